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

use std::ops::Range;

use glam::DVec3;

use super::{
    face::local_vector_area,
    frame::Frame,
    scale::{self, Scale},
};
use crate::{FaceId, HalfedgeId, Mesh, VertexId, VertexMap, parallel};

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
    let count = mesh.face_count();
    // Adding face by face reads memory in order and computes each face once; walking around vertices
    // takes twice the time. Two halves, whatever the number of threads, give the same bits for all.
    let middle = if count > 2 * parallel::BLOCK { count / 2 } else { count };
    let (mut sums, others) = parallel::join(
        || sum_over_faces(mesh, &frame, weight, 0..middle),
        || sum_over_faces(mesh, &frame, weight, middle..count),
    );
    parallel::for_each_chunk(&mut sums, parallel::BLOCK, |first, chunk| {
        for (i, sum) in chunk.iter_mut().enumerate() {
            let other = others.get(first + i).copied().unwrap_or(DVec3::ZERO);
            *sum = scale::unit(*sum + other);
        }
    });
    sums.into()
}

/// The unit normal of `v`, see [`vertex_normals`]; at the scale of the faces around `v` alone.
pub fn vertex_normal(mesh: &Mesh, v: VertexId, weight: NormalWeight) -> DVec3 {
    let around = mesh.vertex_halfedges(v).map(|h| mesh.position(mesh.to(h)));
    let frame = Frame::of_points(around.chain([mesh.position(v)]));
    let corners = mesh.vertex_halfedges(v);
    let terms = corners.filter_map(|h| Some(corner_term(mesh, &frame, weight, mesh.face(h)?, h)));
    scale::unit(terms.sum())
}

/// The weighted normals of `faces` added up at their vertices; nothing if there are none.
fn sum_over_faces(
    mesh: &Mesh,
    frame: &Frame,
    weight: NormalWeight,
    faces: Range<usize>,
) -> Vec<DVec3> {
    if faces.is_empty() && faces.start > 0 {
        return Vec::new();
    }
    let mut sums = vec![DVec3::ZERO; mesh.vertex_count()];
    for f in faces.map(FaceId::new) {
        if let Some(corners) = mesh.triangle(f) {
            let points = corners.map(|v| frame.scaled(mesh.position(v)));
            let terms = triangle_terms(points, weight);
            for (v, term) in corners.into_iter().zip(terms) {
                sums[v.index()] += term;
            }
        } else {
            for h in mesh.face_halfedges(f) {
                sums[mesh.from(h).index()] += corner_term(mesh, frame, weight, f, h);
            }
        }
    }
    sums
}

/// What a triangle adds to the normals of its three corners.
#[inline]
fn triangle_terms([a, b, c]: [DVec3; 3], weight: NormalWeight) -> [DVec3; 3] {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    match weight {
        NormalWeight::Area => [0.5 * ca.cross(ab); 3],
        NormalWeight::Angle => {
            // Scaled to the triangle, so that small ones have their angles too.
            let down = Scale::of(ab.abs().max(bc.abs()).max(ca.abs()).max_element()).down;
            let (ab, bc, ca) = (ab * down, bc * down, ca * down);
            let cross = ca.cross(ab);
            // |u × v| is twice the area at every corner.
            let doubled = cross.length();
            if doubled == 0.0 {
                return [DVec3::ZERO; 3];
            }
            let normal = cross / doubled;
            [-ca.dot(ab), -ab.dot(bc), -bc.dot(ca)].map(|dot| doubled.atan2(dot) * normal)
        }
        NormalWeight::Max => {
            let cross = ca.cross(ab);
            let [x, y, z] = [ab, bc, ca].map(DVec3::length_squared);
            [z * x, x * y, y * z].map(|product| max_term(cross, product))
        }
    }
}

/// What face `f` adds to the normal at its corner `h`.
fn corner_term(
    mesh: &Mesh,
    frame: &Frame,
    weight: NormalWeight,
    f: FaceId,
    h: HalfedgeId,
) -> DVec3 {
    match weight {
        NormalWeight::Area => local_vector_area(mesh, frame, f),
        NormalWeight::Angle => mesh.corner_angle(h) * mesh.face_normal(f),
        NormalWeight::Max => {
            let corners = [mesh.from(h), mesh.to(h), mesh.from(mesh.prev(h))];
            let [p, a, b] = corners.map(|v| frame.scaled(mesh.position(v)));
            let (u, v) = (a - p, b - p);
            max_term(u.cross(v), u.length_squared() * v.length_squared())
        }
    }
}

/// u × v / (|u|² |v|²); zero where a side vanishes beside the size of the mesh and the quotient would
/// leave the range of f64.
#[inline]
fn max_term(cross: DVec3, product: f64) -> DVec3 {
    let term = cross / product;
    if term.is_finite() { term } else { DVec3::ZERO }
}
