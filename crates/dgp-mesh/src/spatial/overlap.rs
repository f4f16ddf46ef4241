//! The faces near a place: in a box, within a radius, the k nearest.
//!
//! A triangle and a box are apart if one of 13 directions keeps them apart: the sides of the box, the
//! normal of the triangle, and the products of their edges.
//!
//! - Input: any surface.
//! - Cost: some log n and the number of triangles found or nearly so.
//! - Guarantees: faces in order, each once; what only touches counts. A triangle further than rounding
//!   (2⁻⁵⁰ of the coordinates) from the border of the box or of the radius is on its right side.
//! - Reference: Akenine-Möller, "Fast 3D triangle-box overlap testing", Journal of Graphics Tools 6(1),
//!   2001.

use glam::DVec3;

use super::{
    ClosestPoint, TriangleTree,
    closest_point::{Nearest, closest_in_triangle},
};
use crate::{FaceId, measure::BoundingBox};

impl TriangleTree {
    /// The faces that meet `query`, in order.
    pub fn faces_in_box(&self, query: &BoundingBox) -> Vec<FaceId> {
        let frame = &self.nodes.frame;
        let (min, max) = (frame.scaled(query.min), frame.scaled(query.max));
        let ((lo, _), (_, hi)) = (frame.rounded(min), frame.rounded(max));
        let (center, half) = (0.5 * min + 0.5 * max, 0.5 * max - 0.5 * min);
        let mut faces = Vec::new();
        if !min.cmple(max).all() {
            return faces;
        }
        self.nodes.overlapping(lo, hi, |items| {
            let meets = |&i: &usize| {
                let triangle = &self.triangles[i];
                let within = |p: &DVec3| min.cmple(*p).all() && p.cmple(max).all();
                triangle.iter().any(within) || meets_box(triangle.map(|p| p - center), half)
            };
            faces.extend(items.filter(meets).map(|i| self.faces[i]));
            true
        });
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// The faces with a point not further than `radius` from `p`, in order; none if `p` is not finite.
    pub fn faces_within(&self, p: DVec3, radius: f64) -> Vec<FaceId> {
        let mut faces = Vec::new();
        let Some(q) = self.query(p).filter(|_| radius >= 0.0) else { return faces };
        let given = radius;
        let radius = radius * self.nodes.frame.scale.down;
        let square = radius * radius;
        let actual = self.nodes.frame.scaled(p);
        if q != actual {
            // Moved nearer, so all triangles are looked at, or only the nearest where squares overflow.
            let near = |&i: &usize| closest_in_triangle(actual, &self.triangles[i]).0 <= square;
            let all = (0..self.len()).filter(|i| square.is_finite() && near(i));
            faces.extend(all.map(|i| self.faces[i]));
            if square.is_infinite()
                && self.closest_point(p).is_some_and(|hit| hit.distance <= given)
            {
                faces.clone_from(&self.faces);
            }
            faces.sort_unstable();
            faces.dedup();
            return faces;
        }
        self.nodes.near(q, square, |items| {
            let near = |&i: &usize| closest_in_triangle(q, &self.triangles[i]).0 <= square;
            faces.extend(items.filter(near).map(|i| self.faces[i]));
            square
        });
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// The nearest points of the `count` faces nearest to `p`, nearest first; fewer if there are fewer
    /// faces, none if `p` is not finite.
    pub fn nearest_faces(&self, p: DVec3, count: usize) -> Vec<ClosestPoint> {
        let mut best: Vec<Nearest> = Vec::with_capacity(count.min(self.len()) + 1);
        let Some(q) = self.query(p).filter(|_| count > 0) else { return Vec::new() };
        let key = |nearest: &Nearest| (nearest.square.to_bits(), self.faces[nearest.triangle]);
        self.nodes.near(q, f64::INFINITY, |items| {
            for triangle in items {
                let (square, weights) = closest_in_triangle(q, &self.triangles[triangle]);
                let new = Nearest { square, triangle, weights };
                let same = best.iter().position(|b| self.faces[b.triangle] == key(&new).1);
                match same {
                    Some(i) if key(&best[i]) <= key(&new) => continue,
                    Some(i) => drop(best.remove(i)),
                    None => {}
                }
                let place = best.partition_point(|b| key(b) < key(&new));
                if place < count {
                    best.insert(place, new);
                    best.truncate(count);
                }
            }
            if best.len() < count { f64::INFINITY } else { best[count - 1].square }
        });
        best.iter().map(|nearest| self.closest_of(p, nearest)).collect()
    }
}

/// Whether a triangle meets the box from −`half` to `half`.
fn meets_box(corners: [DVec3; 3], half: DVec3) -> bool {
    let [a, b, c] = corners;
    if !(a.min(b).min(c).cmple(half).all() && a.max(b).max(c).cmpge(-half).all()) {
        return false;
    }
    let edges = [b - a, c - b, a - c];
    let normal = edges[0].cross(edges[1]);
    if normal.dot(a).abs() > normal.abs().dot(half) {
        return false;
    }
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for edge in edges {
            let across = axis.cross(edge);
            let shadow = corners.map(|p| across.dot(p));
            let reach = across.abs().dot(half);
            let (lo, hi) =
                (shadow[0].min(shadow[1]).min(shadow[2]), shadow[0].max(shadow[1]).max(shadow[2]));
            if lo > reach || hi < -reach {
                return false;
            }
        }
    }
    true
}
