//! Forward and backward substitution with the blocks of the factor, and the check of what they give.

use super::Cholesky;
use crate::{Error, parallel};

/// Right-hand sides that are solved side by side: each entry of the factor is read once for all of
/// them, and eight doubles are what fits in the registers of a core.
const WIDTH: usize = 8;

/// The residual above which a solution is refined: a few hundred roundings.
const REFINE: f64 = 1e-13;

/// The residual above which a solution is refused. Rounding leaves 10⁻¹⁶ to 10⁻¹⁴.
const REFUSE: f64 = 1e-9;

impl Cholesky {
    /// x with A x = `rhs`.
    ///
    /// The residual is checked, and the solution refined where that helps; an error if it remains
    /// above 10⁻⁹ of ‖A‖ ‖x‖ + ‖b‖.
    pub fn solve(&self, rhs: &[f64]) -> Result<Vec<f64>, Error> {
        Error::check_length("the right-hand side", rhs.len(), self.rows())?;
        self.solve_many(rhs)
    }

    /// X with A X = B, where the columns of B stand one after the other in `rhs`, and those of X
    /// likewise. Up to eight columns are solved in hardly more time than two.
    pub fn solve_many(&self, rhs: &[f64]) -> Result<Vec<f64>, Error> {
        let mut x = rhs.to_vec();
        self.solve_in_place(&mut x)?;
        Ok(x)
    }

    /// Replaces the columns of `x`, right-hand sides one after the other, by the solutions.
    ///
    /// After an error `x` is in an unspecified state.
    pub fn solve_in_place(&self, x: &mut [f64]) -> Result<(), Error> {
        self.each_group(x, |cholesky, group, columns| {
            Error::check_finite("the right-hand side", group)?;
            match columns {
                1 => cholesky.solve_checked::<1>(group),
                2 => cholesky.solve_checked::<2>(group),
                3 => cholesky.solve_checked::<3>(group),
                4 => cholesky.solve_checked::<4>(group),
                _ => cholesky.solve_checked::<WIDTH>(group),
            }
        })
    }

    /// Replaces the columns of `x` by the solutions, without looking at the result: for iterations
    /// that check theirs.
    pub fn substitute(&self, x: &mut [f64]) -> Result<(), Error> {
        self.each_group(x, |cholesky, group, columns| {
            match columns {
                1 => cholesky.substitute_group::<1>(group),
                2 => cholesky.substitute_group::<2>(group),
                3 => cholesky.substitute_group::<3>(group),
                4 => cholesky.substitute_group::<4>(group),
                _ => cholesky.substitute_group::<WIDTH>(group),
            }
            Ok(())
        })
    }

    /// Calls `f` on groups of up to [`WIDTH`] columns, in parallel.
    fn each_group(
        &self,
        x: &mut [f64],
        f: impl Fn(&Cholesky, &mut [f64], usize) -> Result<(), Error> + Sync + Send,
    ) -> Result<(), Error> {
        let n = self.rows();
        let columns = x.len().checked_div(n).unwrap_or(0);
        Error::check_length("the right-hand side", x.len(), columns * n)?;
        let results = parallel::map_chunks(x, n * WIDTH, |_, group| {
            let columns = group.len() / n;
            f(self, group, columns)
        });
        results.into_iter().collect()
    }

    fn substitute_group<const K: usize>(&self, columns: &mut [f64]) {
        let mut x = self.gather::<K>(columns, 1.0 / self.scale);
        self.substitute_permuted(&mut x);
        self.scatter(&x, columns);
    }

    fn solve_checked<const K: usize>(&self, columns: &mut [f64]) -> Result<(), Error> {
        let rhs = self.gather::<K>(columns, 1.0 / self.scale);
        let mut x = rhs.clone();
        self.substitute_permuted(&mut x);
        let (mut residual, mut error) = self.residual(&x, &rhs);
        // Iterative refinement.
        if exceeds(error, REFINE) {
            self.substitute_permuted(&mut residual);
            let mut refined = x.clone();
            for (x, correction) in refined.iter_mut().zip(&residual) {
                (0..K).for_each(|k| x[k] += correction[k]);
            }
            let (_, after) = self.residual(&refined, &rhs);
            if after < error {
                (x, error) = (refined, after);
            }
        }
        if exceeds(error, REFUSE) {
            return Err(Error::Inaccurate { residual: error });
        }
        self.scatter(&x, columns);
        Ok(())
    }

    /// Row by row in the order of elimination what stands column by column. Missing columns are zero.
    fn gather<const K: usize>(&self, columns: &[f64], factor: f64) -> Vec<[f64; K]> {
        let n = self.rows();
        let mut x = vec![[0.0; K]; n];
        for (k, column) in columns.chunks_exact(n).enumerate() {
            for (x, &row) in x.iter_mut().zip(self.symbolic.order()) {
                x[k] = column[row as usize] * factor;
            }
        }
        x
    }

    /// The reverse of [`gather`](Self::gather).
    fn scatter<const K: usize>(&self, x: &[[f64; K]], columns: &mut [f64]) {
        for (k, column) in columns.chunks_exact_mut(self.rows()).enumerate() {
            for (x, &row) in x.iter().zip(self.symbolic.order()) {
                column[row as usize] = x[k];
            }
        }
    }

    /// b − A x, and its size relative to ‖A‖ ‖x‖ + ‖b‖ for the worst of the columns.
    fn residual<const K: usize>(&self, x: &[[f64; K]], rhs: &[[f64; K]]) -> (Vec<[f64; K]>, f64) {
        let (starts, rows) = self.symbolic.lower_pattern();
        let mut residual = rhs.to_vec();
        for j in 0..x.len() {
            let range = starts[j] as usize + 1..starts[j + 1] as usize;
            let diagonal = self.lower[range.start - 1];
            let of_column = x[j];
            let mut sum: [f64; K] = std::array::from_fn(|k| diagonal * of_column[k]);
            for (&i, &value) in rows[range.clone()].iter().zip(&self.lower[range]) {
                let (other, target) = (x[i as usize], &mut residual[i as usize]);
                for k in 0..K {
                    sum[k] += value * other[k];
                    target[k] -= value * of_column[k];
                }
            }
            (0..K).for_each(|k| residual[j][k] -= sum[k]);
        }
        let largest = |of: &[[f64; K]], k: usize| {
            // Not max(), which would drop NaN.
            of.iter().map(|x| x[k].abs()).fold(0.0, |a: f64, b| if b <= a { a } else { b })
        };
        let error = (0..K).fold(0.0, |worst: f64, k| {
            let size = self.norm * largest(x, k) + largest(rhs, k);
            let error = largest(&residual, k) / size;
            if size == 0.0 || error <= worst { worst } else { error }
        });
        (residual, error)
    }

    /// L⁻ᵀ L⁻¹ on rows in the order of elimination.
    fn substitute_permuted<const K: usize>(&self, x: &mut [[f64; K]]) {
        let blocks = self.symbolic.blocks();
        let mut below = vec![[0.0; K]; self.symbolic.tallest()];
        for block in 0..blocks.n_supernodes() {
            let (first, values) = self.block(block);
            let pattern = blocks.supernode(block).pattern();
            let below = &mut below[..pattern.len()];
            let columns = blocks.supernode_end()[block] as usize - first;
            let rows = columns + pattern.len();
            below.fill([0.0; K]);
            let diagonal = &mut x[first..first + columns];
            for (j, column) in values.chunks_exact(rows).enumerate() {
                let root = column[j];
                diagonal[j].iter_mut().for_each(|x| *x /= root);
                let solved = diagonal[j];
                subtract(&mut diagonal[j + 1..], &column[j + 1..columns], solved);
                subtract(below, &column[columns..], solved);
            }
            for (&i, below) in pattern.iter().zip(&*below) {
                (0..K).for_each(|k| x[i as usize][k] += below[k]);
            }
        }
        for block in (0..blocks.n_supernodes()).rev() {
            let (first, values) = self.block(block);
            let pattern = blocks.supernode(block).pattern();
            let below = &mut below[..pattern.len()];
            let columns = blocks.supernode_end()[block] as usize - first;
            let rows = columns + pattern.len();
            for (&i, below) in pattern.iter().zip(&mut *below) {
                *below = x[i as usize];
            }
            let diagonal = &mut x[first..first + columns];
            for (j, column) in values.chunks_exact(rows).enumerate().rev() {
                let inside = dot(&diagonal[j + 1..], &column[j + 1..columns]);
                let outside = dot(below, &column[columns..]);
                let root = column[j];
                for k in 0..K {
                    diagonal[j][k] = (diagonal[j][k] - (inside[k] + outside[k])) / root;
                }
            }
        }
    }

    /// First row and values of a block.
    fn block(&self, block: usize) -> (usize, &[f64]) {
        let blocks = self.symbolic.blocks();
        let values = blocks.col_ptr_for_val();
        let values = &self.factor[values[block] as usize..values[block + 1] as usize];
        (blocks.supernode_begin()[block] as usize, values)
    }
}

/// Whether `error` is larger than `limit` or not a number.
fn exceeds(error: f64, limit: f64) -> bool {
    error.is_nan() || error > limit
}

/// x ← x − column · factor.
fn subtract<const K: usize>(x: &mut [[f64; K]], column: &[f64], factor: [f64; K]) {
    for (x, &value) in x.iter_mut().zip(column) {
        for k in 0..K {
            x[k] -= value * factor[k];
        }
    }
}

/// Σ x · column, in four interleaved sums, since a single one waits for each addition.
fn dot<const K: usize>(x: &[[f64; K]], column: &[f64]) -> [f64; K] {
    let mut sums = [[0.0; K]; 4];
    let (x_parts, x_rest) = x.as_chunks::<4>();
    let (column_parts, column_rest) = column.as_chunks::<4>();
    for (x, values) in x_parts.iter().zip(column_parts) {
        for lane in 0..4 {
            for k in 0..K {
                sums[lane][k] += values[lane] * x[lane][k];
            }
        }
    }
    for (x, value) in x_rest.iter().zip(column_rest) {
        for k in 0..K {
            sums[0][k] += value * x[k];
        }
    }
    std::array::from_fn(|k| (sums[0][k] + sums[1][k]) + (sums[2][k] + sums[3][k]))
}
