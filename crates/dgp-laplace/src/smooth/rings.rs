//! What each vertex is drawn to, as lists.
//!
//! Walking half-edges is a chain of loads, each waiting for the one before; lists are read ahead. They
//! are extracted once and serve all iterations.

use dgp_mesh::{DVec3, Mesh, VertexId, VertexSet, parallel};

use super::Boundary;

/// The neighbors that draw each vertex.
pub(super) struct Rings {
    /// The neighbors of vertex v are at `[v]..[v + 1]`; a vertex that stays has none.
    starts: Vec<u32>,
    neighbors: Vec<u32>,
    /// The vertices whose list is no closed ring: the two neighbors along a rim, or an open fan.
    rim: VertexSet,
    boundary: Boundary,
}

/// The neighbors of one vertex.
#[derive(Clone, Copy)]
pub(super) enum Ring<'a> {
    /// The vertex stays.
    None,
    /// All around it, in order.
    Closed(&'a [u32]),
    /// All around it, from rim to rim.
    Open(&'a [u32]),
    /// The two along the rim.
    Curve([u32; 2]),
}

impl Rings {
    pub(super) fn new(mesh: &Mesh, fixed: &VertexSet, boundary: Boundary) -> Self {
        let blocks = parallel::map_blocks(mesh.vertex_count(), parallel::BLOCK, |range| {
            let mut ends = Vec::with_capacity(range.len());
            let mut neighbors = Vec::with_capacity(7 * range.len());
            let mut rim = Vec::new();
            for v in range.map(VertexId::new) {
                add_ring(mesh, v, fixed, boundary, &mut neighbors, &mut rim);
                ends.push(neighbors.len() as u32);
            }
            (ends, neighbors, rim)
        });
        let mut rings = Rings {
            starts: Vec::with_capacity(mesh.vertex_count() + 1),
            neighbors: Vec::with_capacity(mesh.halfedge_count()),
            rim: VertexSet::new(),
            boundary,
        };
        rings.starts.push(0);
        for (ends, neighbors, rim) in blocks {
            let before = rings.neighbors.len() as u32;
            rings.starts.extend(ends.iter().map(|end| before + end));
            rings.neighbors.extend(neighbors);
            rings.rim.extend(rim);
        }
        rings
    }

    /// The neighbors of vertex number `v`, in no matter which arrangement.
    #[inline]
    pub(super) fn neighbors(&self, v: usize) -> &[u32] {
        &self.neighbors[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The neighbors of vertex number `v` and how they lie.
    #[inline]
    pub(super) fn ring(&self, v: usize) -> Ring<'_> {
        let neighbors = self.neighbors(v);
        if neighbors.is_empty() {
            return Ring::None;
        }
        if !self.rim.contains(VertexId::new(v)) {
            return Ring::Closed(neighbors);
        }
        match (self.boundary, neighbors) {
            (Boundary::Curve, &[a, b]) => Ring::Curve([a, b]),
            _ => Ring::Open(neighbors),
        }
    }

    /// Whether vertex number `v` stays.
    #[inline]
    pub(super) fn is_fixed(&self, v: usize) -> bool {
        self.starts[v] == self.starts[v + 1]
    }

    /// `to` ← `from` + `size` · (mean of the neighbors − `from`).
    pub(super) fn relax(&self, from: &[DVec3], to: &mut [DVec3], size: f64) {
        parallel::for_each_chunk(to, parallel::BLOCK, |first, chunk| {
            for (i, moved) in chunk.iter_mut().enumerate() {
                let (p, neighbors) = (from[first + i], self.neighbors(first + i));
                // Differences, so that what is flat along an axis stays so exactly.
                let sum: DVec3 = neighbors.iter().map(|&w| from[w as usize] - p).sum();
                *moved = p + sum * (size / neighbors.len().max(1) as f64);
            }
        });
    }
}

/// Adds the neighbors that draw `v`, and `v` to `rim` if it is on one.
#[inline]
fn add_ring(
    mesh: &Mesh,
    v: VertexId,
    fixed: &VertexSet,
    boundary: Boundary,
    neighbors: &mut Vec<u32>,
    rim: &mut Vec<VertexId>,
) {
    if fixed.contains(v) || mesh.is_isolated_vertex(v) {
        return;
    }
    let is_rim = mesh.is_boundary_vertex(v);
    if is_rim && boundary == Boundary::Fixed {
        return;
    }
    let start = neighbors.len();
    for w in mesh.vertex_neighbors(v) {
        neighbors.push(w.index() as u32);
    }
    if !is_rim {
        return;
    }
    rim.push(v);
    if boundary == Boundary::Curve {
        // The half-edges at a boundary vertex start and end with those along the rim.
        let along = [neighbors[start], neighbors[neighbors.len() - 1]];
        neighbors.truncate(start);
        neighbors.extend(along);
    }
}
