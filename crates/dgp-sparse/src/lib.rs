//! Sparse matrices, and the solvers that geometry needs.
//!
//! | task | items |
//! |---|---|
//! | assemble, combine, multiply | [`SparseMatrix`] |
//! | solve a symmetric positive definite system | [`Cholesky`], [`SymbolicCholesky`], [`CholeskyOptions`] |
//! | some unknowns or equations are given | [`FixedSystem`], [`SoftSystem`], [`EqualitySystem`] |
//! | solve an unsymmetric system | [`Lu`] |
//! | more equations than unknowns | [`least_squares`] |
//! | systems too large to factor | [`conjugate_gradients`], [`ConjugateGradients`] |
//! | the smallest eigenvalues | [`eigenpairs`], [`EigenOptions`], [`Mass`] |
//! | keep the factor sparse | [`Ordering`], [`elimination_order`] |
//! | read and write | [`SparseMatrix::from_matrix_market`], [`SparseMatrix::to_matrix_market`] |
//! | long computations | [`Progress`] |
//!
//! ```
//! use dgp_sparse::{Cholesky, CholeskyOptions, Progress, SparseMatrix};
//!
//! let laplacian = SparseMatrix::from_edges(3, &[(0, 1, 1.0), (1, 2, 1.0)])?;
//! let matrix = laplacian.plus_diagonal(&[1.0; 3])?;
//! let x = Cholesky::new(&matrix, &CholeskyOptions::default(), Progress::NONE)?
//!     .solve(&[1.0, 0.0, 0.0])?;
//! assert!((x.iter().sum::<f64>() - 1.0).abs() < 1e-15);
//! # Ok::<(), dgp_sparse::Error>(())
//! ```

mod cholesky;
mod constraint;
mod eigen;
mod error;
mod iterative;
mod least_squares;
mod lu;
mod matrix;
mod matrix_market;
mod order;
mod parallel;
mod progress;

pub use cholesky::{Cholesky, CholeskyOptions, SymbolicCholesky};
pub use constraint::{EqualitySystem, FixedSystem, SoftSystem};
pub use eigen::{EigenOptions, EigenReport, Eigenpairs, Mass, Shift, eigenpairs};
pub use error::Error;
pub use iterative::{
    ConjugateGradients, ConjugateGradientsOptions, ConjugateGradientsReport, Preconditioner,
    conjugate_gradients,
};
pub use least_squares::{LeastSquares, LeastSquaresMethod, least_squares};
pub use lu::Lu;
pub use matrix::{MAX_ENTRIES, SparseMatrix};
pub use order::{Ordering, elimination_order};
pub use progress::{Callback, Progress};
