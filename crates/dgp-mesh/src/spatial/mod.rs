//! Where things are: nearest points, rays, boxes, what is inside, and how far surfaces are apart.
//!
//! A [`TriangleTree`] is built once for a surface and then asked many times:
//!
//! | question | answer |
//! |---|---|
//! | what is nearest to a point | [`TriangleTree::closest_point`], [`TriangleTree::closest_points`], [`TriangleTree::nearest_faces`] |
//! | what is near | [`TriangleTree::faces_within`], [`TriangleTree::faces_in_box`] |
//! | what does a [`Ray`] or a segment meet | [`TriangleTree::first_hit`], [`TriangleTree::all_hits`], [`TriangleTree::is_hit`] |
//! | what is inside | [`WindingNumbers`], [`SignedDistances`] |
//!
//! Functions for many points or rays at once run in parallel and follow a curve through space, so that
//! each finds in the cache what the one before needed; they give the bits of the single ones.

mod batch;
mod build;
mod closest_point;
mod frame;
mod nodes;
mod overlap;
mod ray;
mod signed_distance;
mod triangle_tree;
mod winding_number;

pub use closest_point::ClosestPoint;
pub use ray::{Ray, RayHit};
pub use signed_distance::{SignedDistance, SignedDistances};
pub use triangle_tree::TriangleTree;
pub use winding_number::{WindingNumbers, WindingOptions};
