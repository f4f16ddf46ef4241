//! Incomplete Cholesky factorization without fill.
//!
//! ```text
//! A + α diag(A) ≈ L D Lᵀ,   L unit lower triangular with entries only where A has some
//! ```
//!
//! D keeps roots out, so that scaling A by 2ᵏ scales D exactly. Where entries of A off the diagonal are
//! positive a pivot may become negative; then the diagonal is raised until none does.
//!
//! - Input: a symmetric matrix with a positive diagonal, both triangles stored.
//! - Cost: O(entries · entries per column) time; O(entries) memory.
//! - Reference: Meijerink and van der Vorst, "An iterative solution method for linear systems of which
//!   the coefficient matrix is a symmetric M-matrix", 1977; Manteuffel, "An incomplete factorization
//!   technique for positive definite linear systems", 1980.

use crate::SparseMatrix;

/// The first α to try after 0. Each is twice the one before.
const FIRST_SHIFT: f64 = 1.0 / 1024.0;

/// The part of a diagonal entry that must remain as pivot: less would make the factor worse than none.
const LEAST_PIVOT: f64 = 1e-3;

/// L, and D on its diagonal.
#[derive(Clone, Debug)]
pub(super) struct IncompleteCholesky {
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// D, then L below it, for each column.
    values: Vec<f64>,
    shift: f64,
}

impl IncompleteCholesky {
    /// Factors `matrix`, whose diagonal is positive.
    pub(super) fn new(matrix: &SparseMatrix, diagonal: &[f64]) -> IncompleteCholesky {
        let n = matrix.rows();
        let (mut starts, mut rows, mut lower) = (vec![0_u32], Vec::new(), Vec::new());
        for j in 0..n {
            let (of_column, values) = matrix.column(j);
            let first = of_column.partition_point(|&i| (i as usize) < j);
            rows.extend_from_slice(&of_column[first..]);
            lower.extend_from_slice(&values[first..]);
            starts.push(rows.len() as u32);
        }
        let mut factor = IncompleteCholesky { starts, rows, values: Vec::new(), shift: 0.0 };
        loop {
            factor.values.clone_from(&lower);
            for (j, &value) in diagonal.iter().enumerate() {
                factor.values[factor.starts[j] as usize] = value * (1.0 + factor.shift);
            }
            // With a diagonal that outweighs each row no pivot fails, so that this comes to an end.
            if factor.factor(diagonal) {
                return factor;
            }
            factor.shift = if factor.shift == 0.0 { FIRST_SHIFT } else { 2.0 * factor.shift };
        }
    }

    /// By how much of itself the diagonal was raised.
    pub(super) fn shift(&self) -> f64 {
        self.shift
    }

    /// Whether all pivots are positive.
    fn factor(&mut self, diagonal: &[f64]) -> bool {
        for (k, &original) in diagonal.iter().enumerate() {
            let (start, end) = (self.starts[k] as usize, self.starts[k + 1] as usize);
            let pivot = self.values[start];
            let remains = pivot > LEAST_PIVOT * original;
            if !remains {
                return false;
            }
            // Of the columns named by this one, what it shares with them.
            for p in start + 1..end {
                let factor = self.values[p] / pivot;
                let column = self.rows[p] as usize;
                let mut target = self.starts[column] as usize;
                let stop = self.starts[column + 1] as usize;
                for q in p..end {
                    let row = self.rows[q];
                    while target < stop && self.rows[target] < row {
                        target += 1;
                    }
                    if target < stop && self.rows[target] == row {
                        self.values[target] -= factor * self.values[q];
                    }
                }
            }
            self.values[start + 1..end].iter_mut().for_each(|value| *value /= pivot);
        }
        true
    }

    /// x ← (L D Lᵀ)⁻¹ x.
    pub(super) fn substitute(&self, x: &mut [f64]) {
        for j in 0..x.len() {
            let (start, end) = (self.starts[j] as usize, self.starts[j + 1] as usize);
            let solved = x[j];
            for (&i, value) in self.rows[start + 1..end].iter().zip(&self.values[start + 1..end]) {
                x[i as usize] -= value * solved;
            }
        }
        for j in (0..x.len()).rev() {
            let (start, end) = (self.starts[j] as usize, self.starts[j + 1] as usize);
            let mut sum = x[j] / self.values[start];
            for (&i, value) in self.rows[start + 1..end].iter().zip(&self.values[start + 1..end]) {
                sum -= value * x[i as usize];
            }
            x[j] = sum;
        }
    }
}
