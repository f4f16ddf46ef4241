//! `dgp param`: each method, what is written, what is refused.

use crate::folder::{CUBE, Dgp, error};

#[test]
fn each_method_lays_out_a_grid() {
    let dgp = Dgp::new(&[]);
    assert_eq!(dgp.run("shape grid 6 6 -o disk.ply").status.code(), Some(0));
    for method in ["tutte", "harmonic", "intrinsic-harmonic", "mean-value", "lscm"] {
        let command = format!("param disk.ply -o {method}.obj --method {method} --picture p.png");
        let (code, value) = dgp.json(&command);
        assert_eq!(code, 0, "{value}");
        let report = &value["report"];
        assert_eq!(
            (report["flipped"].as_u64(), report["boundary_crossings"].as_u64()),
            (Some(0), Some(0))
        );
        let text = std::fs::read_to_string(dgp.folder().join(format!("{method}.obj"))).unwrap();
        assert!(text.contains("\nvt "), "{method}");
        assert!(std::fs::metadata(dgp.folder().join("p.png")).unwrap().len() > 1000);
    }
    // What is flat is unrolled without error.
    let (_, value) = dgp.json("param disk.ply --method lscm");
    assert!(value["report"]["conformal"]["max"].as_f64().unwrap() < 1.0 + 1e-9, "{value}");
    let (code, value) = dgp.json("param disk.ply -o flat.ply --flat --boundary square");
    assert_eq!(code, 0, "{value}");
    let (_, value) = dgp.json("info flat.ply");
    assert!((value["report"]["area"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{value}");
}

#[test]
fn what_is_no_disk_is_refused_with_the_remedy() {
    let dgp = Dgp::new(&[("cube.off", CUBE)]);
    let output = dgp.run("param cube.off");
    assert_eq!(output.status.code(), Some(1));
    let text = error(&output);
    assert!(text.contains("cube.off") && text.contains("closed") && text.contains("cut"), "{text}");
}
