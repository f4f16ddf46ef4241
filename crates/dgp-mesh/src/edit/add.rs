//! New vertices, and new faces at the boundary.
//!
//! - Input: vertices that are isolated or at the boundary.
//! - Cost: O(valences of the corners).

use glam::DVec3;

use super::{EditError, Editor, merge::need_distinct, need_finite};
use crate::{FaceId, HalfedgeId, VertexId};

impl Editor<'_> {
    /// Adds a vertex on no face, with default data.
    pub fn add_vertex(&mut self, position: DVec3) -> Result<VertexId, EditError> {
        need_finite(position)?;
        self.need_room(1, 0, 0)?;
        Ok(self.push_vertex(position))
    }

    /// Adds a face on these vertices, counterclockwise seen from outside, with the edges that are
    /// missing.
    ///
    /// Corners continue the data of a neighbor at the same vertex, and the face mixes those of its
    /// neighbors; without neighbors they are default.
    ///
    /// Refused if a side belongs to a face already, and if a vertex would have two fans: each corner
    /// must be on no face yet, or at the end of a side that is there.
    pub fn add_face(&mut self, vertices: &[VertexId]) -> Result<FaceId, EditError> {
        let old = self.sides_of_new_face(vertices)?;
        self.need_room(0, vertices.len(), 1)?;
        let count = vertices.len();
        let sides: Vec<HalfedgeId> = (0..count)
            .map(|i| match old[i] {
                Some(side) => side,
                None => self.push_edge(vertices[i], vertices[(i + 1) % count]),
            })
            .collect();

        // The rim outside of the new edges. A vertex has one gap at most, so where one side at a
        // corner is new, the rim goes from there to what the other side was linked to.
        let mesh = &mut self.mesh.connectivity;
        for (i, &v) in vertices.iter().enumerate() {
            let before = (i + count - 1) % count;
            let (arriving, leaving) = (sides[before], sides[i]);
            match (old[before].is_some(), old[i].is_some()) {
                (true, true) => {}
                (true, false) => mesh.link(leaving.twin(), mesh.next(arriving)),
                (false, true) => {
                    mesh.link(mesh.prev(leaving), arriving.twin());
                    mesh.vertex_halfedge[v] = Some(arriving.twin());
                }
                (false, false) => {
                    mesh.link(leaving.twin(), arriving.twin());
                    mesh.vertex_halfedge[v] = Some(arriving.twin());
                }
            }
        }
        for (i, &side) in sides.iter().enumerate() {
            mesh.link(side, sides[(i + 1) % count]);
        }
        let face = self.push_face(sides[0]);
        self.continue_data(face, &sides, &old);
        Ok(face)
    }

    /// The sides of a face on `vertices` that are there; an error if there must be no such face.
    fn sides_of_new_face(
        &self,
        vertices: &[VertexId],
    ) -> Result<Vec<Option<HalfedgeId>>, EditError> {
        let count = vertices.len();
        if count < 3 {
            return Err(EditError::TooFewCorners { count });
        }
        vertices.iter().try_for_each(|&v| self.need_vertex(v))?;
        need_distinct(vertices.to_vec())?;
        let mesh = &self.mesh.connectivity;
        let next = vertices.iter().cycle().skip(1);
        let mut old = Vec::with_capacity(count);
        for (&a, &b) in vertices.iter().zip(next) {
            let side = mesh.halfedge_between(a, b);
            if let Some(face) = side.and_then(|side| mesh.face(side)) {
                return Err(EditError::SideTaken { vertices: [a, b], face });
            }
            old.push(side);
        }
        for (i, &vertex) in vertices.iter().enumerate() {
            let is_apart = old[(i + count - 1) % count].is_none() && old[i].is_none();
            if is_apart && !mesh.is_isolated_vertex(vertex) {
                return Err(EditError::SeveralFans { vertex });
            }
        }
        Ok(old)
    }

    /// Gives a new face and its corners the data of the faces beyond its old sides.
    fn continue_data(&mut self, face: FaceId, sides: &[HalfedgeId], old: &[Option<HalfedgeId>]) {
        let mesh = &self.mesh.connectivity;
        let neighbors: Vec<FaceId> =
            old.iter().flatten().filter_map(|side| mesh.face(side.twin())).collect();
        let weight = 1.0 / neighbors.len() as f64;
        let parts: Vec<_> = neighbors.into_iter().map(|f| (weight, f)).collect();
        self.mesh.attributes.face.mix(face, &parts);
        for (i, &side) in sides.iter().enumerate() {
            let before = old[(i + sides.len() - 1) % sides.len()];
            let source = match (old[i], before) {
                (Some(leaving), _) => mesh.next(leaving.twin()),
                (None, Some(arriving)) => arriving.twin(),
                (None, None) => continue,
            };
            self.mesh.attributes.corner.copy(source, side);
        }
    }
}
