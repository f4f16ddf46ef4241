//! One point in each of so many parts of equal area.
//!
//! ```text
//! point i: where the area (i + random) / count · A ends, faces and the points in them taken along a curve
//! ```
//!
//! Faces follow each other in Z-order. In a face, digits of base 4 name the quarter, the quarter of the quarter and
//! so on, so that an interval of the area is a small patch and not a thin band.
//!
//! - Input: any triangles that have area together.
//! - Cost: O(F log F) once, O(log F) for a point, in parallel.
//! - Guarantees: each part of area A/count has exactly one point; a face with x times the area of a part has
//!   less than x + 2 and more than x − 2.
//! - Reference: Cook, "Stochastic sampling in computer graphics", ACM Transactions on Graphics 5(1), 1986; Basu
//!   and Owen, "Low discrepancy constructions in the triangle", SIAM Journal on Numerical Analysis 53(2), 2015.
//! - Departs from it: the digits order random numbers, one in each interval, instead of a regular sequence.

use dgp_mesh::{DVec3, Progress, VertexId, measure::Surface, parallel};

use super::{
    SurfaceSample, check_count,
    triangles::{Triangles, locate},
    uniform::stream,
};
use crate::Error;

/// Digits of base 4: beyond, a random number has none.
const DIGITS: usize = 26;

/// `count` points, one in each part of the surface of `area / count`.
///
/// Errors: as of [`sample_uniform`](super::sample_uniform).
pub fn sample_stratified(
    surface: &impl Surface,
    count: usize,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Vec<SurfaceSample>, Error> {
    check_count("count", count)?;
    let triangles = Triangles::new(surface)?;
    progress.report(0.1)?;
    let centers: Vec<DVec3> = (0..triangles.len())
        .map(|f| triangles.points(f).into_iter().sum::<DVec3>() / 3.0)
        .collect();
    let order = curve_order(&centers);
    let cumulative = triangles.cumulative(order.iter().map(|&f| f as usize))?;
    let total = cumulative[cumulative.len() - 1];
    progress.report(0.5)?;
    let samples = parallel::map(count, |i: VertexId| {
        let i = i.index();
        let x = (i as f64 + stream(seed, i).uniform()) / count as f64 * total;
        let place = locate(&cumulative, x);
        let start = if place == 0 { 0.0 } else { cumulative[place - 1] };
        let part = (x - start) / (cumulative[place] - start);
        triangles.sample(order[place] as usize, along_quarters(part))
    });
    progress.report(1.0)?;
    Ok(samples.into_values())
}

/// The point of a triangle up to which `part` of its area lies, quarter by quarter.
fn along_quarters(part: f64) -> [f64; 2] {
    let (mut v, mut w, mut size) = (0.0, 0.0, 1.0);
    let mut part = part.clamp(0.0, 1.0 - f64::EPSILON);
    for _ in 0..DIGITS {
        part *= 4.0;
        let digit = part.floor();
        part -= digit;
        size *= 0.5;
        // The corner of the quarter where both of its axes start; those of the middle run backward.
        match digit as u8 {
            0 => {}
            1 => {
                v += size;
                w += size;
                size = -size;
            }
            2 => v += size,
            _ => w += size,
        }
    }
    [v + size / 3.0, w + size / 3.0]
}

/// The numbers of `points` in Z-order (Morton 1966); equal places in order of their numbers.
pub(crate) fn curve_order(points: &[DVec3]) -> Vec<u32> {
    /// Bits of each coordinate.
    const BITS: u32 = 21;
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let size = (high - low).max_element();
    // A cell more than the largest coordinate needs, so that it stays inside.
    let cells = if size > 0.0 { f64::from((1 << BITS) - 1) / size } else { 0.0 };
    let key = |p: DVec3| {
        let [x, y, z] = ((p - low) * cells).to_array().map(|x| spread(x as u64));
        x | y << 1 | z << 2
    };
    let mut keys: Vec<(u64, u32)> =
        points.iter().enumerate().map(|(i, &p)| (key(p), i as u32)).collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, i)| i).collect()
}

/// The 21 lowest bits of `x`, two zeros between them.
fn spread(x: u64) -> u64 {
    let x = x & 0x1f_ffff;
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_of_area_are_patches() {
        // The 16 intervals of a sixteenth are the 16 triangles of two splits in four.
        let mut seen = std::collections::BTreeSet::new();
        for i in 0..16 {
            let cells: Vec<[i64; 3]> = (0..20)
                .map(|k| {
                    let [v, w] =
                        along_quarters((f64::from(i) + (f64::from(k) + 0.5) / 20.0) / 16.0);
                    assert!(v > 0.0 && w > 0.0 && v + w < 1.0);
                    [v, w, 1.0 - v - w].map(|x| (4.0 * x).floor() as i64)
                })
                .collect();
            assert!(cells.iter().all(|&cell| cell == cells[0]), "{i} {cells:?}");
            seen.insert(cells[0]);
        }
        assert_eq!(seen.len(), 16);
    }
}
