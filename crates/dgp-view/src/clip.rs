//! Cutting off what lies before the camera or too far beside it.
//!
//! Reference: Sutherland, Hodgman, "Reentrant polygon clipping", Communications of the ACM 17(1), 1974.

use dgp_mesh::DVec3;

use crate::{
    camera::Camera,
    raster::{GUARD, Landed, UNIT, land},
};

/// The pieces of a triangle that are before the near plane and inside the guard band; none if a
/// corner is nowhere.
pub(crate) fn clip(
    corners: [DVec3; 3],
    camera: &Camera,
) -> impl Iterator<Item = [Landed; 3]> + use<> {
    let mut polygon = Polygon::EMPTY;
    if corners.iter().all(|p| p.is_finite()) {
        polygon = Polygon::of(corners);
    }
    // A little inside, so that rounding does not put the new corners outside again.
    let near = camera.near * (1.0 + 1e-9);
    polygon = polygon.cut(|p| -p.z - near);
    let limit = (GUARD - 2.0) / UNIT as f64 * (1.0 - 1e-9);
    for axis in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y] {
        polygon = polygon.cut(|p| {
            let depth = if camera.perspective { -p.z } else { 1.0 };
            limit * depth - camera.focal * axis.dot(p)
        });
    }
    let landed = polygon.points.map(|p| land(p, camera));
    (2..polygon.len).map(move |i| [landed[0], landed[i - 1], landed[i]])
}

/// A convex polygon: a triangle cut by five planes has at most eight corners.
struct Polygon {
    points: [DVec3; 8],
    len: usize,
}

impl Polygon {
    const EMPTY: Polygon = Polygon { points: [DVec3::ZERO; 8], len: 0 };

    fn of(corners: [DVec3; 3]) -> Self {
        let mut points = [DVec3::ZERO; 8];
        points[..3].copy_from_slice(&corners);
        Polygon { points, len: 3 }
    }

    fn push(&mut self, p: DVec3) {
        self.points[self.len] = p;
        self.len += 1;
    }

    /// The part where `height` is not negative.
    fn cut(&self, height: impl Fn(DVec3) -> f64) -> Polygon {
        let mut rest = Polygon::EMPTY;
        for i in 0..self.len {
            let (p, q) = (self.points[i], self.points[(i + 1) % self.len]);
            let (above, next) = (height(p), height(q));
            if above >= 0.0 {
                rest.push(p);
            }
            // From inside to outside in both cases: neighbors get the same point on a shared side.
            if above >= 0.0 && next < 0.0 {
                rest.push(p + (q - p) * (above / (above - next)));
            } else if above < 0.0 && next >= 0.0 {
                rest.push(q + (p - q) * (next / (next - above)));
            }
        }
        rest
    }
}
