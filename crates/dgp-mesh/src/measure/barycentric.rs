//! Barycentric coordinates: a point of a triangle as a mean of its corners.
//!
//! ```text
//! p = α a + β b + γ c,   α + β + γ = 1,   α = area(p, b, c) / area(a, b, c), …
//! ```
//!
//! In the plane the areas are exact but for one rounding, so that the sign of a coordinate tells on
//! which side of an edge the point lies, in the thinnest needle too.
//!
//! - Input: any triangle, in the plane or in space.
//! - Cost: O(1).
//! - Reference: Möbius, *Der barycentrische Calcul*, 1827; Shewchuk, "Adaptive precision
//!   floating-point arithmetic and fast robust geometric predicates", Discrete & Computational
//!   Geometry 18, 1997 (exact sums).

use glam::{DVec2, DVec3};

use super::scale::Scale;
use crate::AttributeValue;

/// The coordinates of `p` in the triangle of `corners` in the plane; `None` if that has no area.
///
/// They sum to 1 but for rounding, are positive inside, zero exactly on the line of the opposite
/// side, and negative beyond it. Differences below 2⁻⁵⁰⁰ of the largest coordinate count as none.
pub fn barycentric_2d(p: DVec2, corners: [DVec2; 3]) -> Option<[f64; 3]> {
    let size = corners.iter().fold(p.abs(), |size, corner| size.max(corner.abs())).max_element();
    let down = Scale::of(size).down;
    let (p, [a, b, c]) = (p * down, corners.map(|corner| corner * down));
    let whole = doubled_area(a, b, c);
    if whole == 0.0 || !size.is_finite() {
        return None;
    }
    Some([doubled_area(p, b, c), doubled_area(p, c, a), doubled_area(p, a, b)].map(|x| x / whole))
}

/// The coordinates of the point of the plane of `corners` nearest to `p`; `None` if the triangle has
/// no area.
///
/// They sum to 1 but for rounding; beyond a side the coordinate of the opposite corner is negative.
pub fn barycentric_3d(p: DVec3, corners: [DVec3; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = corners;
    let scale = Scale::of_vectors(0.5 * b - 0.5 * a, 0.5 * c - 0.5 * a);
    let to_local = |x: DVec3| 0.5 * scale.down * x - 0.5 * scale.down * a;
    let (p, b, c) = (to_local(p), to_local(b), to_local(c));
    let normal = b.cross(c);
    // Each part has the length of a doubled area once, the common factor another time.
    let parts = [(b - p).cross(c - p), (c - p).cross(-p), b.cross(p)].map(|n| n.dot(normal));
    let [x, y] = [parts[1], parts[2]].map(|part| part / normal.length_squared());
    (x.is_finite() && y.is_finite()).then(|| {
        let first = parts[0] / normal.length_squared();
        [first, x, y]
    })
}

/// Where a point lies in a triangle. Corners and sides are numbered 0, 1, 2; side k is opposite
/// corner k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriangleLocation {
    /// Within, on no side.
    Inside,
    /// On this side, between its ends.
    OnSide(usize),
    /// At this corner.
    AtCorner(usize),
    /// Not in the triangle.
    Outside,
}

/// Where the point with these barycentric coordinates lies: exact for those of [`barycentric_2d`].
pub fn triangle_location(coordinates: [f64; 3]) -> TriangleLocation {
    if coordinates.iter().any(|x| x.is_nan() || *x < 0.0) {
        return TriangleLocation::Outside;
    }
    let zero = |k: usize| coordinates[k] == 0.0;
    match [0, 1, 2].into_iter().filter(|&k| zero(k)).count() {
        0 => TriangleLocation::Inside,
        1 => TriangleLocation::OnSide((0..3).position(zero).unwrap_or(0)),
        _ => TriangleLocation::AtCorner((0..3).position(|k| !zero(k)).unwrap_or(0)),
    }
}

/// The value at barycentric `coordinates` between the `values` at the corners.
///
/// Numbers are interpolated linearly, everything else as its type says; `coordinates` must not be
/// negative.
pub fn interpolate<T: AttributeValue>(coordinates: [f64; 3], values: [&T; 3]) -> T {
    let [x, y, z] = coordinates;
    T::mix(&[(x, values[0]), (y, values[1]), (z, values[2])])
}

/// Twice the signed area of a triangle, exact but for one rounding.
fn doubled_area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    // Rounding moves the plain formula by less than this part of the sum of its terms (Shewchuk's
    // bound for orient2d is 3.3e-16); beyond it the result is good to 44 bits, and the sign is sure.
    const SAFE: f64 = 1.0 / (1_u64 << 44) as f64;
    let (u, v) = (b - a, c - a);
    let (left, right) = (u.x * v.y, u.y * v.x);
    let plain = left - right;
    if plain.abs() > SAFE.sqrt() * (left.abs() + right.abs()) {
        return plain;
    }
    // a × b + b × c + c × a as a sum of numbers that have no bits in common.
    let mut sum = Expansion::default();
    for (p, q) in [(a, b), (b, c), (c, a)] {
        sum.add_product(p.x, q.y);
        sum.add_product(-p.y, q.x);
    }
    sum.value()
}

/// An exact sum of up to twelve numbers, smallest first (Shewchuk's nonoverlapping expansion).
#[derive(Default)]
struct Expansion {
    parts: [f64; 12],
    len: usize,
}

impl Expansion {
    fn add_product(&mut self, x: f64, y: f64) {
        let product = x * y;
        let ((x_high, x_low), (y_high, y_low)) = (split(x), split(y));
        let error =
            x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low);
        self.add(error);
        self.add(product);
    }

    /// Shewchuk's Grow-Expansion.
    fn add(&mut self, x: f64) {
        let mut carry = x;
        for part in &mut self.parts[..self.len] {
            let sum = carry + *part;
            let virtual_part = sum - carry;
            let error = (carry - (sum - virtual_part)) + (*part - virtual_part);
            *part = error;
            carry = sum;
        }
        self.parts[self.len] = carry;
        self.len += 1;
    }

    fn value(&self) -> f64 {
        self.parts[..self.len].iter().sum()
    }
}

/// The upper and the lower half of the bits of `x` (Dekker's split).
fn split(x: f64) -> (f64, f64) {
    let c = ((1_u64 << 27) + 1) as f64 * x;
    let high = c - (c - x);
    (high, x - high)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec2> {
        (-1.0..1.0_f64, -1.0..1.0_f64).prop_map(|(x, y)| DVec2::new(x, y))
    }

    proptest! {
        #[test]
        fn a_point_is_the_mean_of_the_corners(a in point(), b in point(), c in point(), p in point()) {
            if let Some(w) = barycentric_2d(p, [a, b, c]) {
                let size = w.iter().fold(1.0, |s: f64, x| s.max(x.abs()));
                prop_assert!((w.iter().sum::<f64>() - 1.0).abs() <= 1e-6 * 1e-9 * size.max(1e6));
                prop_assert!((w[0] * a + w[1] * b + w[2] * c - p).length() <= 1e-14 * size);
            }
        }

        #[test]
        fn in_space_it_is_that_of_the_nearest_point_of_the_plane(
            a in proptest::array::uniform3(-1.0..1.0_f64),
            b in proptest::array::uniform3(-1.0..1.0_f64),
            c in proptest::array::uniform3(-1.0..1.0_f64),
            w in proptest::array::uniform2(-1.0..2.0_f64),
            height in -1.0..1.0_f64,
        ) {
            let [a, b, c] = [a, b, c].map(DVec3::from_array);
            let normal = (b - a).cross(c - a);
            prop_assume!(normal.length() > 1e-3);
            let foot = w[0] * a + w[1] * b + (1.0 - w[0] - w[1]) * c;
            let found = barycentric_3d(foot + height * normal, [a, b, c]).unwrap();
            prop_assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            prop_assert!((found[0] * a + found[1] * b + found[2] * c - foot).length() < 1e-9);
        }

        #[test]
        fn mirrored_order_gives_the_same_numbers(a in point(), b in point(), c in point(), p in point()) {
            let there = barycentric_2d(p, [a, b, c]);
            let back = barycentric_2d(p, [c, b, a]).map(|[x, y, z]| [z, y, x]);
            if let (Some(x), Some(y)) = (there, back) {
                prop_assert_eq!(triangle_location(x), triangle_location(y));
            }
        }
    }

    #[test]
    fn the_border_is_reported_in_the_thinnest_needle() {
        // The three points lie on the line y = x / 3 but for one unit in the last place.
        let corners =
            [DVec2::ZERO, DVec2::new(3.0, 1.0), DVec2::new(6.0, 2.0 + 4.0 * f64::EPSILON)];
        let at = |p: DVec2| triangle_location(barycentric_2d(p, corners).unwrap());
        assert_eq!(at(corners[1]), TriangleLocation::AtCorner(1));
        assert_eq!(at(DVec2::new(1.5, 0.5)), TriangleLocation::OnSide(2));
        assert_eq!(at(DVec2::new(1.5, 0.5 - f64::EPSILON / 4.0)), TriangleLocation::Outside);
        assert_eq!(at(0.5 * corners[2]), TriangleLocation::OnSide(1));
        assert_eq!(barycentric_2d(DVec2::X, [DVec2::ZERO, DVec2::ONE, 2.0 * DVec2::ONE]), None);
    }

    #[test]
    fn neither_huge_nor_tiny_triangles_lose_the_coordinates() {
        for k in [-600, -300, 300, 600] {
            let corners = [DVec2::ZERO, DVec2::X, DVec2::Y].map(|c| c * 2_f64.powi(k));
            let p = DVec2::new(0.25, 0.5) * 2_f64.powi(k);
            assert_eq!(barycentric_2d(p, corners), Some([0.25, 0.25, 0.5]), "2^{k}");
            let in_space = barycentric_3d(p.extend(1.0), corners.map(|c| c.extend(1.0)));
            assert_eq!(in_space, Some([0.25, 0.25, 0.5]), "2^{k}");
        }
    }

    #[test]
    fn attributes_are_interpolated() {
        assert_eq!(interpolate([0.25, 0.25, 0.5], [&1.0, &3.0, &5.0]), 3.5);
        assert_eq!(interpolate([0.2, 0.5, 0.3], [&1_i32, &7, &9]), 7);
    }
}
