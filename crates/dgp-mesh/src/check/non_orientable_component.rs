//! Connected faces can be turned so that all agree on what is outside.

use super::{Groups, adjacency::Adjacency, components::Components, orientation::Orientation};
use crate::{FaceId, FaceSet};

/// The components, joined across edges of two faces, that cannot: one-sided like a Möbius strip.
pub(super) fn find(adjacency: &Adjacency) -> Groups<FaceId> {
    let orientation = Orientation::new(adjacency);
    if orientation.disagreeing.is_empty() {
        return Groups::new();
    }
    let components = Components::new(adjacency);
    let first = |pair: &[usize; 2]| components.first(adjacency.face(pair[0]));
    let bad: FaceSet = orientation.disagreeing.iter().map(first).collect();
    components.groups(|first| bad.contains(first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceList;

    #[test]
    fn a_ring_with_a_face_turned_over_is_orientable() {
        let faces = FaceList::from_indices(&[[0, 1, 4, 3], [1, 4, 5, 2], [2, 0, 3, 5]]);
        assert!(find(&Adjacency::new(6, faces.into())).is_empty());
    }

    #[test]
    fn a_moebius_strip_is_not() {
        let faces =
            FaceList::from_indices(&[[0, 1, 4, 3], [1, 2, 5, 4], [2, 3, 0, 5], [6, 7, 8, 9]]);
        let found = find(&Adjacency::new(10, faces.into()));
        assert_eq!(found.iter().collect::<Vec<_>>(), [[0, 1, 2].map(FaceId::new)]);
    }
}
