//! The list of defects, and how it reads.

use std::fmt;

use super::Elements;
use crate::{Error, FaceList, IndexedFaceSet, Progress, VertexId, spatial::TriangleTree};

/// What can be wrong with a face set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum DefectKind {
    /// A vertex with a coordinate that is infinite or not a number.
    NonFiniteVertex,
    /// A face of fewer than three corners.
    ShortFace,
    /// A face of three or more corners that names a vertex twice.
    RepeatedVertex,
    /// An edge that more than two faces share.
    NonManifoldEdge,
    /// An edge along which two faces run in the same direction, so that they disagree on what is
    /// outside.
    MisorientedEdge,
    /// A vertex whose faces do not form a single fan, the ends of non-manifold edges included.
    NonManifoldVertex,
    /// Connected faces that cannot be turned so that all agree on what is outside.
    NonOrientableComponent,
    /// A face with the same vertices in the same order as another.
    DuplicateFace,
    /// A face with the vertices of another in reverse order: two sides of a sheet, or a wall between
    /// two solids.
    OppositeFace,
    /// A face whose corners all lie on one line, exactly.
    ZeroAreaFace,
    /// A closed surface turned inside out, unless it lies within another one as the wall of a cavity.
    InwardComponent,
    /// Faces that pass through each other, or touch in more than what they share. Looked for only by
    /// [`DefectReport::add_self_intersections`].
    SelfIntersection,
    /// A vertex at exactly the place of an earlier one. Legal: seams are made so.
    DuplicateVertex,
    /// A vertex of no face. Legal.
    IsolatedVertex,
    /// A rim of the surface. Legal unless it should be closed.
    BoundaryLoop,
}

/// How bad a defect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The faces are no manifold: no mesh can be made of them as they are.
    Error,
    /// A mesh can be made, but it is hardly what was meant.
    Warning,
    /// Worth knowing.
    Info,
}

/// One kind of defect and all elements that have it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Defect {
    /// What is wrong.
    pub kind: DefectKind,
    /// With which elements: all of them, in order of their ids.
    pub elements: Elements,
}

/// What [`defects`](crate::defects) found.
#[must_use]
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DefectReport {
    /// Each kind that occurs, worst first.
    pub defects: Vec<Defect>,
}

impl DefectKind {
    /// The name in reports, as in `non_manifold_edge`.
    pub fn name(self) -> &'static str {
        match self {
            DefectKind::NonFiniteVertex => "non_finite_vertex",
            DefectKind::ShortFace => "short_face",
            DefectKind::RepeatedVertex => "repeated_vertex",
            DefectKind::NonManifoldEdge => "non_manifold_edge",
            DefectKind::MisorientedEdge => "misoriented_edge",
            DefectKind::NonManifoldVertex => "non_manifold_vertex",
            DefectKind::NonOrientableComponent => "non_orientable_component",
            DefectKind::DuplicateFace => "duplicate_face",
            DefectKind::OppositeFace => "opposite_face",
            DefectKind::ZeroAreaFace => "zero_area_face",
            DefectKind::InwardComponent => "inward_component",
            DefectKind::SelfIntersection => "self_intersection",
            DefectKind::DuplicateVertex => "duplicate_vertex",
            DefectKind::IsolatedVertex => "isolated_vertex",
            DefectKind::BoundaryLoop => "boundary_loop",
        }
    }

    /// How bad it is.
    pub fn severity(self) -> Severity {
        match self {
            DefectKind::NonFiniteVertex
            | DefectKind::ShortFace
            | DefectKind::RepeatedVertex
            | DefectKind::NonManifoldEdge
            | DefectKind::MisorientedEdge
            | DefectKind::NonManifoldVertex
            | DefectKind::NonOrientableComponent => Severity::Error,
            DefectKind::DuplicateFace
            | DefectKind::OppositeFace
            | DefectKind::ZeroAreaFace
            | DefectKind::InwardComponent
            | DefectKind::SelfIntersection => Severity::Warning,
            DefectKind::DuplicateVertex | DefectKind::IsolatedVertex | DefectKind::BoundaryLoop => {
                Severity::Info
            }
        }
    }

    /// What mends it.
    pub fn remedy(self) -> &'static str {
        match self {
            DefectKind::NonFiniteVertex => "`dgp repair` drops them and their faces",
            DefectKind::RepeatedVertex => {
                "`dgp repair` shortens them, or drops them where no polygon is left"
            }
            DefectKind::NonManifoldEdge | DefectKind::NonManifoldVertex => {
                "`dgp repair --split-non-manifold` gives each sheet vertices of its own"
            }
            DefectKind::MisorientedEdge => "`dgp repair --orient` turns faces over",
            DefectKind::NonOrientableComponent => {
                "`dgp repair --orient` cuts them open along the edges that disagree"
            }
            DefectKind::DuplicateFace => "`dgp repair` keeps the first of each",
            DefectKind::OppositeFace => {
                "`dgp repair` drops walls within solids, and one side of a sheet that has two"
            }
            DefectKind::ZeroAreaFace => "`dgp repair --drop-degenerate` removes them",
            DefectKind::InwardComponent => "`dgp repair --orient` turns them",
            DefectKind::SelfIntersection => "`dgp repair` cuts out what meets and fills the holes",
            DefectKind::DuplicateVertex => {
                "`dgp repair --weld 0` joins them where no seam is meant"
            }
            DefectKind::ShortFace | DefectKind::IsolatedVertex => "`dgp repair` drops them",
            DefectKind::BoundaryLoop => {
                "`dgp repair --fill-holes` closes them where the surface should be closed"
            }
        }
    }

    /// What one element, or many of them, have.
    fn sentence(self, count: usize) -> &'static str {
        let one = count == 1;
        match self {
            DefectKind::NonFiniteVertex if one => {
                "vertex has a coordinate that is no finite number"
            }
            DefectKind::NonFiniteVertex => "vertices have coordinates that are no finite numbers",
            DefectKind::ShortFace if one => "face has fewer than three corners",
            DefectKind::ShortFace => "faces have fewer than three corners",
            DefectKind::RepeatedVertex if one => "face names a vertex twice",
            DefectKind::RepeatedVertex => "faces name a vertex twice",
            DefectKind::NonManifoldEdge if one => "edge is shared by more than two faces",
            DefectKind::NonManifoldEdge => "edges are shared by more than two faces",
            DefectKind::MisorientedEdge if one => {
                "edge lies between faces that disagree on the outside"
            }
            DefectKind::MisorientedEdge => "edges lie between faces that disagree on the outside",
            DefectKind::NonManifoldVertex if one => "vertex has faces that form several fans",
            DefectKind::NonManifoldVertex => "vertices have faces that form several fans",
            DefectKind::NonOrientableComponent if one => "component has only one side",
            DefectKind::NonOrientableComponent => "components have only one side",
            DefectKind::DuplicateFace if one => "face repeats an earlier one",
            DefectKind::DuplicateFace => "faces repeat earlier ones",
            DefectKind::OppositeFace if one => "face is the back of an earlier one",
            DefectKind::OppositeFace => "faces are the backs of earlier ones",
            DefectKind::ZeroAreaFace if one => "face has all corners on a line",
            DefectKind::ZeroAreaFace => "faces have all corners on a line",
            DefectKind::InwardComponent if one => "closed surface is inside out",
            DefectKind::InwardComponent => "closed surfaces are inside out",
            DefectKind::SelfIntersection if one => "pair of faces meets beyond what they share",
            DefectKind::SelfIntersection => "pairs of faces meet beyond what they share",
            DefectKind::DuplicateVertex if one => "vertex is where an earlier one is",
            DefectKind::DuplicateVertex => "vertices are where earlier ones are",
            DefectKind::IsolatedVertex if one => "vertex belongs to no face",
            DefectKind::IsolatedVertex => "vertices belong to no face",
            DefectKind::BoundaryLoop if one => "boundary loop",
            DefectKind::BoundaryLoop => "boundary loops",
        }
    }
}

impl Defect {
    /// How many elements have it.
    pub fn count(&self) -> usize {
        self.elements.len()
    }

    /// How bad it is.
    pub fn severity(&self) -> Severity {
        self.kind.severity()
    }

    /// What mends it.
    pub fn remedy(&self) -> &'static str {
        self.kind.remedy()
    }
}

impl DefectReport {
    /// The defect of this kind, if there is one.
    pub fn get(&self, kind: DefectKind) -> Option<&Defect> {
        self.defects.iter().find(|defect| defect.kind == kind)
    }

    /// How many elements have a defect of this kind.
    pub fn count(&self, kind: DefectKind) -> usize {
        self.get(kind).map_or(0, Defect::count)
    }

    /// Whether a mesh can be made of the faces as they are: nothing has severity [`Severity::Error`].
    pub fn is_manifold(&self) -> bool {
        self.of(Severity::Error).next().is_none()
    }

    /// The defects that are just so bad.
    pub fn of(&self, severity: Severity) -> impl Iterator<Item = &Defect> {
        self.defects.iter().filter(move |defect| defect.severity() == severity)
    }

    /// Looks for faces of `set` that pass through each other, and adds them if there are any.
    ///
    /// Faces with a vertex that is not finite, of fewer than three corners or without area are left
    /// out. Cost: that of a [`TriangleTree`] and of its
    /// [`self_intersections`](TriangleTree::self_intersections). Errors: [`Error::Cancelled`].
    ///
    /// ```
    /// use dgp_mesh::{DVec3, DefectKind, FaceList, IndexedFaceSet, Progress, defects};
    ///
    /// // The second triangle stands in the first.
    /// let corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 1], [2, 1, 1]];
    /// let positions = corners.map(|p| DVec3::from_array(p.map(f64::from))).to_vec();
    /// let set = IndexedFaceSet::new(positions, FaceList::from_indices(&[[0, 1, 2], [3, 4, 5]]))?;
    /// let mut report = defects(&set, Progress::NONE)?;
    /// report.add_self_intersections(&set, Progress::NONE)?;
    /// assert_eq!(report.count(DefectKind::SelfIntersection), 1);
    /// # Ok::<(), dgp_mesh::Error>(())
    /// ```
    pub fn add_self_intersections(
        &mut self,
        set: &IndexedFaceSet,
        progress: Progress<'_>,
    ) -> Result<(), Error> {
        let is_finite = |face: &[VertexId]| face.iter().all(|&v| set.position(v).is_finite());
        let mut sources = Vec::with_capacity(set.face_count());
        let mut finite = FaceList::new();
        for (f, face) in set.faces().iter().filter(|(_, face)| is_finite(face)) {
            finite.push(face);
            sources.push(f);
        }
        let finite = IndexedFaceSet::from_valid(set.positions().clone(), finite);
        let tree = TriangleTree::new(&finite, progress.part(0.0, 0.5))?;
        let pairs = tree.self_intersections(progress.part(0.5, 1.0))?;
        let pairs = pairs.into_iter().map(|pair| pair.map(|f| sources[f.index()])).collect();
        self.add(DefectKind::SelfIntersection, Elements::FacePairs(pairs));
        self.sort();
        Ok(())
    }

    pub(super) fn add(&mut self, kind: DefectKind, elements: Elements) {
        if !elements.is_empty() {
            self.defects.push(Defect { kind, elements });
        }
    }

    pub(super) fn sort(&mut self) {
        self.defects.sort_by_key(|defect| (defect.severity(), defect.kind));
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 3;
        let (count, first) = (self.count(), self.elements.first(SHOWN));
        write!(f, "{count} {}: {first}; {}", self.kind.sentence(count), self.remedy())
    }
}

impl fmt::Display for DefectReport {
    /// A line for each kind.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.defects.is_empty() {
            return f.write_str("no defects");
        }
        for (k, defect) in self.defects.iter().enumerate() {
            if k > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{defect}")?;
        }
        Ok(())
    }
}
