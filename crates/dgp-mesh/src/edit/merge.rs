//! Merging faces: over an edge, or around a vertex.
//!
//! - Input: an edge between two faces; a vertex surrounded by faces.
//! - Cost: O(n log n) for n corners of the merged face.

use super::{EditError, Editor};
use crate::{EdgeId, FaceId, HalfedgeId, VertexId};

impl Editor<'_> {
    /// Removes `e`, making one face of the two at it, and returns that: the one of lower id.
    ///
    /// Its data are those of the face that stays; corners keep theirs. Refused at the boundary, and
    /// if the faces share more than the edge, so that the merged one would touch itself.
    pub fn merge_faces(&mut self, e: EdgeId) -> Result<FaceId, EditError> {
        self.need_edge(e)?;
        let mesh = &self.mesh.connectivity;
        let [h, t] = e.halfedges();
        let (Some(f), Some(g)) = (mesh.face(h), mesh.face(t)) else {
            return Err(EditError::BoundaryEdge { edge: e });
        };
        let [a, b] = mesh.edge_vertices(e);
        let corners = |f| mesh.face_vertices(f).filter(|&v| v != a && v != b);
        need_distinct(corners(f).chain(corners(g)).collect())?;

        let (kept, gone) = if f < g { (f, g) } else { (g, f) };
        let firsts = [kept, gone].map(|f| mesh.face_halfedge(f));
        let (after_h, before_h) = (mesh.next(h), mesh.prev(h));
        let (after_t, before_t) = (mesh.next(t), mesh.prev(t));
        let mesh = &mut self.mesh.connectivity;
        for (v, lost, other) in [(a, h, after_t), (b, t, after_h)] {
            if mesh.vertex_halfedge[v] == Some(lost) {
                mesh.vertex_halfedge[v] = Some(other);
            }
        }
        mesh.link(before_h, after_t);
        mesh.link(before_t, after_h);
        mesh.set_loop_face(after_h, Some(kept));
        mesh.face_halfedge[kept] =
            firsts.into_iter().find(|first| first.edge() != e).unwrap_or(after_h);
        self.drop_edge(h);
        self.drop_face(gone, h);
        Ok(kept)
    }

    /// Removes `v` with its edges, making one face of all around it, and returns that: the one of
    /// lowest id.
    ///
    /// Its data are those of the face that stays; corners keep theirs. Refused at the boundary, and
    /// if the faces touch each other away from the edges at `v`. A vertex on a straight line between
    /// two faces is better removed by [`collapse`](Editor::collapse), which keeps both.
    pub fn merge_vertex_faces(&mut self, v: VertexId) -> Result<FaceId, EditError> {
        self.need_vertex(v)?;
        if self.mesh.is_boundary_vertex(v) {
            return Err(EditError::BoundaryVertex { vertex: v });
        }
        let mesh = &self.mesh.connectivity;
        let spokes: Vec<HalfedgeId> = mesh.vertex_halfedges(v).collect();
        let faces: Vec<FaceId> = mesh.vertex_faces(v).collect();
        // Of each face all corners but v and the one where the next face goes on.
        let rim = |&spoke: &HalfedgeId| {
            let last = mesh.prev(spoke);
            mesh.loop_halfedges(mesh.next(spoke)).take_while(move |&g| g != last)
        };
        let sides: Vec<HalfedgeId> = spokes.iter().flat_map(rim).collect();
        if sides.len() < 3 {
            return Err(EditError::TooFewCorners { count: sides.len() });
        }
        need_distinct(sides.iter().map(|&g| mesh.from(g)).collect())?;

        let Some(&kept) = faces.iter().min() else {
            return Err(EditError::BoundaryVertex { vertex: v });
        };
        let first = mesh.face_halfedge(kept);
        let mesh = &mut self.mesh.connectivity;
        for (&g, &next) in sides.iter().zip(sides.iter().cycle().skip(1)) {
            mesh.link(g, next);
            mesh.face[g] = Some(kept);
            let w = mesh.to(g);
            if mesh.vertex_halfedge[w].is_some_and(|spoke| mesh.to(spoke) == v) {
                mesh.vertex_halfedge[w] = Some(next);
            }
        }
        mesh.face_halfedge[kept] = if sides.contains(&first) { first } else { sides[0] };
        for &spoke in &spokes {
            self.drop_edge(spoke);
        }
        for &f in faces.iter().filter(|&&f| f != kept) {
            self.drop_face(f, spokes[0]);
        }
        self.drop_vertex(v);
        Ok(kept)
    }
}

/// Refuses corners of a face of which two are the same.
pub(super) fn need_distinct(mut vertices: Vec<VertexId>) -> Result<(), EditError> {
    vertices.sort_unstable();
    match vertices.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(EditError::RepeatedVertex { vertex: pair[0] }),
        None => Ok(()),
    }
}
