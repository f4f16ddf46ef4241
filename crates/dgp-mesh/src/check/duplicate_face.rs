//! No two faces have the same vertices in the same or in the reverse order, up to where they start.
//!
//! Each face is put into the bucket of its smallest vertex and compared from there on, towards the
//! smaller of the two neighbors.

use std::cmp::Ordering;

use crate::{FaceId, FaceList, VertexId};

/// Faces that equal an earlier one.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Duplicates {
    /// In the same order: each with the first one.
    pub(crate) same: Vec<[FaceId; 2]>,
    /// In reverse order: the first of each such face with the first of the others.
    pub(crate) opposite: Vec<[FaceId; 2]>,
}

/// A face as it reads from its smallest vertex to the smaller neighbor.
#[derive(Clone, Copy)]
struct Entry {
    /// The second vertex and the last.
    key: u64,
    face: FaceId,
    /// Whether it reads against its order.
    reversed: bool,
}

/// Finds equal faces among polygons of at least three corners, all distinct.
pub(crate) fn duplicates(vertex_count: usize, faces: &FaceList) -> Duplicates {
    let mut starts = vec![0_u32; vertex_count + 2];
    for (_, face) in faces.iter() {
        starts[smallest(face).index() + 2] += 1;
    }
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    // starts[v + 1] is now where bucket v begins, and moves to its end as it fills.
    let mut entries = vec![Entry { key: 0, face: FaceId::new(0), reversed: false }; faces.len()];
    for (f, face) in faces.iter() {
        let (first, entry) = entry(f, face);
        let place = &mut starts[first.index() + 1];
        entries[*place as usize] = entry;
        *place += 1;
    }
    let mut duplicates = Duplicates::default();
    for bounds in starts[..=vertex_count].windows(2) {
        let bucket = &mut entries[bounds[0] as usize..bounds[1] as usize];
        if bucket.len() < 2 {
            continue;
        }
        bucket.sort_unstable_by(|a, b| compare(faces, a, b).then(a.face.cmp(&b.face)));
        for group in bucket.chunk_by(|a, b| compare(faces, a, b).is_eq()) {
            report(group, &mut duplicates);
        }
    }
    duplicates.same.sort_unstable();
    duplicates.opposite.sort_unstable();
    duplicates
}

#[inline]
fn smallest(face: &[VertexId]) -> VertexId {
    match *face {
        [a, b, c] => a.min(b).min(c),
        _ => face.iter().copied().min().expect("a polygon has corners"),
    }
}

#[inline]
fn entry(f: FaceId, face: &[VertexId]) -> (VertexId, Entry) {
    let first = smallest(face);
    let start = face.iter().position(|&v| v == first).expect("the smallest is one of them");
    let next = face[if start + 1 == face.len() { 0 } else { start + 1 }];
    let last = face[if start == 0 { face.len() - 1 } else { start - 1 }];
    let key = (next.min(last).index() as u64) << 32 | next.max(last).index() as u64;
    (first, Entry { key, face: f, reversed: last < next })
}

/// Compares two faces with the same smallest vertex.
#[inline]
fn compare(faces: &FaceList, a: &Entry, b: &Entry) -> Ordering {
    a.key.cmp(&b.key).then_with(|| {
        let (p, q) = (faces.face(a.face), faces.face(b.face));
        let lengths = p.len().cmp(&q.len());
        if p.len() == 3 && q.len() == 3 {
            return lengths;
        }
        lengths.then_with(|| read(p, a.reversed).cmp(read(q, b.reversed)))
    })
}

/// The vertices of a face from the smallest on.
fn read(face: &[VertexId], reversed: bool) -> impl Iterator<Item = VertexId> + '_ {
    let first = smallest(face);
    let start = face.iter().position(|&v| v == first).expect("the smallest is one of them");
    let len = face.len();
    (0..len).map(move |k| face[(start + if reversed { len - k } else { k }) % len])
}

/// Adds what a group of equal faces, in order of their ids, has beyond the first one.
fn report(group: &[Entry], duplicates: &mut Duplicates) {
    let [first, others @ ..] = group else { return };
    let mut back: Option<FaceId> = None;
    for other in others {
        match (other.reversed == first.reversed, back) {
            (true, _) => duplicates.same.push([other.face, first.face]),
            (false, Some(back)) => duplicates.same.push([other.face, back]),
            (false, None) => {
                back = Some(other.face);
                duplicates.opposite.push([other.face, first.face]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(pairs: &[[usize; 2]]) -> Vec<[FaceId; 2]> {
        pairs.iter().map(|pair| pair.map(FaceId::new)).collect()
    }

    #[test]
    fn the_same_vertices_in_another_order_are_another_face() {
        let faces: &[&[usize]] = &[&[0, 1, 2, 3], &[0, 2, 1, 3], &[0, 1, 3], &[1, 2, 3]];
        assert_eq!(duplicates(4, &FaceList::from_indices(faces)), Duplicates::default());
    }

    #[test]
    fn rotated_and_reversed_faces_are_found() {
        let faces: &[&[usize]] = &[
            &[0, 1, 2],
            &[2, 0, 1],
            &[2, 1, 0],
            &[0, 2, 1],
            &[3, 4, 1, 2],
            &[1, 2, 3, 4],
            &[4, 3, 2, 1],
        ];
        let found = duplicates(5, &FaceList::from_indices(faces));
        assert_eq!(found.same, pairs(&[[1, 0], [3, 2], [5, 4]]));
        assert_eq!(found.opposite, pairs(&[[2, 0], [6, 4]]));
    }
}
