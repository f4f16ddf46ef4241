//! All curvatures of a mesh in a few numbers.

use std::f64::consts::TAU;

use super::{angle_defects, gaussian_curvatures, mean_curvatures, principal_curvatures};
use crate::{
    Error, Mesh,
    measure::{Range, VertexArea},
    topology::euler_characteristic,
};

/// What [`curvature_report`] tells.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct CurvatureReport {
    /// Σ of the angle defects, rims included.
    pub total_gaussian: f64,
    /// χ.
    pub euler_characteristic: i64,
    /// How far the total is from 2πχ: rounding alone.
    pub gauss_bonnet_error: f64,
    /// Gaussian curvature by angle defects over mixed Voronoi areas, of vertices that lie on faces and
    /// on no rim; `None` if there are none. The mean is over vertices.
    pub gaussian: Option<Range>,
    /// Mean curvature by cotangents, of the same vertices.
    pub mean: Option<Range>,
    /// κ₁ of [`principal_curvatures`], of all vertices on faces.
    pub max: Option<Range>,
    /// κ₂, of the same.
    pub min: Option<Range>,
}

/// The ranges of all curvatures of `mesh`, and Gauss–Bonnet checked. Errors: [`Error::NotTriangle`].
pub fn curvature_report(mesh: &Mesh) -> Result<CurvatureReport, Error> {
    let total_gaussian: f64 = angle_defects(mesh)?.values().iter().sum();
    let euler_characteristic = euler_characteristic(mesh);
    let gaussian = gaussian_curvatures(mesh, VertexArea::MixedVoronoi)?;
    let mean = mean_curvatures(mesh, VertexArea::MixedVoronoi)?;
    let principal = principal_curvatures(mesh)?;
    let inner: Vec<_> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
    let faced: Vec<_> = mesh.vertices().filter(|&v| !mesh.is_isolated_vertex(v)).collect();
    let range = |values: Vec<f64>| Range::of(&values);
    Ok(CurvatureReport {
        total_gaussian,
        euler_characteristic,
        gauss_bonnet_error: (total_gaussian - TAU * euler_characteristic as f64).abs(),
        gaussian: range(inner.iter().map(|&v| gaussian[v]).collect()),
        mean: range(inner.iter().map(|&v| mean[v]).collect()),
        max: range(faced.iter().map(|&v| principal[v].max).collect()),
        min: range(faced.iter().map(|&v| principal[v].min).collect()),
    })
}
