//! The hierarchy of triangles beside CGAL's, by the figures both drivers tell: sums of distances and numbers of hits.
//!
//! Sums agree to rounding. Numbers of hits of rays may differ by those that pass within rounding of an edge; pairs of
//! faces that meet are exact on both sides. The Hausdorff distance lies in the interval of each.

use std::{fs, path::Path};

use dgp_mesh::{IndexedFaceSet, shapes};
use serde_json::Value;

use super::{Comparison, Table, Verdict};
use crate::{
    peers::{Driver, Peers},
    raw,
    shell::Outcome,
};

/// The operations and by how much of the larger their figures may differ.
const OPERATIONS: [(&str, f64); 8] = [
    ("closest-near", 1e-12),
    ("closest-box", 1e-12),
    ("ray-first", 1e-9),
    ("ray-any", 0.0),
    ("segment-any", 0.0),
    ("box-faces", 0.0),
    ("self-intersections", 0.0),
    ("hausdorff", 1.5),
];

fn inputs() -> Outcome<[(&'static str, IndexedFaceSet); 3]> {
    let sphere = shapes::with_noise(shapes::icosphere(4)?, 0.01, 3)?;
    let holed = shapes::with_holes(&sphere, 4, 1, 3)?;
    Ok([
        ("noisy sphere", sphere.to_indexed()),
        ("holed sphere", holed.to_indexed()),
        ("torus", shapes::torus(2.0, 0.7, 60, 30)?.to_indexed()),
    ])
}

/// Compares on all inputs, and notes it in the table.
pub(super) fn compare(peers: &Peers, folder: &Path, table: &mut Table) -> Outcome<()> {
    for (name, set) in inputs()? {
        let path = folder.join("spatial.raw");
        raw::write(&path, &set)?;
        let mut comparisons = Vec::new();
        for (operation, tolerance) in OPERATIONS {
            let ours = Driver::ours()?.call(operation, &path, &[])?;
            let theirs = peers.cgal.call(operation, &path, &[])?;
            comparisons.push(judge(operation, tolerance, &ours, &theirs));
        }
        table.add(name, "CGAL", comparisons);
        fs::remove_file(path)?;
    }
    Ok(())
}

fn judge(operation: &str, tolerance: f64, ours: &Value, theirs: &Value) -> Comparison {
    let number = |value: &Value, name: &str| value[name].as_f64().unwrap_or(f64::NAN);
    let (a, b) = (number(ours, "value"), number(theirs, "value"));
    // A Hausdorff distance is within the bound of CGAL's figure, and within half of it of ours, the middle.
    let scale = if operation == "hausdorff" { number(ours, "bound") } else { a.abs().max(b.abs()) };
    let off = if a == b { 0.0 } else { (a - b).abs() / scale };
    let verdict =
        if off <= tolerance { Verdict::Same } else { Verdict::Differs(format!("{a} and {b}")) };
    let quantity = operation.replace('-', "_");
    Comparison { quantity, compared: 1, left_out: 0, worst: off, verdict }
}
