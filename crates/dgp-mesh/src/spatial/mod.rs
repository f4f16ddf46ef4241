//! Where things are: nearest points of a surface.
//!
//! A [`TriangleTree`] is built once for a surface and then asked many times.

mod batch;
mod build;
mod closest_point;
mod frame;
mod nodes;
mod triangle_tree;

pub use closest_point::ClosestPoint;
pub use triangle_tree::TriangleTree;
