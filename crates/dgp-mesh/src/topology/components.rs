//! Connected components: which parts of a mesh hang together.

use super::union_find::UnionFind;
use crate::{Connectivity, FaceId, FaceList, FaceMap, VertexId, VertexMap};

/// A number for each component, from 0 in order of the smallest vertex.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Components {
    /// How many there are. Vertices of no face are in none.
    pub count: usize,
    /// The component of each vertex; `None` on no face.
    pub vertex: VertexMap<Option<u32>>,
    /// The component of each face; `None` for a face without corners.
    pub face: FaceMap<Option<u32>>,
}

impl Components {
    /// The faces of each component, in order.
    pub fn faces(&self) -> Vec<Vec<FaceId>> {
        let mut lists = vec![Vec::new(); self.count];
        for (f, component) in self.face.iter() {
            if let Some(c) = component {
                lists[*c as usize].push(f);
            }
        }
        lists
    }

    /// The component with most faces, the first of equals; `None` if there are no faces.
    pub fn largest(&self) -> Option<usize> {
        let sizes = self.faces().into_iter().map(|faces| faces.len());
        sizes.enumerate().max_by_key(|&(c, size)| (size, std::cmp::Reverse(c))).map(|(c, _)| c)
    }
}

/// The components of a mesh.
pub fn components(mesh: &Connectivity) -> Components {
    let mut sets = UnionFind::new(mesh.vertex_count());
    for e in mesh.edges() {
        let [a, b] = mesh.edge_vertices(e);
        sets.join(a.index(), b.index());
    }
    let used = |v: VertexId| !mesh.is_isolated_vertex(v);
    number(mesh.vertex_count(), sets, used, mesh.face_count(), |f| {
        Some(mesh.from(mesh.face_halfedge(f)))
    })
}

/// The components of faces that may be no manifold: faces that share a vertex hang together.
///
/// # Panics
/// If a face names a vertex beyond `vertex_count`.
pub fn face_list_components(vertex_count: usize, faces: &FaceList) -> Components {
    let mut sets = UnionFind::new(vertex_count);
    let mut used = vec![false; vertex_count];
    for (_, face) in faces.iter() {
        for &v in face {
            used[v.index()] = true;
            sets.join(face[0].index(), v.index());
        }
    }
    number(vertex_count, sets, |v| used[v.index()], faces.len(), |f| faces.face(f).first().copied())
}

/// Numbers the sets of used vertices, and faces by one of their vertices.
fn number(
    vertex_count: usize,
    mut sets: UnionFind,
    used: impl Fn(VertexId) -> bool,
    face_count: usize,
    corner: impl Fn(FaceId) -> Option<VertexId>,
) -> Components {
    let mut count = 0;
    let mut vertex: VertexMap<Option<u32>> = VertexMap::filled(vertex_count, None);
    for v in (0..vertex_count).map(VertexId::new).filter(|&v| used(v)) {
        // The representative is the smallest of its set, so it has its number by now.
        let root = VertexId::new(sets.find(v.index()));
        vertex[v] = vertex[root].or_else(|| {
            count += 1;
            Some(count - 1)
        });
    }
    let face = FaceMap::from_fn(face_count, |f| corner(f).and_then(|v| vertex[v]));
    Components { count: count as usize, vertex, face }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_numbered_by_their_smallest_vertex() {
        // Vertex 1 lies on no face; the first face belongs to the component that comes last.
        let faces = FaceList::from_indices(&[[7, 5, 6], [3, 0, 2], [4, 3, 2]]);
        let found = components(&Connectivity::from_faces(8, &faces).unwrap());
        assert_eq!(found.count, 2);
        assert_eq!(found.face.values(), [Some(1), Some(0), Some(0)]);
        assert_eq!(found.vertex[VertexId::new(1)], None);
        assert_eq!(found, face_list_components(8, &faces));
        assert_eq!(found.largest(), Some(0));
    }
}
