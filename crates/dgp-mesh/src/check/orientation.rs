//! Which faces to turn over so that neighbors agree on what is outside.
//!
//! Faces that agree already stay together: they form patches. Each edge between two patches says that
//! one of them must be turned. The patches are joined in the order of how many edges say so, the
//! strongest first (Kruskal 1956, with parities); what contradicts the joins made before is left
//! disagreeing. So the fewest edges are given up where not all can agree, or nearly so, and in each
//! connected part the side that most faces had is kept.

use std::cmp::Reverse;

use super::{adjacency::Adjacency, union::Union};
use crate::{FaceId, FaceMap};

/// How to turn faces so that mates run opposite ways.
pub(crate) struct Orientation {
    /// The faces to turn over; empty if none.
    pub(crate) turned: FaceMap<bool>,
    /// Pairs of mates that run the same way even then: none if the surface has two sides.
    pub(crate) disagreeing: Vec<[usize; 2]>,
}

impl Orientation {
    pub(crate) fn new(adjacency: &Adjacency) -> Self {
        if adjacency.misoriented.is_empty() {
            return Orientation { turned: FaceMap::new(), disagreeing: Vec::new() };
        }
        let mut patches = agreeing_patches(adjacency);
        let patch = |side: usize| patches.find(adjacency.face(side).index());
        let ends: Vec<usize> = adjacency.misoriented.iter().flatten().copied().map(patch).collect();
        let (ends, _) = ends.as_chunks::<2>();
        let mut parity = joined(ends, adjacency.faces.len());

        // In each joined part keep the side of most faces, of the first face where it is a tie.
        let len = adjacency.faces.len();
        let side_of = |f: FaceId, patches: &mut Union, parity: &mut ParityUnion| {
            parity.find(patches.find(f.index()))
        };
        let mut balance = vec![0_i64; len];
        for f in (0..len).map(FaceId::new) {
            let (root, odd) = side_of(f, &mut patches, &mut parity);
            balance[root] += if odd { -1 } else { 1 };
        }
        let turned = FaceMap::from_fn(len, |f: FaceId| {
            let (root, odd) = side_of(f, &mut patches, &mut parity);
            // The root is the smallest patch, whose first face is the first of the part.
            odd != (balance[root] < 0)
        });
        let disagrees = |pair: &[usize; 2]| {
            let [a, b] = pair.map(|side| turned[adjacency.face(side)]);
            a == b
        };
        let disagreeing = adjacency.misoriented.iter().copied().filter(disagrees).collect();
        Orientation { turned, disagreeing }
    }
}

/// The faces joined across edges where they agree.
fn agreeing_patches(adjacency: &Adjacency) -> Union {
    let mut patches = Union::new(adjacency.faces.len());
    for side in 0..adjacency.side_count() {
        let Some(mate) = adjacency.mate(side).filter(|&mate| mate > side) else { continue };
        // Mates run between the same two vertices, so their starts tell the directions apart.
        if adjacency.from(side) != adjacency.from(mate) {
            patches.join(adjacency.face(side).index(), adjacency.face(mate).index());
        }
    }
    patches
}

/// The patches joined so that the ends of edges are on opposite sides, as far as they can be.
fn joined(ends: &[[usize; 2]], len: usize) -> ParityUnion {
    let mut parity = ParityUnion::new(len);
    for &[p, q] in ends {
        parity.join_opposite(p, q);
    }
    if ends.iter().all(|&[p, q]| parity.find(p).1 != parity.find(q).1) {
        return parity;
    }
    // Contradictions: then the order counts.
    let mut ends: Vec<[usize; 2]> = ends.iter().map(|&[p, q]| [p.min(q), p.max(q)]).collect();
    ends.sort_unstable();
    let mut votes: Vec<(usize, [usize; 2])> =
        ends.chunk_by(|a, b| a == b).map(|same| (same.len(), same[0])).collect();
    votes.sort_unstable_by_key(|&(count, ends)| (Reverse(count), ends));
    let mut parity = ParityUnion::new(len);
    for (_, [p, q]) in votes {
        parity.join_opposite(p, q);
    }
    parity
}

/// Union–find where each element is on one of two sides of its set.
struct ParityUnion {
    /// The parent, and whether it is on the other side.
    parents: Vec<(u32, bool)>,
}

impl ParityUnion {
    fn new(len: usize) -> Self {
        ParityUnion { parents: (0..len as u32).map(|i| (i, false)).collect() }
    }

    /// The smallest element of the set of `i`, and whether `i` is on the other side from it.
    fn find(&mut self, i: usize) -> (usize, bool) {
        let (mut root, mut odd) = (i, false);
        while self.parents[root].0 as usize != root {
            odd ^= self.parents[root].1;
            root = self.parents[root].0 as usize;
        }
        // Let all on the way point to the root.
        let (mut j, mut rest) = (i, odd);
        while j != root {
            let (parent, step) = self.parents[j];
            self.parents[j] = (root as u32, rest);
            rest ^= step;
            j = parent as usize;
        }
        (root, odd)
    }

    /// Puts `i` and `j` on opposite sides, unless they are in one set already.
    fn join_opposite(&mut self, i: usize, j: usize) {
        let ((p, odd_p), (q, odd_q)) = (self.find(i), self.find(j));
        if p != q {
            self.parents[p.max(q)] = (p.min(q) as u32, odd_p == odd_q);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FaceList, VertexId};

    fn turned(vertices: usize, faces: &[[usize; 3]]) -> (Vec<bool>, usize) {
        let faces = FaceList::from_indices(faces);
        let adjacency = Adjacency::new(vertices, faces.into());
        let orientation = Orientation::new(&adjacency);
        (orientation.turned.into_values(), orientation.disagreeing.len())
    }

    #[test]
    fn the_minority_is_turned() {
        assert_eq!(turned(5, &[[0, 1, 2], [1, 2, 3], [2, 4, 3]]), (vec![true, false, false], 0));
        assert_eq!(turned(4, &[[0, 1, 2], [1, 2, 3]]), (vec![false, true], 0));
        assert_eq!(turned(4, &[[0, 1, 2], [2, 1, 3]]), (vec![], 0));
    }

    #[test]
    fn a_one_sided_strip_gives_up_the_one_edge_that_disagrees() {
        let faces = FaceList::from_indices(&[[0, 1, 4, 3], [1, 2, 5, 4], [2, 3, 0, 5]]);
        let adjacency = Adjacency::new(6, faces.into());
        let orientation = Orientation::new(&adjacency);
        assert_eq!(orientation.turned.values(), [false; 3]);
        assert_eq!(orientation.disagreeing.len(), 1);
        assert_eq!(adjacency.edge(orientation.disagreeing[0][0]).map(VertexId::index), [0, 3]);
    }
}
