//! The mean distance from one surface to another, and its root mean square.
//!
//! ```text
//! mean = Σ w d(x, B),    rms = √(Σ w d(x, B)²),    w = area of the cell around x / area of A
//! ```
//!
//! Each triangle of A is cut into k² equal ones, k so that cells have about the same area on all of A; x
//! are their centers. No random numbers are involved.
//!
//! - Input: any two surfaces with triangles; A must have area.
//! - Cost: a nearest point for each cell, in parallel.
//! - Guarantees: the error is of the order of the square of the size of a cell where d is smooth; the
//!   same bits for any number of threads.
//! - Reference: Cignoni, Rocchini and Scopigno, "Metro: measuring error on simplified surfaces", Computer
//!   Graphics Forum 17(2), 1998.
//! - Departs from it: centers of cells instead of scan lines.

use glam::DVec3;

use super::TriangleTree;
use crate::{Error, Progress, parallel};

/// Choices of [`deviation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviationOptions {
    /// About how many points to measure at; each triangle has at least one.
    pub samples: usize,
}

impl Default for DeviationOptions {
    fn default() -> Self {
        DeviationOptions { samples: 100_000 }
    }
}

/// What [`deviation`] finds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use]
pub struct Deviation {
    /// The mean distance over the area.
    pub mean: f64,
    /// The root of the mean square distance over the area.
    pub rms: f64,
    /// The largest distance at a sample: less than the one-sided Hausdorff distance.
    pub largest: f64,
    /// At how many points it was measured.
    pub samples: usize,
}

/// The mean distance from the points of `from` to `to`.
///
/// Errors: [`Error::Empty`] if `to` has no triangles or `from` no area.
pub fn deviation(
    from: &TriangleTree,
    to: &TriangleTree,
    options: &DeviationOptions,
    progress: Progress<'_>,
) -> Result<Deviation, Error> {
    const TRIANGLES: usize = 1 << 15;
    let area_of = |[a, b, c]: &[DVec3; 3]| 0.5 * (*b - *a).cross(*c - *a).length();
    let areas = parallel::map_blocks(from.len(), parallel::BLOCK, |range| {
        from.triangles[range].iter().map(area_of).sum::<f64>()
    });
    let area: f64 = areas.into_iter().sum();
    if to.is_empty() || !(area > 0.0) {
        return Err(Error::Empty);
    }
    let cell = area / options.samples.max(1) as f64;
    let change = from.nodes.frame.scale.up;
    let down = to.nodes.frame.scale.down;
    let mut total = Sums::default();
    for start in (0..from.len()).step_by(TRIANGLES) {
        progress.report(start as f64 / from.len() as f64)?;
        let count = TRIANGLES.min(from.len() - start);
        let blocks = parallel::map_blocks(count, 64, |range| {
            let mut sums = Sums::default();
            let mut last = None;
            for triangle in &from.triangles[start + range.start..start + range.end] {
                let area = area_of(triangle);
                let k = (area / cell).sqrt().round().clamp(1.0, 65536.0);
                let corners = triangle.map(|p| p * change * down);
                let weight = area / (k * k);
                for point in centers(&corners, k as usize) {
                    let Some(nearest) = to.nearest(point, last) else { continue };
                    last = Some(nearest.triangle);
                    sums.add(weight, nearest.square);
                }
            }
            sums
        });
        for block in &blocks {
            total.join(block);
        }
    }
    progress.report(1.0)?;
    let up = to.nodes.frame.scale.up;
    Ok(Deviation {
        mean: total.first / area * up,
        rms: (total.second / area).sqrt() * up,
        largest: total.largest.sqrt() * up,
        samples: total.count,
    })
}

#[derive(Clone, Copy, Default)]
struct Sums {
    first: f64,
    second: f64,
    largest: f64,
    count: usize,
}

impl Sums {
    fn add(&mut self, weight: f64, square: f64) {
        self.first += weight * square.sqrt();
        self.second += weight * square;
        self.largest = self.largest.max(square);
        self.count += 1;
    }

    fn join(&mut self, other: &Sums) {
        self.first += other.first;
        self.second += other.second;
        self.largest = self.largest.max(other.largest);
        self.count += other.count;
    }
}

/// The centers of the k² triangles that a triangle is cut into, row by row.
fn centers(&[a, b, c]: &[DVec3; 3], k: usize) -> impl Iterator<Item = DVec3> {
    let third = 1.0 / (3.0 * k as f64);
    let (u, v) = ((b - a) * third, (c - a) * third);
    (0..k).flat_map(move |row| {
        (0..2 * (k - row) - 1).map(move |i| {
            // Upright triangles and those between them take turns.
            let corner = if i % 2 == 0 { 1.0 } else { 2.0 };
            let x = 3.0 * (i / 2) as f64 + corner;
            let y = 3.0 * row as f64 + corner;
            a + x * u + y * v
        })
    })
}
