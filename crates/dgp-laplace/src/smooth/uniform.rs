//! Uniform smoothing: moves each vertex toward the mean of its neighbors.
//!
//! ```text
//! x ← x + λ Δx        Δx(v) = mean of x(w) over the neighbors w of v, minus x(v)
//! ```
//!
//! A wave of frequency k ∈ [0, 2] is scaled by 1 − λk in each iteration: all waves fade, the short
//! ones first, and a closed surface shrinks. [`taubin`](super::taubin) does not shrink it. Equal weights
//! even out the spacing of the vertices too.
//!
//! - Input: any polygon mesh.
//! - Cost: O(V) time and memory per iteration, in parallel; rings are extracted once.
//! - Guarantees: for λ ≤ 1 each vertex stays in the convex hull of its neighbors and itself.
//! - Reference: Field, "Laplacian smoothing and Delaunay triangulations", Communications in Applied
//!   Numerical Methods 4, 1988, with Jacobi's order of steps: all vertices move at once.

use dgp_mesh::{Mesh, Progress, VertexSet};

use super::{
    Boundary, SmoothReport, Volume,
    run::{Task, fraction, run},
};
use crate::Error;

/// How strongly [`uniform`] smooths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformOptions {
    /// How often to smooth.
    pub iterations: usize,
    /// λ, the fraction of the way to the mean of its neighbors that a vertex moves: above 0, at most 1.
    pub lambda: f64,
    /// What vertices at the rim of a hole do.
    pub boundary: Boundary,
    /// What becomes of the enclosed volume.
    pub volume: Volume,
}

impl Default for UniformOptions {
    fn default() -> Self {
        UniformOptions {
            iterations: 10,
            lambda: 0.5,
            boundary: Boundary::default(),
            volume: Volume::default(),
        }
    }
}

/// Moves the vertices of `mesh`, but those of `fixed`, toward the means of their neighbors.
///
/// If cancelled, the iterations done so far remain, and the volume is what they made of it.
pub fn uniform(
    mesh: &mut Mesh,
    fixed: &VertexSet,
    options: &UniformOptions,
    progress: Progress<'_>,
) -> Result<SmoothReport, Error> {
    let UniformOptions { iterations, lambda, boundary, volume } = *options;
    let lambda = fraction("lambda", lambda)?;
    let task = Task { fixed, boundary, volume, iterations, progress };
    run(mesh, &task, |rings, positions, room| {
        rings.relax(positions, room, lambda);
        std::mem::swap(positions, room);
    })
}
