//! From rings back to a mesh.

use dgp_mesh::{Connectivity, DVec3, Editor, FaceId, FaceMap, Mesh, VertexId, VertexMap};

use super::{report::DecimationReport, rings::NONE, state::State};
use crate::Error;

impl State {
    /// Puts what is left into `mesh`.
    pub(super) fn give_back(mut self, mesh: &mut Mesh) -> Result<DecimationReport, Error> {
        let n = self.parent.len();
        // Whom a vertex was merged into comes to where that one came in the end.
        let mut number = vec![NONE; n];
        let mut kept = Vec::with_capacity(self.rings.vertex_count);
        for v in 0..n as u32 {
            if self.parent[v as usize] == v {
                number[v as usize] = kept.len() as u32;
                kept.push(v);
            }
        }
        let final_position = |v: u32| {
            self.frame.position(
                mesh.positions(),
                self.held[v as usize],
                self.rings.positions[v as usize],
            )
        };
        let positions: Vec<DVec3> = kept.iter().map(|&v| final_position(v)).collect();
        for v in 0..n as u32 {
            let mut root = v;
            while self.parent[root as usize] != root {
                root = self.parent[root as usize];
            }
            let mut walk = v;
            while self.parent[walk as usize] != root {
                walk = std::mem::replace(&mut self.parent[walk as usize], root);
            }
        }
        let root = |v: VertexId| number[self.parent[v.index()] as usize] as usize;
        let vertex_map = VertexMap::from_fn(n, |v| VertexId::new(root(v)));
        let mut face_map = FaceMap::filled(self.rings.faces.len(), None);
        for (new, (old, _)) in self.rings.left().enumerate() {
            face_map[old] = Some(FaceId::new(new));
        }
        let report = DecimationReport {
            vertices: [n, kept.len()],
            faces: [self.start[1], self.rings.face_count],
            collapses: self.collapses,
            largest_error: self.largest_error * self.frame.unit,
            stop: self.stop,
            refusals: self.refusals,
            vertex_map,
            face_map,
        };
        if self.keeps_log {
            let input = mesh.positions().clone();
            self.replay(mesh, &input);
            mesh.set_positions(positions.into());
            if let Some(channels) = &self.channels {
                channels.give_back(&self.rings, &number, mesh);
            }
        } else {
            let list = self.rings.face_list(|v| VertexId::new(number[v as usize] as usize));
            let connectivity = Connectivity::from_faces(kept.len(), &list)?;
            *mesh = Mesh::from_parts(connectivity, positions.into());
        }
        Ok(report)
    }

    /// Does the collapses again where data travel.
    fn replay(&self, mesh: &mut Mesh, input: &VertexMap<DVec3>) {
        let mut editor = Editor::new(mesh);
        for done in &self.log {
            let [from, to] = [done.from, done.to].map(|v| VertexId::new(v as usize));
            let h =
                editor.mesh().halfedge_between(from, to).expect("the same edges as in the rings");
            let position = self.frame.position(input, done.held, done.position);
            editor.collapse_at(h, position).expect("the same conditions as in the rings");
        }
        let _ = editor.finish();
    }
}
