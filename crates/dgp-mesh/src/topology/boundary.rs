//! The rims of holes.

use crate::{Connectivity, HalfedgeId, HalfedgeSet, Mesh};

/// The half-edges along each hole, in order, the hole to their left.
///
/// Each loop starts with its smallest half-edge, and the loops are in order of those.
pub fn boundary_loops(mesh: &Connectivity) -> Vec<Vec<HalfedgeId>> {
    let mut seen = HalfedgeSet::new();
    let mut loops = Vec::new();
    for h in mesh.halfedges().filter(|&h| mesh.is_boundary_halfedge(h)) {
        if !seen.contains(h) {
            let rim: Vec<HalfedgeId> = mesh.loop_halfedges(h).collect();
            seen.extend(rim.iter().copied());
            loops.push(rim);
        }
    }
    loops
}

/// The sum of the lengths of `halfedges`, such as the length of a boundary loop.
pub fn path_length(mesh: &Mesh, halfedges: &[HalfedgeId]) -> f64 {
    halfedges.iter().map(|h| mesh.edge_length(h.edge())).sum()
}
