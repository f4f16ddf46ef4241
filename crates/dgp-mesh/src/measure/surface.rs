//! What a measure needs to know: where the vertices are and which of them form a face.

use glam::DVec3;

use crate::{FaceId, IndexedFaceSet, Mesh, VertexId, VertexMap};

/// A mesh or a face set that is none: measures that make sense on both take either.
pub trait Surface: Sync {
    /// Where each vertex is.
    fn vertex_positions(&self) -> &VertexMap<DVec3>;

    /// The number of faces.
    fn number_of_faces(&self) -> usize;

    /// The vertices of face `f`, in order.
    fn polygon(&self, f: FaceId) -> impl Iterator<Item = VertexId> + Clone;

    /// The corners of `f` if it is a triangle.
    fn corners_of_triangle(&self, f: FaceId) -> Option<[VertexId; 3]>;
}

impl Surface for Mesh {
    #[inline]
    fn vertex_positions(&self) -> &VertexMap<DVec3> {
        self.positions()
    }

    #[inline]
    fn number_of_faces(&self) -> usize {
        self.face_count()
    }

    #[inline]
    fn polygon(&self, f: FaceId) -> impl Iterator<Item = VertexId> + Clone {
        let first = self.face_halfedge(f);
        std::iter::successors(Some(first), move |&h| Some(self.next(h)).filter(|&h| h != first))
            .map(|h| self.from(h))
    }

    #[inline]
    fn corners_of_triangle(&self, f: FaceId) -> Option<[VertexId; 3]> {
        self.triangle(f)
    }
}

impl Surface for IndexedFaceSet {
    #[inline]
    fn vertex_positions(&self) -> &VertexMap<DVec3> {
        self.positions()
    }

    #[inline]
    fn number_of_faces(&self) -> usize {
        self.face_count()
    }

    #[inline]
    fn polygon(&self, f: FaceId) -> impl Iterator<Item = VertexId> + Clone {
        self.faces().face(f).iter().copied()
    }

    #[inline]
    fn corners_of_triangle(&self, f: FaceId) -> Option<[VertexId; 3]> {
        self.faces().face(f).try_into().ok()
    }
}
