//! k-means of weighted points, with seeded first centers.
//!
//! ```text
//! first centers   one after the other, each with odds ∝ weight · distance² to those before
//! repeat          each point joins its nearest center, each center moves to the mean of its points
//! ```
//!
//! - Input: points of any dimension with positive weights.
//! - Cost: O(rounds · k · n · dimension) for each attempt.
//! - Guarantees: no cluster is empty; the same for any number of threads. The result is a local minimum of the
//!   sum of squares, the best of several attempts.
//! - Reference: Lloyd, "Least squares quantization in PCM", 1982; Arthur and Vassilvitskii, "k-means++: the
//!   advantages of careful seeding", SODA 2007.

use dgp_mesh::{Progress, parallel, shapes::Random};

use super::partition::PartitionOptions;
use crate::Error;

/// The most rounds of an attempt; clusters settle in far fewer.
const ROUNDS: usize = 200;

/// The cluster of each of the points, which stand one after the other, `count` of them.
pub(super) fn k_means(
    points: &[f64],
    weights: &[f64],
    count: usize,
    options: &PartitionOptions,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    let mut random = Random::new(options.seed);
    let mut best: Option<(f64, Vec<u32>)> = None;
    for attempt in 0..options.attempts {
        let progress = progress.part(
            attempt as f64 / options.attempts as f64,
            (attempt + 1) as f64 / options.attempts as f64,
        );
        let mut clusters = Clusters::new(points, weights, count, &mut random);
        for round in 0..ROUNDS {
            progress.report(round as f64 / ROUNDS as f64)?;
            if !clusters.assign() {
                break;
            }
            clusters.move_centers();
        }
        if best.as_ref().is_none_or(|(error, _)| clusters.error < *error) {
            best = Some((clusters.error, clusters.labels));
        }
    }
    Ok(best.map_or_else(Vec::new, |(_, labels)| labels))
}

/// One attempt.
struct Clusters<'a> {
    points: &'a [f64],
    weights: &'a [f64],
    dimension: usize,
    /// One after the other.
    centers: Vec<f64>,
    labels: Vec<u32>,
    /// Σ weight · distance² to the nearest center.
    error: f64,
}

impl<'a> Clusters<'a> {
    fn new(points: &'a [f64], weights: &'a [f64], count: usize, random: &mut Random) -> Self {
        let dimension = points.len() / weights.len();
        let mut nearest = vec![f64::INFINITY; weights.len()];
        let mut centers = Vec::with_capacity(count * dimension);
        for k in 0..count {
            let odds: Vec<f64> = weights
                .iter()
                .zip(&nearest)
                .map(|(w, d)| if k == 0 { *w } else { w * d })
                .collect();
            let chosen = draw(&odds, random.uniform());
            let center = &points[chosen * dimension..(chosen + 1) * dimension];
            centers.extend_from_slice(center);
            for (near, point) in nearest.iter_mut().zip(points.chunks(dimension)) {
                *near = near.min(distance(point, center));
            }
        }
        let labels = vec![u32::MAX; weights.len()];
        Clusters { points, weights, dimension, centers, labels, error: f64::INFINITY }
    }

    /// Puts each point to its nearest center; whether one changed.
    fn assign(&mut self) -> bool {
        let nearest = parallel::map_blocks(self.weights.len(), parallel::BLOCK, |range| {
            range
                .map(|i| {
                    let point = &self.points[i * self.dimension..(i + 1) * self.dimension];
                    let distances =
                        self.centers.chunks(self.dimension).map(|center| distance(point, center));
                    distances.zip(0_u32..).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0))
                })
                .collect::<Vec<_>>()
        });
        let mut nearest: Vec<(f64, u32)> = nearest.into_iter().flatten().collect();
        self.fill_empty(&mut nearest);
        self.error = nearest.iter().zip(self.weights).map(|((d, _), w)| d * w).sum();
        let labels: Vec<u32> = nearest.into_iter().map(|(_, label)| label).collect();
        let changed = labels != self.labels;
        self.labels = labels;
        changed
    }

    /// Gives each cluster without points the farthest point of a cluster that has others.
    fn fill_empty(&self, nearest: &mut [(f64, u32)]) {
        let count = self.centers.len() / self.dimension;
        let mut sizes = vec![0; count];
        for &(_, label) in &*nearest {
            sizes[label as usize] += 1;
        }
        for empty in 0..count {
            if sizes[empty] > 0 {
                continue;
            }
            let movable = (0..nearest.len()).filter(|&i| sizes[nearest[i].1 as usize] > 1);
            let farthest = movable.max_by(|&i, &j| {
                let weighted = |k: usize| nearest[k].0 * self.weights[k];
                weighted(i).total_cmp(&weighted(j))
            });
            if let Some(i) = farthest {
                sizes[nearest[i].1 as usize] -= 1;
                sizes[empty] = 1;
                nearest[i] = (0.0, empty as u32);
            }
        }
    }

    fn move_centers(&mut self) {
        let mut totals = vec![0.0; self.centers.len() / self.dimension];
        self.centers.fill(0.0);
        for ((point, &weight), &label) in
            self.points.chunks(self.dimension).zip(self.weights).zip(&self.labels)
        {
            let label = label as usize;
            totals[label] += weight;
            let center = &mut self.centers[label * self.dimension..(label + 1) * self.dimension];
            center.iter_mut().zip(point).for_each(|(c, p)| *c += weight * p);
        }
        for (center, total) in self.centers.chunks_mut(self.dimension).zip(totals) {
            for c in center {
                *c /= total;
            }
        }
    }
}

/// The index that `at` (from 0 to 1) of the sum of the odds falls to.
fn draw(odds: &[f64], at: f64) -> usize {
    let mut rest = at * odds.iter().sum::<f64>();
    for (i, odd) in odds.iter().enumerate() {
        rest -= odd;
        if rest < 0.0 {
            return i;
        }
    }
    // All odds are zero, or rounding; the last that can be.
    odds.iter().rposition(|&odd| odd > 0.0).unwrap_or(0)
}

/// The square of the distance.
#[inline]
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}
