//! A mesh: half-edges, positions and the data that travel with them.

use std::ops::Deref;

use glam::DVec3;

use crate::{
    AttributeTable, Connectivity, CornerId, EdgeId, Error, FaceId, HalfedgeId, IndexedFaceSet,
    NotManifold, VertexId, VertexMap, build::assemble::assemble,
};

/// A polygon mesh that is always a valid oriented 2-manifold, with or without boundary.
///
/// It has all methods of [`Connectivity`]. A corner is known by the half-edge that starts there: the
/// corner of `h` is the one of `face(h)` at `from(h)`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub(crate) connectivity: Connectivity,
    pub(crate) positions: VertexMap<DVec3>,
    pub(crate) attributes: Attributes,
}

/// The data that travel with a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Data per vertex.
    pub vertex: AttributeTable<VertexId>,
    /// Data per corner; half-edges without a face hold default values.
    pub corner: AttributeTable<HalfedgeId>,
    /// Data per edge.
    pub edge: AttributeTable<EdgeId>,
    /// Data per face.
    pub face: AttributeTable<FaceId>,
}

impl Mesh {
    /// Makes a mesh of `set`, attributes included, if it is an oriented manifold as it stands.
    ///
    /// Faces and vertices keep their numbers. Vertices of no face are allowed, zero areas too.
    /// Errors: [`Error::NotManifold`] with the first obstacle found.
    pub fn new(set: &IndexedFaceSet) -> Result<Self, Error> {
        if let Some(vertex) = set.positions().iter().find(|(_, p)| !p.is_finite()).map(|(v, _)| v) {
            return Err(NotManifold::NonFinite { vertex }.into());
        }
        let (connectivity, corner_halfedges) = assemble(set.vertex_count(), set.faces())?;
        let mut corner_attributes = AttributeTable::new(connectivity.halfedge_count());
        if !set.corner_attributes.is_empty() {
            let mut corner = vec![None; connectivity.halfedge_count()];
            for (c, &h) in corner_halfedges.iter().enumerate() {
                corner[h as usize] = Some(CornerId::new(c));
            }
            corner_attributes =
                set.corner_attributes.gather(corner.len(), |h: HalfedgeId| corner[h.index()]);
        }
        // Leaves its room to the positions.
        drop(corner_halfedges);
        let mut mesh = Mesh::from_parts(connectivity, set.positions().clone());
        mesh.attributes.vertex = set.vertex_attributes.clone();
        mesh.attributes.face = set.face_attributes.clone();
        mesh.attributes.corner = corner_attributes;
        Ok(mesh)
    }

    /// A mesh without attributes.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn from_parts(connectivity: Connectivity, positions: VertexMap<DVec3>) -> Self {
        assert_eq!(positions.len(), connectivity.vertex_count(), "one position per vertex");
        let attributes = Attributes {
            vertex: AttributeTable::new(connectivity.vertex_count()),
            corner: AttributeTable::new(connectivity.halfedge_count()),
            edge: AttributeTable::new(connectivity.edge_count()),
            face: AttributeTable::new(connectivity.face_count()),
        };
        Mesh { connectivity, positions, attributes }
    }

    /// The mesh as shared vertices and faces. Data per edge have no place there and are left out.
    pub fn to_indexed(&self) -> IndexedFaceSet {
        let faces = self.to_faces();
        let corner_halfedges: Vec<HalfedgeId> =
            self.faces().flat_map(|f| self.face_halfedges(f)).collect();
        let corner_attributes = self
            .attributes
            .corner
            .gather(corner_halfedges.len(), |c: CornerId| Some(corner_halfedges[c.index()]));
        let mut set = IndexedFaceSet::from_valid(self.positions.clone(), faces);
        set.vertex_attributes = self.attributes.vertex.clone();
        set.corner_attributes = corner_attributes;
        set.face_attributes = self.attributes.face.clone();
        set
    }

    /// The half-edges without the positions.
    #[inline]
    pub fn connectivity(&self) -> &Connectivity {
        &self.connectivity
    }

    /// Where `v` is.
    #[inline]
    pub fn position(&self, v: VertexId) -> DVec3 {
        self.positions[v]
    }

    /// Where each vertex is.
    #[inline]
    pub fn positions(&self) -> &VertexMap<DVec3> {
        &self.positions
    }

    /// Moves `v` to `position`.
    #[inline]
    pub fn set_position(&mut self, v: VertexId, position: DVec3) {
        self.positions[v] = position;
    }

    /// Moves all vertices.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn set_positions(&mut self, positions: VertexMap<DVec3>) {
        assert_eq!(positions.len(), self.vertex_count(), "one position per vertex");
        self.positions = positions;
    }

    /// The data that travel with the mesh.
    pub fn attributes(&self) -> &Attributes {
        &self.attributes
    }

    /// The data that travel with the mesh, to be changed. Each table keeps its length.
    pub fn attributes_mut(&mut self) -> &mut Attributes {
        &mut self.attributes
    }
}

impl Deref for Mesh {
    type Target = Connectivity;

    #[inline]
    fn deref(&self) -> &Connectivity {
        &self.connectivity
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FaceList, UV};
    use glam::DVec2;

    #[test]
    fn face_sets_come_back_as_they_went_in() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE, DVec3::Z];
        let faces = FaceList::from_indices::<&[usize]>(&[&[1, 3, 2], &[0, 1, 2]]);
        let mut set = IndexedFaceSet::new(positions, faces).unwrap();
        let uv: Vec<DVec2> = (0..6).map(|i| DVec2::splat(f64::from(i))).collect();
        set.corner_attributes.insert(UV, uv);
        set.face_attributes.insert("part", vec![7_u8, 9]);
        set.vertex_attributes.insert("height", vec![0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(Mesh::new(&set).unwrap().to_indexed(), set);
    }

    #[test]
    fn coordinates_that_are_no_numbers_are_refused() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, f64::NAN, 0.0)];
        let set = IndexedFaceSet::new(positions, FaceList::from_indices(&[[0, 1, 2]])).unwrap();
        let vertex = VertexId::new(2);
        assert_eq!(Mesh::new(&set), Err(Error::NotManifold(NotManifold::NonFinite { vertex })));
    }
}
