//! The uniform Laplacian: that of the graph of vertices and edges.
//!
//! ```text
//! L = D − A      the number of edges on the diagonal, −1 for each neighbor
//! ```
//!
//! - Input: the connectivity of any mesh.
//! - Cost: O(V) time and memory.
//! - Guarantees: symmetric, positive semidefinite, L·1 = 0 exactly. As many zero eigenvalues as parts;
//!   vertices of no face are parts of their own.
//! - Reference: Fiedler, "Algebraic connectivity of graphs", Czechoslovak Mathematical Journal 23, 1973.

use dgp_mesh::Connectivity;
use dgp_sparse::SparseMatrix;

use super::assemble::symmetric;
use crate::Error;

/// D − A: valences on the diagonal, −1 between neighbors.
///
/// Errors: [`Error::Sparse`] for more entries than a matrix can hold.
pub fn uniform_laplacian(mesh: &Connectivity) -> Result<SparseMatrix, Error> {
    symmetric(mesh, |_| 1.0)
}
