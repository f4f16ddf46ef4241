//! ZoomOut: refines a map of points by looking at more and more waves.
//!
//! ```text
//! for k = first, first + step, …, last
//!     C = Φ_N(k)⁺ Φ_M(k)[T]         the functional map that the points give
//!     T = nearest point of Φ_M(k) Cᵀ to each row of Φ_N(k)
//! ```
//!
//! - Input: eigenfunctions of both shapes, a rough map (a functional map of few waves, or points).
//! - Cost: (last − first)/step rounds of O(|M| · samples · k); the last takes all vertices.
//! - Guarantees: an exact map of isometric shapes stays. The report has the change in each round.
//! - Reference: Melzi, Ren, Rodolà, Sharma, Wonka and Ovsjanikov, "ZoomOut: spectral upsampling for
//!   efficient shape correspondence", SIGGRAPH Asia 2019.
//! - Departs from it: samples are every n-th vertex in order of number, not farthest points.

use dgp_mesh::{Progress, VertexId, VertexMap};

use super::{
    basis::Eigenbasis,
    functional_map::{FunctionalMap, map_of_points, nearest, solve_dense},
};
use crate::Error;

/// Options of [`zoomout`].
#[derive(Clone, Debug, PartialEq)]
pub struct ZoomOutOptions {
    /// How many waves more in each round. At least 1.
    pub step: usize,
    /// How many vertices of the second shape are looked at until the last round; more than all are all. At least
    /// as many as waves in the end.
    pub samples: usize,
}

impl Default for ZoomOutOptions {
    fn default() -> Self {
        ZoomOutOptions { step: 1, samples: 1000 }
    }
}

/// A refined map.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct ZoomOut {
    /// The vertex of the first shape for each vertex of the second.
    pub points: VertexMap<VertexId>,
    /// The map between all functions of both bases.
    pub map: FunctionalMap,
    /// In each round, how many of the samples went to another vertex than before.
    pub changed: Vec<usize>,
}

/// Refines `map`, which is between the first functions of both bases, up to all of their functions.
///
/// Errors: [`Error::InvalidOption`] if the step is 0, samples are fewer than functions, or the map is larger than
/// the bases or has no entries; [`Error::Sparse`] if samples do not tell functions apart; [`Error::Cancelled`].
pub fn zoomout(
    first: &Eigenbasis,
    second: &Eigenbasis,
    map: &FunctionalMap,
    options: &ZoomOutOptions,
    progress: Progress<'_>,
) -> Result<ZoomOut, Error> {
    let last = first.len().min(second.len());
    let start = map.columns.min(map.rows());
    if options.step == 0 {
        return Err(Error::option("step", 0.0, "at least 1"));
    }
    if start == 0 || map.columns > first.len() || map.rows() > second.len() {
        let expected = "between 1 and the number of functions";
        return Err(Error::option("map", start as f64, expected));
    }
    let n = second.vertex_count();
    let count = options.samples.min(n);
    if count < last {
        let expected = "at least the number of functions";
        return Err(Error::option("samples", count as f64, expected));
    }
    // Spread over all numbers.
    let samples: Vec<u32> =
        (0..count).map(|i| (i as u64 * n as u64 / count as u64) as u32).collect();
    let mut current = map.clone();
    let mut points = nearest_of(first, second, &current, &samples, Progress::NONE)?;
    let mut changed = Vec::new();
    let mut k = start;
    loop {
        progress.report(0.7 * (k - start) as f64 / (last - start).max(1) as f64)?;
        let (a, b) = (first.truncated(k), second.truncated(k));
        current = sampled_map(&a, &b, &samples, &points)?;
        let next = nearest_of(&a, &b, &current, &samples, Progress::NONE)?;
        changed.push(next.iter().zip(&points).filter(|(a, b)| a != b).count());
        points = next;
        if k == last {
            break;
        }
        k = (k + options.step).min(last);
    }
    let (a, b) = (first.truncated(last), second.truncated(last));
    let all: Vec<u32> = (0..n as u32).collect();
    let points = nearest_of(&a, &b, &current, &all, progress.part(0.7, 1.0))?;
    let points: VertexMap<VertexId> =
        points.into_iter().map(|v| VertexId::new(v as usize)).collect::<Vec<_>>().into();
    let map = map_of_points(&a, &b, &points);
    Ok(ZoomOut { points, map, changed })
}

fn nearest_of(
    first: &Eigenbasis,
    second: &Eigenbasis,
    map: &FunctionalMap,
    wanted: &[u32],
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    nearest(&first.rows(map.columns), &second.rows(map.rows()), map, wanted, progress)
}

/// C with Φ_N C ≈ Φ_M[T] at the samples, in the sense of least squares.
fn sampled_map(
    first: &Eigenbasis,
    second: &Eigenbasis,
    samples: &[u32],
    points: &[u32],
) -> Result<FunctionalMap, Error> {
    let k = first.len();
    let at = |basis: &Eigenbasis, i: usize, rows: &[u32]| -> Vec<f64> {
        let function = basis.function(i);
        rows.iter().map(|&v| function[v as usize]).collect()
    };
    let phi: Vec<Vec<f64>> = (0..k).map(|i| at(second, i, samples)).collect();
    let psi: Vec<Vec<f64>> = (0..k).map(|j| at(first, j, points)).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let gram: Vec<f64> = phi.iter().flat_map(|a| phi.iter().map(move |b| dot(a, b))).collect();
    let rhs: Vec<f64> = psi.iter().flat_map(|b| phi.iter().map(move |a| dot(a, b))).collect();
    let columns = solve_dense(k, &gram, &rhs)?;
    let entries = (0..k).flat_map(|i| columns.chunks(k).map(move |column| column[i])).collect();
    Ok(FunctionalMap { columns: k, entries })
}
