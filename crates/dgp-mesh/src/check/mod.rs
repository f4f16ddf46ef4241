//! What is wrong with faces: every defect of an indexed face set, with the elements that have it.
//!
//! One invariant a file. The checks build on each other: faces of fewer than three distinct corners are
//! reported once and take part in nothing else, and a side that more than two faces share belongs to
//! no fan. Self-intersections are no matter of connectivity: a report looks for them where asked to.
//!
//! - Input: any face set.
//! - Cost: O(F) time and memory, a little over that where many faces share two vertices.
//! - Reference: Guéziec, Taubin, Lazarus & Horn, "Cutting and stitching: converting sets of polygons
//!   to manifold surfaces", IEEE TVCG 2001, for the terms.

mod boundary_loop;
mod depth;
mod duplicate_face;
mod duplicate_vertex;
mod elements;
mod inward_component;
mod isolated_vertex;
mod larger;
mod misoriented_edge;
mod non_finite_vertex;
mod non_manifold_edge;
mod non_manifold_vertex;
mod non_orientable_component;
mod repeated_vertex;
mod report;
mod short_face;
mod zero_area_face;

pub(crate) mod adjacency;
pub(crate) mod components;
pub(crate) mod orientation;
pub(crate) mod union;

pub use elements::{Elements, Groups};
pub use report::{Defect, DefectKind, DefectReport, Severity};

pub(crate) use boundary_loop::following;
pub(crate) use duplicate_face::{Duplicates, duplicates};
pub(crate) use non_manifold_vertex::fans_per_vertex;
pub(crate) use repeated_vertex::Repeats;
pub(crate) use zero_area_face::is_flat;

use std::sync::Arc;

use crate::{Error, FaceId, FaceList, IndexedFaceSet, Progress};
use adjacency::Adjacency;

/// Every defect of `set`, worst first, with all elements that have it. Errors: [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{DVec3, DefectKind, FaceList, IndexedFaceSet, Progress, defects};
///
/// // Three triangles on the edge between vertices 0 and 1.
/// let faces = FaceList::from_indices(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
/// let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Y];
/// let report = defects(&IndexedFaceSet::new(positions, faces)?, Progress::NONE)?;
/// assert!(!report.is_manifold());
/// let edges = report.get(DefectKind::NonManifoldEdge).unwrap();
/// assert_eq!(format!("{:?}", edges.elements), "Edges([[v0, v1]])");
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
pub fn defects(set: &IndexedFaceSet, progress: Progress<'_>) -> Result<DefectReport, Error> {
    let mut report = DefectReport::default();
    progress.report(0.0)?;
    report.add(DefectKind::NonFiniteVertex, non_finite_vertex::find(set));
    report.add(DefectKind::IsolatedVertex, isolated_vertex::find(set));
    report.add(DefectKind::DuplicateVertex, duplicate_vertex::find(set));
    progress.report(0.2)?;
    let short = short_face::find(set.faces());
    let repeating = repeated_vertex::find(set.faces());
    report.add(DefectKind::ZeroAreaFace, zero_area_face::find(set));
    let polygons = Polygons::new(set.faces(), &short, &repeating);
    report.add(DefectKind::ShortFace, Elements::Faces(short));
    report.add(DefectKind::RepeatedVertex, Elements::Faces(repeating));
    progress.report(0.3)?;
    let Duplicates { same, opposite } = duplicates(set.vertex_count(), &polygons.faces);
    report.add(DefectKind::DuplicateFace, polygons.original_pairs(same));
    report.add(DefectKind::OppositeFace, polygons.original_pairs(opposite));
    progress.report(0.4)?;
    let adjacency = Adjacency::new(set.vertex_count(), polygons.faces.clone());
    progress.report(0.6)?;
    report.add(DefectKind::NonManifoldEdge, non_manifold_edge::find(&adjacency));
    report.add(DefectKind::MisorientedEdge, misoriented_edge::find(&adjacency));
    report.add(DefectKind::NonManifoldVertex, non_manifold_vertex::find(&adjacency));
    progress.report(0.8)?;
    let non_orientable = non_orientable_component::find(&adjacency);
    report.add(DefectKind::NonOrientableComponent, polygons.original_groups(non_orientable));
    let inward = inward_component::find(set.positions(), &adjacency);
    report.add(DefectKind::InwardComponent, polygons.original_groups(inward));
    report.add(DefectKind::BoundaryLoop, boundary_loop::find(&adjacency));
    progress.report(1.0)?;
    report.sort();
    Ok(report)
}

/// The faces that have at least three corners, all distinct.
struct Polygons {
    faces: Arc<FaceList>,
    /// Their numbers in the whole list, where that has others too.
    originals: Option<Vec<FaceId>>,
}

impl Polygons {
    fn new(faces: &FaceList, short: &[FaceId], repeating: &[FaceId]) -> Self {
        if short.is_empty() && repeating.is_empty() {
            return Polygons { faces: Arc::new(faces.clone()), originals: None };
        }
        let out: crate::FaceSet = short.iter().chain(repeating).copied().collect();
        let mut kept = FaceList::new();
        let mut originals = Vec::new();
        for (f, face) in faces.iter().filter(|&(f, _)| !out.contains(f)) {
            kept.push(face);
            originals.push(f);
        }
        Polygons { faces: Arc::new(kept), originals: Some(originals) }
    }

    fn original(&self, f: FaceId) -> FaceId {
        self.originals.as_ref().map_or(f, |originals| originals[f.index()])
    }

    fn original_pairs(&self, pairs: Vec<[FaceId; 2]>) -> Elements {
        Elements::FacePairs(pairs.into_iter().map(|pair| pair.map(|f| self.original(f))).collect())
    }

    fn original_groups(&self, mut groups: Groups<FaceId>) -> Elements {
        for f in groups.members_mut() {
            *f = self.original(*f);
        }
        Elements::FaceGroups(groups)
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::{DVec3, Mesh};
    use proptest::prelude::*;

    /// Vertices in general position.
    pub(super) fn set<F: AsRef<[usize]>>(vertices: usize, faces: &[F]) -> IndexedFaceSet {
        let at = |i: usize| {
            let t = i as f64;
            DVec3::new((1.3 * t).sin(), (2.1 * t + 0.4).cos(), (0.7 * t * t).sin())
        };
        IndexedFaceSet::new(
            (0..vertices).map(at).collect::<Vec<_>>(),
            FaceList::from_indices(faces),
        )
        .unwrap()
    }

    #[test]
    fn a_tetrahedron_has_no_defects_and_its_report_says_so() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = FaceList::from_indices(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        let tetrahedron = IndexedFaceSet::new(positions, faces).unwrap();
        let report = defects(&tetrahedron, Progress::NONE).unwrap();
        assert!(report.defects.is_empty() && report.is_manifold());
        assert_eq!(report.to_string(), "no defects");
    }

    #[test]
    fn reports_name_elements_and_remedies() {
        let fan = set(6, &[&[0, 1, 2][..], &[1, 0, 3], &[0, 1, 4], &[4, 4, 3], &[1, 2]]);
        let report = defects(&fan, Progress::NONE).unwrap();
        let text = report.to_string();
        for part in ["1 face names a vertex twice: f3", "f4", "v0–v1", "--split-non-manifold"] {
            assert!(text.contains(part), "{part} is missing in\n{text}");
        }
        assert_eq!(report.get(DefectKind::IsolatedVertex).unwrap().count(), 1);
    }

    #[test]
    fn it_stops_when_asked_to() {
        for reports in 0..6 {
            let left = std::sync::atomic::AtomicI32::new(reports);
            let stop = |_| match left.fetch_sub(1, std::sync::atomic::Ordering::Relaxed) {
                0 => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            };
            let result = defects(&set(3, &[[0, 1, 2]]), Progress::new(&stop));
            assert!(matches!(result, Err(Error::Cancelled(_))), "report {reports}");
        }
    }

    proptest! {
        #[test]
        fn a_report_without_errors_is_what_a_mesh_needs(
            faces in prop::collection::vec(prop::collection::vec(0_usize..7, 0..6), 0..9),
        ) {
            let set = set(7, &faces);
            let report = defects(&set, Progress::NONE).unwrap();
            prop_assert_eq!(report.is_manifold(), Mesh::new(&set).is_ok(), "{}", report);
        }
    }
}
