//! Half-edges: which vertices, edges and faces touch, without knowing where they are.
//!
//! Structure of arrays with paired half-edges (Kettner 1999; Botsch et al., *Polygon Mesh
//! Processing*, ch. 2): the half-edges of edge e are 2e and 2e + 1, so twin and edge are arithmetic
//! and cannot disagree. Stored are prev, to and face of each half-edge and one half-edge of each vertex and
//! face: 42 bytes per triangle. What follows a half-edge is found from what precedes it (decision 0006).
//!
//! Invariants, which [`Connectivity::from_faces`] establishes and every edit keeps (who calls
//! [`Connectivity::from_arrays`] vouches for them):
//!
//! - each half-edge precedes one other, of the same face or hole;
//! - `to(h) = from(next(h))`, and `from(h) ≠ to(h)`;
//! - all half-edges that leave a vertex form one orbit: a fan with at most one gap;
//! - the half-edge of a boundary vertex is the one with no face;
//! - no two edges join the same two vertices, and each face has at least three distinct vertices.

use crate::{
    EdgeId, Error, FaceId, FaceList, FaceMap, HalfedgeId, HalfedgeMap, VertexId, VertexMap,
    build::{assemble::assemble, paired::paired},
};

/// The half-edges of a manifold mesh of arbitrary polygons, holes allowed.
///
/// See [`Mesh`](crate::Mesh) for a mesh with positions, which has all methods of this type.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Connectivity {
    pub(crate) prev: HalfedgeMap<HalfedgeId>,
    pub(crate) to: HalfedgeMap<VertexId>,
    pub(crate) face: HalfedgeMap<Option<FaceId>>,
    pub(crate) vertex_halfedge: VertexMap<Option<HalfedgeId>>,
    pub(crate) face_halfedge: FaceMap<HalfedgeId>,
}

/// What a [`Connectivity`] stores, for code that works out half-edges by itself.
///
/// The half-edges of edge e are 2e and 2e + 1.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct HalfedgeArrays {
    /// The half-edge before each one, around its face or hole.
    pub prev: HalfedgeMap<HalfedgeId>,
    /// The vertex each half-edge leads to.
    pub to: HalfedgeMap<VertexId>,
    /// The face left of each half-edge, `None` at holes.
    pub face: HalfedgeMap<Option<FaceId>>,
    /// A half-edge that leaves each vertex: at a hole the one without a face, `None` if it is on no face.
    pub vertex_halfedge: VertexMap<Option<HalfedgeId>>,
    /// The first side of each face.
    pub face_halfedge: FaceMap<HalfedgeId>,
}

/// Why faces do not form an oriented manifold: the first reason found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotManifold {
    /// A face has fewer than three corners or names a vertex twice.
    #[error("{face} has fewer than three corners or names a vertex twice")]
    DegenerateFace {
        /// The face.
        face: FaceId,
    },
    /// More than two faces meet at an edge.
    #[error("{faces} faces meet at the edge between {} and {}", vertices[0], vertices[1])]
    NonManifoldEdge {
        /// The ends of the edge.
        vertices: [VertexId; 2],
        /// How many faces meet there.
        faces: usize,
    },
    /// Two faces that share an edge run along it in the same direction.
    #[error("{} and {} disagree on which side is outside", faces[0], faces[1])]
    Misoriented {
        /// The ends of the edge.
        vertices: [VertexId; 2],
        /// The faces.
        faces: [FaceId; 2],
    },
    /// The faces at a vertex form more than one fan.
    #[error("the faces at {vertex} form several fans")]
    NonManifoldVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// A coordinate is infinite or not a number.
    #[error("{vertex} has a coordinate that is infinite or not a number")]
    NonFinite {
        /// The vertex.
        vertex: VertexId,
    },
}

impl Connectivity {
    /// Joins `faces` on `vertex_count` vertices along their edges.
    ///
    /// Edges are numbered by their smaller, then by their larger vertex; the first half-edge of each
    /// leads from the smaller to the larger. Vertices of no face are kept. Linear time: edges are
    /// matched in buckets of their smaller vertex.
    ///
    /// Errors: [`Error::NotManifold`] with the first obstacle found, [`Error::VertexOutOfRange`],
    /// [`Error::TooMany`].
    pub fn from_faces(vertex_count: usize, faces: &FaceList) -> Result<Self, Error> {
        faces.validate(vertex_count)?;
        Ok(assemble(vertex_count, faces)?.0)
    }

    /// Joins `faces` whose sides are paired already: the half-edge that starts at corner c, in the order of
    /// [`FaceList::corners`], is `corner_halfedges[c]`, and those of edge e are 2e and 2e + 1. Edges keep
    /// these numbers. Unlike [`from_faces`](Self::from_faces) it finds no pairs.
    ///
    /// Errors: [`Error::Unpaired`] with the first corner whose half-edge cannot be, and those of
    /// [`from_faces`](Self::from_faces).
    pub fn from_paired_corners(
        vertex_count: usize,
        faces: &FaceList,
        corner_halfedges: &[u32],
    ) -> Result<Self, Error> {
        faces.validate(vertex_count)?;
        paired(vertex_count, faces, corner_halfedges)
    }

    /// Takes over half-edges that are known to fit together, such as those of a split that numbers its
    /// children by arithmetic. Nothing is searched or paired, and in a release build nothing but the lengths
    /// is checked: code that cannot prove that its arrays are valid calls
    /// [`from_paired_corners`](Self::from_paired_corners), or [`validate`](Self::validate) afterwards.
    ///
    /// # Panics
    /// If the arrays of half-edges differ in length or that is odd; where debug assertions are on, also if
    /// an invariant does not hold.
    pub fn from_arrays(arrays: HalfedgeArrays) -> Self {
        let HalfedgeArrays { prev, to, face, vertex_halfedge, face_halfedge } = arrays;
        let count = prev.len();
        assert!(count.is_multiple_of(2), "two half-edges an edge");
        assert!(to.len() == count && face.len() == count, "one entry per half-edge");
        let connectivity = Connectivity { prev, to, face, vertex_halfedge, face_halfedge };
        debug_assert_eq!(connectivity.validate(), Ok(()), "half-edges that fit together");
        connectivity
    }

    /// The faces as lists of vertices, in order.
    pub fn to_faces(&self) -> FaceList {
        let mut list = FaceList::new();
        list.reserve(self.face_count(), self.halfedge_count());
        let mut face = Vec::new();
        for f in self.faces() {
            face.clear();
            face.extend(self.face_vertices(f));
            list.push(&face);
        }
        list
    }

    /// How many vertices there are, those of no face included.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.vertex_halfedge.len()
    }

    /// How many half-edges there are, two for each edge.
    #[inline]
    pub fn halfedge_count(&self) -> usize {
        self.prev.len()
    }

    /// How many edges there are.
    #[inline]
    pub fn edge_count(&self) -> usize {
        self.prev.len() / 2
    }

    /// How many faces there are.
    #[inline]
    pub fn face_count(&self) -> usize {
        self.face_halfedge.len()
    }

    /// All vertices.
    pub fn vertices(
        &self,
    ) -> impl DoubleEndedIterator<Item = VertexId> + ExactSizeIterator + use<> {
        (0..self.vertex_count()).map(VertexId::new)
    }

    /// All half-edges.
    pub fn halfedges(
        &self,
    ) -> impl DoubleEndedIterator<Item = HalfedgeId> + ExactSizeIterator + use<> {
        (0..self.halfedge_count()).map(HalfedgeId::new)
    }

    /// All edges.
    pub fn edges(&self) -> impl DoubleEndedIterator<Item = EdgeId> + ExactSizeIterator + use<> {
        (0..self.edge_count()).map(EdgeId::new)
    }

    /// All faces.
    pub fn faces(&self) -> impl DoubleEndedIterator<Item = FaceId> + ExactSizeIterator + use<> {
        (0..self.face_count()).map(FaceId::new)
    }
}
