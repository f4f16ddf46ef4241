//! Tori.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Tiling, at_least, face_count, length, manifold, patch::cells};
use crate::{Error, Mesh, VertexId};

/// A torus around the z axis: a circle of radius `minor` swept along one of radius `major`, in
/// `n` cells along and `m` around the tube, of two triangles each.
///
/// Vertex j·n + i is at angle 2πi/n around the axis and 2πj/m around the tube, from the outside up.
/// `minor` is less than `major`; `n` and `m` are at least 3.
pub fn torus(major: f64, minor: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    tiled([major, minor], [n, m], Tiling::Triangles)
}

/// [`torus`] of `n` × `m` quads.
pub fn quad_torus(major: f64, minor: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    tiled([major, minor], [n, m], Tiling::Quads)
}

fn tiled([major, minor]: [f64; 2], [n, m]: [usize; 2], tiling: Tiling) -> Result<Mesh, Error> {
    length("major", major)?;
    length("minor", minor)?;
    if minor >= major {
        return Err(Error::option("minor", minor, "less than `major`"));
    }
    at_least("n", n, 3, "at least 3")?;
    at_least("m", m, 3, "at least 3")?;
    face_count(&[2, n, m])?;
    let circle = |i: usize, n: usize| (TAU * i as f64 / n as f64).sin_cos();
    let position = |i: usize, j: usize| {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (circle(i, n), circle(j, m));
        let radius = major + minor * cos_v;
        DVec3::new(radius * cos_u, radius * sin_u, minor * sin_v)
    };
    let positions = (0..m).flat_map(|j| (0..n).map(move |i| position(i, j))).collect();
    manifold(positions, &cells([n, m], tiling, |i, j| VertexId::new(j % m * n + i % n)))
}
