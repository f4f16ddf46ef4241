//! What can go wrong.

use dgp_mesh::{Cancelled, FaceId, VertexId};

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

    /// The mesh has no room for more, or an edit was refused.
    #[error(transparent)]
    Edit(dgp_mesh::EditError),

    /// The equations of a smooth surface were not solved.
    #[error(transparent)]
    Solve(dgp_sparse::Error),

    /// A face is no triangle.
    #[error(
        "{face} has {degree} corners, but triangles are needed; call `dgp_mesh::triangulate` first"
    )]
    NotTriangle {
        /// The first face that is no triangle.
        face: FaceId,
        /// How many corners it has.
        degree: usize,
    },

    /// A coordinate is infinite or not a number.
    #[error("{vertex} has a coordinate that is infinite or not a number; repair the mesh first")]
    NotFinite {
        /// The first such vertex.
        vertex: VertexId,
    },

    /// There is no surface between the lines.
    #[error("the faces have no area together; check the coordinates, or repair the mesh first")]
    NoArea,

    /// A target or an option has a value outside its range.
    #[error("`{name}` is {value}, but must be {expected}")]
    InvalidOption {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },

    /// A level of a progressive mesh that does not exist.
    #[error("level {level} was asked for, but there are {levels} vertex splits")]
    NoLevel {
        /// The level.
        level: usize,
        /// The finest one.
        levels: usize,
    },

    /// A file of a progressive mesh is damaged or none.
    #[error("byte {offset} of the progressive mesh: {what}")]
    Damaged {
        /// Where it was noticed, in bytes from the start.
        offset: u64,
        /// What is wrong.
        what: String,
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
