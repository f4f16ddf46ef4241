//! Why a matrix has no Cholesky factor: which row, and what is wrong with it.

use super::{Cholesky, SymbolicCholesky};
use crate::{Error, SparseMatrix};

impl SymbolicCholesky {
    /// The place of the first pivot that is not positive beyond rounding, if there is one.
    ///
    /// `failed` is the place where the factorization stopped. A pivot is the diagonal entry less the
    /// squares of the entries before it; what remains of it after cancellation is [noise](Self::noise).
    pub(super) fn worst_pivot(
        &self,
        lower: &[f64],
        factor: &[f64],
        failed: Option<usize>,
    ) -> Option<usize> {
        if failed.is_some() {
            return failed;
        }
        let noise = self.noise();
        (0..self.blocks().n_supernodes()).find_map(|block| {
            let (first, columns, rows, values) = self.block(factor, block);
            (0..columns).find_map(|j| {
                let pivot = values[j * (rows + 1)].powi(2);
                let diagonal = lower[self.lower_pattern().0[first + j] as usize];
                (pivot.is_nan() || pivot <= noise * diagonal).then_some(first + j)
            })
        })
    }

    /// The part of a diagonal entry that rounding may leave where nothing should remain: the errors of
    /// all operations that lead to the last pivot, added up as if they were random.
    fn noise(&self) -> f64 {
        4.0 * f64::EPSILON * self.operations().sqrt()
    }

    /// First column, number of columns, number of rows (those of the diagonal counted) and values of
    /// a block.
    pub(super) fn block<'a>(
        &self,
        factor: &'a [f64],
        block: usize,
    ) -> (usize, usize, usize, &'a [f64]) {
        let blocks = self.blocks();
        let first = blocks.supernode_begin()[block] as usize;
        let columns = blocks.supernode_end()[block] as usize - first;
        let rows = columns + blocks.supernode(block).pattern().len();
        let values = blocks.col_ptr_for_val();
        (first, columns, rows, &factor[values[block] as usize..values[block + 1] as usize])
    }
}

impl Cholesky {
    /// The error for a pivot at `place` that is not positive.
    pub(super) fn diagnosis(&self, matrix: &SparseMatrix, place: usize) -> Error {
        let symbolic = &*self.symbolic;
        let row = symbolic.order()[place] as usize;
        let diagonal = matrix.get(row, row);
        let ends = symbolic.blocks().supernode_end();
        let block = ends.partition_point(|&end| end as usize <= place);
        let (first, _, rows, values) = symbolic.block(&self.factor, block);
        let entry = values[(place - first) * (rows + 1)];
        // A pivot that was accepted has been replaced by its root.
        let pivot = self.scale * if entry > 0.0 { entry * entry } else { entry };
        let noise = symbolic.noise();
        if pivot.abs() > noise * diagonal.abs() || diagonal < 0.0 {
            return Error::NotPositiveDefinite { row, pivot, diagonal };
        }
        let component = component(matrix, row, &mut vec![false; matrix.rows()]);
        let size = component.len();
        if sums_to_zero(matrix, &component) {
            let row = component.iter().min().map_or(row, |&row| row as usize);
            return Error::ConstantNullSpace { row, size };
        }
        Error::Singular { row, size, pivot, diagonal }
    }
}

/// The rows connected to `row` by entries that are not zero, `row` first. They are marked as reached.
pub(crate) fn component(matrix: &SparseMatrix, row: usize, reached: &mut [bool]) -> Vec<u32> {
    reached[row] = true;
    let mut component = vec![row as u32];
    let mut next = 0;
    while next < component.len() {
        let (rows, values) = matrix.column(component[next] as usize);
        for (&i, &value) in rows.iter().zip(values) {
            if value != 0.0 && !std::mem::replace(&mut reached[i as usize], true) {
                component.push(i);
            }
        }
        next += 1;
    }
    component
}

/// Whether each of these columns sums to zero within rounding.
pub(crate) fn sums_to_zero(matrix: &SparseMatrix, columns: &[u32]) -> bool {
    columns.iter().all(|&j| {
        let (_, values) = matrix.column(j as usize);
        let size: f64 = values.iter().map(|value| value.abs()).sum();
        let rounding = 4.0 * f64::EPSILON * (values.len() + 1) as f64;
        values.iter().sum::<f64>().abs() <= rounding * size
    })
}
