//! Surfaces laid out in the plane.
//!
//! | topic | items |
//! |---|---|
//! | is it a disk, and where does it end | [`disk_boundary`] |
//! | the boundary on a convex shape | [`convex_boundary`], [`Outline`] |
//! | inside of a given boundary, linear | [`map_to_boundary`], [`Weights`], [`map_with_laplacian`] |
//! | conformal, the boundary free | [`least_squares_conformal`], [`Pin`] |
//! | what a map does to lengths, angles, areas | [`distortion`], [`FaceDistortion`], [`DistortionReport`] |
//! | does the plane's picture overlap | [`boundary_crossings`] |
//!
//! ```
//! use dgp_mesh::{Progress, shapes};
//! use dgp_param::{Outline, Weights, convex_boundary, disk_boundary, distortion, map_to_boundary};
//!
//! // A bowl on the disk.
//! let mut bowl = shapes::disk(12)?;
//! bowl.set_positions(bowl.positions().map(|p| p.with_z(p.length_squared())));
//! let rim = disk_boundary(&bowl)?;
//! let outline = convex_boundary(&bowl, &rim, &Outline::Circle)?;
//! let map = map_to_boundary(&bowl, &rim, &outline, Weights::MeanValue, Progress::NONE)?;
//! let report = distortion(&bowl, &map)?;
//! assert_eq!(report.flipped, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod boundary;
mod conformal;
mod crossings;
mod disk;
mod distortion;
mod error;
mod fixed;

pub use boundary::{Outline, convex_boundary};
pub use conformal::{Pin, least_squares_conformal};
pub use crossings::boundary_crossings;
pub use disk::disk_boundary;
pub use distortion::{DistortionReport, FaceDistortion, Spread, distortion, face_distortions};
pub use error::Error;
pub use fixed::{Weights, map_to_boundary, map_with_laplacian};
