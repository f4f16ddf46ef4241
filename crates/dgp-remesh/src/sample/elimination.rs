//! So many points as far apart as can be: of more points those that crowd others most are left out.
//!
//! ```text
//! w(i) = Σ (1 − max(|pᵢ − pⱼ|, 2 r_min) / 2 r_max)^α      over the others nearer than 2 r_max
//! r_max = √(A / (2√3 N)),   r_min = r_max (1 − (N/M)^γ) β,   N of M points stay, A the area
//! ```
//!
//! The one with the largest w is left out, and the w around it made smaller, until N are left.
//!
//! - Input: any triangles that have area together.
//! - Cost: O(M log M); about 18 neighbors for each of M = 5 N points.
//! - Guarantees: exactly N points; weights are added up in order of the points.
//! - Reference: Yuksel, "Sample elimination for generating Poisson disk sample sets", Computer Graphics Forum 34(2),
//!   2015.

use dgp_mesh::{
    DVec3, Progress, VertexId, graph::IndexedHeap, measure::Surface, parallel, spatial::PointTree,
};

use super::{
    MAX_SAMPLES, SurfaceSample, check_count, grid::Grid, least_distance, triangles::Triangles,
    uniform::uniform,
};
use crate::Error;

/// What [`sample_blue_noise`] is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlueNoiseOptions {
    /// Of the random numbers.
    pub seed: u64,
    /// M/N, random points for each that stays; at least 1.
    pub candidates: f64,
    /// α, how much nearer neighbors count for more.
    pub alpha: f64,
    /// β, how far clumps of the first points are looked through: 0 not at all, below 1.
    pub beta: f64,
    /// γ, how that depends on M/N.
    pub gamma: f64,
}

impl Default for BlueNoiseOptions {
    fn default() -> Self {
        BlueNoiseOptions { seed: 0, candidates: 5.0, alpha: 8.0, beta: 0.65, gamma: 1.5 }
    }
}

/// What [`sample_blue_noise`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct BlueNoiseReport {
    /// The smallest distance between two points; infinite if there are fewer than two.
    pub least_distance: f64,
    /// 2 r_max, what that could be if the surface were a plane.
    pub largest_possible: f64,
    /// M, from how many points those were chosen.
    pub candidates: usize,
}

/// `count` points all over the surface, as far from each other as elimination gets them.
///
/// Errors: as of [`sample_uniform`](super::sample_uniform), and [`Error::InvalidOption`].
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_remesh::{BlueNoiseOptions, sample_blue_noise};
///
/// let sphere = shapes::icosphere(3)?;
/// let (points, report) =
///     sample_blue_noise(&sphere, 500, &BlueNoiseOptions::default(), Progress::NONE)?;
/// assert!(points.len() == 500 && report.least_distance > 0.6 * report.largest_possible);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sample_blue_noise(
    surface: &impl Surface,
    count: usize,
    options: &BlueNoiseOptions,
    progress: Progress<'_>,
) -> Result<(Vec<SurfaceSample>, BlueNoiseReport), Error> {
    let BlueNoiseOptions { seed, candidates, alpha, beta, gamma } = *options;
    for (name, value, is_right, expected) in [
        ("candidates", candidates, (1.0..=1000.0).contains(&candidates), "between 1 and 1000"),
        ("alpha", alpha, (0.0..=1000.0).contains(&alpha), "between 0 and 1000"),
        ("beta", beta, (0.0..1.0).contains(&beta), "from 0 to below 1"),
        ("gamma", gamma, (0.0..=1000.0).contains(&gamma), "between 0 and 1000"),
    ] {
        if !is_right {
            return Err(Error::InvalidOption { name, value, expected });
        }
    }
    check_count("count", count)?;
    let triangles = Triangles::new(surface)?;
    let first = ((candidates * count as f64).ceil() as usize).clamp(count, MAX_SAMPLES.max(count));
    let all = uniform(&triangles, first, seed, progress.part(0.0, 0.1))?;
    let positions: Vec<DVec3> = all.iter().map(|sample| sample.position / triangles.unit).collect();
    let area = *triangles.cumulative(0..triangles.len())?.last().unwrap_or(&0.0);
    let kept = eliminate(&positions, count, area, options, progress.part(0.1, 0.9))?;
    let samples: Vec<SurfaceSample> = kept.iter().map(|&i| all[i as usize]).collect();
    let kept: Vec<DVec3> = samples.iter().map(|sample| sample.position).collect();
    let report = BlueNoiseReport {
        least_distance: least_distance(&kept)?,
        largest_possible: 2.0 * largest_radius(area, count) * triangles.unit,
        candidates: first,
    };
    progress.report(1.0)?;
    Ok((samples, report))
}

/// r_max of so many points.
fn largest_radius(area: f64, count: usize) -> f64 {
    (area / (2.0 * 3_f64.sqrt() * count.max(1) as f64)).sqrt()
}

/// Which `count` of the `points`, at unit scale, stay; ascending.
pub(crate) fn eliminate(
    points: &[DVec3],
    count: usize,
    area: f64,
    options: &BlueNoiseOptions,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    /// Eliminations between two reports.
    const STEP: usize = 1 << 14;
    if count >= points.len() || count == 0 {
        return Ok((0..points.len().min(count) as u32).collect());
    }
    let reach = 2.0 * largest_radius(area, count);
    let part = count as f64 / points.len() as f64;
    let least = reach * (1.0 - part.powf(options.gamma)) * options.beta;
    let weight = |distance: f64| (1.0 - distance.max(least) / reach).max(0.0).powf(options.alpha);
    let near = neighbors(points, reach, progress.part(0.0, 0.5))?;
    let weights = parallel::map(points.len(), |v: VertexId| {
        near.of(v.index()).map(|(_, distance)| weight(distance)).sum::<f64>()
    });
    // The heap gives the smallest first.
    let mut heap = IndexedHeap::from_keys(weights.iter().map(|(v, &w)| (v, -w)));
    let eliminated = points.len() - count;
    for done in 0..eliminated {
        if done.is_multiple_of(STEP) {
            progress.part(0.5, 1.0).report(done as f64 / eliminated as f64)?;
        }
        let Some((v, _)) = heap.pop() else { break };
        for (w, distance) in near.of(v.index()) {
            let w = VertexId::new(w as usize);
            if let Some(key) = heap.key(w) {
                heap.set(w, key + weight(distance));
            }
        }
    }
    Ok((0..points.len())
        .filter(|&i| heap.key(VertexId::new(i)).is_some())
        .map(|i| i as u32)
        .collect())
}

/// For each point those nearer than a distance, ascending.
struct Neighbors {
    starts: Vec<usize>,
    list: Vec<(u32, f64)>,
}

impl Neighbors {
    fn of(&self, i: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.list[self.starts[i]..self.starts[i + 1]].iter().copied()
    }
}

fn neighbors(points: &[DVec3], reach: f64, progress: Progress<'_>) -> Result<Neighbors, Error> {
    /// Points between two reports, and in a block.
    const STEP: usize = 1 << 17;
    const BLOCK: usize = 1 << 10;
    /// More cubes than this in a row are more than numbers of cubes can tell apart.
    const CUBES: f64 = (1 << 28) as f64;
    let extent = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    // Points on a surface that is nearly a line: the reach is rounding beside its length.
    if !(reach * CUBES > extent) {
        let tree = PointTree::new(points, Progress::NONE)?;
        return Ok(nearest_few(&tree, points, reach));
    }
    let mut grid = Grid::new(reach * (1.0 + f64::EPSILON.sqrt()));
    for &p in points {
        grid.add(p);
    }
    let (mut starts, mut list) = (vec![0], Vec::new());
    for first in (0..points.len()).step_by(STEP) {
        progress.report(first as f64 / points.len() as f64)?;
        let count = STEP.min(points.len() - first);
        let found = parallel::map_blocks(count, BLOCK, |range| {
            let around = |i: usize| {
                let p = grid.points()[first + i];
                let mut around = Vec::new();
                let _ = grid.any_near(p, |j, q| {
                    let distance = p.distance(q);
                    if distance < reach && j as usize != first + i {
                        around.push((j, distance));
                    }
                    false
                });
                around.sort_unstable_by_key(|&(j, _)| j);
                around
            };
            range.map(around).collect::<Vec<_>>()
        });
        for around in found.into_iter().flatten() {
            list.extend(around);
            starts.push(list.len());
        }
    }
    Ok(Neighbors { starts, list })
}

/// The few nearest points of each, those in reach.
fn nearest_few(tree: &PointTree, points: &[DVec3], reach: f64) -> Neighbors {
    const FEW: usize = 32;
    let (mut starts, mut list) = (vec![0], Vec::new());
    for (i, &p) in points.iter().enumerate() {
        let near = tree.nearest_points(p, FEW).into_iter();
        let others = near.filter(|other| other.index != i && other.distance < reach);
        let mut around: Vec<(u32, f64)> =
            others.map(|other| (other.index as u32, other.distance)).collect();
        around.sort_unstable_by_key(|&(j, _)| j);
        list.extend(around);
        starts.push(list.len());
    }
    Neighbors { starts, list }
}
