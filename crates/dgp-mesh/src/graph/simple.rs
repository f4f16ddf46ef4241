//! A graph without faces: vertices and the edges between them, as adjacency lists.

use crate::{Connectivity, EdgeId, Error, MAX_ELEMENTS, VertexId};

/// An undirected graph without loops and multiple edges, in adjacency lists.
///
/// ```
/// use dgp_mesh::{VertexId, graph::Graph};
///
/// let path = Graph::from_indices(3, &[[0, 1], [1, 2]])?;
/// assert_eq!((path.edge_count(), path.degree(VertexId::new(1))), (2, 2));
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    edges: Vec<[VertexId; 2]>,
    /// The arcs that leave vertex v are at `[v]..[v + 1]`.
    starts: Vec<u32>,
    /// End and edge of each arc, by end.
    arcs: Vec<(VertexId, EdgeId)>,
}

impl Graph {
    /// The graph of these edges. Loops and repeated edges are left out; the others keep their order.
    ///
    /// Errors: [`Error::EdgeOutOfRange`], [`Error::TooMany`].
    pub fn new(
        vertex_count: usize,
        edges: impl IntoIterator<Item = [VertexId; 2]>,
    ) -> Result<Self, Error> {
        let mut kept = Vec::new();
        for (i, ends) in edges.into_iter().enumerate() {
            if let Some(&vertex) = ends.iter().find(|v| v.index() >= vertex_count) {
                let edge = EdgeId::new(i.min(MAX_ELEMENTS));
                return Err(Error::EdgeOutOfRange { edge, vertex, vertex_count });
            }
            if ends[0] != ends[1] {
                kept.push(ends);
            }
        }
        for (kind, count) in [("vertices", vertex_count), ("arcs", 2 * kept.len())] {
            if count > MAX_ELEMENTS {
                return Err(Error::TooMany { kind, count, limit: MAX_ELEMENTS });
            }
        }
        // Of edges with the same ends the first stays.
        let sorted = |i: u32| {
            let [a, b] = kept[i as usize];
            (a.min(b), a.max(b), i)
        };
        let mut order: Vec<u32> = (0..kept.len() as u32).collect();
        order.sort_unstable_by_key(|&i| sorted(i));
        order.dedup_by(|i, j| {
            let ((a, b, _), (c, d, _)) = (sorted(*i), sorted(*j));
            (a, b) == (c, d)
        });
        if order.len() < kept.len() {
            order.sort_unstable();
            kept = order.iter().map(|&i| kept[i as usize]).collect();
        }
        Ok(Graph::of_simple(vertex_count, kept))
    }

    /// The graph of edges given by indices counted from 0; see [`new`](Graph::new).
    pub fn from_indices(vertex_count: usize, edges: &[[usize; 2]]) -> Result<Self, Error> {
        for (i, ends) in edges.iter().enumerate() {
            if let Some(&vertex) = ends.iter().find(|&&v| v >= vertex_count) {
                let vertex = VertexId::new(vertex.min(MAX_ELEMENTS));
                return Err(Error::EdgeOutOfRange { edge: EdgeId::new(i), vertex, vertex_count });
            }
        }
        Graph::new(vertex_count, edges.iter().map(|ends| ends.map(VertexId::new)))
    }

    /// The vertices and edges of a mesh, under their numbers.
    pub fn of_mesh(mesh: &Connectivity) -> Self {
        let edges = mesh.edges().map(|e| mesh.edge_vertices(e)).collect();
        Graph::of_simple(mesh.vertex_count(), edges)
    }

    /// The graph of edges known to have no loops and no repetitions.
    pub(super) fn of_simple(vertex_count: usize, edges: Vec<[VertexId; 2]>) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        for v in edges.iter().flatten() {
            starts[v.index() + 1] += 1;
        }
        for v in 0..vertex_count {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let nothing = (VertexId::new(0), EdgeId::new(0));
        let mut arcs = vec![nothing; 2 * edges.len()];
        for (e, &[a, b]) in edges.iter().enumerate() {
            for (from, to) in [(a, b), (b, a)] {
                let at = &mut next[from.index()];
                arcs[*at as usize] = (to, EdgeId::new(e));
                *at += 1;
            }
        }
        for v in 0..vertex_count {
            arcs[starts[v] as usize..starts[v + 1] as usize].sort_unstable();
        }
        Graph { edges, starts, arcs }
    }

    /// How many vertices there are, those on no edge included.
    pub fn vertex_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many edges there are.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// All vertices.
    pub fn vertices(&self) -> impl DoubleEndedIterator<Item = VertexId> + use<> {
        (0..self.vertex_count()).map(VertexId::new)
    }

    /// The ends of each edge.
    pub fn edges(&self) -> &[[VertexId; 2]] {
        &self.edges
    }

    /// The neighbors of `v` in order of their numbers, each with the edge that leads there.
    #[inline]
    pub fn arcs(&self, v: VertexId) -> &[(VertexId, EdgeId)] {
        &self.arcs[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }

    /// The number of edges at `v`.
    #[inline]
    pub fn degree(&self, v: VertexId) -> usize {
        self.arcs(v).len()
    }

    /// The graph of some of the edges, and all vertices.
    pub(super) fn with_edges(&self, edges: &[EdgeId]) -> Self {
        let edges = edges.iter().map(|e| self.edges[e.index()]).collect();
        Graph::of_simple(self.vertex_count(), edges)
    }
}
