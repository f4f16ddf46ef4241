//! Matrices, heat, correspondence, systems from files, shapes and Euler's consequences.

use std::fs;

use dgp::{mesh::shapes, sparse::SparseMatrix};
use serde_json::Value;

use crate::{
    folder::{CUBE, Dgp, FIN, error},
    spectra::off,
};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn matrix(dgp: &Dgp, name: &str) -> SparseMatrix {
    let text = fs::read_to_string(dgp.folder().join(name)).unwrap();
    SparseMatrix::from_matrix_market(&text).unwrap()
}

#[test]
fn the_laplacian_is_written_bit_for_bit_and_checked() {
    let mesh = shapes::with_noise(shapes::icosphere(2).unwrap(), 0.1, 1).unwrap();
    let dgp = Dgp::new(&[("s.off", &off(&mesh))]);
    let (code, value) = dgp.json("laplacian s.off -o l.mtx --mass-output m.mtx --mass consistent");
    assert_eq!(code, 0, "{value}");
    let expected = dgp::laplace::laplacian::cotangent_laplacian(&mesh).unwrap();
    assert_eq!(matrix(&dgp, "l.mtx"), expected);
    let mass: f64 = matrix(&dgp, "m.mtx").values().iter().sum();
    let area = dgp::mesh::measure::area(&mesh);
    assert!((mass / area - 1.0).abs() < 1e-12, "{mass} {area}");
    let report = &value["report"];
    assert!((number(&report["mass"]["total"]) / area - 1.0).abs() < 1e-12);
    assert_eq!(report["checks"]["asymmetry"], 0.0);
    assert_eq!(report["checks"]["edges"], mesh.edge_count());
    assert!(number(&report["checks"]["row_sum_error"]) < 1e-13);
    assert_eq!(value["output"]["entries"], expected.entries());
}

#[test]
fn every_kind_of_laplacian_is_made_of_what_it_needs() {
    let sphere = off(&shapes::icosphere(3).unwrap());
    let dgp = Dgp::new(&[("s.off", &sphere), ("fin.off", FIN), ("cube.off", CUBE)]);
    let kinds = [
        "uniform",
        "cotan",
        "mean-value",
        "intrinsic",
        "tufted",
        "point-cloud",
        "gaussian",
        "heat",
    ];
    for kind in kinds {
        let (code, value) = dgp.json(&format!("laplacian s.off --kind {kind}"));
        assert_eq!(code, 0, "{kind}: {value}");
        let checks = &value["report"]["checks"];
        assert!(number(&checks["row_sum_error"]) < 1e-12, "{kind}: {checks}");
        assert_eq!(number(&checks["asymmetry"]) > 0.0, kind == "mean-value", "{kind}: {checks}");
        // All angles of the icosphere are below 90°; what is zero may be so up to rounding.
        assert!(number(&checks["least_weight"]) > -1e-12, "{kind}: {checks}");
    }
    let (code, value) = dgp.json("laplacian fin.off --kind tufted");
    assert_eq!((code, &value["report"]["intrinsic"]["triangles"]), (0, &6.into()), "{value}");
    for (command, code, message) in [
        ("laplacian fin.off", 1, "edge"),
        ("laplacian cube.off", 1, "triang"),
        ("laplacian s.off --kind tufted --mass mixed", 2, "--mass"),
        ("laplacian s.off --kind gaussian --coordinates c.ply", 2, "--coordinates"),
        ("laplacian s.off --kind heat --time 0", 1, "positive"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
    assert_eq!(dgp.names(), ["cube.off", "fin.off", "s.off"], "nothing is written on the way");
}

#[test]
fn normalized_rows_have_ones_and_coordinates_lead_back() {
    // Two components and a vertex of no face: each has to be held.
    let mut text = off(&shapes::icosphere(2).unwrap()).replace("OFF\n162 320", "OFF\n166 321");
    let at = text.find("\n3 ").unwrap();
    text.insert_str(at, "\n5 0 0\n6 0 0\n5 1 0\n9 9 9");
    text += "3 162 163 164\n";
    let dgp = Dgp::new(&[("s.off", &text)]);
    let (code, _) = dgp.json("laplacian s.off --kind uniform --normalize rows -o walk.mtx");
    assert_eq!(code, 0);
    let walk = matrix(&dgp, "walk.mtx");
    assert!(walk.diagonal()[..165].iter().all(|d| *d == 1.0) && walk.diagonal()[165] == 0.0);
    for kind in ["uniform", "cotan", "mean-value"] {
        let command = format!("laplacian s.off --kind {kind} --coordinates d.ply");
        let (code, value) = dgp.json(&command);
        assert_eq!(code, 0, "{kind}: {value}");
        let back = &value["report"]["coordinates"];
        assert_eq!(back["fixed_vertices"], 3, "{kind}");
        // Mean values are solved by least squares, which loses half the digits.
        let tolerance = if kind == "mean-value" { 1e-8 } else { 1e-12 };
        assert!(number(&back["largest_error"]) < tolerance, "{kind}: {back}");
    }
    let (_, info) = dgp.json("info d.ply");
    let names = info["report"]["attributes"]["vertex"].to_string();
    assert!(names.contains("differential_coordinates"), "{names}");
}

#[test]
fn heat_spreads_and_none_is_lost() {
    let dgp = Dgp::new(&[("s.off", &off(&shapes::icosphere(3).unwrap()))]);
    let command = "heat s.off --from 3,v40 -o h.ply --picture h.png --csv h.csv --steps 5";
    let (code, value) = dgp.json(command);
    assert_eq!(code, 0, "{value}");
    let steps = &value["report"]["values"][0];
    assert!((number(&steps["total"]) - 2.0).abs() < 1e-12 && number(&steps["least"]) > 0.0);
    assert_eq!(dgp.names(), ["h.csv", "h.ply", "h.png", "s.off"]);
    // After a long time both ways of spreading have the same heat everywhere: 2 over the area.
    for method in ["steps", "kernel"] {
        let command = format!("heat s.off --from 3,40 --method {method} --time 1e5 --count 10");
        let (_, value) = dgp.json(&command);
        let last = &value["report"]["values"][0];
        let (least, most) = (number(&last["least"]), number(&last["largest"]));
        assert!(most / least - 1.0 < 1e-3, "{method}: {least} {most}");
        assert!((number(&last["total"]) - 2.0).abs() < 1e-9, "{method}: {last}");
    }
    for (command, code, message) in [
        ("heat s.off", 2, "--from"),
        ("heat s.off --from 642", 1, "642"),
        ("heat s.off --from 0 --time 0", 1, "time"),
        ("heat s.off --signature 0", 1, "count"),
        ("heat s.off --signature --from 1", 2, "cannot be used"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
}

#[test]
fn signatures_of_a_sphere_are_the_same_everywhere() {
    let dgp = Dgp::new(&[("s.off", &off(&shapes::icosphere(3).unwrap()))]);
    let command = "heat s.off --signature 4 --count 49 -o h.ply --picture h.png --csv h.csv";
    let (code, value) = dgp.json(command);
    assert_eq!(code, 0, "{value}");
    let values = value["report"]["values"].as_array().unwrap();
    assert_eq!(values.len(), 4);
    let times: Vec<f64> = values.iter().map(|v| number(&v["time"])).collect();
    assert!(times.windows(2).all(|t| t[0] < t[1]), "{times:?}");
    for signature in &values[1..] {
        let (least, most) = (number(&signature["least"]), number(&signature["largest"]));
        assert!(most / least - 1.0 < 0.02, "{signature}");
    }
    let text = fs::read_to_string(dgp.folder().join("h.csv")).unwrap();
    assert!(text.starts_with("vertex,heat_signature_0,") && text.lines().count() == 643);
}

#[test]
fn a_moved_and_renumbered_shape_finds_its_own_points() {
    let mesh = shapes::blob(3).unwrap();
    let mut other = dgp::mesh::Mesh::new(&shapes::shuffled(&mesh.to_indexed(), 5)).unwrap();
    let renumbered = other.clone();
    other.set_positions(other.positions().map(|p| 2.0 * dgp::mesh::DVec3::new(-p.y, p.x, p.z)));
    let dgp = Dgp::new(&[("a.off", &off(&mesh)), ("b.off", &off(&other))]);
    let command = "correspond a.off b.off -o c.ply --first-output a.ply --csv c.csv --matrix c.txt \
                   --picture c.png --count 30";
    let (code, value) = dgp.json(command);
    assert_eq!(code, 0, "{value}");
    let report = &value["report"];
    assert_eq!(report["waves"], 30);
    assert!(number(&report["orthogonality_defect"]) < 1e-6, "{report}");
    let text = fs::read_to_string(dgp.folder().join("c.csv")).unwrap();
    for line in text.lines().skip(1) {
        let (w, v) = line.split_once(',').unwrap();
        let [w, v] = [w, v].map(|n| dgp::mesh::VertexId::new(n.parse().unwrap()));
        assert_eq!(mesh.position(v), renumbered.position(w), "{line}");
    }
    let matrix = fs::read_to_string(dgp.folder().join("c.txt")).unwrap();
    assert_eq!(matrix.lines().count(), 31);
    assert_eq!(dgp.names(), ["a.off", "a.ply", "b.off", "c.csv", "c.ply", "c.png", "c.txt"]);
    let (_, info) = dgp.json("info c.ply");
    assert!(info["report"]["attributes"]["vertex"].to_string().contains("corresponds_to"));
    let (code, _) = dgp.json("correspond a.off b.off --landmark 0,1 --count 8 --start 4");
    assert_eq!(code, 0);
    for (command, code, message) in [
        ("correspond a.off b.off --start 0", 2, "--start"),
        ("correspond a.off b.off --landmark 9999,0", 1, "a.off"),
        ("correspond a.off b.off --landmark 0,9999", 1, "b.off"),
        ("correspond a.off b.off --count 100000", 1, "count"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
}

/// −1 2 −1 with ends held: a straight line.
const CHAIN: &str = "%%MatrixMarket matrix coordinate real symmetric\n4 4 7\n1 1 1\n2 2 2\n3 3 2\n4 4 1\n\
    2 1 -1\n3 2 -1\n4 3 -1\n";

#[test]
fn systems_of_files_are_solved_by_every_method() {
    let tall =
        "%%MatrixMarket matrix coordinate real general\n3 2 5\n1 1 1\n2 1 1\n3 1 1\n2 2 1\n3 2 2\n";
    let plus = CHAIN.replace("1 1 1", "1 1 2").replace("4 4 1\n", "4 4 2\n");
    let files = [
        ("chain.mtx", CHAIN),
        ("plus.mtx", plus.as_str()),
        ("tall.mtx", tall),
        ("zero.csv", "0\n0\n0\n0\n"),
        ("two.csv", "a,b\n1,0\n0,0\n0,0\n0,5\n"),
        ("three.csv", "0\n1\n1\n"),
    ];
    let dgp = Dgp::new(&files);
    let numbers = |name: &str| -> Vec<f64> {
        let text = fs::read_to_string(dgp.folder().join(name)).unwrap();
        let words = text.lines().skip(1).flat_map(|line| line.split(','));
        words.map(|word| word.parse().unwrap()).collect()
    };
    let (code, _) = dgp.json("solve chain.mtx --rhs zero.csv --fix 0=1,3=7 -o x.csv");
    assert_eq!(code, 0);
    let x = numbers("x.csv");
    assert!(x.iter().zip([1.0, 3.0, 5.0, 7.0]).all(|(x, y)| (x - y).abs() < 1e-14), "{x:?}");
    for method in ["cholesky", "lu", "cg"] {
        let command = format!("solve plus.mtx --rhs two.csv -o x.csv --method {method}");
        let (code, value) = dgp.json(&command);
        assert_eq!(code, 0, "{method}: {value}");
        // A⁻¹ of −1 2 −1 has entries min(i, j)(5 − max(i, j))/5.
        let exact = [0.8, 1.0, 0.6, 2.0, 0.4, 3.0, 0.2, 4.0];
        let x = numbers("x.csv");
        assert!(x.iter().zip(exact).all(|(x, y)| (x - y).abs() < 1e-9), "{method}: {x:?}");
        assert!(number(&value["report"]["residuals"][1]) < 1e-9);
    }
    let (code, _) = dgp.json("solve tall.mtx --rhs three.csv --method least-squares -o x.csv");
    assert_eq!(code, 0);
    let x = numbers("x.csv");
    assert!((x[0] - 1.0 / 6.0).abs() < 1e-14 && (x[1] - 0.5).abs() < 1e-14, "{x:?}");
    let (code, value) = dgp.json("solve chain.mtx --eigenvalues 2 -o v.csv");
    assert_eq!((code, &value["report"]["zero_eigenvalues"]), (0, &1.into()));
    let expected = 2.0 - 2.0_f64.sqrt();
    assert!((number(&value["report"]["eigenvalues"][1]) - expected).abs() < 1e-12);
    for (command, code, message) in [
        ("solve chain.mtx --rhs zero.csv", 1, "chain.mtx"),
        ("solve chain.mtx --rhs three.csv", 2, "4 lines"),
        ("solve chain.mtx", 2, "--rhs"),
        ("solve none.mtx --rhs zero.csv", 1, "none.mtx"),
        ("solve zero.csv --rhs zero.csv", 1, "MatrixMarket"),
        ("solve plus.mtx --rhs two.csv --method lu --fix 0=1", 2, "--fix"),
        ("solve plus.mtx --rhs two.csv --fix 9=1", 1, "9"),
        ("solve chain.mtx --eigenvalues 9", 1, "9"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
}

#[test]
fn equations_beside_a_system_hold_exactly_or_as_their_weights_demand() {
    let ends = "%%MatrixMarket matrix coordinate real general\n2 4 2\n1 1 1\n2 4 1\n";
    let files = [
        ("chain.mtx", CHAIN),
        ("ends.mtx", ends),
        ("zero.csv", "0\n0\n0\n0\n"),
        ("two.csv", "0,0\n0,0\n0,0\n0,0\n"),
        ("d.csv", "1\n7\n"),
        ("w.csv", "3\n3\n"),
    ];
    let dgp = Dgp::new(&files);
    let column = |of: usize| -> Vec<f64> {
        let text = fs::read_to_string(dgp.folder().join("x.csv")).unwrap();
        text.lines().skip(1).map(|line| line.split(',').nth(of).unwrap().parse().unwrap()).collect()
    };
    let close = |x: &[f64], y: [f64; 4]| x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-13);
    let (code, value) =
        dgp.json("solve chain.mtx --rhs zero.csv --equations ends.mtx --targets d.csv -o x.csv");
    assert_eq!(code, 0, "{value}");
    assert!(close(&column(0), [1.0, 3.0, 5.0, 7.0]), "{:?}", column(0));
    // What holds the ends is the slope.
    let force = number(&value["report"]["multipliers"][0][0]).abs();
    assert!((force - 2.0).abs() < 1e-13, "{value}");
    // Three springs of stiffness 1 between two of stiffness w: the slope is 6 / (3 + 2/w).
    for (weights, slope) in [("3", 18.0 / 11.0), ("w.csv", 18.0 / 11.0), ("1", 1.2)] {
        let command = format!(
            "solve chain.mtx --rhs two.csv --equations ends.mtx --targets d.csv -o x.csv --weights {weights}"
        );
        let (code, value) = dgp.json(&command);
        assert_eq!(code, 0, "{value}");
        let exact = [4.0 - 1.5 * slope, 4.0 - 0.5 * slope, 4.0 + 0.5 * slope, 4.0 + 1.5 * slope];
        assert!(close(&column(0), exact) && close(&column(1), exact), "{:?}", column(0));
        let off = number(&value["report"]["equations_off_by"][0]);
        assert!((off - (3.0 - 1.5 * slope)).abs() < 1e-13, "{value}");
    }
    for (command, code, message) in [
        ("solve chain.mtx --rhs zero.csv --equations ends.mtx --method lu", 2, "--equations"),
        ("solve chain.mtx --rhs zero.csv --equations ends.mtx --fix 0=1", 2, "--fix"),
        ("solve chain.mtx --rhs zero.csv --equations ends.mtx --weights -1", 1, "weights"),
        ("solve chain.mtx --rhs zero.csv --equations ends.mtx --weights none.csv", 1, "none.csv"),
        ("solve chain.mtx --rhs zero.csv --equations ends.mtx --targets two.csv", 2, "2 lines"),
        ("solve chain.mtx --rhs zero.csv --targets d.csv", 2, "--equations"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
}

#[test]
fn shapes_are_made_and_euler_tells_what_they_are() {
    let dgp = Dgp::new(&[]);
    for (shape, faces, regular, planar) in [
        ("cube", 6, true, true),
        ("dodecahedron", 12, true, true),
        ("goldberg 2 1", 72, false, true),
        ("truncated-icosahedron", 32, false, true),
        ("geodesic-sphere 2 0", 80, false, true),
        ("icosphere 1", 80, false, true),
        ("torus 2 1 8 6", 96, false, false),
        ("grid 3 2", 12, false, true),
    ] {
        let (code, value) = dgp.json(&format!("shape {shape} -o s.off"));
        assert_eq!((code, &value["report"]["faces"]), (0, &faces.into()), "{shape}");
        let (code, value) = dgp.json("info s.off --euler");
        assert_eq!(code, 0, "{shape}: {value}");
        let euler = &value["report"]["euler"];
        assert_eq!(euler["regular"].is_object(), regular, "{shape}: {euler}");
        assert_eq!(euler["planar"], planar, "{shape}: {euler}");
        assert_eq!(euler["obstruction"].is_object(), !planar, "{shape}");
        if euler["trivalent"] == true {
            assert_eq!(euler["surplus"], 12, "{shape}: {euler}");
        }
        if planar {
            assert!(number(&euler["colors"]) <= 6.0 && number(&euler["five_colors"]) <= 5.0);
        }
    }
    let text = String::from_utf8(dgp.run("info s.off --euler").stdout).unwrap();
    assert!(text.contains("planar edges") && text.contains("V − E + F"), "{text}");
    let (_, a) = dgp.json("shape icosphere 2 --noise 0.1 --seed 3 -o a.ply");
    assert_eq!(a["report"]["vertices"], 162);
    for (command, message) in [
        ("shape goldberg 2 -o x.off", "A B"),
        ("shape cube 1 -o x.off", "no sizes"),
        ("shape icosphere 1.5 -o x.off", "1.5"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(2), "{command}");
        assert!(error(&output).contains(message), "{}", error(&output));
    }
}
