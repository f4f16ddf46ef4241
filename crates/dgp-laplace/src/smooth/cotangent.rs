//! Cotangent smoothing: moves each vertex against the curvature, by explicit steps.
//!
//! ```text
//! x ← x + λ Σ w (x(w) − x) / Σ w        w = cot α + cot β, the angles opposite the edge, in each step anew
//! ```
//!
//! The step is along the normal but for the irregularity of the mesh, so that, unlike
//! [`uniform`](super::uniform) smoothing, it leaves the spacing of the vertices as it is.
//!
//! - Input: a triangle mesh.
//! - Cost: O(V) time and memory per iteration, in parallel; some five times that of uniform smoothing.
//! - Guarantees: what is flat stays as it is, vertex by vertex. A vertex whose weights do not sum to
//!   something positive, as where its triangles have no area, stays.
//! - Reference: Desbrun, Meyer, Schröder and Barr, "Implicit fairing of irregular meshes using diffusion and
//!   curvature flow", SIGGRAPH 1999, section 5.1.

use dgp_mesh::{DVec3, Mesh, Progress, VertexSet, measure::require_triangles, parallel};

use super::{
    Boundary, SmoothReport, Volume,
    rings::{Ring, Rings},
    run::{Task, fraction, run},
};
use crate::Error;

/// How strongly [`cotangent`] smooths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CotangentOptions {
    /// How often to smooth.
    pub iterations: usize,
    /// λ, the fraction of the way to the weighted mean of its neighbors that a vertex moves: above 0, at
    /// most 1.
    pub lambda: f64,
    /// What vertices at the rim of a hole do. `Curve` draws them to the mean of their two neighbors there.
    pub boundary: Boundary,
    /// What becomes of the enclosed volume.
    pub volume: Volume,
}

impl Default for CotangentOptions {
    fn default() -> Self {
        CotangentOptions {
            iterations: 10,
            lambda: 0.5,
            boundary: Boundary::default(),
            volume: Volume::default(),
        }
    }
}

/// Moves the vertices of `mesh`, but those of `fixed`, against the curvature.
///
/// If cancelled, the iterations done so far remain, and the volume is what they made of it. Errors:
/// [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`], and those of the other methods.
pub fn cotangent(
    mesh: &mut Mesh,
    fixed: &VertexSet,
    options: &CotangentOptions,
    progress: Progress<'_>,
) -> Result<SmoothReport, Error> {
    let CotangentOptions { iterations, lambda, boundary, volume } = *options;
    let lambda = fraction("lambda", lambda)?;
    require_triangles(mesh)?;
    let task = Task { fixed, boundary, volume, iterations, progress };
    run(mesh, &task, |rings, positions, room| {
        step(rings, positions, room, lambda);
        std::mem::swap(positions, room);
    })
}

/// One step, all vertices at once.
fn step(rings: &Rings, from: &[DVec3], to: &mut [DVec3], lambda: f64) {
    parallel::for_each_chunk(to, parallel::BLOCK, |first, chunk| {
        for (i, moved) in chunk.iter_mut().enumerate() {
            let p = from[first + i];
            let side = |w: u32| from[w as usize] - p;
            let (mut sum, mut total) = (DVec3::ZERO, 0.0);
            let mut add = |a: u32, b: u32| {
                let (pull, weight) = triangle(side(a), side(b));
                sum += pull;
                total += weight;
            };
            match rings.ring(first + i) {
                Ring::None => {}
                Ring::Closed(ring) => {
                    ring.windows(2).for_each(|pair| add(pair[0], pair[1]));
                    add(ring[ring.len() - 1], ring[0]);
                }
                Ring::Open(ring) => ring.windows(2).for_each(|pair| add(pair[0], pair[1])),
                Ring::Curve([a, b]) => (sum, total) = (side(a) + side(b), 2.0),
            }
            let way = sum * (lambda / total);
            *moved = if total > 0.0 && way.is_finite() { p + way } else { p };
        }
    });
}

/// What a triangle with sides `u` and `v` at a vertex adds to its pull and to its weights.
fn triangle(u: DVec3, v: DVec3) -> (DVec3, f64) {
    let sine = u.cross(v).length();
    if sine == 0.0 {
        return (DVec3::ZERO, 0.0);
    }
    // The angle at the end of v is opposite u, and the other way around.
    let for_u = v.dot(v - u) / sine;
    let for_v = u.dot(u - v) / sine;
    (for_u * u + for_v * v, for_u + for_v)
}
