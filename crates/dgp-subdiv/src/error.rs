//! What can go wrong.

use dgp_mesh::{Cancelled, EdgeId, FaceId, VertexId};

/// Why a function of this crate gave no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller asked the computation to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),

    /// The mesh is not what is needed.
    #[error(transparent)]
    Mesh(dgp_mesh::Error),

    /// The scheme splits triangles, but a face is none.
    #[error(
        "{face} has {degree} corners, but {scheme} splits triangles; call `dgp_mesh::triangulate` \
         first, or take Catmull–Clark"
    )]
    NotTriangle {
        /// The scheme asked for.
        scheme: &'static str,
        /// The first face that is no triangle.
        face: FaceId,
        /// How many corners it has.
        degree: usize,
    },

    /// Points of a face are named by two coordinates, but it is no quadrilateral.
    #[error(
        "{face} has {degree} corners, but a quadrilateral is needed; refine once and take its parts"
    )]
    NotQuad {
        /// The face.
        face: FaceId,
        /// How many corners it has.
        degree: usize,
    },

    /// A vertex belongs to no face, so no mask says where it goes.
    #[error("{vertex} belongs to no face; drop it with `dgp_mesh::repair`")]
    IsolatedVertex {
        /// The first such vertex.
        vertex: VertexId,
    },

    /// Two faces share both edges at a vertex; the refined mesh would have two edges between the same
    /// vertices.
    #[error(
        "{vertex} is inside the mesh, but only two faces meet there, which {scheme} cannot split; \
         split an edge there, or take Catmull–Clark"
    )]
    TwoFaces {
        /// The scheme asked for.
        scheme: &'static str,
        /// The first such vertex.
        vertex: VertexId,
    },

    /// A coordinate is infinite or not a number, before refining or because refining overflowed.
    #[error("{vertex} has a coordinate that is infinite or not a number; scale or repair the cage")]
    NotFinite {
        /// The first such vertex, of the cage or of the refined mesh.
        vertex: VertexId,
    },

    /// The sharpness of an edge is out of range.
    #[error("{edge} has sharpness {sharpness}, but it must be 0 (smooth) to 10 (sharp for ever)")]
    EdgeSharpness {
        /// The first such edge.
        edge: EdgeId,
        /// Its sharpness.
        sharpness: f64,
    },

    /// The sharpness of a vertex is out of range.
    #[error("{vertex} has sharpness {sharpness}, but it must be 0 (smooth) to 10 (sharp for ever)")]
    VertexSharpness {
        /// The first such vertex.
        vertex: VertexId,
        /// Its sharpness.
        sharpness: f64,
    },

    /// The scheme has no rules for creases.
    #[error("{scheme} has no rules for creases; take Loop or Catmull–Clark, or no sharpness")]
    NoCreases {
        /// The scheme asked for.
        scheme: &'static str,
    },

    /// The scheme has no limit masks here.
    #[error("{scheme} has no limit masks here; refine instead")]
    NoLimit {
        /// The scheme asked for.
        scheme: &'static str,
    },

    /// The refined meshes would not fit in the memory granted.
    #[error(
        "level {level} would have {faces} faces and need {bytes} bytes, more than the {limit} allowed; \
         refine less or raise `memory_limit`"
    )]
    TooLarge {
        /// The first level that does not fit.
        level: usize,
        /// How many faces it would have.
        faces: u64,
        /// What all levels up to it would need.
        bytes: u64,
        /// What was granted, or what 32-bit ids can count if that is less.
        limit: u64,
    },

    /// A stencil table has more entries than 32-bit offsets can count.
    #[error(
        "the stencils have {entries} entries, more than a table can hold; compose fewer levels"
    )]
    TooManyEntries {
        /// How many there would be.
        entries: u64,
    },

    /// Values do not fit the table or plan they are given to.
    #[error("{given} values are given, but {expected} are needed, one per {what}")]
    WrongLength {
        /// What a value is for.
        what: &'static str,
        /// How many values there are.
        given: usize,
        /// How many there must be.
        expected: usize,
    },

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

impl From<dgp_mesh::Error> for Error {
    fn from(error: dgp_mesh::Error) -> Self {
        match error {
            dgp_mesh::Error::Cancelled(cancelled) => Error::Cancelled(cancelled),
            other => Error::Mesh(other),
        }
    }
}
