//! Measures of triangles that neither overflow nor vanish, whatever the unit.

use dgp_mesh::{DVec3, Mesh, measure::bounding_box};

use crate::Error;

/// The power of two below the largest of the coordinates of `p`; 1 for zero and what is no number.
fn size(p: DVec3) -> f64 {
    let largest = p.abs().max_element();
    if largest > 0.0 && largest.is_finite() { 2.0_f64.powi(exponent(largest)) } else { 1.0 }
}

fn exponent(x: f64) -> i32 {
    (x.log2().floor() as i32).clamp(-1000, 1000)
}

/// The corners relative to the first, scaled by a power of two to about one in size.
pub(super) fn normalized([a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    let (u, v) = (b - a, c - a);
    let scale = size(u.abs().max(v.abs()));
    [DVec3::ZERO, u / scale, v / scale]
}

pub(super) fn distance(a: DVec3, b: DVec3) -> f64 {
    let scale = size(b - a);
    scale * ((b - a) / scale).length()
}

/// Twice the area of the triangle scaled to about one in size, as a vector along its normal.
pub(super) fn normal(triangle: &[DVec3; 3]) -> DVec3 {
    let [_, u, v] = normalized(*triangle);
    u.cross(v)
}

/// How far `c` is from the line through `a` and `b`; from `a` if they are at one place.
pub(super) fn height(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (scale, [_, u, v]) = (size((b - a).abs().max((c - a).abs())), normalized([a, b, c]));
    let base = u.length();
    scale * if base > 0.0 { u.cross(v).length() / base } else { v.length() }
}

/// The height over the longest side relative to that: 0 for a line, 0.87 where all sides are equal.
pub(super) fn breadth(triangle: &[DVec3; 3]) -> f64 {
    let [_, u, v] = normalized(*triangle);
    let longest = u.length_squared().max(v.length_squared()).max(u.distance_squared(v));
    if longest > 0.0 { u.cross(v).length() / longest } else { 0.0 }
}

/// The diagonal of the bounding box; 0 without vertices.
pub(super) fn diagonal(mesh: &Mesh) -> f64 {
    bounding_box(mesh).map_or(0.0, |bounds| distance(bounds.min, bounds.max))
}

/// Errors: [`Error::NotFinite`].
pub(super) fn need_finite(mesh: &Mesh) -> Result<(), Error> {
    match mesh.vertices().find(|&v| !mesh.position(v).is_finite()) {
        Some(vertex) => Err(Error::NotFinite { vertex }),
        None => Ok(()),
    }
}
