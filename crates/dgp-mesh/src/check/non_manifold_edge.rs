//! At most two faces share an edge.

use super::{Elements, adjacency::Adjacency};

/// The edges that more share.
pub(super) fn find(adjacency: &Adjacency) -> Elements {
    Elements::Edges(adjacency.crowded_edges().map(|sides| adjacency.edge(sides[0])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FaceList, VertexId};

    #[test]
    fn two_faces_may_share_an_edge() {
        let faces = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
        assert!(find(&Adjacency::new(4, faces.into())).is_empty());
    }

    #[test]
    fn three_may_not() {
        let faces = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3], [1, 2, 4]]);
        let edge = [1, 2].map(VertexId::new);
        assert_eq!(find(&Adjacency::new(5, faces.into())), Elements::Edges(vec![edge]));
    }
}
