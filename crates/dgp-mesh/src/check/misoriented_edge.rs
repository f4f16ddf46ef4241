//! Two faces that share an edge run along it in opposite directions.

use super::{Elements, adjacency::Adjacency};

/// The edges along which they run in the same one.
pub(super) fn find(adjacency: &Adjacency) -> Elements {
    Elements::Edges(adjacency.misoriented.iter().map(|pair| adjacency.edge(pair[0])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FaceList, VertexId};

    #[test]
    fn opposite_directions_agree() {
        let faces = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
        assert!(find(&Adjacency::new(4, faces.into())).is_empty());
    }

    #[test]
    fn the_same_direction_does_not() {
        let faces = FaceList::from_indices(&[[0, 1, 2], [1, 2, 3]]);
        let edge = [1, 2].map(VertexId::new);
        assert_eq!(find(&Adjacency::new(4, faces.into())), Elements::Edges(vec![edge]));
    }
}
