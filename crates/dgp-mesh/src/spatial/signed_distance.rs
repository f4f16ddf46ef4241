//! How far a point is from a surface, negative on the inner side.
//!
//! ```text
//! sign of (p − c) · n(c)
//!
//! n at a point of   a face     its normal
//!                   an edge    the sum of the normals of its faces
//!                   a vertex   Σ angle · normal of its faces
//! ```
//!
//! - Input: a surface whose faces agree on what is outside. For open ones the sign tells the side of the
//!   nearest place; soups are better asked for [winding numbers](super::WindingNumbers).
//! - Cost: that of the nearest point; faces around each vertex are listed before.
//! - Guarantees: the right sign everywhere off a closed surface without self-intersections.
//! - Reference: Bærentzen and Aanæs, "Signed distance computation using the angle weighted
//!   pseudonormal", IEEE Transactions on Visualization and Computer Graphics 11(3), 2005.

use glam::DVec3;

use super::{ClosestPoint, TriangleTree, batch, closest_point::Nearest};
use crate::{Error, Progress, VertexId, measure::scale};

/// Signed distances from a surface to many points.
#[derive(Clone, Debug)]
pub struct SignedDistances<'a> {
    tree: &'a TriangleTree,
    /// Where the triangles of each vertex start in `triangles`, and one end.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

/// The distance of a point and where the surface is nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedDistance {
    /// The distance, negative inside.
    pub distance: f64,
    /// The nearest point of the surface.
    pub closest: ClosestPoint,
}

impl<'a> SignedDistances<'a> {
    /// Prepares signed distances to the surface of `tree`.
    pub fn new(tree: &'a TriangleTree) -> Self {
        let corners = tree.vertices.as_flattened();
        let count = corners.iter().map(|v| v.index() + 1).max().unwrap_or(0);
        let mut starts = vec![0_u32; count + 1];
        for v in corners {
            starts[v.index() + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut triangles = vec![0_u32; corners.len()];
        let mut next = starts.clone();
        for (i, v) in corners.iter().enumerate() {
            let place = &mut next[v.index()];
            triangles[*place as usize] = (i / 3) as u32;
            *place += 1;
        }
        SignedDistances { tree, starts, triangles }
    }

    /// The signed distance of `p`; `None` if there are no triangles or `p` is not finite.
    pub fn at(&self, p: DVec3) -> Option<SignedDistance> {
        let q = self.tree.query(p)?;
        self.tree.nearest(q, None).map(|nearest| self.signed(p, q, &nearest))
    }

    /// The signed distance of each of `points`.
    ///
    /// Errors: [`Error::NonFinitePoint`], [`Error::Empty`] if there are no triangles.
    pub fn at_points(
        &self,
        points: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Vec<SignedDistance>, Error> {
        let tree = self.tree;
        tree.check_points(points)?;
        batch::ordered(&tree.nodes.frame, points, progress, |i, last: &mut Option<usize>| {
            let q = tree.query(points[i]).expect("points were checked");
            let nearest = tree.nearest(q, *last).expect("there are triangles");
            *last = Some(nearest.triangle);
            self.signed(points[i], q, &nearest)
        })
    }

    fn signed(&self, p: DVec3, q: DVec3, nearest: &Nearest) -> SignedDistance {
        let closest = self.tree.closest_of(p, nearest);
        let from = q - self.tree.point_at(nearest.triangle, nearest.weights);
        let is_inside = from.dot(self.pseudonormal(nearest)) < 0.0;
        let distance = if is_inside { -closest.distance } else { closest.distance };
        SignedDistance { distance, closest }
    }

    /// The angle-weighted normal where the surface is nearest: of any length, zero where there is none.
    fn pseudonormal(&self, nearest: &Nearest) -> DVec3 {
        let vertices = self.tree.vertices[nearest.triangle];
        let is_zero = nearest.weights.map(|w| w == 0.0);
        match is_zero {
            [false, false, false] => self.normal(nearest.triangle),
            [false, true, true] => self.vertex_normal(vertices[0]),
            [true, false, true] => self.vertex_normal(vertices[1]),
            [true, true, _] => self.vertex_normal(vertices[2]),
            [true, ..] => self.edge_normal(vertices[1], vertices[2]),
            [_, true, _] => self.edge_normal(vertices[2], vertices[0]),
            [.., true] => self.edge_normal(vertices[0], vertices[1]),
        }
    }

    fn normal(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.tree.triangles[triangle];
        scale::unit((b - a).cross(c - a))
    }

    fn edge_normal(&self, v: VertexId, w: VertexId) -> DVec3 {
        let with_w = self.around(v).filter(|&i| self.tree.vertices[i].contains(&w));
        with_w.map(|i| self.normal(i)).sum()
    }

    fn vertex_normal(&self, v: VertexId) -> DVec3 {
        let weighted = |i: usize| {
            let k = self.tree.vertices[i].iter().position(|&u| u == v).unwrap_or(0);
            let corners = self.tree.triangles[i];
            let [a, b, c] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
            scale::angle(b - a, c - a) * self.normal(i)
        };
        self.around(v).map(weighted).sum()
    }

    /// The triangles at `v`.
    fn around(&self, v: VertexId) -> impl Iterator<Item = usize> + '_ {
        let range = self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize;
        self.triangles[range].iter().map(|&i| i as usize)
    }
}
