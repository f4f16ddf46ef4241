//! Welding: vertices at the same place become one.
//!
//! Two ways to say what the same place is. *Exact*: all three coordinates are equal (−0 equals 0). One
//! pass with a hash table over the bits. *Within a distance d*: chains of vertices, each at most d from
//! the next, become one vertex. These are the connected parts of the graph that joins all pairs within
//! d, so the result depends on no order. They are found by walking pairs of boxes of a k-d tree, where
//! a box of diagonal ≤ d is joined as a whole, so that dense data cost no more than sparse data.
//!
//! The first of the old vertices gives position and data, and the new ones are numbered in the order of
//! those. Coordinates that are no numbers equal each other bit for bit and are near nothing.
//!
//! - Input: any points.
//! - Cost: exact O(V); within a distance O(V log V) on all but contrived input.
//! - Guarantees: independent of threads; scaling points and distance by 2ᵏ changes nothing.
//! - Reference: none for the exact form; Bentley & Friedman, "Data structures for range searching",
//!   ACM Computing Surveys 1979, for the tree.

mod near;
mod table;

use glam::DVec3;

use crate::{
    AttributeTable, CornerId, Error, FaceId, FaceList, IndexedFaceSet, Progress, VertexId,
    VertexMap, check::Repeats,
};

/// Which vertices are at the same place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// Those with equal coordinates.
    Exact,
    /// Those up to this far apart, in the unit of the coordinates.
    Distance(f64),
    /// Those up to this fraction of the diagonal of the bounding box apart.
    OfDiagonal(f64),
}

/// Which vertices became one.
#[must_use]
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Welding {
    /// The new vertex each old one is part of.
    pub vertices: VertexMap<VertexId>,
    /// The first old vertex in each new one, in ascending order.
    pub originals: VertexMap<VertexId>,
}

/// What [`weld`] did.
#[must_use]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeldReport {
    /// Which vertices became one.
    pub welding: Welding,
    /// How many vertices went into others.
    pub merged: usize,
    /// How far a vertex moved at most. Chains can make it longer than the tolerance.
    pub largest_move: f64,
    /// Faces that had distinct corners and now name a vertex twice.
    pub collapsed_faces: Vec<FaceId>,
    /// Columns of vertex data that differed between vertices that became one. They are data per
    /// corner now, so that seams keep both values.
    pub moved_to_corners: Vec<String>,
}

impl Welding {
    /// How many vertices went into others.
    pub fn merged(&self) -> usize {
        self.vertices.len() - self.originals.len()
    }

    /// The old vertices that went into others, each with the first one of its place.
    pub fn merges(&self) -> impl Iterator<Item = [VertexId; 2]> + '_ {
        self.vertices.iter().map(|(old, &new)| [old, self.originals[new]]).filter(|[v, w]| v != w)
    }
}

/// The vertices with equal coordinates as one.
///
/// ```
/// use dgp_mesh::{DVec3, weld_exact};
///
/// let welding = weld_exact(&[DVec3::X, DVec3::ZERO, DVec3::new(1.0, -0.0, 0.0)]);
/// assert_eq!(format!("{:?}", welding.vertices.values()), "[v0, v1, v0]");
/// ```
pub fn weld_exact(points: &[DVec3]) -> Welding {
    table::weld(points)
}

/// The vertices that chains of steps up to `tolerance` join as one.
///
/// Errors: [`Error::InvalidOption`] if the tolerance is negative or not a number,
/// [`Error::Cancelled`].
pub fn weld_within(
    points: &[DVec3],
    tolerance: Tolerance,
    progress: Progress<'_>,
) -> Result<Welding, Error> {
    progress.report(0.0)?;
    let (name, value) = match tolerance {
        Tolerance::Exact => return Ok(weld_exact(points)),
        Tolerance::Distance(distance) => ("distance", distance),
        Tolerance::OfDiagonal(fraction) => ("fraction of the diagonal", fraction),
    };
    if !(0.0..f64::INFINITY).contains(&value) {
        return Err(Error::option(name, value, "a number that is not negative"));
    }
    let exact = weld_exact(points);
    near::weld(points, exact, tolerance, progress)
}

/// `set` with its vertices welded; faces, corners and their data stay in order.
///
/// Faces that name a vertex twice afterwards are kept and reported. Errors as [`weld_within`].
///
/// ```
/// use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Mesh, Progress, Tolerance, weld};
///
/// // Two triangles of a square, each with vertices of its own.
/// let (a, b, c, d) = (DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y);
/// let faces = FaceList::from_indices(&[[0, 1, 2], [3, 4, 5]]);
/// let soup = IndexedFaceSet::new(vec![a, b, c, a, c, d], faces)?;
/// let (square, report) = weld(&soup, Tolerance::Exact, Progress::NONE)?;
/// assert_eq!((report.merged, Mesh::new(&square)?.edge_count()), (2, 5));
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
pub fn weld(
    set: &IndexedFaceSet,
    tolerance: Tolerance,
    progress: Progress<'_>,
) -> Result<(IndexedFaceSet, WeldReport), Error> {
    let points = set.positions().values();
    let welding = weld_within(points, tolerance, progress)?;
    let welded = weld_as(set, welding);
    progress.report(1.0)?;
    Ok(welded)
}

/// `set` with those vertices made one that `welding` makes one; faces, corners and their data stay in
/// order.
///
/// Faces that name a vertex twice afterwards are kept and reported. What is to be one is the caller's
/// to say: [`weld`] takes all vertices that are near each other.
///
/// # Panics
/// If `welding` is of another number of vertices.
pub fn weld_as(set: &IndexedFaceSet, welding: Welding) -> (IndexedFaceSet, WeldReport) {
    assert_eq!(welding.vertices.len(), set.vertex_count(), "a class for each vertex");
    let mut faces = set.faces().clone();
    for v in faces.corners_mut() {
        *v = welding.vertices[*v];
    }
    let originals = &welding.originals;
    let positions: VertexMap<DVec3> = originals.map(|&v| set.position(v));
    let largest_move = welding.merges().map(|[v, w]| set.position(v).distance(set.position(w)));
    let largest_move = largest_move.filter(|d| d.is_finite()).fold(0.0, f64::max);
    let collapsed_faces = newly_repeating(set.faces(), &faces);

    let mut welded = IndexedFaceSet::from_valid(positions, faces);
    let moved_to_corners = seams(set, &welding, &mut welded.corner_attributes);
    welded.vertex_attributes =
        set.vertex_attributes.gather(originals.len(), |v| Some(originals[v]));
    for name in &moved_to_corners {
        welded.vertex_attributes.remove(name);
    }
    welded.face_attributes = set.face_attributes.clone();
    let merged = welding.merged();
    (welded, WeldReport { welding, merged, largest_move, collapsed_faces, moved_to_corners })
}

/// Sets the corner data of the welded set: that of `set` and the vertex data that welding would lose.
/// Returns the names of the latter.
pub(crate) fn seams(
    set: &IndexedFaceSet,
    welding: &Welding,
    corner_attributes: &mut AttributeTable<CornerId>,
) -> Vec<String> {
    *corner_attributes = set.corner_attributes.clone();
    if set.vertex_attributes.is_empty() || welding.merged() == 0 {
        return Vec::new();
    }
    let mut names = set.vertex_attributes.differing(welding.merges());
    // Where corners have data of that name already, those are the finer ones.
    names.retain(|name| !corner_attributes.contains(name));
    if !names.is_empty() {
        let corners = set.faces().corners();
        let per_corner =
            set.vertex_attributes.gather(corners.len(), |c: CornerId| Some(corners[c.index()]));
        corner_attributes.append(per_corner, |name| names.iter().any(|other| other == name));
    }
    names
}

/// The faces that name a vertex twice in `after` but not in `before`.
fn newly_repeating(before: &FaceList, after: &FaceList) -> Vec<FaceId> {
    let mut repeats = Repeats::default();
    let new = after.iter().filter(|&(f, face)| repeats.any(face) && !repeats.any(before.face(f)));
    new.map(|(f, _)| f).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::UV;
    use glam::DVec2;
    use proptest::prelude::*;

    #[test]
    fn the_first_of_equal_points_stays() {
        let (a, b) = (DVec3::ZERO, DVec3::new(0.0, 1e-300, 0.0));
        let welding = weld_exact(&[a, b, -a, b, DVec3::X]);
        assert_eq!(welding.vertices.values(), [0, 1, 0, 1, 2].map(VertexId::new));
        assert_eq!(welding.originals.values(), [0, 1, 4].map(VertexId::new));
        assert_eq!(weld_exact(&[]), Welding::default());
    }

    #[test]
    fn chains_within_the_tolerance_become_one_vertex() {
        let points = [0.0, 10.0, 1.0, 2.0, 3.5].map(|x| DVec3::new(x, 0.0, 0.0));
        let classes = |tolerance| {
            let welding = weld_within(&points, tolerance, Progress::NONE).unwrap();
            welding.vertices.values().iter().map(|v| v.index()).collect::<Vec<_>>()
        };
        assert_eq!(classes(Tolerance::Distance(0.99)), [0, 1, 2, 3, 4]);
        assert_eq!(classes(Tolerance::Distance(1.0)), [0, 1, 0, 0, 2]);
        assert_eq!(classes(Tolerance::OfDiagonal(0.15)), [0, 1, 0, 0, 0]);
        assert_eq!(classes(Tolerance::Distance(0.0)), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn faces_that_collapse_are_reported() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.1, 0.0, 0.0)];
        let faces = FaceList::from_indices(&[[0, 1, 2], [1, 3, 2], [0, 0, 1]]);
        let set = IndexedFaceSet::new(positions, faces).unwrap();
        let (welded, report) = weld(&set, Tolerance::Distance(0.2), Progress::NONE).unwrap();
        assert_eq!(report.collapsed_faces, [FaceId::new(1)]);
        assert_eq!((welded.vertex_count(), welded.face_count()), (3, 3));
        assert!((report.largest_move - 0.1).abs() < 1e-15);
    }

    #[test]
    fn seams_move_to_the_corners() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X, DVec3::ONE, DVec3::Y];
        let faces = FaceList::from_indices(&[[0, 1, 2], [3, 4, 5]]);
        let mut set = IndexedFaceSet::new(positions, faces).unwrap();
        let uv: Vec<_> = (0..6).map(|i| DVec2::splat(f64::from(i))).collect();
        set.vertex_attributes.insert(UV, uv.clone());
        set.vertex_attributes.insert("height", vec![0.0, 1.0, 2.0, 1.0, 4.0, 2.0]);
        let (welded, report) = weld(&set, Tolerance::Exact, Progress::NONE).unwrap();
        assert_eq!(report.moved_to_corners, [UV]);
        assert_eq!(welded.corner_attributes.get::<DVec2>(UV).unwrap().values(), uv);
        assert!(!welded.vertex_attributes.contains(UV));
        let height = welded.vertex_attributes.get::<f64>("height").unwrap();
        assert_eq!(height.values(), [0.0, 1.0, 2.0, 4.0]);
    }

    #[test]
    fn a_million_points_in_a_lump_do_not_take_a_million_squared() {
        let lump = |i: usize| DVec3::new(i as f64, (i * 7 % 1000) as f64, (i * 3 % 17) as f64);
        let points: Vec<_> = (0..200_000).map(|i| lump(i) * 1e-9).collect();
        let welding = weld_within(&points, Tolerance::Distance(1.0), Progress::NONE).unwrap();
        assert_eq!(welding.originals.len(), 1);
    }

    #[test]
    fn bad_tolerances_are_refused_and_runs_can_be_cancelled() {
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let result = weld_within(&[], Tolerance::Distance(bad), Progress::NONE);
            assert!(matches!(result, Err(Error::InvalidOption { .. })));
        }
        let stop = |_| ControlFlow::Break(());
        let result = weld_within(&[DVec3::X], Tolerance::Exact, Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))));
    }

    proptest! {
        #[test]
        fn clusters_equal_those_of_all_pairs(
            grid in prop::collection::vec([-4_i32..4, -4..4, -2..2], 0..60),
            steps in 0_u8..6,
            exponent in -600_i32..600,
        ) {
            let scale = 2.0_f64.powi(exponent);
            let points: Vec<_> =
                grid.iter().map(|&[x, y, z]| DVec3::new(x.into(), y.into(), z.into())).collect();
            let scaled: Vec<_> = points.iter().map(|&p| p * scale).collect();
            let distance = f64::from(steps) * 0.5;
            let welding =
                weld_within(&scaled, Tolerance::Distance(distance * scale), Progress::NONE).unwrap();

            let mut class: Vec<usize> = (0..points.len()).collect();
            loop {
                let before = class.clone();
                for i in 0..points.len() {
                    for j in 0..points.len() {
                        if points[i].distance(points[j]) <= distance {
                            class[i] = class[i].min(class[j]);
                        }
                    }
                }
                if class == before {
                    break;
                }
            }
            let first: Vec<_> =
                welding.vertices.values().iter().map(|&v| welding.originals[v].index()).collect();
            prop_assert_eq!(first, class);
        }

        #[test]
        fn exact_classes_equal_those_of_sorting(
            grid in prop::collection::vec([-2_i32..3, -2..3, 0..2], 0..200),
        ) {
            let points: Vec<_> =
                grid.iter().map(|&[x, y, z]| DVec3::new(x.into(), y.into(), z.into())).collect();
            prop_assert_eq!(table::weld(&points), table::weld_sorted(&points));
        }
    }
}
