//! Equations that hold as well as their weights demand.
//!
//! ```text
//! minimize  ½ xᵀ A x − bᵀ x + ½ Σ wᵢ (cᵢ·x − dᵢ)²     ⇔     (A + Cᵀ W C) x = b + Cᵀ W d
//! ```
//!
//! - Input: a symmetric positive semidefinite A that the equations make definite; weights ≥ 0.
//! - Cost: one factorization of A + CᵀWC, which is sparse where each equation has few unknowns.
//! - Reference: none; the normal equations.

use crate::{Cholesky, CholeskyOptions, Error, Progress, SparseMatrix};

/// A system with weighted equations, factored for any targets of them.
///
/// ```
/// use dgp_sparse::{CholeskyOptions, Progress, SoftSystem, SparseMatrix};
///
/// // The ends of a path are pulled to 0 and 1.
/// let laplacian = SparseMatrix::from_edges(2, &[(0, 1, 1.0)])?;
/// let ends = SparseMatrix::identity(2);
/// let options = CholeskyOptions::default();
/// let system = SoftSystem::new(&laplacian, &ends, &[2.0, 2.0], &options, Progress::NONE)?;
/// let x = system.solve(&[0.0; 2], &[0.0, 1.0])?;
/// assert!((x[0] - 0.25).abs() < 1e-15 && (x[1] - 0.75).abs() < 1e-15);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SoftSystem {
    cholesky: Cholesky,
    /// W C.
    weighted: SparseMatrix,
}

impl SoftSystem {
    /// Factors `matrix` with the equations `constraints` · x = targets, one in each row, of which each
    /// has a weight.
    pub fn new(
        matrix: &SparseMatrix,
        constraints: &SparseMatrix,
        weights: &[f64],
        options: &CholeskyOptions,
        progress: Progress<'_>,
    ) -> Result<SoftSystem, Error> {
        Error::check_length("the constraints (columns)", constraints.columns(), matrix.rows())?;
        Error::check_length("the weights", weights.len(), constraints.rows())?;
        if let Some(&weight) = weights.iter().find(|weight| weight.is_nan() || **weight < 0.0) {
            return Err(Error::option("weights", weight, "not negative"));
        }
        matrix.check_symmetric()?;
        let sum = SparseMatrix::combine(1.0, matrix, 1.0, &constraints.gram(weights)?)?;
        let cholesky = Cholesky::new(&sum, options, progress)?;
        let ones = vec![1.0; matrix.rows()];
        let weighted = constraints.clone().scaled_by(weights, &ones)?;
        Ok(SoftSystem { cholesky, weighted })
    }

    /// The minimum for these targets.
    pub fn solve(&self, rhs: &[f64], targets: &[f64]) -> Result<Vec<f64>, Error> {
        Error::check_length("the right-hand side", rhs.len(), self.cholesky.rows())?;
        Error::check_length("the targets", targets.len(), self.weighted.rows())?;
        Error::check_finite("the targets", targets)?;
        let pull = self.weighted.transpose_product(targets);
        let sum: Vec<f64> = rhs.iter().zip(pull).map(|(rhs, pull)| rhs + pull).collect();
        self.cholesky.solve(&sum)
    }
}
