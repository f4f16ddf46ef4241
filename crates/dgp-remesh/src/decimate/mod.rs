//! Decimation: edges shrink to points, the least harmful first.

mod cost;
mod edge;
mod frame;
mod generic;
mod give_back;
mod nearness;
mod options;
pub(crate) mod quadric;
mod report;
pub(crate) mod rings;

pub use cost::{CollapseCost, CurvatureCost, LengthCost, Price, QuadricCost};
pub use generic::{DecimationOptions, decimate, seam_edges, sharp_edges};
pub use options::{Boundary, Memory, Placement, QuadricOptions, Volume};
pub use quadric::decimate_quadric;
pub use report::{DecimationReport, Refusals, StopReason, Target};
