//! Taubin smoothing: removes noise without shrinking the surface.
//!
//! An iteration is a step that smooths and one that undoes the shrinking:
//!
//! ```text
//! x ← x + λ Δx        Δx(v) = mean of x(w) over the neighbors w of v, minus x(v)
//! x ← x + μ Δx        μ < −λ < 0
//! ```
//!
//! A wave of frequency k ∈ [0, 2] is scaled by f(k) = (1 − λk)(1 − μk). That is 1 at k = 0 and at the
//! pass band k = 1/λ + 1/μ; longer waves are shape and grow a little, shorter waves are noise and fade.
//!
//! - Input: any polygon mesh.
//! - Cost: twice that of [`uniform`](super::uniform).
//! - Guarantees: no wave beyond the pass band grows; options for which one would are refused.
//! - Reference: Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995.
//! - Departs from it: rims of holes are fixed unless asked otherwise.

use dgp_mesh::{Mesh, Progress, VertexSet};

use super::{
    Boundary, SmoothReport, Volume,
    run::{Task, run},
};
use crate::Error;

/// How strongly [`taubin`] smooths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaubinOptions {
    /// How often to smooth, two steps each time.
    pub iterations: usize,
    /// λ, the fraction of the way to the mean of its neighbors that a vertex moves in the first step.
    pub lambda: f64,
    /// k = 1/λ + 1/μ, the frequency below which a wave counts as shape: 0.01 to 0.1 in the paper.
    pub pass_band: f64,
    /// What vertices at the rim of a hole do.
    pub boundary: Boundary,
    /// What becomes of the enclosed volume.
    pub volume: Volume,
}

impl Default for TaubinOptions {
    fn default() -> Self {
        TaubinOptions {
            iterations: 10,
            lambda: 0.5,
            pass_band: 0.1,
            boundary: Boundary::default(),
            volume: Volume::default(),
        }
    }
}

impl TaubinOptions {
    /// μ, the factor of the second step.
    pub fn mu(&self) -> f64 {
        1.0 / (self.pass_band - 1.0 / self.lambda)
    }

    /// f(k), by which an iteration scales a wave of frequency `k` between 0 and 2.
    pub fn gain(&self, k: f64) -> f64 {
        (1.0 - self.lambda * k) * (1.0 - self.mu() * k)
    }

    /// λ and μ, unless they would make noise grow.
    fn steps(&self) -> Result<(f64, f64), Error> {
        let (lambda, mu) = (self.lambda, self.mu());
        if !(lambda > 0.0 && lambda.is_finite()) {
            return Err(Error::option("lambda", lambda, "positive and finite"));
        }
        if !(self.pass_band > 0.0 && mu < 0.0 && mu.is_finite()) {
            return Err(Error::option("pass_band", self.pass_band, "between 0 and 1/λ"));
        }
        // f is a parabola that opens downward with f = 1 at both ends of the pass band, so beyond it
        // only the shortest wave can grow.
        if self.gain(2.0) < -1.0 {
            let expected = "so small that (1 − 2λ)(1 − 2μ) ≥ −1";
            return Err(Error::option("lambda", lambda, expected));
        }
        Ok((lambda, mu))
    }
}

/// Removes noise from `mesh` without shrinking it; the vertices of `fixed` stay.
///
/// If cancelled, the iterations done so far remain, and the volume is what they made of it.
pub fn taubin(
    mesh: &mut Mesh,
    fixed: &VertexSet,
    options: &TaubinOptions,
    progress: Progress<'_>,
) -> Result<SmoothReport, Error> {
    let (lambda, mu) = options.steps()?;
    let TaubinOptions { iterations, boundary, volume, .. } = *options;
    let task = Task { fixed, boundary, volume, iterations, progress };
    run(mesh, &task, |rings, positions, room| {
        rings.relax(positions, room, lambda);
        rings.relax(room, positions, mu);
    })
}
