//! `dgp remesh`: lengths, tolerances, features, what is refused.

use std::fs;

use crate::folder::{CUBE, Dgp, error};

fn with_shapes() -> Dgp {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    for shape in ["icosphere 3 -o sphere.ply", "grid 8 8 -o grid.ply"] {
        let (code, value) = dgp.json(&format!("shape {shape}"));
        assert_eq!(code, 0, "{shape}: {value}");
    }
    dgp
}

#[test]
fn every_way_gives_a_mesh_that_passes_the_check() {
    let dgp = with_shapes();
    for options in [
        "",
        "--edge 0.1",
        "--edge 0.7x --iterations 3",
        "--edge 2x --feature-angle 40 --corner-angle 30",
        "--adaptive 1%",
        "--adaptive 0.01 --min-edge 0.05 --max-edge 20% --gradation 0.5",
        "--keep-boundary --measure",
    ] {
        for input in ["sphere.ply", "grid.ply"] {
            let (code, value) = dgp.json(&format!("remesh {input} -o r.ply {options}"));
            assert_eq!(code, 0, "{input} {options}: {value}");
            let report = &value["report"];
            assert_eq!(value["output"]["faces"], report["faces"][1]);
            let angle = report["quality"][1]["minimum_angle"].as_f64().unwrap().to_degrees();
            assert!(angle > 20.0, "{input} {options}: {angle}");
            assert_eq!(dgp.run("check r.ply -q").status.code(), Some(0), "{input} {options}");
            let is_measured = options.contains("adaptive") || options.contains("measure");
            assert_eq!(report["distance"].is_object(), is_measured, "{report}");
        }
    }
}

#[test]
fn edges_of_a_cube_stay_and_polygons_are_cut() {
    let dgp = with_shapes();
    let output =
        dgp.run("remesh cube.off -o r.ply --edge 0.25x --feature-angle 40 --picture r.png");
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    assert!(error(&output).contains("polygons are cut"), "{}", error(&output));
    assert!(fs::read(dgp.folder().join("r.png")).unwrap().len() > 1000);
    let (_, before) = dgp.json("info cube.off");
    let (_, after) = dgp.json("info r.ply");
    let volume = |value: &serde_json::Value| value["report"]["volume"].as_f64().unwrap();
    assert!((volume(&after) / volume(&before) - 1.0).abs() < 1e-6);
}

#[test]
fn creases_of_a_file_are_lines() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nt crease 2/1/0 0 2 3.0\n";
    let dgp = Dgp::new(&[("square.obj", text)]);
    for (options, lines) in [("", 4), ("--features", 5)] {
        let (code, value) = dgp.json(&format!("remesh square.obj -o r.ply --edge 0.2 {options}"));
        assert_eq!((code, value["report"]["lines"].as_u64()), (0, Some(lines)), "{value}");
    }
}

#[test]
fn wrong_options_and_lengths_are_refused() {
    let dgp = with_shapes();
    for (options, message) in [
        ("--edge 0", "positive"),
        ("--edge many", "positive"),
        ("--edge -1x", "unexpected"),
        ("--edge 1 --adaptive 1", "cannot be used with"),
        ("--adaptive some", "neither a number"),
        ("--min-edge 1", "required"),
        ("--feature-angle 270", "no angle"),
    ] {
        let output = dgp.run(&format!("remesh sphere.ply -o r.ply {options}"));
        assert_eq!(output.status.code(), Some(2), "{options}: {}", error(&output));
        assert!(error(&output).contains(message), "{options}: {}", error(&output));
    }
    let output = dgp.run("remesh sphere.ply -o r.ply --edge 1e-9");
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("67 million"), "{}", error(&output));
}
