//! Decimation: edges shrink to points, the least harmful first.

mod edge;
mod quadric;
mod report;
mod rings;

pub use quadric::{Boundary, Memory, Placement, QuadricOptions, Volume, decimate_quadric};
pub use report::{DecimationReport, Refusals, StopReason, Target};
