//! The corners of a face do not all lie on one line.
//!
//! Decided exactly: three points lie on a line if and only if their projections along each axis do, and
//! that is the sign of a determinant, which Shewchuk's adaptive arithmetic gets right. A bound on the
//! rounding error settles nearly all faces without it.
//!
//! - Input: any faces; those with coordinates that are no numbers are passed over.
//! - Cost: O(corners).
//! - Reference: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
//!   predicates", Discrete & Computational Geometry 1997.
//! - Departs from it: coordinates are first scaled by a power of two, so that only products some
//!   10⁻³⁰⁰ times those of the largest coordinates can underflow.

use glam::DVec3;
use robust::{Coord, orient2d};

use super::Elements;
use crate::{FaceId, IndexedFaceSet, VertexId, VertexMap, parallel};

/// (3 + 16 ε) ε with ε = 2⁻⁵³: the rounding error of the determinant, relative to its two products.
const ERROR_BOUND: f64 = 3.330_669_073_875_472e-16;

/// Below this a determinant may have lost bits to underflow.
const TINY: f64 = 1e-280;

/// The faces of three or more corners whose corners are finite and all on one line.
pub(super) fn find(set: &IndexedFaceSet) -> Elements {
    let faces = set.faces();
    let blocks = parallel::map_blocks(faces.len(), parallel::BLOCK, |block| {
        let flat = |&f: &FaceId| is_flat(set.positions(), faces.face(f));
        block.map(FaceId::new).filter(flat).collect::<Vec<_>>()
    });
    Elements::Faces(blocks.concat())
}

/// Whether a face of three or more corners has them all on one line, or in one point.
pub(crate) fn is_flat(positions: &VertexMap<DVec3>, face: &[VertexId]) -> bool {
    if let [a, b, c] = *face {
        return on_a_line(positions[a], positions[b], positions[c]);
    }
    if face.len() < 3 || face.iter().any(|&v| !positions[v].is_finite()) {
        return false;
    }
    let a = positions[face[0]];
    let Some(b) = face.iter().map(|&v| positions[v]).find(|&b| b != a) else {
        return true;
    };
    face.iter().all(|&v| on_a_line(a, b, positions[v]))
}

/// Whether three points lie on one line; false if a coordinate is no finite number.
#[inline]
fn on_a_line(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let (u, v) = (a - c, b - c);
    let surely_not = |left: f64, right: f64| {
        let determinant = (left - right).abs();
        determinant > ERROR_BOUND * (left.abs() + right.abs()) && determinant > TINY
    };
    let not = surely_not(u.x * v.y, u.y * v.x)
        || surely_not(u.y * v.z, u.z * v.y)
        || surely_not(u.z * v.x, u.x * v.z);
    !not && on_a_line_exactly(a, b, c)
}

#[cold]
fn on_a_line_exactly(a: DVec3, b: DVec3, c: DVec3) -> bool {
    if !(a.is_finite() && b.is_finite() && c.is_finite()) {
        return false;
    }
    if a == b || b == c || c == a {
        return true;
    }
    let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
    let exponent = (largest.log2().floor() as i32).clamp(-1000, 1000);
    let scale = 2.0_f64.powi(-exponent);
    let [a, b, c] = [a, b, c].map(|p| p * scale);
    let zero = |x: fn(DVec3) -> f64, y: fn(DVec3) -> f64| {
        let coord = |p: DVec3| Coord { x: x(p), y: y(p) };
        orient2d(coord(a), coord(b), coord(c)) == 0.0
    };
    zero(|p| p.x, |p| p.y) && zero(|p| p.y, |p| p.z) && zero(|p| p.z, |p| p.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceList;

    #[test]
    fn thin_is_not_flat_at_any_size() {
        for exponent in [-900, -300, -1, 0, 1, 300, 900] {
            let scale = 2.0_f64.powi(exponent);
            let third = DVec3::new(0.5, 1e-16, 0.0);
            assert!(!on_a_line(DVec3::ZERO, DVec3::X * scale, third * scale), "2^{exponent}");
        }
        let (a, b) = (DVec3::splat(0.1), DVec3::splat(0.3));
        assert!(!on_a_line(a, b, DVec3::new(0.2, 0.2, 0.2_f64.next_up())));
    }

    #[test]
    fn points_on_a_line_are_flat_at_any_size() {
        for exponent in [-900, 0, 900] {
            let p = |t: f64| DVec3::new(1.0 + t, 2.0 + 2.0 * t, 3.0 - t) * 2.0_f64.powi(exponent);
            assert!(on_a_line(p(0.0), p(4.0), p(1.0)), "2^{exponent}");
        }
        assert!(on_a_line(DVec3::MAX, DVec3::MIN, DVec3::ZERO));
    }

    #[test]
    fn polygons_are_flat_if_all_their_corners_are_on_a_line() {
        let positions = [0.0, 1.0, 2.0, 5.0].map(|x| DVec3::new(x, 0.0, 0.0));
        let positions = [&positions[..], &[DVec3::Y, DVec3::NAN]].concat();
        let faces: &[&[usize]] = &[&[0, 2, 1, 3], &[0, 1, 2, 4], &[0, 1, 2, 5], &[0, 0, 0, 0]];
        let set = IndexedFaceSet::new(positions, FaceList::from_indices(faces)).unwrap();
        assert_eq!(find(&set), Elements::Faces([0, 3].map(FaceId::new).to_vec()));
    }
}
