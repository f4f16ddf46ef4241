//! Subdivision surfaces: cages become smooth surfaces, with creases where they are wanted.
//!
//! | topic | items |
//! |---|---|
//! | a mesh refined, data included | [`subdivide`](subdivide()), [`SubdivisionOptions`] |
//! | connectivity once, values many times | [`RefinementPlan`], [`RefinementOptions`], [`Scheme`] |
//! | refinement as a sparse matrix | [`StencilTable`] |
//! | creases, corners, rims | [`Sharpness`], [`BoundaryRule`] |
//! | limit positions and tangents | [`RefinementPlan::limit`], [`RefinementPlan::limit_tangents`] |
//! | the limit surface at any point | [`RefinementPlan::evaluate`], [`SurfacePoint`] |
//! | faces split where asked, or until flat | [`refine_adaptively`], [`refine_to_tolerance`] |
//! | masks | [`loop_scheme`], [`catmull_clark`], [`butterfly`], [`sqrt3`], [`doo_sabin`] |
//! | triangles bent by normals | [`phong_tessellate`] |
//!
//! ```
//! use dgp_mesh::{Progress, shapes};
//! use dgp_subdiv::{RefinementOptions, Sharpness, SubdivisionOptions, Surface, subdivide};
//!
//! let refinement = RefinementOptions { levels: 4, ..RefinementOptions::default() };
//! let surface = Surface::Limit;
//! let options = SubdivisionOptions { refinement, surface, ..SubdivisionOptions::default() };
//! let (mesh, report) = subdivide(&shapes::cube(), &Sharpness::new(), &options, Progress::NONE)?;
//! assert_eq!(report.refined.faces, 6 * 4_u64.pow(4));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive;
pub mod butterfly;
pub mod catmull_clark;
pub mod doo_sabin;
mod error;
mod evaluate;
mod face_varying;
mod limit;
pub mod loop_scheme;
mod masks;
mod options;
mod phong;
mod plan;
mod primal;
mod ring;
mod sharpness;
mod smooth;
mod split;
pub mod sqrt3;
mod stencil;
mod subdivide;
mod topology;

pub use adaptive::{AdaptiveOptions, ToleranceReport, refine_adaptively, refine_to_tolerance};
pub use error::Error;
pub use evaluate::SurfacePoint;
pub use face_varying::FaceVarying;
pub use masks::Value;
pub use options::{BoundaryRule, ButterflyRule, Counts, LoopWeights, RefinementOptions, Scheme};
pub use phong::{PhongOptions, phong_tessellate};
pub use plan::RefinementPlan;
pub use sharpness::{SHARP, SHARPNESS, Sharpness};
pub use stencil::StencilTable;
pub use subdivide::{SubdivisionOptions, SubdivisionReport, Surface, subdivide};
