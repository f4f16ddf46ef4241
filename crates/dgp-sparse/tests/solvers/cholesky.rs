//! Cholesky against dense elimination, closed forms, and matrices that have no factor.

use dgp_sparse::{
    Cholesky, CholeskyOptions, Error, Ordering, Progress, SparseMatrix, SymbolicCholesky,
};
use proptest::prelude::*;
use std::{ops::ControlFlow, sync::Arc};

use crate::common::{dense_solve, grid, random};

fn with(ordering: Ordering) -> CholeskyOptions {
    CholeskyOptions { ordering }
}

/// The rows of a matrix.
fn rows(matrix: &SparseMatrix) -> Vec<Vec<f64>> {
    (0..matrix.rows()).map(|i| (0..matrix.columns()).map(|j| matrix.get(i, j)).collect()).collect()
}

fn factored(matrix: &SparseMatrix) -> Result<Cholesky, Error> {
    Cholesky::new(matrix, &CholeskyOptions::default(), Progress::NONE)
}

proptest! {
    #[test]
    fn solutions_equal_those_of_dense_elimination(
        edges in prop::collection::vec((0..20_u32, 0..20_u32, 0.01_f64..10.0), 0..60),
        mass in prop::collection::vec(0.1_f64..2.0, 20),
        rhs in prop::collection::vec(-1.0_f64..1.0, 20),
        order in Just((0..20_u32).collect::<Vec<_>>()).prop_shuffle(),
    ) {
        let laplacian = SparseMatrix::from_edges(20, &edges).unwrap();
        let matrix = laplacian.plus_diagonal(&mass).unwrap();
        let expected = dense_solve(rows(&matrix), &rhs);
        for ordering in
            [Ordering::MinimumDegree, Ordering::Dissection, Ordering::Natural, Ordering::Given(order)]
        {
            let cholesky = Cholesky::new(&matrix, &with(ordering), Progress::NONE).unwrap();
            let x = cholesky.solve(&rhs).unwrap();
            for (x, expected) in x.iter().zip(&expected) {
                prop_assert!((x - expected).abs() <= 1e-11, "{x} {expected}");
            }
        }
    }
}

#[test]
fn the_eigenvectors_of_a_grid_are_known() {
    // (L + I) u = (λ + 1) u for u = cos(π p (x + ½)/n) cos(π q (y + ½)/n).
    let n = 40;
    let matrix = grid(n, n).plus_diagonal(&vec![1.0; n * n]).unwrap();
    let cholesky = factored(&matrix).unwrap();
    let angle = |p: usize| std::f64::consts::PI * p as f64 / n as f64;
    for (p, q) in [(0, 0), (1, 0), (3, 7), (39, 20)] {
        let u: Vec<f64> = (0..n * n)
            .map(|i| {
                let (x, y) = ((i % n) as f64 + 0.5, (i / n) as f64 + 0.5);
                (angle(p) * x).cos() * (angle(q) * y).cos()
            })
            .collect();
        let eigenvalue = 5.0 - 2.0 * angle(p).cos() - 2.0 * angle(q).cos();
        let x = cholesky.solve(&u).unwrap();
        let worst = x.iter().zip(&u).map(|(x, u)| (x - u / eigenvalue).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-13, "{worst}");
    }
}

#[test]
fn many_right_hand_sides_are_solved_like_one() {
    let matrix = grid(30, 20).plus_diagonal(&vec![0.1; 600]).unwrap();
    let cholesky = factored(&matrix).unwrap();
    let mut next = random(1);
    for count in [0, 1, 2, 3, 4, 5, 8, 9, 17] {
        let rhs: Vec<f64> = (0..600 * count).map(|_| next() - 0.5).collect();
        let all = cholesky.solve_many(&rhs).unwrap();
        let mut substituted = rhs.clone();
        cholesky.substitute(&mut substituted).unwrap();
        for (k, column) in rhs.chunks_exact(600).enumerate() {
            let one = cholesky.solve(column).unwrap();
            let place = 600 * k..600 * (k + 1);
            assert_eq!(one, all[place.clone()], "column {k} of {count}");
            assert_eq!(one, substituted[place], "column {k} of {count}");
        }
    }
}

#[test]
fn new_values_reuse_the_analysis() {
    let pattern = grid(15, 15);
    let first = pattern.plus_diagonal(&[1.0; 225]).unwrap();
    let second = pattern.plus_diagonal(&[7.0; 225]).unwrap();
    let symbolic =
        SymbolicCholesky::new(&first, &CholeskyOptions::default(), Progress::NONE).unwrap();
    let symbolic = Arc::new(symbolic);
    let mut cholesky = Cholesky::with_symbolic(&symbolic, &first, Progress::NONE).unwrap();
    cholesky.refactor(&second, Progress::NONE).unwrap();
    let rhs = vec![1.0; 225];
    assert_eq!(cholesky.solve(&rhs), factored(&second).unwrap().solve(&rhs));

    let mut other =
        grid(15, 15).triplets().map(|(i, j, x)| (i as u32, j as u32, x)).collect::<Vec<_>>();
    other.extend([(3, 200, -1.0), (200, 3, -1.0)]);
    let other = SparseMatrix::from_triplets(225, 225, &other).unwrap();
    let error = cholesky.refactor(&other, Progress::NONE).unwrap_err();
    assert_eq!(error, Error::OtherPattern { column: 3 });
}

#[test]
fn scaling_by_powers_of_two_scales_the_solution_exactly() {
    let matrix = grid(20, 20).plus_diagonal(&[0.3; 400]).unwrap();
    let mut next = random(2);
    let rhs: Vec<f64> = (0..400).map(|_| next()).collect();
    let x = factored(&matrix).unwrap().solve(&rhs).unwrap();
    for power in [-301, -7, 1, 300] {
        let factor = 2_f64.powi(power);
        let scaled = factored(&matrix.clone().scaled(factor)).unwrap().solve(&rhs).unwrap();
        assert!(x.iter().zip(&scaled).all(|(x, scaled)| *x == scaled * factor), "2^{power}");
    }
}

#[test]
fn a_laplacian_without_mass_names_the_constants() {
    for n in [1, 2, 5, 30, 100] {
        let error = factored(&grid(n, n)).unwrap_err();
        assert_eq!(error, Error::ConstantNullSpace { row: 0, size: n * n }, "{n}");
    }
    // Two components, of which one has a mass.
    let edges = [(0_u32, 1_u32, 1.0), (1, 2, 1.0), (3, 4, 0.1), (4, 5, 0.3), (3, 5, 0.7)];
    let laplacian = SparseMatrix::from_edges(6, &edges).unwrap();
    let matrix = laplacian.plus_diagonal(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
    assert_eq!(factored(&matrix).unwrap_err(), Error::ConstantNullSpace { row: 3, size: 3 });
}

#[test]
fn an_indefinite_matrix_names_row_and_pivot() {
    // A saddle in rows 4 and 7, where everything else is definite.
    let mut triplets: Vec<_> = (0..10).map(|i| (i, i, 2.0)).collect();
    triplets.extend([(4, 7, -3.0), (7, 4, -3.0)]);
    let matrix = SparseMatrix::from_triplets(10, 10, &triplets).unwrap();
    for ordering in [Ordering::MinimumDegree, Ordering::Natural] {
        match Cholesky::new(&matrix, &with(ordering), Progress::NONE).unwrap_err() {
            Error::NotPositiveDefinite { row, pivot, diagonal } => {
                assert!(row == 4 || row == 7, "{row}");
                assert_eq!((pivot, diagonal), (-2.5, 2.0));
            }
            error => panic!("{error}"),
        }
    }
    let negative = grid(9, 9).scaled(-1.0).plus_diagonal(&[-1.0; 81]).unwrap();
    let error = factored(&negative).unwrap_err();
    assert!(matches!(error, Error::NotPositiveDefinite { .. }), "{error}");
}

#[test]
fn a_pivot_deep_in_a_block_is_the_one_of_elimination() {
    // Dense, so that all is one block: B Bᵀ + I, made indefinite at the last row.
    let n = 60;
    let mut next = random(3);
    let mut triplets = Vec::new();
    for i in 0..n {
        for j in 0..i {
            let value = next() - 0.5;
            triplets.extend([(i, j, value), (j, i, value)]);
        }
        triplets.push((i, i, if i == n - 1 { 0.01 } else { 40.0 }));
    }
    let matrix = SparseMatrix::from_triplets(n as usize, n as usize, &triplets).unwrap();
    let error = Cholesky::new(&matrix, &with(Ordering::Natural), Progress::NONE).unwrap_err();
    // The last pivot is the Schur complement a − cᵀ B⁻¹ c.
    let others: Vec<u32> = (0..n - 1).collect();
    let top = matrix.submatrix(&others, &others).unwrap();
    let c: Vec<f64> = others.iter().map(|&i| matrix.get(i as usize, n as usize - 1)).collect();
    let x = dense_solve(rows(&top), &c);
    let expected = 0.01 - x.iter().zip(&c).map(|(x, c)| x * c).sum::<f64>();
    match error {
        Error::NotPositiveDefinite { row: 59, pivot, diagonal: 0.01 } => {
            assert!((pivot - expected).abs() < 1e-12, "{pivot} {expected}");
        }
        error => panic!("{error}"),
    }
}

#[test]
fn a_singular_matrix_whose_null_space_is_not_constant_names_a_row() {
    // Rows 1 and 2 are multiples: (1, −2; −2, 4).
    let triplets = [(0, 0, 1.0), (1, 1, 1.0), (1, 2, -2.0), (2, 1, -2.0), (2, 2, 4.0)];
    let matrix = SparseMatrix::from_triplets(3, 3, &triplets).unwrap();
    let error = factored(&matrix).unwrap_err();
    assert!(matches!(error, Error::Singular { row: 1 | 2, size: 2, .. }), "{error}");
}

#[test]
fn what_cannot_be_factored_is_named() {
    let nan = SparseMatrix::from_diagonal(&[1.0, f64::NAN, 1.0]);
    assert!(matches!(factored(&nan), Err(Error::NotFinite { row: 1, column: 1, .. })));
    let infinite = SparseMatrix::from_diagonal(&[1.0, 1.0, f64::INFINITY]);
    assert!(matches!(factored(&infinite), Err(Error::NotFinite { row: 2, .. })));
    let triplets = [(0, 0, 1.0), (1, 1, 1.0), (0, 1, 0.5), (1, 0, 0.25)];
    let skew = SparseMatrix::from_triplets(2, 2, &triplets).unwrap();
    assert!(matches!(factored(&skew), Err(Error::NotSymmetric { row: 0, column: 1, .. })));
    let wide = SparseMatrix::zeros(2, 3);
    assert_eq!(factored(&wide).unwrap_err(), Error::NotSquare { rows: 2, columns: 3 });
    let hollow = SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0)]).unwrap();
    assert!(matches!(factored(&hollow), Err(Error::NotPositiveDefinite { row: 1, .. })));
    let order = with(Ordering::Given(vec![0, 0]));
    let error = Cholesky::new(&SparseMatrix::identity(2), &order, Progress::NONE).unwrap_err();
    assert_eq!(error, Error::NotPermutation { row: 0 });

    let cholesky = factored(&SparseMatrix::identity(2)).unwrap();
    let error = cholesky.solve(&[1.0, f64::NAN]).unwrap_err();
    assert!(matches!(error, Error::VectorNotFinite { index: 1, .. }));
    assert!(matches!(cholesky.solve(&[1.0]), Err(Error::Length { actual: 1, expected: 2, .. })));
}

#[test]
fn a_failed_refactorization_leaves_nothing_to_solve_with() {
    let mut cholesky = factored(&SparseMatrix::identity(2)).unwrap();
    let negative = SparseMatrix::from_diagonal(&[1.0, -1.0]);
    assert!(cholesky.refactor(&negative, Progress::NONE).is_err());
    assert!(matches!(cholesky.solve(&[1.0, 1.0]), Err(Error::Inaccurate { .. })));
}

#[test]
fn small_and_empty_matrices_are_solved() {
    let none = factored(&SparseMatrix::zeros(0, 0)).unwrap();
    assert_eq!(none.solve(&[]), Ok(Vec::new()));
    let one = factored(&SparseMatrix::from_diagonal(&[4.0])).unwrap();
    assert_eq!(one.solve(&[2.0]), Ok(vec![0.5]));
    let diagonal = factored(&SparseMatrix::from_diagonal(&[1.0, 4.0, 16.0])).unwrap();
    assert_eq!(diagonal.solve(&[1.0, 1.0, 1.0]), Ok(vec![1.0, 0.25, 0.0625]));
    assert_eq!(diagonal.solve(&[0.0; 3]), Ok(vec![0.0; 3]));
}

#[test]
fn it_stops_when_asked_to() {
    let matrix = grid(5, 5).plus_diagonal(&[1.0; 25]).unwrap();
    let reports = std::sync::atomic::AtomicUsize::new(0);
    let count = |_| {
        reports.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    let options = CholeskyOptions::default();
    assert!(Cholesky::new(&matrix, &options, Progress::new(&count)).is_ok());
    for stop_at in 1..=reports.into_inner() {
        let left = std::sync::atomic::AtomicUsize::new(stop_at);
        let stop = |_| {
            if left.fetch_sub(1, std::sync::atomic::Ordering::Relaxed) == 1 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let result = Cholesky::new(&matrix, &options, Progress::new(&stop));
        assert_eq!(result.unwrap_err(), Error::Cancelled, "report {stop_at}");
    }
}

/// A full matrix, large enough for threads to share its one block: I + s sᵀ for a vector s of length
/// one, with A⁻¹ b = b − ½ s (s·b).
fn full(n: usize) -> (SparseMatrix, Vec<f64>) {
    let s: Vec<f64> = (0..n).map(|i| 1.0 + (i as f64).sin()).collect();
    let length = s.iter().map(|x| x * x).sum::<f64>().sqrt();
    let s: Vec<f64> = s.iter().map(|x| x / length).collect();
    let entry = |i: usize, j: usize| s[i] * s[j] + f64::from(u8::from(i == j));
    let triplets: Vec<_> = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .map(|(i, j)| (i as u32, j as u32, entry(i, j)))
        .collect();
    (SparseMatrix::from_triplets(n, n, &triplets).unwrap(), s)
}

#[test]
fn a_block_that_threads_share_is_factored_as_on_one() {
    let n = 900;
    let (matrix, s) = full(n);
    let rhs: Vec<f64> = (0..n).map(|i| (3.0 * i as f64).cos()).collect();
    let along: f64 = s.iter().zip(&rhs).map(|(a, b)| a * b).sum();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| factored(&matrix).unwrap().solve(&rhs).unwrap())
    };
    let x = run(1);
    for ((x, b), s) in x.iter().zip(&rhs).zip(&s) {
        assert!((x - (b - 0.5 * along * s)).abs() < 1e-14, "{x}");
    }
    assert!(x == run(2) && x == run(3) && x == run(8));
}

#[test]
fn a_pivot_deep_in_a_shared_block_is_named() {
    let (matrix, _) = full(900);
    let mut shift = vec![0.0; 900];
    shift[700] = -3.0;
    let matrix = matrix.plus_diagonal(&shift).unwrap();
    let error = Cholesky::new(&matrix, &with(Ordering::Natural), Progress::NONE).unwrap_err();
    assert!(matches!(error, Error::NotPositiveDefinite { row: 700, .. }), "{error:?}");
}
