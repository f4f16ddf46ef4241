//! `dgp evaluate` and `dgp stencils`: points at parameters, tables written and applied; data through
//! `dgp subdivide --adaptive`, Phong tessellation and √3.

use std::{fmt::Write, fs};

use dgp::{
    io::Document,
    mesh::{Color, DVec2, DVec3, NORMAL, Normal, UV},
    sparse::SparseMatrix,
};
use serde_json::{Value, json};

use crate::folder::{CUBE, Dgp, error};

fn read(dgp: &Dgp, name: &str) -> Document {
    dgp::io::read(dgp.folder().join(name)).unwrap()
}

fn matrix(dgp: &Dgp, name: &str) -> SparseMatrix {
    let text = fs::read_to_string(dgp.folder().join(name)).unwrap();
    SparseMatrix::from_matrix_market(&text).unwrap()
}

#[test]
fn the_table_takes_the_cage_to_the_refined_vertices() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let (code, value) = dgp.json("stencils cube.off -o t.mtx --levels 2");
    let report = &value["report"];
    assert_eq!((code, &report["rows"], &report["columns"]), (0, &98.into(), &8.into()), "{value}");
    let sums: Vec<f64> = serde_json::from_value(report["row_sums"].clone()).unwrap();
    assert!(sums.iter().all(|s| (s - 1.0).abs() < 1e-14), "{value}");
    dgp.json("subdivide cube.off -o r.ply --levels 2");
    let (cage, refined) = (read(&dgp, "cube.off").set, read(&dgp, "r.ply").set);
    let table = matrix(&dgp, "t.mtx");
    for axis in 0..3 {
        let old: Vec<f64> = cage.positions().values().iter().map(|p| p[axis]).collect();
        for (found, p) in table.product(&old).iter().zip(refined.positions().values()) {
            assert!((found - p[axis]).abs() < 1e-15);
        }
    }
    // Steps one after the other, and the matrix turned over, are the same.
    dgp.json("stencils cube.off -o first.mtx --levels 1");
    dgp.json("stencils cube.off -o second.mtx --levels 2 --from 1");
    dgp.json("stencils cube.off -o back.mtx --levels 2 --transpose");
    let [first, second, back] = ["first.mtx", "second.mtx", "back.mtx"].map(|n| matrix(&dgp, n));
    let old: Vec<f64> = (0..8).map(|k| f64::from(k * k)).collect();
    let (one, two) = (table.product(&old), second.product(&first.product(&old)));
    assert!(one.iter().zip(&two).all(|(a, b)| (a - b).abs() < 1e-12));
    let weights: Vec<f64> = (0..98).map(|k| f64::from(k % 7) - 2.0).collect();
    let there: f64 = one.iter().zip(&weights).map(|(a, b)| a * b).sum();
    let here: f64 = back.product(&weights).iter().zip(&old).map(|(a, b)| a * b).sum();
    assert!((there - here).abs() < 1e-9, "{there} {here}");
}

#[test]
fn rows_stand_for_limits_and_tangents_too() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    dgp.json("stencils cube.off -o limit.mtx --levels 0 --rows limit");
    let limit = matrix(&dgp, "limit.mtx");
    // Around the middle of the cube, at ½, the cage shrinks to a half.
    let x: Vec<f64> = read(&dgp, "cube.off").set.positions().values().iter().map(|p| p.x).collect();
    for (found, x) in limit.product(&x).iter().zip(&x) {
        assert!((found - (0.25 + 0.5 * x)).abs() < 1e-15);
    }
    for k in ["tangent-1", "tangent-2"] {
        let (_, value) = dgp.json(&format!("stencils cube.off -o t.mtx --levels 1 --rows {k}"));
        let sums: Vec<f64> = serde_json::from_value(value["report"]["row_sums"].clone()).unwrap();
        assert!(sums.iter().all(|s| s.abs() < 1e-13), "{value}");
        assert_eq!(value["report"]["stands_for"], k);
    }
}

#[test]
fn poses_are_refined_by_one_table() {
    let lid = "0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
    let stretched = CUBE.replace(lid, "0 0 3\n1 0 3\n1 1 3\n0 1 3\n");
    let fewer = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let dgp = Dgp::new(&[("cube.off", CUBE), ("long.off", &stretched), ("fewer.off", fewer)]);
    let command = "stencils cube.off --levels 3 --rows limit --apply cube.off long.off --into out";
    let (code, value) = dgp.json(command);
    assert_eq!(
        (code, value["report"]["applied"].as_array().map(Vec::len)),
        (0, Some(2)),
        "{value}"
    );
    dgp.json("subdivide long.off -o r.off --levels 3 --limit");
    let [found, expected] = ["out/long.off", "r.off"].map(|name| read(&dgp, name).set);
    assert_eq!(found.faces(), expected.faces());
    let pairs = found.positions().values().iter().zip(expected.positions().values());
    assert!(pairs.clone().count() > 300 && pairs.clone().all(|(p, q)| p.distance(*q) < 1e-14));
    for (command, code, part) in [
        ("--apply fewer.off --into out", 2, "fewer.off does not have the faces"),
        ("--apply long.off", 2, "--into"),
        ("-o t.mtx --levels 2 --from 2", 2, "must be below"),
        ("-o t.mtx --rows limit --scheme sqrt3", 1, "splits triangles"),
        ("-o t.mtx --rows limit --scheme doo-sabin", 1, "no limit masks"),
        ("-o t.mtx --rows tangent-1 --apply long.off --into out", 2, "--rows refined or limit"),
        ("-o t.mtx --scheme phong", 2, "phong"),
        ("-o t.mtx --levels 12", 1, "--memory-limit"),
    ] {
        let output = dgp.run(&format!("stencils cube.off {command}"));
        let message = error(&output);
        assert_eq!(output.status.code(), Some(code), "{command}: {message}");
        assert!(message.contains(part), "{command}: {message}");
    }
    assert!(!dgp.names().contains(&"t.mtx".to_owned()), "{:?}", dgp.names());
}

#[test]
fn points_of_the_surface_have_their_places_normals_and_derivatives() {
    let at = "face,u,v\n0,0,0\n1,0.5,0.5\n3,1,1\n\n5,0.25,0.75\n";
    let dgp = Dgp::new(&[("cube.off", CUBE), ("at.csv", at)]);
    let (code, value) = dgp.json("evaluate cube.off -o p.csv --at at.csv");
    assert_eq!((code, &value["report"]["points"]), (0, &4.into()), "{value}");
    assert_eq!(value["report"]["without_normal"], 0);
    let text = fs::read_to_string(dgp.folder().join("p.csv")).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|word| word.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 4);
    // A vertex of the cube goes half way to the middle; face 1 is the lid.
    let point = |row: &[f64], k: usize| DVec3::from_slice(&row[k..k + 3]);
    assert!(point(&rows[0], 3).distance(DVec3::splat(0.25)) < 1e-12, "{:?}", rows[0]);
    let outward = DVec3::splat(-1.0).normalize();
    assert!(point(&rows[0], 6).distance(outward) < 1e-6, "{:?}", rows[0]);
    let lid = point(&rows[1], 3);
    assert!((lid.x - 0.5).abs() < 1e-14 && (lid.y - 0.5).abs() < 1e-14 && lid.z > 0.7);
    assert!(point(&rows[1], 6).distance(DVec3::Z) < 1e-14, "{:?}", rows[1]);
    for row in &rows {
        let [normal, du, dv] = [6, 9, 12].map(|k| point(row, k));
        assert!((normal.length() - 1.0).abs() < 1e-14);
        assert!(normal.dot(du).abs() < 1e-12 && normal.dot(dv).abs() < 1e-12, "{row:?}");
    }
    // Evenly, as a cloud; the points are those of a mesh refined to the limit between its vertices.
    let (_, value) = dgp.json("evaluate cube.off -o p.ply --samples 4");
    assert_eq!(value["report"]["points"], 96);
    let cloud = read(&dgp, "p.ply").set;
    assert_eq!((cloud.vertex_count(), cloud.face_count()), (96, 0));
    assert!(cloud.vertex_attributes.get::<Normal>(NORMAL).is_some());
    assert_eq!(cloud.vertex_attributes.get::<u32>("face").unwrap().values()[95], 5);
    dgp.json("subdivide cube.off -o fine.ply --levels 3 --limit");
    let fine = read(&dgp, "fine.ply").set;
    for p in cloud.positions().values() {
        let nearest = fine.positions().values().iter().map(|q| p.distance(*q));
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-13, "{p}");
    }
}

#[test]
fn triangles_and_creases_are_evaluated_and_what_cannot_be_is_refused() {
    let tent = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\n\
        f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nt corner 1/1/0 4 10\n";
    let pentagon = "OFF\n5 1 0\n0 0 0\n1 0 0\n1.5 1 0\n0.5 2 0\n-0.5 1 0\n5 0 1 2 3 4\n";
    let dgp = Dgp::new(&[
        ("tent.obj", tent),
        ("pentagon.off", pentagon),
        ("cube.off", CUBE),
        ("tip.csv", "2,0,1\n"),
        ("far.csv", "face,u,v\n9,0,0\n"),
        ("out.csv", "0,0.7,0.6\n"),
        ("bad.csv", "0,0.1\n"),
        ("nan.csv", "0,nan,0\n"),
    ]);
    // The tip stays where it is as a corner, and sinks as a smooth vertex.
    let tip = |options: &str| {
        dgp.json(&format!("evaluate tent.obj -o p.ply --scheme loop --at tip.csv {options}"));
        read(&dgp, "p.ply").set.positions().values()[0]
    };
    assert_eq!(tip("--creases"), DVec3::new(0.5, 0.5, 1.0));
    assert!(tip("").z < 0.8, "{}", tip(""));
    let (code, value) = dgp.json("evaluate tent.obj -o p.ply --scheme loop --samples 3");
    assert_eq!((code, &value["report"]["points"]), (0, &36.into()));
    let (code, value) = dgp.json("evaluate pentagon.off -o p.ply --levels 1 --samples 2");
    assert_eq!((code, &value["report"]["points"]), (0, &20.into()));
    for (command, code, part) in [
        ("pentagon.off", 1, "refine once"),
        ("cube.off --scheme sqrt3", 2, "loop or catmull-clark"),
        ("cube.off --scheme loop", 1, "dgp convert --triangulate"),
        ("cube.off --at far.csv", 1, "there is no face 9"),
        ("tent.obj --scheme loop --at out.csv", 1, "inside the face"),
        ("cube.off --at bad.csv", 2, "face,u,v"),
        ("cube.off --at nan.csv", 1, "inside the face"),
        ("cube.off --at none.csv", 1, "none.csv"),
    ] {
        let output = dgp.run(&format!("evaluate {command} -o q.ply"));
        let message = error(&output);
        assert_eq!(output.status.code(), Some(code), "{command}: {message}");
        assert!(message.contains(part), "{command}: {message}");
    }
    assert!(!dgp.names().contains(&"q.ply".to_owned()));
}

/// A cube with texture coordinates, groups and colors.
fn textured() -> String {
    let mut text = String::new();
    for k in 0..8 {
        let at = [k & 1, k >> 1 & 1, k >> 2];
        writeln!(text, "v {} {} {} {} {} 0", at[0], at[1], at[2], at[0], at[1]).unwrap();
    }
    text += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    for (k, face) in faces.iter().enumerate() {
        let corners: Vec<String> =
            face.iter().zip(1..).map(|(v, t)| format!("{}/{t}", v + 1)).collect();
        writeln!(text, "g side{k}\nf {}", corners.join(" ")).unwrap();
    }
    text
}

/// The area of all charts.
fn texture_area(document: &Document) -> f64 {
    let set = &document.set;
    let uv = set.corner_attributes.get::<DVec2>(UV).unwrap();
    let mut start = 0;
    let mut area = 0.0;
    for (_, face) in set.faces().iter() {
        let uv = &uv.values()[start..start + face.len()];
        start += face.len();
        area += (0..uv.len()).map(|k| uv[k].perp_dot(uv[(k + 1) % uv.len()])).sum::<f64>() / 2.0;
    }
    area
}

#[test]
fn texture_groups_and_colors_travel_whatever_splits_the_faces() {
    let dgp = Dgp::new(&[("cube.obj", &textured())]);
    dgp.json("convert cube.obj -o tri.obj --triangulate");
    for (command, left_out, area) in [
        ("cube.obj --adaptive 1%", json!([]), 6.0),
        ("cube.obj --adaptive 1% --face-varying smooth", json!([]), 6.0),
        ("cube.obj --adaptive 1% --face-varying sharp-rims", json!([]), 6.0),
        ("tri.obj --scheme loop --adaptive 1%", json!([]), 6.0),
        ("tri.obj --scheme phong --levels 2", json!([]), 6.0),
        ("tri.obj --scheme sqrt3 --levels 2", json!([]), 6.0),
        ("tri.obj --scheme sqrt3 --levels 3", json!(["uv"]), 0.0),
    ] {
        let (code, value): (i32, Value) = dgp.json(&format!("subdivide {command} -o r.obj"));
        assert_eq!((code, &value["report"]["left_out"]), (0, &left_out), "{command}: {value}");
        let found = read(&dgp, "r.obj");
        let groups = found.set.face_attributes.get::<dgp::mesh::Label>("group").unwrap();
        let mut names: Vec<&str> = groups.values().iter().map(dgp::mesh::Label::as_str).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names, ["side0", "side1", "side2", "side3", "side4", "side5"], "{command}");
        assert!(found.set.vertex_attributes.get::<Color>("color").is_some(), "{command}");
        if area > 0.0 {
            let found = texture_area(&found);
            assert!((found - area).abs() < 1e-9, "{command}: {found}");
        }
    }
    // Round corners of charts take some of the texture away.
    dgp.json("subdivide cube.obj -o r.obj --levels 2 --face-varying smooth-corners");
    assert!(texture_area(&read(&dgp, "r.obj")) < 5.9);
}
