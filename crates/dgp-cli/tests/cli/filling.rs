//! `dgp fill`: which holes, with what, and what is refused.

use std::fmt::Write;

use crate::folder::{Dgp, error};

/// Two squares of a strip with a hole between them, in a frame: a grid of 4 × 4 quads without the middle.
fn frame() -> String {
    let mut text = String::from("OFF\n25 12 0\n");
    for y in 0..5 {
        for x in 0..5 {
            let _ = writeln!(text, "{x} {y} 0");
        }
    }
    for y in 0..4 {
        for x in 0..4 {
            let middle = (1..3).contains(&x) && (1..3).contains(&y);
            if !middle {
                let a = 5 * y + x;
                let _ = writeln!(text, "4 {a} {} {} {}", a + 1, a + 6, a + 5);
            }
        }
    }
    text
}

#[test]
fn holes_are_filled_as_asked() {
    let frame = frame();
    let dgp = Dgp::new(&[("frame.off", frame.as_str())]);
    // The middle vertex is on no face: repair drops it.
    assert_eq!(dgp.run("repair frame.off -o frame.ply").status.code(), Some(0));
    for (options, filled, faces) in [
        ("--keep-longest", 1, 6),
        ("--max-edges 8", 1, 6),
        ("", 2, 6 + 14),
        ("--max-edges 3", 0, 0),
    ] {
        let (code, value) = dgp.json(&format!("fill frame.ply -o r.ply {options}"));
        assert_eq!(code, 0, "{options}: {value}");
        assert_eq!(value["report"]["filled"], filled, "{options}: {value}");
        assert_eq!(value["report"]["faces"], faces, "{options}: {value}");
        assert_eq!(value["output"]["faces"], 12 + faces);
        assert_eq!(value["report"]["holes"].as_array().unwrap().len(), 2);
    }
    for options in ["--refine", "--fair", "--fair --density 0.8"] {
        let (code, value) = dgp.json(&format!("fill frame.ply -o r.ply --keep-longest {options}"));
        assert_eq!(code, 0, "{options}: {value}");
        assert_eq!(dgp.run("check r.ply -q").status.code(), Some(0), "{options}");
        let (_, value) = dgp.json("info r.ply");
        assert!((value["report"]["area"].as_f64().unwrap() - 16.0).abs() < 1e-9, "{options}");
        assert_eq!(value["report"]["boundary_loops"], 1);
    }
    let output = dgp.run("fill frame.ply -o r.ply --keep-longest --fair --picture r.png");
    assert!(output.status.success() && dgp.folder().join("r.png").exists(), "{}", error(&output));
    for (command, code, message) in [
        ("fill frame.ply -o r.ply --density 0", 2, "density"),
        ("fill frame.ply -o r.ply --max-edges x", 2, "max-edges"),
        ("fill none.ply -o r.ply", 1, "none.ply"),
    ] {
        let output = dgp.run(command);
        assert_eq!(output.status.code(), Some(code), "{command}: {}", error(&output));
        assert!(error(&output).contains(message), "{command}: {}", error(&output));
    }
}
