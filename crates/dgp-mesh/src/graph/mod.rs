//! Search along edges.
//!
//! | question | function |
//! |---|---|
//! | how many edges away is everything | [`breadth_first`] |
//! | how far is everything along edges, and which way | [`dijkstra`] |
//! | which is the shortest way to one vertex | [`astar`] |
//! | the neighbors of all vertices as lists, to visit them often | [`VertexAdjacency`] |
//! | the same without faces: any vertices and edges | [`Graph`] |
//! | whether it can be drawn in the plane, how, or why not | [`is_planar`], [`planar_embedding`], [`kuratowski`], [`edge_bound`] |
//! | colors such that neighbors differ | [`smallest_last_coloring`], [`five_coloring`], [`bipartition`] |
//! | elements by a priority that changes | [`IndexedHeap`] |
//!
//! ```
//! use dgp_mesh::{Progress, VertexId, graph::{Until, dijkstra}, measure::edge_lengths, shapes::cube};
//!
//! let cube = cube();
//! let start = VertexId::new(0);
//! let found = dijkstra(&cube, &edge_lengths(&cube), &[start], Until::AllReached, Progress::NONE)?;
//! let farthest = found.order.last().copied().expect("eight vertices");
//! assert_eq!(found.path(&cube, farthest).map(|path| path.len()), Some(3));
//! # Ok::<(), dgp_mesh::Error>(())
//! ```

mod adjacency;
mod astar;
mod breadth_first;
mod coloring;
mod dijkstra;
mod edge_bound;
mod heap;
mod planar;
mod simple;

pub use adjacency::VertexAdjacency;
pub use astar::{Path, astar};
pub use breadth_first::{BreadthFirst, breadth_first};
pub use coloring::{Coloring, five_coloring, smallest_last_coloring, smallest_last_order};
pub use dijkstra::{ShortestPaths, Until, dijkstra};
pub use edge_bound::{EdgeBound, bipartition, edge_bound};
pub use heap::IndexedHeap;
pub use planar::{Embedding, Kuratowski, Obstruction, is_planar, kuratowski, planar_embedding};
pub use simple::Graph;
