//! `dgp repair` and what `dgp check` says before and after.

use std::fmt::Write;

use crate::folder::{CUBE, Dgp, FIN, error};

/// A grid in the plane z = 0, and a needle of triangles through one of its cells.
fn pierced() -> String {
    const N: usize = 12;
    let mut text = format!("OFF\n{} {} 0\n", (N + 1) * (N + 1) + 4, N * N + 4);
    for k in 0..(N + 1) * (N + 1) {
        let _ = writeln!(text, "{} {} 0", k % (N + 1), k / (N + 1));
    }
    text += "5.2 5.3 -1\n5.8 5.3 -1\n5.4 5.7 -1\n5.5 5.5 1\n";
    for k in 0..N * N {
        let a = k / N * (N + 1) + k % N;
        let _ = writeln!(text, "4 {a} {} {} {}", a + 1, a + N + 2, a + N + 1);
    }
    let p = (N + 1) * (N + 1);
    for [a, b, c] in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        let _ = writeln!(text, "3 {} {} {}", p + a, p + b, p + c);
    }
    text
}

/// One triangle above an edge, two below it that meet in its middle.
const JUNCTION: &str =
    "OFF\n7 3 0\n0 0 0\n2 0 0\n1 2 0\n0 0 0\n1 0 0\n2 0 0\n1 -2 0\n3 0 1 2\n3 4 3 6\n3 5 4 6\n";

/// Two tetrahedra in each other.
const STARS: &str = "OFF\n8 8 0\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n0.1 0.2 -1\n3.1 0.3 0.5\n0.2 3.3 0.4\n0.3 0.1 2.4\n\
    3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 4 6 5\n3 4 5 7\n3 5 6 7\n3 6 4 7\n";

#[test]
fn what_passes_through_itself_is_found_and_cut() {
    let pierced = pierced();
    let dgp = Dgp::new(&[("pierced.off", pierced.as_str())]);
    let (code, value) = dgp.json("check pierced.off");
    let defect = &value["report"]["defects"][0];
    assert_eq!((code, defect["kind"].as_str()), (1, Some("self_intersection")), "{value}");
    assert_eq!(defect["element_kind"], "face, face");
    assert_eq!(dgp.run("check pierced.off --skip-intersections").status.code(), Some(0));
    let (code, value) = dgp.json("repair pierced.off -o mended.ply");
    assert_eq!(code, 0, "{value}");
    assert!(value["report"]["intersections"]["removed_faces"].as_u64() > Some(0), "{value}");
    assert_eq!(dgp.run("check mended.ply").status.code(), Some(0));
    // Again there is nothing to do.
    let (_, value) = dgp.json("repair mended.ply -o again.ply");
    assert_eq!(value["report"]["changes"].as_array().map(Vec::len), Some(0), "{value}");
    // Left where that is asked for.
    let (code, value) = dgp.json("repair pierced.off -o kept.ply --intersections keep");
    assert_eq!((code, value["output"]["faces"].as_u64()), (0, Some(148)));
}

#[test]
fn junctions_are_joined_step_by_step() {
    let dgp = Dgp::new(&[("junction.off", JUNCTION)]);
    let (code, value) = dgp.json("repair junction.off -o mended.off");
    let changes = value["report"]["changes"].as_array().unwrap();
    let count = |action: &str| {
        changes.iter().find(|c| c["action"] == action).and_then(|c| c["count"].as_u64())
    };
    assert_eq!(code, 0);
    assert_eq!((count("split_edges_at_junctions"), count("join_edges")), (Some(1), Some(2)));
    assert_eq!(
        (value["output"]["vertices"].as_u64(), value["output"]["faces"].as_u64()),
        (Some(5), Some(4))
    );
    let output = dgp.run("repair junction.off -o same.off --stitch none --intersections keep");
    assert!(String::from_utf8_lossy(&output.stdout).contains("nothing to repair"));
    let (_, value) = dgp.json("repair junction.off -o minimal.off --minimal");
    assert_eq!(value["report"]["changes"].as_array().map(Vec::len), Some(0));
}

#[test]
fn what_cannot_be_mended_is_refused_with_faces_and_remedy() {
    let dgp = Dgp::new(&[("stars.off", STARS)]);
    let output = dgp.run("repair stars.off -o out.off");
    let message = error(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in ["stars.off", "f0 with f", "--max-removed", "--intersections keep"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    assert_eq!(dgp.names(), ["stars.off"]);
}

#[test]
fn holes_slivers_and_components_go_as_asked() {
    let open = CUBE.replace("8 6 0", "8 5 0").replace("4 3 0 4 7\n", "");
    let dgp = Dgp::new(&[("open.off", open.as_str()), ("fin.off", FIN)]);
    let (code, value) = dgp.json("repair open.off -o closed.off --fill-holes");
    assert_eq!((code, value["output"]["faces"].as_u64()), (0, Some(7)));
    let (_, value) = dgp.json("repair open.off -o open.ply --fill-holes 3");
    assert_eq!(value["output"]["faces"], 5);
    let (_, value) = dgp.json("repair fin.off -o one.off --keep-largest");
    assert_eq!(value["output"]["faces"], 2);
    let (_, value) = dgp.json("repair fin.off -o area.off --drop-area 40");
    assert_eq!(value["output"]["faces"], 2);
    for wrong in ["--needles 0.5", "--caps 80", "--max-removed 120", "--stitch far", "--orient up"]
    {
        let output = dgp.run(&format!("repair fin.off -o x.off {wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}: {}", error(&output));
    }
}
