//! Small dense problems.

use faer::{
    Mat, MatRef, Par, Spec,
    diag::Diag,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt::factor::{self, LltParams, LltRegularization},
        evd::{
            ComputeEigenvectors, SelfAdjointEvdParams, self_adjoint_evd, self_adjoint_evd_scratch,
        },
    },
    prelude::default,
};

use super::tall::multiply;

/// Eigenvalues, ascending, and orthonormal eigenvectors of a symmetric matrix of which the lower
/// triangle is read. `None` if the iteration fails, as it does for NaN.
pub(super) fn symmetric_eigen(matrix: MatRef<'_, f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = matrix.nrows();
    let params: Spec<SelfAdjointEvdParams, f64> = default();
    let size = self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, params);
    let mut memory = MemBuffer::new(size);
    let mut values = Diag::zeros(n);
    let mut vectors = Mat::zeros(n, n);
    let stack = MemStack::new(&mut memory);
    self_adjoint_evd(matrix, values.as_mut(), Some(vectors.as_mut()), Par::Seq, stack, params)
        .ok()?;
    let values: Vec<f64> = (0..n).map(|i| values.column_vector()[i]).collect();
    values.iter().all(|value| value.is_finite()).then_some((values, vectors))
}

/// The lower triangular R with A = R Rᵀ, and R⁻¹; `None` if a pivot falls below `least` times the
/// diagonal entry it comes from.
pub(super) fn triangular_root(matrix: MatRef<'_, f64>, least: f64) -> Option<(Mat<f64>, Mat<f64>)> {
    let n = matrix.nrows();
    let params: Spec<LltParams, f64> = default();
    let size = factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, params);
    let mut memory = MemBuffer::new(size);
    let mut root = matrix.to_owned();
    let regularization = LltRegularization::default();
    let stack = MemStack::new(&mut memory);
    factor::cholesky_in_place(root.as_mut(), regularization, Par::Seq, stack, params).ok()?;
    for j in 0..n {
        (0..j).for_each(|i| root[(i, j)] = 0.0);
        let remains = root[(j, j)].powi(2) > least * matrix[(j, j)];
        if !remains {
            return None;
        }
    }
    let mut inverse = Mat::identity(n, n);
    faer::linalg::triangular_solve::solve_lower_triangular_in_place(
        root.as_ref(),
        inverse.as_mut(),
        Par::Seq,
    );
    Some((root, inverse))
}

/// A B.
pub(super) fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut product = Mat::zeros(a.nrows(), b.ncols());
    multiply(product.as_mut(), faer::Accum::Replace, a, b, 1.0);
    product
}
