//! Laplacians by heat kernels: weights that fall with distance, faces or not.
//!
//! | of | function |
//! |---|---|
//! | points, as a graph | [`gaussian_laplacian`] |
//! | how far apart points are, to choose a time by | [`nearest_distances`] |
//! | a mesh, with areas | [`mesh_heat_laplacian`] |
//!
//! [`point_cloud_laplacian`](crate::intrinsic::point_cloud_laplacian) is more accurate for points on a surface and
//! needs no time to be chosen.

mod gaussian;
mod mesh_heat;

pub use gaussian::{Neighbors, gaussian_laplacian, nearest_distances};
pub use mesh_heat::{HeatKernel, mesh_heat_laplacian};
