//! Conjugate gradients: solves symmetric positive definite systems that are too large to factor.
//!
//! ```text
//! x ← x + α p,  r ← r − α A p,  p ← P⁻¹ r + β p        α = rᵀP⁻¹r / pᵀA p
//! ```
//!
//! P is near A and easy to solve with: the diagonal of A (Jacobi), or an incomplete Cholesky factor.
//!
//! - Input: a symmetric positive definite matrix of which both triangles are stored; or a semidefinite
//!   one and a right-hand side in its range, such as that of a Laplacian with sum zero.
//! - Cost: memory of a few vectors and a copy of the lower triangle; iterations grow with the root of the
//!   condition number, for meshes with the root of the number of vertices.
//! - Guarantees: the residual is computed anew before a solution is returned. Same bits for any number of
//!   threads; scaling by 2ᵏ scales exactly.
//! - Reference: Hestenes and Stiefel, "Methods of conjugate gradients for solving linear systems", 1952;
//!   Saad, "Iterative Methods for Sparse Linear Systems", 2003, algorithm 9.1.

mod incomplete;

use incomplete::IncompleteCholesky;

use crate::{Error, Progress, SparseMatrix, parallel};

/// Numbers of a task of their own.
const BLOCK: usize = 8192;

/// What to divide by between iterations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preconditioner {
    /// The diagonal.
    Jacobi,
    /// A Cholesky factor with entries only where the matrix has some. Fewer iterations than with Jacobi
    /// (three fifths on a sphere), each of which takes longer.
    #[default]
    IncompleteCholesky,
}

/// When [`conjugate_gradients`] stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradientsOptions {
    /// The residual ‖b − A x‖ / ‖b‖ to reach.
    pub tolerance: f64,
    /// The most iterations.
    pub iterations: usize,
    /// What to divide by between iterations.
    pub preconditioner: Preconditioner,
}

impl Default for ConjugateGradientsOptions {
    fn default() -> Self {
        let preconditioner = Preconditioner::default();
        ConjugateGradientsOptions { tolerance: 1e-10, iterations: 10_000, preconditioner }
    }
}

/// How a solution was reached.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct ConjugateGradientsReport {
    /// The iterations.
    pub iterations: usize,
    /// ‖b − A x‖ / ‖b‖.
    pub residual: f64,
    /// By how much of itself the diagonal was raised until the incomplete factor existed; 0 if it did at
    /// once.
    pub shift: f64,
}

/// A matrix with its preconditioner, for several right-hand sides.
#[derive(Clone, Debug)]
pub struct ConjugateGradients<'a> {
    matrix: &'a SparseMatrix,
    options: ConjugateGradientsOptions,
    divisor: Divisor,
}

/// P.
#[derive(Clone, Debug)]
enum Divisor {
    Diagonal(Vec<f64>),
    Factor(IncompleteCholesky),
}

/// x with A x = `rhs`, by iterations.
///
/// ```
/// use dgp_sparse::{ConjugateGradientsOptions, Progress, SparseMatrix, conjugate_gradients};
///
/// let laplacian = SparseMatrix::from_edges(3, &[(0, 1, 1.0), (1, 2, 1.0)])?;
/// let matrix = laplacian.plus_diagonal(&[1.0; 3])?;
/// let options = ConjugateGradientsOptions::default();
/// let (x, report) = conjugate_gradients(&matrix, &[1.0, 0.0, 0.0], &options, Progress::NONE)?;
/// assert!((x[0] - 0.625).abs() < 1e-10 && report.residual <= 1e-10);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
pub fn conjugate_gradients(
    matrix: &SparseMatrix,
    rhs: &[f64],
    options: &ConjugateGradientsOptions,
    progress: Progress<'_>,
) -> Result<(Vec<f64>, ConjugateGradientsReport), Error> {
    ConjugateGradients::new(matrix, options)?.solve(rhs, progress)
}

impl<'a> ConjugateGradients<'a> {
    /// Makes the preconditioner.
    pub fn new(
        matrix: &'a SparseMatrix,
        options: &ConjugateGradientsOptions,
    ) -> Result<ConjugateGradients<'a>, Error> {
        matrix.check_finite()?;
        matrix.check_symmetric()?;
        if !(options.tolerance > 0.0 && options.tolerance < 1.0) {
            return Err(Error::option("tolerance", options.tolerance, "between 0 and 1"));
        }
        let diagonal = matrix.diagonal();
        if let Some(row) = diagonal.iter().position(|&value| value <= 0.0) {
            let diagonal = diagonal[row];
            return Err(Error::NotPositiveDefinite { row, pivot: diagonal, diagonal });
        }
        let divisor = match options.preconditioner {
            Preconditioner::Jacobi => Divisor::Diagonal(diagonal),
            Preconditioner::IncompleteCholesky => {
                Divisor::Factor(IncompleteCholesky::new(matrix, &diagonal))
            }
        };
        Ok(ConjugateGradients { matrix, options: *options, divisor })
    }

    /// x with A x = `rhs`; an error if the iterations do not suffice.
    pub fn solve(
        &self,
        rhs: &[f64],
        progress: Progress<'_>,
    ) -> Result<(Vec<f64>, ConjugateGradientsReport), Error> {
        let n = self.matrix.rows();
        Error::check_length("the right-hand side", rhs.len(), n)?;
        Error::check_finite("the right-hand side", rhs)?;
        let target = dot(rhs, rhs).sqrt();
        let shift = match &self.divisor {
            Divisor::Diagonal(_) => 0.0,
            Divisor::Factor(factor) => factor.shift(),
        };
        let mut x = vec![0.0; n];
        let mut residual = rhs.to_vec();
        let mut direction = self.divided(&residual);
        let mut product = vec![0.0; n];
        let mut square = dot(&residual, &direction);
        let mut size: f64 = if target > 0.0 { 1.0 } else { 0.0 };
        let mut best = size;
        for iteration in 0..=self.options.iterations {
            // Iterations reduce the logarithm of the residual about evenly.
            let done = size.ln() / self.options.tolerance.ln();
            progress.report(done.clamp(0.0, 1.0))?;
            if size <= self.options.tolerance {
                // What was updated may have drifted from what it stands for.
                residual.copy_from_slice(rhs);
                self.matrix.transpose_product_into(&x, &mut product);
                add(-1.0, &product, &mut residual);
                size = if target > 0.0 { dot(&residual, &residual).sqrt() / target } else { 0.0 };
                if size <= self.options.tolerance {
                    progress.report(1.0)?;
                    let report =
                        ConjugateGradientsReport { iterations: iteration, residual: size, shift };
                    return Ok((x, report));
                }
                direction = self.divided(&residual);
                square = dot(&residual, &direction);
            }
            best = size.min(best);
            self.matrix.transpose_product_into(&direction, &mut product);
            let curvature = dot(&direction, &product);
            let convex = curvature > 0.0;
            if !convex {
                return Err(self.indefinite(&direction, curvature, iteration, best));
            }
            let step = square / curvature;
            add(step, &direction, &mut x);
            add(-step, &product, &mut residual);
            let divided = self.divided(&residual);
            let next = dot(&residual, &divided);
            let keep = next / square;
            square = next;
            parallel::map_chunks(&mut direction, BLOCK, |first, chunk| {
                for (p, z) in chunk.iter_mut().zip(&divided[first..]) {
                    *p = z + keep * *p;
                }
            });
            size = dot(&residual, &residual).sqrt() / target;
        }
        Err(Error::NotConverged { iterations: self.options.iterations, residual: best })
    }

    /// The error for pᵀA p ≤ 0.
    fn indefinite(
        &self,
        direction: &[f64],
        curvature: f64,
        iterations: usize,
        residual: f64,
    ) -> Error {
        let length = dot(direction, direction);
        let rounding = 8.0 * f64::EPSILON * self.matrix.row_norm() * length;
        if curvature.is_nan() || curvature >= -rounding {
            // Null within rounding: the right-hand side has a part that no x yields.
            return Error::NotConverged { iterations, residual };
        }
        let largest = direction.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let row = direction.iter().position(|x| x.abs() == largest).unwrap_or(0);
        let pivot = curvature / length;
        Error::NotPositiveDefinite { row, pivot, diagonal: self.matrix.get(row, row) }
    }

    /// P⁻¹ r.
    fn divided(&self, residual: &[f64]) -> Vec<f64> {
        let mut divided = residual.to_vec();
        match &self.divisor {
            Divisor::Diagonal(diagonal) => {
                divided.iter_mut().zip(diagonal).for_each(|(z, d)| *z /= d);
            }
            Divisor::Factor(factor) => factor.substitute(&mut divided),
        }
        divided
    }
}

/// y ← y + factor · x.
fn add(factor: f64, x: &[f64], y: &mut [f64]) {
    parallel::map_chunks(y, BLOCK, |first, chunk| {
        for (y, x) in chunk.iter_mut().zip(&x[first..]) {
            *y += factor * x;
        }
    });
}

/// xᵀ y, in blocks that do not depend on the number of threads.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    parallel::sum(x.len(), |range| x[range.clone()].iter().zip(&y[range]).map(|(x, y)| x * y).sum())
}
