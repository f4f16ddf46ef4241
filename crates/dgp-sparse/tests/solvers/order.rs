//! Orders of elimination: permutations for any graph, little fill on surfaces, the same for any number
//! of threads.

use dgp_sparse::{
    CholeskyOptions, Error, Ordering, Progress, SparseMatrix, SymbolicCholesky, elimination_order,
};
use proptest::prelude::*;
use std::{ops::ControlFlow, sync::atomic};

use crate::common::surfaces::{gyroid, sphere, system};
use crate::common::{grid, random};

/// Entries of the factor.
fn fill(matrix: &SparseMatrix, ordering: Ordering) -> f64 {
    let options = CholeskyOptions { ordering };
    SymbolicCholesky::new(matrix, &options, Progress::NONE).unwrap().factor_entries() as f64
}

fn dissected(matrix: &SparseMatrix) -> Vec<u32> {
    elimination_order(matrix, &Ordering::Dissection, Progress::NONE).unwrap()
}

fn is_permutation(order: &[u32], n: usize) -> bool {
    let mut seen = vec![false; n];
    order.len() == n && order.iter().all(|&row| !std::mem::replace(&mut seen[row as usize], true))
}

/// A graph of `n` vertices with random edges.
fn random_graph(n: u32, edges: usize, seed: u64) -> SparseMatrix {
    let mut next = random(seed);
    let mut vertex = || (next() * f64::from(n)) as u32;
    let edges: Vec<_> = (0..edges).map(|_| (vertex(), vertex(), 1.0)).collect();
    SparseMatrix::from_edges(n as usize, &edges).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn any_graph_gets_a_permutation(n in 1..3000_u32, degree in 0..6_usize, seed in 0..1000_u64) {
        let matrix = random_graph(n, n as usize * degree / 2, seed);
        prop_assert!(is_permutation(&dissected(&matrix), n as usize));
    }
}

#[test]
fn odd_graphs_get_a_permutation() {
    let n = 3000;
    let clique: Vec<_> = (0..300).flat_map(|i| (0..i).map(move |j| (i, j, 1.0))).collect();
    let star: Vec<_> = (1..n).map(|i| (0, i, 1.0)).collect();
    let path: Vec<_> = (1..n).map(|i| (i - 1, i, 1.0)).collect();
    let pairs: Vec<_> = (0..n / 2).map(|i| (2 * i, 2 * i + 1, 1.0)).collect();
    let tree: Vec<_> = (1..n).map(|i| (i, (i - 1) / 2, 1.0)).collect();
    // Two cliques that share one vertex, and a long tail.
    let mut barbell = clique.clone();
    barbell.extend(clique.iter().map(|&(i, j, w)| (i + 299, j + 299, w)));
    barbell.extend((599..n).map(|i| (i - 1, i, 1.0)));
    for (name, edges) in [
        ("clique", clique),
        ("star", star),
        ("path", path),
        ("pairs", pairs),
        ("tree", tree),
        ("barbell", barbell),
        ("nothing", Vec::new()),
    ] {
        let matrix = SparseMatrix::from_edges(n as usize, &edges).unwrap();
        assert!(is_permutation(&dissected(&matrix), n as usize), "{name}");
    }
}

#[test]
fn fill_of_grids_stays_below_the_bound_of_george() {
    // 31/4 n log₂ k for a grid of n = k² vertices (George 1973).
    for k in [30, 64, 100, 150] {
        let n = (k * k) as f64;
        let bound = 7.75 * n * (k as f64).log2();
        let entries = fill(&grid(k, k), Ordering::Dissection);
        assert!(entries < 0.75 * bound, "{k}: {entries} {bound}");
    }
}

#[test]
fn fill_of_surfaces_is_near_that_of_minimum_degree_or_below() {
    for (name, surface, ratio) in [("sphere", sphere(6), 0.95), ("gyroid", gyroid(40), 0.9)] {
        let matrix = system(&surface);
        let ours = fill(&matrix, Ordering::Dissection);
        let minimum = fill(&matrix, Ordering::MinimumDegree);
        assert!(ours < ratio * minimum, "{name}: {ours} {minimum}");
    }
}

#[test]
fn numbering_hardly_matters() {
    let matrix = system(&sphere(5));
    let n = matrix.rows();
    let mut next = random(5);
    let mut order: Vec<u32> = (0..n as u32).collect();
    for i in (1..n).rev() {
        order.swap(i, (next() * (i + 1) as f64) as usize);
    }
    let shuffled = matrix.permuted(&order).unwrap();
    let (before, after) =
        (fill(&matrix, Ordering::Dissection), fill(&shuffled, Ordering::Dissection));
    assert!((after / before - 1.0).abs() < 0.15, "{before} {after}");
}

#[test]
fn order_and_solution_are_the_same_for_any_number_of_threads() {
    // Subtrees of both are shared among threads; of the second several coarse cuts are compared.
    for surface in [sphere(5), gyroid(40)] {
        let matrix = system(&surface);
        let rhs: Vec<f64> = (0..9 * matrix.rows()).map(|i| (i as f64).sin()).collect();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let options = CholeskyOptions { ordering: Ordering::Dissection };
                let cholesky =
                    dgp_sparse::Cholesky::new(&matrix, &options, Progress::NONE).unwrap();
                let order = cholesky.symbolic().order().to_vec();
                (order, cholesky.solve_many(&rhs).unwrap())
            })
        };
        let one = run(1);
        assert!(one == run(2));
        assert!(one == run(8));
    }
}

#[test]
fn dissection_stops_when_asked_to() {
    let matrix = system(&sphere(4));
    let reports = atomic::AtomicUsize::new(0);
    let count = |_| {
        reports.fetch_add(1, atomic::Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    elimination_order(&matrix, &Ordering::Dissection, Progress::new(&count)).unwrap();
    let reports = reports.into_inner();
    assert!(reports > 4, "{reports}");
    for stop_at in 1..=reports {
        let left = atomic::AtomicUsize::new(stop_at);
        let stop = |_| match left.fetch_sub(1, atomic::Ordering::Relaxed) {
            1 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let result = elimination_order(&matrix, &Ordering::Dissection, Progress::new(&stop));
        assert_eq!(result, Err(Error::Cancelled), "report {stop_at}");
    }
}
