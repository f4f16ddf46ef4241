//! Closing the gaps that removed elements leave.
//!
//! - Input: a mesh with removed elements.
//! - Cost: one pass over each array, in place. The order of what is left stays.

use super::{Editor, Removed};
use crate::{
    AttributeTable, EdgeId, EdgeMap, FaceId, FaceMap, HalfedgeId, Id, IdMap, IdSet, Invalid, Mesh,
    VertexId, VertexMap,
};

/// Where the elements of a mesh went when the editor closed the gaps: the new id for each old one,
/// `None` for what was removed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Compaction {
    /// The new ids of vertices.
    pub vertices: VertexMap<Option<VertexId>>,
    /// The new ids of edges. Each keeps its directions: see [`halfedge`](Compaction::halfedge).
    pub edges: EdgeMap<Option<EdgeId>>,
    /// The new ids of faces.
    pub faces: FaceMap<Option<FaceId>>,
}

impl Compaction {
    /// The new id of half-edge `h`, `None` if it was removed.
    #[inline]
    pub fn halfedge(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        self.edges[h.edge()].map(|e| e.halfedges()[h.index() & 1])
    }

    pub(super) fn without(mesh: &Mesh, removed: &Removed) -> Self {
        Compaction {
            vertices: renumber(mesh.vertex_count(), &removed.vertices),
            edges: renumber(mesh.edge_count(), &removed.edges),
            faces: renumber(mesh.face_count(), &removed.faces),
        }
    }

    pub(super) fn apply(&self, mesh: &mut Mesh) {
        const LEFT: &str = "what is left names only what is left";
        let vertices = kept(&self.vertices);
        let edges = kept(&self.edges);
        let faces = kept(&self.faces);
        let halfedge = |h| self.halfedge(h).expect(LEFT);
        let vertex = |v| self.vertices[v].expect(LEFT);

        // No element moves up, so that none is overwritten before it has moved.
        let connectivity = &mut mesh.connectivity;
        for (new, &old) in edges.iter().enumerate() {
            for (h, g) in EdgeId::new(new).halfedges().into_iter().zip(old.halfedges()) {
                connectivity.prev[h] = halfedge(connectivity.prev[g]);
                connectivity.to[h] = vertex(connectivity.to[g]);
                connectivity.face[h] = connectivity.face[g].map(|f| self.faces[f].expect(LEFT));
            }
        }
        for (new, &old) in vertices.iter().enumerate() {
            let v = VertexId::new(new);
            connectivity.vertex_halfedge[v] = connectivity.vertex_halfedge[old].map(halfedge);
            mesh.positions[v] = mesh.positions[old];
        }
        for (new, &old) in faces.iter().enumerate() {
            connectivity.face_halfedge[FaceId::new(new)] =
                halfedge(connectivity.face_halfedge[old]);
        }
        connectivity.prev.truncate(2 * edges.len());
        connectivity.to.truncate(2 * edges.len());
        connectivity.face.truncate(2 * edges.len());
        connectivity.vertex_halfedge.truncate(vertices.len());
        connectivity.face_halfedge.truncate(faces.len());
        mesh.positions.truncate(vertices.len());

        let attributes = &mut mesh.attributes;
        gather(&mut attributes.vertex, vertices.len(), |v: VertexId| vertices[v.index()]);
        gather(&mut attributes.edge, edges.len(), |e: EdgeId| edges[e.index()]);
        gather(&mut attributes.face, faces.len(), |f: FaceId| faces[f.index()]);
        gather(&mut attributes.corner, 2 * edges.len(), |h: HalfedgeId| {
            edges[h.edge().index()].halfedges()[h.index() & 1]
        });
    }
}

impl Editor<'_> {
    /// Refuses elements that are left but name removed ones.
    pub(super) fn need_no_removed_names(&self) -> Result<(), Invalid> {
        let mesh = &self.mesh.connectivity;
        for h in self.halfedges() {
            let is_named = self.has_halfedge(mesh.prev(h))
                && self.has_vertex(mesh.to(h))
                && mesh.face(h).is_none_or(|f| self.has_face(f));
            if !is_named {
                return Err(Invalid::HalfedgeNamesMissing { halfedge: h });
            }
        }
        for v in self.vertices() {
            if mesh.vertex_halfedge(v).is_some_and(|h| !self.has_halfedge(h)) {
                return Err(Invalid::VertexNamesMissing { vertex: v });
            }
        }
        for f in self.faces() {
            if !self.has_halfedge(mesh.face_halfedge(f)) {
                return Err(Invalid::FaceNamesMissing { face: f });
            }
        }
        Ok(())
    }
}

/// New ids, in order, for all but the removed elements.
fn renumber<I: Id>(len: usize, removed: &IdSet<I>) -> IdMap<I, Option<I>> {
    let mut count = 0;
    IdMap::from_fn(len, |id| {
        let is_left = !removed.contains(id);
        let new = is_left.then(|| I::from_index(count));
        count += usize::from(is_left);
        new
    })
}

/// The old ids of all elements that are left, in order.
fn kept<I: Id>(map: &IdMap<I, Option<I>>) -> Vec<I> {
    map.iter().filter(|(_, new)| new.is_some()).map(|(old, _)| old).collect()
}

/// Lets each of `len` elements have the data of its source.
pub(super) fn gather<I: Id>(
    table: &mut AttributeTable<I>,
    len: usize,
    source: impl Fn(I) -> I + Sync,
) {
    if table.is_empty() {
        table.resize(len);
    } else {
        *table = table.gather(len, |id: I| Some(source(id)));
    }
}
