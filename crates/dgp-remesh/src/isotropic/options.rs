//! How to remesh, and what was done.

use std::f64::consts::FRAC_PI_4;

use dgp_mesh::{FaceId, VertexId, VertexMap};

use super::quality::TriangleQuality;
use crate::Error;

/// How [`remesh_isotropic`](crate::remesh_isotropic) works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemeshOptions {
    /// How often to split, collapse, flip and relax; 5 to 10 in the paper.
    pub iterations: usize,
    /// What happens to rims of holes.
    pub rims: Rims,
    /// Where a line of features or a rim turns by a larger angle, in radians, over a distance of two edges, is a
    /// corner, and stays.
    pub corner_angle: f64,
}

impl Default for RemeshOptions {
    fn default() -> Self {
        RemeshOptions { iterations: 10, rims: Rims::Resampled, corner_angle: FRAC_PI_4 }
    }
}

impl RemeshOptions {
    pub(super) fn check(&self) -> Result<(), Error> {
        in_range("corner_angle", self.corner_angle, self.corner_angle >= 0.0, "not negative")
    }
}

/// What happens to rims of holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rims {
    /// They keep their shape and get edges of the length wanted.
    Resampled,
    /// Their vertices and edges stay.
    Kept,
}

/// How [`remesh_adaptive`](crate::remesh_adaptive) works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveOptions {
    /// As for meshes of one length.
    pub remesh: RemeshOptions,
    /// The least length wanted anywhere, in units of the tolerance.
    pub shortest: f64,
    /// The largest length wanted anywhere, as a part of the diagonal of the mesh.
    pub longest: f64,
    /// By how much the length wanted may grow over a distance of one.
    pub gradation: f64,
    /// How often to measure the distance to the input, and to shorten edges where it is larger than it may be.
    pub corrections: usize,
}

impl Default for AdaptiveOptions {
    fn default() -> Self {
        AdaptiveOptions {
            remesh: RemeshOptions::default(),
            shortest: 1.0,
            longest: 0.1,
            gradation: 0.3,
            corrections: 8,
        }
    }
}

impl AdaptiveOptions {
    pub(super) fn check(&self) -> Result<(), Error> {
        self.remesh.check()?;
        let positive = |x: f64| x > 0.0 && x.is_finite();
        in_range("shortest", self.shortest, positive(self.shortest), "positive")?;
        in_range("longest", self.longest, positive(self.longest), "positive")?;
        in_range("gradation", self.gradation, positive(self.gradation), "positive")
    }
}

/// The error for an option that is not in its range.
pub(super) fn in_range(
    name: &'static str,
    value: f64,
    is_in: bool,
    expected: &'static str,
) -> Result<(), Error> {
    if is_in { Ok(()) } else { Err(Error::InvalidOption { name, value, expected }) }
}

/// Where on the input a vertex is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// The face it lies on.
    pub face: FaceId,
    /// The corners of that face.
    pub vertices: [VertexId; 3],
    /// Their weights: not negative, of sum 1.
    pub barycentric: [f64; 3],
}

/// What remeshing did.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct RemeshReport {
    /// Vertices before and after.
    pub vertices: [usize; 2],
    /// Faces before and after.
    pub faces: [usize; 2],
    /// How many edges were split.
    pub splits: usize,
    /// How many were collapsed.
    pub collapses: usize,
    /// How many were flipped.
    pub flips: usize,
    /// Chains of sharp edges and of rims between corners, and loops of them.
    pub lines: usize,
    /// Vertices that stayed: corners of lines, and those that were fixed.
    pub corners: usize,
    /// Edges that are still shorter than 4/5 of the length wanted: what is fixed, sharp or closed has no fewer.
    pub short_edges: usize,
    /// Edges that are still longer than 4/3 of the length wanted.
    pub long_edges: usize,
    /// Angles, valences and lengths before and after.
    pub quality: [TriangleQuality; 2],
    /// Where each vertex lies on the input; `None` for those of no face.
    pub origins: VertexMap<Option<Origin>>,
    /// What is known of the distance to the input, if it had to be kept.
    pub distance: Option<Distance>,
}

/// How far the result is from the input, both ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// The Hausdorff distance is not less than this.
    pub lower: f64,
    /// It is not more than this.
    pub upper: f64,
    /// Whether it is surely not more than was allowed.
    pub is_within_tolerance: bool,
    /// How often edges were shortened where it was.
    pub corrections: usize,
}
