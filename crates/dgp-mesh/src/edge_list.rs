//! An edge list: vertices, the edges between them, and faces as loops of edges.
//!
//! The form of wireframes and of boundary representations, where an edge is an object of its own. A
//! face names directed edges by the same numbers as a mesh does: half-edges 2e and 2e + 1 are the two
//! directions of edge e.

use glam::DVec3;

use crate::{
    AttributeTable, Connectivity, CornerId, EdgeId, EdgeMap, Error, FaceId, FaceList, HalfedgeId,
    IndexedFaceSet, MAX_ELEMENTS, Mesh, VertexId, VertexMap,
};

/// Vertices, edges, and faces as closed loops of directed edges. Any number of faces may use an edge.
///
/// ```
/// use dgp_mesh::{DVec3, EdgeList, FaceList, IndexedFaceSet};
///
/// let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
/// let faces = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
/// let set = IndexedFaceSet::new(positions, faces)?;
/// let list = EdgeList::from_indexed(&set);
/// assert_eq!((list.edges().len(), list.to_indexed()), (5, set));
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeList {
    positions: VertexMap<DVec3>,
    edges: EdgeMap<[VertexId; 2]>,
    loops: Vec<HalfedgeId>,
    /// Where the loop of each face begins, and where the last one ends.
    starts: Vec<u32>,
    /// Data per vertex.
    pub vertex_attributes: AttributeTable<VertexId>,
    /// Data per edge.
    pub edge_attributes: AttributeTable<EdgeId>,
    /// Data per corner: that of a side is where it starts.
    pub corner_attributes: AttributeTable<CornerId>,
    /// Data per face.
    pub face_attributes: AttributeTable<FaceId>,
}

impl EdgeList {
    /// A wireframe: edges without faces.
    ///
    /// Errors: [`Error::EdgeOutOfRange`] if an edge ends at a vertex that does not exist,
    /// [`Error::TooMany`].
    pub fn new(
        positions: impl Into<VertexMap<DVec3>>,
        edges: impl Into<EdgeMap<[VertexId; 2]>>,
    ) -> Result<Self, Error> {
        let (positions, edges) = (positions.into(), edges.into());
        let vertex_count = positions.len();
        for (kind, count) in [("vertices", vertex_count), ("half-edges", 2 * edges.len())] {
            if count > MAX_ELEMENTS {
                return Err(Error::TooMany { kind, count, limit: MAX_ELEMENTS });
            }
        }
        for (edge, ends) in edges.iter() {
            if let Some(&vertex) = ends.iter().find(|v| v.index() >= vertex_count) {
                return Err(Error::EdgeOutOfRange { edge, vertex, vertex_count });
            }
        }
        Ok(EdgeList::without_faces(positions, edges))
    }

    fn without_faces(positions: VertexMap<DVec3>, edges: EdgeMap<[VertexId; 2]>) -> Self {
        EdgeList {
            vertex_attributes: AttributeTable::new(positions.len()),
            edge_attributes: AttributeTable::new(edges.len()),
            corner_attributes: AttributeTable::new(0),
            face_attributes: AttributeTable::new(0),
            loops: Vec::new(),
            starts: vec![0],
            positions,
            edges,
        }
    }

    /// Adds the face that walks along `sides` in turn; its data have default values.
    ///
    /// Errors: [`Error::BrokenLoop`] if a side does not exist or does not start where the one before
    /// it ends, [`Error::TooMany`].
    pub fn push_face(&mut self, sides: &[HalfedgeId]) -> Result<FaceId, Error> {
        let face = FaceId::new(self.face_count());
        let count = self.loops.len() + sides.len();
        let limit = FaceList::MAX_CORNERS;
        if count > limit {
            return Err(Error::TooMany { kind: "corners", count, limit });
        }
        for (k, &side) in sides.iter().enumerate() {
            let before = sides[(k + sides.len() - 1) % sides.len()];
            let exists = |h: HalfedgeId| h.edge().index() < self.edges.len();
            if !exists(side) || !exists(before) || self.ends(before)[1] != self.ends(side)[0] {
                return Err(Error::BrokenLoop { face, side: k });
            }
        }
        self.loops.extend_from_slice(sides);
        self.starts.push(count as u32);
        self.corner_attributes.resize(count);
        self.face_attributes.resize(face.index() + 1);
        Ok(face)
    }

    /// The vertices, edges and faces of `set`, which may be anything but a manifold.
    ///
    /// Edges are numbered by their smaller, then by their larger vertex, and lead from the one to the
    /// other, as in [`Connectivity::from_faces`]. A face of one corner has an edge from that to itself.
    pub fn from_indexed(set: &IndexedFaceSet) -> Self {
        let mut sides: Vec<(VertexId, VertexId, u32)> = Vec::new();
        let mut starts = vec![0];
        for (_, face) in set.faces().iter() {
            for (k, &a) in face.iter().enumerate() {
                let b = face[(k + 1) % face.len()];
                sides.push((a.min(b), a.max(b), sides.len() as u32));
            }
            starts.push(sides.len() as u32);
        }
        sides.sort_unstable();
        let mut edges: EdgeMap<[VertexId; 2]> = EdgeMap::new();
        let mut loops = vec![HalfedgeId::new(0); sides.len()];
        for group in sides.chunk_by(|s, t| (s.0, s.1) == (t.0, t.1)) {
            let (a, b, _) = group[0];
            let forward = edges.push([a, b]).halfedge();
            for &(.., corner) in group {
                let from = set.faces().vertex(CornerId::new(corner as usize));
                loops[corner as usize] = if from == a { forward } else { forward.twin() };
            }
        }
        let list = EdgeList::without_faces(set.positions().clone(), edges);
        EdgeList {
            loops,
            starts,
            vertex_attributes: set.vertex_attributes.clone(),
            corner_attributes: set.corner_attributes.clone(),
            face_attributes: set.face_attributes.clone(),
            ..list
        }
    }

    /// The vertices, edges and faces of `mesh` under their numbers, data per edge included.
    pub fn from_mesh(mesh: &Mesh) -> Self {
        let connectivity: &Connectivity = mesh;
        let edges = connectivity.map_edges(|e| connectivity.edge_vertices(e));
        let mut list = EdgeList::without_faces(mesh.positions().clone(), edges);
        for f in mesh.faces() {
            list.loops.extend(mesh.face_halfedges(f));
            list.starts.push(list.loops.len() as u32);
        }
        let attributes = mesh.attributes();
        list.vertex_attributes = attributes.vertex.clone();
        list.edge_attributes = attributes.edge.clone();
        list.face_attributes = attributes.face.clone();
        let side = |c: CornerId| Some(list.loops[c.index()]);
        list.corner_attributes = attributes.corner.gather(list.loops.len(), side);
        list
    }

    /// The faces as lists of vertices. Edges that no face uses, and data per edge, have no place there.
    pub fn to_indexed(&self) -> IndexedFaceSet {
        let mut faces = FaceList::new();
        faces.reserve(self.face_count(), self.loops.len());
        let mut face = Vec::new();
        for bounds in self.starts.windows(2) {
            face.clear();
            let sides = &self.loops[bounds[0] as usize..bounds[1] as usize];
            face.extend(sides.iter().map(|&h| self.ends(h)[0]));
            faces.push(&face);
        }
        let mut set = IndexedFaceSet::from_valid(self.positions.clone(), faces);
        set.vertex_attributes = self.vertex_attributes.clone();
        set.corner_attributes = self.corner_attributes.clone();
        set.face_attributes = self.face_attributes.clone();
        set
    }

    /// Where each vertex is.
    pub fn positions(&self) -> &VertexMap<DVec3> {
        &self.positions
    }

    /// The two ends of each edge.
    pub fn edges(&self) -> &EdgeMap<[VertexId; 2]> {
        &self.edges
    }

    /// How many faces there are.
    pub fn face_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The directed edges around face `f`.
    pub fn face_sides(&self, f: FaceId) -> &[HalfedgeId] {
        &self.loops[self.starts[f.index()] as usize..self.starts[f.index() + 1] as usize]
    }

    /// Where `side` starts and where it ends.
    pub fn ends(&self, side: HalfedgeId) -> [VertexId; 2] {
        let [a, b] = self.edges[side.edge()];
        if side == side.edge().halfedge() { [a, b] } else { [b, a] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_face_set_comes_back_as_it_was(
            faces in prop::collection::vec(prop::collection::vec(0_usize..6, 0..6), 0..8),
        ) {
            let positions: Vec<_> = (0..7).map(|i| DVec3::splat(f64::from(i))).collect();
            let faces = FaceList::from_indices(&faces);
            let corners = faces.corners().len();
            let mut set = IndexedFaceSet::new(positions, faces).unwrap();
            set.corner_attributes.insert("n", (0..corners as u32).collect::<Vec<_>>());
            prop_assert_eq!(EdgeList::from_indexed(&set).to_indexed(), set);
        }
    }

    #[test]
    fn meshes_keep_their_edges_and_the_data_on_them() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        let faces = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
        let set = IndexedFaceSet::new(positions, faces).unwrap();
        let mut mesh = Mesh::new(&set).unwrap();
        mesh.attributes_mut().edge.insert("crease", vec![0.0, 1.0, 2.0, 3.0, 4.0]);
        let list = EdgeList::from_mesh(&mesh);
        assert_eq!(list.edges(), EdgeList::from_indexed(&set).edges());
        assert_eq!(list.edge_attributes, mesh.attributes().edge);
        assert_eq!(list.to_indexed(), set);
    }

    #[test]
    fn loops_that_do_not_close_are_refused() {
        let v = VertexId::new;
        let edges = vec![[v(0), v(1)], [v(1), v(2)], [v(0), v(2)]];
        let mut list = EdgeList::new(vec![DVec3::ZERO; 3], edges).unwrap();
        let h = HalfedgeId::new;
        assert!(list.push_face(&[h(0), h(2), h(5)]).is_ok());
        let face = FaceId::new(1);
        let broken = list.push_face(&[h(0), h(2), h(4)]);
        assert_eq!(broken, Err(Error::BrokenLoop { face, side: 0 }));
        assert_eq!(list.push_face(&[h(8)]), Err(Error::BrokenLoop { face, side: 0 }));
        let out = EdgeList::new(vec![DVec3::ZERO; 2], vec![[v(0), v(2)]]);
        assert!(matches!(out, Err(Error::EdgeOutOfRange { vertex_count: 2, .. })));
    }
}
