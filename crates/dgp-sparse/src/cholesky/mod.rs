//! Cholesky factorization: solves symmetric positive definite systems directly.
//!
//! ```text
//! P A Pᵀ = L Lᵀ,   L (Lᵀ (P x)) = P b
//! ```
//!
//! P orders the rows so that L stays sparse. [`SymbolicCholesky`] finds P and the pattern of L from the
//! pattern of A alone; [`Cholesky`] adds the numbers and solves. Columns of L with equal pattern are
//! kept together as dense blocks (supernodes), on which faer's kernels compute.
//!
//! - Input: a symmetric matrix of which both triangles are stored.
//! - Cost: for a mesh of n vertices O(n log n) entries of L and O(n^1.5) operations.
//! - Guarantees: a solution is returned only if it fulfils its equations; a matrix that is indefinite
//!   or singular to working precision is an error that names a row. Scaling A or b by 2ᵏ scales the
//!   solution exactly. Same bits for any number of threads.
//! - Reference: George and Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981;
//!   Ng and Peyton, "Block sparse Cholesky algorithms", 1993.

mod diagnose;
mod inertia;
mod kernel;
mod large;
mod numeric;
mod solve;
mod supernodes;
mod symbolic;

use std::{fmt, sync::Arc};

pub(crate) use diagnose::{component, sums_to_zero};
pub use symbolic::SymbolicCholesky;

use crate::{Error, Ordering, Progress, SparseMatrix, parallel};

/// How [`Cholesky::new`] factors.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CholeskyOptions {
    /// The order of elimination.
    pub ordering: Ordering,
}

/// A factored symmetric positive definite matrix.
///
/// ```
/// use dgp_sparse::{Cholesky, CholeskyOptions, Progress, SparseMatrix};
///
/// // A path of three vertices; the mass makes its Laplacian definite.
/// let laplacian = SparseMatrix::from_edges(3, &[(0, 1, 1.0), (1, 2, 1.0)])?;
/// let matrix = laplacian.plus_diagonal(&[1.0; 3])?;
/// let cholesky = Cholesky::new(&matrix, &CholeskyOptions::default(), Progress::NONE)?;
/// let x = cholesky.solve(&[1.0, 0.0, 0.0])?;
/// assert!((x[0] - 0.625).abs() < 1e-15);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
#[derive(Clone)]
pub struct Cholesky {
    symbolic: Arc<SymbolicCholesky>,
    /// The lower triangle of P A Pᵀ / scale, in the places that the symbolic part lists.
    lower: Vec<f64>,
    /// A power of two near the largest diagonal entry.
    scale: f64,
    /// The largest sum of |entries| of a row of A / scale.
    norm: f64,
    /// The blocks of L one after the other, each by columns.
    factor: Vec<f64>,
}

impl Cholesky {
    /// Analyzes and factors `matrix`.
    pub fn new(
        matrix: &SparseMatrix,
        options: &CholeskyOptions,
        progress: Progress<'_>,
    ) -> Result<Cholesky, Error> {
        let symbolic = SymbolicCholesky::new(matrix, options, progress.part(0.0, 0.5))?;
        let mut cholesky = Cholesky::unfactored(&Arc::new(symbolic));
        cholesky.factor_symmetric(matrix, progress.part(0.5, 1.0))?;
        Ok(cholesky)
    }

    /// Factors `matrix`, whose pattern is the one that was analyzed.
    pub fn with_symbolic(
        symbolic: &Arc<SymbolicCholesky>,
        matrix: &SparseMatrix,
        progress: Progress<'_>,
    ) -> Result<Cholesky, Error> {
        let mut cholesky = Cholesky::unfactored(symbolic);
        cholesky.refactor(matrix, progress)?;
        Ok(cholesky)
    }

    fn unfactored(symbolic: &Arc<SymbolicCholesky>) -> Cholesky {
        Cholesky {
            symbolic: Arc::clone(symbolic),
            lower: Vec::new(),
            scale: 1.0,
            norm: 0.0,
            factor: Vec::new(),
        }
    }

    /// Factors another matrix with the same pattern.
    ///
    /// After [`Error::Cancelled`], or where this matrix does not fit, the factorization is the one before;
    /// where it has no factor, solving fails from now on.
    pub fn refactor(&mut self, matrix: &SparseMatrix, progress: Progress<'_>) -> Result<(), Error> {
        self.symbolic.check_pattern(matrix)?;
        matrix.check_symmetric()?;
        self.factor_symmetric(matrix, progress)
    }

    /// Factors a matrix that is known to be symmetric and to have the pattern.
    fn factor_symmetric(
        &mut self,
        matrix: &SparseMatrix,
        progress: Progress<'_>,
    ) -> Result<(), Error> {
        matrix.check_finite()?;
        progress.report(0.0)?;
        self.scale = power_of_two(matrix.diagonal().into_iter().fold(0.0, f64::max));
        let values = || self.symbolic.lower_values(matrix, 1.0 / self.scale);
        let (lower, norm) = parallel::join(values, || matrix.row_norm() / self.scale);
        (self.lower, self.norm) = (lower, norm);
        let failed = self.factor().err();
        match self.symbolic.worst_pivot(&self.lower, &self.factor, failed) {
            Some(place) => {
                let error = self.diagnosis(matrix, place);
                self.factor.fill(f64::NAN);
                Err(error)
            }
            None => Ok(()),
        }
    }

    /// L from the lower triangle; the place of the pivot that is not positive, if there is one.
    fn factor(&mut self) -> Result<(), usize> {
        let entries = self.symbolic.stored_entries();
        if self.factor.len() != entries {
            // The system hands out zeros without writing them.
            self.factor = vec![0.0; entries];
        }
        self.symbolic.factor_numbers(&self.lower, &mut self.factor)
    }

    /// What does not depend on the values.
    pub fn symbolic(&self) -> &Arc<SymbolicCholesky> {
        &self.symbolic
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.symbolic.rows()
    }
}

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Cholesky({:?})", self.symbolic)
    }
}

/// The power of two next below `value`; 1 for what is not positive.
pub(crate) fn power_of_two(value: f64) -> f64 {
    let normal = f64::from_bits(value.to_bits() & f64::INFINITY.to_bits());
    if value > 0.0 && normal > 0.0 && (1.0 / normal).is_normal() { normal } else { 1.0 }
}
