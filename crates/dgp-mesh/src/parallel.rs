//! Threads: maps and reductions that give the same bits for any number of them.
//!
//! A map writes each value by its id, so threads cannot change it. A reduction splits the range into
//! blocks whose size does not depend on the number of threads, reduces each in order, and then
//! combines the blocks in order. Without the feature `rayon` the same blocks run one by one.

use std::ops::Range;

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::{Connectivity, EdgeId, EdgeMap, FaceId, FaceMap, HalfedgeId, HalfedgeMap, Id, IdMap};
use crate::{VertexId, VertexMap};

/// Elements per block of a reduction, and the fewest that are worth a task of their own: at some
/// nanoseconds each a block takes longer than starting a task.
pub const BLOCK: usize = 4096;

/// Elements that a map makes at a time.
#[cfg(feature = "rayon")]
const FEW: usize = 32;

/// The value `f(id)` for each of `len` elements.
pub fn map<I: Id, T: Send>(len: usize, f: impl Fn(I) -> T + Sync + Send) -> IdMap<I, T> {
    #[cfg(feature = "rayon")]
    if len > BLOCK {
        // Some at a time, so that `f` stands in a loop and is not called through a pointer, which takes
        // longer than most of what it does. The memory is touched first by whoever writes it.
        let few = |i: usize| -> [T; FEW] { std::array::from_fn(|k| f(I::from_index(FEW * i + k))) };
        let mut values = Vec::with_capacity(len.div_ceil(FEW));
        let blocks = (0..len / FEW).into_par_iter().with_min_len(BLOCK / FEW / 4);
        blocks.map(few).collect_into_vec(&mut values);
        let mut values = values.into_flattened();
        values.extend((values.len()..len).map(|i| f(I::from_index(i))));
        return values.into();
    }
    IdMap::from_fn(len, f)
}

/// [`map()`] in memory that was made before, empty and with room for `len` elements.
pub(crate) fn map_in<I: Id, T: Send>(
    mut room: Vec<T>,
    len: usize,
    f: impl Fn(I) -> T + Sync + Send,
) -> IdMap<I, T> {
    #[cfg(feature = "rayon")]
    if len > BLOCK {
        let values = (0..len).into_par_iter().with_min_len(BLOCK / 4);
        values.map(|i| f(I::from_index(i))).collect_into_vec(&mut room);
        return room.into();
    }
    room.extend((0..len).map(|i| f(I::from_index(i))));
    room.into()
}

/// The results of `f` on consecutive ranges of `0..len`, each of `block` elements but the last.
pub fn map_blocks<T: Send>(
    len: usize,
    block: usize,
    f: impl Fn(Range<usize>) -> T + Sync + Send,
) -> Vec<T> {
    let block = block.max(1);
    let range = |b: usize| b * block..((b + 1) * block).min(len);
    #[cfg(feature = "rayon")]
    if len > block {
        return (0..len.div_ceil(block)).into_par_iter().map(|b| f(range(b))).collect();
    }
    (0..len.div_ceil(block)).map(|b| f(range(b))).collect()
}

/// Calls `f(first index, chunk)` on consecutive chunks of `values`, each of `block` but the last.
pub fn for_each_chunk<T: Send>(
    values: &mut [T],
    block: usize,
    f: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    let block = block.max(1);
    #[cfg(feature = "rayon")]
    if values.len() > block {
        values.par_chunks_mut(block).enumerate().for_each(|(b, chunk)| f(b * block, chunk));
        return;
    }
    values.chunks_mut(block).enumerate().for_each(|(b, chunk)| f(b * block, chunk));
}

/// `combine` over `f(id)` for each of `len` elements, starting each block from `zero`.
pub fn reduce<I: Id, T: Send + Sync + Clone>(
    len: usize,
    zero: T,
    f: impl Fn(I) -> T + Sync + Send,
    combine: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    let blocks = map_blocks(len, BLOCK, |range| {
        // Written out, since a chain of adapters leaves a call per element.
        let mut value = zero.clone();
        for i in range {
            value = combine(value, f(I::from_index(i)));
        }
        value
    });
    blocks.into_iter().fold(zero.clone(), &combine)
}

/// Both results, computed side by side where there are threads.
pub fn join<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "rayon")]
    return rayon::join(a, b);
    #[cfg(not(feature = "rayon"))]
    (a(), b())
}

/// How often work is halved so that each thread has a part, where every part reads all of the input: twice
/// is the most.
pub(crate) fn halvings() -> u32 {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads().ilog2().min(2);
    #[cfg(not(feature = "rayon"))]
    0
}

/// Values at every element.
impl Connectivity {
    /// Computes a value at every vertex.
    pub fn map_vertices<T: Send>(&self, f: impl Fn(VertexId) -> T + Sync + Send) -> VertexMap<T> {
        map(self.vertex_count(), f)
    }

    /// Computes a value at every half-edge.
    pub fn map_halfedges<T: Send>(
        &self,
        f: impl Fn(HalfedgeId) -> T + Sync + Send,
    ) -> HalfedgeMap<T> {
        map(self.halfedge_count(), f)
    }

    /// Computes a value at every edge.
    pub fn map_edges<T: Send>(&self, f: impl Fn(EdgeId) -> T + Sync + Send) -> EdgeMap<T> {
        map(self.edge_count(), f)
    }

    /// Computes a value at every face.
    pub fn map_faces<T: Send>(&self, f: impl Fn(FaceId) -> T + Sync + Send) -> FaceMap<T> {
        map(self.face_count(), f)
    }
}
