//! Decimation: edges shrink to points, the least harmful first.

mod cost;
mod edge;
mod generic;
mod nearness;
pub(crate) mod quadric;
mod report;
pub(crate) mod rings;

pub use cost::{CollapseCost, CurvatureCost, LengthCost, Price, QuadricCost};
pub use generic::{DecimationOptions, decimate, seam_edges, sharp_edges};
pub use quadric::{Boundary, Memory, Placement, QuadricOptions, Volume, decimate_quadric};
pub use report::{DecimationReport, Refusals, StopReason, Target};
