//! Equations that hold exactly.
//!
//! ```text
//! minimize  ½ xᵀ A x − bᵀ x   where C x = d       (A  Cᵀ) (x)   (b)
//!                                                 (C  0 ) (λ) = (d)
//! ```
//!
//! A is factored alone; the equations lead to a small dense system for λ (the Schur complement). Where
//! constants on a component are in the null space of A, one of its diagonal entries is raised to make
//! it definite, and one more equation of the small system takes that back: A need only be definite where
//! C x = 0.
//!
//! - Input: a symmetric positive semidefinite A whose null space is that of constants on components;
//!   a few equations, sparse or dense, such as a mean that is zero.
//! - Cost: a factorization of A, a solve and m operations per unknown for each of m equations, and m³.
//! - Reference: Benzi, Golub and Liesen, "Numerical solution of saddle point problems", 2005, section 5.

use crate::{Cholesky, CholeskyOptions, Error, Progress, SparseMatrix};

/// A system with exact equations, factored for any right-hand sides.
///
/// ```
/// use dgp_sparse::{CholeskyOptions, EqualitySystem, Progress, SparseMatrix};
///
/// // A Laplacian has no unique solution; the one with sum zero is unique.
/// let laplacian = SparseMatrix::from_edges(3, &[(0, 1, 1.0), (1, 2, 1.0)])?;
/// let sum = SparseMatrix::from_triplets(1, 3, &[(0, 0, 1.0), (0, 1, 1.0), (0, 2, 1.0)])?;
/// let options = CholeskyOptions::default();
/// let system = EqualitySystem::new(&laplacian, &sum, &options, Progress::NONE)?;
/// let (x, _) = system.solve(&[-1.0, 0.0, 1.0], &[0.0])?;
/// assert!((x[0] + 1.0).abs() < 1e-14 && x[1].abs() < 1e-14 && (x[2] - 1.0).abs() < 1e-14);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct EqualitySystem {
    cholesky: Cholesky,
    constraints: SparseMatrix,
    /// Rows whose diagonal entry was raised.
    raised: Vec<u32>,
    /// A⁻¹ Bᵀ, column by column, where B is C with a row for each raised entry.
    inverse_rows: Vec<f64>,
    schur: Dense,
}

impl EqualitySystem {
    /// Factors `matrix` with the equations `constraints` · x = targets, one in each row.
    pub fn new(
        matrix: &SparseMatrix,
        constraints: &SparseMatrix,
        options: &CholeskyOptions,
        progress: Progress<'_>,
    ) -> Result<EqualitySystem, Error> {
        Error::check_length("the constraints (columns)", constraints.columns(), matrix.rows())?;
        constraints.check_finite()?;
        matrix.check_symmetric()?;
        matrix.check_finite()?;
        let n = matrix.rows();
        let components = super::constant_components(matrix);
        let raised: Vec<u32> = components.iter().map(|component| component[0]).collect();
        let mut raise = vec![0.0; n];
        for &row in &raised {
            let diagonal = matrix.get(row as usize, row as usize);
            raise[row as usize] = if diagonal > 0.0 { diagonal } else { 1.0 };
        }
        let definite = matrix.plus_diagonal(&raise)?;
        let cholesky = Cholesky::new(&definite, options, progress.part(0.0, 0.8))?;
        // B, and A⁻¹ Bᵀ.
        let count = constraints.rows() + raised.len();
        let mut rows = vec![0.0; n * count];
        for (i, j, value) in constraints.triplets() {
            rows[i * n + j] = value;
        }
        for (k, &row) in raised.iter().enumerate() {
            rows[(constraints.rows() + k) * n + row as usize] = 1.0;
        }
        let mut inverse_rows = rows.clone();
        cholesky.solve_in_place(&mut inverse_rows)?;
        progress.report(0.9)?;
        let mut schur = vec![0.0; count * count];
        for (i, row) in rows.chunks_exact(n.max(1)).enumerate() {
            for (j, column) in inverse_rows.chunks_exact(n.max(1)).enumerate() {
                schur[i * count + j] = row.iter().zip(column).map(|(a, b)| a * b).sum();
            }
        }
        let sizes: Vec<f64> = (0..count).map(|i| schur[i * count + i].abs().sqrt()).collect();
        for (k, &row) in raised.iter().enumerate() {
            let place = constraints.rows() + k;
            schur[place * count + place] -= 1.0 / raise[row as usize];
        }
        let schur = Dense::new(schur, &sizes).map_err(|equation| {
            let Some(component) = equation.checked_sub(constraints.rows()) else {
                return Error::DependentConstraint { constraint: equation };
            };
            let component = &components[component];
            let row = component.iter().min().map_or(0, |&row| row as usize);
            Error::Unconstrained { row, size: component.len() }
        })?;
        progress.report(1.0)?;
        let constraints = constraints.clone();
        Ok(EqualitySystem { cholesky, constraints, raised, inverse_rows, schur })
    }

    /// The minimum with these targets, and the multiplier λ of each equation.
    pub fn solve(&self, rhs: &[f64], targets: &[f64]) -> Result<(Vec<f64>, Vec<f64>), Error> {
        Error::check_length("the targets", targets.len(), self.constraints.rows())?;
        Error::check_finite("the targets", targets)?;
        let mut x = self.cholesky.solve(rhs)?;
        let mut multipliers = self.constraints.product(&x);
        multipliers.iter_mut().zip(targets).for_each(|(value, target)| *value -= target);
        multipliers.extend(self.raised.iter().map(|&row| x[row as usize]));
        self.schur.solve(&mut multipliers);
        for (column, multiplier) in self.inverse_rows.chunks_exact(x.len().max(1)).zip(&multipliers)
        {
            x.iter_mut().zip(column).for_each(|(x, value)| *x -= multiplier * value);
        }
        // Rounding of the dense system shows where equations nearly depend on each other.
        let reached = self.constraints.product(&x);
        let largest = x.iter().map(|x| x.abs()).fold(0.0, f64::max);
        let size = self.constraints.row_norm() * largest;
        for (value, target) in reached.iter().zip(targets) {
            let residual = (value - target).abs() / (size + target.abs());
            if residual > 1e-9 {
                return Err(Error::Inaccurate { residual });
            }
        }
        multipliers.truncate(targets.len());
        Ok((x, multipliers))
    }
}

/// A small dense matrix, factored by elimination with pivots.
#[derive(Clone, Debug)]
struct Dense {
    n: usize,
    values: Vec<f64>,
    pivots: Vec<usize>,
}

impl Dense {
    /// Factors the symmetric matrix with these rows; the first that depends on those before it, if
    /// there is one.
    ///
    /// An entry is compared with the product of the `sizes` of its row and column.
    fn new(mut values: Vec<f64>, sizes: &[f64]) -> Result<Dense, usize> {
        let n = sizes.len();
        let mut row_of: Vec<usize> = (0..n).collect();
        let mut pivots = Vec::with_capacity(n);
        for k in 0..n {
            let weight = |i: usize| values[i * n + k].abs() / (sizes[row_of[i]] * sizes[k]);
            let pivot = (k..n).max_by(|&a, &b| weight(a).total_cmp(&weight(b))).unwrap_or(k);
            if weight(pivot).is_nan() || weight(pivot) <= 1e-13 * n as f64 {
                return Err(k);
            }
            row_of.swap(k, pivot);
            pivots.push(pivot);
            for j in 0..n {
                values.swap(k * n + j, pivot * n + j);
            }
            for i in k + 1..n {
                let factor = values[i * n + k] / values[k * n + k];
                values[i * n + k] = factor;
                for j in k + 1..n {
                    values[i * n + j] -= factor * values[k * n + j];
                }
            }
        }
        Ok(Dense { n, values, pivots })
    }

    fn solve(&self, x: &mut [f64]) {
        let n = self.n;
        for (k, &pivot) in self.pivots.iter().enumerate() {
            x.swap(k, pivot);
        }
        for i in 0..n {
            let row = &self.values[i * n..];
            x[i] -= (0..i).map(|j| row[j] * x[j]).sum::<f64>();
        }
        for i in (0..n).rev() {
            let row = &self.values[i * n..];
            x[i] = (x[i] - (i + 1..n).map(|j| row[j] * x[j]).sum::<f64>()) / row[i];
        }
    }
}
