//! Functional maps: a correspondence as a small matrix between the waves of two shapes.
//!
//! ```text
//! T: N → M point to point     f ↦ f ∘ T     C = Φ_Nᵀ A_N Π Φ_M     (k × k, Π picks row T(y) for each y)
//!
//! from functions a ↔ b that correspond:  min ‖C A − B‖² + μ ‖C Λ_M − Λ_N C‖²
//! ```
//!
//! - Input: eigenfunctions of both shapes, functions on both that correspond.
//! - Cost: k systems of k unknowns; back to points O(|M| |N| k).
//! - Guarantees: the minimum of the energy. An isometry gives an orthogonal C that commutes with Λ; the
//!   identity of a shape on itself gives the identity.
//! - Reference: Ovsjanikov, Ben-Chen, Solomon, Butscher and Guibas, "Functional maps: a flexible
//!   representation of maps between shapes", SIGGRAPH 2012.

use dgp_mesh::{Progress, VertexId, VertexMap, parallel};
use dgp_sparse::{Cholesky, CholeskyOptions, SparseMatrix};

use super::basis::Eigenbasis;
use crate::{Error, solve::with_progress};

/// A linear map from functions on one shape to functions on another.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionalMap {
    /// How many functions of the first shape there are.
    pub columns: usize,
    /// The matrix, row after row: a row for each function of the second shape.
    pub entries: Vec<f64>,
}

impl FunctionalMap {
    /// The map of `size` functions of a shape onto themselves.
    pub fn identity(size: usize) -> Self {
        let mut entries = vec![0.0; size * size];
        entries.iter_mut().step_by(size + 1).for_each(|entry| *entry = 1.0);
        FunctionalMap { columns: size, entries }
    }

    /// How many functions of the second shape there are.
    pub fn rows(&self) -> usize {
        self.entries.len().checked_div(self.columns).unwrap_or(0)
    }

    /// The entry of row `i` and column `j`.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.entries[i * self.columns + j]
    }

    /// The coefficients on the second shape of the function with these coefficients on the first.
    ///
    /// # Panics
    /// If there is not a coefficient per column.
    pub fn apply(&self, coefficients: &[f64]) -> Vec<f64> {
        assert_eq!(coefficients.len(), self.columns, "a coefficient per column");
        let dot = |row: &[f64]| row.iter().zip(coefficients).map(|(c, a)| c * a).sum();
        self.entries.chunks(self.columns.max(1)).map(dot).collect()
    }

    /// The largest entry of |CᵀC − 1|: 0 for maps that keep areas.
    pub fn orthogonality_defect(&self) -> f64 {
        let mut worst = 0.0_f64;
        for i in 0..self.columns {
            for j in i..self.columns {
                let sum: f64 = (0..self.rows()).map(|r| self.get(r, i) * self.get(r, j)).sum();
                worst = worst.max((sum - f64::from(u8::from(i == j))).abs());
            }
        }
        worst
    }
}

/// Options of [`functional_map`].
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionalMapOptions {
    /// How much C must commute with the Laplacians beside the functions, μ; eigenvalues are taken relative to the
    /// largest. Positive.
    pub commutativity: f64,
}

impl Default for FunctionalMapOptions {
    fn default() -> Self {
        FunctionalMapOptions { commutativity: 1e-3 }
    }
}

/// The map between all functions of both bases that takes each of `from` to its partner in `to` as well as it
/// can.
///
/// Functions are scaled to norm 1, so that all count the same.
/// Errors: [`Error::InvalidOption`] unless μ is positive and finite, [`Error::Sparse`] for values that are not
/// finite, [`Error::Cancelled`].
///
/// # Panics
/// If there are not as many functions on both sides, or one has not a value per vertex.
pub fn functional_map(
    first: &Eigenbasis,
    second: &Eigenbasis,
    from: &[VertexMap<f64>],
    to: &[VertexMap<f64>],
    options: &FunctionalMapOptions,
    progress: Progress<'_>,
) -> Result<FunctionalMap, Error> {
    assert_eq!(from.len(), to.len(), "functions in pairs");
    let mu = options.commutativity;
    if !(mu > 0.0 && mu.is_finite()) {
        return Err(Error::option("commutativity", mu, "positive and finite"));
    }
    let (columns, rows) = (first.len(), second.len());
    let unit = |basis: &Eigenbasis, f: &VertexMap<f64>| {
        let mut c = basis.coefficients(f.values());
        let norm = c.iter().map(|c| c * c).sum::<f64>().sqrt();
        if norm > 0.0 {
            for c in &mut c {
                *c /= norm;
            }
        }
        c
    };
    let a: Vec<Vec<f64>> = from.iter().map(|f| unit(first, f)).collect();
    let b: Vec<Vec<f64>> = to.iter().map(|f| unit(second, f)).collect();
    let gram = |i: usize, j: usize| a.iter().map(|a| a[i] * a[j]).sum::<f64>();
    let products: Vec<f64> = (0..columns)
        .flat_map(|j| (0..columns).map(move |i| (i, j)))
        .map(|(i, j)| gram(i, j))
        .collect();
    let last = |basis: &Eigenbasis| basis.values().last().copied().unwrap_or(0.0);
    let scale = last(first).max(last(second));
    let mut entries = Vec::with_capacity(rows * columns);
    for (i, &lambda) in second.values().iter().enumerate() {
        progress.report(i as f64 / rows as f64)?;
        // Row i is a system of its own: (A Aᵀ + μ diag (λ_M − λ_N(i))²) cᵀ = A bᵀ.
        let mut matrix = products.clone();
        for (j, &other) in first.values().iter().enumerate() {
            let gap = if scale > 0.0 { (other - lambda) / scale } else { 0.0 };
            // A trace of μ where the gap is nothing, so that the system has one solution.
            matrix[j * columns + j] += mu * (gap * gap).max(1e-6);
        }
        let rhs: Vec<f64> =
            (0..columns).map(|j| a.iter().zip(&b).map(|(a, b)| a[j] * b[i]).sum()).collect();
        entries.extend(solve_dense(columns, &matrix, &rhs)?);
    }
    Ok(FunctionalMap { columns, entries })
}

/// The map of functions that a map of points gives: `points` has the vertex of the first shape for each vertex
/// of the second.
///
/// # Panics
/// If there is not a point per vertex of the second shape.
pub fn map_of_points(
    first: &Eigenbasis,
    second: &Eigenbasis,
    points: &VertexMap<VertexId>,
) -> FunctionalMap {
    assert_eq!(points.len(), second.vertex_count(), "a point per vertex of the second shape");
    let columns: Vec<Vec<f64>> = (0..first.len())
        .map(|j| {
            let function = first.function(j);
            let pulled: Vec<f64> = points.values().iter().map(|v| function[v.index()]).collect();
            second.coefficients(&pulled)
        })
        .collect();
    let entries =
        (0..second.len()).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
    FunctionalMap { columns: first.len(), entries }
}

/// The vertex of the first shape that `map` takes nearest to each vertex of the second.
///
/// Errors: [`Error::Cancelled`].
///
/// # Panics
/// If the map is of other numbers of functions, or the first shape has no vertices and the second has.
pub fn point_map(
    first: &Eigenbasis,
    second: &Eigenbasis,
    map: &FunctionalMap,
    progress: Progress<'_>,
) -> Result<VertexMap<VertexId>, Error> {
    assert_eq!((map.rows(), map.columns), (second.len(), first.len()), "a map of these bases");
    let all: Vec<u32> = (0..second.vertex_count() as u32).collect();
    let points = nearest(&first.rows(map.columns), &second.rows(map.rows()), map, &all, progress)?;
    Ok(points.into_iter().map(|v| VertexId::new(v as usize)).collect::<Vec<_>>().into())
}

/// The index of the point of `first` (rows of functions at vertices) whose image under `map` is nearest to each
/// of the `wanted` rows of `second`.
pub(super) fn nearest(
    first: &[f64],
    second: &[f64],
    map: &FunctionalMap,
    wanted: &[u32],
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    let (k, rows) = (map.columns, map.rows());
    // Images of all points, and half their squares: |p − q|² / 2 = |p|²/2 − p·q + …
    let images: Vec<f64> = first.chunks(k.max(1)).flat_map(|point| map.apply(point)).collect();
    let halves: Vec<f64> =
        images.chunks(rows.max(1)).map(|p| 0.5 * p.iter().map(|x| x * x).sum::<f64>()).collect();
    assert!(!halves.is_empty() || wanted.is_empty(), "points to choose from");
    let block = 64;
    let blocks = parallel::map_blocks(wanted.len(), block, |range| {
        progress.report(range.start as f64 / wanted.len() as f64)?;
        let queries = &wanted[range];
        let mut best = vec![(f64::INFINITY, 0_u32); queries.len()];
        // Points in blocks that stay in the cache while all queries go by.
        for (start, points) in images.chunks(rows.max(1) * 256).enumerate() {
            for (best, &q) in best.iter_mut().zip(queries) {
                let query = &second[q as usize * rows..(q as usize + 1) * rows];
                for (i, point) in points.chunks(rows.max(1)).enumerate() {
                    let index = start * 256 + i;
                    let value = halves[index] - dot(point, query);
                    if value < best.0 {
                        *best = (value, index as u32);
                    }
                }
            }
        }
        Ok::<_, Error>(best.into_iter().map(|(_, index)| index).collect::<Vec<_>>())
    });
    let mut result = Vec::with_capacity(wanted.len());
    for block in blocks {
        result.extend(block?);
    }
    Ok(result)
}

/// In four sums, which compilers turn into vectors.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a4.iter().zip(b4) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Solves a full positive definite system, given column after column, for right-hand sides one after the other.
pub(super) fn solve_dense(n: usize, matrix: &[f64], rhs: &[f64]) -> Result<Vec<f64>, Error> {
    let entry = |(at, &value): (usize, &f64)| ((at % n) as u32, (at / n) as u32, value);
    let triplets: Vec<(u32, u32, f64)> = matrix.iter().enumerate().map(entry).collect();
    let matrix = SparseMatrix::from_triplets(n, n, &triplets)?;
    let factor = with_progress(Progress::NONE, |progress| {
        Cholesky::new(&matrix, &CholeskyOptions::default(), progress)
    })?;
    Ok(factor.solve_many(rhs)?)
}
