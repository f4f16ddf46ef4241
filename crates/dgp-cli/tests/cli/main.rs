//! The command as a user meets it: exit codes, messages, reports, pipes, files left behind.

mod decimation;
mod distances;
mod elements;
mod filling;
mod folder;
mod layouts;
mod operators;
mod remeshing;
mod repairing;
mod sampling;
mod spectra;
mod subdivision;
mod subdivision_tables;
mod texts;

use std::fs;

use serde_json::Value;

use self::folder::{CUBE, Dgp, FIN, error};

#[test]
fn info_reports_the_facts_of_a_cube() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let (code, value) = dgp.json("info cube.off");
    assert_eq!((code, value["command"].as_str()), (0, Some("info")));
    let report = &value["report"];
    let expected = [
        ("vertices", 8),
        ("edges", 12),
        ("faces", 6),
        ("triangles", 0),
        ("quads", 6),
        ("polygons", 0),
        ("components", 1),
        ("boundary_loops", 0),
        ("euler_characteristic", 2),
        ("genus", 0),
    ];
    for (name, number) in expected {
        assert_eq!(report[name], number, "{name}");
    }
    for name in ["closed", "manifold", "oriented"] {
        assert_eq!(report[name], true, "{name}");
    }
    assert_eq!((report["area"].as_f64(), report["volume"].as_f64()), (Some(6.0), Some(1.0)));
    assert_eq!(report["bounding_box"]["max"], serde_json::json!([1.0, 1.0, 1.0]));
    assert_eq!(report["edge_length"]["mean"], 1.0);
    assert_eq!(report["valence"]["3"], 8);
    assert!((report["minimum_angle"].as_f64().unwrap() - 90.0).abs() < 1e-12);
    assert!(report["attributes"].is_object());
    assert!(value["seconds"]["read"].as_f64().is_some());
}

#[test]
fn what_has_no_meaning_is_null() {
    let dgp = Dgp::new(&[("fin.off", FIN), ("cloud.xyz", "0 0 0\n1 0 0\n")]);
    let (code, value) = dgp.json("info fin.off");
    let report = &value["report"];
    assert_eq!((code, &report["manifold"]), (0, &Value::Bool(false)));
    assert!(report["genus"].is_null() && report["volume"].is_null(), "{report}");
    let (_, value) = dgp.json("info cloud.xyz");
    assert_eq!(
        (&value["report"]["vertices"], &value["report"]["genus"]),
        (&2.into(), &Value::Null)
    );
}

#[test]
fn check_lists_defects_and_exits_with_1() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("fin.off", FIN)]);
    let (code, value) = dgp.json("check cube.off");
    assert_eq!((code, &value["report"]["valid"]), (0, &Value::Bool(true)));
    let (code, value) = dgp.json("check fin.off");
    assert_eq!((code, &value["report"]["valid"]), (1, &Value::Bool(false)));
    let defect = &value["report"]["defects"][0];
    assert_eq!(defect["kind"], "non_manifold_edge");
    assert_eq!((&defect["count"], &defect["elements"]), (&1.into(), &serde_json::json!([[0, 1]])));
    assert!(defect["remedy"].as_str().unwrap().contains("dgp repair"));
}

#[test]
fn a_mesh_that_is_no_manifold_is_refused_with_the_element_and_the_remedy() {
    let dgp = Dgp::new(&[("fin.off", FIN)]);
    let output = dgp.run("smooth fin.off -o out.off");
    let message = error(&output);
    assert_eq!(output.status.code(), Some(1));
    assert!(message.contains("fin.off") && message.contains("v0–v1"), "{message}");
    assert!(message.contains("repair"), "{message}");
    assert_eq!(dgp.names(), ["fin.off"]);
}

#[test]
fn repair_says_what_it_changed_and_smooth_then_accepts_it() {
    let dgp = Dgp::new(&[("fin.off", FIN)]);
    let (code, value) = dgp.json("repair fin.off -o mended.ply");
    assert_eq!(code, 0);
    assert!(!value["report"]["changes"].as_array().unwrap().is_empty(), "{value}");
    assert_eq!(dgp.run("smooth mended.ply -o out.obj").status.code(), Some(0));
    assert_eq!(dgp.run("check mended.ply -q").status.code(), Some(0));
}

#[test]
fn every_format_is_written_and_read_back() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    for name in ["a.obj", "a.ply", "a.stl", "a.off"] {
        let output = dgp.run(&format!("convert cube.off -o {name}"));
        assert_eq!(output.status.code(), Some(0), "{}", error(&output));
        let (_, value) = dgp.json(&format!("info {name}"));
        assert_eq!(
            (&value["report"]["volume"], &value["report"]["vertices"]),
            (&1.0.into(), &8.into())
        );
    }
}

#[test]
fn what_a_format_cannot_hold_is_said() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let output = dgp.run("convert cube.off -o cube.stl");
    assert!(error(&output).contains("warning"), "{}", error(&output));
    let (_, value) = dgp.json("convert cube.off -o cube.stl");
    assert!(!value["warnings"].as_array().unwrap().is_empty(), "{value}");
}

#[test]
fn pipes_go_both_ways() {
    let dgp = Dgp::new(&[]);
    let output = dgp.pipe("convert - --format off -o - --output-format obj", CUBE.as_bytes());
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.lines().filter(|line| line.starts_with("f ")).count() == 6, "{text}");
    // The contents tell the format where none is named.
    assert_eq!(dgp.pipe("info -", CUBE.as_bytes()).status.code(), Some(0));
}

#[test]
fn wrong_usage_exits_with_2() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    for arguments in [
        "",
        "melt cube.off",
        "convert cube.off",
        "smooth cube.off -o a.off --iterations many",
        "render cube.off -o a.png --size huge",
        "convert cube.off -o -",
        "convert cube.off -o - --output-format off --json -",
    ] {
        let output = dgp.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", error(&output));
    }
    assert_eq!(dgp.names(), ["cube.off"]);
}

#[test]
fn bad_files_exit_with_1_and_leave_nothing_behind() {
    let dgp = Dgp::new(&[
        ("cube.off", CUBE),
        ("empty.ply", ""),
        ("cut.off", &CUBE[..70]),
        ("huge.off", "OFF\n353535235358 6 0\n0 0 0\n"),
        ("beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("words.stl", "solid x\nfacet normal a b c\n"),
        ("mesh.docx", "?"),
    ]);
    fs::create_dir(dgp.folder().join("folder.obj")).unwrap();
    let before = dgp.names();
    for name in [
        "empty.ply",
        "cut.off",
        "huge.off",
        "beyond.obj",
        "words.stl",
        "mesh.docx",
        "folder.obj",
        "none.ply",
    ] {
        let output = dgp.run(&format!("convert {name} -o out.ply"));
        let message = error(&output);
        assert_eq!(output.status.code(), Some(1), "{name}: {message}");
        assert!(message.starts_with("dgp: ") && message.contains(name), "{name}: {message}");
    }
    let output = dgp.run("convert cube.off -o missing/folder/out.ply");
    assert_eq!(output.status.code(), Some(1), "{}", error(&output));
    assert_eq!(dgp.names(), before);
}

#[test]
fn an_old_file_survives_a_failed_run() {
    let dgp = Dgp::new(&[("fin.off", FIN), ("out.off", "precious")]);
    assert_eq!(dgp.run("smooth fin.off -o out.off").status.code(), Some(1));
    assert_eq!(fs::read_to_string(dgp.folder().join("out.off")).unwrap(), "precious");
}

#[test]
fn render_draws_side_by_side() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("fin.off", FIN)]);
    let (code, value) = dgp.json("render cube.off fin.off -o both.png --size 320x160 --wireframe");
    assert_eq!((code, value["report"]["models"].as_array().map(Vec::len)), (0, Some(2)));
    let png = fs::read(dgp.folder().join("both.png")).unwrap();
    assert_eq!((&png[1..4], &png[16..24]), (&b"PNG"[..], &[0, 0, 1, 64, 0, 0, 0, 160][..]));
    let output = dgp.run("render cube.off -o a.png --color-by warmth");
    assert!(error(&output).contains("warmth"), "{}", error(&output));
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn results_are_the_same_bytes_for_any_number_of_threads() {
    let dgp = Dgp::new(&[]);
    for threads in [1, 2, 8] {
        let output =
            dgp.run(&format!("demo -o d{threads} --shape blob --level 4 --threads {threads} -q"));
        assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    }
    let mut names: Vec<_> =
        fs::read_dir(dgp.folder().join("d1")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert!(names.len() > 8, "{names:?}");
    for name in names {
        let [one, others @ ..] =
            ["d1", "d2", "d8"].map(|d| fs::read(dgp.folder().join(d).join(&name)));
        let one = one.unwrap();
        // The page and the report hold times.
        if name.to_string_lossy().ends_with(".html") || name.to_string_lossy().ends_with(".json") {
            continue;
        }
        for other in others {
            assert!(one == other.unwrap(), "{name:?}");
        }
    }
}

#[test]
fn demo_runs_the_chain_on_a_file_too() {
    let dgp = Dgp::new(&[("fin.off", FIN)]);
    let output = dgp.run("demo fin.off -o shown");
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    let page = fs::read_to_string(dgp.folder().join("shown/index.html")).unwrap();
    for link in page.split("src=\"").skip(1).chain(page.split("href=\"").skip(1)) {
        let link = link.split('"').next().unwrap();
        assert!(dgp.folder().join("shown").join(link).exists(), "{link}");
    }
}
