//! Forward and backward substitution with the blocks of the factor, and the check of what they give.

use std::ops::Range;

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
    ///
    /// Subtrees know nothing of each other, so those that [`Supernodes::pieces`] lists are shared among threads;
    /// the blocks above them follow one by one.
    ///
    /// [`Supernodes::pieces`]: super::supernodes::Supernodes::pieces
    fn substitute_permuted<const K: usize>(&self, x: &mut [[f64; K]]) {
        let tree = self.symbolic.supernodes();
        let mut pieces = self.pieces(x);
        parallel::map_chunks(&mut pieces, 1, |_, pieces| {
            self.forward(&mut pieces[0]);
        });
        let sums: Vec<_> = pieces.into_iter().map(|piece| piece.at_beyond).collect();
        for (blocks, sums) in tree.pieces().iter().zip(sums) {
            for (&i, sum) in self.rows_beyond(blocks).iter().zip(sums) {
                (0..K).for_each(|k| x[i as usize][k] += sum[k]);
            }
        }
        for blocks in tree.above_pieces() {
            self.forward(&mut Piece::of_all(blocks, x));
        }
        for blocks in tree.above_pieces().iter().rev() {
            self.backward(&mut Piece::of_all(blocks, x));
        }
        let known: Vec<Vec<[f64; K]>> = tree
            .pieces()
            .iter()
            .map(|blocks| self.rows_beyond(blocks).iter().map(|&i| x[i as usize]).collect())
            .collect();
        let mut pieces = self.pieces(x);
        for (piece, known) in pieces.iter_mut().zip(known) {
            piece.at_beyond = known;
        }
        parallel::map_chunks(&mut pieces, 1, |_, pieces| {
            self.backward(&mut pieces[0]);
        });
    }

    /// The subtrees that are gone through side by side.
    fn pieces<'a, const K: usize>(&'a self, x: &'a mut [[f64; K]]) -> Vec<Piece<'a, K>> {
        let blocks = self.symbolic.blocks();
        let (mut rest, mut done) = (x, 0);
        let piece = |range: &Range<usize>| {
            let first = blocks.supernode_begin()[range.start] as usize;
            let end = blocks.supernode_end()[range.end - 1] as usize;
            let (x, after) = std::mem::take(&mut rest)[first - done..].split_at_mut(end - first);
            (rest, done) = (after, end);
            let beyond = self.rows_beyond(range);
            let at_beyond = vec![[0.0; K]; beyond.len()];
            Piece { blocks: range.clone(), first, x, beyond, at_beyond }
        };
        self.symbolic.supernodes().pieces().iter().map(piece).collect()
    }

    /// The rows that a subtree has beyond its own, which are those of its root.
    fn rows_beyond(&self, blocks: &Range<usize>) -> &[u32] {
        self.symbolic.block_rows(blocks.end - 1)
    }

    /// L⁻¹ on the rows of a piece; what it adds to the rows beyond.
    fn forward<const K: usize>(&self, piece: &mut Piece<'_, K>) {
        let blocks = self.symbolic.blocks();
        let mut memory = vec![[0.0; K]; self.symbolic.tallest()];
        for block in piece.blocks.clone() {
            let (first, values) = self.block(block);
            let pattern = blocks.supernode(block).pattern();
            let below = &mut memory[..pattern.len()];
            let columns = blocks.supernode_end()[block] as usize - first;
            let rows = columns + pattern.len();
            below.fill([0.0; K]);
            let diagonal = &mut piece.x[first - piece.first..][..columns];
            for (j, column) in values.chunks_exact(rows).enumerate() {
                let root = column[j];
                diagonal[j].iter_mut().for_each(|x| *x /= root);
                let solved = diagonal[j];
                subtract(&mut diagonal[j + 1..], &column[j + 1..columns], solved);
                subtract(below, &column[columns..], solved);
            }
            piece.each_row(pattern, below, |at, below| {
                (0..K).for_each(|k| at[k] += below[k]);
            });
        }
    }

    /// L⁻ᵀ on the rows of a piece, given those beyond.
    fn backward<const K: usize>(&self, piece: &mut Piece<'_, K>) {
        let blocks = self.symbolic.blocks();
        let mut memory = vec![[0.0; K]; self.symbolic.tallest()];
        for block in piece.blocks.clone().rev() {
            let (first, values) = self.block(block);
            let pattern = blocks.supernode(block).pattern();
            let below = &mut memory[..pattern.len()];
            let columns = blocks.supernode_end()[block] as usize - first;
            let rows = columns + pattern.len();
            piece.each_row(pattern, below, |at, below| *below = *at);
            let diagonal = &mut piece.x[first - piece.first..][..columns];
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

/// Blocks that follow one another, and the rows that they have to do with.
struct Piece<'a, const K: usize> {
    blocks: Range<usize>,
    /// The first of their rows, and these.
    first: usize,
    x: &'a mut [[f64; K]],
    /// The rows beyond, ascending, and what is known of them or to be added to them.
    beyond: &'a [u32],
    at_beyond: Vec<[f64; K]>,
}

impl<'a, const K: usize> Piece<'a, K> {
    /// Blocks, with all rows.
    fn of_all(blocks: &Range<usize>, x: &'a mut [[f64; K]]) -> Self {
        Piece { blocks: blocks.clone(), first: 0, x, beyond: &[], at_beyond: Vec::new() }
    }

    /// Calls `f` on what stands at each of these rows, ascending, and on the value for it.
    fn each_row(
        &mut self,
        rows: &[u32],
        values: &mut [[f64; K]],
        f: impl Fn(&mut [f64; K], &mut [f64; K]),
    ) {
        let end = self.first + self.x.len();
        let inside = rows.partition_point(|&row| (row as usize) < end);
        let (inside_values, beyond_values) = values.split_at_mut(inside);
        for (&row, value) in rows[..inside].iter().zip(inside_values) {
            f(&mut self.x[row as usize - self.first], value);
        }
        let Some(&first) = rows.get(inside) else { return };
        let mut at = self.beyond.partition_point(|&row| row < first);
        for (&row, value) in rows[inside..].iter().zip(beyond_values) {
            while self.beyond[at] < row {
                at += 1;
            }
            f(&mut self.at_beyond[at], value);
        }
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
