//! Smoothing: moves vertices toward the means of their neighbors.
//!
//! | function | removes | keeps |
//! |---|---|---|
//! | [`uniform`] | noise, and shape little by little | topology; the volume on request |
//! | [`taubin`] | noise | shape: waves longer than the pass band |
//! | [`cotangent`] | the same, by curvature | the spacing of vertices |
//! | [`implicit`] | the same, in one large stable step | the spacing, with cotangent weights |
//! | [`bilateral`] | noise | sharp edges |
//! | [`tangential`] | uneven spacing | the surface: vertices slide in their tangent planes |
//!
//! All take any mesh, but for those with cotangents, which take triangles. They keep its connectivity and
//! attributes, and leave vertices of no face and those in the given set where they are. Stored normals are data like others: they stay as they are.

mod bilateral;
mod cotangent;
mod implicit;
mod rings;
mod run;
mod tangential;
mod taubin;
mod uniform;

pub use bilateral::{BilateralOptions, BilateralScheme, FaceNeighborhood, bilateral};
pub use cotangent::{CotangentOptions, cotangent};
pub use implicit::{ImplicitOptions, ImplicitWeight, implicit};
pub use tangential::{NeighborWeight, TangentialOptions, tangential};
pub use taubin::{TaubinOptions, taubin};
pub use uniform::{UniformOptions, uniform};

/// What vertices at the rim of a hole do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Boundary {
    /// They stay.
    #[default]
    Fixed,
    /// Their neighbors are the two along the rim: it is smoothed as a curve.
    Curve,
    /// Their neighbors are all, as for other vertices: the rim is drawn inward.
    Free,
}

/// What becomes of the enclosed volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Volume {
    /// What smoothing makes of it.
    #[default]
    MayChange,
    /// In the end the mesh, which must be closed and without fixed vertices, is scaled about the mean
    /// of its vertices to the volume it had.
    Keep,
}

/// What smoothing did.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct SmoothReport {
    /// How many iterations were done.
    pub iterations: usize,
    /// How many vertices could move.
    pub free_vertices: usize,
    /// The volume enclosed at the start, if the mesh is closed.
    pub volume_before: Option<f64>,
    /// The volume enclosed in the end, if the mesh is closed.
    pub volume_after: Option<f64>,
    /// How far vertices moved, on average over all.
    pub mean_displacement: f64,
    /// How far the vertex moved that moved furthest.
    pub max_displacement: f64,
}

#[cfg(test)]
mod curvature_tests;
#[cfg(test)]
mod tests;
