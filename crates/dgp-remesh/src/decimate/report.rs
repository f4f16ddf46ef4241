//! How far to go, and what was done.

use dgp_mesh::{FaceId, FaceMap, Mesh, VertexId, VertexMap};

use crate::Error;

/// Where a decimation stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// At so many faces, or one more where a pair goes at a time.
    Faces(usize),
    /// At so many vertices.
    Vertices(usize),
    /// Where every collapse left would have a larger error, in the unit of the coordinates.
    Error(f64),
}

impl Target {
    /// Refuses errors that are negative or no number.
    pub(crate) fn check(self) -> Result<(), Error> {
        match self {
            Target::Error(value) if !(value >= 0.0) => {
                Err(Error::InvalidOption { name: "error", value, expected: "zero or more" })
            }
            _ => Ok(()),
        }
    }

    /// Whether a mesh of this size is small enough.
    pub(crate) fn is_reached(self, vertices: usize, faces: usize) -> bool {
        match self {
            Target::Faces(count) => faces <= count,
            Target::Vertices(count) => vertices <= count,
            Target::Error(_) => false,
        }
    }

    /// The largest error allowed.
    pub(crate) fn error_limit(self) -> f64 {
        if let Target::Error(limit) = self { limit } else { f64::INFINITY }
    }

    /// The fraction of the way from `start` to the target, where that is known.
    pub(crate) fn progress(self, start: [usize; 2], now: [usize; 2]) -> f64 {
        let (goal, k) = match self {
            Target::Vertices(count) => (count, 0),
            Target::Faces(count) => (count, 1),
            Target::Error(_) => (0, 1),
        };
        let way = start[k].saturating_sub(goal).max(1);
        ((start[k] - now[k]) as f64 / way as f64).min(1.0)
    }
}

/// Why a decimation stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The mesh is as small as was asked for; perhaps it was from the start.
    TargetReached,
    /// Every collapse that is left is refused: see [`DecimationReport::refusals`].
    NothingLeft,
}

/// How many collapses were refused, by the first reason found. One edge may be refused many times, for its
/// surroundings change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    /// The surface would no longer be a manifold of the same topology.
    pub topology: usize,
    /// A triangle would turn over or vanish.
    pub flipped: usize,
    /// Both ends are protected, or the one that would go is.
    pub protected: usize,
    /// The error would exceed the limit.
    pub error: usize,
    /// A triangle would be too thin.
    pub shape: usize,
    /// The distance to the input would exceed the bound.
    pub distance: usize,
}

/// What a decimation did.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct DecimationReport {
    /// Vertices before and after.
    pub vertices: [usize; 2],
    /// Faces before and after.
    pub faces: [usize; 2],
    /// How many edges were collapsed.
    pub collapses: usize,
    /// The largest error of a collapse that was done, in the unit of the coordinates.
    pub largest_error: f64,
    /// Why it stopped.
    pub stop: StopReason,
    /// What was refused.
    pub refusals: Refusals,
    /// For each vertex there was, the one it is now, alone or merged with others.
    pub vertex_map: VertexMap<VertexId>,
    /// For each face there was, the one it is now, `None` if it vanished.
    pub face_map: FaceMap<Option<FaceId>>,
}

impl DecimationReport {
    /// Of a mesh that was left as it is.
    pub(crate) fn unchanged(mesh: &Mesh) -> Self {
        DecimationReport {
            vertices: [mesh.vertex_count(); 2],
            faces: [mesh.face_count(); 2],
            collapses: 0,
            largest_error: 0.0,
            stop: StopReason::TargetReached,
            refusals: Refusals::default(),
            vertex_map: VertexMap::from_fn(mesh.vertex_count(), |v| v),
            face_map: FaceMap::from_fn(mesh.face_count(), Some),
        }
    }
}
