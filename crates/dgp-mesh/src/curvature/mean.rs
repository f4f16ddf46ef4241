//! Mean curvature by cotangents: the Laplacian of the position.
//!
//! ```text
//! H n = 1/(4 A(v)) Σ (cot α + cot β) (x(v) − x(w))      over the neighbors w of v
//! ```
//!
//! with the angles α and β opposite the edge vw and the vertex area A. The sum is the gradient of the
//! area of the surface; at the rim of a hole it also pulls the rim inward and tells nothing of H.
//!
//! - Input: a triangle mesh, with or without holes.
//! - Cost: O(V) time and memory.
//! - Guarantees: exactly 0 where the triangles around a vertex lie in a plane. Finite.
//! - Reference: Pinkall and Polthier, "Computing discrete minimal surfaces and their conjugates",
//!   Experimental Mathematics 2(1), 1993; Meyer et al. 2003, section 3.

use std::ops::Add;

use glam::DVec3;

use super::triangle::{Corners, sum_at_corners};
use crate::{
    Error, Mesh, VertexMap,
    measure::{NormalWeight, VertexArea, frame::Frame, require_triangles, vertex_normals},
};

/// Mean curvature times normal at each vertex: outward and of length 1/r on a sphere.
///
/// Zero at the rims of holes, on no face, and where the triangles around a vertex have no area beside
/// the mesh. Errors: [`Error::NotTriangle`].
pub fn mean_curvature_vectors(mesh: &Mesh, area: VertexArea) -> Result<VertexMap<DVec3>, Error> {
    let (frame, pulls) = pulls(mesh, area)?;
    let per_length = frame.per_measure(1.0, 1);
    Ok(mesh.map_vertices(|v| {
        let pull = pulls[v.index()];
        if mesh.is_boundary_vertex(v) || pull.vector.length() <= pull.rounding {
            return DVec3::ZERO;
        }
        let curvature = pull.vector / (2.0 * pull.area);
        if curvature.is_finite() { curvature * per_length } else { DVec3::ZERO }
    }))
}

/// The mean curvature H = (κ₁ + κ₂)/2 at each vertex: 1/r on a sphere, negative in hollows.
///
/// It is [`mean_curvature_vectors`] along the vertex normal (by angles), and 0 where one of them is.
/// Errors: [`Error::NotTriangle`].
pub fn mean_curvatures(mesh: &Mesh, area: VertexArea) -> Result<VertexMap<f64>, Error> {
    let (frame, pulls) = pulls(mesh, area)?;
    let normals = vertex_normals(mesh, NormalWeight::Angle);
    Ok(mesh.map_vertices(|v| {
        let pull = pulls[v.index()];
        let along = pull.vector.dot(normals[v]);
        if mesh.is_boundary_vertex(v) || along.abs() <= pull.rounding {
            return 0.0;
        }
        let curvature = along / (2.0 * pull.area);
        if curvature.is_finite() { frame.per_measure(curvature, 1) } else { 0.0 }
    }))
}

/// The gradient of the area at a vertex.
#[derive(Clone, Copy, Default)]
struct Pull {
    vector: DVec3,
    /// What the last bits of the coordinates can make of it.
    rounding: f64,
    area: f64,
}

impl Add for Pull {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Pull {
            vector: self.vector + other.vector,
            rounding: self.rounding + other.rounding,
            area: self.area + other.area,
        }
    }
}

fn pulls(mesh: &Mesh, area: VertexArea) -> Result<(Frame, Vec<Pull>), Error> {
    // Half a unit in the last place at both ends, and as much again for the differences.
    const ROUNDING: f64 = 2.0 * f64::EPSILON;
    require_triangles(mesh)?;
    let frame = Frame::of(mesh);
    let pulls = sum_at_corners(mesh, |_, corners| {
        let points = corners.map(|v| frame.scaled(mesh.position(v)));
        let corners = Corners::of(points);
        let areas = corners.areas(area);
        let size = points.iter().fold(DVec3::ZERO, |size, p| size.max(p.abs())).max_element();
        [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (to_i, to_j) = (0.5 * corners.cotangents[j], 0.5 * corners.cotangents[i]);
            Pull {
                vector: to_i * (points[k] - points[i]) + to_j * (points[k] - points[j]),
                rounding: ROUNDING * size * (to_i.abs() + to_j.abs()),
                area: areas[k],
            }
        })
    });
    Ok((frame, pulls))
}
