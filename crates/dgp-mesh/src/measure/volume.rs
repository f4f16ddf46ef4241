//! The volume that faces enclose.
//!
//! By the divergence theorem the volume is a third of the sum of m · A over the faces, where A is the
//! vector area and m a point of the face, here the mean of its corners. Relative to the middle of the
//! mesh, so that no digits are lost far from the origin.

use glam::DVec3;

use super::{Surface, face::local_vector_area, frame::Frame};
use crate::{FaceId, parallel};

/// The volume enclosed by `surface`, negative if its faces point inward.
///
/// Polygons that are not flat are spanned by triangles around the mean of their corners. The number
/// has a meaning only where the surface is closed and oriented; otherwise it depends on where the
/// surface lies. Faces with a coordinate that is not finite count as zero. Infinite if the volume
/// exceeds what an f64 can hold.
pub fn volume(surface: &impl Surface) -> f64 {
    let frame = Frame::of(surface);
    let positions = surface.vertex_positions();
    let sum = parallel::reduce(
        surface.number_of_faces(),
        0.0,
        |f| {
            let term = match surface.corners_of_triangle(f) {
                // The same for a triangle, whose corners are looked up once.
                Some(corners) => {
                    let [a, b, c] = corners.map(|v| frame.scaled(positions[v]));
                    let [p, q, r] = [a, b, c].map(|point| frame.moved(point));
                    ((p + q + r) / 3.0).dot(0.5 * (b - a).cross(c - a))
                }
                None => corner_mean(surface, &frame, f).dot(local_vector_area(surface, &frame, f)),
            };
            if term.is_finite() { term } else { 0.0 }
        },
        |a, b| a + b,
    );
    frame.measure(sum / 3.0, 3)
}

/// The mean of the corners of `f` in `frame`.
#[inline]
pub(crate) fn corner_mean(surface: &impl Surface, frame: &Frame, f: FaceId) -> DVec3 {
    let positions = surface.vertex_positions();
    if let Some(corners) = surface.corners_of_triangle(f) {
        let [a, b, c] = corners.map(|v| frame.local(positions[v]));
        return (a + b + c) / 3.0;
    }
    let (sum, count) = surface
        .polygon(f)
        .fold((DVec3::ZERO, 0.0), |(sum, n), v| (sum + frame.local(positions[v]), n + 1.0));
    if count > 0.0 { sum / count } else { DVec3::ZERO }
}
