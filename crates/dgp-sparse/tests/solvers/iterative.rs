//! Conjugate gradients against Cholesky, and systems they cannot solve.

use std::ops::ControlFlow;

use dgp_sparse::{
    Cholesky, CholeskyOptions, ConjugateGradients, ConjugateGradientsOptions, Error,
    Preconditioner, Progress, SparseMatrix, conjugate_gradients,
};

use crate::common::{
    elements::{elements, icosphere},
    grid, random,
};

const BOTH: [Preconditioner; 2] = [Preconditioner::Jacobi, Preconditioner::IncompleteCholesky];

fn with(preconditioner: Preconditioner) -> ConjugateGradientsOptions {
    ConjugateGradientsOptions { preconditioner, ..ConjugateGradientsOptions::default() }
}

#[test]
fn solutions_equal_those_of_cholesky() {
    let elements = elements(&icosphere(4));
    let matrix = elements.laplacian.plus_diagonal(&elements.lumped).unwrap();
    let mut next = random(5);
    let rhs: Vec<f64> = (0..matrix.rows()).map(|_| next() - 0.5).collect();
    let cholesky = Cholesky::new(&matrix, &CholeskyOptions::default(), Progress::NONE).unwrap();
    let expected = cholesky.solve(&rhs).unwrap();
    let [jacobi, incomplete] = BOTH.map(|preconditioner| {
        let options = with(preconditioner);
        let (x, report) = conjugate_gradients(&matrix, &rhs, &options, Progress::NONE).unwrap();
        assert!(report.residual <= 1e-10);
        let size = expected.iter().map(|x| x.abs()).fold(0.0, f64::max);
        assert!(x.iter().zip(&expected).all(|(x, e)| (x - e).abs() < 1e-8 * size));
        report
    });
    assert_eq!(incomplete.shift, 0.0);
    assert!(3 * incomplete.iterations < 2 * jacobi.iterations, "{incomplete:?} {jacobi:?}");
}

#[test]
fn a_factor_that_fails_is_shifted() {
    // Kershaw's matrix: positive definite, but its incomplete factor has a negative pivot.
    let (a, b) = (3.0, 2.0);
    let triplets = [
        (0, 0, a),
        (1, 1, a),
        (2, 2, a),
        (3, 3, a),
        (0, 1, -b),
        (1, 0, -b),
        (1, 2, -b),
        (2, 1, -b),
        (2, 3, -b),
        (3, 2, -b),
        (0, 3, b),
        (3, 0, b),
    ];
    let matrix = SparseMatrix::from_triplets(4, 4, &triplets).unwrap();
    let options = with(Preconditioner::IncompleteCholesky);
    let (x, report) =
        conjugate_gradients(&matrix, &[1.0, 2.0, 3.0, 4.0], &options, Progress::NONE).unwrap();
    assert!(report.shift > 0.0, "{report:?}");
    let product = matrix.product(&x);
    assert!(product.iter().zip([1.0, 2.0, 3.0, 4.0]).all(|(p, b)| (p - b).abs() < 1e-9));
}

#[test]
fn a_factor_without_fill_is_exact_where_none_would_be() {
    let edges: Vec<_> = (1..500).map(|i| (i - 1, i, f64::from(i))).collect();
    let path = SparseMatrix::from_edges(500, &edges).unwrap().plus_diagonal(&vec![0.1; 500]);
    let options = with(Preconditioner::IncompleteCholesky);
    let rhs: Vec<f64> = (0..500).map(|i| f64::from(i).cos()).collect();
    let (_, report) = conjugate_gradients(&path.unwrap(), &rhs, &options, Progress::NONE).unwrap();
    assert!(report.iterations <= 2, "{report:?}");
}

#[test]
fn scaling_by_powers_of_two_and_threads_change_no_bit() {
    let matrix = grid(150, 150).plus_diagonal(&vec![0.01; 150 * 150]).unwrap();
    let rhs: Vec<f64> = (0..matrix.rows()).map(|i| (i as f64).sin()).collect();
    for preconditioner in BOTH {
        let solve = |matrix: &SparseMatrix| {
            conjugate_gradients(matrix, &rhs, &with(preconditioner), Progress::NONE).unwrap()
        };
        let one = solve(&matrix);
        let factor = 2.0_f64.powi(-33);
        let (x, report) = solve(&matrix.clone().scaled(factor));
        assert_eq!(report, one.1);
        assert!(x.iter().zip(&one.0).all(|(x, y)| x * factor == *y));
        for threads in [1, 2, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| solve(&matrix)), one);
        }
    }
}

#[test]
fn a_laplacian_is_solved_where_the_right_hand_side_has_sum_zero() {
    let laplacian = grid(30, 30);
    let mut rhs = vec![0.0; 900];
    (rhs[0], rhs[899]) = (1.0, -1.0);
    for preconditioner in BOTH {
        let options = ConjugateGradientsOptions { iterations: 500, ..with(preconditioner) };
        let (x, _) = conjugate_gradients(&laplacian, &rhs, &options, Progress::NONE).unwrap();
        let product = laplacian.product(&x);
        assert!(product.iter().zip(&rhs).all(|(p, b)| (p - b).abs() < 1e-9));
        let result = conjugate_gradients(&laplacian, &[1.0; 900], &options, Progress::NONE);
        assert!(matches!(result, Err(Error::NotConverged { .. })), "{result:?}");
    }
}

#[test]
fn what_cannot_be_solved_is_named() {
    let options = ConjugateGradientsOptions::default();
    let solve = |matrix: &SparseMatrix, rhs: &[f64]| {
        conjugate_gradients(matrix, rhs, &options, Progress::NONE).map(|(x, _)| x)
    };
    let indefinite =
        SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, 9.0), (1, 0, 9.0)]);
    let result = solve(&indefinite.unwrap(), &[1.0, -1.0]);
    assert!(matches!(result, Err(Error::NotPositiveDefinite { .. })), "{result:?}");
    let negative = SparseMatrix::from_diagonal(&[1.0, -2.0]);
    assert!(matches!(
        solve(&negative, &[1.0, 1.0]),
        Err(Error::NotPositiveDefinite { row: 1, diagonal: -2.0, .. })
    ));
    let matrix = grid(40, 40).plus_diagonal(&vec![1e-3; 1600]).unwrap();
    let few = ConjugateGradientsOptions { iterations: 3, ..options };
    let result = conjugate_gradients(&matrix, &vec![1.0; 1600], &few, Progress::NONE);
    let Err(Error::NotConverged { iterations: 3, residual }) = result else { panic!("{result:?}") };
    assert!(residual > 1e-10 && residual <= 1.0);
    let nan = vec![f64::NAN; 1600];
    assert!(matches!(solve(&matrix, &nan), Err(Error::VectorNotFinite { index: 0, .. })));
    assert!(matches!(solve(&matrix, &[1.0]), Err(Error::Length { .. })));
    assert_eq!(solve(&matrix, &vec![0.0; 1600]).unwrap(), vec![0.0; 1600]);
    assert_eq!(solve(&SparseMatrix::zeros(0, 0), &[]).unwrap(), [0.0; 0]);
    let zero = ConjugateGradientsOptions { tolerance: 0.0, ..options };
    assert!(matches!(
        ConjugateGradients::new(&matrix, &zero),
        Err(Error::InvalidOption { name: "tolerance", .. })
    ));
    let stop = |_: f64| ControlFlow::Break(());
    let result = conjugate_gradients(&matrix, &vec![1.0; 1600], &options, Progress::new(&stop));
    assert_eq!(result.map(|(x, _)| x), Err(Error::Cancelled));
}
