//! What a repair changed.

use crate::{Elements, FaceId, FaceMap, VertexId, VertexMap};

/// What was done to some elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum RepairAction {
    /// Vertices went into others at the same place: vertex pairs.
    MergeVertices,
    /// Faces with a coordinate that is no finite number were dropped: faces.
    DropNonFiniteFaces,
    /// Vertices with such a coordinate were dropped: vertices.
    DropNonFiniteVertices,
    /// Faces lost repeated corners: faces.
    ShortenFaces,
    /// Faces visit a vertex more than once around a hole or a neck, and got copies of it: faces.
    CopyCorners,
    /// Faces of fewer than three distinct corners were dropped: faces.
    DropShortFaces,
    /// Faces that repeat another one were dropped: face pairs.
    DropDuplicateFaces,
    /// Faces that lie back to back were dropped: both of a wall, one of a sheet: faces.
    DropOppositeFaces,
    /// Faces were turned over: faces.
    TurnFaces,
    /// The surface was cut where it has only one side, or where faces disagree and were to stay so:
    /// edges.
    CutEdges,
    /// At edges of more than two faces it was decided which belong together: edges.
    SeparateEdges,
    /// Vertices of several fans got a copy for each but the first: vertices, once for each copy.
    SplitVertices,
    /// Closed components inside out were turned: face groups.
    TurnComponents,
    /// Components were dropped: face groups.
    DropComponents,
    /// Faces of zero area were removed, with a vertex merged or given to the face across: faces.
    RemoveFlatFaces,
    /// Faces of zero area were to be removed, but that would have broken the manifold: faces.
    LeaveFlatFaces,
    /// Holes were filled: loops.
    FillHoles,
    /// Holes were to be filled, but each way to do that would break the manifold: loops.
    LeaveHoles,
    /// Vertices of no face were dropped: vertices.
    DropIsolatedVertices,
}

/// Elements to which the same was done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// What was done.
    pub action: RepairAction,
    /// To which elements, by their ids in the input; a copy of a vertex has the id of that.
    pub elements: Elements,
}

/// What [`repair`](crate::repair()) changed.
#[must_use]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RepairReport {
    /// The changes in the order of the steps; none if the input was fine.
    pub changes: Vec<Change>,
    /// What became of each vertex of the input: its first copy, `None` if it was dropped.
    pub vertices: VertexMap<Option<VertexId>>,
    /// The vertex of the input that each vertex is, or is a copy of.
    pub vertex_sources: VertexMap<VertexId>,
    /// What became of each face of the input, `None` if it was dropped.
    pub faces: FaceMap<Option<FaceId>>,
    /// The face of the input that each face was, `None` if it fills a hole.
    pub face_sources: FaceMap<Option<FaceId>>,
}

impl RepairReport {
    /// The elements to which this was done.
    pub fn get(&self, action: RepairAction) -> Option<&Elements> {
        self.changes.iter().find(|change| change.action == action).map(|change| &change.elements)
    }

    /// To how many elements this was done.
    pub fn count(&self, action: RepairAction) -> usize {
        self.get(action).map_or(0, Elements::len)
    }
}

impl RepairAction {
    /// The step of the repair, as in `weld`.
    pub fn step(self) -> &'static str {
        match self {
            RepairAction::MergeVertices => "weld",
            RepairAction::DropNonFiniteFaces | RepairAction::DropNonFiniteVertices => "non_finite",
            RepairAction::ShortenFaces
            | RepairAction::CopyCorners
            | RepairAction::DropShortFaces => "degenerate_faces",
            RepairAction::DropDuplicateFaces | RepairAction::DropOppositeFaces => "duplicate_faces",
            RepairAction::TurnFaces | RepairAction::CutEdges | RepairAction::TurnComponents => {
                "orient"
            }
            RepairAction::SeparateEdges | RepairAction::SplitVertices => "split_non_manifold",
            RepairAction::DropComponents => "components",
            RepairAction::RemoveFlatFaces | RepairAction::LeaveFlatFaces => "flat_faces",
            RepairAction::FillHoles | RepairAction::LeaveHoles => "fill_holes",
            RepairAction::DropIsolatedVertices => "isolated_vertices",
        }
    }

    /// The name in reports, as in `merge_vertices`.
    pub fn name(self) -> &'static str {
        match self {
            RepairAction::MergeVertices => "merge_vertices",
            RepairAction::DropNonFiniteFaces => "drop_non_finite_faces",
            RepairAction::DropNonFiniteVertices => "drop_non_finite_vertices",
            RepairAction::ShortenFaces => "shorten_faces",
            RepairAction::CopyCorners => "copy_corners",
            RepairAction::DropShortFaces => "drop_short_faces",
            RepairAction::DropDuplicateFaces => "drop_duplicate_faces",
            RepairAction::DropOppositeFaces => "drop_opposite_faces",
            RepairAction::TurnFaces => "turn_faces",
            RepairAction::CutEdges => "cut_edges",
            RepairAction::SeparateEdges => "separate_edges",
            RepairAction::SplitVertices => "split_vertices",
            RepairAction::TurnComponents => "turn_components",
            RepairAction::DropComponents => "drop_components",
            RepairAction::RemoveFlatFaces => "remove_flat_faces",
            RepairAction::LeaveFlatFaces => "leave_flat_faces",
            RepairAction::FillHoles => "fill_holes",
            RepairAction::LeaveHoles => "leave_holes",
            RepairAction::DropIsolatedVertices => "drop_isolated_vertices",
        }
    }
}
