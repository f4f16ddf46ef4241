//! A tube along a trefoil knot, thinner and thicker along the way.
//!
//! The cross-sections turn as little as possible along the curve (double reflection); the angle by
//! which the last misses the first is spread evenly over all.
//!
//! - Input: how many vertices there are along the tube and around it.
//! - Cost: O(faces).
//! - Reference: Wang, Jüttler, Zheng and Liu, "Computation of rotation minimizing frames", ACM
//!   Transactions on Graphics 27(1), 2008.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Tiling, at_least, face_count, manifold, patch::cells};
use crate::{Error, Mesh, VertexId};

/// A knotted torus with swellings: `n` cells along the knot and `m` around the tube, of two triangles
/// each. Triangles are well shaped where `n` is about 12·`m`; 780 × 65 make 101,400.
///
/// `n` is at least 24, so that the tube does not cut itself, and `m` at least 3.
pub fn trefoil(n: usize, m: usize) -> Result<Mesh, Error> {
    at_least("n", n, 24, "at least 24")?;
    at_least("m", m, 3, "at least 3")?;
    face_count(&[2, n, m])?;
    let angle = |i: usize| TAU * i as f64 / n as f64;
    let normals = closed_frame(n, angle);
    let positions = (0..n).flat_map(|i| {
        let t = angle(i);
        let (center, tangent, normal) = (curve(t), tangent(t), normals[i]);
        let side = tangent.cross(normal);
        let radius = 0.55 + 0.11 * (6.0 * t).cos();
        (0..m).map(move |j| {
            let (sin, cos) = (TAU * j as f64 / m as f64).sin_cos();
            center + radius * (cos * normal + sin * side)
        })
    });
    let positions = positions.collect();
    // Rows run around the tube, so a cell turns from j to i.
    let vertex = |j: usize, i: usize| VertexId::new(i % n * m + j % m);
    manifold(positions, &cells([m, n], Tiling::Triangles, vertex))
}

/// The trefoil knot, t from 0 to 2π.
fn curve(t: f64) -> DVec3 {
    let (sin, cos) = t.sin_cos();
    let (sin2, cos2) = (2.0 * t).sin_cos();
    DVec3::new(sin + 2.0 * sin2, cos - 2.0 * cos2, -(3.0 * t).sin())
}

/// The direction of [`curve`].
fn tangent(t: f64) -> DVec3 {
    let (sin, cos) = t.sin_cos();
    let (sin2, cos2) = (2.0 * t).sin_cos();
    DVec3::new(cos + 4.0 * cos2, 4.0 * sin2 - sin, -3.0 * (3.0 * t).cos()).normalize()
}

/// A unit normal at each of `n` places, carried along the curve and back into itself.
fn closed_frame(n: usize, angle: impl Fn(usize) -> f64) -> Vec<DVec3> {
    let start = tangent(0.0).any_orthonormal_vector();
    let mut normals = vec![start];
    for i in 0..n {
        let (p, q) = (angle(i), angle(i + 1));
        normals.push(reflect_twice([curve(p), curve(q)], [tangent(p), tangent(q)], normals[i]));
    }
    let last = normals.pop().expect("the frame after a whole turn");
    let twist = start.dot(tangent(0.0).cross(last)).atan2(start.dot(last));
    for (i, normal) in normals.iter_mut().enumerate() {
        let (sin, cos) = (twist * i as f64 / n as f64).sin_cos();
        *normal = cos * *normal + sin * tangent(angle(i)).cross(*normal);
    }
    normals
}

/// Carries `normal` from the first to the second point: mirrors the frame into the plane between
/// the points, then tilts it onto the second tangent.
fn reflect_twice([p, q]: [DVec3; 2], [t, u]: [DVec3; 2], normal: DVec3) -> DVec3 {
    let mirror = |x: DVec3, axis: DVec3| x - 2.0 * axis.dot(x) / axis.length_squared() * axis;
    let (normal, t) = (mirror(normal, q - p), mirror(t, q - p));
    mirror(normal, u - t)
}
