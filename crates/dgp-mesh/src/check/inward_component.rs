//! Closed surfaces have their outside outside.

use glam::DVec3;

use super::{Groups, adjacency::Adjacency, components::Solids};
use crate::{FaceId, VertexMap};

/// The closed components of negative volume that are not walls of cavities.
pub(super) fn find(positions: &VertexMap<DVec3>, adjacency: &Adjacency) -> Groups<FaceId> {
    Solids::new(positions, adjacency).inward()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceList;

    const OUTWARD: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    const INWARD: [[usize; 3]; 4] = [[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]];

    /// The first faces of the inward ones among tetrahedra of these sizes around one point.
    fn inward(tetrahedra: &[(f64, [[usize; 3]; 4])]) -> Vec<usize> {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for (k, (size, list)) in tetrahedra.iter().enumerate() {
            positions
                .extend([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| (p - 0.2) * *size));
            faces.extend(list.iter().map(|face| face.map(|v| v + 4 * k)));
        }
        let faces = FaceList::from_indices(&faces);
        let adjacency = Adjacency::new(positions.len(), faces.into());
        let found = find(&positions.into(), &adjacency);
        found.iter().map(|group| group[0].index()).collect()
    }

    #[test]
    fn a_cavity_is_fine() {
        assert_eq!(inward(&[(1.0, OUTWARD)]), []);
        assert_eq!(inward(&[(1.0, OUTWARD), (0.5, INWARD), (0.25, OUTWARD)]), []);
        assert_eq!(inward(&[(1.0, OUTWARD), (0.5, OUTWARD)]), []);
    }

    #[test]
    fn an_outermost_surface_inside_out_is_not() {
        assert_eq!(inward(&[(1e200, INWARD)]), [0]);
        assert_eq!(inward(&[(0.5, INWARD), (1.0, INWARD)]), [4]);
        assert_eq!(inward(&[(1.0, OUTWARD), (0.5, OUTWARD), (0.25, INWARD)]), [8]);
    }
}
