//! Surfaces that tests of several modules use.

use dgp_mesh::shapes;

use crate::intrinsic::IntrinsicTriangulation;

/// The unit square with opposite sides glued: n × n cells of two triangles, known by their lengths alone.
pub(crate) fn flat_torus(n: usize) -> IntrinsicTriangulation {
    let torus = shapes::torus(2.0, 1.0, n, n).expect("three cells at least");
    let step = 1.0 / n as f64;
    let lengths = torus.map_edges(|e| {
        let [a, b] = torus.edge_vertices(e).map(|v| [v.index() % n, v.index() / n]);
        let is_diagonal = a[0] != b[0] && a[1] != b[1];
        if is_diagonal { step * 2.0_f64.sqrt() } else { step }
    });
    IntrinsicTriangulation::from_lengths(&torus, &lengths).expect("right triangles")
}
