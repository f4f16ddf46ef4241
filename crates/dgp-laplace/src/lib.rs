//! The Laplacian of meshes and point clouds, and what it does.
//!
//! | topic | functions |
//! |---|---|
//! | matrices of meshes ([`laplacian`]) | [`uniform_laplacian`](laplacian::uniform_laplacian) [`cotangent_laplacian`](laplacian::cotangent_laplacian) [`mean_value_laplacian`](laplacian::mean_value_laplacian) [`mass_matrix`](laplacian::mass_matrix) |
//! | without negative weights ([`intrinsic`]) | [`intrinsic_delaunay`](intrinsic::intrinsic_delaunay) [`tufted_laplacian`](intrinsic::tufted_laplacian) [`point_cloud_laplacian`](intrinsic::point_cloud_laplacian) |
//! | by heat kernels ([`kernel`]) | [`gaussian_laplacian`](kernel::gaussian_laplacian) [`mesh_heat_laplacian`](kernel::mesh_heat_laplacian) |
//! | differential coordinates ([`differential`]) | [`DifferentialOperator`](differential::DifferentialOperator) [`Reconstruction`](differential::Reconstruction) |
//! | diffusion ([`flow`]) | [`heat_step`](flow::heat_step) [`mean_curvature_flow`](flow::mean_curvature_flow) |
//! | waves and their uses ([`spectral`]) | [`Eigenbasis`](spectral::Eigenbasis) [`fiedler`](spectral::fiedler) [`partition`](spectral::partition) [`compress`](spectral::compress) [`functional_map`](spectral::functional_map) [`zoomout`](spectral::zoomout) [`heat_kernel`](spectral::heat_kernel) |
//! | smoothing ([`smooth`]) | [`uniform`](smooth::uniform) [`taubin`](smooth::taubin) [`tangential`](smooth::tangential) [`cotangent`](smooth::cotangent) [`implicit`](smooth::implicit) [`bilateral`](smooth::bilateral) |
//!
//! ```
//! use dgp_laplace::smooth::{TaubinOptions, taubin};
//! use dgp_mesh::{Progress, VertexSet, shapes};
//!
//! let mut mesh = shapes::with_noise(shapes::icosphere(4)?, 0.1, 1)?;
//! let report = taubin(&mut mesh, &VertexSet::new(), &TaubinOptions::default(), Progress::NONE)?;
//! let (before, after) = report.volume_before.zip(report.volume_after).ok_or("a sphere is closed")?;
//! assert!((after / before - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(test)]
mod bad_input_tests;
pub mod differential;
mod error;
pub mod flow;
pub mod intrinsic;
pub mod kernel;
pub mod laplacian;
mod nearest;
pub mod smooth;
mod solve;
pub mod spectral;
#[cfg(test)]
mod test_shapes;
mod unit;

pub use error::Error;
