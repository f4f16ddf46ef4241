//! The smallest eigenpairs of one connected problem, and their proof.

use faer::Mat;

use super::{
    EigenOptions,
    dense::{product, symmetric_eigen, triangular_root},
    lanczos::Lanczos,
    pencil::{OwnMass, Pencil, norm},
    tall::{Tall, Weight},
};
use crate::{Cholesky, CholeskyOptions, Error, Progress, parallel};

/// Up to so many rows a dense solve is faster.
const DENSE: usize = 256;

/// How often to look for eigenvalues that were missed.
const SEARCHES: u64 = 8;

/// A gap of the spectrum that rounding does not close, relative to λ + σ.
const GAP: f64 = 1e-6;

/// Eigenpairs of a connected problem, and how good they are.
pub(super) struct Solved {
    pub(super) values: Vec<f64>,
    pub(super) vectors: Vec<f64>,
    pub(super) residuals: Vec<f64>,
    pub(super) orthogonality: f64,
    /// How many of the pairs are known to be the smallest there are.
    pub(super) confirmed: usize,
    pub(super) solves: usize,
    pub(super) restarts: usize,
}

/// The `wanted` smallest eigenpairs.
pub(super) fn solve(
    pencil: &Pencil,
    wanted: usize,
    options: &EigenOptions,
    progress: Progress<'_>,
) -> Result<Solved, Error> {
    let n = pencil.rows();
    let constant = if pencil.constant && wanted > 0 { constant(pencil) } else { Vec::new() };
    if wanted * n == constant.len() {
        return prove(pencil, constant, wanted, options, wanted, (0, 0));
    }
    if let OwnMass::Matrix(mass) = &pencil.mass {
        Cholesky::new(mass, &CholeskyOptions::default(), Progress::NONE)?;
    }
    let shifted = pencil.shifted(pencil.shift)?;
    let cholesky = Cholesky::new(&shifted, &CholeskyOptions::default(), progress.part(0.0, 0.1))?;
    if n <= DENSE || n <= 3 * wanted {
        let vectors = dense(pencil, constant, wanted)?;
        return prove(pencil, vectors, wanted, options, wanted, (0, 0));
    }
    let (mut solves, mut restarts) = (0, 0);
    let (mut vectors, mut missing) = (constant, 0);
    let mut next = f64::INFINITY;
    for search in 0..SEARCHES {
        let known = vectors.len() / n;
        let sought = wanted.saturating_sub(known).max(missing).min(n - known);
        let seed = options.seed.wrapping_add(search);
        let mut lanczos = Lanczos::new(pencil, &cholesky, &vectors, sought, seed);
        let span = if search == 0 { progress.part(0.1, 0.9) } else { progress.part(0.9, 0.9) };
        let limit = options.solves_per_pair.saturating_mul(sought.max(8));
        let found = lanczos.run(sought, options.tolerance / 10.0, limit, span)?;
        solves += lanczos.solves;
        restarts += lanczos.restarts;
        drop(lanczos);
        vectors.extend(found.vectors);
        next = found.next.min(next);
        let mut values = quotients(pencil, &vectors);
        values.sort_by(f64::total_cmp);
        let (below, bound) = gap(&values[..], wanted, next, pencil.shift);
        progress.report(0.9)?;
        let counted = if below == 0 {
            Some(0)
        } else {
            cholesky.symbolic().negative_eigenvalues(&pencil.shifted(-bound)?)
        };
        let counted = counted.unwrap_or(0);
        if counted <= below {
            let confirmed = if counted == below { below } else { 0 };
            let effort = (solves, restarts);
            return prove(pencil, vectors, wanted, options, confirmed, effort);
        }
        missing = counted - below;
        if search + 1 == SEARCHES || known + sought == n {
            return Err(Error::EigenvaluesMissed { found: below, counted, bound });
        }
    }
    unreachable!("the last search returns")
}

/// The constant of length one.
fn constant(pencil: &Pencil) -> Vec<f64> {
    let mut weighted = vec![1.0; pencil.rows()];
    pencil.weigh(&mut weighted);
    vec![1.0 / weighted.iter().sum::<f64>().sqrt(); pencil.rows()]
}

/// How many of the eigenvalues lie below the last gap among the first `wanted`, and a value in that gap.
fn gap(values: &[f64], wanted: usize, next: f64, shift: f64) -> (usize, f64) {
    (1..=wanted.min(values.len()))
        .rev()
        .find_map(|below| {
            let (low, high) = (values[below - 1], values.get(below).map_or(next, |v| v.min(next)));
            let size = low.abs() + shift;
            // Not far above: what lies in a wide gap above may not have been found yet.
            (high - low > GAP * size).then(|| (below, low + (0.5 * (high - low)).min(0.01 * size)))
        })
        .unwrap_or((0, 0.0))
}

/// All of the smallest eigenvectors by dense matrices: with M = R Rᵀ, those of R⁻¹ L R⁻ᵀ.
fn dense(pencil: &Pencil, constant: Vec<f64>, wanted: usize) -> Result<Vec<f64>, Error> {
    let n = pencil.rows();
    let failed =
        || Error::EigenNotConverged { converged: 0, count: wanted, residual: f64::NAN, solves: 0 };
    let mut laplacian: Mat<f64> = Mat::zeros(n, n);
    for (i, j, value) in pencil.laplacian.triplets() {
        laplacian[(i, j)] = value;
    }
    let inverse = match &pencil.mass {
        OwnMass::Identity => Mat::identity(n, n),
        OwnMass::Diagonal(masses) => {
            Mat::from_fn(n, n, |i, j| if i == j { 1.0 / masses[i].sqrt() } else { 0.0 })
        }
        OwnMass::Matrix(mass) => {
            let mut dense = Mat::zeros(n, n);
            for (i, j, value) in mass.triplets() {
                dense[(i, j)] = value;
            }
            triangular_root(dense.as_ref(), 0.0).ok_or_else(failed)?.1
        }
    };
    let mut reduced =
        product(product(inverse.as_ref(), laplacian.as_ref()).as_ref(), inverse.transpose());
    if !constant.is_empty() {
        // Moves the eigenvalue of the constant from 0 beyond the others, which the trace bounds.
        let mut weighted = constant.clone();
        pencil.weigh(&mut weighted);
        let weighted = Mat::from_fn(n, 1, |i, _| weighted[i]);
        let direction = product(inverse.as_ref(), weighted.as_ref());
        let size = 2.0 * (0..n).map(|i| reduced[(i, i)]).sum::<f64>();
        for j in 0..n {
            for i in 0..n {
                reduced[(i, j)] += size * direction[(i, 0)] * direction[(j, 0)];
            }
        }
    }
    let (_, vectors) = symmetric_eigen(reduced.as_ref()).ok_or_else(failed)?;
    let others = wanted - constant.len() / n;
    let vectors = product(inverse.transpose(), vectors.subcols(0, others));
    let mut all = constant;
    all.extend((0..others).flat_map(|j| (0..n).map(|i| vectors[(i, j)]).collect::<Vec<f64>>()));
    Ok(all)
}

/// λ of each of the vectors.
fn quotients(pencil: &Pencil, vectors: &[f64]) -> Vec<f64> {
    let n = pencil.rows();
    let mut values = vec![0.0; vectors.len() / n];
    parallel::map_chunks(&mut values, 1, |k, value| {
        let x = &vectors[k * n..(k + 1) * n];
        let mut weighted = x.to_vec();
        pencil.weigh(&mut weighted);
        value[0] = pencil.quotient(x, &weighted);
    });
    values
}

/// The `wanted` smallest of the pairs, in order, with their residuals; an error if one is too large.
fn prove(
    pencil: &Pencil,
    vectors: Vec<f64>,
    wanted: usize,
    options: &EigenOptions,
    confirmed: usize,
    (solves, restarts): (usize, usize),
) -> Result<Solved, Error> {
    let n = pencil.rows();
    let quotients = quotients(pencil, &vectors);
    let mut order: Vec<usize> = (0..quotients.len()).collect();
    order.sort_by(|&a, &b| quotients[a].total_cmp(&quotients[b]));
    order.truncate(wanted);
    let values: Vec<f64> = order.iter().map(|&k| quotients[k]).collect();
    let mut sorted = Vec::with_capacity(wanted * n);
    for &k in &order {
        sorted.extend_from_slice(&vectors[k * n..(k + 1) * n]);
    }
    drop(vectors);
    let results = parallel::map_chunks(&mut sorted, n, |start, x| {
        orient(x);
        residual(pencil, values[start / n], x)
    });
    let accurate = |&(residual, floor): &(f64, f64)| residual <= options.tolerance.max(floor);
    let converged = results.iter().filter(|pair| accurate(pair)).count();
    if converged < wanted {
        let bad = results.iter().filter(|pair| !accurate(pair)).map(|&(residual, _)| residual);
        let residual = bad.fold(0.0, |a: f64, b| if b <= a { a } else { b });
        return Err(Error::EigenNotConverged { converged, count: wanted, residual, solves });
    }
    let orthogonality = orthogonality(pencil, &sorted);
    let residuals = results.into_iter().map(|(residual, _)| residual).collect();
    Ok(Solved { values, vectors: sorted, residuals, orthogonality, confirmed, solves, restarts })
}

/// Makes the first of the entries that are largest, but for rounding, positive.
fn orient(x: &mut [f64]) {
    let largest = x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let first = x.iter().find(|x| x.abs() >= (1.0 - 1e-6) * largest);
    if first.is_some_and(|&x| x < 0.0) {
        for x in x {
            *x = -*x;
        }
    }
}

/// ‖L x − λ M x‖ / ((λ + σ) ‖M x‖), and how much of it rounding may be.
fn residual(pencil: &Pencil, value: f64, x: &[f64]) -> (f64, f64) {
    let mut weighted = x.to_vec();
    pencil.weigh(&mut weighted);
    let mut rest = vec![0.0; x.len()];
    pencil.laplacian.add_product(1.0, x, &mut rest);
    for (rest, weighted) in rest.iter_mut().zip(&weighted) {
        *rest -= value * weighted;
    }
    let size = (value.abs() + pencil.shift) * norm(&weighted);
    let rounding = 16.0 * f64::EPSILON * pencil.laplacian.row_norm() * norm(x);
    (norm(&rest) / size, rounding / size)
}

/// The largest |φᵢᵀ M φⱼ − δᵢⱼ|.
fn orthogonality(pencil: &Pencil, vectors: &[f64]) -> f64 {
    let n = pencil.rows();
    let count = vectors.len() / n;
    let mut plain = Tall::new(n, count);
    plain.set(0, vectors);
    match &pencil.mass {
        OwnMass::Identity => plain.distance_to_identity(Weight::Identity),
        OwnMass::Diagonal(masses) => plain.distance_to_identity(Weight::Diagonal(masses)),
        OwnMass::Matrix(mass) => {
            let mut weighted = Tall::new(n, count);
            weighted.set(0, &mass.transpose_product_many(vectors));
            plain.distance_to_identity(Weight::Product(&weighted))
        }
    }
}
