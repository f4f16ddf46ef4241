//! The few kernels on 3×3 matrices that measures need.

use glam::{DMat3, DVec3};

use crate::measure::scale::Scale;

/// The eigenvalues and eigenvectors of a symmetric matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricEigen {
    /// The eigenvalues, smallest first.
    pub values: DVec3,
    /// Their unit eigenvectors as columns: a right-handed frame. In the first two the component of
    /// largest size is positive.
    pub vectors: DMat3,
}

/// The eigenvalues and eigenvectors of symmetric `matrix`, of which the upper half is read.
///
/// By cyclic Jacobi rotations, which give orthogonal vectors for equal and nearly equal values too
/// (Golub and Van Loan, *Matrix Computations*, section 8.5). Entries that are not finite count as 0.
pub fn symmetric_eigen(matrix: &DMat3) -> SymmetricEigen {
    // Quadratic convergence: real matrices need four to six sweeps.
    const SWEEPS: usize = 30;
    let mut a = [[0.0; 3]; 3];
    for (i, row) in a.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let value = matrix.col(i.max(j))[i.min(j)];
            *entry = if value.is_finite() { value } else { 0.0 };
        }
    }
    let scale = Scale::of(a.iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs())));
    a.iter_mut().flatten().for_each(|x| *x *= scale.down);
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        let off = a[0][1].abs() + a[0][2].abs() + a[1][2].abs();
        if off == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    let column = |k: usize| {
        let u = DVec3::new(v[0][k], v[1][k], v[2][k]).normalize();
        let largest = u.abs().max_position();
        if u[largest] < 0.0 { -u } else { u }
    };
    let (first, second) = (column(order[0]), column(order[1]));
    SymmetricEigen {
        values: DVec3::from_array(order.map(|k| a[k][k])) * scale.up,
        vectors: DMat3::from_cols(first, second, first.cross(second)),
    }
}

/// Makes a[p][q] zero by a rotation in the plane of p and q, gathered in `v`.
fn rotate(a: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    let off = a[p][q];
    // What cannot change the diagonal any more counts as zero.
    if off.abs() <= f64::EPSILON * f64::EPSILON * (a[p][p].abs() + a[q][q].abs()) {
        (a[p][q], a[q][p]) = (0.0, 0.0);
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * off);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    a[p][p] -= t * off;
    a[q][q] += t * off;
    (a[p][q], a[q][p]) = (0.0, 0.0);
    let r = 3 - p - q;
    let (x, y) = (a[r][p], a[r][q]);
    (a[r][p], a[r][q]) = (c * x - s * y, s * x + c * y);
    (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
    for row in v {
        let (x, y) = (row[p], row[q]);
        (row[p], row[q]) = (c * x - s * y, s * x + c * y);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn is_decomposition(a: &DMat3, tolerance: f64) -> bool {
        let SymmetricEigen { values, vectors } = symmetric_eigen(a);
        let size = a.to_cols_array().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let back = vectors * DMat3::from_diagonal(values) * vectors.transpose();
        back.abs_diff_eq(*a, tolerance * size)
            && (vectors.transpose() * vectors).abs_diff_eq(DMat3::IDENTITY, 1e-14)
            && (vectors.determinant() - 1.0).abs() < 1e-14
            && values.x <= values.y
            && values.y <= values.z
    }

    fn symmetric(x: [f64; 6]) -> DMat3 {
        DMat3::from_cols_array(&[x[0], x[1], x[2], x[1], x[3], x[4], x[2], x[4], x[5]])
    }

    proptest! {
        #[test]
        fn the_parts_make_the_matrix(x in proptest::array::uniform6(-1.0..1.0_f64), k in -300..300) {
            prop_assert!(is_decomposition(&(symmetric(x) * 2_f64.powi(k)), 1e-14));
        }

        #[test]
        fn nearly_equal_values_are_no_trouble(x in proptest::array::uniform6(-1e-9..1e-9_f64)) {
            prop_assert!(is_decomposition(&(DMat3::IDENTITY + symmetric(x)), 1e-14));
        }
    }

    #[test]
    fn special_matrices() {
        for a in
            [[0.0; 6], [1.0, 0.0, 0.0, 1.0, 0.0, 1.0], [1.0; 6], [3.0, 0.0, 0.0, 1.0, 0.0, 2.0]]
        {
            assert!(is_decomposition(&symmetric(a), 1e-14), "{a:?}");
        }
        assert_eq!(
            symmetric_eigen(&symmetric([3.0, 0.0, 0.0, 1.0, 0.0, 2.0])).values,
            DVec3::new(1.0, 2.0, 3.0)
        );
        assert_eq!(symmetric_eigen(&DMat3::from_diagonal(DVec3::NAN)).values, DVec3::ZERO);
    }
}
