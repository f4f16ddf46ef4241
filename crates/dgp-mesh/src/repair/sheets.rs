//! Faces back to back: walls within solids, fins, and sheets with two sides.
//!
//! ```text
//!   a wall: the solids beside      a fin: it ends         a sheet: nothing      a side too many:
//!   it become one                  in the air             else meets it         the surface goes on
//!
//!    ┌────╥────┐                      ║                     ══════               ──────══════──────
//!    │    ║    │                   ───╨───
//!    └────╨────┘
//! ```
//!
//! Where an odd number of other faces meets an edge, one side of the patch continues them and stays; where
//! the number is even, both go.
//!
//! - Input: polygons; copies in the same order may be among them and count as the face they copy.
//! - Cost: O(n log n) for n faces back to back, O(F) for the edges of the others.

use std::collections::{BTreeMap, BTreeSet};

use super::draft::Draft;
use crate::{FaceId, FaceSet, VertexId, check::union::Union};

/// Which of the faces of `pairs`, each the back of the other, are to go. Of `same` the first of each
/// repeats the second.
pub(super) fn to_drop(draft: &Draft, same: &[[FaceId; 2]], pairs: &[[FaceId; 2]]) -> Vec<FaceId> {
    let paired: FaceSet = pairs.iter().flatten().copied().collect();
    // The first pair at each edge of one of them.
    let mut edges: BTreeMap<[VertexId; 2], usize> = BTreeMap::new();
    let mut patches = Union::new(pairs.len());
    for (k, &[f, _]) in pairs.iter().enumerate() {
        for edge in sides(draft.faces.face(f)) {
            patches.join(k, *edges.entry(edge).or_insert(k));
        }
    }
    let copies: FaceSet = same.iter().map(|pair| pair[0]).collect();
    // How many other faces each edge has.
    let mut others: BTreeMap<[VertexId; 2], usize> = BTreeMap::new();
    for (_, face) in draft.faces.iter().filter(|&(f, _)| !copies.contains(f) && !paired.contains(f))
    {
        for edge in sides(face).filter(|edge| edges.contains_key(edge)) {
            *others.entry(edge).or_default() += 1;
        }
    }
    let (mut crossed, mut continued) = (BTreeSet::new(), BTreeSet::new());
    for (edge, count) in others {
        let patch = patches.find(edges[&edge]);
        if count % 2 == 0 {
            crossed.insert(patch)
        } else {
            continued.insert(patch)
        };
    }
    let mut dropped = Vec::new();
    for (k, &[f, g]) in pairs.iter().enumerate() {
        // The side that comes first stays where it is a part of the surface or all there is.
        dropped.push(f.max(g));
        let patch = patches.find(k);
        if crossed.contains(&patch) && !continued.contains(&patch) {
            dropped.push(f.min(g));
        }
    }
    dropped.sort_unstable();
    dropped.dedup();
    dropped
}

fn sides(face: &[VertexId]) -> impl Iterator<Item = [VertexId; 2]> + '_ {
    let next = face.iter().cycle().skip(1);
    face.iter().zip(next).map(|(&v, &w)| [v.min(w), v.max(w)])
}
