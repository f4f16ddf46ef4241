//! Each face has at least three corners.

use crate::{FaceId, FaceList};

/// The faces with fewer.
pub(super) fn find(faces: &FaceList) -> Vec<FaceId> {
    if faces.uniform_degree().is_some_and(|degree| degree >= 3) {
        return Vec::new();
    }
    faces.iter().filter(|(_, face)| face.len() < 3).map(|(f, _)| f).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_corners_are_enough() {
        assert!(find(&FaceList::from_indices::<&[usize]>(&[&[0, 1, 2], &[0, 1, 2, 3]])).is_empty());
    }

    #[test]
    fn fewer_are_not() {
        let faces = FaceList::from_indices::<&[usize]>(&[&[0, 1], &[0, 1, 2], &[], &[3]]);
        assert_eq!(find(&faces), [0, 2, 3].map(FaceId::new));
        assert_eq!(find(&FaceList::from_indices(&[[0, 1]])), [FaceId::new(0)]);
    }
}
