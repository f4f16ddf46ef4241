//! The cotangent Laplacian: that of piecewise linear functions on the triangles.
//!
//! ```text
//! L(i, j) = −(cot α + cot β)/2      with the angles opposite edge ij, one at a rim
//! xᵀ L x = ∫ |∇x|²                  of the function x, linear on each triangle
//! ```
//!
//! - Input: a triangle mesh, with or without holes.
//! - Cost: O(V) time and memory; one pass over faces, one over edges.
//! - Guarantees: symmetric, positive semidefinite but for rounding, L·1 = 0. Depends on angles alone.
//!   Weights are negative where α + β > π ([`laplacian_report`](super::laplacian_report) counts them);
//!   [`IntrinsicTriangulation`](crate::intrinsic::IntrinsicTriangulation) gives one without. Triangles without area
//!   count for nothing.
//! - Reference: Pinkall and Polthier, "Computing discrete minimal surfaces and their conjugates",
//!   Experimental Mathematics 2(1), 1993.

use dgp_mesh::{Mesh, measure::cotangent_weights};
use dgp_sparse::SparseMatrix;

use super::assemble::symmetric;
use crate::Error;

/// The stiffness matrix of linear finite elements.
///
/// Errors: [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`].
pub fn cotangent_laplacian(mesh: &Mesh) -> Result<SparseMatrix, Error> {
    let weights = cotangent_weights(mesh)?;
    symmetric(mesh, |e| weights[e])
}
