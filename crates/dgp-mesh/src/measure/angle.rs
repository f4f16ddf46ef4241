//! Angles at corners and edges.

use super::{
    Surface,
    scale::{self, half_side},
};
use crate::{EdgeId, FaceId, HalfedgeId, HalfedgeMap, Mesh, parallel};

/// Angles.
impl Mesh {
    /// The angle in [0, π] between `h` and the side before it, at the vertex `h` leaves.
    ///
    /// A reflex corner of a polygon gives the angle outside. 0 where a side has no length.
    #[inline]
    pub fn corner_angle(&self, h: HalfedgeId) -> f64 {
        let (p, a, b) = (self.from(h), self.to(h), self.from(self.prev(h)));
        let p = self.position(p);
        scale::angle(half_side(p, self.position(a)), half_side(p, self.position(b)))
    }

    /// By how much the surface bends at `e`: the angle in [−π, π] from the normal of one face to that
    /// of the other. 0 if flat, positive on a ridge, negative in a valley; the angle inside is π
    /// minus this. `None` on the boundary; 0 where a face has no area.
    pub fn dihedral_angle(&self, e: EdgeId) -> Option<f64> {
        let [Some(left), Some(right)] = self.edge_faces(e) else { return None };
        let [m, n] = [left, right].map(|f| self.face_normal(f));
        let [a, b] = self.edge_vertices(e).map(|v| self.position(v));
        let along = scale::unit(half_side(a, b));
        let (sine, cosine) = (m.cross(n).dot(along), m.dot(n));
        Some(sine.atan2(cosine))
    }
}

/// The angle of each corner, in [0, π]; 0 at half-edges without a face.
pub fn corner_angles(mesh: &Mesh) -> HalfedgeMap<f64> {
    mesh.map_halfedges(|h| if mesh.face(h).is_some() { mesh.corner_angle(h) } else { 0.0 })
}

/// The smallest angle between adjacent sides of a face, in [0, π]; `None` without faces.
///
/// A side without length makes an angle of 0. Faces of fewer than three corners and faces with a
/// coordinate that is not finite do not count.
pub fn minimum_angle(surface: &impl Surface) -> Option<f64> {
    let smallest = parallel::reduce(
        surface.number_of_faces(),
        f64::INFINITY,
        |f| smallest_of_face(surface, f),
        f64::min,
    );
    smallest.is_finite().then_some(smallest)
}

/// The smallest angle of `f`, infinite if it has none.
fn smallest_of_face(surface: &impl Surface, f: FaceId) -> f64 {
    let positions = surface.vertex_positions();
    let corners = surface.polygon(f).map(|v| positions[v]);
    let count = corners.clone().count();
    if count < 3 || !corners.clone().all(glam::DVec3::is_finite) {
        return f64::INFINITY;
    }
    let before = corners.clone().cycle().skip(count - 1);
    let after = corners.clone().cycle().skip(1);
    corners
        .zip(before.zip(after))
        .map(|(p, (a, b))| scale::angle(half_side(p, a), half_side(p, b)))
        .fold(f64::INFINITY, f64::min)
}
