//! Coordinates are finite numbers.

use super::Elements;
use crate::IndexedFaceSet;

/// The vertices with another coordinate.
pub(super) fn find(set: &IndexedFaceSet) -> Elements {
    let bad = set.positions().iter().filter(|(_, p)| !p.is_finite());
    Elements::Vertices(bad.map(|(v, _)| v).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DVec3, FaceList};

    fn count(positions: Vec<DVec3>) -> usize {
        find(&IndexedFaceSet::new(positions, FaceList::new()).unwrap()).len()
    }

    #[test]
    fn large_numbers_are_fine() {
        assert_eq!(count(vec![DVec3::MAX, DVec3::MIN, DVec3::splat(5e-324)]), 0);
    }

    #[test]
    fn infinities_and_what_is_no_number_are_not() {
        assert_eq!(count(vec![DVec3::NAN, DVec3::ZERO, DVec3::new(0.0, f64::INFINITY, 0.0)]), 2);
    }
}
