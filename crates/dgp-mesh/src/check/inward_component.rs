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
        let at_origin = tetrahedra.iter().map(|&(size, list)| (DVec3::ZERO, size, list));
        inward_at(&at_origin.collect::<Vec<_>>())
    }

    /// The same around these points.
    fn inward_at(tetrahedra: &[(DVec3, f64, [[usize; 3]; 4])]) -> Vec<usize> {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for (k, (center, size, list)) in tetrahedra.iter().enumerate() {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
            positions.extend(corners.map(|p| center + (p - 0.2) * *size));
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
    #[test]
    fn thousands_within_each_other_are_told_apart() {
        let shell =
            |k: usize| (4000.0 - k as f64, if k.is_multiple_of(2) { OUTWARD } else { INWARD });
        let mut shells: Vec<_> = (0..3000).map(shell).collect();
        assert_eq!(inward(&shells), []);
        // Without one of them, those within look the wrong way.
        shells.remove(1501);
        let turned = (1501..2999).filter(|&k| shells[k].1 == INWARD).map(|k| 4 * k);
        assert_eq!(inward(&shells), turned.collect::<Vec<_>>());
    }

    #[test]
    fn thousands_beside_each_other_are_told_apart() {
        let bubble = |k: usize| (DVec3::new(k as f64, 0.0, 0.0), 0.5, INWARD);
        let mut bubbles: Vec<_> = (0..5000).map(bubble).collect();
        assert_eq!(inward_at(&bubbles), (0..5000).map(|k| 4 * k).collect::<Vec<_>>());
        bubbles.push((DVec3::splat(-2.0), 1e5, OUTWARD));
        assert_eq!(inward_at(&bubbles), []);
    }
}
