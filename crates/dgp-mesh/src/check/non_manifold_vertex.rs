//! The faces at a vertex form one fan: open as at a rim, or closed.

use super::{Elements, adjacency::Adjacency};
use crate::{VertexId, VertexMap, VertexSet, parallel};

/// The vertices whose faces do not, the ends of edges that more than two faces share included.
pub(super) fn find(adjacency: &Adjacency) -> Elements {
    let mut bad = VertexSet::new();
    for sides in adjacency.crowded_edges() {
        bad.extend(adjacency.edge(sides[0]));
    }
    bad.extend(fans_per_vertex(adjacency));
    Elements::Vertices(bad.iter().collect())
}

/// The vertices with more than one fan, in order.
pub(crate) fn fans_per_vertex(adjacency: &Adjacency) -> Vec<VertexId> {
    let corners = adjacency.faces.corners();
    let mut counts: VertexMap<u32> = VertexMap::filled(adjacency.vertex_count, 0);
    let mut last: VertexMap<u32> = VertexMap::filled(adjacency.vertex_count, 0);
    for (corner, &v) in corners.iter().enumerate() {
        counts[v] += 1;
        last[v] = corner as u32;
    }
    let blocks = parallel::map_blocks(adjacency.vertex_count, parallel::BLOCK, |block| {
        let several = |&v: &VertexId| {
            let mut met = 0;
            if counts[v] > 0 {
                adjacency.walk_fan(last[v] as usize, |_| met += 1);
            }
            met != counts[v]
        };
        block.map(VertexId::new).filter(several).collect::<Vec<_>>()
    });
    blocks.concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceList;

    fn bad(vertices: usize, faces: &[[usize; 3]]) -> Vec<usize> {
        match find(&Adjacency::new(vertices, FaceList::from_indices(faces).into())) {
            Elements::Vertices(list) => list.iter().map(|v| v.index()).collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn one_fan_is_fine_whichever_way_its_faces_turn() {
        assert_eq!(bad(5, &[[0, 1, 2], [0, 3, 2], [0, 3, 4]]), []);
        assert_eq!(bad(4, &[[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]]), []);
        assert_eq!(bad(3, &[[0, 1, 2], [2, 1, 0]]), []);
    }

    #[test]
    fn bow_ties_are_found_open_and_closed() {
        assert_eq!(bad(5, &[[0, 1, 2], [0, 3, 4]]), [0]);
        let closed = |a: [usize; 4]| {
            [[a[0], a[2], a[1]], [a[0], a[1], a[3]], [a[1], a[2], a[3]], [a[2], a[0], a[3]]]
        };
        assert_eq!(bad(7, &[closed([0, 1, 2, 3]), closed([4, 5, 3, 6])].concat()), [3]);
    }

    #[test]
    fn the_ends_of_a_crowded_edge_are_found() {
        assert_eq!(bad(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]), [0, 1]);
    }
}
