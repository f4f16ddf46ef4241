//! Eigenpairs against closed forms, dense matrices, and matrices that have none.

use std::{f64::consts::PI, ops::ControlFlow, sync::Mutex};

use dgp_sparse::{
    EigenOptions, Eigenpairs, Error, Mass, Progress, Shift, SparseMatrix, eigenpairs,
};
use proptest::prelude::*;

use crate::common::{
    elements::{elements, flat_torus, icosphere},
    random,
};

fn pairs(laplacian: &SparseMatrix, mass: Mass<'_>, count: usize) -> Result<Eigenpairs, Error> {
    eigenpairs(laplacian, mass, count, &EigenOptions::default(), Progress::NONE)
}

/// What holds for every result.
fn check(pairs: &Eigenpairs) {
    assert!(pairs.values.is_sorted(), "{:?}", pairs.values);
    assert!(pairs.report.orthogonality < 1e-12, "{:?}", pairs.report);
    assert!(pairs.report.residuals.iter().all(|&r| r < 1e-9), "{:?}", pairs.report);
}

fn assert_close(actual: &[f64], expected: &[f64], relative: f64) {
    let scale = expected.iter().copied().find(|&value| value > 0.0).unwrap_or(1.0);
    for (i, (a, b)) in actual.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= relative * b.max(scale), "eigenvalue {i}: {a} is not {b}");
    }
}

fn smallest(mut values: Vec<f64>, count: usize) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.truncate(count);
    values
}

fn path(n: u32) -> SparseMatrix {
    let edges: Vec<_> = (1..n).map(|i| (i - 1, i, 1.0)).collect();
    SparseMatrix::from_edges(n as usize, &edges).unwrap()
}

#[test]
fn the_spectrum_of_a_sphere_converges_to_its_own() {
    // Largest relative errors for l = 1 to 6, found with SciPy on the same meshes.
    let expected = [
        (4, [3.2e-7, 1.42e-3, 3.6e-3, 6.7e-3, 1.19e-2, 1.57e-2]),
        (5, [2.4e-8, 3.6e-4, 9.1e-4, 1.7e-3, 3.0e-3, 3.9e-3]),
    ];
    for (level, errors) in expected {
        let elements = elements(&icosphere(level));
        let found = pairs(&elements.laplacian, Mass::Diagonal(&elements.lumped), 49).unwrap();
        check(&found);
        assert_eq!(found.values[0], 0.0);
        assert_eq!(found.report.zeros, 1);
        for (l, error) in (1..=6).zip(errors) {
            let exact = f64::from(l * (l + 1));
            let group = &found.values[(l * l) as usize..((l + 1) * (l + 1)) as usize];
            let worst = group.iter().map(|value| (exact - value) / exact).fold(0.0, f64::max);
            assert!((worst / error - 1.0).abs() < 0.05, "level {level}, l = {l}: {worst}");
        }
    }
}

#[test]
fn linear_elements_bound_the_spectrum_from_above_and_keep_clusters() {
    let elements = elements(&icosphere(5));
    let found = pairs(&elements.laplacian, Mass::Matrix(&elements.galerkin), 49).unwrap();
    check(&found);
    for (l, error) in (1..=6).zip([3.6e-4, 7.3e-4, 1.3e-3, 2.0e-3, 3.2e-3, 4.1e-3]) {
        let exact = f64::from(l * (l + 1));
        let group = &found.values[(l * l) as usize..((l + 1) * (l + 1)) as usize];
        let worst = group.iter().map(|value| (value - exact) / exact).fold(0.0, f64::max);
        assert!(group.iter().all(|&value| value > exact));
        assert!((worst / error - 1.0).abs() < 0.05, "l = {l}: {worst}");
        if l <= 2 {
            // By the symmetry of the icosahedron.
            assert!(group[group.len() - 1] - group[0] < 1e-12 * exact, "{group:?}");
        }
    }
}

#[test]
fn a_flat_torus_has_the_eigenvalues_of_the_discrete_fourier_transform() {
    for (n, count) in [(16_u32, 40), (33, 120)] {
        let elements = flat_torus(n);
        let size = f64::from(n);
        let wave = |i: u32| 2.0 - 2.0 * (2.0 * PI * f64::from(i) / size).cos();
        let exact = (0..n * n).map(|i| (wave(i % n) + wave(i / n)) * size * size);
        let exact = smallest(exact.collect(), count);
        let found = pairs(&elements.laplacian, Mass::Diagonal(&elements.lumped), count).unwrap();
        check(&found);
        assert_close(&found.values, &exact, 1e-12);
    }
}

#[test]
fn paths_and_cycles_have_theirs() {
    let n = 2000_u32;
    let exact: Vec<f64> =
        (0..30).map(|k| 4.0 * (PI * f64::from(k) / (2.0 * f64::from(n))).sin().powi(2)).collect();
    let found = pairs(&path(n), Mass::Identity, 30).unwrap();
    check(&found);
    assert_close(&found.values, &exact, 1e-9);

    let edges: Vec<_> = (0..n).map(|i| (i, (i + 1) % n, 1.0)).collect();
    let cycle = SparseMatrix::from_edges(n as usize, &edges).unwrap();
    let exact: Vec<f64> =
        (0..n).map(|k| 4.0 * (PI * f64::from(k) / f64::from(n)).sin().powi(2)).collect();
    let found = pairs(&cycle, Mass::Identity, 21).unwrap();
    check(&found);
    assert_close(&found.values, &smallest(exact, 21), 1e-9);
}

#[test]
fn multiplicities_beyond_the_block_are_found() {
    // A complete graph: n, as often as it has vertices but one. A star: 1, but for two.
    let n = 300_u32;
    let all: Vec<_> = (0..n).flat_map(|i| (0..i).map(move |j| (i, j, 1.0))).collect();
    let complete = SparseMatrix::from_edges(n as usize, &all).unwrap();
    let found = pairs(&complete, Mass::Identity, 40).unwrap();
    check(&found);
    assert!(found.values[1..].iter().all(|value| (value / 300.0 - 1.0).abs() < 1e-13));

    let edges: Vec<_> = (1..2000).map(|i| (0, i, 1.0)).collect();
    let star = SparseMatrix::from_edges(2000, &edges).unwrap();
    let found = pairs(&star, Mass::Identity, 50).unwrap();
    check(&found);
    assert!(found.values[1..].iter().all(|value| (value - 1.0).abs() < 1e-12));
}

#[test]
fn components_are_counted_by_zeros_and_share_their_spectrum() {
    // 150 cycles of 3 to 5 vertices, among them isolated vertices.
    let mut edges = Vec::new();
    let mut exact = Vec::new();
    let mut n = 0;
    for part in 0..150_u32 {
        let length = 3 + part % 3;
        edges.extend((0..length).map(|i| (n + i, n + (i + 1) % length, 1.0)));
        exact.extend(
            (0..length).map(|k| 4.0 * (PI * f64::from(k) / f64::from(length)).sin().powi(2)),
        );
        n += length;
        if part % 10 == 0 {
            exact.push(0.0);
            n += 1;
        }
    }
    let laplacian = SparseMatrix::from_edges(n as usize, &edges).unwrap();
    for count in [100, 165, 300] {
        let found = pairs(&laplacian, Mass::Identity, count).unwrap();
        check(&found);
        assert_eq!(found.report.components, 165);
        assert_eq!(found.report.zeros, count.min(165));
        assert!(found.values[..count.min(165)].iter().all(|&value| value == 0.0));
        assert_close(&found.values, &smallest(exact.clone(), count), 1e-13);
    }
    // Three spheres of which two are alike: what one has twice comes six times.
    let (points, faces) = icosphere(3);
    let count = points.len() as u32;
    let mut all = points.clone();
    all.extend(&points);
    all.extend(points.iter().map(|p| p.map(|x| 2.0 * x)));
    let faces: Vec<_> =
        (0..3).flat_map(|k| faces.iter().map(move |f| f.map(|i| i + k * count))).collect();
    let three = elements(&(all, faces));
    let found = pairs(&three.laplacian, Mass::Diagonal(&three.lumped), 25).unwrap();
    check(&found);
    assert_eq!(found.report.zeros, 3);
    // 3 zeros; the large one's 2/4 (3), 6/4 (5); 2 of both (6); its 12/4 (7).
    for (range, value) in [(3..6, 0.5), (6..11, 1.5), (11..17, 2.0), (17..24, 3.0)] {
        assert!(found.values[range].iter().all(|v| (v / value - 1.0).abs() < 0.02));
    }
}

#[test]
fn threads_change_no_bit() {
    let elements = elements(&icosphere(4));
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| pairs(&elements.laplacian, Mass::Diagonal(&elements.lumped), 30).unwrap())
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(8));
}

#[test]
fn scaling_by_powers_of_two_scales_exactly() {
    let elements = elements(&icosphere(4));
    let found = pairs(&elements.laplacian, Mass::Diagonal(&elements.lumped), 20).unwrap();
    for (of_laplacian, of_mass) in [(40, 0), (-300, 0), (0, 60), (13, -200)] {
        let laplacian = elements.laplacian.clone().scaled(2.0_f64.powi(of_laplacian));
        let lumped: Vec<f64> =
            elements.lumped.iter().map(|mass| mass * 2.0_f64.powi(of_mass)).collect();
        let scaled = pairs(&laplacian, Mass::Diagonal(&lumped), 20).unwrap();
        for (a, b) in found.values.iter().zip(&scaled.values) {
            assert_eq!(a * 2.0_f64.powi(of_laplacian - of_mass), *b);
        }
        for (a, b) in found.vectors.iter().zip(&scaled.vectors) {
            assert_eq!(a * 2.0_f64.powi(-of_mass / 2), *b);
        }
        assert_eq!(found.report.residuals, scaled.report.residuals);
    }
}

#[test]
fn a_long_basis_is_restarted_and_a_far_shift_costs_only_solves() {
    let n = 4000;
    let options = EigenOptions { shift: Shift::Value(1e-3), ..EigenOptions::default() };
    let found = eigenpairs(&path(n), Mass::Identity, 12, &options, Progress::NONE).unwrap();
    check(&found);
    assert!(found.report.restarts > 0, "{:?}", found.report);
    let exact: Vec<f64> =
        (0..12).map(|k| 4.0 * (PI * f64::from(k) / (2.0 * f64::from(n))).sin().powi(2)).collect();
    assert_close(&found.values, &exact, 1e-6);
}

#[test]
fn too_few_solves_are_an_error_that_tells_how_far_it_came() {
    let options =
        EigenOptions { shift: Shift::Value(1e3), solves_per_pair: 4, ..EigenOptions::default() };
    let result = eigenpairs(&path(3000), Mass::Identity, 10, &options, Progress::NONE);
    let Err(Error::EigenNotConverged { converged, count: 9, residual, solves }) = result else {
        panic!("{result:?}");
    };
    assert!(converged < 9 && residual > 1e-10 && solves >= 36);
}

#[test]
fn what_has_no_eigenpairs_is_named() {
    let laplacian = path(4);
    let of = |mass: &[f64]| pairs(&laplacian, Mass::Diagonal(mass), 2).map(|found| found.values);
    assert_eq!(of(&[1.0, 1.0, 0.0, 1.0]), Err(Error::MassNotPositive { row: 2, mass: 0.0 }));
    assert_eq!(of(&[1.0, -1.0, 0.0, 1.0]), Err(Error::MassNotPositive { row: 1, mass: -1.0 }));
    assert!(matches!(of(&[1.0, 1.0, f64::NAN, 1.0]), Err(Error::VectorNotFinite { index: 2, .. })));
    assert!(matches!(of(&[1.0]), Err(Error::Length { actual: 1, expected: 4, .. })));
    let too_many = pairs(&laplacian, Mass::Identity, 5).unwrap_err();
    assert_eq!(too_many, Error::TooManyEigenpairs { count: 5, rows: 4 });
    let nan = SparseMatrix::from_triplets(2, 2, &[(0, 0, f64::NAN), (1, 1, 1.0)]).unwrap();
    assert!(matches!(pairs(&nan, Mass::Identity, 1), Err(Error::NotFinite { row: 0, .. })));
    let lower = SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 0, 1.0)]).unwrap();
    assert!(matches!(pairs(&lower, Mass::Identity, 1), Err(Error::NotSymmetric { .. })));
    let indefinite =
        SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, 9.0), (1, 0, 9.0)]);
    let result = pairs(&indefinite.unwrap(), Mass::Identity, 1);
    assert!(matches!(result, Err(Error::NotPositiveDefinite { .. })), "{result:?}");
    let wrong_mass =
        SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, 2.0), (1, 0, 2.0)]);
    let result = pairs(&path(2), Mass::Matrix(&wrong_mass.unwrap()), 2);
    assert!(matches!(result, Err(Error::NotPositiveDefinite { .. })), "{result:?}");
    for tolerance in [0.0, -1.0, f64::NAN] {
        let options = EigenOptions { tolerance, ..EigenOptions::default() };
        let result = eigenpairs(&laplacian, Mass::Identity, 1, &options, Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidOption { name: "tolerance", .. })));
        let options = EigenOptions { shift: Shift::Value(tolerance), ..EigenOptions::default() };
        let result = eigenpairs(&laplacian, Mass::Identity, 1, &options, Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidOption { name: "shift", .. })));
    }
}

#[test]
fn nothing_and_little_is_answered() {
    assert_eq!(pairs(&SparseMatrix::zeros(0, 0), Mass::Identity, 0).unwrap().values, [0.0; 0]);
    assert_eq!(pairs(&path(3), Mass::Identity, 0).unwrap().values, [0.0; 0]);
    let single = SparseMatrix::from_diagonal(&[6.0]);
    let found = pairs(&single, Mass::Diagonal(&[2.0]), 1).unwrap();
    assert!((found.values[0] - 3.0).abs() < 1e-15);
    let zero = pairs(&SparseMatrix::from_edges(2, &[]).unwrap(), Mass::Diagonal(&[4.0, 1.0]), 2);
    let zero = zero.unwrap();
    assert_eq!((zero.values, zero.vectors), (vec![0.0, 0.0], vec![0.5, 0.0, 0.0, 1.0]));
}

#[test]
fn it_stops_when_asked_to_at_every_report() {
    let laplacian = path(1000);
    let reports = Mutex::new(Vec::new());
    let count = |done: f64| {
        reports.lock().unwrap().push(done);
        ControlFlow::Continue(())
    };
    let options = EigenOptions::default();
    let _ = eigenpairs(&laplacian, Mass::Identity, 5, &options, Progress::new(&count)).unwrap();
    let reports = reports.into_inner().unwrap();
    assert!(reports.is_sorted() && reports.len() > 5, "{reports:?}");
    assert_eq!(reports.last(), Some(&1.0));
    for stop_at in 0..reports.len() {
        let seen = Mutex::new(0);
        let stop = |_: f64| {
            let mut seen = seen.lock().unwrap();
            *seen += 1;
            if *seen > stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let result = eigenpairs(&laplacian, Mass::Identity, 5, &options, Progress::new(&stop));
        assert_eq!(result, Err(Error::Cancelled));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Large enough for Lanczos; against the dense solver, which takes over where many are asked for.
    #[test]
    fn few_pairs_by_lanczos_equal_those_of_the_dense_solver(
        seed in any::<u64>(), n in 300_usize..400, extra in 0_usize..600, full in any::<bool>()
    ) {
        let mut next = random(seed);
        let mut edges: Vec<(u32, u32, f64)> = Vec::new();
        for k in 0..n + extra {
            let i = (next() * n as f64) as u32;
            let j = if k % 2 == 0 { (next() * n as f64) as u32 } else { (i + 1) % n as u32 };
            edges.push((i, j, 0.1 + next()));
        }
        let mut laplacian = SparseMatrix::from_edges(n, &edges).unwrap();
        if seed % 3 == 0 {
            let potential: Vec<f64> = (0..n).map(|_| 0.01 * next()).collect();
            laplacian = laplacian.plus_diagonal(&potential).unwrap();
        }
        let masses: Vec<f64> = (0..n).map(|_| 0.1 + next()).collect();
        let springs: Vec<_> = edges.iter().map(|&(i, j, w)| (i, j, 0.05 * w)).collect();
        let matrix = SparseMatrix::from_edges(n, &springs).unwrap().plus_diagonal(&masses).unwrap();
        let mass = if full { Mass::Matrix(&matrix) } else { Mass::Diagonal(&masses) };
        let few = pairs(&laplacian, mass, 15).unwrap();
        let many = pairs(&laplacian, mass, n).unwrap();
        check(&few);
        check(&many);
        prop_assert_eq!(few.report.zeros, many.report.zeros.min(15));
        let scale = many.values.iter().copied().find(|&value| value > 1e-9).unwrap();
        for (a, b) in few.values.iter().zip(&many.values) {
            prop_assert!((a - b).abs() <= 1e-10 * b.max(scale), "{} {}", a, b);
        }
    }
}
