//! Blocks so large that threads share one of them.
//!
//! ```text
//! for each few columns:  ⎛ L₁₁      ⎞   L₁₁ L₁₁ᵀ = A₁₁
//!                        ⎜ L₂₁  A₂₂ ⎟   L₂₁ = A₂₁ L₁₁⁻ᵀ      parts of rows side by side
//!                        ⎝ L₃₁  A₃₂ ⎠   A₂₂, A₃₂ −= L₂₁ L₂₁ᵀ, L₃₁ L₂₁ᵀ   parts of both
//! ```
//!
//! How a block is cut into parts depends on its size alone: same bits for any number of threads.

use faer::{
    Accum, MatMut, MatRef, Par,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt::factor::{LltError, LltRegularization, cholesky_in_place},
        matmul::{
            matmul,
            triangular::{self, BlockStructure},
        },
        triangular_solve::solve_lower_triangular_in_place,
    },
    prelude::{Reborrow, ReborrowMut, default},
};

use crate::parallel;

/// How many columns are eliminated at a time.
const COLUMNS: usize = 192;

/// Parts of no more rows and columns are not cut further.
const PART: usize = 384;

/// L₁₁ and L₂₁ from F₁₁ and F₂₁, one above the other in `panel`; the first column whose pivot is not
/// positive.
pub(super) fn eliminate(mut panel: MatMut<'_, f64>, memory: &mut MemBuffer) -> Result<(), usize> {
    let columns = panel.ncols();
    let mut begun = 0;
    while begun < columns {
        let width = COLUMNS.min(columns - begun);
        let rest = panel.rb_mut().get_mut(begun.., begun..);
        let (current, right) = rest.split_at_col_mut(width);
        let (mut square, mut below) = current.split_at_row_mut(width);
        let (regularization, stack) = (LltRegularization::default(), MemStack::new(memory));
        cholesky_in_place(square.rb_mut(), regularization, Par::Seq, stack, default())
            .map_err(|LltError::NonPositivePivot { index }| begun + index)?;
        divide(square.rb(), below.rb_mut());
        let (top, bottom) =
            right.split_at_row_mut(width).1.split_at_row_mut(columns - begun - width);
        let (beside, under) = below.rb().split_at_row(columns - begun - width);
        parallel::join(
            || subtract_square(top, beside, Accum::Add),
            || subtract_product(bottom, under, beside, Accum::Add),
        );
        begun += width;
    }
    Ok(())
}

/// X L⁻ᵀ in the place of X.
fn divide(l: MatRef<'_, f64>, x: MatMut<'_, f64>) {
    if x.nrows() <= PART {
        return solve_lower_triangular_in_place(l, x.transpose_mut(), Par::Seq);
    }
    let half = half(x.nrows());
    let (top, bottom) = x.split_at_row_mut(half);
    parallel::join(|| divide(l, top), || divide(l, bottom));
}

/// The lower triangle of X − A Aᵀ in the place of that of X, or of −A Aᵀ where `accum` is to replace it.
pub(super) fn subtract_square(x: MatMut<'_, f64>, a: MatRef<'_, f64>, accum: Accum) {
    if x.nrows() <= PART {
        let (lower, any) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        return triangular::matmul(x, lower, accum, a, any, a.transpose(), any, -1.0, Par::Seq);
    }
    let half = half(x.nrows());
    let (first, _, middle, second) = x.split_at_mut(half, half);
    let (top, bottom) = a.split_at_row(half);
    parallel::join(
        || subtract_product(middle, bottom, top, accum),
        || {
            parallel::join(
                || subtract_square(first, top, accum),
                || subtract_square(second, bottom, accum),
            )
        },
    );
}

/// X − A Bᵀ in the place of X, or −A Bᵀ where `accum` is to replace it.
fn subtract_product(x: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, accum: Accum) {
    let (rows, columns) = (x.nrows(), x.ncols());
    if rows.max(columns) <= PART {
        return matmul(x, accum, a, b.transpose(), -1.0, Par::Seq);
    }
    if rows >= columns {
        let half = half(rows);
        let (top, bottom) = x.split_at_row_mut(half);
        let (above, below) = a.split_at_row(half);
        parallel::join(
            || subtract_product(top, above, b, accum),
            || subtract_product(bottom, below, b, accum),
        );
    } else {
        let half = half(columns);
        let (left, right) = x.split_at_col_mut(half);
        let (before, after) = b.split_at_row(half);
        parallel::join(
            || subtract_product(left, a, before, accum),
            || subtract_product(right, a, after, accum),
        );
    }
}

/// About the half, such that whole registers and cache lines stay together.
fn half(count: usize) -> usize {
    (count / 2).next_multiple_of(24)
}
