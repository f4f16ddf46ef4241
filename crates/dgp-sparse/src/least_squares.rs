//! Linear least squares: more equations than unknowns.
//!
//! ```text
//! minimize ‖A x − b‖      Normal equations: AᵀA x = Aᵀ b.      QR: A Q = (R; 0) by reflections, R x = …
//! ```
//!
//! Normal equations are fast, and exact enough where columns are far from dependent; one step of
//! refinement repairs most of what forming AᵀA loses. QR works on A itself and so with the root of the
//! condition number.
//!
//! - Input: a matrix with at least as many rows as columns.
//! - Cost: that of a Cholesky factorization of AᵀA; QR takes several times as long.
//! - Guarantees: the gradient ‖Aᵀ(b − A x)‖ is checked; columns that depend on others are an error that
//!   names one.
//! - Reference: Björck, "Numerical Methods for Least Squares Problems", 1996; Davis, "Algorithm 915,
//!   SuiteSparseQR: multifrontal multithreaded rank-revealing sparse QR factorization", 2011.
//! - Departs from it: QR with Householder reflections of faer, without rank revealing.

use faer::{
    Conj, MatMut, Par, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::qr::no_pivoting::factor::QrParams,
    prelude::default,
    sparse::{
        SparseColMatRef, SymbolicSparseColMatRef,
        linalg::qr::{QrSymbolicParams, factorize_symbolic_qr},
    },
};

use crate::{
    Cholesky, CholeskyOptions, Error, MAX_ENTRIES, Progress, SparseMatrix,
    lu::{arbitrary, largest},
};

/// The gradient relative to ‖A‖ (‖A‖ ‖x‖ + ‖b‖) above which a solution is refused.
const REFUSE: f64 = 1e-9;

/// ‖A‖ ‖x‖ / ‖A x‖ above which rounding decides what x is.
const DEPENDENT: f64 = 1e13;

/// How [`least_squares`] computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LeastSquaresMethod {
    /// Cholesky factorization of AᵀA, and one step of refinement. For columns that are far from
    /// dependent: the condition number is squared.
    NormalEquations,
    /// QR factorization of A.
    #[default]
    Qr,
}

/// What [`least_squares`] found.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct LeastSquares {
    /// The minimum for each right-hand side, one after the other.
    pub solution: Vec<f64>,
    /// ‖A x − b‖ for each.
    pub residuals: Vec<f64>,
    /// The largest entry of Aᵀ(b − A x), relative to ‖A‖ (‖A‖ ‖x‖ + ‖b‖) in the maximum norm, for each:
    /// 0 at the minimum, but for rounding.
    pub gradients: Vec<f64>,
}

/// The x for which ‖A x − b‖ is least, where the columns b stand one after the other in `rhs`.
///
/// ```
/// use dgp_sparse::{LeastSquaresMethod, Progress, SparseMatrix, least_squares};
///
/// // The line through (0, 0), (1, 1), (2, 1): 1/6 + x/2.
/// let triplets =
///     [(0, 0, 1.0), (1, 0, 1.0), (2, 0, 1.0), (1, 1, 1.0), (2, 1, 2.0)];
/// let matrix = SparseMatrix::from_triplets(3, 2, &triplets)?;
/// let rhs = [0.0, 1.0, 1.0];
/// let line = least_squares(&matrix, &rhs, LeastSquaresMethod::Qr, Progress::NONE)?.solution;
/// assert!((line[0] - 1.0 / 6.0).abs() < 1e-15 && (line[1] - 0.5).abs() < 1e-15);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
pub fn least_squares(
    matrix: &SparseMatrix,
    rhs: &[f64],
    method: LeastSquaresMethod,
    progress: Progress<'_>,
) -> Result<LeastSquares, Error> {
    progress.report(0.0)?;
    let (m, n) = (matrix.rows(), matrix.columns());
    let count = rhs.len().checked_div(m).unwrap_or(0);
    Error::check_length("the right-hand side", rhs.len(), count * m)?;
    matrix.check_finite()?;
    Error::check_finite("the right-hand side", rhs)?;
    if m < n {
        return Err(Error::Underdetermined { rows: m, columns: n });
    }
    let empty = |j: &usize| matrix.column(*j).1.iter().all(|&value| value == 0.0);
    if let Some(column) = (0..n).find(empty) {
        return Err(Error::DependentColumn { column, columns: 1 });
    }
    let solution = match method {
        _ if n == 0 => Vec::new(),
        LeastSquaresMethod::NormalEquations => normal_equations(matrix, rhs, progress)?,
        LeastSquaresMethod::Qr => orthogonal(matrix, rhs, progress)?,
    };
    progress.report(0.95)?;
    let report = checked(matrix, rhs, solution, count)?;
    progress.report(1.0)?;
    Ok(report)
}

/// By AᵀA.
fn normal_equations(
    matrix: &SparseMatrix,
    rhs: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<f64>, Error> {
    let (m, n) = (matrix.rows(), matrix.columns());
    let gram = matrix.gram(&vec![1.0; m])?;
    let options = CholeskyOptions::default();
    let cholesky =
        Cholesky::new(&gram, &options, progress.part(0.0, 0.8)).map_err(|error| match error {
            // AᵀA is semidefinite, so that rounding is what makes a pivot negative.
            Error::NotPositiveDefinite { row, .. } => {
                Error::DependentColumn { column: row, columns: n }
            }
            Error::Singular { row, size, .. } | Error::ConstantNullSpace { row, size } => {
                Error::DependentColumn { column: row, columns: size }
            }
            error => error,
        })?;
    let mut x = matrix.transpose_product_many(rhs);
    cholesky.substitute(&mut x)?;
    // One step with the residual of the equations themselves, not of those with AᵀA.
    let product = matrix.product_many(&x);
    let residual: Vec<f64> = rhs.iter().zip(product).map(|(b, ax)| b - ax).collect();
    let mut correction = matrix.transpose_product_many(&residual);
    cholesky.substitute(&mut correction)?;
    x.iter_mut().zip(correction).for_each(|(x, dx)| *x += dx);
    Ok(x)
}

/// By QR of A.
fn orthogonal(
    matrix: &SparseMatrix,
    rhs: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<f64>, Error> {
    let too_large =
        |count| Error::TooLarge { kind: "entries of the factor", count, limit: MAX_ENTRIES };
    let (m, n) = (matrix.rows(), matrix.columns());
    let pattern = SymbolicSparseColMatRef::new_unsorted_checked(
        m,
        n,
        matrix.starts(),
        None,
        matrix.indices(),
    );
    let symbolic = factorize_symbolic_qr(pattern, QrSymbolicParams::default())
        .map_err(|_| too_large(matrix.entries()))?;
    progress.report(0.3)?;
    let mut indices = vec![0_u32; symbolic.len_idx()];
    let mut values = vec![0.0; symbolic.len_val()];
    let params: Spec<QrParams, f64> = default();
    let size = symbolic.factorize_numeric_qr_scratch::<f64>(Par::Seq, params);
    let mut memory = MemBuffer::new(size);
    let factors = symbolic.factorize_numeric_qr(
        &mut indices,
        &mut values,
        SparseColMatRef::new(pattern, matrix.values()),
        Par::Seq,
        MemStack::new(&mut memory),
        params,
    );
    progress.report(0.8)?;
    // One column more: a vector whose image is known, to see whether the columns are dependent.
    let mut columns = rhs.to_vec();
    columns.extend((0..m).map(arbitrary));
    let size = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
    let mut memory = MemBuffer::new(size);
    let mut solution = Vec::with_capacity(columns.len() / m * n);
    for column in columns.chunks_exact_mut(m) {
        let x = MatMut::from_column_major_slice_mut(column, m, 1);
        factors.solve_in_place_with_conj(Conj::No, x, Par::Seq, MemStack::new(&mut memory));
        solution.extend_from_slice(&column[..n]);
    }
    let probe = solution.split_off(solution.len() - n);
    let independent = matrix.row_norm() * largest(&probe) <= DEPENDENT;
    if !independent {
        return Err(dependent_column(matrix, &probe));
    }
    Ok(solution)
}

/// The error for dependent columns, where `probe` is a solution that has grown beyond measure.
fn dependent_column(matrix: &SparseMatrix, probe: &[f64]) -> Error {
    if largest(probe).is_finite() {
        return with_largest_part(probe);
    }
    // Beside it, AᵀA + ε‖A‖² has a factor, and inverse iteration finds the combination that vanishes.
    vanishing(matrix).map_or_else(|error| error, |x| with_largest_part(&x))
}

/// Names the column with the largest part in a combination that vanishes.
fn with_largest_part(combination: &[f64]) -> Error {
    let size = largest(combination);
    let column = combination.iter().position(|x| x.abs() >= (1.0 - 1e-6) * size).unwrap_or(0);
    let columns = combination.iter().filter(|x| x.abs() >= 1e-6 * size).count();
    Error::DependentColumn { column, columns }
}

/// A combination of columns that nearly vanishes.
fn vanishing(matrix: &SparseMatrix) -> Result<Vec<f64>, Error> {
    let gram = matrix.gram(&vec![1.0; matrix.rows()])?;
    let shift = vec![1e-9 * gram.row_norm(); gram.rows()];
    let options = CholeskyOptions::default();
    let cholesky = Cholesky::new(&gram.plus_diagonal(&shift)?, &options, Progress::NONE)?;
    let mut x: Vec<f64> = (0..gram.rows()).map(arbitrary).collect();
    for _ in 0..3 {
        cholesky.substitute(&mut x)?;
        let size = largest(&x);
        for x in &mut x {
            *x /= size;
        }
    }
    Ok(x)
}

/// The solution with its residuals, if its gradient vanishes.
fn checked(
    matrix: &SparseMatrix,
    rhs: &[f64],
    solution: Vec<f64>,
    count: usize,
) -> Result<LeastSquares, Error> {
    let (m, n) = (matrix.rows(), matrix.columns());
    let norm = matrix.row_norm().max(matrix.transpose().row_norm());
    let (mut residuals, mut gradients) = (Vec::new(), Vec::new());
    for k in 0..count {
        let (x, b) = (&solution[k * n..(k + 1) * n], &rhs[k * m..(k + 1) * m]);
        let mut residual = b.to_vec();
        matrix.add_product(-1.0, x, &mut residual);
        let gradient = largest(&matrix.transpose_product(&residual));
        let size = norm * (norm * largest(x) + largest(b));
        let gradient = if size == 0.0 { 0.0 } else { gradient / size };
        let least = gradient <= REFUSE;
        if !least {
            return Err(Error::Inaccurate { residual: gradient });
        }
        residuals.push(residual.iter().map(|r| r * r).sum::<f64>().sqrt());
        gradients.push(gradient);
    }
    Ok(LeastSquares { solution, residuals, gradients })
}
