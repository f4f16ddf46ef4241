//! How many edges a planar graph can have: Euler's formula as a verdict.
//!
//! ```text
//! E ≤ 3V − 6      for V ≥ 3: each face has three sides at least, each edge two sides
//! E ≤ 2V − 4      if there is no odd cycle: each face has four sides at least
//! ```
//!
//! More edges prove that a graph is not planar: K5 breaks the first bound, K3,3 the second. Fewer prove
//! nothing; [`planarity`](super::planarity) decides.
//!
//! Reference: Euler 1758; Diestel, *Graph Theory*, corollaries 4.2.10 and 4.2.11.

use super::Graph;
use crate::{VertexId, VertexMap};

/// What [`edge_bound`] says.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use]
pub struct EdgeBound {
    /// V.
    pub vertices: usize,
    /// E.
    pub edges: usize,
    /// 3V − 6; `None` for fewer than three vertices, where there is no bound but V(V − 1)/2.
    pub limit: Option<usize>,
    /// 2V − 4 if the graph is bipartite, `None` if not, or for fewer than three vertices.
    pub bipartite_limit: Option<usize>,
    /// Whether there are more edges than one of the bounds, so that the graph cannot be planar.
    pub proves_non_planar: bool,
}

/// Compares the number of edges of `graph` with the bounds for planar graphs.
pub fn edge_bound(graph: &Graph) -> EdgeBound {
    let (vertices, edges) = (graph.vertex_count(), graph.edge_count());
    let limit = (vertices >= 3).then(|| 3 * vertices - 6);
    let is_bipartite = vertices >= 3 && bipartition(graph).is_some();
    let bipartite_limit = is_bipartite.then(|| 2 * vertices - 4);
    let exceeds = |limit: Option<usize>| limit.is_some_and(|limit| edges > limit);
    let proves_non_planar = exceeds(limit) || exceeds(bipartite_limit);
    EdgeBound { vertices, edges, limit, bipartite_limit, proves_non_planar }
}

/// Two sides such that each edge joins one to the other: which vertices are on the second side. `None`
/// if a cycle has an odd number of edges.
#[must_use]
pub fn bipartition(graph: &Graph) -> Option<VertexMap<bool>> {
    let mut side: VertexMap<Option<bool>> = VertexMap::filled(graph.vertex_count(), None);
    let mut stack: Vec<VertexId> = Vec::new();
    for start in graph.vertices() {
        if side[start].is_none() {
            side[start] = Some(false);
            stack.push(start);
        }
        while let Some(v) = stack.pop() {
            let other = side[v].map(|s| !s);
            for &(w, _) in graph.arcs(v) {
                if side[w].is_none() {
                    side[w] = other;
                    stack.push(w);
                } else if side[w] != other {
                    return None;
                }
            }
        }
    }
    Some(side.map(|s| *s == Some(true)))
}
