//! The heat kernel: how much of the heat put at x is at y after a time.
//!
//! ```text
//! k(t; x, y) = Σ e^(−λᵢ t) φᵢ(x) φᵢ(y)
//! ```
//!
//! - Input: eigenfunctions; a time in length², as long that those left out have died: λ t ≫ 1 for the last.
//! - Cost: O(k n) for a point, or for all points with themselves.
//! - Guarantees: symmetric; Σ m(y) k(t; x, y) = 1 on a connected surface.
//! - Reference: Sun, Ovsjanikov and Guibas, "A concise and provably informative multi-scale signature based
//!   on heat diffusion", SGP 2009.

use dgp_mesh::{VertexId, VertexMap};

use super::basis::Eigenbasis;
use crate::Error;

/// k(t; x, y) for each vertex y, in 1/area.
///
/// Errors: [`Error::InvalidOption`] if the time is negative or not finite.
pub fn heat_kernel(basis: &Eigenbasis, time: f64, x: VertexId) -> Result<VertexMap<f64>, Error> {
    let decay = decay(basis, time)?;
    let coefficients: Vec<f64> =
        decay.iter().enumerate().map(|(i, d)| d * basis.function(i)[x.index()]).collect();
    Ok(basis.combination(&coefficients).into())
}

/// k(t; x, x) for each vertex x, in 1/area: the heat kernel signature at time t.
///
/// Errors: [`Error::InvalidOption`] if the time is negative or not finite.
pub fn heat_kernel_diagonal(basis: &Eigenbasis, time: f64) -> Result<VertexMap<f64>, Error> {
    let mut sum = vec![0.0; basis.vertex_count()];
    for (i, d) in decay(basis, time)?.into_iter().enumerate() {
        sum.iter_mut().zip(basis.function(i)).for_each(|(sum, phi)| *sum += d * phi * phi);
    }
    Ok(sum.into())
}

/// e^(−λ t) for each eigenvalue.
fn decay(basis: &Eigenbasis, time: f64) -> Result<Vec<f64>, Error> {
    if !(time >= 0.0 && time.is_finite()) {
        return Err(Error::option("time", time, "finite and not negative"));
    }
    Ok(basis.values().iter().map(|lambda| (-lambda * time).exp()).collect())
}
