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

/// `count` times, even in their logarithms, over which the signatures of these functions tell places apart: from
/// 4 ln 10/λ of the last function, when it has faded to 10⁻⁴, to the same of the first that is not constant.
/// In length².
///
/// Errors: [`Error::InvalidOption`] if `count` is 0, or no function has an eigenvalue above 0.
pub fn signature_times(basis: &Eigenbasis, count: usize) -> Result<Vec<f64>, Error> {
    if count == 0 {
        return Err(Error::option("count", 0.0, "at least 1"));
    }
    let waves = &basis.values()[basis.zero_count()..];
    let (Some(&first), Some(&last)) = (waves.first(), waves.last()) else {
        let (count, expected) = (basis.len() as f64, "more than the number of parts");
        return Err(Error::option("functions", count, expected));
    };
    let faded = 4.0 * std::f64::consts::LN_10;
    let (shortest, longest) = ((faded / last).ln(), (faded / first).ln());
    // One time alone is the middle.
    let part = |i: usize| if count == 1 { 0.5 } else { i as f64 / (count - 1) as f64 };
    Ok((0..count).map(|i| (shortest + part(i) * (longest - shortest)).exp()).collect())
}

/// e^(−λ t) for each eigenvalue.
fn decay(basis: &Eigenbasis, time: f64) -> Result<Vec<f64>, Error> {
    if !(time >= 0.0 && time.is_finite()) {
        return Err(Error::option("time", time, "finite and not negative"));
    }
    Ok(basis.values().iter().map(|lambda| (-lambda * time).exp()).collect())
}
