//! `dgp subdivide`: schemes, creases of files, limits, tolerances, what is refused.

use std::{
    fs,
    path::{Path, PathBuf},
};

use dgp::{
    io::Document,
    mesh::{DVec2, DVec3, NORMAL, Normal, UV},
};
use serde_json::json;

use crate::folder::{CUBE, Dgp, error};

/// A cube whose upper face has a sharp rim, a sharp corner below and texture coordinates with seams.
const TAGGED: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    f 1/1 4/2 3/3 2/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\n\
    f 4/1 1/2 5/3 8/4\n\
    t crease 5/1/0 4 5 6 7 4 10\nt corner 1/1/0 0 2.5\nt interpolateboundary 1/0/0 2\n";

fn read(dgp: &Dgp, name: &str) -> Document {
    dgp::io::read(dgp.folder().join(name)).unwrap()
}

fn octahedron() -> &'static str {
    "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n\
     3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n"
}

#[test]
fn every_scheme_has_its_number_of_faces_and_keeps_the_euler_characteristic() {
    let dgp = Dgp::new(&[("o.off", octahedron()), ("cube.off", CUBE)]);
    for (name, scheme, [vertices, faces]) in [
        ("o", "loop", [66, 128]),
        ("o", "loop --loop-weights warren", [66, 128]),
        ("o", "butterfly", [66, 128]),
        ("o", "modified-butterfly", [66, 128]),
        ("o", "phong", [66, 128]),
        ("o", "sqrt3", [38, 72]),
        ("o", "catmull-clark", [98, 96]),
        ("cube", "catmull-clark", [98, 96]),
        ("cube", "bilinear", [98, 96]),
        ("cube", "doo-sabin", [96, 98]),
    ] {
        let command = format!("subdivide {name}.off -o r.off --levels 2 --scheme {scheme}");
        let (code, value) = dgp.json(&command);
        assert_eq!(code, 0, "{command}: {value}");
        let report = &value["report"];
        assert_eq!(report["refined"]["vertices"], vertices, "{command}");
        assert_eq!(report["refined"]["faces"], faces, "{command}");
        assert_eq!(report["euler_characteristic"], json!([2, 2]), "{command}");
        assert!(report["predicted_bytes"].as_u64().unwrap() > 1000, "{command}");
        assert_eq!(dgp.run("check r.off -q").status.code(), Some(0), "{command}");
    }
    // Interpolating schemes keep the six vertices, Phong tessellation too.
    for scheme in ["butterfly", "modified-butterfly", "phong", "loop"] {
        dgp.json(&format!("subdivide o.off -o r.off --levels 2 --scheme {scheme}"));
        let found = read(&dgp, "r.off").set.positions().values()[..6].to_vec();
        assert_eq!(found[4] == DVec3::Z, scheme != "loop", "{scheme}: {found:?}");
    }
}

#[test]
fn limits_have_their_analytic_places_and_normals() {
    let dgp = Dgp::new(&[("o.off", octahedron()), ("cube.off", CUBE)]);
    for (command, at, expected) in [
        // From the octahedron at 1 to 24/55 under Loop, from the cube around (½, ½, ½) to a half of it.
        ("subdivide o.off -o r.ply --levels 2 --limit --scheme loop", 4, DVec3::Z * 24.0 / 55.0),
        ("subdivide cube.off -o r.ply --levels 2 --limit", 6, DVec3::splat(0.75)),
    ] {
        let (code, value) = dgp.json(command);
        assert_eq!((code, &value["report"]["limit"]), (0, &true.into()), "{value}");
        let set = read(&dgp, "r.ply").set;
        let v = dgp::mesh::VertexId::new(at);
        assert!(set.positions()[v].distance(expected) < 1e-14, "{}", set.positions()[v]);
        let normals = set.vertex_attributes.get::<Normal>(NORMAL).unwrap();
        let center = if at == 4 { DVec3::ZERO } else { DVec3::splat(0.5) };
        let outward = (expected - center).normalize();
        assert!(normals[v].0.distance(outward) < 1e-12, "{:?} {outward}", normals[v]);
        assert!(normals.values().iter().all(|n| (n.0.length() - 1.0).abs() < 1e-12));
    }
}

#[test]
fn creases_come_from_the_file_and_go_into_the_file() {
    let dgp = Dgp::new(&[("t.obj", TAGGED)]);
    let (code, value) = dgp.json("subdivide t.obj -o r.obj --levels 2 --creases");
    let report = &value["report"];
    assert_eq!(
        (code, &report["sharp_edges"], &report["sharp_vertices"]),
        (0, &4.into(), &1.into())
    );
    assert_eq!(value["warnings"], json!([]));
    let found = read(&dgp, "r.obj");
    let rules = found.subdivision_rules().unwrap();
    // Each of the four edges has four quarters, sharp for ever; of 2.5 a half is left.
    assert_eq!(rules.creases.len(), 16);
    assert!(rules.creases.iter().all(|(_, s)| *s == 10.0));
    assert_eq!((rules.corners.len(), rules.corners[0].1, rules.boundary), (1, 0.5, Some(2)));
    let top = |p: &&DVec3| (p.z - 1.0).abs() < 1e-14;
    assert!(found.set.positions().values().iter().filter(top).count() > 16, "the lid stays flat");
    // Refining the result once more is the same as refining by one level more.
    dgp.json("subdivide r.obj -o twice.obj --creases");
    dgp.json("subdivide t.obj -o once.obj --levels 3 --creases");
    let [twice, once] = ["twice.obj", "once.obj"].map(|name| {
        let mut points = read(&dgp, name).set.positions().values().to_vec();
        points.sort_by(|p, q| {
            let key = |p: &DVec3| p.to_array().map(|x| (x * 1e6 + 0.3137).round());
            key(p).partial_cmp(&key(q)).unwrap()
        });
        points
    });
    assert_eq!(twice.len(), once.len());
    for (p, q) in twice.iter().zip(&once) {
        assert!(p.distance(*q) < 1e-12, "{p} {q}");
    }
    // Without --creases tags are not applied, which is said, and none are written.
    let (_, value) = dgp.json("subdivide t.obj -o smooth.obj --levels 2");
    assert!(value["warnings"][0].as_str().unwrap().contains("--creases"), "{value}");
    assert_eq!(value["report"]["sharp_edges"], 0);
    assert_eq!(read(&dgp, "smooth.obj").tags, []);
}

#[test]
fn edges_that_bend_become_creases_on_request() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let (_, value) = dgp.json("subdivide cube.off -o r.off --levels 3 --crease-angle 80 --limit");
    assert_eq!(value["report"]["sharp_edges"], 12);
    let (_, info) = dgp.json("info r.off");
    assert!((info["report"]["volume"].as_f64().unwrap() - 1.0).abs() < 1e-14, "{info}");
    let (_, value) = dgp.json("subdivide cube.off -o r.off --crease-angle 91");
    assert_eq!(value["report"]["sharp_edges"], 0);
    // Half sharp, the middle of an edge moves half as far.
    let (_, value) =
        dgp.json("subdivide cube.off -o r.off --crease-angle 80 --crease-sharpness .5");
    assert_eq!(value["report"]["sharp_edges"], 12);
    let found = read(&dgp, "r.off").set.positions().values().to_vec();
    let half = DVec3::new(0.5, 0.0625, 0.0625);
    assert!(found.iter().any(|p| p.distance(half) < 1e-14), "{found:?}");
}

#[test]
fn texture_coordinates_keep_their_seams() {
    let dgp = Dgp::new(&[("t.obj", TAGGED)]);
    for rule in ["linear", "smooth"] {
        let command = format!("subdivide t.obj -o r.obj --levels 2 --face-varying {rule}");
        assert_eq!(dgp.json(&command).0, 0);
        let set = read(&dgp, "r.obj").set;
        let uv = set.corner_attributes.get::<DVec2>(UV).unwrap();
        // Each face of the cage has all of the unit square: a sixteenth of it in each of its 16 parts.
        let area = |corners: std::ops::Range<usize>| {
            let uv = &uv.values()[corners];
            (0..4).map(|i| uv[i].perp_dot(uv[(i + 1) % 4])).sum::<f64>() / 2.0
        };
        let areas: Vec<f64> = (0..96).map(|f| area(4 * f..4 * f + 4)).collect();
        assert!((areas.iter().sum::<f64>() - 6.0).abs() < 1e-12, "{rule}");
        assert!(areas.iter().all(|a| *a > 0.0), "{rule}");
        let even = areas.iter().all(|a| (a - 0.0625).abs() < 1e-14);
        assert!(even || rule == "smooth");
    }
    let (_, value) = dgp.json("convert t.obj -o tri.obj --triangulate");
    assert_eq!(value["report"]["triangulation"]["triangles"], 12);
    let (_, value) = dgp.json("subdivide tri.obj -o r.obj --scheme sqrt3");
    assert_eq!(value["report"]["left_out"], json!(["uv"]), "{value}");
}

#[test]
fn tolerances_split_where_the_surface_bends() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let (code, value) = dgp.json("subdivide cube.off -o r.off --adaptive 0.1% --picture r.png");
    let adaptive = &value["report"]["adaptive"];
    let tolerance = adaptive["tolerance"].as_f64().unwrap();
    assert!((tolerance - 3.0_f64.sqrt() / 1000.0).abs() < 1e-15, "{value}");
    assert!(adaptive["largest_deviation"].as_f64().unwrap() <= tolerance, "{value}");
    assert_eq!((code, &adaptive["faces_beyond"]), (0, &0.into()), "{value}");
    assert_eq!(value["report"]["euler_characteristic"], json!([2, 2]));
    assert_eq!(dgp.run("check r.off -q").status.code(), Some(0));
    assert_eq!(dgp.names(), ["cube.off", "r.off", "r.png"]);
    let (_, value) = dgp.json("subdivide cube.off -o r.off --adaptive 1e-9 --levels 2");
    assert_eq!(value["report"]["adaptive"]["faces_beyond"], 96);
}

#[test]
fn what_cannot_be_refined_is_refused_by_name_and_nothing_is_written() {
    let bad = |tag: &str| format!("{TAGGED}{tag}\n");
    let (blunt, far, missing) =
        (bad("t crease 2/1/0 0 1 11"), bad("t crease 2/1/0 0 6 1"), bad("t corner 1/1/0 8 1"));
    let lonely = format!("{TAGGED}v 9 9 9\n");
    let infinite = TAGGED.replace("v 1 1 1\n", "v 1 1 inf\n");
    let dgp = Dgp::new(&[
        ("cube.off", CUBE),
        ("t.obj", TAGGED),
        ("blunt.obj", &blunt),
        ("far.obj", &far),
        ("missing.obj", &missing),
        ("lonely.obj", &lonely),
        ("infinite.obj", &infinite),
    ]);
    let before = dgp.names();
    for (command, code, messages) in [
        ("cube.off --scheme loop", 1, &["f0", "4 corners", "dgp convert --triangulate"][..]),
        ("cube.off --scheme sqrt3", 1, &["f0", "√3", "dgp convert --triangulate"]),
        ("cube.off --scheme phong", 1, &["f0", "dgp convert --triangulate"]),
        ("cube.off --levels 40", 1, &["level", "bytes", "--memory-limit"]),
        ("cube.off --levels 6 --memory-limit 1M", 1, &["level", "1048576", "--memory-limit"]),
        ("t.obj --creases --scheme doo-sabin", 1, &["Doo–Sabin", "no rules for creases"]),
        ("blunt.obj --creases", 1, &["blunt.obj", "v0 to v1", "11"]),
        ("far.obj --creases", 1, &["far.obj", "v0", "v6"]),
        ("missing.obj --creases", 1, &["missing.obj", "vertex 8", "corner"]),
        ("lonely.obj", 1, &["v8", "dgp repair"]),
        ("infinite.obj", 1, &["infinite.obj"]),
        ("cube.off --scheme doo-sabin --limit", 2, &["doo-sabin", "catmull-clark"]),
        ("cube.off --scheme bilinear --adaptive 1%", 2, &["bilinear", "catmull-clark"]),
        ("cube.off --adaptive 0", 2, &["above 0"]),
        ("cube.off --adaptive -1", 2, &["-1"]),
        ("cube.off --crease-sharpness 11 --crease-angle 3", 2, &["sharp for ever"]),
        ("cube.off --crease-angle 200", 2, &["degrees"]),
        ("cube.off --memory-limit much", 2, &["512M"]),
        ("cube.off --scheme spline", 2, &["spline"]),
    ] {
        let output = dgp.run(&format!("subdivide {command} -o r.obj"));
        let message = error(&output);
        assert_eq!(output.status.code(), Some(code), "{command}: {message}");
        for part in messages {
            assert!(message.contains(part), "{command}: {part} in {message}");
        }
    }
    assert_eq!(dgp.names(), before);
}

/// The cages and levels that OpenSubdiv's authors keep, where `../shared` or `DGP_SHARED_DATA` has them.
#[test]
fn shapes_of_opensubdiv_are_matched_with_their_tags() {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("DGP_SHARED_DATA").map_or(beside, PathBuf::from);
    let folder = data.join("quads/subdiv_ref");
    if !folder.is_dir() {
        return;
    }
    let points = |path: &Path| dgp::io::read(path).unwrap().set.positions().values().to_vec();
    for (name, scheme, levels) in [
        ("catmark_cube_creases1", "catmull-clark", 3),
        ("catmark_dart_edgeonly", "catmull-clark", 3),
        ("catmark_edgecorner", "catmull-clark", 3),
        ("catmark_edgeonly", "catmull-clark", 3),
        ("loop_saddle_edgeonly", "loop", 4),
        ("loop_triangle_edgeonly", "loop", 3),
        ("bilinear_cube", "bilinear", 3),
    ] {
        let base = fs::read_to_string(folder.join(format!("{name}_base.obj"))).unwrap();
        let dgp = Dgp::new(&[("base.obj", &base)]);
        for level in 1..=levels {
            let command = format!("subdivide base.obj -o r.obj --creases --scheme {scheme}");
            let (code, value) = dgp.json(&format!("{command} --levels {level}"));
            assert_eq!((code, &value["warnings"]), (0, &json!([])), "{name}");
            let found = points(&dgp.folder().join("r.obj"));
            let expected = points(&folder.join(format!("{name}_level{}.obj", level - 1)));
            assert_eq!(found.len(), expected.len(), "{name} {level}");
            for p in &expected {
                let nearest = found.iter().map(|q| p.distance(*q)).fold(f64::INFINITY, f64::min);
                // The files have six or seven digits.
                assert!(nearest < 2e-6, "{name} {level}: {p} {nearest}");
            }
        }
    }
}
