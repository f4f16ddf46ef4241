//! Positions and faces without connectivity: what files hold, valid or not.

use glam::DVec3;

use crate::{AttributeTable, CornerId, Error, FaceId, FaceList, VertexId, VertexMap};

/// Shared vertices, faces that index them, and their attributes.
///
/// Everything can be stored here: non-manifold, misoriented and degenerate faces, vertices of no
/// face, coordinates that are no numbers. Only indices are always in range. [`Mesh::new`](crate::Mesh::new)
/// makes a mesh of it where it is a manifold.
///
/// ```
/// use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Mesh};
///
/// let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
/// let triangle = IndexedFaceSet::new(positions, FaceList::from_indices(&[[0, 1, 2]]))?;
/// assert_eq!(Mesh::new(&triangle)?.edge_count(), 3);
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IndexedFaceSet {
    positions: VertexMap<DVec3>,
    faces: FaceList,
    /// Data per vertex.
    pub vertex_attributes: AttributeTable<VertexId>,
    /// Data per corner.
    pub corner_attributes: AttributeTable<CornerId>,
    /// Data per face.
    pub face_attributes: AttributeTable<FaceId>,
}

impl IndexedFaceSet {
    /// A face set without attributes, or [`Error::VertexOutOfRange`].
    pub fn new(positions: impl Into<VertexMap<DVec3>>, faces: FaceList) -> Result<Self, Error> {
        let positions = positions.into();
        faces.validate(positions.len())?;
        Ok(IndexedFaceSet::from_valid(positions, faces))
    }

    /// A face set whose faces are known to be in range.
    pub(crate) fn from_valid(positions: VertexMap<DVec3>, faces: FaceList) -> Self {
        IndexedFaceSet {
            vertex_attributes: AttributeTable::new(positions.len()),
            corner_attributes: AttributeTable::new(faces.corners().len()),
            face_attributes: AttributeTable::new(faces.len()),
            positions,
            faces,
        }
    }

    /// How many vertices there are, those of no face included.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// How many faces there are.
    #[inline]
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Where vertex `v` is.
    #[inline]
    pub fn position(&self, v: VertexId) -> DVec3 {
        self.positions[v]
    }

    /// Where each vertex is.
    #[inline]
    pub fn positions(&self) -> &VertexMap<DVec3> {
        &self.positions
    }

    /// Where each vertex is, to be changed.
    pub fn positions_mut(&mut self) -> &mut [DVec3] {
        self.positions.values_mut()
    }

    /// The faces.
    #[inline]
    pub fn faces(&self) -> &FaceList {
        &self.faces
    }
}
