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
//! - Departs from it: a vertex enters the queue again whenever its distance falls, and what became of
//!   older entries is seen when they come up. On meshes a quarter more entries cost less than knowing
//!   where in the queue each vertex is.

use std::{cmp::Reverse, collections::BinaryHeap};

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
    let mut reached = VertexMap::filled(count, Reached::NEVER);
    let mut order = Vec::new();
    let mut queue = BinaryHeap::new();
    for &source in sources {
        if reached[source].distance > 0.0 {
            reached[source].distance = 0.0;
            queue.push(Reverse(Entry::new(0.0, source)));
        }
    }
    let mut missing = match until {
        Until::Reached(targets) => targets.len(),
        _ => usize::MAX,
    };
    let mut ring = Vec::new();
    while let Some(&Reverse(nearest)) = queue.peek() {
        let (distance, v) = (nearest.distance(), nearest.vertex());
        if distance > reached[v].distance {
            queue.pop();
            continue;
        }
        if missing == 0 || matches!(until, Until::Distance(limit) if distance > limit) {
            break;
        }
        queue.pop();
        if order.len().is_multiple_of(REPORT_EVERY) {
            progress.report(order.len() as f64 / count as f64)?;
        }
        order.push(v);
        match until {
            Until::FirstOf(targets) if targets.contains(v) => break,
            Until::Reached(targets) if targets.contains(v) => missing -= 1,
            _ => {}
        }
        spokes(mesh, v, reached[v].arrival, &mut ring);
        for &(h, w) in &ring {
            let reached = &mut reached[w];
            if reached.distance <= distance {
                continue;
            }
            let through_v = distance + lengths[h.edge()];
            if through_v < reached.distance {
                *reached = Reached { distance: through_v, arrival: Some(h) };
                queue.push(Reverse(Entry::new(through_v, w)));
            }
        }
    }
    // What is still in the queue has a path, but maybe not its shortest.
    for Reverse(entry) in queue {
        if entry.distance() <= reached[entry.vertex()].distance {
            reached[entry.vertex()] = Reached::NEVER;
        }
    }
    Ok(ShortestPaths {
        distance: reached.map(|reached| reached.distance),
        arrival: reached.map(|reached| reached.arrival),
        order,
    })
}

/// The best path to a vertex so far. What is asked for together lies together: on a mesh in no order
/// each vertex is a wait for memory.
#[derive(Clone, Copy)]
struct Reached {
    distance: f64,
    arrival: Option<HalfedgeId>,
}

impl Reached {
    const NEVER: Reached = Reached { distance: f64::INFINITY, arrival: None };
}

/// A distance and a vertex as one number, in the order of distances and then of vertices: the bits of
/// numbers that are not negative are in their order, and numbers are compared without a branch.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry(u128);

impl Entry {
    #[inline]
    fn new(distance: f64, v: VertexId) -> Self {
        Entry(u128::from(distance.to_bits()) << 32 | v.index() as u128)
    }

    #[inline]
    fn distance(self) -> f64 {
        f64::from_bits((self.0 >> 32) as u64)
    }

    #[inline]
    fn vertex(self) -> VertexId {
        VertexId::new(self.0 as u32 as usize)
    }
}

/// Collects the half-edges that leave `v` and where they lead, counterclockwise.
///
/// Starts from where the search came from, which was looked at not long ago. The ends are read before
/// anything is asked about them, so that the processor does not wait for one after the other.
#[inline]
fn spokes(
    mesh: &Connectivity,
    v: VertexId,
    arrival: Option<HalfedgeId>,
    ring: &mut Vec<(HalfedgeId, VertexId)>,
) {
    ring.clear();
    let Some(start) = arrival.map(HalfedgeId::twin).or_else(|| mesh.vertex_halfedge(v)) else {
        return;
    };
    let mut h = start;
    loop {
        ring.push((h, mesh.to(h)));
        h = mesh.ccw(h);
        if h == start {
            return;
        }
    }
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
