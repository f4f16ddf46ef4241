//! What can go wrong.

use dgp_mesh::{Cancelled, VertexId};

/// Why a function of this crate gave no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller asked the computation to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),

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
