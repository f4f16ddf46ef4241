//! Diffusion: of values on a surface, and of the surface itself.
//!
//! | what flows | function |
//! |---|---|
//! | values, over a time | [`heat_step`], [`HeatFlow`] for many |
//! | the surface, to smaller area | [`mean_curvature_flow`] |
//! | the same without singularities | [`mean_curvature_flow`] with [`FlowKind::Conformalized`] |
//!
//! All steps are implicit, so that no time is too long.

mod heat;
mod mean_curvature;

pub use heat::{HeatFlow, heat_step};
pub use mean_curvature::{FlowKind, FlowOptions, FlowReport, FlowSize, mean_curvature_flow};
