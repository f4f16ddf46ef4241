//! Face splits: a vertex into a face, or an edge across it.
//!
//! - Input: any face.
//! - Cost: O(degree); [`split_face_by`](Editor::split_face_by) also O(valence).

use glam::DVec3;

use super::{EditError, Editor, need_finite, weights::corner_weights};
use crate::{EdgeId, FaceId, HalfedgeId, VertexId};

impl Editor<'_> {
    /// Puts a vertex into `f` at `position` and joins it to all corners.
    ///
    /// The triangle at the first side of `f` keeps its id; the others are new, with the same data.
    /// The data of the vertex and its corners are mixed from those of the face: as barycentric
    /// coordinates tell in a triangle, with the most equal weights that reproduce `position` in a
    /// larger face. [`merge_vertex_faces`](Editor::merge_vertex_faces) restores the mesh exactly.
    pub fn split_face(&mut self, f: FaceId, position: DVec3) -> Result<VertexId, EditError> {
        self.need_face(f)?;
        need_finite(position)?;
        let sides: Vec<HalfedgeId> = self.mesh.face_halfedges(f).collect();
        self.need_room(1, sides.len(), sides.len() - 1)?;
        let vertices: Vec<VertexId> = self.mesh.face_vertices(f).collect();
        let has_data =
            !(self.mesh.attributes.vertex.is_empty() && self.mesh.attributes.corner.is_empty());
        let weights = if has_data {
            let corners: Vec<DVec3> = vertices.iter().map(|&v| self.mesh.position(v)).collect();
            corner_weights(position, &corners)
        } else {
            Vec::new()
        };

        let center = self.push_vertex(position);
        let spokes: Vec<HalfedgeId> = vertices.iter().map(|&v| self.push_edge(center, v)).collect();
        for (i, (&side, &spoke)) in sides.iter().zip(&spokes).enumerate() {
            let next = (i + 1) % sides.len();
            let arriving = spokes[next].twin();
            let mesh = &mut self.mesh.connectivity;
            mesh.link(spoke, side);
            mesh.link(side, arriving);
            mesh.link(arriving, spoke);
            self.mesh.attributes.corner.copy(sides[next], arriving);
            if i == 0 {
                self.mesh.connectivity.set_loop_face(side, Some(f));
            } else {
                let new = self.push_face(side);
                self.mesh.attributes.face.copy(f, new);
            }
        }
        self.mesh.connectivity.vertex_halfedge[center] = Some(spokes[0]);
        if has_data {
            let attributes = &mut self.mesh.attributes;
            let of_vertices: Vec<_> = weights.iter().copied().zip(vertices).collect();
            attributes.vertex.mix(center, &of_vertices);
            let of_corners: Vec<_> = weights.iter().copied().zip(sides).collect();
            attributes.corner.mix(spokes[0], &of_corners);
            for &spoke in &spokes[1..] {
                attributes.corner.copy(spokes[0], spoke);
            }
        }
        Ok(center)
    }

    /// Joins two corners of a face by a new edge, from the start of `h` to the start of `g`.
    ///
    /// The face keeps its id on the side of `h`; the part at `g` is new, with the same data. The new
    /// edge has default data. [`merge_faces`](Editor::merge_faces) restores the mesh exactly.
    ///
    /// Refused if the half-edges are of different faces or of none, and if an edge joins the corners.
    pub fn split_face_by(&mut self, h: HalfedgeId, g: HalfedgeId) -> Result<EdgeId, EditError> {
        self.need_halfedge(h)?;
        self.need_halfedge(g)?;
        self.need_room(0, 1, 1)?;
        let mesh = &self.mesh.connectivity;
        if mesh.is_boundary_halfedge(h) {
            return Err(EditError::BoundaryHalfedge { halfedge: h });
        }
        if mesh.face(h) != mesh.face(g) {
            return Err(EditError::DifferentFaces { halfedges: [h, g] });
        }
        let vertices = [mesh.from(h), mesh.from(g)];
        if h == g {
            return Err(EditError::RepeatedVertex { vertex: vertices[0] });
        }
        if let Some(between) = mesh.halfedge_between(vertices[0], vertices[1]) {
            return Err(EditError::EdgeExists { edge: between.edge(), vertices });
        }
        Ok(self.cut(h, g))
    }

    /// Cuts the face of `h` and `g` between their starts, which are known not to be adjacent.
    pub(super) fn cut(&mut self, h: HalfedgeId, g: HalfedgeId) -> EdgeId {
        let (u, w) = (self.mesh.from(h), self.mesh.from(g));
        let chord = self.push_edge(u, w);
        let mesh = &mut self.mesh.connectivity;
        let (before_h, before_g) = (mesh.prev(h), mesh.prev(g));
        mesh.link(before_h, chord);
        mesh.link(chord, g);
        mesh.link(before_g, chord.twin());
        mesh.link(chord.twin(), h);
        self.mesh.attributes.corner.copy(h, chord);
        self.mesh.attributes.corner.copy(g, chord.twin());
        if let Some(f) = self.mesh.face(h) {
            let first = self.mesh.face_halfedge(f);
            let new = self.push_face(chord);
            self.mesh.attributes.face.copy(f, new);
            let mesh = &mut self.mesh.connectivity;
            mesh.face[chord.twin()] = Some(f);
            if mesh.face(first) == Some(new) {
                // Keeps the first side of the whole, so that merging finds it again.
                mesh.face_halfedge[new] = first;
                mesh.face_halfedge[f] = chord.twin();
            }
        }
        chord.edge()
    }
}
