//! Butterfly subdivision: triangles into four through the vertices of the cage.
//!
//! ```text
//!      −1/16 ─── ⅛ ─── −1/16
//!          ╲    ╱ ╲    ╱              among vertices of six edges; of the original scheme everywhere
//!           ½ ─── ◦ ─── ½
//!          ╱    ╲ ╱    ╲
//!      −1/16 ─── ⅛ ─── −1/16
//!
//! vertex of d ≠ 6 edges: ¾ v + Σ s_j w_j, w_0 at the other end of the edge
//!     d = 3    s = 5/12, −1/12, −1/12
//!     d = 4    s = 3/8, 0, −1/8, 0
//!     d ≥ 5    s_j = (¼ + cos(2πj/d) + ½ cos(4πj/d))/d
//! the mean of two such where both ends are; rim of a hole: (−1, 9, 9, −1)/16
//! ```
//!
//! - Input: triangles; no vertex inside with only two faces.
//! - Cost: O(F) per level.
//! - Guarantees: vertices stay; masks sum to 1 but are not convex, so surfaces overshoot.
//! - Reference: Dyn, Levin and Gregory, "A butterfly subdivision scheme for surface interpolation with
//!   tension control", 1990; Zorin, Schröder and Sweldens, "Interpolating subdivision for meshes with
//!   arbitrary topology", SIGGRAPH 1996.
//! - Departs from it: where a wing of the eight-point mask is missing beyond a rim, the corner across is
//!   reflected in the middle of the rim edge; a vertex at a rim counts as one of six edges.

use std::f64::consts::TAU;

use dgp_mesh::{VertexId, parallel};

use crate::{
    masks::{Masks, Means, Stencil, Value},
    options::ButterflyRule,
    primal::COMMON,
    topology::{NONE, Topology},
};

/// s_j, how much neighbor `j` of a vertex of `valence` edges counts, neighbor 0 being at the other end.
pub fn butterfly_weight(valence: usize, j: usize) -> f64 {
    match (valence, j) {
        (3, 0) => 5.0 / 12.0,
        (3, _) => -1.0 / 12.0,
        (4, 0) => 3.0 / 8.0,
        (4, 2) => -1.0 / 8.0,
        (4, _) => 0.0,
        _ => {
            let angle = TAU * j as f64 / valence as f64;
            (0.25 + angle.cos() + 0.5 * (2.0 * angle).cos()) / valence as f64
        }
    }
}

/// The masks of a step: old vertices, then edges.
pub(crate) struct Butterfly<'a> {
    topology: &'a Topology,
    /// Whether each vertex has a mask of its own: it is inside and has not six edges. Empty if none has.
    irregular: Vec<bool>,
    /// The weights of such masks, by number of edges.
    common: Vec<Vec<f64>>,
}

impl<'a> Butterfly<'a> {
    pub(crate) fn new(topology: &'a Topology, rule: ButterflyRule) -> Self {
        let irregular = match rule {
            ButterflyRule::Original => Vec::new(),
            ButterflyRule::Modified => {
                let is_irregular = |v: VertexId| is_irregular(topology, v.index());
                parallel::map(topology.vertex_count(), is_irregular).into_values()
            }
        };
        let weights = |d: usize| (0..d).map(|j| butterfly_weight(d, j)).collect();
        Butterfly { topology, irregular, common: (0..COMMON).map(weights).collect() }
    }

    /// The new values, without rows being written down but at rims.
    pub(crate) fn refined<T: Value>(&self, old: &[T]) -> Vec<T> {
        let topology = self.topology;
        let vertices = topology.vertex_count();
        let row = |row: VertexId| {
            if row.index() < vertices {
                return old[row.index()];
            }
            let h = 2 * (row.index() - vertices) as u32;
            match [h, h ^ 1].map(|h| self.is_irregular(h)) {
                [true, true] => (self.fan(h, old) + self.fan(h ^ 1, old)) * 0.5,
                [true, false] => self.fan(h, old),
                [false, true] => self.fan(h ^ 1, old),
                [false, false] => self.regular(h, old).unwrap_or_else(|| {
                    let mut stencil = Stencil::default();
                    self.edge(h as usize / 2, &mut stencil);
                    let entries = stencil.entries.iter();
                    entries.fold(T::default(), |sum, &(v, weight)| sum + old[v as usize] * weight)
                }),
            }
        };
        parallel::map(vertices + topology.edge_count(), row).into_values()
    }

    /// The eight-point mask of an edge, unless a rim is too near.
    #[inline]
    fn regular<T: Value>(&self, h: u32, old: &[T]) -> Option<T> {
        let topology = self.topology;
        let at = |corner: u32| old[topology.vertex(corner) as usize];
        let [mut ends, mut across, mut wings] = [T::default(); 3];
        for side in [h, h ^ 1] {
            let corner = topology.corner(side);
            if corner == NONE {
                return None;
            }
            let (next, prev) = (topology.next(corner), topology.prev(corner));
            ends = ends + at(corner);
            across = across + at(prev);
            for wing in [next, prev] {
                let twin = topology.corner(topology.corner_halfedge[wing as usize] ^ 1);
                if twin == NONE {
                    return None;
                }
                wings = wings + at(topology.prev(twin));
            }
        }
        Some(ends * 0.5 + across * 0.125 + wings * (-1.0 / 16.0))
    }

    /// The mask of the irregular vertex that `h` leaves, for the edge that `h` is.
    fn fan<T: Value>(&self, h: u32, old: &[T]) -> T {
        let topology = self.topology;
        let step = |spoke: u32| {
            topology.corner_halfedge[topology.prev(topology.corner(spoke)) as usize] ^ 1
        };
        let spokes =
            || std::iter::successors(Some(h), |&spoke| Some(step(spoke)).filter(|&s| s != h));
        let d = spokes().count();
        let common = self.common.get(d);
        spokes().enumerate().fold(old[topology.from(h) as usize] * 0.75, |sum, (j, spoke)| {
            let weight = common.map_or_else(|| butterfly_weight(d, j), |weights| weights[j]);
            sum + old[topology.to(spoke) as usize] * weight
        })
    }

    fn edge(&self, e: usize, stencil: &mut Stencil) {
        let halfedges = [2 * e as u32, 2 * e as u32 + 1];
        if self.topology.is_boundary_edge(e) {
            for h in halfedges {
                stencil.push(self.topology.from(h), 9.0 / 16.0);
                self.push_beyond(h, stencil);
            }
            return;
        }
        let irregular = halfedges.map(|h| self.is_irregular(h));
        let count = irregular.iter().filter(|&&irregular| irregular).count();
        if count == 0 {
            for h in halfedges {
                self.push_side(h, stencil);
            }
        }
        for (h, _) in halfedges.into_iter().zip(irregular).filter(|(_, irregular)| *irregular) {
            self.push_fan(h, 1.0 / count as f64, stencil);
        }
    }

    /// Whether the vertex that `h` leaves has a mask of its own.
    #[inline]
    fn is_irregular(&self, h: u32) -> bool {
        self.irregular.get(self.topology.from(h) as usize).copied().unwrap_or(false)
    }

    /// The vertex of the rim before the one that `h`, an edge of the rim, leaves.
    fn push_beyond(&self, h: u32, stencil: &mut Stencil) {
        let mut spokes = std::mem::take(&mut stencil.spokes);
        self.topology.spokes(self.topology.from(h) as usize, &mut spokes);
        let (first, last) = (spokes[0], spokes[spokes.len() - 1]);
        stencil.push(self.topology.to(if first == h { last } else { first }), -1.0 / 16.0);
        stencil.spokes = spokes;
    }

    /// The mask of an irregular vertex, for the edge that `h` is.
    fn push_fan(&self, h: u32, factor: f64, stencil: &mut Stencil) {
        let mut spokes = std::mem::take(&mut stencil.spokes);
        let v = self.topology.from(h);
        self.topology.spokes(v as usize, &mut spokes);
        let d = spokes.len();
        let start = spokes.iter().position(|&spoke| spoke == h).expect("h leaves the vertex");
        stencil.push(v, 0.75 * factor);
        for j in 0..d {
            let neighbor = self.topology.to(spokes[(start + j) % d]);
            stencil.push(neighbor, butterfly_weight(d, j) * factor);
        }
        stencil.spokes = spokes;
    }

    /// The half of the eight-point mask on the left of `h`, with the vertex it leaves.
    fn push_side(&self, h: u32, stencil: &mut Stencil) {
        let topology = self.topology;
        let corner = topology.corner(h);
        stencil.push(topology.from(h), 0.5);
        let across = topology.vertex(topology.prev(corner));
        stencil.push(across, 1.0 / 8.0);
        for side in [topology.next(corner), topology.prev(corner)] {
            let side_halfedge = topology.corner_halfedge[side as usize];
            let twin = topology.corner(side_halfedge ^ 1);
            if twin == NONE {
                // a + b − c, the corner of this triangle reflected in the middle of its side.
                stencil.push(topology.vertex(side), -1.0 / 16.0);
                stencil.push(topology.to(side_halfedge), -1.0 / 16.0);
                stencil.push(topology.vertex(topology.prev(side)), 1.0 / 16.0);
            } else {
                stencil.push(topology.vertex(topology.prev(twin)), -1.0 / 16.0);
            }
        }
    }
}

/// Whether a vertex is inside and has not six edges.
fn is_irregular(topology: &Topology, v: usize) -> bool {
    let first = topology.vertex_halfedge[v];
    let (mut spoke, mut count) = (first, 0);
    loop {
        let corner = topology.corner(spoke);
        if corner == NONE {
            return false;
        }
        count += 1;
        spoke = topology.corner_halfedge[topology.prev(corner) as usize] ^ 1;
        if spoke == first {
            return count != 6;
        }
    }
}

impl Masks for Butterfly<'_> {
    fn rows(&self) -> usize {
        self.topology.vertex_count() + self.topology.edge_count()
    }

    fn topology(&self) -> &Topology {
        self.topology
    }

    fn means(&self) -> Means {
        Means::Unused
    }

    fn row(&self, row: usize, stencil: &mut Stencil) {
        let vertices = self.topology.vertex_count();
        if row < vertices {
            stencil.push(row as u32, 1.0);
        } else {
            self.edge(row - vertices, stencil);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_irregular_vertices_sum_to_a_quarter() {
        for d in 3..20 {
            let sum: f64 = (0..d).map(|j| butterfly_weight(d, j)).sum();
            assert!((sum - 0.25).abs() < 1e-15, "{d} {sum}");
        }
    }
}
