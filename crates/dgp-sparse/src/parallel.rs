//! Threads: the same bits for any number of them, because each value is computed by one.

use std::ops::Range;

#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// The fewest values that are worth a task of their own.
const BLOCK: usize = 4096;

/// Calls `f(first index, chunk)` on consecutive chunks of `values`, each of `block` but the last, and
/// returns the results in order.
pub(crate) fn map_chunks<T: Send, R: Send>(
    values: &mut [T],
    block: usize,
    f: impl Fn(usize, &mut [T]) -> R + Sync + Send,
) -> Vec<R> {
    let block = block.max(1);
    #[cfg(feature = "rayon")]
    if values.len() > block {
        let chunks = values.par_chunks_mut(block).enumerate();
        return chunks.map(|(b, chunk)| f(b * block, chunk)).collect();
    }
    values.chunks_mut(block).enumerate().map(|(b, chunk)| f(b * block, chunk)).collect()
}

/// Σ `f(i)` over `0..len`, in blocks that do not depend on the number of threads.
pub(crate) fn sum(len: usize, f: impl Fn(Range<usize>) -> f64 + Sync + Send) -> f64 {
    let range = |b: usize| b * BLOCK..((b + 1) * BLOCK).min(len);
    #[cfg(feature = "rayon")]
    if len > BLOCK {
        let blocks: Vec<f64> =
            (0..len.div_ceil(BLOCK)).into_par_iter().map(|b| f(range(b))).collect();
        return blocks.into_iter().sum();
    }
    (0..len.div_ceil(BLOCK)).map(|b| f(range(b))).sum()
}

/// Both results, computed at the same time if there are threads.
pub(crate) fn join<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "rayon")]
    return rayon::join(a, b);
    #[cfg(not(feature = "rayon"))]
    (a(), b())
}
