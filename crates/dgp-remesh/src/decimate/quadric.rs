//! Decimation of triangles by quadrics: collapses edges in the order of the squared distance to planes.
//!
//! - Input: triangles, with holes perhaps.
//! ```text
//! E(p) = Σ over a, b  Σ over triangles around it  w (n·(p − a))²,   w = A^(3/2)
//! p    = argmin E(p)  with  Σ A n·(p − a) = 0: the volume stays the same
//! ```
//!
//! - Cost: O(n log n).
//! - Guarantees: a manifold of the same topology; no triangle turned by more than `largest_turn`.
//! - Reference: Garland and Heckbert 1997; Lindstrom and Turk, "Fast and memory efficient polygonal
//!   simplification", Visualization 1998 (quadrics of the present triangles).
//! - Departs from it: weights are powers 3/2 of areas, between Hoppe's areas and Lindstrom and Turk's squares,
//!   which measured best in both mean and largest distance; rims and sharp edges are kept by planes through
//!   them; what planes leave free is drawn to the middle of the edge; the best edge of a vertex is looked for again only when its turn comes.

use dgp_mesh::{DVec3, Mesh, Progress, VertexSet};

use super::{
    options::QuadricOptions,
    report::{DecimationReport, Target},
    state::State,
};
use crate::Error;

/// Decimates triangles toward `target`; vertices of `fixed` stay where they are.
///
/// Data travel: see [`Editor::collapse_at`](dgp_mesh::Editor::collapse_at); those that count by
/// [`attribute_weight`](QuadricOptions::attribute_weight) get their best values. A cancelled run leaves a valid mesh,
/// decimated part of the way.
///
/// Errors: [`Error::NotTriangle`], [`Error::NotFinite`], [`Error::InvalidOption`], [`Error::Cancelled`].
pub fn decimate_quadric(
    mesh: &mut Mesh,
    target: Target,
    fixed: &VertexSet,
    options: &QuadricOptions,
    progress: Progress<'_>,
) -> Result<DecimationReport, Error> {
    target.check()?;
    options.check()?;
    if target.is_reached(mesh.vertex_count(), mesh.face_count()) {
        return Ok(DecimationReport::unchanged(mesh));
    }
    let mut state = State::new(mesh, target, fixed, options, progress.part(0.0, 0.1))?;
    let mut stopped = state.run(progress.part(0.1, 0.9));
    if stopped.is_ok() {
        stopped = state.polish(mesh, progress.part(0.9, 0.95));
    }
    let report = state.give_back(mesh)?;
    stopped?;
    progress.report(1.0)?;
    Ok(report)
}

/// The collapses that [`decimate_quadric`] would do, in order. The mesh stays as it is.
pub(crate) fn collapses(
    mesh: &Mesh,
    target: Target,
    fixed: &VertexSet,
    options: &QuadricOptions,
    progress: Progress<'_>,
) -> Result<Vec<Done>, Error> {
    target.check()?;
    options.check()?;
    let mut state = State::new(mesh, target, fixed, options, progress.part(0.0, 0.1))?;
    state.keeps_log = true;
    if !target.is_reached(mesh.vertex_count(), mesh.face_count()) {
        state.run(progress.part(0.1, 1.0))?;
    }
    let frame = state.frame;
    for done in &mut state.log {
        done.position = frame.position(mesh.positions(), done.held, done.position);
    }
    Ok(state.log)
}

/// A collapse that was done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Done {
    pub(crate) from: u32,
    pub(crate) to: u32,
    /// The vertex of the input whose position it is, `NONE` if it is a new one.
    pub(super) held: u32,
    pub(crate) position: DVec3,
}
