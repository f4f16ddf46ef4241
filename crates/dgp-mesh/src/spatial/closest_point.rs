//! The point of a surface nearest to a given one.
//!
//! Boxes are looked at nearest first; those further away than the best triangle so far are not
//! entered. In a triangle the nearest point lies inside, on a side or at a corner, as signs of
//! barycentric coordinates tell.
//!
//! - Input: any surface, any point.
//! - Cost: some log n for points near the surface; many in parallel, in an order in which each is near
//!   the one before.
//! - Guarantees: of all triangles the one with the smallest computed distance, of equals the one of the
//!   face first in the surface. Many at once give the same bits as one by one.
//! - Reference: Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5 (triangle); Hjaltason and
//!   Samet, "Distance browsing in spatial databases", ACM Transactions on Database Systems 24(2), 1999.
//! - Departs from it: triangles so thin that signs are rounding are looked at side by side as well.

use glam::DVec3;

use super::{TriangleTree, batch};
use crate::{Error, FaceId, Progress, VertexId, measure::scale};

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Where it is.
    pub point: DVec3,
    /// How far that is from the given point.
    pub distance: f64,
    /// The face it lies on.
    pub face: FaceId,
    /// The triangle it lies in: the corners of the face, or of a part of it if that is a polygon.
    pub vertices: [VertexId; 3],
    /// Its coordinates in that triangle: not negative, of sum 1.
    pub barycentric: [f64; 3],
}

/// What a question found, so that one asked nearby is answered sooner; by default nothing.
///
/// It belongs to the tree that was asked. Answers do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Near {
    triangle: u32,
}

impl Default for Near {
    fn default() -> Self {
        Near { triangle: u32::MAX }
    }
}

/// The best so far: squared distance in the frame, which triangle, and where in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) square: f64,
    pub(super) triangle: usize,
    pub(super) weights: [f64; 3],
}

impl TriangleTree {
    /// The nearest point of the surface, or `None` if it has no triangles or `p` is not finite.
    pub fn closest_point(&self, p: DVec3) -> Option<ClosestPoint> {
        let q = self.query(p)?;
        self.nearest(q, None).map(|nearest| self.closest_of(p, &nearest))
    }

    /// What [`closest_point`](Self::closest_point) gives, sooner if `near` was found nearby; `near` becomes what
    /// is found now. For points that move by little, each keeps its own.
    pub fn closest_point_near(&self, p: DVec3, near: &mut Near) -> Option<ClosestPoint> {
        let q = self.query(p)?;
        let guess = near.triangle as usize;
        let nearest = self.nearest(q, (guess < self.len()).then_some(guess))?;
        near.triangle = nearest.triangle as u32;
        Some(self.closest_of(p, &nearest))
    }

    /// The nearest point of the surface for each of `points`, as [`closest_point`](Self::closest_point)
    /// gives it.
    ///
    /// Errors: [`Error::NonFinitePoint`], [`Error::Empty`] if there are no triangles.
    pub fn closest_points(
        &self,
        points: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Vec<ClosestPoint>, Error> {
        self.check_points(points)?;
        batch::ordered(&self.nodes.frame, points, progress, |i, last: &mut Option<usize>| {
            let q = self.query(points[i]).expect("points were checked");
            let nearest = self.nearest(q, *last).expect("there are triangles");
            *last = Some(nearest.triangle);
            self.closest_of(points[i], &nearest)
        })
    }

    /// Whether there is something to find and all `points` are finite.
    pub(super) fn check_points(&self, points: &[DVec3]) -> Result<(), Error> {
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(Error::NonFinitePoint { index });
        }
        if self.is_empty() { Err(Error::Empty) } else { Ok(()) }
    }

    /// `p` in the frame, points very far away drawn nearer; `None` if there is nothing to find.
    pub(super) fn query(&self, p: DVec3) -> Option<DVec3> {
        // Further away, an f64 tells distances apart by more than the surface looks different from here.
        const FAR: f64 = (1_u64 << 26) as f64;
        if self.is_empty() || !p.is_finite() {
            return None;
        }
        let frame = &self.nodes.frame;
        let local = frame.scaled(p) - frame.center;
        if local.abs().max_element() <= FAR {
            return Some(frame.scaled(p));
        }
        let center = self.bounds?.center();
        Some(frame.center + scale::unit(0.5 * p - 0.5 * center) * FAR)
    }

    /// The nearest triangle to `q`, which is scaled; `guess` is a triangle that may be near.
    pub(super) fn nearest(&self, q: DVec3, guess: Option<usize>) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        let look = |i: usize, best: &mut Option<Nearest>| {
            let (square, weights) = closest_in_triangle(q, &self.triangles[i]);
            let is_better = best.is_none_or(|best| {
                square < best.square
                    || (square == best.square && self.faces[i] < self.faces[best.triangle])
            });
            if is_better {
                *best = Some(Nearest { square, triangle: i, weights });
            }
        };
        if let Some(i) = guess {
            look(i, &mut best);
        }
        let limit = best.map_or(f64::INFINITY, |best| best.square);
        self.nodes.near(q, limit, |items| {
            items.for_each(|i| look(i, &mut best));
            best.map_or(f64::INFINITY, |best| best.square)
        });
        best
    }

    /// A point of a triangle, in the frame.
    #[inline]
    pub(super) fn point_at(&self, triangle: usize, weights: [f64; 3]) -> DVec3 {
        let [a, b, c] = self.triangles[triangle];
        match weights {
            [1.0, ..] => a,
            [_, 1.0, _] => b,
            [.., 1.0] => c,
            [_, v, w] => a + v * (b - a) + w * (c - a),
        }
    }

    /// What was found, in the units of the surface.
    pub(super) fn closest_of(&self, p: DVec3, nearest: &Nearest) -> ClosestPoint {
        let Nearest { triangle, weights: barycentric, .. } = *nearest;
        let point = self.point_at(triangle, barycentric) * self.nodes.frame.scale.up;
        ClosestPoint {
            point,
            distance: scale::distance(p, point),
            face: self.faces[triangle],
            vertices: self.vertices[triangle],
            barycentric,
        }
    }
}

/// The squared distance from `p` to a triangle, and the weights of its corners in the nearest point:
/// exactly zero for the corner opposite to a side and exactly one for a corner on which it lies.
#[inline]
pub(super) fn closest_in_triangle(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> (f64, [f64; 3]) {
    // Triangles of a smaller (area / product of sides)² are thin.
    const THIN: f64 = 1e-10;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (bb, bc, cc) = (ab.dot(ab), ab.dot(ac), ac.dot(ac));
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    let whole = bb * cc - bc * bc;
    if whole <= THIN * bb * cc || !whole.is_normal() {
        return closest_in_thin_triangle(p, [a, b, c]);
    }
    let (d3, d4, d5, d6) = (d1 - bb, d2 - bc, d1 - bc, d2 - cc);
    if d1 <= 0.0 && d2 <= 0.0 {
        return (ap.length_squared(), [1.0, 0.0, 0.0]);
    }
    if d3 >= 0.0 && d4 <= d3 {
        return ((p - b).length_squared(), [0.0, 1.0, 0.0]);
    }
    if d6 >= 0.0 && d5 <= d6 {
        return ((p - c).length_squared(), [0.0, 0.0, 1.0]);
    }
    let vc = d1 * d4 - d3 * d2;
    let vb = d5 * d2 - d1 * d6;
    let va = d3 * d6 - d5 * d4;
    let [u, v, w] = if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let along = d1 / bb;
        [1.0 - along, along, 0.0]
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let along = d2 / cc;
        [1.0 - along, 0.0, along]
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        [0.0, 1.0 - along, along]
    } else {
        let sum = va + vb + vc;
        let (v, w) = (vb / sum, vc / sum);
        [(1.0 - v - w).max(0.0), v, w]
    };
    ((ap - v * ab - w * ac).length_squared(), [u, v, w])
}

/// [`closest_in_triangle`] where the triangle is nearly or wholly a line: the best of its sides and of
/// what lies inside.
#[cold]
fn closest_in_thin_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> (f64, [f64; 3]) {
    let along = |from: DVec3, to: DVec3| {
        let side = to - from;
        let t = side.dot(p - from) / side.length_squared();
        // A side of length zero gives no number, and its start.
        if t > 0.0 { t.min(1.0) } else { 0.0 }
    };
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (t_ab, t_ac, t_bc) = (along(a, b), along(a, c), along(b, c));
    let mut best = (f64::INFINITY, [1.0, 0.0, 0.0]);
    let mut offer = |weights: [f64; 3]| {
        let from = match weights {
            [1.0, ..] => ap,
            [_, 1.0, _] => p - b,
            [.., 1.0] => p - c,
            [_, v, w] => ap - v * ab - w * ac,
        };
        let square = from.length_squared();
        if square < best.0 {
            best = (square, weights);
        }
    };
    offer([1.0 - t_ab, t_ab, 0.0]);
    offer([1.0 - t_ac, 0.0, t_ac]);
    offer([0.0, 1.0 - t_bc, t_bc]);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let [v, w] = [ap.cross(ac).dot(normal) / square, ab.cross(ap).dot(normal) / square];
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        offer([1.0 - v - w, v, w]);
    }
    best
}
