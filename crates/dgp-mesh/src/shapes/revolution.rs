//! Surfaces of revolution around the z axis.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use super::{Tiling, at_least, face_count, length, manifold, patch::cells};
use crate::{Error, Mesh, VertexId};

/// The surface that `profile` sweeps in `n` steps around the z axis, in quads.
///
/// A point of the profile is (distance from the axis, height). The first and the last may lie on the
/// axis: a ring of triangles closes the surface there. Faces look to the right of the profile, which
/// is outside where it climbs. Vertices lie ring by ring along the profile.
///
/// Errors: [`Error::InvalidOption`] for fewer than two points, an inner point that is not beside the
/// axis, a coordinate that is not finite, or `n` below 3.
pub fn surface_of_revolution(profile: &[DVec2], n: usize) -> Result<Mesh, Error> {
    revolve(profile, n, Tiling::Quads)
}

/// The side of a cylinder around the z axis from z = 0 to `height`, open at both ends: `n` × `m`
/// cells of two triangles.
pub fn cylinder(radius: f64, height: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    let profile = cylinder_profile(radius, height, m)?;
    revolve(&profile, n, Tiling::Triangles)
}

/// [`cylinder`] with a fan of triangles at both ends.
pub fn capped_cylinder(radius: f64, height: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    let mut profile = cylinder_profile(radius, height, m)?;
    profile.insert(0, DVec2::ZERO);
    profile.push(DVec2::new(0.0, height));
    revolve(&profile, n, Tiling::Triangles)
}

/// The side of a cone around the z axis from a circle at z = 0 to its tip at `height`: `n` × `m`
/// cells of two triangles, those at the tip of one.
pub fn cone(radius: f64, height: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    let profile = cone_profile(radius, height, m)?;
    revolve(&profile, n, Tiling::Triangles)
}

/// [`cone`] with a fan of triangles as its base.
pub fn capped_cone(radius: f64, height: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    let mut profile = cone_profile(radius, height, m)?;
    profile.insert(0, DVec2::ZERO);
    revolve(&profile, n, Tiling::Triangles)
}

/// Two balls of radius about 1 joined by a neck of radius about `neck` (between 0 and 1), along the
/// z axis, smooth and closed: `n` × `m` cells of two triangles.
pub fn dumbbell(neck: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    if !(neck > 0.0 && neck <= 1.0) {
        return Err(Error::option("neck", neck, "above 0 and at most 1"));
    }
    at_least("m", m, 4, "at least 4")?;
    face_count(&[2, n, m])?;
    let point = |j: usize| {
        if j == 0 || j == m {
            return DVec2::new(0.0, if j == 0 { -2.0 } else { 2.0 });
        }
        let t = PI * j as f64 / m as f64 - FRAC_PI_2;
        // A long ellipsoid with a waist: the factor falls from 1 at the ends to `neck` at t = 0.
        let waist = 1.0 - (1.0 - neck) * t.cos().powi(4);
        DVec2::new(1.4 * t.cos() * waist, 2.0 * t.sin())
    };
    let profile: Vec<DVec2> = (0..=m).map(point).collect();
    revolve(&profile, n, Tiling::Triangles)
}

fn cylinder_profile(radius: f64, height: f64, m: usize) -> Result<Vec<DVec2>, Error> {
    length("radius", radius)?;
    length("height", height)?;
    at_least("m", m, 1, "at least 1")?;
    face_count(&[m])?;
    Ok((0..=m).map(|j| DVec2::new(radius, height * j as f64 / m as f64)).collect())
}

fn cone_profile(radius: f64, height: f64, m: usize) -> Result<Vec<DVec2>, Error> {
    length("radius", radius)?;
    length("height", height)?;
    at_least("m", m, 1, "at least 1")?;
    face_count(&[m])?;
    let point = |j: usize| {
        let t = j as f64 / m as f64;
        DVec2::new(radius * (1.0 - t), height * t)
    };
    Ok((0..=m).map(point).collect())
}

/// [`surface_of_revolution`] in triangles or quads.
pub(super) fn revolve(profile: &[DVec2], n: usize, tiling: Tiling) -> Result<Mesh, Error> {
    at_least("n", n, 3, "at least 3")?;
    let rows = at_least("profile", profile.len(), 2, "at least 2 points")? - 1;
    face_count(&[2, n, rows])?;
    let is_pole = |j: usize| profile[j].x == 0.0 && (j == 0 || j == rows);
    for (j, p) in profile.iter().enumerate() {
        if !p.is_finite() || p.x < 0.0 || (p.x == 0.0 && !is_pole(j)) {
            return Err(Error::option("profile", p.x, "beside the axis but at its ends"));
        }
    }
    if rows == 1 && is_pole(0) && is_pole(1) {
        return Err(Error::option("profile", 2.0, "more than two points on the axis"));
    }
    let mut positions = Vec::with_capacity((rows + 1) * n);
    let mut starts = Vec::with_capacity(rows + 1);
    for (j, p) in profile.iter().enumerate() {
        starts.push(positions.len());
        if is_pole(j) {
            positions.push(DVec3::new(0.0, 0.0, p.y));
        } else {
            positions.extend((0..n).map(|i| {
                let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
                DVec3::new(p.x * cos, p.x * sin, p.y)
            }));
        }
    }
    let vertex =
        |i: usize, j: usize| VertexId::new(if is_pole(j) { starts[j] } else { starts[j] + i % n });
    manifold(positions, &cells([n, rows], tiling, vertex))
}
