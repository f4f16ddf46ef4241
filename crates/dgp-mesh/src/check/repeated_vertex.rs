//! No face names a vertex twice.

use crate::{FaceId, FaceList, VertexId, parallel};

/// The faces of three or more corners that do.
pub(super) fn find(faces: &FaceList) -> Vec<FaceId> {
    let blocks = parallel::map_blocks(faces.len(), parallel::BLOCK, |block| {
        let mut repeats = Repeats::default();
        let repeating = |&f: &FaceId| {
            let face = faces.face(f);
            face.len() >= 3 && repeats.any(face)
        };
        block.map(FaceId::new).filter(repeating).collect::<Vec<_>>()
    });
    blocks.concat()
}

/// Tells whether faces repeat a vertex; keeps its memory from one to the next.
#[derive(Default)]
pub(crate) struct Repeats {
    sorted: Vec<VertexId>,
}

impl Repeats {
    /// Whether `face` names a vertex twice.
    #[inline]
    pub(crate) fn any(&mut self, face: &[VertexId]) -> bool {
        if let [a, b, c] = *face {
            return a == b || b == c || c == a;
        }
        self.sorted.clear();
        self.sorted.extend_from_slice(face);
        self.sorted.sort_unstable();
        self.sorted.windows(2).any(|pair| pair[0] == pair[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distinct_corners_are_fine() {
        assert!(find(&FaceList::from_indices::<&[usize]>(&[&[0, 1, 2], &[3, 0, 1, 2]])).is_empty());
    }

    #[test]
    fn repetitions_are_found_next_to_each_other_and_apart() {
        let faces: &[&[usize]] =
            &[&[0, 1, 1], &[0, 1, 2], &[0, 1, 0, 2], &[4, 1, 2, 3, 4], &[5, 5]];
        assert_eq!(find(&FaceList::from_indices(faces)), [0, 2, 3].map(FaceId::new));
    }
}
