//! Removing faces and vertices, which makes holes.
//!
//! An edge goes with its last face. A vertex whose faces fall apart into several fans is doubled, so
//! that the rest is a manifold again; a vertex that loses its last face stays, isolated.
//!
//! - Input: any faces.
//! - Cost: O(n log n) for n edges at the corners of the faces.

use super::{EditError, Editor};
use crate::{FaceId, FaceSet, HalfedgeId, VertexId};

/// What [`Editor::remove_faces`] did besides.
#[must_use]
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaceRemoval {
    /// Vertices whose faces fell apart, each with a copy of it that got one of the fans.
    pub copies: Vec<(VertexId, VertexId)>,
    /// Vertices that are on no face any more.
    pub isolated: Vec<VertexId>,
}

impl Editor<'_> {
    /// Removes `f` with the edges that have no other face. Its vertices stay.
    ///
    /// Refused where a vertex would be left with two fans; [`remove_faces`](Editor::remove_faces)
    /// doubles such a vertex instead.
    pub fn remove_face(&mut self, f: FaceId) -> Result<(), EditError> {
        self.need_face(f)?;
        let mesh = &self.mesh.connectivity;
        let has_other = |h: HalfedgeId| mesh.face(h.twin()).is_some();
        for h in mesh.face_halfedges(f) {
            let vertex = mesh.from(h);
            if mesh.is_boundary_vertex(vertex) && has_other(h) && has_other(mesh.prev(h)) {
                return Err(EditError::SeveralFans { vertex });
            }
        }
        let removal = self.take_out(&[f]);
        debug_assert!(removal.copies.is_empty(), "each vertex kept one fan");
        Ok(())
    }

    /// Removes `faces` with the edges that have no other face. Their vertices stay; one whose other
    /// faces fall apart into fans keeps the first, and gets a copy for each of the others.
    ///
    /// Refused only if a face of the set does not exist.
    pub fn remove_faces(&mut self, faces: &FaceSet) -> Result<FaceRemoval, EditError> {
        let faces: Vec<FaceId> = faces.iter().collect();
        faces.iter().try_for_each(|&f| self.need_face(f))?;
        self.need_room(faces.iter().map(|&f| self.mesh.degree(f)).sum(), 0, 0)?;
        Ok(self.take_out(&faces))
    }

    /// Removes `v` and all faces at it. Other vertices of these are treated as
    /// [`remove_faces`](Editor::remove_faces) treats them.
    pub fn remove_vertex(&mut self, v: VertexId) -> Result<FaceRemoval, EditError> {
        self.need_vertex(v)?;
        let faces: Vec<FaceId> = self.mesh.vertex_faces(v).collect();
        self.need_room(faces.iter().map(|&f| self.mesh.degree(f)).sum(), 0, 0)?;
        let mut removal = self.take_out(&faces);
        removal.isolated.retain(|&w| w != v);
        self.drop_vertex(v);
        Ok(removal)
    }

    /// Removes all vertices that are on no face, and tells how many those were.
    pub fn remove_isolated_vertices(&mut self) -> usize {
        let isolated: Vec<VertexId> =
            self.vertices().filter(|&v| self.mesh.is_isolated_vertex(v)).collect();
        for &v in &isolated {
            self.drop_vertex(v);
        }
        isolated.len()
    }

    /// Removes faces that are known to be there.
    fn take_out(&mut self, faces: &[FaceId]) -> FaceRemoval {
        let mesh = &self.mesh.connectivity;
        let sides: Vec<HalfedgeId> = faces.iter().flat_map(|&f| mesh.face_halfedges(f)).collect();
        let mut vertices: Vec<VertexId> = sides.iter().map(|&h| mesh.from(h)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let rings: Vec<Vec<HalfedgeId>> =
            vertices.iter().map(|&v| mesh.vertex_halfedges(v).collect()).collect();

        for &h in &sides {
            self.mesh.connectivity.face[h] = None;
            self.mesh.attributes.corner.reset(h);
        }
        let mut removal = FaceRemoval::default();
        for (&v, ring) in vertices.iter().zip(rings) {
            self.relink(v, ring, &mut removal);
        }
        for &h in &sides {
            if self.mesh.face(h.twin()).is_none() && self.has_halfedge(h) {
                self.drop_edge(h);
            }
        }
        for &f in faces {
            self.drop_face(f, self.mesh.face_halfedge(f));
        }
        removal
    }

    /// Links the rim at `v`, given the half-edges that left it before faces went; gives each fan but
    /// the first a vertex of its own.
    fn relink(&mut self, v: VertexId, mut ring: Vec<HalfedgeId>, removal: &mut FaceRemoval) {
        let face = &self.mesh.connectivity.face;
        ring.retain(|&h| face[h].is_some() || face[h.twin()].is_some());
        let Some(end) = ring.iter().position(|&h| face[h].is_none()) else {
            self.mesh.connectivity.vertex_halfedge[v] = None;
            removal.isolated.push(v);
            return;
        };
        // A fan ends, counterclockwise, with a half-edge that has no face.
        ring.rotate_left(end + 1);
        let ends: Vec<usize> = (0..ring.len()).filter(|&i| face[ring[i]].is_none()).collect();
        let mut start = 0;
        for end in ends {
            let fan = &ring[start..=end];
            let (first, last) = (ring[start], ring[end]);
            let center = if start == 0 { v } else { self.push_vertex(self.mesh.position(v)) };
            if center != v {
                self.mesh.attributes.vertex.copy(v, center);
                removal.copies.push((v, center));
            }
            let mesh = &mut self.mesh.connectivity;
            mesh.vertex_halfedge[center] = Some(last);
            mesh.link(first.twin(), last);
            for &h in fan {
                mesh.to[h.twin()] = center;
            }
            start = end + 1;
        }
    }
}
