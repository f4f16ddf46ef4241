//! Smoothing of meshes with the Laplacian.
//!
//! | topic | functions |
//! |---|---|
//! | smoothing ([`smooth`]) | [`uniform`](smooth::uniform) [`taubin`](smooth::taubin) [`tangential`](smooth::tangential) |
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

mod error;
pub mod smooth;

pub use error::Error;
