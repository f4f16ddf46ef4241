//! What can go wrong.

use std::ops::ControlFlow;

use dgp_mesh::{Cancelled, EdgeId, FaceId, Progress, VertexId};

/// Why a function of this crate gave no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller asked the computation to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),

    /// The mesh is not what is needed.
    #[error(transparent)]
    Mesh(#[from] dgp_mesh::Error),

    /// A system could not be solved.
    #[error(transparent)]
    Solve(dgp_sparse::Error),

    /// The surface has no boundary.
    #[error(
        "the surface is closed (Euler characteristic {euler}), and only what has a boundary can be laid out; \
         cut it open first"
    )]
    Closed {
        /// V − E + F.
        euler: i64,
    },

    /// The surface has handles, more than one piece, or vertices on no face.
    #[error(
        "the surface is no disk: {components} pieces, Euler characteristic {euler}, {loops} boundary loops, \
         where a disk with holes has 1 piece and 2 − loops; keep one piece, and cut handles open"
    )]
    NotDisk {
        /// How many pieces it has, isolated vertices counted.
        components: usize,
        /// V − E + F.
        euler: i64,
        /// How many boundary loops.
        loops: usize,
    },

    /// The boundary that was named is none.
    #[error(
        "{vertex} is named as entry {entry} of the boundary, but no edge of the boundary leads from there to \
         the next; list a loop as `disk_boundary` gives it"
    )]
    NotBoundary {
        /// Which entry of the list.
        entry: usize,
        /// The vertex.
        vertex: VertexId,
    },

    /// A list has the wrong length.
    #[error("{given} values for {what}, of which there are {expected}")]
    WrongLength {
        /// What the values are for.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many there must be.
        expected: usize,
    },

    /// A polygon is not convex, runs clockwise, or has fewer than three corners.
    #[error(
        "the outline must be a convex polygon, counterclockwise, with at least three corners, but at corner \
         {corner} it does not turn left"
    )]
    NotConvex {
        /// The first corner that does not turn left.
        corner: usize,
    },

    /// The boundary has fewer vertices than the outline has corners.
    #[error(
        "the boundary has {vertices} vertices, fewer than the {corners} corners of the outline"
    )]
    TooFewVertices {
        /// Vertices of the boundary.
        vertices: usize,
        /// Corners of the outline.
        corners: usize,
    },

    /// All edges of the boundary are at one point, or a coordinate is not finite.
    #[error("the boundary has length {length}, which must be positive and finite")]
    NoLength {
        /// Its length.
        length: f64,
    },

    /// A face has no area, so that nothing can be said about what happens to it.
    #[error("{face} has no area; repair the mesh first (`dgp repair`)")]
    NoArea {
        /// The first such face.
        face: FaceId,
    },

    /// The ends of an edge are at one point, or nearly so.
    #[error("{edge} is too short to have a weight; weld its ends or remesh")]
    NoWeight {
        /// The first such edge.
        edge: EdgeId,
    },

    /// Fewer than two vertices are held, or two of them at one place.
    #[error("{problem}; hold two different vertices at two different places")]
    Pins {
        /// What is wrong with the pins.
        problem: &'static str,
    },
}

impl From<dgp_sparse::Error> for Error {
    fn from(error: dgp_sparse::Error) -> Self {
        match error {
            dgp_sparse::Error::Cancelled => Error::Cancelled(Cancelled),
            error => Error::Solve(error),
        }
    }
}

impl Error {
    /// An error unless `given` is `expected`.
    pub(crate) fn check_length(
        what: &'static str,
        given: usize,
        expected: usize,
    ) -> Result<(), Error> {
        if given == expected { Ok(()) } else { Err(Error::WrongLength { what, given, expected }) }
    }
}

/// Runs `f` with a progress of dgp-sparse that reports to `progress`.
pub(crate) fn with_progress<T>(
    progress: Progress<'_>,
    f: impl FnOnce(dgp_sparse::Progress<'_>) -> T,
) -> T {
    let callback = |done: f64| match progress.report(done) {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    f(dgp_sparse::Progress::new(&callback))
}
