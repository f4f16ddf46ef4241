//! Areas, normals and centers of faces.
//!
//! The vector area of a polygon, half the sum of pᵢ × pᵢ₊₁, needs no triangulation: its length is the
//! area and its direction the normal if the polygon is flat, convex or not. If it is not flat, both
//! are those of its projection along the direction in which that is largest.

use glam::DVec3;

use super::{
    Surface,
    frame::Frame,
    scale::{self, Scale, half_side},
};
use crate::{FaceId, FaceMap, Mesh, parallel};

/// Measures at a face.
impl Mesh {
    /// The area of `f` times its normal: half the sum of pᵢ × pᵢ₊₁ along its sides.
    #[inline]
    pub fn face_vector_area(&self, f: FaceId) -> DVec3 {
        vector_area(self, f)
    }

    /// The area of `f`, which is taken to be flat.
    #[inline]
    pub fn face_area(&self, f: FaceId) -> f64 {
        scale::length(vector_area(self, f))
    }

    /// The unit normal of `f`, outward where faces run counterclockwise; zero if `f` has no area.
    #[inline]
    pub fn face_normal(&self, f: FaceId) -> DVec3 {
        normal(self, f)
    }

    /// The mean of the corners of `f`.
    pub fn face_center(&self, f: FaceId) -> DVec3 {
        let count = self.degree(f) as f64;
        let first = self.position(self.from(self.face_halfedge(f)));
        first
            + self.face_vertices(f).map(|v| self.position(v) / count - first / count).sum::<DVec3>()
    }
}

/// The vector area of each face: its area times its normal.
pub fn face_vector_areas(surface: &impl Surface) -> FaceMap<DVec3> {
    parallel::map(surface.number_of_faces(), |f| vector_area(surface, f))
}

/// The area of each face, which is taken to be flat.
pub fn face_areas(surface: &impl Surface) -> FaceMap<f64> {
    parallel::map(surface.number_of_faces(), |f| scale::length(vector_area(surface, f)))
}

/// The unit normal of each face; zero where a face has no area.
pub fn face_normals(surface: &impl Surface) -> FaceMap<DVec3> {
    parallel::map(surface.number_of_faces(), |f| normal(surface, f))
}

/// The area of the whole surface.
///
/// Faces are taken to be flat; those with a coordinate that is not finite count as zero. Infinite if
/// the area exceeds what an f64 can hold.
pub fn area(surface: &impl Surface) -> f64 {
    let frame = Frame::of(surface);
    let sum = parallel::reduce(
        surface.number_of_faces(),
        0.0,
        |f| {
            let area = local_vector_area(surface, &frame, f).length();
            if area.is_finite() { area } else { 0.0 }
        },
        |a, b| a + b,
    );
    frame.measure(sum, 2)
}

/// The vector area of `f` at the scale of `frame`.
#[inline]
pub(crate) fn local_vector_area(surface: &impl Surface, frame: &Frame, f: FaceId) -> DVec3 {
    let positions = surface.vertex_positions();
    let point = |v| frame.scaled(positions[v]);
    if let Some([a, b, c]) = surface.corners_of_triangle(f) {
        let a = point(a);
        return 0.5 * (point(b) - a).cross(point(c) - a);
    }
    let mut corners = surface.polygon(f).map(point);
    let Some(first) = corners.next() else { return DVec3::ZERO };
    0.5 * fan(corners.map(|p| p - first))
}

/// The sum of u × v over consecutive vectors.
#[inline]
fn fan(sides: impl Iterator<Item = DVec3>) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let mut last = DVec3::ZERO;
    for side in sides {
        sum += last.cross(side);
        last = side;
    }
    sum
}

/// The vector area of `f`.
#[inline]
fn vector_area(surface: &impl Surface, f: FaceId) -> DVec3 {
    let positions = surface.vertex_positions();
    if let Some([a, b, c]) = surface.corners_of_triangle(f) {
        return scale::vector_area(positions[a], positions[b], positions[c]);
    }
    let (sum, scale) = scaled_polygon(surface, f);
    2.0 * sum * scale.up * scale.up
}

/// The unit normal of `f`, or zero.
#[inline]
pub(crate) fn normal(surface: &impl Surface, f: FaceId) -> DVec3 {
    let positions = surface.vertex_positions();
    if let Some([a, b, c]) = surface.corners_of_triangle(f) {
        let (u, v) = (half_side(positions[a], positions[b]), half_side(positions[a], positions[c]));
        let down = Scale::of_vectors(u, v).down;
        return scale::unit((u * down).cross(v * down));
    }
    scale::unit(scaled_polygon(surface, f).0)
}

/// Half the vector area of polygon `f` over the square of the returned scale.
fn scaled_polygon(surface: &impl Surface, f: FaceId) -> (DVec3, Scale) {
    let positions = surface.vertex_positions();
    let mut corners = surface.polygon(f).map(|v| positions[v]);
    let Some(first) = corners.next() else { return (DVec3::ZERO, Scale::of(0.0)) };
    let sides = corners.map(|p| half_side(first, p));
    let size = sides.clone().fold(DVec3::ZERO, |size, side| size.max(side.abs()));
    let scale = Scale::of(size.max_element());
    (fan(sides.map(|side| side * scale.down)), scale)
}
