//! Curvature: how much a triangle mesh bends at its vertices, and in which directions.
//!
//! | you want | function | reads |
//! |---|---|---|
//! | the total Gaussian curvature of regions, exact by Gauss–Bonnet | [`angle_defects`] | angles |
//! | Gaussian curvature at a vertex | [`gaussian_curvatures`] | angles, areas |
//! | mean curvature at a vertex, or times the normal | [`mean_curvatures`], [`mean_curvature_vectors`] | cotangents, areas |
//! | principal curvatures and directions, from one-rings | [`principal_curvatures`] | vertex normals |
//! | the same of noisy surfaces, at a length of your choice | [`normal_cycle_curvatures`] | dihedral angles in a ball |
//! | ranges, totals, Gauss–Bonnet | [`curvature_report`] | all |
//!
//! Curvatures are positive where the surface bends away from its normal: those of a sphere with
//! outward normals are 1/r, those of a saddle have both signs. The unit is 1/length, for Gaussian
//! curvature 1/length². All functions need triangles. What the rounding of coordinates alone can
//! explain counts as zero, so a plane has no curvature however it lies. Nothing is NaN: where triangles
//! have no area, each function says what it gives.
//!
//! ```
//! use dgp_mesh::{curvature::principal_curvatures, shapes};
//!
//! let sphere = shapes::icosphere(4)?;
//! let curvature = principal_curvatures(&sphere)?;
//! assert!(curvature.values().iter().all(|k| (k.mean() - 1.0).abs() < 0.01));
//! # Ok::<(), dgp_mesh::Error>(())
//! ```

mod gaussian;
mod mean;
mod normal_cycle;
mod principal;
mod report;
mod tensor;
mod triangle;

pub use gaussian::{angle_defects, gaussian_curvatures};
pub use mean::{mean_curvature_vectors, mean_curvatures};
pub use normal_cycle::{Neighborhood, normal_cycle_curvatures};
pub use principal::principal_curvatures;
pub use report::{CurvatureReport, curvature_report};
pub use tensor::PrincipalCurvatures;
