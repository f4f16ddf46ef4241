//! Independent points, each part of the surface as likely as its area.
//!
//! ```text
//! face: the one in whose part of the cumulative area a random number falls
//! p = (1 − √s) a + √s (1 − t) b + √s t c        s, t random in 0..1
//! ```
//!
//! - Input: any triangles that have area together.
//! - Cost: O(F) once, O(log F) for a point, in parallel.
//! - Guarantees: a point depends on the seed and its number only.
//! - Reference: Turk, "Generating random points in triangles", Graphics Gems, 1990; Osada, Funkhouser,
//!   Chazelle and Dobkin, "Shape distributions", ACM Transactions on Graphics 21(4), 2002.

use dgp_mesh::{Progress, VertexId, measure::Surface, parallel, shapes::Random};

use super::{
    SurfaceSample, check_count,
    triangles::{Triangles, locate},
};
use crate::Error;

/// Points between two reports.
const STEP: usize = 1 << 18;

/// `count` points, each anywhere on the surface.
///
/// Errors: [`Error::NotTriangle`], [`Error::NotFinite`], [`Error::NoArea`], [`Error::InvalidOption`] for more
/// than [`MAX_SAMPLES`](super::MAX_SAMPLES), [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_remesh::sample_uniform;
///
/// let points = sample_uniform(&shapes::icosphere(3)?, 1000, 7, Progress::NONE)?;
/// assert!(points.len() == 1000 && points.iter().all(|p| (p.position.length() - 1.0).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sample_uniform(
    surface: &impl Surface,
    count: usize,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Vec<SurfaceSample>, Error> {
    check_count("count", count)?;
    uniform(&Triangles::new(surface)?, count, seed, progress)
}

/// The same of triangles that are known.
pub(super) fn uniform(
    triangles: &Triangles,
    count: usize,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Vec<SurfaceSample>, Error> {
    let cumulative = triangles.cumulative(0..triangles.len())?;
    let total = cumulative[cumulative.len() - 1];
    let mut samples = Vec::with_capacity(count);
    while samples.len() < count {
        progress.report(samples.len() as f64 / count as f64)?;
        let first = samples.len();
        let part = parallel::map(STEP.min(count - first), |i: VertexId| {
            let mut random = stream(seed, first + i.index());
            let f = locate(&cumulative, random.uniform() * total);
            triangles.sample(f, in_triangle(&mut random))
        });
        samples.extend(part.into_values());
    }
    progress.report(1.0)?;
    Ok(samples)
}

/// Two weights of a random point of a triangle.
pub(super) fn in_triangle(random: &mut Random) -> [f64; 2] {
    let (root, t) = (random.uniform().sqrt(), random.uniform());
    [root * (1.0 - t), root * t]
}

/// The random numbers of element `i`.
pub(super) fn stream(seed: u64, i: usize) -> Random {
    // Sequences of states that follow each other are shifted copies: both numbers are mixed first.
    Random::new(Random::new(seed).bits() ^ Random::new(!(i as u64)).bits())
}
