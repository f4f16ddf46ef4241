//! Many queries at once: in an order in which neighbors follow each other, block by block in parallel.

use glam::DVec3;

use super::{curve, frame::Frame};
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
    let key = |i: usize| curve::key((frame.scaled(points[i]) - frame.center).to_array());
    let order = curve::sorted(points.len(), key);
    let mut results: Vec<Option<T>> = Vec::with_capacity(points.len());
    results.resize_with(points.len(), || None);
    for (k, part) in order.chunks(QUERIES * BLOCKS_PER_REPORT).enumerate() {
        progress.report((k * QUERIES * BLOCKS_PER_REPORT) as f64 / points.len() as f64)?;
        let blocks = parallel::map_blocks(part.len(), QUERIES, |range| {
            let mut state = S::default();
            let indices = part[range].iter().map(|&(_, i)| i as usize);
            indices.map(|i| f(i, &mut state)).collect::<Vec<T>>()
        });
        for (&(_, i), value) in part.iter().zip(blocks.into_iter().flatten()) {
            results[i as usize] = Some(value);
        }
    }
    progress.report(1.0)?;
    Ok(results.into_iter().flatten().collect())
}
