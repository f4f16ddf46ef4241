//! Breadth-first search: how many edges away everything is.

use std::collections::VecDeque;

use crate::{Connectivity, HalfedgeId, VertexId, VertexMap};

/// What [`breadth_first`] finds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BreadthFirst {
    /// The least number of edges from a source; `None` where no path leads.
    pub level: VertexMap<Option<u32>>,
    /// The last half-edge of such a path; `None` at sources and where no path leads.
    pub arrival: VertexMap<Option<HalfedgeId>>,
    /// All vertices reached, nearest first.
    pub order: Vec<VertexId>,
}

/// Searches from `sources` over edges, nearest vertices first, around each vertex in order.
pub fn breadth_first(mesh: &Connectivity, sources: &[VertexId]) -> BreadthFirst {
    let mut level = VertexMap::filled(mesh.vertex_count(), None);
    let mut arrival = VertexMap::filled(mesh.vertex_count(), None);
    let mut order = Vec::new();
    let mut queue = VecDeque::new();
    for &source in sources {
        if level[source].is_none() {
            level[source] = Some(0);
            queue.push_back((source, 0));
        }
    }
    while let Some((v, steps)) = queue.pop_front() {
        order.push(v);
        for h in mesh.vertex_halfedges(v) {
            let w = mesh.to(h);
            if level[w].is_none() {
                level[w] = Some(steps + 1);
                arrival[w] = Some(h);
                queue.push_back((w, steps + 1));
            }
        }
    }
    BreadthFirst { level, arrival, order }
}
