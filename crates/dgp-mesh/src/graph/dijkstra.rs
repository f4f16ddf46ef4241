//! Dijkstra's algorithm: shortest paths along edges.
//!
//! ```text
//! settle the nearest vertex v that is not settled yet
//! for each edge from v to w:  distance(w) ← min(distance(w), distance(v) + length(edge))
//! ```
//!
//! - Input: any mesh; lengths that are not negative. An infinite one closes the edge.
//! - Cost: O((V + E) log V) time, O(V) memory.
//! - Guarantees: no path is shorter in the arithmetic of f64; of equal ones always the same is found.
//! - Reference: Dijkstra, "A note on two problems in connexion with graphs", Numerische Mathematik 1,
//!   1959.

use super::IndexedHeap;
use crate::{Connectivity, EdgeMap, Error, HalfedgeId, Progress, VertexId, VertexMap, VertexSet};

/// When [`dijkstra`] may stop.
#[derive(Clone, Copy, Debug, Default)]
pub enum Until<'a> {
    /// When all that can be reached is.
    #[default]
    AllReached,
    /// When all of these are reached.
    Reached(&'a VertexSet),
    /// When one of these is reached.
    FirstOf(&'a VertexSet),
    /// When all within this distance is reached.
    Distance(f64),
}

/// What [`dijkstra`] finds.
#[derive(Clone, Debug, PartialEq)]
pub struct ShortestPaths {
    /// The length of the shortest path from a source; infinite where none leads or the search had
    /// stopped.
    pub distance: VertexMap<f64>,
    /// The last half-edge of that path; `None` at sources and where `distance` is infinite.
    pub arrival: VertexMap<Option<HalfedgeId>>,
    /// The vertices reached, nearest first.
    pub order: Vec<VertexId>,
}

impl ShortestPaths {
    /// The half-edges of the shortest path from a source to `v`, in order; `None` if it was not
    /// reached.
    pub fn path(&self, mesh: &Connectivity, v: VertexId) -> Option<Vec<HalfedgeId>> {
        self.distance[v].is_finite().then(|| trace(mesh, &self.arrival, v))
    }
}

/// The half-edges that lead to `v`, in order.
pub(super) fn trace(
    mesh: &Connectivity,
    arrival: &VertexMap<Option<HalfedgeId>>,
    v: VertexId,
) -> Vec<HalfedgeId> {
    let steps = |h: &HalfedgeId| arrival[mesh.from(*h)];
    let mut path: Vec<HalfedgeId> = std::iter::successors(arrival[v], steps).collect();
    path.reverse();
    path
}

/// Finds the shortest paths along edges from the nearest of `sources` to each vertex.
///
/// Errors: [`Error::InvalidWeight`] for a length that is negative or no number,
/// [`Error::Cancelled`].
///
/// # Panics
/// If `lengths` does not have one value per edge, or a source is not on the mesh.
pub fn dijkstra(
    mesh: &Connectivity,
    lengths: &EdgeMap<f64>,
    sources: &[VertexId],
    until: Until<'_>,
    progress: Progress<'_>,
) -> Result<ShortestPaths, Error> {
    validate(mesh, lengths)?;
    let count = mesh.vertex_count();
    let mut found = ShortestPaths {
        distance: VertexMap::filled(count, f64::INFINITY),
        arrival: VertexMap::filled(count, None),
        order: Vec::new(),
    };
    let mut queue = IndexedHeap::with_capacity(count);
    for &source in sources {
        found.distance[source] = 0.0;
        queue.set(source, 0.0);
    }
    let mut missing = match until {
        Until::Reached(targets) => targets.len(),
        _ => usize::MAX,
    };
    while let Some((v, distance)) = queue.first() {
        if missing == 0 || matches!(until, Until::Distance(limit) if distance > limit) {
            break;
        }
        queue.pop();
        if found.order.len().is_multiple_of(REPORT_EVERY) {
            progress.report(found.order.len() as f64 / count as f64)?;
        }
        found.order.push(v);
        match until {
            Until::FirstOf(targets) if targets.contains(v) => break,
            Until::Reached(targets) if targets.contains(v) => missing -= 1,
            _ => {}
        }
        for h in mesh.vertex_halfedges(v) {
            let w = mesh.to(h);
            let through_v = distance + lengths[h.edge()];
            if through_v < found.distance[w] {
                found.distance[w] = through_v;
                found.arrival[w] = Some(h);
                queue.set(w, through_v);
            }
        }
    }
    // What is still in the queue has a path, but maybe not its shortest.
    while let Some((v, _)) = queue.pop() {
        found.distance[v] = f64::INFINITY;
        found.arrival[v] = None;
    }
    Ok(found)
}

/// Vertices between two reports: some milliseconds.
pub(super) const REPORT_EVERY: usize = 1 << 15;

/// Refuses lengths that are negative or no numbers.
pub(super) fn validate(mesh: &Connectivity, lengths: &EdgeMap<f64>) -> Result<(), Error> {
    assert_eq!(lengths.len(), mesh.edge_count(), "one length per edge");
    match lengths.iter().find(|(_, length)| length.is_nan() || **length < 0.0) {
        Some((edge, &weight)) => Err(Error::InvalidWeight { edge, weight }),
        None => Ok(()),
    }
}
