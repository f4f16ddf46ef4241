//! No two vertices are at exactly the same place.

use super::Elements;
use crate::{IndexedFaceSet, weld_exact};

/// The vertices at the place of an earlier one, each with the first one there.
pub(super) fn find(set: &IndexedFaceSet) -> Elements {
    let finite = |&[v, _]: &[crate::VertexId; 2]| set.position(v).is_finite();
    Elements::VertexPairs(weld_exact(set.positions().values()).merges().filter(finite).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DVec3, FaceList, VertexId};

    fn pairs(positions: Vec<DVec3>) -> Elements {
        find(&IndexedFaceSet::new(positions, FaceList::new()).unwrap())
    }

    #[test]
    fn close_is_not_the_same() {
        assert!(pairs(vec![DVec3::ONE, DVec3::splat(1.0 + f64::EPSILON), DVec3::NAN]).is_empty());
    }

    #[test]
    fn the_same_is_found() {
        let found = pairs(vec![DVec3::X, DVec3::ZERO, -DVec3::ZERO, DVec3::X, DVec3::X]);
        let expected = [[2, 1], [3, 0], [4, 0]].map(|pair| pair.map(VertexId::new));
        assert_eq!(found, Elements::VertexPairs(expected.to_vec()));
    }
}
