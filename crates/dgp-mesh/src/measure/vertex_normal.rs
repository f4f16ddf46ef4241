//! Vertex normals: the mean of the normals of the faces around a vertex.
//!
//! ```text
//! n(v) = Σ weight · face normal, made unit
//!
//! weight   Area    area of the face
//!          Angle   angle of its corner at v
//!          Max     |u × v| / (|u|² |v|²) for the sides u, v of the corner: exact on spheres
//! ```
//!
//! - Input: any mesh.
//! - Cost: O(V) time and memory, in parallel.
//! - Guarantees: unit length, or zero where the faces around a vertex have no area or cancel.
//! - Reference: Max, "Weights for computing vertex normals from facet normals", Journal of Graphics
//!   Tools 4(2), 1999; Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", Journal
//!   of Graphics Tools 3(1), 1998 (angles).

use glam::DVec3;

use super::{face::local_vector_area, frame::Frame, scale};
use crate::{HalfedgeId, Mesh, VertexId, VertexMap};

/// What a face counts for in the normal of its vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalWeight {
    /// Its area: cheapest, and nearly always good enough.
    Area,
    /// The angle of its corner: does not depend on how the surface is cut into faces.
    #[default]
    Angle,
    /// Max 1999: gives the exact normal where all vertices around lie on a sphere.
    Max,
}

/// The unit normal of each vertex; zero on no face, and where the faces around cancel.
pub fn vertex_normals(mesh: &Mesh, weight: NormalWeight) -> VertexMap<DVec3> {
    let frame = Frame::of(mesh);
    match weight {
        NormalWeight::Area => area_weighted(mesh, &frame),
        NormalWeight::Angle => mesh.map_vertices(|v| sum(mesh, v, |h| angle_term(mesh, h))),
        NormalWeight::Max => mesh.map_vertices(|v| sum(mesh, v, |h| max_term(mesh, &frame, h))),
    }
}

/// The unit normal of `v`, see [`vertex_normals`].
pub fn vertex_normal(mesh: &Mesh, v: VertexId, weight: NormalWeight) -> DVec3 {
    match weight {
        NormalWeight::Area => {
            sum(mesh, v, |h| mesh.face(h).map_or(DVec3::ZERO, |f| mesh.face_vector_area(f)))
        }
        NormalWeight::Angle => sum(mesh, v, |h| angle_term(mesh, h)),
        NormalWeight::Max => sum(mesh, v, |h| max_term(mesh, &Frame::of(mesh), h)),
    }
}

/// The direction of the sum of `term` over the corners at `v`.
fn sum(mesh: &Mesh, v: VertexId, term: impl Fn(HalfedgeId) -> DVec3) -> DVec3 {
    let corners = mesh.vertex_halfedges(v).filter(|&h| mesh.face(h).is_some());
    scale::unit(corners.map(term).sum())
}

/// The normal of the face of `h` times the angle of the corner there.
fn angle_term(mesh: &Mesh, h: HalfedgeId) -> DVec3 {
    mesh.face(h).map_or(DVec3::ZERO, |f| mesh.corner_angle(h) * mesh.face_normal(f))
}

/// u × v / (|u|² |v|²) for the sides u, v of the corner at `h`; zero where one has no length.
fn max_term(mesh: &Mesh, frame: &Frame, h: HalfedgeId) -> DVec3 {
    let [p, a, b] = [mesh.from(h), mesh.to(h), mesh.from(mesh.prev(h))];
    let [p, a, b] = [p, a, b].map(|v| frame.local(mesh.position(v)));
    let (u, v) = (a - p, b - p);
    let product = scale::length(u) * scale::length(v);
    // Sides that vanish beside the size of the mesh have a weight beyond the range of f64.
    if product < f64::MIN_POSITIVE {
        return DVec3::ZERO;
    }
    let term = scale::unit(u).cross(scale::unit(v)) / product;
    if term.is_finite() { term } else { DVec3::ZERO }
}

/// One pass over the faces, then one over the vertices.
fn area_weighted(mesh: &Mesh, frame: &Frame) -> VertexMap<DVec3> {
    let areas = mesh.map_faces(|f| local_vector_area(mesh, frame, f));
    mesh.map_vertices(|v| scale::unit(mesh.vertex_faces(v).map(|f| areas[f]).sum()))
}
