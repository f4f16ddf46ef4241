//! Why an edit was refused.

use crate::{EdgeId, FaceId, HalfedgeId, VertexId};

/// Why an edit was refused: it would have left something that is no oriented manifold. The mesh is
/// as it was before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// The vertex was removed, or never existed.
    #[error("{vertex} was removed, or never existed")]
    NoVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// The half-edge was removed, or never existed.
    #[error("{halfedge} was removed, or never existed")]
    NoHalfedge {
        /// The half-edge.
        halfedge: HalfedgeId,
    },
    /// The edge was removed, or never existed.
    #[error("{edge} was removed, or never existed")]
    NoEdge {
        /// The edge.
        edge: EdgeId,
    },
    /// The face was removed, or never existed.
    #[error("{face} was removed, or never existed")]
    NoFace {
        /// The face.
        face: FaceId,
    },
    /// A coordinate of the new position is infinite or not a number.
    #[error("the position has a coordinate that is infinite or not a number")]
    NonFinite,
    /// Ids could not count the elements any more.
    #[error("one edit more would make more {kind} than a mesh can hold (2³² − 2)")]
    TooMany {
        /// What there is too much of.
        kind: &'static str,
    },
    /// The edge has a face on one side only.
    #[error("{edge} lies at the boundary; the edit needs a face on both sides")]
    BoundaryEdge {
        /// The edge.
        edge: EdgeId,
    },
    /// The half-edge runs along a hole.
    #[error("{halfedge} runs along a hole; the edit needs a face there")]
    BoundaryHalfedge {
        /// The half-edge.
        halfedge: HalfedgeId,
    },
    /// The vertex is at the boundary, or on no face.
    #[error("{vertex} is not surrounded by faces")]
    BoundaryVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// There would be a second edge between two vertices.
    #[error("{edge} joins {} and {} already", vertices[0], vertices[1])]
    EdgeExists {
        /// The edge that is there.
        edge: EdgeId,
        /// Its ends.
        vertices: [VertexId; 2],
    },
    /// A face would have one vertex at two of its corners.
    #[error("a face would have {vertex} at two of its corners")]
    RepeatedVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// Both ends of the edge are joined to a vertex that does not span a triangle with the edge
    /// (the link condition).
    #[error("both ends of {edge} are joined to {vertex}, but not by a triangle at the edge")]
    LinkCondition {
        /// The edge.
        edge: EdgeId,
        /// The vertex.
        vertex: VertexId,
    },
    /// Both ends of an edge are on the boundary and the edge is not: its collapse would join the
    /// boundary to itself in one point.
    #[error("both ends of {edge} lie at the boundary, but the edge does not")]
    BoundaryEnds {
        /// The edge.
        edge: EdgeId,
    },
    /// An edge would be left without faces.
    #[error("{edge} would lose its last face")]
    LastFace {
        /// The edge.
        edge: EdgeId,
    },
    /// Two triangles lie back to back, with the same three corners, or would do so.
    #[error("{} and {} lie back to back or would do so: the same corners", faces[0], faces[1])]
    SameCorners {
        /// The triangles.
        faces: [FaceId; 2],
    },
    /// The faces at a vertex would form several fans.
    #[error("the faces at {vertex} would form several fans")]
    SeveralFans {
        /// The vertex.
        vertex: VertexId,
    },
    /// The half-edges do not belong to one face.
    #[error("{} and {} do not belong to one face", halfedges[0], halfedges[1])]
    DifferentFaces {
        /// The half-edges.
        halfedges: [HalfedgeId; 2],
    },
    /// A face needs at least three corners.
    #[error("a face needs three corners, but there are only {count}")]
    TooFewCorners {
        /// How many there are.
        count: usize,
    },
    /// A side of the new face is the side of another one already: an edge would get a third face, or
    /// the new face is the wrong way round.
    #[error("the side from {} to {} belongs to {face} already", vertices[0], vertices[1])]
    SideTaken {
        /// Where the side begins and ends.
        vertices: [VertexId; 2],
        /// The face that has it.
        face: FaceId,
    },
}
