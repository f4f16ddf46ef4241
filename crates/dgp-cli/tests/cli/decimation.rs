//! `dgp decimate` and `dgp progressive`: targets, constraints, files, what is refused.

use std::fs;

use serde_json::json;

use crate::folder::{CUBE, Dgp, error};

fn with_sphere() -> Dgp {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let (code, _) = dgp.json("shape icosphere 3 -o sphere.ply");
    assert_eq!(code, 0);
    dgp
}

#[test]
fn every_target_and_cost_gives_a_mesh_that_passes_the_check() {
    let dgp = with_sphere();
    for options in [
        "--faces 200",
        "--faces 25%",
        "--vertices 100",
        "--error 1%",
        "--error 0.01 --keep-positions",
        "--faces 200 --cost length",
        "--faces 200 --cost curvature --feature-angle 60",
        "--faces 200 --max-hausdorff 5%",
        "--faces 200 --keep-boundary --feature-angle 30",
        "--faces 200 --fast",
        "--faces 200 --polish 2",
        "--faces 200 --attribute-weight 5%",
    ] {
        let (code, value) = dgp.json(&format!("decimate sphere.ply -o r.ply {options}"));
        assert_eq!(code, 0, "{options}: {value}");
        let report = &value["report"];
        assert!(report["faces"][1].as_u64().unwrap() < 1000, "{options}: {report}");
        assert_eq!(value["output"]["faces"], report["faces"][1]);
        assert!(report["largest_error"].as_f64().unwrap() > 0.0, "{options}");
        assert_eq!(dgp.run("check r.ply -q").status.code(), Some(0), "{options}");
    }
    let (_, value) = dgp.json("decimate sphere.ply -o r.ply --faces 25%");
    assert_eq!(value["report"]["faces"], json!([1280, 320]));
    assert_eq!(value["report"]["stop"], "target reached");
    assert_eq!(value["report"]["cost"], "quadric");
}

#[test]
fn what_cannot_be_reached_is_said_and_polygons_are_cut() {
    let dgp = with_sphere();
    let (code, value) = dgp.json("decimate sphere.ply -o r.ply --faces 0");
    assert_eq!((code, &value["report"]["faces"][1]), (0, &json!(4)));
    assert_eq!(value["report"]["stop"], "nothing left");
    let output = dgp.run("decimate cube.off -o r.off --faces 12 --picture r.png");
    assert!(error(&output).contains("polygons are cut"), "{}", error(&output));
    assert!(fs::read(dgp.folder().join("r.png")).unwrap().len() > 1000);
    for (options, message) in [
        ("", "required"),
        ("--faces 3 --vertices 3", "cannot be used with"),
        ("--faces some", "neither a number"),
        ("--faces 10 --feature-angle 270", "no angle"),
        ("--faces 10 --fast --cost length", "--cost quadric"),
        ("--faces 10 --fast --polish 1", "cannot be used with"),
    ] {
        let output = dgp.run(&format!("decimate sphere.ply -o r.ply {options}"));
        assert_eq!(output.status.code(), Some(2), "{options}");
        assert!(error(&output).contains(message), "{options}: {}", error(&output));
    }
}

#[test]
fn the_distance_asked_for_is_sure_both_ways() {
    let dgp = with_sphere();
    let (code, value) = dgp.json("decimate sphere.ply -o r.ply --faces 0 --max-hausdorff 2%");
    assert_eq!(code, 0, "{value}");
    let diagonal = 2.0 * 3_f64.sqrt();
    let upper = value["report"]["hausdorff"]["upper"].as_f64().unwrap();
    assert!(upper <= 0.02 * diagonal * 1.001 && upper > 0.005 * diagonal, "{upper}");
    let (_, value) = dgp.json("compare r.ply sphere.ply");
    let lower = value["report"]["hausdorff"]["lower"].as_f64();
    assert!(lower.is_none_or(|lower| lower <= upper), "{value}");
}

#[test]
fn progressive_files_keep_data() {
    let dgp = with_sphere();
    assert_eq!(dgp.run("curvature sphere.ply -o c.ply").status.code(), Some(0));
    let (code, value) = dgp.json("progressive c.ply -o c.dgpp --base 20");
    assert_eq!(code, 0, "{value}");
    let names = value["report"]["attributes"].clone();
    assert!(!names.as_array().unwrap().is_empty(), "{value}");
    let (code, value) = dgp.json("progressive c.dgpp -o r.ply --faces 100");
    assert_eq!((code, &value["report"]["attributes"]), (0, &names));
    let (_, value) = dgp.json("info r.ply");
    let there = value["report"]["attributes"]["vertex"].to_string();
    for name in names.as_array().unwrap() {
        assert!(there.contains(name.as_str().unwrap()), "{there}");
    }
}

#[test]
fn progressive_files_give_back_every_level() {
    let dgp = with_sphere();
    let (code, value) = dgp.json("progressive sphere.ply -o s.dgpp --base 20");
    assert_eq!(code, 0, "{value}");
    assert_eq!(value["report"]["base"]["faces"], 20);
    assert!(value["output"]["bytes"].as_u64().unwrap() > 10_000);
    for (options, faces) in
        [("", 1280), ("--faces 100", 100), ("--level 0", 20), ("--level 100%", 1280)]
    {
        let (code, value) = dgp.json(&format!("progressive s.dgpp -o r.ply {options}"));
        assert_eq!((code, &value["report"]["faces"]), (0, &json!(faces)), "{options}");
        assert_eq!(dgp.run("check r.ply -q").status.code(), Some(0), "{options}");
    }
    let output = dgp.run("progressive s.dgpp -o r.ply --level 100000");
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("vertex splits"), "{}", error(&output));
    let mut bytes = fs::read(dgp.folder().join("s.dgpp")).unwrap();
    bytes[1000] ^= 1;
    fs::write(dgp.folder().join("bad.dgpp"), &bytes).unwrap();
    let output = dgp.run("progressive bad.dgpp -o r.ply");
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("checksum"), "{}", error(&output));
}
