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
//! | surfaces mended: slivers, T-junctions, self-intersections | [`repair_surface`], [`remove_self_intersections`], [`remove_slivers`], [`stitch_rims`] |
//! | points on a surface, at random or evenly | [`sample_uniform`], [`sample_stratified`], [`sample_poisson_disk`], [`sample_blue_noise`] |
//! | a new triangulation of evenly spread vertices | [`voronoi_remesh`], [`VoronoiOptions`] |
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
mod repair;
mod sample;
mod voronoi;

pub use decimate::{
    Boundary, CollapseCost, CurvatureCost, DecimationOptions, DecimationReport, LengthCost, Memory,
    Order, Placement, Price, QuadricCost, QuadricOptions, Refusals, StopReason, Target, Volume,
    decimate, decimate_quadric, seam_edges, sharp_edges,
};
pub use error::Error;
pub use fill::{FillOptions, FillReport, Hole, HoleOutcome, LongestRim, Patch, fill_holes};
pub use isotropic::{
    AdaptiveOptions, Distance, Origin, RemeshOptions, RemeshReport, Rims, TriangleQuality,
    remesh_adaptive, remesh_isotropic, triangle_quality,
};
pub use progressive::{Geomorph, ProgressiveMesh, ProgressiveStream};
pub use quadric::Quadric;
pub use repair::{
    IntersectionOptions, IntersectionReport, LeastComponent, OpenSurfaces, RepairStep,
    SliverOptions, SliverReport, StitchReport, SurfaceRepairOptions, SurfaceRepairReport,
    cap_faces, drop_small_components, hidden_fronts, needle_faces, remove_self_intersections,
    remove_slivers, repair_surface, stitch_rims,
};
pub use sample::{
    BlueNoiseOptions, BlueNoiseReport, MAX_SAMPLES, PoissonOptions, PoissonReport, SampleNormal,
    SurfaceSample, sample_attributes, sample_blue_noise, sample_normals, sample_poisson_disk,
    sample_stratified, sample_uniform,
};
pub use voronoi::{VoronoiOptions, VoronoiPlacement, VoronoiReport, voronoi_remesh};
