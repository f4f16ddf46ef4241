//! Which faces of a surface pass through each other.
//!
//! Two triangles meet if a side of one meets the other. What neighbors share does not count:
//!
//! ```text
//! share nothing      any common point counts, touching included
//! share a corner     the side opposite to it of one meets the other
//! share a side       they lie in one plane on the same side of it
//! share all          they count: one covers the other
//! ```
//!
//! Corners are shared if they are at the same place, whether or not they are the same vertex. All signs
//! are exact.
//!
//! - Input: any surface. Triangles without area are left out (`check` names them), and so are pairs of
//!   triangles of the same polygon.
//! - Cost: for each triangle those whose boxes meet its own, in parallel.
//! - Guarantees: exactly the pairs that meet, each once, in order.
//! - Reference: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
//!   predicates", Discrete & Computational Geometry 18, 1997; Guigue and Devillers, "Fast and robust
//!   triangle-triangle overlap test using orientation predicates", Journal of Graphics Tools 8(1), 2003.
//! - Departs from it: sides are tested one by one, which needs no case distinctions in one plane.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::{
    TriangleTree,
    frame::{above, below},
};
use crate::{Error, FaceId, Progress, parallel};

/// Triangles between two reports, and in a task.
const PER_REPORT: usize = 1 << 15;
const PER_TASK: usize = 256;

impl TriangleTree {
    /// The pairs of faces that meet in more than what they share, the smaller number first, in order.
    pub fn self_intersections(&self, progress: Progress<'_>) -> Result<Vec<[FaceId; 2]>, Error> {
        let mut pairs = Vec::new();
        for start in (0..self.len()).step_by(PER_REPORT) {
            progress.report(start as f64 / self.len() as f64)?;
            let count = PER_REPORT.min(self.len() - start);
            let blocks = parallel::map_blocks(count, PER_TASK, |range| {
                let mut found = Vec::new();
                for i in range.map(|i| start + i) {
                    self.meeting(i, &mut found);
                }
                found
            });
            pairs.extend(blocks.into_iter().flatten());
        }
        pairs.sort_unstable();
        pairs.dedup();
        progress.report(1.0)?;
        Ok(pairs)
    }

    /// Adds the pairs of triangle `i` and those behind it in the order of the leaves.
    fn meeting(&self, i: usize, pairs: &mut Vec<[FaceId; 2]>) {
        let triangle = &self.triangles[i];
        if plane_of(triangle).is_none() {
            return;
        }
        let [a, b, c] = triangle.map(|p| p - self.nodes.frame.center);
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        self.nodes.overlapping(lo.to_array().map(below), hi.to_array().map(above), |items| {
            for j in items.filter(|&j| j > i && self.faces[j] != self.faces[i]) {
                let other = &self.triangles[j];
                if boxes_meet(triangle, other) && meet(triangle, other) {
                    let (f, g) = (self.faces[i], self.faces[j]);
                    pairs.push([f.min(g), f.max(g)]);
                }
            }
            true
        });
    }
}

fn boxes_meet([a, b, c]: &[DVec3; 3], [p, q, r]: &[DVec3; 3]) -> bool {
    let (lo, hi) = (a.min(*b).min(*c), a.max(*b).max(*c));
    p.max(*q).max(*r).cmpge(lo).all() && p.min(*q).min(*r).cmple(hi).all()
}

/// Whether two triangles have a point in common beyond the corners they share.
fn meet(s: &[DVec3; 3], t: &[DVec3; 3]) -> bool {
    // For each corner of s the corner of t at the same place.
    let shared = s.map(|p| t.iter().position(|&q| p == q));
    match shared.iter().flatten().count() {
        0 => {
            !is_apart(s, t)
                && !is_apart(t, s)
                && (sides(s).any(|side| meets_triangle(side, t))
                    || sides(t).any(|side| meets_triangle(side, s)))
        }
        1 => {
            let Some((i, j)) = (0..3).find_map(|i| Some((i, shared[i]?))) else { return false };
            let [a, b] = [s[(i + 1) % 3], s[(i + 2) % 3]];
            let [c, d] = [t[(j + 1) % 3], t[(j + 2) % 3]];
            // Strictly on one side of the other's plane there is nothing but the corner.
            let [x, y] = [a, b].map(|p| side_of(t, p));
            if x * y > 0.0 {
                return false;
            }
            let [x, y] = [c, d].map(|p| side_of(s, p));
            x * y <= 0.0 && (meets_triangle([a, b], t) || meets_triangle([c, d], s))
        }
        2 => {
            let Some(i) = (0..3).find(|&i| shared[i].is_none()) else { return false };
            let Some(apex) = t.iter().find(|q| !s.contains(q)) else { return false };
            if side_of(s, *apex) != 0.0 {
                return false;
            }
            let Some(plane) = plane_of(s) else { return false };
            let side = [s[(i + 1) % 3], s[(i + 2) % 3]];
            turn(plane, side, s[i]) * turn(plane, side, *apex) > 0.0
        }
        _ => plane_of(t).is_some(),
    }
}

/// Whether all of `t` lies strictly on one side of the plane of `s`.
fn is_apart(s: &[DVec3; 3], t: &[DVec3; 3]) -> bool {
    let [x, y, z] = t.map(|p| side_of(s, p));
    (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0)
}

fn sides(&[a, b, c]: &[DVec3; 3]) -> impl Iterator<Item = [DVec3; 2]> {
    [[a, b], [b, c], [c, a]].into_iter()
}

/// Whether a segment and a triangle with area have a point in common.
fn meets_triangle([p, q]: [DVec3; 2], t: &[DVec3; 3]) -> bool {
    let (x, y) = (side_of(t, p), side_of(t, q));
    if (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0) {
        return false;
    }
    if x == 0.0 && y == 0.0 {
        return meets_in_plane([p, q], t);
    }
    let [a, b, c] = *t;
    let around = [[a, b], [b, c], [c, a]].map(|[u, v]| orientation(p, q, u, v));
    around.iter().all(|&x| x >= 0.0) || around.iter().all(|&x| x <= 0.0)
}

/// [`meets_triangle`] for a segment in the plane of the triangle.
fn meets_in_plane([p, q]: [DVec3; 2], t: &[DVec3; 3]) -> bool {
    let Some(plane) = plane_of(t) else { return false };
    let within = |p: DVec3| {
        let turns: Vec<f64> = sides(t).map(|side| turn(plane, side, p)).collect();
        turns.iter().all(|&x| x >= 0.0) || turns.iter().all(|&x| x <= 0.0)
    };
    within(p) || within(q) || sides(t).any(|side| segments_meet(plane, [p, q], side))
}

/// Whether two segments in a plane meet.
fn segments_meet(plane: Plane, [p, q]: [DVec3; 2], [a, b]: [DVec3; 2]) -> bool {
    let across = turn(plane, [a, b], p) * turn(plane, [a, b], q);
    let along = turn(plane, [p, q], a) * turn(plane, [p, q], b);
    across <= 0.0
        && along <= 0.0
        && (across < 0.0 || along < 0.0 || {
            let [p, q, a, b] = [p, q, a, b].map(|x| plane.view(x));
            let spans =
                |p: f64, q: f64, a: f64, b: f64| p.max(q) >= a.min(b) && a.max(b) >= p.min(q);
            spans(p.x, q.x, a.x, b.x) && spans(p.y, q.y, a.y, b.y)
        })
}

/// The two coordinates that are looked at.
#[derive(Clone, Copy)]
struct Plane(usize, usize);

impl Plane {
    fn view(self, p: DVec3) -> Coord<f64> {
        Coord { x: p[self.0], y: p[self.1] }
    }
}

/// Coordinates in which a triangle has area; `None` if there are none.
fn plane_of(t: &[DVec3; 3]) -> Option<Plane> {
    let normal = (t[1] - t[0]).cross(t[2] - t[0]).abs();
    let first = if normal.x >= normal.y && normal.x >= normal.z {
        0
    } else if normal.y >= normal.z {
        1
    } else {
        2
    };
    let planes = (first..first + 3).map(|axis| Plane((axis + 1) % 3, (axis + 2) % 3));
    planes.into_iter().find(|&plane| turn(plane, [t[0], t[1]], t[2]) != 0.0)
}

/// −1, 0 or 1: on which side of the line through two points a third is, seen in a plane.
fn turn(plane: Plane, [a, b]: [DVec3; 2], p: DVec3) -> f64 {
    sign(orient2d(plane.view(a), plane.view(b), plane.view(p)))
}

/// −1, 0 or 1: on which side of the plane of a triangle `p` is.
fn side_of(&[a, b, c]: &[DVec3; 3], p: DVec3) -> f64 {
    orientation(a, b, c, p)
}

fn orientation(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    sign(orient3d(a, b, c, d))
}

/// Products of signs cannot vanish as products of small numbers do.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}
