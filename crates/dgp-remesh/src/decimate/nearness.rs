//! Keeps every vertex of the input within a distance of the result.
//!
//! Each face carries the vertices of the input that it stands for. When an edge collapses, those of the faces
//! around it go to the nearest of the new ones; where the nearest is too far away the collapse is refused.
//!
//! - Input: a mesh, the vertices each face carries, and what a collapse would leave.
//! - Cost: O(vertices carried by the faces around × faces around) a collapse.
//! - Guarantees: the distance of every vertex of the input from the result is at most the limit.
//! - Reference: Klein, Liebich, Straßer, "Mesh reduction with error control", Visualization 1996, of which
//!   this is the direction from input to result, at vertices.

use super::triangle::nearest_point;
use dgp_mesh::{DVec3, FaceId, FaceMap, HalfedgeId, Mesh, VertexId};

/// The vertices of the input, and which face stands for each.
pub(super) struct Nearness {
    points: Vec<DVec3>,
    carried: FaceMap<Vec<u32>>,
}

impl Nearness {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut carried = FaceMap::filled(mesh.face_count(), Vec::new());
        for v in mesh.vertices() {
            if let Some(f) = mesh.vertex_faces(v).next() {
                carried[f].push(v.index() as u32);
            }
        }
        Nearness { points: mesh.positions().values().to_vec(), carried }
    }

    /// Whether all that is carried around `h` stays within `limit` if it collapses to `p`; if so it is handed on.
    pub(super) fn try_collapse(
        &mut self,
        mesh: &Mesh,
        h: HalfedgeId,
        p: DVec3,
        limit: f64,
    ) -> bool {
        let ends = [mesh.from(h), mesh.to(h)];
        let mut faces: Vec<FaceId> = ends.iter().flat_map(|&v| mesh.vertex_faces(v)).collect();
        faces.sort_unstable();
        faces.dedup();
        let is_gone = |f: FaceId| {
            mesh.degree(f) == 3 && ends.iter().all(|&v| mesh.face_vertices(f).any(|w| w == v))
        };
        let left: Vec<FaceId> = faces.iter().copied().filter(|&f| !is_gone(f)).collect();
        let at = |v: VertexId| if ends.contains(&v) { p } else { mesh.position(v) };
        let triangles: Vec<(FaceId, [DVec3; 3])> = left
            .iter()
            .flat_map(|&f| {
                let first = mesh.from(mesh.face_halfedge(f));
                let sides = mesh.face_halfedges(f).filter(move |&g| mesh.from(g) != first);
                let sides = sides.filter(move |&g| mesh.to(g) != first);
                sides.map(move |g| (f, [first, mesh.from(g), mesh.to(g)].map(at)))
            })
            .collect();
        let mut handed = Vec::new();
        for &point in faces.iter().flat_map(|&f| &self.carried[f]) {
            let q = self.points[point as usize];
            let mut nearest = (f64::INFINITY, None);
            for &(f, corners) in &triangles {
                let distance = q.distance(nearest_point(q, corners));
                if distance < nearest.0 {
                    nearest = (distance, Some(f));
                }
            }
            match nearest {
                (distance, Some(f)) if distance <= limit => handed.push((f, point)),
                _ => return false,
            }
        }
        for &f in &faces {
            self.carried[f].clear();
        }
        for (f, point) in handed {
            self.carried[f].push(point);
        }
        true
    }
}
