//! Distances between surfaces, and of points.

use std::fs;

use dgp::mesh::{Mesh, shapes};
use serde_json::Value;

use crate::{
    folder::{CUBE, Dgp, FIN, error},
    spectra::off,
};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn sphere(radius: f64) -> String {
    let mut mesh: Mesh = shapes::icosphere(3).unwrap();
    mesh.set_positions(mesh.positions().map(|&p| radius * p));
    off(&mesh)
}

#[test]
fn two_spheres_are_as_far_apart_as_their_radii() {
    let dgp = Dgp::new(&[("a.off", &sphere(1.0)), ("b.off", &sphere(1.1)), ("fin.off", FIN)]);
    let (code, value) = dgp.json("compare a.off b.off -o d.ply --picture d.png --tolerance 1e-3");
    assert_eq!(code, 0, "{value}");
    let hausdorff = &value["report"]["hausdorff"];
    let (lower, upper) = (number(&hausdorff["lower"]), number(&hausdorff["upper"]));
    // From the outer vertices to the inner faces, which are up to 1% below the sphere.
    assert!(lower <= upper && lower > 0.0999 && upper < 0.115, "{hausdorff}");
    assert_eq!(hausdorff["forward"]["within_tolerance"], true);
    let mean = number(&value["report"]["forward"]["mean"]);
    assert!((mean - 0.1).abs() < 0.003, "{mean}");
    assert!((number(&value["report"]["chamfer"]["distance"]) - 0.2).abs() < 1e-9);
    assert_eq!(&fs::read(dgp.folder().join("d.png")).unwrap()[1..4], b"PNG");
    let info = dgp.json("info d.ply").1;
    let attributes = info["report"]["attributes"].to_string();
    assert!(attributes.contains("distance") && attributes.contains("color"), "{attributes}");
    // What is no manifold has a distance too; a cloud has no faces.
    assert_eq!(dgp.json("compare fin.off a.off").0, 0);
    fs::write(dgp.folder().join("cloud.xyz"), "0 0 0\n1 0 0\n").unwrap();
    let output = dgp.run("compare a.off cloud.xyz");
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("cloud.xyz"), "{}", error(&output));
    assert_eq!(dgp.run("compare a.off b.off --tolerance 0").status.code(), Some(1));
}

#[test]
fn points_know_whether_they_are_inside_a_cube() {
    let points = "0.5 0.5 0.5\n0.5 0.5 1.5\n2 0.5 0.5\n0.25 0.5 0.5\n";
    let dgp = Dgp::new(&[("cube.off", CUBE), ("p.xyz", points)]);
    for sign in ["winding", "normal"] {
        let command =
            format!("distance cube.off --points p.xyz --sign {sign} --csv d.csv -o d.ply");
        let (code, value) = dgp.json(&command);
        assert_eq!((code, &value["report"]["inside"]), (0, &2.into()), "{value}");
        let text = fs::read_to_string(dgp.folder().join("d.csv")).unwrap();
        let rows: Vec<Vec<f64>> = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
            .collect();
        let distances: Vec<f64> = rows.iter().map(|row| row[3]).collect();
        assert_eq!(distances, [-0.5, 0.5, 1.0, -0.25], "{text}");
        for row in &rows {
            let right = if row[3] < 0.0 { 1.0 } else { 0.0 };
            assert!((row[4] - right).abs() < 0.01, "{text}");
        }
    }
    let (code, value) = dgp.json("distance cube.off --grid 7 --sign none -o g.ply");
    assert_eq!(
        (code, &value["report"]["points"], &value["report"]["inside"]),
        (0, &343.into(), &0.into())
    );
    for (command, code) in [
        ("distance cube.off", 2),
        ("distance cube.off --grid 1", 2),
        ("distance p.xyz --grid 4", 1),
        ("distance cube.off --points p.xyz --accuracy 0.1", 1),
    ] {
        assert_eq!(dgp.run(command).status.code(), Some(code), "{command}");
    }
}
