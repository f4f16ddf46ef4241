//! Turning a mesh inside out.

use crate::{AttributeTable, Connectivity, HalfedgeId, Id, Mesh, NORMAL, Normal};

impl Mesh {
    /// Turns every face over: its corners are now in the opposite order, starting with the same.
    ///
    /// Ids of vertices, edges and faces stay; each half-edge runs the other way along its face.
    /// Data stay where they were, but normals point the other way. Twice restores the mesh exactly.
    pub fn reverse(&mut self) {
        let corner = &self.attributes.corner;
        if !corner.is_empty() {
            // The corner of a half-edge is where it starts, which is now where its next started.
            let next = |h| self.connectivity.next(h);
            self.attributes.corner = corner.gather(corner.len(), |h: HalfedgeId| Some(next(h)));
        }
        turn_normals(&mut self.attributes.vertex);
        turn_normals(&mut self.attributes.corner);
        turn_normals(&mut self.attributes.face);
        self.connectivity.reverse();
    }
}

impl Connectivity {
    /// Turns every face over, keeping the first corner of each.
    fn reverse(&mut self) {
        let mut next = self.prev.clone();
        for h in self.halfedges() {
            next[self.prev[h]] = h;
        }
        // What arrived at an element before leaves it now.
        for start in self.vertex_halfedge.values_mut().iter_mut().flatten() {
            *start = self.prev[*start];
        }
        for start in self.face_halfedge.values_mut() {
            *start = self.prev[*start];
        }
        self.prev = next;
        for ends in self.to.values_mut().as_chunks_mut::<2>().0 {
            ends.swap(0, 1);
        }
    }
}

fn turn_normals<I: Id>(table: &mut AttributeTable<I>) {
    for normal in table.get_mut::<Normal>(NORMAL).unwrap_or_default() {
        // Zero, which stands for no normal, keeps its sign.
        normal.0 = glam::DVec3::ZERO - normal.0;
    }
}
