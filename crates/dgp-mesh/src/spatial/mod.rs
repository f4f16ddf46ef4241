//! Where things are: nearest points, rays, boxes, what is inside, and how far surfaces are apart.
//!
//! A [`TriangleTree`] is built once for a surface and then asked many times:
//!
//! | question | answer |
//! |---|---|
//! | what is nearest to a point | [`TriangleTree::closest_point`], [`TriangleTree::closest_points`], [`TriangleTree::closest_point_near`], [`TriangleTree::nearest_faces`] |
//! | what is near | [`TriangleTree::faces_within`], [`TriangleTree::faces_in_box`] |
//! | what does a [`Ray`] or a segment meet | [`TriangleTree::first_hit`], [`TriangleTree::all_hits`], [`TriangleTree::is_hit`] |
//! | which faces pass through each other | [`TriangleTree::self_intersections`] |
//! | what is inside | [`WindingNumbers`], [`SignedDistances`]; of points with normals [`CloudWinding`] |
//! | how far are two surfaces apart | [`hausdorff`](hausdorff()) with sure bounds, [`deviation`](deviation()) for means |
//! | the same for points | [`PointTree`], [`chamfer`] |
//!
//! Functions for many points or rays at once run in parallel and follow a curve through space, so that
//! each finds in the cache what the one before needed; they give the bits of the single ones.

mod batch;
mod build;
mod closest_point;
mod cloud_winding;
mod curve;
mod deviation;
mod frame;
mod hausdorff;
mod nodes;
mod overlap;
mod point_tree;
mod ray;
mod self_intersection;
mod signed_distance;
mod triangle_tree;
mod winding_number;

pub use closest_point::{ClosestPoint, Near};
pub use cloud_winding::{AREA_NEIGHBORS, CloudWinding, cloud_areas};
pub use deviation::{Deviation, DeviationOptions, deviation};
pub use hausdorff::{
    HausdorffBounds, HausdorffOptions, HausdorffReport, hausdorff, one_sided_hausdorff,
};
pub use point_tree::{Chamfer, NearPoint, PointTree, chamfer};
pub use ray::{Ray, RayHit};
pub use signed_distance::{SignedDistance, SignedDistances};
pub use triangle_tree::TriangleTree;
pub use winding_number::{WindingNumbers, WindingOptions};
