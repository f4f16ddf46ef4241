//! Cotangents of the angles of triangles, from which Laplacians are made.

use super::scale::{Scale, half_side};
use crate::{EdgeMap, Error, HalfedgeId, Mesh};

impl Mesh {
    /// The cotangent of the angle opposite `h` in the triangle left of it.
    ///
    /// 0 where the triangle has no area or there is no face, so that the side counts for nothing.
    /// In a polygon of more than three corners there is no opposite angle: the result is that of the
    /// triangle of `h` and the corner before it.
    #[inline]
    pub fn cotangent(&self, h: HalfedgeId) -> f64 {
        if self.face(h).is_none() {
            return 0.0;
        }
        let apex = self.position(self.from(self.prev(h)));
        let u = half_side(apex, self.position(self.from(h)));
        let v = half_side(apex, self.position(self.to(h)));
        let down = Scale::of_vectors(u, v).down;
        let (u, v) = (u * down, v * down);
        let sine = u.cross(v).length();
        // A quotient of nearly nothing may exceed the range, never leave it.
        if sine > 0.0 { (u.dot(v) / sine).clamp(-f64::MAX, f64::MAX) } else { 0.0 }
    }
}

/// The cotangent weight of each edge, (cot α + cot β) / 2 over the angles opposite it.
///
/// Σ w (x(a) − x(b))² over the edges is twice the Dirichlet energy of the piecewise linear function x
/// (Pinkall and Polthier 1993). Weights are negative where α + β > π.
///
/// Errors: [`Error::NotTriangle`].
pub fn cotangent_weights(mesh: &Mesh) -> Result<EdgeMap<f64>, Error> {
    require_triangles(mesh)?;
    Ok(mesh.map_edges(|e| e.halfedges().iter().map(|&h| 0.5 * mesh.cotangent(h)).sum()))
}

/// An error that names the first face that is no triangle, if there is one.
pub fn require_triangles(mesh: &Mesh) -> Result<(), Error> {
    match mesh.faces().find(|&f| mesh.triangle(f).is_none()) {
        Some(face) => Err(Error::NotTriangle { face, degree: mesh.degree(face) }),
        None => Ok(()),
    }
}
