//! Tangential smoothing: evens out the spacing of vertices and leaves the surface where it is.
//!
//! ```text
//! x ← x + λ (I − n nᵀ)(c − x)        c = Σ a(w) x(w) / Σ a(w) over the neighbors w
//! ```
//!
//! with the normal n, summed over the corners around v weighted by area, anew in each iteration. Equal
//! weights a draw vertices to where neighbors are many; vertex areas as weights equalize areas.
//!
//! - Input: any polygon mesh.
//! - Cost: O(V) time and memory per iteration, in parallel; some three times that of
//!   [`uniform`](super::uniform).
//! - Guarantees: what is flat stays flat. Where the corners around a vertex have no area, or cancel,
//!   there is no tangent plane and the vertex stays.
//! - Reference: Botsch and Kobbelt, "A remeshing approach to multiresolution modeling", SGP 2004, section 4.
//! - Departs from it: the rim of a hole can slide along itself.

use dgp_mesh::{DVec3, Mesh, Progress, VertexSet, parallel};

use super::{
    Boundary, SmoothReport, Volume,
    rings::{Ring, Rings},
    run::{Task, fraction, run},
};
use crate::Error;

/// How strongly [`tangential`] smooths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentialOptions {
    /// How often to smooth.
    pub iterations: usize,
    /// λ, the fraction of the way to the center of its neighbors that a vertex moves: above 0, at most
    /// 1.
    pub lambda: f64,
    /// a, what a neighbor counts for.
    pub weight: NeighborWeight,
    /// What vertices at the rim of a hole do.
    pub boundary: Boundary,
    /// What becomes of the enclosed volume.
    pub volume: Volume,
}

impl Default for TangentialOptions {
    fn default() -> Self {
        TangentialOptions {
            iterations: 10,
            lambda: 0.5,
            weight: NeighborWeight::default(),
            boundary: Boundary::default(),
            volume: Volume::default(),
        }
    }
}

/// What a neighbor counts for in the center of a ring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NeighborWeight {
    /// All count the same.
    #[default]
    Equal,
    /// The area of the corners around it, so that areas become equal.
    Area,
}

/// Slides the vertices of `mesh`, but those of `fixed`, toward the centers of their neighbors.
///
/// If cancelled, the iterations done so far remain, and the volume is what they made of it.
pub fn tangential(
    mesh: &mut Mesh,
    fixed: &VertexSet,
    options: &TangentialOptions,
    progress: Progress<'_>,
) -> Result<SmoothReport, Error> {
    let TangentialOptions { iterations, lambda, weight, boundary, volume } = *options;
    let lambda = fraction("lambda", lambda)?;
    let task = Task { fixed, boundary, volume, iterations, progress };
    // Vertices that stay have no ring to sum over, but an area that counts for others.
    let all = match weight {
        NeighborWeight::Equal => None,
        NeighborWeight::Area => Some(Rings::new(mesh, &VertexSet::new(), Boundary::Free)),
    };
    run(mesh, &task, |rings, positions, room| {
        let areas = all.as_ref().map(|all| vertex_areas(all, positions));
        slide(rings, areas.as_deref(), positions, room, lambda);
        std::mem::swap(positions, room);
    })
}

/// One step, all vertices at once.
fn slide(rings: &Rings, areas: Option<&[f64]>, from: &[DVec3], to: &mut [DVec3], lambda: f64) {
    parallel::for_each_chunk(to, parallel::BLOCK, |first, chunk| {
        for (i, moved) in chunk.iter_mut().enumerate() {
            let p = from[first + i];
            let toward = |neighbors: &[u32]| center(neighbors, areas, from, p);
            *moved = match rings.ring(first + i) {
                Ring::None => p,
                Ring::Closed(ring) | Ring::Open(ring) => {
                    let is_closed = matches!(rings.ring(first + i), Ring::Closed(_));
                    let normal = corner_sum(ring, is_closed, from, p, |cross| cross);
                    match normal.try_normalize() {
                        Some(n) => {
                            let d = toward(ring);
                            p + lambda * (d - n * n.dot(d))
                        }
                        None => p,
                    }
                }
                Ring::Curve(ends) => {
                    let [a, b] = ends.map(|w| from[w as usize]);
                    match (b - a).try_normalize() {
                        Some(t) => p + lambda * t.dot(toward(&ends)) * t,
                        None => p,
                    }
                }
            };
        }
    });
}

/// The way from `p` to the center of its neighbors.
fn center(neighbors: &[u32], areas: Option<&[f64]>, from: &[DVec3], p: DVec3) -> DVec3 {
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for &w in neighbors {
        let weight = areas.map_or(1.0, |areas| areas[w as usize]);
        sum += weight * (from[w as usize] - p);
        total += weight;
    }
    if total > 0.0 { sum / total } else { DVec3::ZERO }
}

/// The sum of `f`(twice the vector area) over the corners at `p`.
fn corner_sum<T: std::iter::Sum>(
    ring: &[u32],
    is_closed: bool,
    from: &[DVec3],
    p: DVec3,
    f: impl Fn(DVec3) -> T,
) -> T {
    let side = |w: u32| from[w as usize] - p;
    let last = ring.len() - 1;
    let inner = ring.windows(2).map(|pair| side(pair[0]).cross(side(pair[1])));
    let closing = is_closed.then(|| side(ring[last]).cross(side(ring[0])));
    inner.chain(closing).map(f).sum()
}

/// The area of the corners around each vertex, up to a factor.
fn vertex_areas(rings: &Rings, positions: &[DVec3]) -> Vec<f64> {
    let mut areas = vec![0.0; positions.len()];
    parallel::for_each_chunk(&mut areas, parallel::BLOCK, |first, chunk| {
        for (i, area) in chunk.iter_mut().enumerate() {
            let p = positions[first + i];
            *area = match rings.ring(first + i) {
                Ring::Closed(ring) => corner_sum(ring, true, positions, p, DVec3::length),
                Ring::Open(ring) => corner_sum(ring, false, positions, p, DVec3::length),
                Ring::None | Ring::Curve(_) => 0.0,
            };
        }
    });
    areas
}
