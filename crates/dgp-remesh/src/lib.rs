//! Fewer faces for the same shape, and levels of detail that replay exactly.
//!
//! | topic | items |
//! |---|---|
//! | fewer triangles, fast and close to the input | [`decimate_quadric`], [`QuadricOptions`] |
//! | any cost, any constraint, any data | [`decimate`](decimate()), [`CollapseCost`], [`LengthCost`], [`CurvatureCost`], [`QuadricCost`] |
//! | all levels of detail of a mesh, exactly | [`ProgressiveMesh`], [`ProgressiveStream`], [`Geomorph`] |
//! | triangles nearly equilateral, of one size | [`remesh_isotropic`], [`RemeshOptions`] |
//! | the same, as fine as the shape needs | [`remesh_adaptive`], [`AdaptiveOptions`] |
//! | how good triangles are | [`triangle_quality`] |
//! | holes closed, smoothly | [`fill_holes`], [`FillOptions`] |
//! | quadric error metrics | [`Quadric`] |
//!
//! ```
//! use dgp_mesh::{Progress, VertexSet, shapes};
//! use dgp_remesh::{QuadricOptions, Target, Volume, decimate_quadric};
//!
//! let mut mesh = shapes::icosphere(4)?;
//! let options = QuadricOptions::default();
//! let report =
//!     decimate_quadric(&mut mesh, Target::Faces(500), &VertexSet::new(), &options, Progress::NONE)?;
//! assert_eq!(mesh.face_count(), 500);
//! assert!(report.largest_error < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod decimate;
mod error;
mod fill;
mod isotropic;
mod progressive;
mod quadric;

pub use decimate::{
    Boundary, CollapseCost, CurvatureCost, DecimationOptions, DecimationReport, LengthCost, Memory,
    Placement, Price, QuadricCost, QuadricOptions, Refusals, StopReason, Target, Volume, decimate,
    decimate_quadric, seam_edges, sharp_edges,
};
pub use error::Error;
pub use fill::{FillOptions, FillReport, Hole, HoleOutcome, LongestRim, Patch, fill_holes};
pub use isotropic::{
    AdaptiveOptions, Distance, Origin, RemeshOptions, RemeshReport, Rims, TriangleQuality,
    remesh_adaptive, remesh_isotropic, triangle_quality,
};
pub use progressive::{Geomorph, ProgressiveMesh, ProgressiveStream};
pub use quadric::Quadric;
