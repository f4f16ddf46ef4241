//! Questions about elements, edits, distances, polygons to triangles.

use serde_json::{Value, json};

use super::folder::{CUBE, Dgp, FIN, error};

/// Two triangles with a seam of texture coordinates between them, and a color a vertex.
const SQUARE: &str = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 5 5\nf 1/1 2/2 3/3\nf 1/5 3/3 4/4\n";

/// A square of one quad, beside it a triangle that it does not touch.
const ISLANDS: &str =
    "OFF\n7 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n5 0 0\n6 0 0\n5 1 0\n4 0 1 2 3\n3 4 5 6\n";

fn numbers(value: &Value) -> Vec<u64> {
    value.as_array().unwrap().iter().map(|x| x.as_u64().unwrap()).collect()
}

/// From its smallest entry on.
fn turned(value: &Value) -> Vec<u64> {
    let mut ring = numbers(value);
    let least = ring.iter().enumerate().min_by_key(|(_, x)| **x).map_or(0, |(i, _)| i);
    ring.rotate_left(least);
    ring
}

#[test]
fn what_is_around_elements_is_told_in_order() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let (code, value) =
        dgp.json("info cube.off --vertex 0 --vertex v6 --face 1 --edge 0,1 --adjacent 0,2 --loops");
    assert_eq!(code, 0);
    let queries = &value["report"]["queries"];
    // Seen from outside, counterclockwise: below, at the front, on the left.
    assert_eq!(turned(&queries["vertex"][0]["neighbors"]), [1, 4, 3]);
    assert_eq!(turned(&queries["vertex"][0]["faces"]), [0, 2, 5]);
    assert_eq!(queries["vertex"][1]["position"], json!([1.0, 1.0, 1.0]));
    assert_eq!(queries["face"][0]["vertices"], json!([4, 5, 6, 7]));
    assert_eq!(queries["face"][0]["normal"], json!([0.0, 0.0, 1.0]));
    assert_eq!(queries["face"][0]["area"], 1.0);
    let edge = &queries["edge"][0];
    assert_eq!(
        (&edge["length"], &edge["left_face"], &edge["right_face"]),
        (&1.0.into(), &2.into(), &0.into())
    );
    assert_eq!(queries["adjacent"][0]["adjacent"], false);
    assert_eq!(queries["adjacent"][0]["common_faces"], json!([0]));
    assert_eq!(queries["loops"], json!([]));
    assert!(dgp.json("info cube.off").1["report"]["queries"].is_null());
}

#[test]
fn loops_are_listed_with_their_lengths() {
    let dgp = Dgp::new(&[("islands.off", ISLANDS)]);
    let (_, value) = dgp.json("info islands.off --loops");
    let loops = &value["report"]["queries"]["loops"];
    assert_eq!(loops.as_array().unwrap().len(), 2);
    assert_eq!((&loops[0]["edges"], &loops[0]["length"]), (&4.into(), &4.0.into()));
    assert_eq!(turned(&loops[0]["vertices"]), [0, 3, 2, 1]);
}

#[test]
fn data_are_interpolated_at_a_point_of_a_triangle() {
    let dgp = Dgp::new(&[("square.obj", SQUARE)]);
    let (code, value) =
        dgp.json("info square.obj --at 0,1,1,2 --locate 1,0.25,0.5,3 --locate f0,-1,0,0");
    assert_eq!(code, 0);
    let queries = &value["report"]["queries"];
    let at = &queries["at"][0];
    assert_eq!(at["position"], json!([0.75, 0.5, 0.0]));
    assert_eq!(at["attributes"]["color"], json!([0.25, 0.25, 0.5, 1.0]));
    assert_eq!(at["corner_attributes"]["uv"], json!([0.75, 0.5]));
    assert_eq!(at["location"], "inside");
    let [inside, outside] = [0, 1].map(|i| &queries["locate"][i]);
    assert_eq!(inside["coordinates"], json!([0.5, 0.25, 0.25]));
    assert_eq!(
        (&inside["distance_to_plane"], &inside["location"]),
        (&3.0.into(), &"inside".into())
    );
    assert_eq!((&outside["location"], &outside["attributes"]), (&"outside".into(), &Value::Null));
}

#[test]
fn elements_that_are_not_there_are_named() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("fin.off", FIN), ("square.obj", SQUARE)]);
    for (arguments, code, words) in [
        ("info cube.off --vertex 8", 1, "no vertex 8"),
        ("info cube.off --face 6", 1, "no face 6"),
        ("info cube.off --edge 0,6", 1, "no edge joins v0 and v6"),
        ("info cube.off --at 0,1,1,1", 1, "f0 has 4 corners"),
        ("info fin.off --vertex 0", 1, "repair"),
        ("info square.obj --at 0,0,0,0", 2, "positive"),
        ("info square.obj --edge 0", 2, "2 vertex numbers"),
        ("info square.obj --vertex x", 2, "no vertex"),
        ("geodesic cube.off --from 9", 1, "no vertex 9"),
        ("geodesic cube.off --from 1 --method astar", 2, "--to"),
        ("edit cube.off -o out.off", 2, "no edit"),
        ("edit cube.off -o out.off --split 0,1,2", 2, "0 to 1"),
    ] {
        let output = dgp.run(arguments);
        let message = error(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments}: {message}");
        assert!(message.contains(words), "{arguments}: {message}");
    }
}

#[test]
fn polygons_become_triangles_by_each_method() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("fin.off", FIN)]);
    for method in ["fan", "ear", "optimal", "least-area"] {
        let (code, value) =
            dgp.json(&format!("convert cube.off -o out.off --triangulate {method}"));
        assert_eq!(code, 0);
        let report = &value["report"]["triangulation"];
        assert_eq!((&report["faces_cut"], &report["triangles"]), (&6.into(), &12.into()));
        assert_eq!((&report["method"], &report["surface"]), (&method.into(), &"manifold".into()));
        let facts = dgp.json("info out.off").1;
        let facts = &facts["report"];
        assert_eq!((&facts["triangles"], &facts["volume"]), (&12.into(), &1.0.into()), "{method}");
    }
    let (code, value) = dgp.json("convert fin.off -o out.off --triangulate");
    assert_eq!((code, &value["report"]["triangulation"]["faces_cut"]), (0, &0.into()));
}

#[test]
fn distances_are_written_and_what_is_out_of_reach_is_said() {
    let dgp = Dgp::new(&[("islands.off", ISLANDS)]);
    let (code, value) = dgp.json("geodesic islands.off --from 0 --to 2 -o out.ply");
    let report = &value["report"];
    assert_eq!((code, &report["reached"]), (0, &4.into()));
    assert_eq!(report["unreachable"], json!([4, 5, 6]));
    assert_eq!(report["farthest"], json!({"vertex": 2, "distance": 2.0}));
    assert_eq!(report["path"]["length"], 2.0);
    assert_eq!(numbers(&report["path"]["vertices"]).len(), 3);
    assert!(value["warnings"][0].as_str().unwrap().contains("3 vertices"));
    let (_, value) = dgp.json("info out.ply --vertex 2 --vertex 4");
    let [at_2, at_4] = [0, 1].map(|i| &value["report"]["queries"]["vertex"][i]["attributes"]);
    assert_eq!((&at_2["distance"], &at_2["on_path"]), (&2.0.into(), &1.into()));
    // JSON has no infinity.
    assert_eq!((&at_4["distance"], &at_4["on_path"]), (&Value::Null, &0.into()));
    assert!(at_4["color"].is_array());
    let output = dgp.run("geodesic islands.off --from 0 --to 5 -o none.ply");
    assert_eq!(output.status.code(), Some(1));
    assert!(error(&output).contains("leads from v0 to v5"), "{}", error(&output));
    assert!(!dgp.names().contains(&"none.ply".to_owned()));
}

#[test]
fn both_searches_find_paths_of_the_same_length() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let found = ["dijkstra", "astar"].map(|method| {
        let (code, value) =
            dgp.json(&format!("geodesic cube.off --from 0 --to 6 --method {method}"));
        assert_eq!(code, 0);
        value["report"]["path"]["length"].clone()
    });
    assert_eq!(found, [3.0, 3.0]);
    let (_, value) = dgp.json("geodesic cube.off --from 0,6");
    assert_eq!(value["report"]["farthest"]["distance"], 1.0);
}

#[test]
fn edits_are_done_in_the_order_given() {
    let dgp = Dgp::new(&[("square.obj", SQUARE)]);
    let arguments = "edit square.obj -o out.obj --flip 0,2 --split 1,3 --remove-face 0";
    let (code, value) = dgp.json(arguments);
    assert_eq!(code, 0);
    let report = &value["report"];
    assert_eq!(report["edits"][0]["edit"], "flip");
    assert_eq!(report["edits"][1]["new_vertices"], json!([4]));
    assert_eq!(report["edits"][1]["new_faces"], json!([2, 3]));
    assert_eq!(report["edits"][2]["removed_faces"], json!([0]));
    assert_eq!(report["old_to_new"]["faces"], json!([null, 0, 1, 2]));
    assert!(report["old_to_new"]["vertices"].is_null(), "no vertex moved");
    let (_, value) = dgp.json("info out.obj --vertex 4");
    let middle = &value["report"]["queries"]["vertex"][0];
    assert_eq!((&value["report"]["faces"], &middle["valence"]), (&3.into(), &4.into()));
    assert_eq!(middle["position"], json!([0.5, 0.5, 0.0]));
    // The other way round the diagonal is not there yet.
    let output = dgp.run("edit square.obj -o none.obj --split 1,3 --flip 0,2");
    let message = error(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("edit 1, --split 1,3") && message.contains("no edge"), "{message}");
    assert!(!dgp.names().contains(&"none.obj".to_owned()));
}

#[test]
fn every_edit_can_be_asked_for() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("square.obj", SQUARE)]);
    for (file, edits, counts) in [
        ("square.obj", "--flip 0,2", (4, 2)),
        ("square.obj", "--split 0,2,0.25", (5, 4)),
        ("square.obj", "--insert 0,1", (5, 2)),
        ("square.obj", "--split 0,2 --collapse 4,0", (4, 2)),
        ("square.obj", "--split 0,2 --collapse 4,0,0.5", (4, 2)),
        ("cube.off", "--split-face 0", (9, 9)),
        ("cube.off", "--split-face f0,0.25,0.5,0", (9, 9)),
        ("cube.off", "--cut 0,2", (8, 7)),
        ("cube.off", "--cut 0,2 --merge 0,2", (8, 6)),
        ("cube.off", "--split-face 0 --merge-vertex 8", (8, 6)),
        ("cube.off", "--remove-face 0 --add-face 0,3,2,1", (8, 6)),
        ("cube.off", "--remove-faces 0,1 --add-vertex -1,0,0", (9, 4)),
        ("cube.off", "--remove-vertex 0", (7, 3)),
        ("cube.off", "--add-vertex 2,0,0 --remove-isolated", (8, 6)),
        ("cube.off", "--reverse --reorder", (8, 6)),
    ] {
        let (code, value) = dgp.json(&format!("edit {file} {edits} -o out.ply"));
        assert_eq!(code, 0, "{edits}");
        let output = &value["output"];
        let expected: (Value, Value) = (counts.0.into(), counts.1.into());
        assert_eq!((&output["vertices"], &output["faces"]), (&expected.0, &expected.1), "{edits}");
        assert_eq!(dgp.json("info out.ply").1["report"]["manifold"], true, "{edits}");
    }
    let (_, value) = dgp.json("edit cube.off --reverse -o out.ply");
    assert_eq!(value["report"]["edits"][0]["edit"], "reverse");
    assert_eq!(dgp.json("info out.ply").1["report"]["volume"], -1.0);
}

#[test]
fn refused_edits_say_why_and_write_nothing() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("square.obj", SQUARE)]);
    for (arguments, words) in [
        ("edit square.obj -o out.obj --flip 0,1", "lies at the boundary"),
        ("edit square.obj -o out.obj --collapse 0,2", "boundary"),
        ("edit cube.off -o out.off --add-face 0,1,2,3", "belongs to"),
        ("edit cube.off -o out.off --remove-vertex 0 --split-face 0", "was removed"),
        ("edit cube.off -o out.off --cut 0,6", "not corners of one face"),
        ("edit cube.off -o out.off --merge-vertex 9", "v9"),
    ] {
        let output = dgp.run(arguments);
        let message = error(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
        assert!(message.contains(words), "{arguments}: {message}");
    }
    assert_eq!(dgp.names(), ["cube.off", "square.obj"]);
}
