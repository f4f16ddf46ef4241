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

use crate::{
    masks::{Masks, Means, Stencil},
    options::ButterflyRule,
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
    rule: ButterflyRule,
}

impl<'a> Butterfly<'a> {
    pub(crate) fn new(topology: &'a Topology, rule: ButterflyRule) -> Self {
        Butterfly { topology, rule }
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
        let irregular = match self.rule {
            ButterflyRule::Original => [false; 2],
            ButterflyRule::Modified => halfedges.map(|h| self.is_irregular(h, stencil)),
        };
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

    /// Whether the vertex that `h` leaves is inside and has not six edges.
    fn is_irregular(&self, h: u32, stencil: &mut Stencil) -> bool {
        let v = self.topology.from(h) as usize;
        self.topology.spokes(v, &mut stencil.spokes) && stencil.spokes.len() != 6
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
