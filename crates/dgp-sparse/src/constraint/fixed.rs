//! Fixed unknowns are eliminated: what is left is smaller and definite.
//!
//! ```text
//! A = (F  Cᵀ)   x = (free )     F x_free = b_free − Cᵀ x_fixed
//!     (C  G )       (fixed)
//! ```
//!
//! - Input: a symmetric matrix that is positive definite on the free unknowns, such as a Laplacian of
//!   which each component has a fixed vertex.
//! - Cost: one factorization of F; then a solve for each set of fixed values.
//! - Reference: none; elimination.

use crate::{Cholesky, CholeskyOptions, Error, Progress, SparseMatrix};

/// A system some of whose unknowns are given, factored for any values of them.
///
/// ```
/// use dgp_sparse::{CholeskyOptions, FixedSystem, Progress, SparseMatrix};
///
/// // Along a path the harmonic function between fixed ends is linear.
/// let laplacian = SparseMatrix::from_edges(3, &[(0, 1, 1.0), (1, 2, 1.0)])?;
/// let options = CholeskyOptions::default();
/// let system = FixedSystem::new(&laplacian, &[2, 0], &options, Progress::NONE)?;
/// assert_eq!(system.solve(&[0.0; 3], &[10.0, 0.0])?, [0.0, 5.0, 10.0]);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FixedSystem {
    free: Vec<u32>,
    fixed: Vec<u32>,
    cholesky: Cholesky,
    /// Rows of fixed, columns of free unknowns; its rows stand in the order of `sorted`.
    coupling: SparseMatrix,
    sorted: Vec<u32>,
}

impl FixedSystem {
    /// Factors `matrix` without the rows and columns `fixed`.
    pub fn new(
        matrix: &SparseMatrix,
        fixed: &[u32],
        options: &CholeskyOptions,
        progress: Progress<'_>,
    ) -> Result<FixedSystem, Error> {
        matrix.check_symmetric()?;
        let n = matrix.rows();
        let mut is_fixed = vec![false; n];
        for (entry, &row) in fixed.iter().enumerate() {
            let row = row as usize;
            match is_fixed.get_mut(row) {
                None => {
                    return Err(Error::OutOfRange { entry, row, column: row, rows: n, columns: n });
                }
                Some(true) => return Err(Error::FixedTwice { row }),
                Some(free) => *free = true,
            }
        }
        check_components(matrix, &is_fixed)?;
        let free: Vec<u32> = (0..n as u32).filter(|&i| !is_fixed[i as usize]).collect();
        let sorted: Vec<u32> = (0..n as u32).filter(|&i| is_fixed[i as usize]).collect();
        let inner = matrix.submatrix(&free, &free)?;
        let cholesky =
            Cholesky::new(&inner, options, progress).map_err(|error| error.renumbered(&free))?;
        let coupling = matrix.submatrix(&sorted, &free)?;
        Ok(FixedSystem { free, fixed: fixed.to_vec(), cholesky, coupling, sorted })
    }

    /// Factors another matrix with the same pattern and the same fixed unknowns.
    pub fn refactor(&mut self, matrix: &SparseMatrix, progress: Progress<'_>) -> Result<(), Error> {
        Error::check_length("the matrix (rows)", matrix.rows(), self.rows())?;
        matrix.check_symmetric()?;
        let mut is_fixed = vec![false; matrix.rows()];
        self.fixed.iter().for_each(|&row| is_fixed[row as usize] = true);
        check_components(matrix, &is_fixed)?;
        let inner = matrix.submatrix(&self.free, &self.free)?;
        let refactored = self.cholesky.refactor(&inner, progress);
        refactored.map_err(|error| error.renumbered(&self.free))?;
        self.coupling = matrix.submatrix(&self.sorted, &self.free)?;
        Ok(())
    }

    /// All unknowns, where the fixed ones have these `values`, in the order in which they were named.
    ///
    /// `rhs` has an entry for each row; those of fixed rows do not matter.
    pub fn solve(&self, rhs: &[f64], values: &[f64]) -> Result<Vec<f64>, Error> {
        Error::check_length("the right-hand side", rhs.len(), self.rows())?;
        Error::check_length("the fixed values", values.len(), self.fixed.len())?;
        self.solve_many(rhs, values, 1)
    }

    /// The same for `count` systems, whose right-hand sides stand one after the other, and whose fixed
    /// values and solutions do likewise.
    pub fn solve_many(&self, rhs: &[f64], values: &[f64], count: usize) -> Result<Vec<f64>, Error> {
        let (n, fixed) = (self.rows(), self.fixed.len());
        Error::check_length("the right-hand side", rhs.len(), n * count)?;
        Error::check_length("the fixed values", values.len(), fixed * count)?;
        Error::check_finite("the fixed values", values)?;
        let mut all = vec![0.0; n * count];
        let mut inner = Vec::with_capacity(self.free.len() * count);
        for k in 0..count {
            let x = &mut all[k * n..(k + 1) * n];
            for (&row, &value) in self.fixed.iter().zip(&values[k * fixed..]) {
                x[row as usize] = value;
            }
            let given: Vec<f64> = self.sorted.iter().map(|&row| x[row as usize]).collect();
            let known = self.coupling.transpose_product(&given);
            let rhs = &rhs[k * n..(k + 1) * n];
            inner
                .extend(self.free.iter().zip(known).map(|(&row, known)| rhs[row as usize] - known));
        }
        self.cholesky.solve_in_place(&mut inner)?;
        for k in 0..count {
            let solved = &inner[k * self.free.len()..];
            for (&row, &value) in self.free.iter().zip(solved) {
                all[k * n + row as usize] = value;
            }
        }
        Ok(all)
    }

    /// The number of unknowns, the fixed ones included.
    pub fn rows(&self) -> usize {
        self.free.len() + self.fixed.len()
    }

    /// The unknowns that are not fixed, in ascending order.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// The factored part.
    pub fn cholesky(&self) -> &Cholesky {
        &self.cholesky
    }
}

/// An error for a component whose rows sum to zero and of which none is fixed.
fn check_components(matrix: &SparseMatrix, is_fixed: &[bool]) -> Result<(), Error> {
    for component in super::constant_components(matrix) {
        if !component.iter().any(|&row| is_fixed[row as usize]) {
            let row = component.iter().min().map_or(0, |&row| row as usize);
            return Err(Error::Unconstrained { row, size: component.len() });
        }
    }
    Ok(())
}
