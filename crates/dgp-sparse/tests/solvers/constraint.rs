//! Given unknowns and equations, against dense systems that contain all of them.

use dgp_sparse::{
    CholeskyOptions, EqualitySystem, Error, FixedSystem, Progress, SoftSystem, SparseMatrix,
};
use proptest::prelude::*;

use crate::common::{dense_solve, grid, random};

fn options() -> CholeskyOptions {
    CholeskyOptions::default()
}

/// The rows of a matrix.
fn rows(matrix: &SparseMatrix) -> Vec<Vec<f64>> {
    (0..matrix.rows()).map(|i| (0..matrix.columns()).map(|j| matrix.get(i, j)).collect()).collect()
}

/// x and λ of (A Cᵀ; C 0) (x; λ) = (b; d).
fn dense_saddle(
    matrix: &SparseMatrix,
    constraints: &SparseMatrix,
    rhs: &[f64],
    targets: &[f64],
) -> Vec<f64> {
    let (n, m) = (matrix.rows(), constraints.rows());
    let (a, c) = (rows(matrix), rows(constraints));
    let mut saddle: Vec<Vec<f64>> =
        (0..n).map(|i| a[i].iter().copied().chain((0..m).map(|k| c[k][i])).collect()).collect();
    saddle.extend((0..m).map(|k| c[k].iter().copied().chain(vec![0.0; m]).collect()));
    let all: Vec<f64> = rhs.iter().chain(targets).copied().collect();
    dense_solve(saddle, &all)
}

/// A connected Laplacian: a path with more edges.
fn laplacian(n: usize) -> impl Strategy<Value = SparseMatrix> {
    let edge = (0..n as u32, 0..n as u32, 0.1_f64..2.0);
    prop::collection::vec(edge, 0..2 * n).prop_map(move |mut edges| {
        edges.extend((1..n as u32).map(|i| (i - 1, i, 1.0)));
        SparseMatrix::from_edges(n, &edges).unwrap()
    })
}

fn close(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()))
}

proptest! {
    #[test]
    fn fixed_unknowns_equal_those_of_the_dense_saddle(
        matrix in laplacian(12),
        order in Just((0..12_u32).collect::<Vec<_>>()).prop_shuffle(),
        count in 1..12_usize,
        rhs in prop::collection::vec(-1.0_f64..1.0, 12),
        values in prop::collection::vec(-1.0_f64..1.0, 12),
    ) {
        let fixed = &order[..count];
        let ones: Vec<_> = fixed.iter().enumerate().map(|(k, &i)| (k as u32, i, 1.0)).collect();
        let constraints = SparseMatrix::from_triplets(count, 12, &ones).unwrap();
        let expected = dense_saddle(&matrix, &constraints, &rhs, &values[..count]);
        let system = FixedSystem::new(&matrix, fixed, &options(), Progress::NONE).unwrap();
        let x = system.solve(&rhs, &values[..count]).unwrap();
        prop_assert!(close(&x, &expected[..12]));
    }

    #[test]
    fn exact_equations_equal_those_of_the_dense_saddle(
        matrix in laplacian(12),
        entries in prop::collection::vec(-1.0_f64..1.0, 36),
        mass in prop::sample::select(vec![0.0, 0.5]),
        rhs in prop::collection::vec(-1.0_f64..1.0, 12),
        targets in prop::collection::vec(-1.0_f64..1.0, 3),
    ) {
        // Without mass the matrix is singular, and only the equations make the solution unique.
        let matrix = matrix.plus_diagonal(&[mass; 12]).unwrap();
        let triplets: Vec<_> =
            entries.iter().enumerate().map(|(k, &x)| (k as u32 / 12, k as u32 % 12, x)).collect();
        let constraints = SparseMatrix::from_triplets(3, 12, &triplets).unwrap();
        // Sums of rows near zero would hardly fix the constant.
        prop_assume!(entries[..12].iter().sum::<f64>().abs() > 0.1);
        let expected = dense_saddle(&matrix, &constraints, &rhs, &targets);
        let system = EqualitySystem::new(&matrix, &constraints, &options(), Progress::NONE).unwrap();
        let (x, multipliers) = system.solve(&rhs, &targets).unwrap();
        prop_assert!(close(&x, &expected[..12]), "{x:?} {expected:?}");
        prop_assert!(close(&multipliers, &expected[12..]), "{multipliers:?} {expected:?}");
    }

    #[test]
    fn weighted_equations_equal_the_dense_normal_equations(
        matrix in laplacian(10),
        entries in prop::collection::vec((0..4_u32, 0..10_u32, -1.0_f64..1.0), 1..20),
        weights in prop::collection::vec(0.1_f64..5.0, 4),
        rhs in prop::collection::vec(-1.0_f64..1.0, 10),
        targets in prop::collection::vec(-1.0_f64..1.0, 4),
    ) {
        let matrix = matrix.plus_diagonal(&[0.2; 10]).unwrap();
        let constraints = SparseMatrix::from_triplets(4, 10, &entries).unwrap();
        let c = rows(&constraints);
        let mut normal = rows(&matrix);
        let mut all = rhs.clone();
        for k in 0..4 {
            for i in 0..10 {
                all[i] += weights[k] * c[k][i] * targets[k];
                for j in 0..10 {
                    normal[i][j] += weights[k] * c[k][i] * c[k][j];
                }
            }
        }
        let expected = dense_solve(normal, &all);
        let system =
            SoftSystem::new(&matrix, &constraints, &weights, &options(), Progress::NONE).unwrap();
        prop_assert!(close(&system.solve(&rhs, &targets).unwrap(), &expected));
    }
}

#[test]
fn a_component_without_a_fixed_row_is_named() {
    let edges = [(0, 1, 1.0), (1, 2, 1.0), (3, 4, 0.1), (4, 5, 0.3), (3, 5, 0.7)];
    let matrix = SparseMatrix::from_edges(7, &edges).unwrap();
    let system = |fixed: &[u32]| FixedSystem::new(&matrix, fixed, &options(), Progress::NONE);
    assert_eq!(system(&[1, 6]).unwrap_err(), Error::Unconstrained { row: 3, size: 3 });
    assert_eq!(system(&[1, 4]).unwrap_err(), Error::Unconstrained { row: 6, size: 1 });
    assert!(system(&[1, 4, 6]).is_ok());
    assert_eq!(system(&[1, 4, 1]).unwrap_err(), Error::FixedTwice { row: 1 });
    assert!(matches!(system(&[7]), Err(Error::OutOfRange { row: 7, .. })));
}

#[test]
fn rows_in_errors_are_those_of_the_whole_matrix() {
    let matrix = SparseMatrix::from_diagonal(&[1.0, 1.0, 1.0, -2.0, 1.0]);
    let error = FixedSystem::new(&matrix, &[0, 1], &options(), Progress::NONE).unwrap_err();
    assert!(matches!(error, Error::NotPositiveDefinite { row: 3, .. }), "{error}");
}

#[test]
fn one_factorization_serves_many_values() {
    let matrix = grid(20, 10);
    let fixed: Vec<u32> = (0..200).step_by(7).collect();
    let mut system = FixedSystem::new(&matrix, &fixed, &options(), Progress::NONE).unwrap();
    let mut next = random(4);
    let rhs: Vec<f64> = (0..600).map(|_| next()).collect();
    let values: Vec<f64> = (0..3 * fixed.len()).map(|_| next()).collect();
    let all = system.solve_many(&rhs, &values, 3).unwrap();
    for k in 0..3 {
        let values = &values[k * fixed.len()..(k + 1) * fixed.len()];
        let one = system.solve(&rhs[k * 200..(k + 1) * 200], values).unwrap();
        assert_eq!(one, all[k * 200..(k + 1) * 200]);
    }
    // Twice the matrix: half the answer to the same forces, the same harmonic part.
    system.refactor(&matrix.clone().scaled(2.0), Progress::NONE).unwrap();
    let zero = vec![0.0; fixed.len()];
    let half = system.solve(&rhs[..200], &zero).unwrap();
    let fresh = FixedSystem::new(&matrix, &fixed, &options(), Progress::NONE).unwrap();
    let whole = fresh.solve(&rhs[..200], &zero).unwrap();
    assert!(half.iter().zip(&whole).all(|(half, whole)| 2.0 * half == *whole));
}

#[test]
fn everything_or_nothing_may_be_fixed() {
    let matrix = grid(3, 3).plus_diagonal(&[1.0; 9]).unwrap();
    let all: Vec<u32> = (0..9).collect();
    let values: Vec<f64> = (0..9).map(f64::from).collect();
    let system = FixedSystem::new(&matrix, &all, &options(), Progress::NONE).unwrap();
    assert_eq!(system.solve(&[1.0; 9], &values), Ok(values));
    let system = FixedSystem::new(&matrix, &[], &options(), Progress::NONE).unwrap();
    assert!(close(&system.solve(&[1.0; 9], &[]).unwrap(), &[1.0; 9]));
}

#[test]
fn equations_that_depend_on_others_are_named() {
    let matrix = grid(4, 4);
    let row = |k: u32, factor: f64| (0..16).map(move |j| (k, j, factor));
    let triplets: Vec<_> = row(0, 1.0).chain([(1, 3, 1.0)]).chain(row(2, 2.0)).collect();
    let constraints = SparseMatrix::from_triplets(3, 16, &triplets).unwrap();
    let system = EqualitySystem::new(&matrix, &constraints, &options(), Progress::NONE);
    assert!(matches!(system, Err(Error::DependentConstraint { constraint: 0 | 2 })), "{system:?}");
    // Nothing fixes the constant.
    let difference = SparseMatrix::from_triplets(1, 16, &[(0, 2, 1.0), (0, 5, -1.0)]).unwrap();
    let system = EqualitySystem::new(&matrix, &difference, &options(), Progress::NONE);
    assert_eq!(system.unwrap_err(), Error::Unconstrained { row: 0, size: 16 });
}
