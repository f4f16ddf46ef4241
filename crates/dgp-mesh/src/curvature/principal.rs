//! Principal curvatures by the change of vertex normals along the edges of each triangle.
//!
//! ```text
//! II e = Δn      for the three sides e of a triangle, with the difference Δn of the normals at the ends
//! ```
//!
//! in the plane of the triangle: six equations for the three entries of its second fundamental form
//! II, solved in the sense of least squares. The forms of the triangles around a vertex are turned into
//! its tangent plane and averaged by the area that belongs to the corner.
//!
//! - Input: a triangle mesh, with or without holes.
//! - Cost: O(V) time and memory.
//! - Guarantees: exactly 0 in a plane. Finite. Rims of holes have values too, from the triangles on one
//!   side.
//! - Reference: Rusinkiewicz, "Estimating curvatures and their derivatives on triangle meshes",
//!   3DPVT 2004.
//! - Departs from it: triangles without area and those that look against the vertex normal are left
//!   out; noise of the last bits of the coordinates counts as zero.

use std::ops::Add;

use glam::DVec3;

use super::{
    tensor::{PrincipalCurvatures, Tangents, Tensor},
    triangle::{Corners, sum_at_corners},
};
use crate::{
    Error, Mesh, VertexId, VertexMap,
    measure::{NormalWeight, VertexArea, frame::Frame, require_triangles, vertex_normals},
};

/// The principal curvatures and directions at each vertex, from its one-ring.
///
/// All zero on no face and where the normals around a vertex cancel; zero curvature where its triangles
/// have no area beside the mesh. Errors: [`Error::NotTriangle`].
pub fn principal_curvatures(mesh: &Mesh) -> Result<VertexMap<PrincipalCurvatures>, Error> {
    require_triangles(mesh)?;
    let frame = Frame::of(mesh);
    // Max's weights, as in the paper: exact on spheres.
    let normals = vertex_normals(mesh, NormalWeight::Max);
    let sums = sum_at_corners(mesh, |_, corners| {
        let points = corners.map(|v| frame.scaled(mesh.position(v)));
        face_terms(points, corners.map(|v| normals[v]))
    });
    let per_length = frame.per_measure(1.0, 1);
    Ok(mesh.map_vertices(|v| {
        let Some(tangents) = Tangents::of_normal(normals[v]) else {
            return PrincipalCurvatures::default();
        };
        let Weighted { tensor, area } = sums[v.index()];
        let tensor = tensor.scaled(1.0 / area);
        let tensor = if tensor.is_finite() { tensor } else { Tensor::default() };
        let rounding = rounding(mesh, &frame, v, area);
        let found = tensor.principal(&tangents, rounding);
        PrincipalCurvatures { max: found.max * per_length, min: found.min * per_length, ..found }
    }))
}

/// A tensor times an area, and the area.
#[derive(Clone, Copy, Default)]
struct Weighted {
    tensor: Tensor,
    area: f64,
}

impl Add for Weighted {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Weighted { tensor: self.tensor + other.tensor, area: self.area + other.area }
    }
}

/// What a triangle adds to its corners, in the frames of their tangent planes.
fn face_terms(points: [DVec3; 3], normals: [DVec3; 3]) -> [Weighted; 3] {
    let areas = Corners::of(points).areas(VertexArea::MixedVoronoi);
    let Some((tangents, tensor)) = face_tensor(points, normals) else {
        return [Weighted::default(); 3];
    };
    [0, 1, 2].map(|k| match turned(tensor, &tangents, normals[k]) {
        Some(tensor) => Weighted { tensor: tensor.scaled(areas[k]), area: areas[k] },
        None => Weighted::default(),
    })
}

/// The second fundamental form of a triangle; `None` if it has no area.
fn face_tensor([a, b, c]: [DVec3; 3], [l, m, n]: [DVec3; 3]) -> Option<(Tangents, Tensor)> {
    let sides = [(c - b, n - m), (a - c, l - n), (b - a, m - l)];
    let normal = sides[0].0.cross(sides[1].0).try_normalize()?;
    let u = sides[0].0.try_normalize()?;
    let tangents = Tangents { normal, u, v: normal.cross(u) };
    // The normal equations of the six equations, with the sums A, B, C of squares and products.
    let (mut aa, mut bb, mut cc) = (0.0, 0.0, 0.0);
    let mut rhs = [0.0; 3];
    for (side, change) in sides {
        let [x, y] = [side.dot(tangents.u), side.dot(tangents.v)];
        let [p, q] = [change.dot(tangents.u), change.dot(tangents.v)];
        aa += x * x;
        bb += x * y;
        cc += y * y;
        rhs[0] += x * p;
        rhs[1] += x * q + y * p;
        rhs[2] += y * q;
    }
    // Their inverse in closed form; the determinant is (A + C)(AC − B²).
    let (trace, minor) = (aa + cc, aa * cc - bb * bb);
    let [p, q, r] = rhs;
    let tensor = Tensor {
        uu: ((trace * cc - bb * bb) * p - bb * cc * q + bb * bb * r) / (trace * minor),
        uv: (-bb * cc * p + aa * cc * q - aa * bb * r) / (trace * minor),
        vv: (bb * bb * p - aa * bb * q + (trace * aa - bb * bb) * r) / (trace * minor),
    };
    tensor.is_finite().then_some((tangents, tensor))
}

/// `tensor` of the plane of a triangle in that of a vertex, turned about their common line.
fn turned(tensor: Tensor, face: &Tangents, normal: DVec3) -> Option<Tensor> {
    // Closer to the opposite direction there is no telling which way to turn.
    const OPPOSITE: f64 = 1e-6;
    let vertex = Tangents::of_normal(normal)?;
    let one_plus_cosine = 1.0 + face.normal.dot(vertex.normal);
    if one_plus_cosine < OPPOSITE {
        return None;
    }
    // The vectors of the vertex turned into the plane of the triangle.
    let middle = (face.normal + vertex.normal) / one_plus_cosine;
    let back = |x: DVec3| {
        let x = x - middle * face.normal.dot(x);
        [x.dot(face.u), x.dot(face.v)]
    };
    let (u, v) = (back(vertex.u), back(vertex.v));
    Some(Tensor { uu: tensor.form(u, u), uv: tensor.form(u, v), vv: tensor.form(v, v) })
}

/// The curvature that moves of vertices within the rounding of their coordinates can make, at the scale
/// of `frame`: over edges of length h a normal turns by r/h, and curvature is turning over h.
pub(super) fn rounding(mesh: &Mesh, frame: &Frame, v: VertexId, area: f64) -> f64 {
    const ROUNDING: f64 = 16.0 * f64::EPSILON;
    let size = frame.scaled(mesh.position(v)).abs().max_element() + area.sqrt();
    ROUNDING * size / area
}
