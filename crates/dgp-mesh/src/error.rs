//! What can go wrong.

use crate::{Cancelled, CornerId, DefectReport, EdgeId, EditError, FaceId, NotManifold, VertexId};

/// Why a function of this crate gave no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller asked the computation to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),

    /// A face names a vertex that does not exist.
    #[error("{face} names {vertex}, but there are only {vertex_count} vertices")]
    VertexOutOfRange {
        /// The first such face.
        face: FaceId,
        /// The vertex it names.
        vertex: VertexId,
        /// How many vertices there are.
        vertex_count: usize,
    },

    /// An edge ends at a vertex that does not exist.
    #[error("{edge} ends at {vertex}, but there are only {vertex_count} vertices")]
    EdgeOutOfRange {
        /// The first such edge.
        edge: EdgeId,
        /// The vertex it names.
        vertex: VertexId,
        /// How many vertices there are.
        vertex_count: usize,
    },

    /// The sides of a face do not follow each other.
    #[error("side {side} of {face} does not start where the one before it ends")]
    BrokenLoop {
        /// The face.
        face: FaceId,
        /// Which of its sides, counted from 0.
        side: usize,
    },

    /// More elements than 32-bit ids can count.
    #[error("{count} {kind} are more than the {limit} a mesh can hold; cut it into parts")]
    TooMany {
        /// What is counted.
        kind: &'static str,
        /// How many there are.
        count: usize,
        /// How many there can be.
        limit: usize,
    },

    /// Half-edges that were given for corners are not those of a mesh.
    #[error(
        "{corner} is said to start a half-edge that is out of range, taken by another corner, or not \
         opposite to its twin; join the faces without saying so"
    )]
    Unpaired {
        /// The first such corner.
        corner: CornerId,
    },

    /// The faces do not form an oriented manifold.
    #[error("{0}; `repair` can mend it")]
    NotManifold(#[from] NotManifold),

    /// A triangle mesh is needed.
    #[error("{face} has {degree} corners; triangulate the mesh first")]
    NotTriangle {
        /// The first face that is no triangle.
        face: FaceId,
        /// How many corners it has.
        degree: usize,
    },

    /// A face cannot be cut into triangles without a second edge between two vertices.
    #[error(
        "each way to cut {face} into triangles joins vertices that have an edge already; split that edge"
    )]
    NoTriangulation {
        /// The face.
        face: FaceId,
    },

    /// An edit was refused.
    #[error(transparent)]
    Edit(#[from] EditError),

    /// The faces have defects, all of which are listed.
    #[error("the faces are no manifold:\n{0}")]
    Defective(Box<DefectReport>),

    /// A surface has only one side, which was to be refused.
    #[error(
        "{} and {} cannot agree on what is outside at the edge {}–{}, nor can faces at {} other edges; \
         `OneSided::Cut` cuts there", faces[0], faces[1], vertices[0], vertices[1], edges - 1
    )]
    OneSided {
        /// At how many edges the surface would have to be cut.
        edges: usize,
        /// The ends of the first.
        vertices: [VertexId; 2],
        /// The faces there.
        faces: [FaceId; 2],
    },

    /// An edge has a weight that no shortest path can be found with.
    #[error("{edge} has weight {weight}; give each edge one that is not negative")]
    InvalidWeight {
        /// The first such edge.
        edge: EdgeId,
        /// Its weight.
        weight: f64,
    },

    /// A coordinate of a vertex is infinite or not a number.
    #[error("{vertex} has a coordinate that is not finite; `repair` drops it with its faces")]
    NonFinite {
        /// The first such vertex that a face has.
        vertex: VertexId,
    },

    /// A coordinate of a given point is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite; leave it out")]
    NonFinitePoint {
        /// Which of the points, counted from 0.
        index: usize,
    },

    /// A ray leads nowhere.
    #[error("ray {index} has no finite origin, no direction or a negative end; leave it out")]
    InvalidRay {
        /// Which of the rays, counted from 0.
        index: usize,
    },

    /// There is nothing to look for.
    #[error("there are no triangles and no points to find; give a surface that has faces")]
    Empty,

    /// An option has a value outside its range.
    #[error("option `{name}` is {value}, but must be {expected}")]
    InvalidOption {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
}

impl Error {
    /// The error for an option out of range.
    pub fn option(name: &'static str, value: f64, expected: &'static str) -> Self {
        Error::InvalidOption { name, value, expected }
    }
}
