//! Edge flip: turns an edge within the union of its two faces.
//!
//! ```text
//!        c                       c
//!       ╱ ╲                     ╱│╲
//!      ╱ f ╲        flip       ╱ │ ╲
//!     a ───→ b     ─────→     a f│  b        each end moves on along the face on its left
//!      ╲   ╱                   ╲ │ ╱
//!       ╲ ╱                     ╲│╱
//!        d                       d
//! ```
//!
//! - Input: an edge between two polygons; their numbers of corners stay the same.
//! - Cost: O(degrees of both faces + valence of c).
//! - Reference: Botsch et al., *Polygon Mesh Processing*, 2010, ch. 2.

use super::{EditError, Editor};
use crate::EdgeId;

impl Editor<'_> {
    /// Turns `e`: each of its ends moves on to the next corner of the face on its left.
    ///
    /// Edge and faces keep their ids. For two triangles the fourth flip, for polygons of m and n
    /// corners the (m + n − 2)nd restores the mesh: all links, positions and data, but for the
    /// half-edge with which the ring of a vertex starts. Corners keep or copy their values; on an
    /// edge along a texture seam two values are lost, so that the data is not restored there.
    ///
    /// Refused as by [`can_flip`](Editor::can_flip).
    pub fn flip(&mut self, e: EdgeId) -> Result<(), EditError> {
        self.can_flip(e)?;
        let corner = &mut self.mesh.attributes.corner;
        let connectivity = &mut self.mesh.connectivity;
        let [h, t] = e.halfedges();
        let (after_h, before_h) = (connectivity.next(h), connectivity.prev(h));
        let (after_t, before_t) = (connectivity.next(t), connectivity.prev(t));
        let (to_c, to_d) = (connectivity.next(after_h), connectivity.next(after_t));
        let (a, b) = (connectivity.from(h), connectivity.to(h));

        for (from, to) in [(h, after_t), (t, after_h), (to_d, h), (to_c, t)] {
            corner.copy(from, to);
        }
        for (lost, gained) in [(after_h, after_t), (after_t, after_h)] {
            // The two faces swap a side; one that started with it now starts with what it got.
            if let Some(f) = connectivity.face(lost)
                && connectivity.face_halfedge[f] == lost
            {
                connectivity.face_halfedge[f] = gained;
            }
        }
        for (v, lost, other) in [(a, h, after_t), (b, t, after_h)] {
            if connectivity.vertex_halfedge[v] == Some(lost) {
                connectivity.vertex_halfedge[v] = Some(other);
            }
        }
        let (c, d) = (connectivity.to(after_h), connectivity.to(after_t));
        connectivity.face[after_t] = connectivity.face[h];
        connectivity.face[after_h] = connectivity.face[t];
        connectivity.to[h] = c;
        connectivity.to[t] = d;
        connectivity.link(before_h, after_t);
        connectivity.link(after_t, h);
        connectivity.link(h, to_c);
        connectivity.link(before_t, after_h);
        connectivity.link(after_h, t);
        connectivity.link(t, to_d);
        Ok(())
    }

    /// Whether [`flip`](Editor::flip) would flip `e`, and if not, why.
    ///
    /// Refused at the boundary, where the new ends are joined already, and where a face would visit
    /// a vertex twice. An interior corner of two edges between polygons is allowed, as
    /// [`split_edge`](Editor::split_edge) makes them too.
    pub fn can_flip(&self, e: EdgeId) -> Result<(), EditError> {
        self.need_edge(e)?;
        let mesh = &self.mesh.connectivity;
        let [h, t] = e.halfedges();
        if mesh.is_boundary_edge(e) {
            return Err(EditError::BoundaryEdge { edge: e });
        }
        let (after_h, after_t) = (mesh.next(h), mesh.next(t));
        let (c, d) = (mesh.to(after_h), mesh.to(after_t));
        for (halfedge, vertex) in [(after_h, d), (after_t, c)] {
            if mesh.loop_halfedges(halfedge).any(|g| mesh.to(g) == vertex) {
                return Err(EditError::RepeatedVertex { vertex });
            }
        }
        // Around c, from a side of the face at hand: the half-edge of the vertex may be far away.
        let start = mesh.next(after_h);
        let mut g = mesh.ccw(start);
        while g != start {
            if mesh.to(g) == d {
                return Err(EditError::EdgeExists { edge: g.edge(), vertices: [c, d] });
            }
            g = mesh.ccw(g);
        }
        Ok(())
    }
}
