//! Points on surfaces: independent, one in each part of equal area, or all at a distance from each other.
//!
//! | points | function | file |
//! |---|---|---|
//! | each anywhere, independent of the others | [`sample_uniform`] | `uniform.rs` |
//! | one in each of so many parts of equal area | [`sample_stratified`] | `stratified.rs` |
//! | at least a radius apart, with no room for another | [`sample_poisson_disk`] | `darts.rs` |
//! | so many, as far apart as can be | [`sample_blue_noise`] | `elimination.rs` |
//!
//! Any [`Surface`] of triangles will do, a manifold or not. Each point knows its face and where it lies there;
//! [`sample_attributes`] and [`sample_normals`] give it the data of the surface.

mod carry;
mod darts;
mod elimination;
mod grid;
mod stratified;
mod triangles;
mod uniform;

use dgp_mesh::{DVec3, FaceId, parallel, spatial::PointTree};

pub(crate) use carry::mixed;
pub use carry::{SampleNormal, sample_attributes, sample_normals};
pub use darts::{PoissonOptions, PoissonReport, sample_poisson_disk};
pub(crate) use elimination::eliminate;
pub use elimination::{BlueNoiseOptions, BlueNoiseReport, sample_blue_noise};
pub(crate) use stratified::curve_order;
pub use stratified::sample_stratified;
pub(crate) use triangles::{locate, power_of_two};
pub use uniform::sample_uniform;

use crate::Error;

/// The most points that are made: what asks for more is thought to be a mistake of units.
pub const MAX_SAMPLES: usize = 1 << 26;

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// The face it lies on.
    pub face: FaceId,
    /// The weights of the corners of the face, in their order there: not negative, of sum 1 but for rounding.
    pub barycentric: [f64; 3],
    /// Where it is.
    pub position: DVec3,
}

/// The smallest distance between two points; infinite if there are fewer than two.
fn least_distance(points: &[DVec3]) -> Result<f64, Error> {
    let tree = PointTree::new(points, dgp_mesh::Progress::NONE)?;
    let nearest = |range: std::ops::Range<usize>| {
        let other = |i: usize| {
            let found = tree.nearest_points(points[i], 2);
            found.get(1).map_or(f64::INFINITY, |other| points[i].distance(points[other.index]))
        };
        range.map(other).fold(f64::INFINITY, f64::min)
    };
    let blocks = parallel::map_blocks(points.len(), 1024, nearest);
    Ok(blocks.into_iter().fold(f64::INFINITY, f64::min))
}

/// An error if there cannot be so many points.
fn check_count(name: &'static str, count: usize) -> Result<(), Error> {
    if count > MAX_SAMPLES {
        let value = count as f64;
        return Err(Error::InvalidOption { name, value, expected: "at most 2²⁶ points" });
    }
    Ok(())
}
