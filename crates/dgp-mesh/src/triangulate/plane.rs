//! A polygon in space, seen in the plane.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// The corners of a polygon in the coordinate plane that its normal is closest to.
///
/// The polygon turns counterclockwise there, if it has an area. Coordinates are those in space, times
/// a power of two that keeps products from overflowing.
pub(super) struct View {
    pub(super) points: Vec<DVec2>,
    /// The power of two.
    pub(super) unit: f64,
}

impl View {
    pub(super) fn new(corners: &[DVec3]) -> Self {
        let unit = power_of_two_near(corners);
        let normal = newell_normal(corners, unit);
        let size = normal.abs();
        let axis = match (size.z >= size.x && size.z >= size.y, size.y >= size.x) {
            (true, _) => 2,
            (false, true) => 1,
            (false, false) => 0,
        };
        let normal_is_negative = normal[axis] < 0.0;
        // The two other axes in cyclic order, swapped if the polygon is seen from behind.
        let (mut first, mut second) = ((axis + 1) % 3, (axis + 2) % 3);
        if normal_is_negative {
            (first, second) = (second, first);
        }
        let points = corners.iter().map(|p| DVec2::new(p[first] * unit, p[second] * unit));
        View { points: points.collect(), unit }
    }

    /// The sign of the area of a triangle of corners: exact, 0 if they are on a line.
    pub(super) fn turn(&self, a: usize, b: usize, c: usize) -> f64 {
        turn(self.points[a], self.points[b], self.points[c])
    }

    /// Whether all triangles from the first corner turn counterclockwise.
    pub(super) fn is_fan(&self) -> bool {
        (1..self.points.len() - 1).all(|k| self.turn(0, k, k + 1) > 0.0)
    }
}

/// Positive if a, b, c turn counterclockwise, negative if clockwise, 0 if they are on a line: exact.
pub(super) fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// A power of two that brings the largest coordinate to about 1; 1 where there is none.
fn power_of_two_near(corners: &[DVec3]) -> f64 {
    let largest = corners.iter().fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()));
    if !(largest > 0.0 && largest.is_finite()) {
        return 1.0;
    }
    let exponent = (largest.to_bits() >> 52) as i32 - 1023;
    2.0_f64.powi(-exponent.clamp(-1000, 1000))
}

/// Twice the vector area. Corners are taken relative to the first, for accuracy far from the origin.
fn newell_normal(corners: &[DVec3], unit: f64) -> DVec3 {
    let origin = corners[0] * unit;
    let relative = |i: usize| corners[i] * unit - origin;
    (2..corners.len()).map(|i| relative(i - 1).cross(relative(i))).sum()
}
