//! Where the elements of a mesh under repair came from.

use dgp_mesh::{Compaction, FaceId, FaceMap, Mesh, RepairReport, VertexId, VertexMap, Welding};

/// The maps between the elements at the start and now.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Track {
    /// What became of each vertex: `None` if it is gone.
    pub(super) vertices: VertexMap<Option<VertexId>>,
    /// What each face was: `None` if it is new.
    pub(super) faces: FaceMap<Option<FaceId>>,
}

impl Track {
    /// Before anything has changed.
    pub(super) fn of(mesh: &Mesh) -> Self {
        Track {
            vertices: VertexMap::from_fn(mesh.vertex_count(), Some),
            faces: FaceMap::from_fn(mesh.face_count(), Some),
        }
    }

    /// After an editor has finished. Of `merged` each first vertex went into the second, in this order.
    pub(super) fn compacted(&mut self, compaction: &Compaction, merged: &[[VertexId; 2]]) {
        let mut into = VertexMap::from_fn(compaction.vertices.len(), |v: VertexId| v);
        for &[from, to] in merged.iter().rev() {
            into[from] = into[to];
        }
        for (_, place) in self.vertices.iter_mut() {
            *place = place.and_then(|v| compaction.vertices[into[v]]);
        }
        let mut faces = FaceMap::filled(compaction.faces.values().iter().flatten().count(), None);
        for (old, new) in compaction.faces.iter() {
            if let (Some(new), Some(&source)) = (*new, self.faces.get(old)) {
                faces[new] = source;
            }
        }
        self.faces = faces;
    }

    /// After vertices became one.
    pub(super) fn welded(&mut self, welding: &Welding) {
        for (_, place) in self.vertices.iter_mut() {
            *place = place.map(|v| welding.vertices[v]);
        }
    }

    /// After faces were repaired.
    pub(super) fn repaired(&mut self, report: &RepairReport) {
        for (_, place) in self.vertices.iter_mut() {
            *place = place.and_then(|v| report.vertices[v]);
        }
        self.faces = report.face_sources.map(|source| source.and_then(|f| self.faces[f]));
    }
}
