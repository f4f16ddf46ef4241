//! A closed surface has no rim.

use super::{Elements, Groups, adjacency::Adjacency};
use crate::VertexId;

/// The rims: chains of sides that belong to one face only, from vertex to vertex around each hole.
///
/// A chain passes a vertex where several fans touch within the fan it came in. Where more than two
/// faces meet it ends, so that rims of what is no manifold may come in pieces.
pub(super) fn find(adjacency: &Adjacency) -> Elements {
    let mut loops = Groups::new();
    let mut seen = vec![false; adjacency.side_count()];
    for start in 0..adjacency.side_count() {
        if !adjacency.is_open(start) || seen[start] {
            continue;
        }
        let mut chain: Vec<VertexId> = vec![adjacency.from(start)];
        let (mut side, mut end) = (start, adjacency.to(start));
        loop {
            seen[side] = true;
            let Some(next) = following(adjacency, side, end).filter(|&next| !seen[next]) else {
                break;
            };
            chain.push(end);
            let ends = [adjacency.from(next), adjacency.to(next)];
            end = if ends[0] == end { ends[1] } else { ends[0] };
            side = next;
        }
        loops.push(chain);
    }
    Elements::Loops(loops)
}

/// The open side at the other end of the fan that `side` begins at vertex `v`.
pub(crate) fn following(adjacency: &Adjacency, side: usize, v: VertexId) -> Option<usize> {
    // The other side of the same face at v.
    let mut exit =
        if adjacency.from(side) == v { adjacency.prev(side) } else { adjacency.next(side) };
    while let Some((_, next)) = adjacency.step(v, exit) {
        exit = next;
    }
    adjacency.is_open(exit).then_some(exit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceList;

    fn lengths(vertices: usize, faces: &[[usize; 3]]) -> Vec<usize> {
        match find(&Adjacency::new(vertices, FaceList::from_indices(faces).into())) {
            Elements::Loops(loops) => loops.iter().map(<[_]>::len).collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_tetrahedron_has_none() {
        assert_eq!(lengths(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), []);
    }

    #[test]
    fn rims_are_walked_past_turned_faces_and_touching_corners() {
        assert_eq!(lengths(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3]]), [3]);
        assert_eq!(lengths(4, &[[0, 1, 2], [1, 2, 3]]), [4]);
        assert_eq!(lengths(5, &[[0, 1, 2], [0, 3, 4]]), [3, 3]);
    }
}
