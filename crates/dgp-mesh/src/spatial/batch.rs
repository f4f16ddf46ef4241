//! Many queries at once: in an order in which neighbors follow each other, block by block in parallel.

use glam::DVec3;

use super::frame::Frame;
use crate::{Error, Progress, parallel};

/// How many queries a block has: enough for the first of a block, which has no neighbor, not to count.
const QUERIES: usize = 256;
/// How many blocks run between two reports.
const BLOCKS_PER_REPORT: usize = 64;

/// `f(i, state)` for each of `points`, in the order of `points`.
///
/// Within a block `f` is called along a curve through space, with a state that starts anew for each
/// block: what f returns must not depend on it.
pub(super) fn ordered<T: Send, S: Default>(
    frame: &Frame,
    points: &[DVec3],
    progress: Progress<'_>,
    f: impl Fn(usize, &mut S) -> T + Sync,
) -> Result<Vec<T>, Error> {
    let order = along_curve(frame, points);
    let mut results: Vec<Option<T>> = Vec::with_capacity(points.len());
    results.resize_with(points.len(), || None);
    for (k, part) in order.chunks(QUERIES * BLOCKS_PER_REPORT).enumerate() {
        progress.report((k * QUERIES * BLOCKS_PER_REPORT) as f64 / points.len() as f64)?;
        let blocks = parallel::map_blocks(part.len(), QUERIES, |range| {
            let mut state = S::default();
            let indices = part[range].iter().map(|&i| i as usize);
            indices.map(|i| f(i, &mut state)).collect::<Vec<T>>()
        });
        for (&i, value) in part.iter().zip(blocks.into_iter().flatten()) {
            results[i as usize] = Some(value);
        }
    }
    progress.report(1.0)?;
    Ok(results.into_iter().flatten().collect())
}

/// The numbers of `points` along the Z-order curve through the box of the frame (Morton 1966).
fn along_curve(frame: &Frame, points: &[DVec3]) -> Vec<u32> {
    /// Bits of each coordinate, and of a digit of the sort.
    const BITS: u32 = 10;
    const DIGIT: u32 = 10;
    let keys = parallel::map_blocks(points.len(), parallel::BLOCK, |range| {
        let key = |i: usize| {
            let local = frame.scaled(points[i]) - frame.center;
            // The box of the frame lies within −2..2.
            let cell = ((local + 2.0) * f64::from(1 << (BITS - 2))).to_array();
            let [x, y, z] = cell.map(|x| spread((x as u32).min((1 << BITS) - 1)));
            (x | y << 1 | z << 2, i as u32)
        };
        range.map(key).collect::<Vec<_>>()
    });
    let mut keys: Vec<(u32, u32)> = keys.into_iter().flatten().collect();
    let mut sorted = keys.clone();
    for shift in (0..3 * BITS).step_by(DIGIT as usize) {
        let digit = |key: u32| (key >> shift & ((1 << DIGIT) - 1)) as usize;
        let mut starts = [0_u32; 1 << DIGIT];
        for &(key, _) in &keys {
            starts[digit(key)] += 1;
        }
        let mut start = 0;
        for count in &mut starts {
            start += std::mem::replace(count, start);
        }
        for &pair in &keys {
            let place = &mut starts[digit(pair.0)];
            sorted[*place as usize] = pair;
            *place += 1;
        }
        std::mem::swap(&mut keys, &mut sorted);
    }
    keys.into_iter().map(|(_, i)| i).collect()
}

/// The ten lowest bits of `x`, two zeros between them.
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}
