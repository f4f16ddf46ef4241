//! `dgp sample` and `dgp voronoi`: points and meshes of them, and what is refused.

use std::fs;

use crate::folder::{CUBE, Dgp, FIN, error};

#[test]
fn points_are_spread_as_asked() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("fin.off", FIN), ("cloud.xyz", "0 0 0\n1 0 0\n")]);
    for method in ["uniform", "stratified", "blue-noise"] {
        let (code, value) =
            dgp.json(&format!("sample cube.off -o p.xyz --count 300 --method {method} --seed 5"));
        assert_eq!((code, &value["report"]["points"]), (0, &300.into()), "{method}: {value}");
        let text = fs::read_to_string(dgp.folder().join("p.xyz")).unwrap();
        let rows: Vec<Vec<f64>> = text
            .lines()
            .map(|line| line.split_whitespace().map(|x| x.parse().unwrap()).collect())
            .collect();
        assert_eq!(rows.len(), 300, "{method}");
        for row in rows {
            // A point of the cube, and a unit normal.
            assert_eq!(row.len(), 6);
            assert!(row[..3].iter().any(|x| *x == 0.0 || *x == 1.0), "{row:?}");
            assert!((row[3..].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-9, "{row:?}");
        }
    }
    let (code, value) = dgp.json("sample cube.off -o p.ply --radius 0.1 --picture p.png");
    assert_eq!((code, value["report"]["method"].as_str()), (0, Some("poisson-disk")));
    assert!(value["report"]["least_distance"].as_f64().unwrap() >= 0.1, "{value}");
    assert!(value["report"]["coverage"].as_f64().unwrap() < 0.10001, "{value}");
    assert_eq!(value["output"]["vertices"], value["report"]["points"]);
    assert!(dgp.folder().join("p.png").exists());
    // A soup has a surface too; the same seed gives the same bytes, another does not.
    let bytes = |seed: u64, name: &str| {
        let output = dgp.run(&format!("sample fin.off -o {name} --count 50 --seed {seed} -q"));
        assert!(output.status.success(), "{}", error(&output));
        fs::read(dgp.folder().join(name)).unwrap()
    };
    assert_eq!(bytes(1, "a.ply"), bytes(1, "b.ply"));
    assert_ne!(bytes(1, "a.ply"), bytes(2, "b.ply"));
    for (command, code, message) in [
        ("sample cube.off -o q.ply", 2, "--count"),
        ("sample cube.off -o q.ply --count 5 --radius 1", 2, "--radius"),
        ("sample cube.off -o q.ply --radius 1 --method uniform", 2, "--method"),
        ("sample cube.off -o q.ply --radius 0", 1, "radius"),
        ("sample cube.off -o q.ply --radius 1e-9", 1, "radius"),
        ("sample cloud.xyz -o q.ply --count 5", 1, "no area"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
    assert!(!dgp.names().contains(&"q.ply".to_owned()));
}

#[test]
fn voronoi_gives_a_mesh_of_so_many_vertices() {
    let dgp = Dgp::new(&[("cube.off", CUBE), ("fin.off", FIN)]);
    let (code, value) = dgp.json("voronoi cube.off -o v.ply --vertices 200 --picture v.png");
    assert_eq!((code, &value["report"]["vertices"]), (0, &serde_json::json!([8, 200])), "{value}");
    assert_eq!(value["report"]["topology_kept"], true);
    assert!(value["report"]["minimum_angle"].as_f64().unwrap() > 15.0, "{value}");
    assert_eq!(dgp.run("check v.ply -q").status.code(), Some(0));
    let (_, info) = dgp.json("info v.ply");
    assert_eq!(
        (&info["report"]["vertices"], &info["report"]["closed"]),
        (&200.into(), &true.into())
    );
    for options in ["--vertices 1000% --sharp", "--vertices 50 --gradation 1.5 --resolution 50"] {
        let (code, value) = dgp.json(&format!("voronoi cube.off -o v.ply {options}"));
        assert_eq!(code, 0, "{options}: {value}");
        assert_eq!(dgp.run("check v.ply -q").status.code(), Some(0), "{options}");
    }
    for (command, code, message) in [
        ("voronoi cube.off -o q.ply", 2, "--vertices"),
        ("voronoi cube.off -o q.ply --vertices -3", 2, "--vertices"),
        ("voronoi cube.off -o q.ply --vertices 0", 1, "vertices"),
        ("voronoi cube.off -o q.ply --vertices 9 --resolution 1", 1, "resolution"),
        ("voronoi fin.off -o q.ply --vertices 9", 1, "repair"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
    assert!(!dgp.names().contains(&"q.ply".to_owned()));
}
