//! How good the triangles of a mesh are.

use dgp_mesh::{
    FaceId, Mesh,
    measure::{Range, edge_length_range},
    parallel,
};

use crate::Error;

/// What [`triangle_quality`] finds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use]
pub struct TriangleQuality {
    /// The smallest angle, in radians.
    pub minimum_angle: f64,
    /// The angle, in radians, that the smallest of a triangle is below in one of a hundred triangles.
    pub low_angle: f64,
    /// The mean over triangles of their smallest angles, in radians.
    pub mean_minimum_angle: f64,
    /// The share of vertices inside that have six edges.
    pub regular_share: f64,
    /// Shortest, mean and longest edge; `None` without edges.
    pub edge_length: Option<Range>,
}

/// Angles, valences and lengths of a mesh of triangles; all zero without any. Errors: [`Error::NotTriangle`].
pub fn triangle_quality(mesh: &Mesh) -> Result<TriangleQuality, Error> {
    if let Some(face) = mesh.faces().find(|&f| mesh.triangle(f).is_none()) {
        return Err(Error::NotTriangle { face, degree: mesh.degree(face) });
    }
    let smallest = |f: FaceId| {
        mesh.face_halfedges(f).map(|h| mesh.corner_angle(h)).fold(f64::INFINITY, f64::min)
    };
    let angles = parallel::map(mesh.face_count(), smallest);
    let mut angles = angles.into_values();
    if angles.is_empty() {
        return Ok(TriangleQuality::default());
    }
    let mean_minimum_angle = angles.iter().sum::<f64>() / angles.len() as f64;
    let minimum_angle = angles.iter().copied().fold(f64::INFINITY, f64::min);
    let hundredth = angles.len() / 100;
    let (_, low_angle, _) = angles.select_nth_unstable_by(hundredth, f64::total_cmp);
    let low_angle = *low_angle;
    let inside = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v));
    let (mut regular, mut count) = (0_usize, 0_usize);
    for v in inside {
        count += 1;
        regular += usize::from(mesh.valence(v) == 6);
    }
    Ok(TriangleQuality {
        minimum_angle,
        low_angle,
        mean_minimum_angle,
        regular_share: if count > 0 { regular as f64 / count as f64 } else { 0.0 },
        edge_length: edge_length_range(mesh),
    })
}
