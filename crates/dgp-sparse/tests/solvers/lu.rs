//! LU and least squares: residuals, agreement with each other, and matrices that are singular.

use dgp_sparse::{Error, LeastSquaresMethod, Lu, Progress, SparseMatrix, least_squares};
use proptest::prelude::*;

use crate::common::{grid, random};

fn factored(matrix: &SparseMatrix) -> Result<Lu, Error> {
    Lu::new(matrix, Progress::NONE)
}

/// The Laplacian of a grid with weights that differ by direction, and a little mass.
fn unsymmetric(width: usize) -> SparseMatrix {
    let mut next = random(7);
    let symmetric = grid(width, width);
    let triplets: Vec<_> = symmetric
        .triplets()
        .filter(|(i, j, _)| i != j)
        .flat_map(|(i, j, _)| {
            let weight = 0.5 + next();
            [(i as u32, j as u32, -weight), (i as u32, i as u32, weight)]
        })
        .collect();
    let n = symmetric.rows();
    SparseMatrix::from_triplets(n, n, &triplets).unwrap().plus_diagonal(&vec![0.01; n]).unwrap()
}

#[test]
fn unsymmetric_systems_are_solved_to_rounding() {
    for width in [3, 20, 80] {
        let matrix = unsymmetric(width);
        let mut next = random(1);
        let expected: Vec<f64> = (0..2 * matrix.rows()).map(|_| next() - 0.5).collect();
        let x = factored(&matrix).unwrap().solve_many(&matrix.product_many(&expected)).unwrap();
        assert!(x.iter().zip(&expected).all(|(x, e)| (x - e).abs() < 1e-10));
    }
}

#[test]
fn scaling_by_powers_of_two_and_threads_change_no_bit() {
    let matrix = unsymmetric(30);
    let rhs: Vec<f64> = (0..3 * matrix.rows()).map(|i| (i as f64).sin()).collect();
    let solve = |matrix: &SparseMatrix| factored(matrix).unwrap().solve_many(&rhs).unwrap();
    let x = solve(&matrix);
    let factor = 2.0_f64.powi(70);
    let scaled = solve(&matrix.clone().scaled(factor));
    assert!(x.iter().zip(&scaled).all(|(x, y)| *x == y * factor));
    for threads in [1, 2, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| solve(&matrix)), x);
    }
}

#[test]
fn singular_matrices_are_named() {
    // Row 1 and column 2 are what the others make of them.
    let column_2 = [(0, 2, 3.0), (1, 2, 6.0), (2, 2, 5.0), (3, 2, 1.0)];
    let triplets: Vec<_> = column_2
        .into_iter()
        .chain([(0, 0, 3.0), (1, 0, 6.0), (2, 0, 5.0), (3, 0, 1.0)])
        .chain([(2, 1, 1.0), (3, 3, 2.0), (0, 3, 0.25), (1, 3, 0.5)])
        .collect();
    let matrix = SparseMatrix::from_triplets(4, 4, &triplets).unwrap();
    let error = factored(&matrix).unwrap_err();
    let Error::SingularLu { row, column } = error else { panic!("{error}") };
    assert!(row == 0 || row == 1, "{error}");
    assert!(column == 0 || column == 2, "{error}");
    // A Laplacian: any row and column.
    assert!(matches!(factored(&grid(12, 12)), Err(Error::SingularLu { .. })));
    // No choice of pivots: rows 1 and 2 have entries in column 0 only.
    let triplets = [(0, 1, 1.0), (0, 2, 1.0), (1, 0, 1.0), (2, 0, 1.0), (0, 0, 1.0)];
    let structural = SparseMatrix::from_triplets(3, 3, &triplets).unwrap();
    let error = factored(&structural).unwrap_err();
    assert!(matches!(error, Error::SingularLu { row: 1 | 2, column: 1 | 2 }), "{error}");
    let empty =
        SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (0, 1, 1.0), (1, 1, 0.0)]).unwrap();
    assert_eq!(factored(&empty).unwrap_err(), Error::EmptyRow { row: 1 });
    let empty = empty.transpose();
    let error = factored(&empty).unwrap_err();
    assert_eq!(error, Error::DependentColumn { column: 1, columns: 1 });
    let wide = SparseMatrix::zeros(2, 3);
    assert_eq!(factored(&wide).unwrap_err(), Error::NotSquare { rows: 2, columns: 3 });
    assert_eq!(factored(&SparseMatrix::zeros(0, 0)).unwrap().solve(&[]).unwrap(), [0.0; 0]);
    let nan = SparseMatrix::from_diagonal(&[1.0, f64::NAN]);
    assert!(matches!(factored(&nan), Err(Error::NotFinite { row: 1, .. })));
    let lu = factored(&SparseMatrix::from_diagonal(&[2.0, -4.0])).unwrap();
    assert!(matches!(lu.solve(&[1.0]), Err(Error::Length { .. })));
    assert!(matches!(lu.solve(&[1.0, f64::NAN]), Err(Error::VectorNotFinite { index: 1, .. })));
    assert_eq!(lu.solve(&[1.0, 1.0]).unwrap(), [0.5, -0.25]);
}

const METHODS: [LeastSquaresMethod; 2] =
    [LeastSquaresMethod::NormalEquations, LeastSquaresMethod::Qr];

#[test]
fn a_line_is_fitted_as_by_hand() {
    // y = a + b x through noise: b = Σ(x − x̄)(y − ȳ) / Σ(x − x̄)².
    let n = 50_u32;
    let triplets: Vec<_> = (0..n).flat_map(|i| [(i, 0, 1.0), (i, 1, f64::from(i))]).collect();
    let matrix = SparseMatrix::from_triplets(n as usize, 2, &triplets).unwrap();
    let mut next = random(3);
    let y: Vec<f64> = (0..n).map(|i| 3.0 - 0.5 * f64::from(i) + next()).collect();
    let (mean_x, mean_y) = (f64::from(n - 1) / 2.0, y.iter().sum::<f64>() / f64::from(n));
    let deviation = |i: usize| i as f64 - mean_x;
    let slope = (0..50).map(|i| deviation(i) * (y[i] - mean_y)).sum::<f64>()
        / (0..50).map(|i| deviation(i).powi(2)).sum::<f64>();
    for method in METHODS {
        let fit = least_squares(&matrix, &y, method, Progress::NONE).unwrap();
        assert!((fit.solution[1] - slope).abs() < 1e-13);
        assert!((fit.solution[0] - (mean_y - slope * mean_x)).abs() < 1e-12);
        assert!(fit.gradients[0] < 1e-14 && fit.residuals[0] > 1.0);
    }
}

#[test]
fn orthogonalization_keeps_digits_that_normal_equations_lose() {
    // Läuchli's matrix: columns (1, ε, 0, 0), (1, 0, ε, 0), (1, 0, 0, ε).
    let of = |small: f64| {
        let triplets: Vec<_> = (0..3).flat_map(|j| [(0, j, 1.0), (j + 1, j, small)]).collect();
        SparseMatrix::from_triplets(4, 3, &triplets).unwrap()
    };
    let mild = of(1e-3);
    let nearly = of(1e-9);
    for (matrix, method) in [(&mild, METHODS[0]), (&mild, METHODS[1]), (&nearly, METHODS[1])] {
        let rhs = matrix.product(&[1.0, 2.0, 3.0]);
        let fit = least_squares(matrix, &rhs, method, Progress::NONE).unwrap();
        let error = fit.solution.iter().zip([1.0, 2.0, 3.0]).map(|(x, e)| (x - e).abs());
        assert!(error.fold(0.0, f64::max) < 1e-6, "{method:?} {fit:?}");
    }
    // AᵀA is all ones to rounding.
    let result = least_squares(&nearly, &[1.0; 4], METHODS[0], Progress::NONE);
    assert!(matches!(result, Err(Error::DependentColumn { .. })), "{result:?}");
}

#[test]
fn dependent_columns_are_named() {
    let triplets =
        [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 3.0), (3, 2, 4.0), (2, 3, 6.0), (3, 3, 8.0), (4, 1, 2.0)];
    let twice = SparseMatrix::from_triplets(6, 4, &triplets).unwrap();
    for method in METHODS {
        let error = least_squares(&twice, &[1.0; 6], method, Progress::NONE).unwrap_err();
        assert!(matches!(error, Error::DependentColumn { column: 2 | 3, .. }), "{error}");
        let wide = SparseMatrix::zeros(2, 3);
        let error = least_squares(&wide, &[1.0; 2], method, Progress::NONE).unwrap_err();
        assert_eq!(error, Error::Underdetermined { rows: 2, columns: 3 });
        let empty = SparseMatrix::from_triplets(3, 2, &[(0, 0, 1.0)]).unwrap();
        let error = least_squares(&empty, &[1.0; 3], method, Progress::NONE).unwrap_err();
        assert_eq!(error, Error::DependentColumn { column: 1, columns: 1 });
        let none = least_squares(&SparseMatrix::zeros(3, 0), &[1.0; 3], method, Progress::NONE);
        assert!((none.unwrap().residuals[0] - 3.0_f64.sqrt()).abs() < 1e-15);
    }
}

proptest! {
    #[test]
    fn normal_equations_and_orthogonalization_agree(seed in any::<u64>(), m in 20_usize..60) {
        let mut next = random(seed);
        let n = 15;
        let mut triplets: Vec<_> = (0..n as u32).map(|j| (j, j, 2.0 + next())).collect();
        for _ in 0..4 * m {
            let place = ((next() * m as f64) as u32, (next() * n as f64) as u32);
            triplets.push((place.0, place.1, next() - 0.5));
        }
        let matrix = SparseMatrix::from_triplets(m, n, &triplets).unwrap();
        let rhs: Vec<f64> = (0..2 * m).map(|_| next() - 0.5).collect();
        let [a, b] =
            METHODS.map(|method| least_squares(&matrix, &rhs, method, Progress::NONE).unwrap());
        for (x, y) in a.solution.iter().zip(&b.solution) {
            prop_assert!((x - y).abs() < 1e-9, "{x} {y}");
        }
        prop_assert!(b.gradients.iter().all(|&gradient| gradient < 1e-13));
    }
}
