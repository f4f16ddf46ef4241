//! Systems with constraints, unsymmetric ones, least squares, and iterations, on a sphere.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use dgp_sparse::{
    CholeskyOptions, ConjugateGradients, ConjugateGradientsOptions, EqualitySystem, FixedSystem,
    LeastSquaresMethod, Lu, Progress, SoftSystem, SparseMatrix, least_squares,
};

#[path = "../tests/solvers/common/mod.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod common;
use common::surfaces;

/// 40,962 vertices.
const LEVEL: usize = 6;
/// Every so many vertices one has a given value.
const STRIDE: usize = 1000;

fn benchmarks(criterion: &mut Criterion) {
    let matrix = surfaces::system(&surfaces::sphere(LEVEL));
    let n = matrix.rows();
    let rhs: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let none = Progress::NONE;
    constraints(criterion, &matrix, &rhs);
    let mut group = criterion.benchmark_group("systems");
    group.sample_size(10);
    group.bench_function(format!("lu/{n}"), |bencher| {
        bencher.iter(|| Lu::new(black_box(&matrix), none)?.solve(&rhs));
    });
    let tall = tall(&matrix);
    let of_tall = tall.product(&rhs);
    for (name, method) in
        [("qr", LeastSquaresMethod::Qr), ("normal_equations", LeastSquaresMethod::NormalEquations)]
    {
        group.bench_function(format!("least_squares_{name}/{n}"), |bencher| {
            bencher.iter(|| least_squares(black_box(&tall), &of_tall, method, none));
        });
    }
    group.bench_function(format!("conjugate_gradients/{n}"), |bencher| {
        let options = ConjugateGradientsOptions::default();
        bencher.iter(|| ConjugateGradients::new(black_box(&matrix), &options)?.solve(&rhs, none));
    });
    group.finish();
}

fn constraints(criterion: &mut Criterion, matrix: &SparseMatrix, rhs: &[f64]) {
    let n = matrix.rows();
    let (options, none) = (CholeskyOptions::default(), Progress::NONE);
    let given: Vec<u32> = (0..n as u32).step_by(STRIDE).collect();
    let values: Vec<f64> = given.iter().map(|&i| f64::from(i).cos()).collect();
    let rows: Vec<_> = given.iter().enumerate().map(|(k, &i)| (k as u32, i, 1.0)).collect();
    let equations = SparseMatrix::from_triplets(given.len(), n, &rows).expect("rows in range");
    let weights = vec![10.0; given.len()];
    let mut group = criterion.benchmark_group("constraints");
    group.sample_size(10);
    group.bench_function(format!("fixed/{n}"), |bencher| {
        bencher.iter(|| {
            FixedSystem::new(black_box(matrix), &given, &options, none)?.solve(rhs, &values)
        });
    });
    let system = FixedSystem::new(matrix, &given, &options, none).expect("a definite matrix");
    group.bench_function(format!("fixed_solve/{n}"), |bencher| {
        bencher.iter(|| system.solve(black_box(rhs), &values));
    });
    group.bench_function(format!("soft/{n}"), |bencher| {
        bencher.iter(|| {
            SoftSystem::new(black_box(matrix), &equations, &weights, &options, none)?
                .solve(rhs, &values)
        });
    });
    group.bench_function(format!("equality/{n}"), |bencher| {
        bencher.iter(|| {
            EqualitySystem::new(black_box(matrix), &equations, &options, none)?.solve(rhs, &values)
        });
    });
    group.finish();
}

/// The matrix with a second equation for every tenth unknown.
fn tall(matrix: &SparseMatrix) -> SparseMatrix {
    let n = matrix.rows();
    let more = (0..n).step_by(10).enumerate().map(|(k, i)| ((n + k) as u32, i as u32, 2.0));
    let all: Vec<(u32, u32, f64)> =
        matrix.triplets().map(|(i, j, value)| (i as u32, j as u32, value)).chain(more).collect();
    SparseMatrix::from_triplets(n + n.div_ceil(10), n, &all).expect("rows in range")
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
