//! Each vertex belongs to a face.

use super::Elements;
use crate::{IndexedFaceSet, VertexMap};

/// The vertices of no face.
pub(super) fn find(set: &IndexedFaceSet) -> Elements {
    let mut used = VertexMap::filled(set.vertex_count(), false);
    for &v in set.faces().corners() {
        used[v] = true;
    }
    Elements::Vertices(used.iter().filter(|&(_, &used)| !used).map(|(v, _)| v).collect())
}

#[cfg(test)]
mod tests {
    use super::super::tests::set;
    use super::*;
    use crate::VertexId;

    #[test]
    fn a_vertex_of_a_face_is_fine() {
        assert!(find(&set(3, &[[0, 1, 2]])).is_empty());
    }

    #[test]
    fn a_vertex_of_no_face_is_found() {
        assert_eq!(find(&set(4, &[[0, 1, 3]])), Elements::Vertices(vec![VertexId::new(2)]));
    }
}
