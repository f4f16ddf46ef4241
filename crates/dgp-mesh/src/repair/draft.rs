//! The faces under repair, and where each element came from.

use std::sync::Arc;

use glam::DVec3;

use super::{Change, RepairAction};
use crate::{
    CornerId, Elements, Error, FaceId, FaceList, IndexedFaceSet, MAX_ELEMENTS, VertexId, VertexMap,
    VertexSet, Welding, check::adjacency::Adjacency,
};

/// Positions and faces that change, with the elements of the (welded) input they go back to.
pub(super) struct Draft {
    pub(super) positions: VertexMap<DVec3>,
    pub(super) faces: Arc<FaceList>,
    /// The vertex of the input that each vertex is a copy of.
    pub(super) vertex_sources: Vec<VertexId>,
    /// The corner of the input that each corner takes its data from.
    pub(super) corner_sources: Vec<CornerId>,
    /// The face of the input that each face takes its data from.
    pub(super) face_sources: Vec<FaceId>,
    /// The faces from here on fill holes.
    pub(super) filled_from: Option<usize>,
    /// Vertices of the input that went into others after welding.
    pub(super) merged: Vec<[VertexId; 2]>,
    pub(super) welding: Option<Welding>,
    pub(super) changes: Vec<Change>,
    adjacency: Option<Adjacency>,
}

impl Draft {
    pub(super) fn new(
        base: &IndexedFaceSet,
        welding: Option<Welding>,
        changes: Vec<Change>,
    ) -> Self {
        Draft {
            positions: base.positions().clone(),
            faces: Arc::new(base.faces().clone()),
            vertex_sources: (0..base.vertex_count()).map(VertexId::new).collect(),
            corner_sources: (0..base.faces().corners().len()).map(CornerId::new).collect(),
            face_sources: (0..base.face_count()).map(FaceId::new).collect(),
            filled_from: None,
            merged: Vec::new(),
            welding,
            changes,
            adjacency: None,
        }
    }

    /// The vertex of the input that `v` is, or is a copy of.
    pub(super) fn input_vertex(&self, v: VertexId) -> VertexId {
        let source = self.vertex_sources[v.index()];
        self.welding.as_ref().map_or(source, |welding| welding.originals[source])
    }

    /// The face of the input that `f` is.
    pub(super) fn input_face(&self, f: FaceId) -> FaceId {
        self.face_sources[f.index()]
    }

    pub(super) fn input_faces(&self, faces: &[FaceId]) -> Elements {
        Elements::Faces(faces.iter().map(|&f| self.input_face(f)).collect())
    }

    /// Notes what was done, if it was done to anything.
    pub(super) fn record(&mut self, action: RepairAction, elements: Elements) {
        if !elements.is_empty() {
            self.changes.push(Change { action, elements });
        }
    }

    /// How the faces lie side by side.
    pub(super) fn adjacency(&mut self) -> &Adjacency {
        let adjacency = self.take_adjacency();
        self.adjacency.insert(adjacency)
    }

    /// The same, to be changed, or to be kept while faces change.
    pub(super) fn take_adjacency(&mut self) -> Adjacency {
        let build = || Adjacency::new(self.positions.len(), self.faces.clone());
        self.adjacency.take().unwrap_or_else(build)
    }

    /// Gives back what [`Self::take_adjacency`] took, if it still tells how the faces lie.
    pub(super) fn put_adjacency(&mut self, adjacency: Adjacency) {
        self.adjacency = Some(adjacency);
    }

    /// The faces, to be changed.
    pub(super) fn faces_mut(&mut self) -> &mut FaceList {
        self.adjacency = None;
        Arc::make_mut(&mut self.faces)
    }

    /// Makes a copy of `v` and returns it.
    pub(super) fn copy_vertex(&mut self, v: VertexId) -> Result<VertexId, Error> {
        let count = self.positions.len() + 1;
        if count > MAX_ELEMENTS {
            return Err(Error::TooMany { kind: "vertices", count, limit: MAX_ELEMENTS });
        }
        self.adjacency = None;
        self.vertex_sources.push(self.vertex_sources[v.index()]);
        Ok(self.positions.push(self.positions[v]))
    }

    /// Replaces each face by the corners that `change` leaves of it, or drops it where it returns
    /// false. A corner is a vertex and the corner whose data it takes.
    pub(super) fn rewrite(
        &mut self,
        mut change: impl FnMut(&mut Self, FaceId, &mut Vec<(VertexId, CornerId)>) -> Result<bool, Error>,
    ) -> Result<(), Error> {
        let old = std::mem::take(&mut self.faces);
        self.adjacency = None;
        let mut faces = FaceList::new();
        faces.reserve(old.len(), old.corners().len());
        let mut corner_sources = Vec::with_capacity(old.corners().len());
        let mut face_sources = Vec::with_capacity(old.len());
        let (mut corners, mut vertices) = (Vec::new(), Vec::new());
        for (f, face) in old.iter() {
            let start = old.face_start(f).index();
            corners.clear();
            corners
                .extend(face.iter().enumerate().map(|(k, &v)| (v, self.corner_sources[start + k])));
            if change(self, f, &mut corners)? {
                vertices.clear();
                vertices.extend(corners.iter().map(|corner| corner.0));
                faces.push(&vertices);
                corner_sources.extend(corners.iter().map(|corner| corner.1));
                face_sources.push(self.face_sources[f.index()]);
            }
        }
        self.faces = Arc::new(faces);
        (self.corner_sources, self.face_sources) = (corner_sources, face_sources);
        Ok(())
    }

    /// Drops these faces, given in order.
    pub(super) fn drop_faces(&mut self, dropped: &[FaceId]) {
        if dropped.is_empty() {
            return;
        }
        let mut next = dropped.iter().copied().peekable();
        let kept = self.rewrite(|_, f, _| Ok(next.next_if_eq(&f).is_none()));
        kept.expect("dropping cannot fail");
    }

    /// Turns these faces over; each starts at the same vertex as before.
    pub(super) fn turn(&mut self, turned: &[FaceId]) {
        if turned.is_empty() {
            return;
        }
        self.adjacency = None;
        let faces = Arc::make_mut(&mut self.faces);
        for &f in turned {
            let start = faces.face_start(f).index();
            let face = faces.face_mut(f);
            face[1..].reverse();
            self.corner_sources[start + 1..start + face.len()].reverse();
        }
    }

    /// Drops vertices whose coordinates are no finite numbers, and their faces.
    pub(super) fn drop_non_finite(&mut self) {
        let bad = self.positions.iter().filter(|(_, p)| !p.is_finite()).map(|(v, _)| v);
        let bad: VertexSet = bad.collect();
        if bad.is_empty() {
            return;
        }
        let touched = |face: &[VertexId]| face.iter().any(|&v| bad.contains(v));
        let dropped: Vec<FaceId> =
            self.faces.iter().filter(|(_, face)| touched(face)).map(|(f, _)| f).collect();
        self.record(RepairAction::DropNonFiniteFaces, self.input_faces(&dropped));
        self.drop_faces(&dropped);
        self.drop_vertices(&bad, RepairAction::DropNonFiniteVertices);
    }

    /// Drops the vertices of no face, unless there is no face at all.
    pub(super) fn drop_isolated(&mut self) {
        if self.faces.is_empty() {
            return;
        }
        let mut used = VertexMap::filled(self.positions.len(), false);
        for &v in self.faces.corners() {
            used[v] = true;
        }
        let isolated = used.iter().filter(|&(_, &used)| !used).map(|(v, _)| v).collect();
        self.drop_vertices(&isolated, RepairAction::DropIsolatedVertices);
    }

    /// Drops vertices of no face.
    fn drop_vertices(&mut self, dropped: &VertexSet, action: RepairAction) {
        if dropped.is_empty() {
            return;
        }
        let inputs = dropped.iter().map(|v| self.input_vertex(v)).collect();
        self.record(action, Elements::Vertices(inputs));
        self.forget_vertices(dropped);
    }

    /// Renumbers the vertices without these, which belong to no face.
    pub(super) fn forget_vertices(&mut self, dropped: &VertexSet) {
        if dropped.is_empty() {
            return;
        }
        let mut positions = VertexMap::new();
        let mut sources = Vec::new();
        let new = VertexMap::from_fn(self.positions.len(), |v: VertexId| {
            if dropped.contains(v) {
                return None;
            }
            sources.push(self.vertex_sources[v.index()]);
            Some(positions.push(self.positions[v]))
        });
        (self.positions, self.vertex_sources) = (positions, sources);
        for v in self.faces_mut().corners_mut() {
            *v = new[*v].expect("vertices of faces stay");
        }
    }
}
