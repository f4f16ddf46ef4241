//! Curvature, spectra, parts, compression, and all methods of smoothing.

use std::fmt::Write;

use dgp::mesh::{Mesh, shapes};
use serde_json::Value;

use crate::folder::{Dgp, error};

/// A mesh as the text of an OFF file.
pub(crate) fn off(mesh: &Mesh) -> String {
    let mut text = format!("OFF\n{} {} 0\n", mesh.vertex_count(), mesh.face_count());
    for p in mesh.positions().values() {
        writeln!(text, "{} {} {}", p.x, p.y, p.z).unwrap();
    }
    for f in mesh.faces() {
        let corners: Vec<String> = mesh.face_vertices(f).map(|v| v.index().to_string()).collect();
        writeln!(text, "{} {}", corners.len(), corners.join(" ")).unwrap();
    }
    text
}

fn sphere() -> String {
    off(&shapes::icosphere(3).unwrap())
}

#[test]
fn curvature_of_a_sphere_is_one_and_sums_to_four_pi() {
    let dgp = Dgp::new(&[("s.off", &sphere())]);
    let (code, value) = dgp.json("curvature s.off -o k.ply --picture k.png --quantity gaussian");
    assert_eq!(code, 0, "{value}");
    let report = &value["report"];
    let number = |v: &Value| v.as_f64().unwrap();
    assert!((number(&report["total_gaussian"]) - 4.0 * std::f64::consts::PI).abs() < 1e-10);
    assert!((number(&report["mean"]["mean"]) - 1.0).abs() < 0.02, "{report}");
    let (_, info) = dgp.json("info k.ply");
    let names = info["report"]["attributes"]["vertex"].to_string();
    for name in ["gaussian_curvature", "mean_curvature", "maximum_curvature", "color"] {
        assert!(names.contains(name), "{names}");
    }
    assert_eq!(dgp.names(), ["k.ply", "k.png", "s.off"]);
    let (code, _) = dgp.json("curvature s.off --method normal-cycle --radius 2");
    assert_eq!(code, 0);
}

#[test]
fn the_spectrum_of_a_sphere_is_that_of_the_books() {
    let dgp = Dgp::new(&[("s.off", &sphere())]);
    let command = "spectrum s.off --count 9 --csv s.csv --plot s.svg --picture s.png \
                   --eigenvectors s.ply";
    let (code, value) = dgp.json(command);
    assert_eq!(code, 0, "{value}");
    let values = value["report"]["eigenvalues"].as_array().unwrap();
    for (i, exact) in [0.0, 2.0, 2.0, 2.0, 6.0, 6.0, 6.0, 6.0, 6.0].into_iter().enumerate() {
        assert!((values[i].as_f64().unwrap() - exact).abs() <= 0.02 * exact, "{values:?}");
    }
    assert_eq!(value["report"]["zero_eigenvalues"], 1);
    assert_eq!(dgp.names(), ["s.csv", "s.off", "s.ply", "s.png", "s.svg"]);
    let (_, info) = dgp.json("info s.ply");
    assert!(info["report"]["attributes"]["vertex"].to_string().contains("eigenvector_8"));
    for laplacian in ["uniform", "intrinsic"] {
        let (code, _) = dgp.json(&format!("spectrum s.off --count 4 --laplacian {laplacian}"));
        assert_eq!(code, 0);
    }
    let output = dgp.run("spectrum s.off --count 100000");
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("count"), "{}", error(&output));
}

#[test]
fn a_dumbbell_is_cut_into_halves() {
    let dgp = Dgp::new(&[("d.off", &off(&shapes::dumbbell(0.2, 24, 36).unwrap()))]);
    for method in ["clusters", "bisection"] {
        let command = format!("partition d.off -o p.ply --method {method} --picture p.png");
        let (code, value) = dgp.json(&command);
        assert_eq!(code, 0, "{value}");
        let masses = value["report"]["masses"].as_array().unwrap();
        let [a, b] = [0, 1].map(|i| masses[i].as_f64().unwrap());
        assert!((a / (a + b) - 0.5).abs() < 0.05, "{masses:?}");
        assert_eq!(value["report"]["pieces"], serde_json::json!([1, 1]));
    }
    let output = dgp.run("partition d.off --parts 0");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn more_coefficients_compress_less_and_lose_less() {
    let dgp = Dgp::new(&[("s.off", &sphere())]);
    let (code, value) =
        dgp.json("compress s.off --coefficients 60 -o c.ply --csv c.csv --plot c.svg");
    assert_eq!(code, 0, "{value}");
    let curve = value["report"]["curve"].as_array().unwrap();
    let distance = |point: &Value| point["distance"].as_f64().unwrap();
    assert!(distance(&curve[curve.len() - 1]) < 0.05 * distance(&curve[0]), "{curve:?}");
    assert_eq!(dgp.names(), ["c.csv", "c.ply", "c.svg", "s.off"]);
}

#[test]
fn every_method_smooths() {
    let noisy = shapes::with_noise(shapes::icosphere(3).unwrap(), 0.05, 1).unwrap();
    let dgp = Dgp::new(&[("n.off", &off(&noisy))]);
    for method in
        ["uniform", "taubin", "cotan", "implicit", "bilateral", "flow", "conformal", "tangential"]
    {
        let command = format!("smooth n.off -o out.off --method {method} --iterations 3");
        let (code, value) = dgp.json(&command);
        assert_eq!(code, 0, "{method}: {value}");
        assert!(value["report"]["max_displacement"].as_f64().unwrap() > 0.0, "{method}");
    }
}

#[test]
fn polygons_are_refused_with_what_to_do() {
    let dgp = Dgp::new(&[("cube.off", crate::folder::CUBE)]);
    for command in ["curvature cube.off", "spectrum cube.off --count 2"] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(1));
        let message = error(&output);
        assert!(message.contains("cube.off") && message.contains("triang"), "{message}");
    }
}
