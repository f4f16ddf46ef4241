//! Why a graph is not planar: a subdivision of K5 or K3,3.

use super::left_right;
use crate::{EdgeId, Error, Progress, VertexId, graph::Graph};

/// The two smallest graphs that are not planar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kuratowski {
    /// Five vertices, each joined to each.
    K5,
    /// Three vertices, each joined to each of three others.
    K33,
}

/// A part of a graph that cannot be drawn in the plane: paths that join branch vertices as the edges of
/// K5 or K3,3 do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Obstruction {
    /// Which of the two.
    pub kind: Kuratowski,
    /// The vertices where paths meet: five of degree 4, or six of degree 3.
    pub branch_vertices: Vec<VertexId>,
    /// All edges of the paths. Without any one of them the rest is planar.
    pub edges: Vec<EdgeId>,
}

/// A subdivision of K5 or K3,3 in `graph`; `None` if it is planar.
///
/// Edges are left out as long as the rest is not planar: k log E tests in all, where k is the number of
/// edges of the subdivision. Errors: [`Error::Cancelled`].
pub fn kuratowski(graph: &Graph, progress: Progress<'_>) -> Result<Option<Obstruction>, Error> {
    let mut candidates: Vec<EdgeId> = (0..graph.edge_count()).map(EdgeId::new).collect();
    let n = graph.vertex_count();
    // Among so many edges there is always a subdivision.
    candidates.truncate((3 * n).saturating_sub(5).max(9));
    let is_planar = |edges: &[EdgeId]| left_right::test(&graph.with_edges(edges)).is_some();
    if is_planar(&candidates) {
        return Ok(None);
    }
    // Edges known to be needed come first; the shortest beginning that is not planar ends with another.
    let mut needed = 0;
    loop {
        progress.report(1.0 - (candidates.len() - needed) as f64 / graph.edge_count() as f64)?;
        let (mut planar, mut crossing) = (needed, candidates.len());
        if !is_planar(&candidates[..needed]) {
            break;
        }
        while crossing - planar > 1 {
            let middle = planar + (crossing - planar) / 2;
            if is_planar(&candidates[..middle]) {
                planar = middle;
            } else {
                crossing = middle;
            }
        }
        candidates.truncate(crossing);
        candidates[needed..].rotate_right(1);
        needed += 1;
    }
    candidates.truncate(needed);
    candidates.sort_unstable();
    let part = graph.with_edges(&candidates);
    let branch_vertices: Vec<VertexId> = part.vertices().filter(|&v| part.degree(v) > 2).collect();
    let kind = if branch_vertices.len() == 5 { Kuratowski::K5 } else { Kuratowski::K33 };
    Ok(Some(Obstruction { kind, branch_vertices, edges: candidates }))
}
