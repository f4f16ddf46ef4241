//! What can go wrong.

use dgp_mesh::{Cancelled, EdgeId, VertexId};

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

    /// A matrix could not be made, or a system not be solved.
    #[error(transparent)]
    Sparse(dgp_sparse::Error),

    /// The ends of an edge are at one point, or nearly so.
    #[error("{edge} is too short to have a weight beside the others; weld its ends or remesh")]
    NoLength {
        /// The first such edge.
        edge: EdgeId,
    },

    /// Lengths form no triangle.
    #[error(
        "the sides of triangle {triangle} have lengths {} {} {}, which must be positive and finite, \
         none above the sum of the others",
        lengths[0], lengths[1], lengths[2]
    )]
    NoTriangle {
        /// Which triangle, counted from 0.
        triangle: usize,
        /// The lengths of its sides.
        lengths: [f64; 3],
    },

    /// A row has no mass to divide by.
    #[error(
        "row {row} has mass {mass}, but it must be positive and finite; remove vertices on no face \
         and faces without area"
    )]
    NoMass {
        /// The first such row.
        row: usize,
        /// Its mass.
        mass: f64,
    },

    /// The weights of a row cannot be normalized.
    #[error(
        "the weights of row {row} sum to {diagonal}, which must be positive; use weights that are not \
         negative, as those of an intrinsic Delaunay triangulation"
    )]
    NonPositiveDiagonal {
        /// The first such row.
        row: usize,
        /// The sum of its weights.
        diagonal: f64,
    },

    /// A point has a coordinate that is infinite or not a number.
    #[error("{vertex} has a coordinate that is infinite or not a number; remove it")]
    NotFinite {
        /// The first such point.
        vertex: VertexId,
    },

    /// There are fewer points than needed.
    #[error("{count} points are given, but at least {least} are needed")]
    TooFewPoints {
        /// How many there are.
        count: usize,
        /// How many there must be.
        least: usize,
    },

    /// Flips do not come to an end, which rounding can cause where triangles are nearly flat.
    #[error("after {flips} flips edges still want to be flipped; mollify more")]
    EndlessFlips {
        /// How many were done.
        flips: usize,
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

    /// The volume of a mesh with holes cannot be kept.
    #[error(
        "the mesh has a hole at {vertex}, so it has no volume to keep; fill the holes or let the volume change"
    )]
    NotClosed {
        /// A vertex at the rim of a hole.
        vertex: VertexId,
    },

    /// Keeping the volume would move vertices that are to stay.
    #[error(
        "keeping the volume moves all vertices, but {fixed} are to stay; let the volume change or free them"
    )]
    VolumeMovesFixed {
        /// How many vertices are to stay.
        fixed: usize,
    },

    /// Keeping the area would move vertices that are to stay.
    #[error(
        "keeping the area moves all vertices, but {fixed} are to stay; let the area shrink or free them"
    )]
    FixedArea {
        /// How many vertices are to stay, those of holes included.
        fixed: usize,
    },

    /// The volume fell to zero or changed its sign, so no scaling brings it back.
    #[error(
        "smoothing changed the volume from {before} to {after}, which no scaling brings back; smooth less"
    )]
    VolumeLost {
        /// The volume at the start.
        before: f64,
        /// The volume after smoothing.
        after: f64,
    },
}

impl Error {
    /// The error for an option out of range.
    pub fn option(name: &'static str, value: f64, expected: &'static str) -> Self {
        Error::InvalidOption { name, value, expected }
    }
}

impl From<dgp_mesh::Error> for Error {
    fn from(error: dgp_mesh::Error) -> Self {
        match error {
            dgp_mesh::Error::Cancelled(cancelled) => Error::Cancelled(cancelled),
            other => Error::Mesh(other),
        }
    }
}

impl From<dgp_sparse::Error> for Error {
    fn from(error: dgp_sparse::Error) -> Self {
        match error {
            dgp_sparse::Error::Cancelled => Error::Cancelled(Cancelled),
            other => Error::Sparse(other),
        }
    }
}
