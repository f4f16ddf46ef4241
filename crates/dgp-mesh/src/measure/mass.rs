//! Centers and moments: of the vertices, of the surface, and of the solid inside.
//!
//! The solid is summed up from tetrahedra between the middle of the mesh and its triangles:
//!
//! ```text
//! volume = det / 6,   ∫ x = det / 24 · s,   ∫ x xᵀ = det / 120 · (s sᵀ + a aᵀ + b bᵀ + c cᵀ)
//!
//! det = a · (b × c),   s = a + b + c
//! ```
//!
//! - Input: a closed oriented surface for the solid, any for the rest. Polygons are spanned by
//!   triangles around the mean of their corners.
//! - Cost: O(V + F) time, in parallel.
//! - Reference: Tonon, "Explicit exact formulas for the 3-D tetrahedron inertia tensor", Journal of
//!   Mathematics and Statistics 1(1), 2005.

use glam::{DMat3, DVec3};

use super::{Surface, face::local_vector_area, frame::Frame, scale, volume::corner_mean};
use crate::{FaceId, VertexId, linear::symmetric_eigen, parallel};

/// The moments of a solid of density 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// The volume, negative if the faces point inward.
    pub volume: f64,
    /// The center of mass.
    pub centroid: DVec3,
    /// The inertia tensor about the center of mass.
    pub inertia: DMat3,
    /// The moments about the principal axes, smallest first.
    pub principal_moments: DVec3,
    /// The unit principal axes as columns, a right-handed frame.
    pub principal_axes: DMat3,
}

/// Volume, center of mass and inertia of the solid that `surface` encloses.
///
/// `None` if the volume is zero. As with [`volume`](super::volume()), the numbers mean something only
/// where the surface is closed and oriented; infinite where they exceed what an f64 holds.
pub fn mass_properties(surface: &impl Surface) -> Option<MassProperties> {
    let frame = Frame::of(surface);
    let sum = parallel::reduce(
        surface.number_of_faces(),
        Moments::default(),
        |f| face_moments(surface, &frame, f),
        Moments::add,
    );
    let volume = sum.volume;
    if volume == 0.0 {
        return None;
    }
    let centroid = sum.first / volume;
    let second = (sum.second - outer(centroid, centroid) * volume) * volume.signum();
    let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
    let inertia = DMat3::from_diagonal(DVec3::splat(trace)) - second;
    let eigen = symmetric_eigen(&inertia);
    let to_space = |x: f64| frame.measure(x, 5);
    Some(MassProperties {
        volume: frame.measure(volume, 3),
        centroid: frame.global(centroid),
        inertia: DMat3::from_cols_array(&inertia.to_cols_array().map(to_space)),
        principal_moments: eigen.values.map(to_space),
        principal_axes: eigen.vectors,
    })
}

/// The mean of all vertices, those of no face included; `None` if there are none.
///
/// Vertices with a coordinate that is not finite do not count.
pub fn vertex_centroid(surface: &impl Surface) -> Option<DVec3> {
    let frame = Frame::of(surface);
    let positions = surface.vertex_positions();
    let (sum, count) = parallel::reduce(
        positions.len(),
        (DVec3::ZERO, 0.0),
        |v: VertexId| match positions[v] {
            p if p.is_finite() => (frame.local(p), 1.0),
            _ => (DVec3::ZERO, 0.0),
        },
        |(p, m), (q, n)| (p + q, m + n),
    );
    (count > 0.0).then(|| frame.global(sum / count))
}

/// The center of mass of the surface itself, as of a shell of even thickness.
///
/// `None` if it has no area. Faces with a coordinate that is not finite do not count.
pub fn surface_centroid(surface: &impl Surface) -> Option<DVec3> {
    let frame = Frame::of(surface);
    let (sum, area) = parallel::reduce(
        surface.number_of_faces(),
        (DVec3::ZERO, 0.0),
        |f| {
            let vector = local_vector_area(surface, &frame, f);
            let normal = scale::unit(vector);
            let center = corner_mean(surface, &frame, f);
            let mut moment = center * vector.length();
            if surface.corners_of_triangle(f).is_none() {
                // Signed by the normal, so that triangles outside a concave polygon are taken off.
                moment = DVec3::ZERO;
                for_each_side(surface, &frame, f, |p, q| {
                    let part = 0.5 * (p - center).cross(q - center).dot(normal);
                    moment += part * (center + p + q) / 3.0;
                });
            }
            if moment.is_finite() { (moment, vector.length()) } else { (DVec3::ZERO, 0.0) }
        },
        |(p, m), (q, n)| (p + q, m + n),
    );
    (area > 0.0).then(|| frame.global(sum / area))
}

/// ∫ 1, ∫ x and ∫ x xᵀ over a solid.
#[derive(Clone, Copy, Debug)]
struct Moments {
    volume: f64,
    first: DVec3,
    second: DMat3,
}

impl Default for Moments {
    fn default() -> Self {
        Moments { volume: 0.0, first: DVec3::ZERO, second: DMat3::ZERO }
    }
}

impl Moments {
    fn add(self, other: Moments) -> Moments {
        Moments {
            volume: self.volume + other.volume,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }

    /// The moments of the tetrahedron between the origin and a, b, c.
    fn of_tetrahedron(a: DVec3, b: DVec3, c: DVec3) -> Moments {
        let det = a.dot(b.cross(c));
        let s = a + b + c;
        let second = outer(s, s) + outer(a, a) + outer(b, b) + outer(c, c);
        Moments { volume: det / 6.0, first: s * (det / 24.0), second: second * (det / 120.0) }
    }
}

/// u vᵀ
fn outer(u: DVec3, v: DVec3) -> DMat3 {
    DMat3::from_cols(u * v.x, u * v.y, u * v.z)
}

/// The moments between the origin and face `f`.
fn face_moments(surface: &impl Surface, frame: &Frame, f: FaceId) -> Moments {
    let positions = surface.vertex_positions();
    let mut sum = Moments::default();
    if let Some(corners) = surface.corners_of_triangle(f) {
        let [a, b, c] = corners.map(|v| frame.local(positions[v]));
        sum = Moments::of_tetrahedron(a, b, c);
    } else {
        let center = corner_mean(surface, frame, f);
        for_each_side(surface, frame, f, |p, q| {
            sum = sum.add(Moments::of_tetrahedron(center, p, q));
        });
    }
    if sum.second.is_finite() && sum.volume.is_finite() { sum } else { Moments::default() }
}

/// Calls `visit(p, q)` with the ends of each side of `f` in `frame`.
fn for_each_side(
    surface: &impl Surface,
    frame: &Frame,
    f: FaceId,
    mut visit: impl FnMut(DVec3, DVec3),
) {
    let positions = surface.vertex_positions();
    let corners = surface.polygon(f).map(|v| frame.local(positions[v]));
    let Some(first) = corners.clone().next() else { return };
    let mut last = first;
    for corner in corners.skip(1) {
        visit(last, corner);
        last = corner;
    }
    visit(last, first);
}
