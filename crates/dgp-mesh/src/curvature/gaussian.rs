//! Gaussian curvature by angle defects: what the angles around a vertex lack of a full turn.
//!
//! ```text
//! Ω(v) = 2π − Σ θ      inside: the Gaussian curvature of the region of v, integrated
//! Ω(v) =  π − Σ θ      at the rim of a hole: the turning of the rim
//! Σ Ω(v) = 2π χ        Gauss–Bonnet, exact but for rounding
//! K(v) = Ω(v) / A(v)   pointwise, with the vertex area A
//! ```
//!
//! - Input: a triangle mesh, with or without holes.
//! - Cost: O(V) time and memory.
//! - Guarantees: Gauss–Bonnet holds for triangles without area too. A surface that unfolds into the
//!   plane has exactly 0. Vertices on no face have 0.
//! - Reference: Meyer, Desbrun, Schröder and Barr, "Discrete differential-geometry operators for
//!   triangulated 2-manifolds", VisMath 2002 (in print 2003), section 4.

use std::{
    f64::consts::{PI, TAU},
    ops::Add,
};

use super::triangle::{Corners, sum_at_corners};
use crate::{
    Error, Mesh, VertexId, VertexMap,
    measure::{VertexArea, frame::Frame, require_triangles},
};

/// What the angles around each vertex lack of 2π, of π at the rim of a hole. Radians.
///
/// Angles of triangles with a side of no length are their limit π/2, π/2, 0; of points π/3.
/// Errors: [`Error::NotTriangle`].
pub fn angle_defects(mesh: &Mesh) -> Result<VertexMap<f64>, Error> {
    require_triangles(mesh)?;
    let sums = sum_at_corners(mesh, |_, corners| {
        Corners::of(corners.map(|v| 0.5 * mesh.position(v))).angles
    });
    Ok(mesh.map_vertices(|v| defect(mesh, v, sums[v.index()])))
}

/// The Gaussian curvature at each vertex, per area: that of a sphere is 1/r².
///
/// 0 at the rims of holes, where the angles tell of the rim and not of the surface, on no face, and
/// where the triangles around a vertex have no area beside the mesh.
/// Errors: [`Error::NotTriangle`].
pub fn gaussian_curvatures(mesh: &Mesh, area: VertexArea) -> Result<VertexMap<f64>, Error> {
    require_triangles(mesh)?;
    let frame = Frame::of(mesh);
    let sums = sum_at_corners(mesh, |_, corners| {
        let corners = Corners::of(corners.map(|v| frame.scaled(mesh.position(v))));
        let areas = corners.areas(area);
        [0, 1, 2].map(|k| AngleAndArea { angle: corners.angles[k], area: areas[k] })
    });
    Ok(mesh.map_vertices(|v| {
        if mesh.is_boundary_vertex(v) {
            return 0.0;
        }
        let AngleAndArea { angle, area } = sums[v.index()];
        let curvature = defect(mesh, v, angle) / area;
        if curvature.is_finite() { frame.per_measure(curvature, 2) } else { 0.0 }
    }))
}

#[derive(Clone, Copy, Default)]
struct AngleAndArea {
    angle: f64,
    area: f64,
}

impl Add for AngleAndArea {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        AngleAndArea { angle: self.angle + other.angle, area: self.area + other.area }
    }
}

/// What `angle` at `v` lacks, 0 if that is within the rounding of its terms.
fn defect(mesh: &Mesh, v: VertexId, angle: f64) -> f64 {
    // An angle is good to two roundings of its sides and two of its own, and so is each partial sum.
    const ROUNDING_OF_AN_ANGLE: f64 = 8.0 * f64::EPSILON;
    const NEARLY_NOTHING: f64 = 1e-9;
    if mesh.is_isolated_vertex(v) {
        return 0.0;
    }
    let defect = if mesh.is_boundary_vertex(v) { PI - angle } else { TAU - angle };
    let is_rounding = || defect.abs() <= ROUNDING_OF_AN_ANGLE * mesh.valence(v) as f64;
    if defect.abs() < NEARLY_NOTHING && is_rounding() { 0.0 } else { defect }
}
