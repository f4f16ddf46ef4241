//! Planarity: draws a graph in the plane without crossings, or shows why that cannot be.
//!
//! A graph is planar if and only if it contains no subdivision of K5 or K3,3 (Kuratowski 1930), nor
//! either as a minor (Wagner 1937). The left–right test decides in linear time: a depth-first search
//! orients the edges, every back edge must return on the left or on the right of its tree path, and the
//! constraints which go on the same side and which on different ones must not contradict each other.
//!
//! - Input: any [`Graph`].
//! - Cost: O(V + E) time and memory for the test and the embedding; [`kuratowski`] runs the test
//!   k log E times to find a subdivision of k edges.
//! - Guarantees: both answers carry their proof: an embedding has genus 0 by Euler's formula
//!   ([`Embedding::genus`]), an obstruction is a subdivision whose branch vertices are told.
//! - Reference: de Fraysseix, Ossona de Mendez and Rosenstiehl, "Trémaux trees and planarity",
//!   International Journal of Foundations of Computer Science 17(5), 2006; Brandes, "The left-right
//!   planarity test", manuscript 2009.
//! - Departs from it: stacks instead of recursion, so that long paths are no danger.

mod embedding;
mod kuratowski;
mod left_right;

pub use embedding::Embedding;
pub use kuratowski::{Kuratowski, Obstruction, kuratowski};

use super::Graph;

/// Whether `graph` can be drawn in the plane without crossings.
pub fn is_planar(graph: &Graph) -> bool {
    let n = graph.vertex_count();
    (n < 3 || graph.edge_count() <= 3 * n - 6) && left_right::test(graph).is_some()
}

/// The order of the edges around each vertex in a drawing of `graph` without crossings; `None` if there
/// is no such drawing, and then [`kuratowski`] says why.
#[must_use]
pub fn planar_embedding(graph: &Graph) -> Option<Embedding> {
    let n = graph.vertex_count();
    // Euler's bound is quicker than the test.
    if n >= 3 && graph.edge_count() > 3 * n - 6 {
        return None;
    }
    left_right::test(graph).map(|sides| embedding::embed(graph, sides))
}

#[cfg(test)]
mod tests;
