//! Edge split: puts a vertex on an edge.
//!
//! ```text
//!        c                    c                     c
//!       ╱ ╲                  ╱ ╲                   ╱│╲
//!      ╱   ╲   split_edge   ╱   ╲   ..triangles   ╱ │ ╲
//!     a ─── b    ─────→    a ─m─ b    ─────→     a ─m─ b
//! ```
//!
//! - Input: any edge.
//! - Cost: O(1) where the faces are triangles, else O(degrees).

use glam::DVec3;

use super::{EditError, Editor, collapse::apex, need_finite, weights::fraction_along};
use crate::{EdgeId, VertexId};

impl Editor<'_> {
    /// Puts a vertex on `e` at `position`, which each face of `e` gets as a new corner.
    ///
    /// `e` becomes the half at `from(e.halfedge())`; the other half is the newest edge and has the
    /// same data. The data of the vertex, and of its corner on either side, are mixed as at the point
    /// of the edge nearest to `position`. Collapsing the other half from the new vertex restores
    /// the mesh exactly.
    pub fn split_edge(&mut self, e: EdgeId, position: DVec3) -> Result<VertexId, EditError> {
        self.need_edge(e)?;
        need_finite(position)?;
        self.need_room(1, 1, 0)?;
        let [h, t] = e.halfedges();
        let [a, b] = self.mesh.edge_vertices(e);
        let x = fraction_along(position, self.mesh.position(a), self.mesh.position(b));
        let m = self.push_vertex(position);
        let g = self.push_edge(m, b);

        let attributes = &mut self.mesh.attributes;
        let mesh = &mut self.mesh.connectivity;
        let (after_h, before_t) = (mesh.next(h), mesh.prev(t));
        attributes.vertex.mix(m, &[(1.0 - x, a), (x, b)]);
        attributes.edge.copy(e, g.edge());
        if mesh.face(h).is_some() {
            attributes.corner.mix(g, &[(1.0 - x, h), (x, after_h)]);
        }
        if mesh.face(t).is_some() {
            attributes.corner.copy(t, g.twin());
            attributes.corner.mix(t, &[(1.0 - x, mesh.next(t)), (x, g.twin())]);
        }

        mesh.to[h] = m;
        mesh.link(h, g);
        mesh.link(g, after_h);
        mesh.link(before_t, g.twin());
        mesh.link(g.twin(), t);
        mesh.face[g] = mesh.face[h];
        mesh.face[g.twin()] = mesh.face[t];
        if mesh.vertex_halfedge[b] == Some(t) {
            mesh.vertex_halfedge[b] = Some(g.twin());
        }
        mesh.vertex_halfedge[m] = Some(if mesh.face(h).is_none() { g } else { t });
        Ok(m)
    }

    /// Puts a vertex on `e` at `position` and joins it to the opposite corner of each triangle at
    /// `e`, so that triangles stay triangles; larger faces get a corner more.
    ///
    /// Faces keep their ids on the side of `from(e.halfedge())`; the others are new, with the same
    /// data. Data of vertex and corners, and how to undo it: as for [`split_edge`](Editor::split_edge).
    /// Refused between two triangles that lie back to back, with the same opposite corner.
    pub fn split_edge_triangles(
        &mut self,
        e: EdgeId,
        position: DVec3,
    ) -> Result<VertexId, EditError> {
        self.need_edge(e)?;
        self.need_room(1, 3, 2)?;
        let [h, t] = e.halfedges();
        let apexes = [h, t].map(|g| apex(&self.mesh, g));
        if let [Some(c), Some(d)] = apexes
            && c == d
            && let [Some(f), Some(g)] = self.mesh.edge_faces(e)
        {
            return Err(EditError::SameCorners { faces: [f, g] });
        }
        let m = self.split_edge(e, position)?;
        if apexes[0].is_some() {
            self.cut(self.mesh.prev(h), self.mesh.next(h));
        }
        if apexes[1].is_some() {
            self.cut(t, self.mesh.next(self.mesh.next(t)));
        }
        Ok(m)
    }
}
