//! Cotangents of the angles of triangles, from which Laplacians are made.

use std::ops::Range;

use glam::DVec3;

use super::scale::{Scale, half_side};
use crate::{EdgeMap, Error, FaceId, HalfedgeId, Mesh, parallel};

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
    // Face by face, so that each triangle is read and computed once. An edge has two terms at most,
    // whose order does not matter: two halves give the same bits as one.
    let part = |faces: Range<usize>| {
        if faces.is_empty() && faces.start > 0 {
            return Vec::new();
        }
        let mut weights = vec![0.0; mesh.edge_count()];
        for h in faces.map(|f| mesh.face_halfedge(FaceId::new(f))) {
            let (g, k) = (mesh.next(h), mesh.prev(h));
            let points = [k, h, g].map(|side| mesh.position(mesh.to(side)));
            // Opposite the sides g, k, h lie the corners of h, g, k.
            for (side, cotangent) in [g, k, h].into_iter().zip(triangle_cotangents(points)) {
                weights[side.edge().index()] += 0.5 * cotangent;
            }
        }
        weights
    };
    let count = mesh.face_count();
    let middle = if count > 2 * parallel::BLOCK { count / 2 } else { count };
    let (mut weights, others) = parallel::join(|| part(0..middle), || part(middle..count));
    weights.iter_mut().zip(&others).for_each(|(weight, other)| *weight += other);
    Ok(weights.into())
}

/// The cotangents of the angles of a triangle; all 0 if it has no area.
#[inline]
fn triangle_cotangents([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, bc, ca) = (half_side(a, b), half_side(b, c), half_side(c, a));
    let down = Scale::of(ab.abs().max(bc.abs()).max(ca.abs()).max_element()).down;
    let (ab, bc, ca) = (ab * down, bc * down, ca * down);
    let sine = cross_of_shorter(ab, bc, ca).length();
    if sine == 0.0 {
        return [0.0; 3];
    }
    // A quotient of nearly nothing may exceed the range, never leave it.
    [-ca.dot(ab), -ab.dot(bc), -bc.dot(ca)].map(|dot| (dot / sine).clamp(-f64::MAX, f64::MAX))
}

/// Twice the vector area of a triangle with these sides: of the two shorter ones, since in a needle the
/// longer two cancel.
#[inline]
pub(crate) fn cross_of_shorter(ab: DVec3, bc: DVec3, ca: DVec3) -> DVec3 {
    let [x, y, z] = [ab, bc, ca].map(DVec3::length_squared);
    if x >= y && x >= z {
        bc.cross(ca)
    } else if y >= z {
        ca.cross(ab)
    } else {
        ab.cross(bc)
    }
}

/// An error that names the first face that is no triangle, if there is one.
pub fn require_triangles(mesh: &Mesh) -> Result<(), Error> {
    match mesh.faces().find(|&f| mesh.triangle(f).is_none()) {
        Some(face) => Err(Error::NotTriangle { face, degree: mesh.degree(face) }),
        None => Ok(()),
    }
}
