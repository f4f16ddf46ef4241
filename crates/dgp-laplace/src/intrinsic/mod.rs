//! Laplacians without negative weights but at rims, of any triangles and of point clouds.
//!
//! | of | function |
//! |---|---|
//! | a triangle mesh | [`intrinsic_delaunay`] |
//! | triangles that are no manifold: any face set | [`tufted_laplacian`] |
//! | points without faces | [`point_cloud_laplacian`] |
//! | lengths alone, step by step | [`IntrinsicTriangulation`] |
//!
//! The surface stays as it is; only the edges, which are straight lines on it, are chosen anew. So the
//! vertices keep their numbers, and the result is what finite elements give on the best triangles that
//! the surface admits.

mod delaunay;
mod mollify;
mod points;
mod triangulation;
mod tufted;

pub use points::{PointCloudOptions, point_cloud_laplacian};
pub use triangulation::IntrinsicTriangulation;
pub use tufted::tufted_laplacian;

use dgp_mesh::{Mesh, Progress, VertexMap};
use dgp_sparse::SparseMatrix;

use crate::Error;

/// How triangles of little area are treated before edges are flipped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntrinsicOptions {
    /// δ, by how much two sides of a triangle are at least longer than the third, in mean edge lengths:
    /// where they are not, the same small length is added to all edges. 0 leaves lengths as they are.
    pub mollify: f64,
}

impl Default for IntrinsicOptions {
    fn default() -> Self {
        IntrinsicOptions { mollify: 1e-6 }
    }
}

/// A Laplacian with its masses.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct IntrinsicLaplacian {
    /// Symmetric, positive semidefinite, the weights as [`IntrinsicReport::least_weight`] says.
    pub laplacian: SparseMatrix,
    /// The barycentric mass of each vertex; 0 on no face.
    pub masses: VertexMap<f64>,
    /// What was done.
    pub report: IntrinsicReport,
}

/// What was done to make triangles Delaunay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntrinsicReport {
    /// How many triangles there are, those of both sides of a tufted cover included.
    pub triangles: usize,
    /// How many edges were flipped.
    pub flips: usize,
    /// What was added to each length so that triangles have area; 0 if they had.
    pub added_length: f64,
    /// The least weight of an edge with two triangles: not negative but for rounding. `None` without such
    /// edges. Tufted covers have no others; the rim of a mesh has, where obtuse angles give negative weights.
    pub least_weight: Option<f64>,
    /// Faces left out since they name a vertex twice.
    pub dropped_faces: usize,
}

/// The Laplacian of the intrinsic Delaunay triangulation of `mesh`.
///
/// Errors: [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`], [`Error::InvalidOption`],
/// [`Error::Cancelled`].
pub fn intrinsic_delaunay(
    mesh: &Mesh,
    options: &IntrinsicOptions,
    progress: Progress<'_>,
) -> Result<IntrinsicLaplacian, Error> {
    let mut triangulation = IntrinsicTriangulation::of_mesh(mesh)?;
    let mut report = delaunay_report(&mut triangulation, *options, progress)?;
    let laplacian = triangulation.laplacian()?;
    report.least_weight = triangulation.least_weight();
    Ok(IntrinsicLaplacian { laplacian, masses: triangulation.masses(), report })
}

/// Mollifies and flips.
fn delaunay_report(
    triangulation: &mut IntrinsicTriangulation,
    options: IntrinsicOptions,
    progress: Progress<'_>,
) -> Result<IntrinsicReport, Error> {
    let added_length = triangulation.mollify(options.mollify)?;
    let flips = triangulation.flip_to_delaunay(progress)?;
    Ok(IntrinsicReport {
        triangles: triangulation.triangle_count(),
        flips,
        added_length,
        least_weight: None,
        dropped_faces: 0,
    })
}

#[cfg(test)]
mod cloud_tests;
#[cfg(test)]
mod tests;
