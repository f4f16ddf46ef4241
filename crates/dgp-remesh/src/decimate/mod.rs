//! Decimation: edges shrink to points, the least harmful first.

mod channels;
mod cost;
mod edge;
mod frame;
mod generic;
mod give_back;
mod nearness;
mod options;
mod passes;
mod polish;
pub(crate) mod quadric;
mod queue;
mod report;
pub(crate) mod rings;
mod state;
mod triangle;

pub use cost::{CollapseCost, CurvatureCost, LengthCost, Price, QuadricCost};
pub use generic::{DecimationOptions, decimate, seam_edges, sharp_edges};
pub use options::{Boundary, Memory, Order, Placement, QuadricOptions, Volume};
pub use quadric::decimate_quadric;
pub use report::{DecimationReport, Refusals, StopReason, Target};
