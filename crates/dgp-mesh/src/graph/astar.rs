//! A*: the shortest path along edges to one vertex, looking towards it first.
//!
//! ```text
//! expand the vertex v of least g(v) + h(v)
//!
//! g(v)   length of the best path to v so far
//! h(v)   κ |x(v) − x(target)|, which no path can beat; κ = least length / distance of an edge
//! ```
//!
//! - Input: any mesh; lengths that are not negative, of any kind. With lengths in space κ = 1.
//! - Cost: that of Dijkstra's algorithm at worst; usually a fraction of the vertices is looked at.
//! - Guarantees: as long as the result of [`dijkstra`](super::dijkstra).
//! - Reference: Hart, Nilsson and Raphael, "A formal basis for the heuristic determination of minimum
//!   cost paths", IEEE Transactions on Systems Science and Cybernetics 4(2), 1968.
//! - Departs from it: the bound is scaled to the lengths given, and lowered by the rounding errors a
//!   path may gather.

use super::{
    IndexedHeap,
    dijkstra::{REPORT_EVERY, trace, validate},
};
use crate::{EdgeMap, Error, HalfedgeId, Mesh, Progress, VertexId, VertexMap, measure::scale};

/// A path along edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The sum of the lengths of its edges, from its start on.
    pub length: f64,
    /// Its half-edges in order; none if it ends where it starts.
    pub halfedges: Vec<HalfedgeId>,
    /// How many vertices the search looked at.
    pub visited: usize,
}

/// Finds the shortest path along edges from `source` to `target`; `None` if there is none.
///
/// Errors: [`Error::InvalidWeight`] for a length that is negative or no number,
/// [`Error::Cancelled`].
///
/// # Panics
/// If `lengths` does not have one value per edge, or a vertex is not on the mesh.
pub fn astar(
    mesh: &Mesh,
    lengths: &EdgeMap<f64>,
    source: VertexId,
    target: VertexId,
    progress: Progress<'_>,
) -> Result<Option<Path>, Error> {
    validate(mesh, lengths)?;
    let kappa = length_per_distance(mesh, lengths);
    let goal = mesh.position(target);
    let bound = |v: VertexId| kappa * scale::distance(mesh.position(v), goal);

    let mut length = VertexMap::filled(mesh.vertex_count(), f64::INFINITY);
    let mut arrival = VertexMap::filled(mesh.vertex_count(), None);
    let mut queue = IndexedHeap::with_capacity(mesh.vertex_count());
    length[source] = 0.0;
    queue.set(source, bound(source));
    let mut visited = 0_usize;
    while let Some((v, _)) = queue.pop() {
        if visited.is_multiple_of(REPORT_EVERY) {
            progress.report((visited as f64 / mesh.vertex_count() as f64).min(1.0))?;
        }
        visited += 1;
        if v == target {
            let halfedges = trace(mesh, &arrival, target);
            return Ok(Some(Path { length: length[target], halfedges, visited }));
        }
        for h in mesh.vertex_halfedges(v) {
            let w = mesh.to(h);
            let through_v = length[v] + lengths[h.edge()];
            // A vertex that was expanded comes back if rounding had made it look worse than it is.
            if through_v < length[w] {
                length[w] = through_v;
                arrival[w] = Some(h);
                queue.set(w, through_v + bound(w));
            }
        }
    }
    Ok(None)
}

/// κ: no path is shorter than κ times the distance of its ends.
fn length_per_distance(mesh: &Mesh, lengths: &EdgeMap<f64>) -> f64 {
    // Each edge of a path adds a relative error of 2⁻⁵³; this covers paths of 2²² edges.
    const SLACK: f64 = 1.0 - 1.0 / (1_u64 << 30) as f64;
    let ratios = lengths.iter().map(|(e, &length)| {
        let distance = mesh.edge_length(e);
        if distance > 0.0 { length / distance } else { f64::INFINITY }
    });
    let least = ratios.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least * SLACK } else { 0.0 }
}
