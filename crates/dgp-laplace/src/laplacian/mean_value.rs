//! The mean value Laplacian: weights that are always positive.
//!
//! ```text
//! L(i, j) = −(tan γ/2 + tan δ/2) / (2 |ij|)      with the angles at i on both sides of edge ij
//! ```
//!
//! The mean value theorem of harmonic functions, applied to the fan around vertex i: a linear function
//! on a flat fan is the weighted mean of its values around.
//!
//! - Input: any mesh; of polygons the angles at their corners count. Edges have lengths.
//! - Cost: O(V) time and memory.
//! - Guarantees: no weight is negative, those of angles below π are positive. L·1 = 0. Not symmetric:
//!   row i has the weights of vertex i.
//! - Reference: Floater, "Mean value coordinates", Computer Aided Geometric Design 20(1), 2003.

use dgp_mesh::{HalfedgeId, Mesh, measure::edge_lengths};
use dgp_sparse::SparseMatrix;

use super::assemble::matrix;
use crate::Error;

/// The matrix of mean value coordinates; unit 1/length.
///
/// Errors: [`Error::NoLength`] where the ends of an edge are at one point, or so near beside the rest that
/// its weight is not finite.
pub fn mean_value_laplacian(mesh: &Mesh) -> Result<SparseMatrix, Error> {
    let lengths = edge_lengths(mesh);
    // tan of half the angle of each corner.
    let tangents = mesh.map_halfedges(|h| {
        if mesh.face(h).is_some() { (0.5 * mesh.corner_angle(h)).tan() } else { 0.0 }
    });
    // Left of h lies the corner of h; right of it that of the next spoke clockwise.
    let weights = mesh.map_halfedges(|h: HalfedgeId| {
        (tangents[h] + tangents[mesh.cw(h)]) / (2.0 * lengths[h.edge()])
    });
    if let Some((h, _)) = weights.iter().find(|(_, w)| !w.is_finite()) {
        return Err(Error::NoLength { edge: h.edge() });
    }
    let mut diagonal = vec![0.0; mesh.vertex_count()];
    for h in mesh.halfedges() {
        diagonal[mesh.from(h).index()] += weights[h];
    }
    matrix(mesh, &diagonal, |e| {
        let [h, g] = e.halfedges();
        let [up, down] = if mesh.from(h) < mesh.to(h) { [h, g] } else { [g, h] };
        // Row a has the weight of the half-edge that leaves a.
        [0.0 - weights[up], 0.0 - weights[down]]
    })
}
