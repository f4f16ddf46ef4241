//! The sides of faces, in buckets by their smaller vertex.

use std::{cmp::Ordering, ops::Range};

use crate::{FaceList, VertexId, parallel};

/// A side of a face in the bucket of its smaller vertex: its corner, with the direction in the highest
/// bit (0 if the side leads from the smaller to the larger), and the larger vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Side(pub(super) [u32; 2]);

impl Side {
    #[inline]
    pub(super) fn new(corner: usize, a: VertexId, b: VertexId) -> Self {
        let (smaller, larger) = (a.index().min(b.index()), a.index().max(b.index()));
        Side([u32::from(a.index() != smaller) << 31 | corner as u32, larger as u32])
    }

    /// By the larger vertex, then by direction.
    #[inline]
    fn key(self) -> u64 {
        u64::from(self.0[1]) << 32 | u64::from(self.0[0])
    }

    #[inline]
    pub(crate) fn larger(self) -> usize {
        self.0[1] as usize
    }

    #[inline]
    pub(crate) fn is_forward(self) -> bool {
        self.0[0] >> 31 == 0
    }

    #[inline]
    pub(crate) fn corner(self) -> usize {
        self.0[0] as usize & (FaceList::MAX_CORNERS - 1)
    }
}

impl Ord for Side {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl PartialOrd for Side {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The sides of all faces in sorted buckets by smaller vertex. That of v is `[v]..[v + 1]` of the
/// second list.
pub(crate) fn sorted_sides(vertex_count: usize, faces: &FaceList) -> (Vec<Side>, Vec<u32>) {
    let starts = starts(vertex_count, faces);
    let mut sides = vec![[0; 2]; faces.corners().len()];
    fill(faces, &starts, &mut middles(&starts), 0..vertex_count, &mut sides);
    let mut sides: Vec<_> = sides.into_iter().map(Side).collect();
    sort_buckets(&mut sides, &starts, 0..vertex_count);
    (sides, starts)
}

/// Where the sides of each vertex to larger ones have their bucket: that of v at `[v]..[v + 1]`.
pub(super) fn starts(vertex_count: usize, faces: &FaceList) -> Vec<u32> {
    let mut starts = vec![0_u32; vertex_count + 1];
    count(faces, 0, &mut starts[1..], parallel::halvings());
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    starts
}

/// Adds the sides of each vertex from `first` on to its count.
fn count(faces: &FaceList, first: usize, counts: &mut [u32], halvings: u32) {
    if halvings > 0 && counts.len() > parallel::BLOCK {
        let (low, high) = counts.split_at_mut(counts.len() / 2);
        let middle = first + low.len();
        parallel::join(
            || count(faces, first, low, halvings - 1),
            || count(faces, middle, high, halvings - 1),
        );
        return;
    }
    for_each_side(faces, |_, a, b| {
        if let Some(count) = counts.get_mut(a.min(b).index().wrapping_sub(first)) {
            *count += 1;
        }
    });
}

/// Where the bucket of each vertex begins and ends.
pub(super) fn middles(starts: &[u32]) -> Vec<[u32; 2]> {
    starts.windows(2).map(|ends| [ends[0], ends[1]]).collect()
}

/// Puts the sides of these vertices into their buckets, of which the first begins at `sides[0]`. Each
/// bucket fills from both ends; where they meet, its forward sides end and the others begin.
pub(super) fn fill(
    faces: &FaceList,
    starts: &[u32],
    middles: &mut [[u32; 2]],
    vertices: Range<usize>,
    sides: &mut [[u32; 2]],
) {
    let first = starts[vertices.start];
    for_each_side(faces, |corner, a, b| {
        if let Some(ends) = middles.get_mut(a.min(b).index().wrapping_sub(vertices.start)) {
            let backward = usize::from(a > b);
            let end = &mut ends[backward];
            let place = *end - backward as u32;
            *end = place + 1 - backward as u32;
            sides[(place - first) as usize] = Side::new(corner, a, b).0;
        }
    });
}

/// Calls `f(corner, a, b)` for each side a → b of each face, in order.
#[inline]
pub(super) fn for_each_side(faces: &FaceList, mut f: impl FnMut(usize, VertexId, VertexId)) {
    if faces.uniform_degree() == Some(3) {
        for (t, &[a, b, c]) in faces.corners().as_chunks::<3>().0.iter().enumerate() {
            f(3 * t, a, b);
            f(3 * t + 1, b, c);
            f(3 * t + 2, c, a);
        }
        return;
    }
    let mut corner = 0;
    for (_, face) in faces.iter() {
        let mut a = face[face.len() - 1];
        let last = corner + face.len() - 1;
        for (k, &b) in face.iter().enumerate() {
            f(if k == 0 { last } else { corner + k - 1 }, a, b);
            a = b;
        }
        corner += face.len();
    }
}

/// Sorts the buckets of these vertices, whose sides begin at `sides[0]`; halves in parallel.
fn sort_buckets(sides: &mut [Side], starts: &[u32], vertices: Range<usize>) {
    if vertices.len() > 4 * parallel::BLOCK {
        let middle = vertices.start.midpoint(vertices.end);
        let (low, high) = sides.split_at_mut((starts[middle] - starts[vertices.start]) as usize);
        parallel::join(
            || sort_buckets(low, starts, vertices.start..middle),
            || sort_buckets(high, starts, middle..vertices.end),
        );
        return;
    }
    let mut rest = sides;
    for v in vertices {
        let (bucket, others) = rest.split_at_mut((starts[v + 1] - starts[v]) as usize);
        sort(bucket);
        rest = others;
    }
}

/// Sorts a few sides. Most parts of buckets have up to six, in no order, where branches on comparisons
/// are guesses; these go through networks of minima and maxima instead (Knuth, The Art of Computer
/// Programming 3, section 5.3.4).
#[inline]
pub(super) fn sort(sides: &mut [Side]) {
    /// Puts the pairs in order, one after the other.
    macro_rules! order {
        ($($a:ident $b:ident),+) => {
            { $((*$a, *$b) = ((*$a).min(*$b), (*$a).max(*$b));)+ }
        };
    }
    match sides {
        [] | [_] => {}
        [a, b] => order!(a b),
        [a, b, c] => order!(a b, b c, a b),
        [a, b, c, d] => order!(a b, c d, a c, b d, b c),
        [a, b, c, d, e] => order!(a d, b e, a c, b d, a b, c e, b c, d e, c d),
        [a, b, c, d, e, f] => {
            order!(a f, b d, c e, b c, d e, a d, c f, a b, c d, e f, b c, d e);
        }
        _ => sides.sort_unstable(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_sides_are_sorted_in_whichever_order_they_come() {
        // Networks sort everything if they sort all lists of zeros and ones.
        for len in 0..8 {
            for bits in 0..1_u64 << len {
                let mut sides: Vec<Side> =
                    (0..len).map(|i| Side([0, (bits >> i & 1) as u32])).collect();
                sort(&mut sides);
                assert!(sides.is_sorted(), "{len} {bits:b}");
                assert_eq!(
                    sides.iter().map(|side| side.larger()).sum::<usize>(),
                    bits.count_ones() as usize
                );
            }
        }
    }
}
