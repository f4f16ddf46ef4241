//! Order, factor and solve of L + M, on spheres of three sizes and on a surface of high genus.

use std::{hint::black_box, sync::Arc};

use criterion::{Criterion, criterion_group, criterion_main};
use dgp_sparse::{
    Cholesky, CholeskyOptions, Ordering, Progress, SparseMatrix, SymbolicCholesky,
    elimination_order,
};

#[path = "../tests/solvers/common/mod.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod common;
use common::surfaces;

/// The spheres have 10,242, 163,842 and 655,362 vertices.
const LEVELS: [usize; 3] = [5, 7, 8];
/// The gyroid has about 236,000.
const CELLS: u32 = 93;

fn benchmarks(criterion: &mut Criterion) {
    assemble(criterion);
    for level in LEVELS {
        steps(criterion, "sphere", &surfaces::system(&surfaces::sphere(level)));
    }
    steps(criterion, "gyroid", &surfaces::system(&surfaces::gyroid(CELLS)));
}

fn assemble(criterion: &mut Criterion) {
    let (n, faces) = surfaces::sphere(LEVELS[2]);
    let edges = surfaces::edges_of(&faces);
    let mut group = criterion.benchmark_group("assemble");
    group.sample_size(10);
    group.bench_function(format!("sphere/{n}"), |bencher| {
        bencher.iter(|| SparseMatrix::from_edges(n, black_box(&edges)));
    });
    group.finish();
}

fn steps(criterion: &mut Criterion, name: &str, matrix: &SparseMatrix) {
    let n = matrix.rows();
    let options = CholeskyOptions::default();
    let none = Progress::NONE;
    let mut group = criterion.benchmark_group("cholesky");
    group.sample_size(10);
    for (kind, ordering) in
        [("dissection", Ordering::Dissection), ("minimum_degree", Ordering::MinimumDegree)]
    {
        group.bench_function(format!("{kind}/{name}/{n}"), |bencher| {
            bencher.iter(|| elimination_order(black_box(matrix), &ordering, none));
        });
    }
    group.bench_function(format!("analyze/{name}/{n}"), |bencher| {
        bencher.iter(|| SymbolicCholesky::new(black_box(matrix), &options, none));
    });
    let symbolic = SymbolicCholesky::new(matrix, &options, none).expect("a symmetric matrix");
    let mut cholesky =
        Cholesky::with_symbolic(&Arc::new(symbolic), matrix, none).expect("a definite matrix");
    group.bench_function(format!("refactor/{name}/{n}"), |bencher| {
        bencher.iter(|| cholesky.refactor(black_box(matrix), none));
    });
    for count in [1, 3, 8] {
        let rhs: Vec<f64> = (0..n * count).map(|i| (i as f64).sin()).collect();
        group.bench_function(format!("solve_{count}/{name}/{n}"), |bencher| {
            bencher.iter(|| cholesky.solve_many(black_box(&rhs)));
        });
    }
    group.bench_function(format!("all/{name}/{n}"), |bencher| {
        let rhs = vec![1.0; n];
        bencher.iter(|| Cholesky::new(black_box(matrix), &options, none)?.solve(&rhs));
    });
    group.finish();
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
