//! Spectral compression: a shape as a few coefficients of the waves of its connectivity.
//!
//! ```text
//! cᵢ = ⟨position, φᵢ⟩    i < k       kept, each rounded to a whole number of steps
//! position ≈ Σ step · round(cᵢ / step) · φᵢ
//! ```
//!
//! The receiver has the connectivity, so the waves must be those of the graph alone (the uniform Laplacian,
//! masses 1). Low waves carry the shape, high ones the noise.
//!
//! - Input: a mesh, eigenfunctions of its graph, how many coefficients, how many bits.
//! - Cost: O(k n).
//! - Guarantees: with all eigenfunctions and many bits the mesh comes back; without rounding the error never
//!   rises with k. Bits are counted by the entropy of the rounded numbers, which arithmetic coding attains.
//! - Reference: Karni and Gotsman, "Spectral compression of mesh geometry", SIGGRAPH 2000.
//! - Departs from it: the whole mesh has one basis, where the paper cuts it into patches of some hundred
//!   vertices because it computes all eigenvectors.

use std::collections::BTreeMap;

use dgp_mesh::{DVec3, Mesh, Progress, VertexMap, measure::bounding_box};

use super::basis::Eigenbasis;
use crate::Error;

/// Options of [`compress`] and [`rate_distortion`].
#[derive(Clone, Debug, PartialEq)]
pub struct CompressionOptions {
    /// Bits of the largest coefficient but the constant one: the step is its size / 2^(bits − 1). From 2 to 52.
    pub bits: u32,
}

impl Default for CompressionOptions {
    fn default() -> Self {
        CompressionOptions { bits: 14 }
    }
}

/// A mesh as whole numbers of steps.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Compressed {
    /// The rounded coefficients of x, y and z, wave after wave.
    pub coefficients: Vec<[i64; 3]>,
    /// What a step is worth.
    pub step: f64,
    /// Bits for all coefficients after arithmetic coding.
    pub bits: f64,
    /// The positions that come back.
    pub positions: VertexMap<DVec3>,
}

/// A point of the rate–distortion curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatePoint {
    /// How many coefficients of each coordinate are kept.
    pub coefficients: usize,
    /// Bits per vertex after arithmetic coding.
    pub bits_per_vertex: f64,
    /// Root of the mean square distance between old and new vertices, in units of length.
    pub distance: f64,
    /// The same for the difference of each vertex from the mean of its neighbors: what the eye sees.
    pub roughness: f64,
    /// The distance over the diagonal of the bounding box.
    pub relative: f64,
}

/// The first `count` coefficients of the positions, rounded.
///
/// Errors: [`Error::InvalidOption`] if there are fewer functions or bits are out of range.
///
/// # Panics
/// If the basis is of another number of vertices.
pub fn compress(
    mesh: &Mesh,
    basis: &Eigenbasis,
    count: usize,
    options: &CompressionOptions,
) -> Result<Compressed, Error> {
    let exact = coefficients(mesh, basis);
    rounded(basis, &exact, count, options)
}

/// Rate and distortion for each of these numbers of coefficients.
///
/// Errors: those of [`compress`], [`Error::Cancelled`].
///
/// # Panics
/// If the basis is of another number of vertices.
pub fn rate_distortion(
    mesh: &Mesh,
    basis: &Eigenbasis,
    counts: &[usize],
    options: &CompressionOptions,
    progress: Progress<'_>,
) -> Result<Vec<RatePoint>, Error> {
    let exact = coefficients(mesh, basis);
    let diagonal = bounding_box(mesh).map_or(0.0, |b| b.diagonal());
    let old = differences(mesh, mesh.positions());
    let mut points = Vec::with_capacity(counts.len());
    for (i, &count) in counts.iter().enumerate() {
        progress.report(i as f64 / counts.len() as f64)?;
        let compressed = rounded(basis, &exact, count, options)?;
        let new = differences(mesh, &compressed.positions);
        let distance = root_mean_square(mesh.positions(), &compressed.positions);
        points.push(RatePoint {
            coefficients: count,
            bits_per_vertex: compressed.bits / mesh.vertex_count().max(1) as f64,
            distance,
            roughness: root_mean_square(&old, &new),
            relative: if diagonal > 0.0 { distance / diagonal } else { 0.0 },
        });
    }
    Ok(points)
}

/// The coefficients of x, y and z, wave after wave.
fn coefficients(mesh: &Mesh, basis: &Eigenbasis) -> Vec<[f64; 3]> {
    assert_eq!(basis.vertex_count(), mesh.vertex_count(), "a basis of this mesh");
    let [x, y, z] = [0, 1, 2].map(|k| {
        let values: Vec<f64> = mesh.positions().values().iter().map(|p| p[k]).collect();
        basis.coefficients(&values)
    });
    (0..basis.len()).map(|i| [x[i], y[i], z[i]]).collect()
}

fn rounded(
    basis: &Eigenbasis,
    exact: &[[f64; 3]],
    count: usize,
    options: &CompressionOptions,
) -> Result<Compressed, Error> {
    if count > exact.len() {
        let expected = "no more than there are functions";
        return Err(Error::option("count", count as f64, expected));
    }
    if !(2..=52).contains(&options.bits) {
        return Err(Error::option("bits", f64::from(options.bits), "between 2 and 52"));
    }
    // Constant waves only tell where the parts are; their coefficients need not fit into the bits.
    let waves = &exact[basis.zero_count().min(count)..count];
    let largest = waves.iter().flatten().fold(0.0_f64, |max, c| max.max(c.abs()));
    let step = if largest > 0.0 {
        largest / 2_f64.powi(options.bits as i32 - 1)
    } else {
        // Nothing but points.
        let largest = exact.iter().flatten().fold(0.0_f64, |max, c| max.max(c.abs()));
        if largest > 0.0 { largest * 2_f64.powi(1 - options.bits as i32) } else { 1.0 }
    };
    let whole: Vec<[i64; 3]> =
        exact[..count].iter().map(|c| c.map(|c| (c / step).round() as i64)).collect();
    let coordinate = |k: usize| {
        let values: Vec<f64> = whole.iter().map(|c| step * c[k] as f64).collect();
        basis.combination(&values)
    };
    let [x, y, z] = [0, 1, 2].map(coordinate);
    let positions: Vec<DVec3> =
        (0..basis.vertex_count()).map(|v| DVec3::new(x[v], y[v], z[v])).collect();
    Ok(Compressed {
        bits: entropy_bits(&whole),
        coefficients: whole,
        step,
        positions: positions.into(),
    })
}

/// What arithmetic coding needs for these numbers: n log₂ n − Σ m log₂ m over the m equal ones of each kind.
fn entropy_bits(numbers: &[[i64; 3]]) -> f64 {
    let mut counts = BTreeMap::new();
    for &number in numbers.iter().flatten() {
        *counts.entry(number).or_insert(0_usize) += 1;
    }
    let term = |count: usize| count as f64 * (count as f64).log2();
    let total = 3 * numbers.len();
    if total == 0 {
        return 0.0;
    }
    (term(total) - counts.into_values().map(term).sum::<f64>()).max(0.0)
}

/// Each vertex less the mean of its neighbors.
fn differences(mesh: &Mesh, positions: &VertexMap<DVec3>) -> VertexMap<DVec3> {
    mesh.map_vertices(|v| {
        let (mut sum, mut count) = (DVec3::ZERO, 0);
        for w in mesh.vertex_neighbors(v) {
            sum += positions[w];
            count += 1;
        }
        if count == 0 { DVec3::ZERO } else { positions[v] - sum / f64::from(count) }
    })
}

fn root_mean_square(a: &VertexMap<DVec3>, b: &VertexMap<DVec3>) -> f64 {
    // Divided by the largest, whose square might not be a number.
    let distances: Vec<f64> =
        a.values().iter().zip(b.values()).map(|(a, b)| (*a - *b).length()).collect();
    let largest = distances.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    let squares: f64 = distances.iter().map(|d| (d / largest) * (d / largest)).sum();
    largest * (squares / distances.len() as f64).sqrt()
}
