//! The Möbius strip, which has one side only.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Tiling, at_least, face_count, patch::cells};
use crate::{Error, IndexedFaceSet, VertexId};

/// A Möbius strip around the z axis, of radius 1 and width 0.8: `n` cells along, `m` across, of two
/// triangles each. `n` is at least 3.
///
/// No choice of directions makes its faces agree along all edges, so it stays a face set:
/// [`Mesh::new`](crate::Mesh::new) refuses it as misoriented.
pub fn mobius_strip(n: usize, m: usize) -> Result<IndexedFaceSet, Error> {
    at_least("n", n, 3, "at least 3")?;
    at_least("m", m, 1, "at least 1")?;
    face_count(&[2, n, m])?;
    let position = |i: usize, j: usize| {
        let angle = TAU * i as f64 / n as f64;
        let (sin, cos) = angle.sin_cos();
        let (half_sin, half_cos) = (0.5 * angle).sin_cos();
        let across = 0.8 * (j as f64 / m as f64 - 0.5);
        let radius = 1.0 + across * half_cos;
        DVec3::new(radius * cos, radius * sin, across * half_sin)
    };
    let positions: Vec<DVec3> = (0..n).flat_map(|i| (0..=m).map(move |j| position(i, j))).collect();
    // After one turn the strip meets its start upside down.
    let vertex = |i: usize, j: usize| VertexId::new(if i < n { i * (m + 1) + j } else { m - j });
    IndexedFaceSet::new(positions, cells([n, m], Tiling::Triangles, vertex))
}
