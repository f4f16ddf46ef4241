//! How often oriented points wind around a place: near 1 inside of what they were taken from, near 0
//! outside.
//!
//! ```text
//! w(q) = Σ aᵢ nᵢ · (pᵢ − q) / 4π |pᵢ − q|³        aᵢ the area that point i stands for
//! ```
//!
//! Between points that are a distance h apart the sum is right to some percent further than h from the
//! surface; nearer than that it says which side a place is on, and at the points themselves it is noise.
//!
//! - Input: any points with normals; areas from [`cloud_areas`] where none are known.
//! - Cost: O(n log n) to build, some log n a place; 208 bytes a node.
//! - Guarantees: the same bits for any number of threads and at any scale of a power of two.
//! - Reference: Barill, Dickson, Schmidt, Levin and Jacobson, "Fast winding numbers for soups and
//!   clouds", ACM Transactions on Graphics 37(4), 2018.
//! - Departs from it: areas are those of the disk that reaches to the k-th neighbor, over k, instead of
//!   those of Voronoi cells.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    PointTree, WindingOptions, batch,
    winding_number::{Moments, Sums, gathered, walk},
};
use crate::{Error, Progress, parallel};

/// Neighbors of [`cloud_areas`] unless told: enough to even out random spacing.
pub const AREA_NEIGHBORS: usize = 12;

/// Winding numbers of oriented points at many places.
///
/// ```
/// use dgp_mesh::{DVec3, Progress, shapes::icosphere};
/// use dgp_mesh::spatial::{AREA_NEIGHBORS, CloudWinding, WindingOptions, cloud_areas};
///
/// let sphere = icosphere(4)?;
/// let points = sphere.positions().values();
/// let areas = cloud_areas(points, AREA_NEIGHBORS, Progress::NONE)?;
/// // On a sphere around the origin the normals are the points.
/// let areas: Vec<DVec3> = points.iter().zip(areas).map(|(&p, a)| a * p).collect();
/// let winding = CloudWinding::new(points, &areas, WindingOptions::default(), Progress::NONE)?;
/// assert!((winding.at(DVec3::ZERO) - 1.0).abs() < 0.1 && winding.at(3.0 * DVec3::X).abs() < 0.01);
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct CloudWinding {
    tree: PointTree,
    /// In order of the leaves, in the units of the frame.
    areas: Vec<DVec3>,
    moments: Vec<Moments>,
}

impl CloudWinding {
    /// Prepares winding numbers of `points`, each with the area that it stands for along its outward
    /// normal, in the square of the unit of the coordinates.
    ///
    /// Errors: [`Error::InvalidOption`] if there is another number of areas, or the accuracy is below 1;
    /// [`Error::NonFinitePoint`] for a point or an area; those of [`PointTree::new`].
    pub fn new(
        points: &[DVec3],
        areas: &[DVec3],
        options: WindingOptions,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        if !(options.accuracy >= 1.0) {
            return Err(Error::option("accuracy", options.accuracy, "at least 1"));
        }
        if areas.len() != points.len() {
            return Err(Error::option("areas", areas.len() as f64, "as many as there are points"));
        }
        if let Some(index) = areas.iter().position(|a| !a.is_finite()) {
            return Err(Error::NonFinitePoint { index });
        }
        let tree = PointTree::new(points, progress.part(0.0, 0.7))?;
        let down = tree.nodes.frame.scale.down;
        let areas: Vec<DVec3> =
            tree.numbers.iter().map(|&i| areas[i as usize] * down * down).collect();
        let sums = gathered(&tree.nodes.nodes, |i| Sums::of_point(tree.points[i], areas[i]));
        let moments = sums.iter().map(|sum| sum.moments(options.accuracy)).collect();
        progress.report(1.0)?;
        Ok(CloudWinding { tree, areas, moments })
    }

    /// How often the points wind around `p`; 0 for a place that is not finite. A point at `p` itself
    /// counts nothing.
    pub fn at(&self, p: DVec3) -> f64 {
        let q = self.tree.nodes.frame.scaled(p);
        if self.moments.is_empty() || !q.is_finite() {
            return 0.0;
        }
        let of_leaf = |items: std::ops::Range<usize>| {
            let of_point = |i: usize| {
                let r = self.tree.points[i] - q;
                let square = r.length_squared();
                if square > 0.0 { self.areas[i].dot(r) / (square * square.sqrt()) } else { 0.0 }
            };
            items.map(of_point).sum::<f64>()
        };
        walk(&self.tree.nodes.nodes, &self.moments, q, of_leaf) / (4.0 * PI)
    }

    /// The winding number at each of `places`.
    ///
    /// Errors: [`Error::NonFinitePoint`].
    pub fn at_points(&self, places: &[DVec3], progress: Progress<'_>) -> Result<Vec<f64>, Error> {
        if let Some(index) = places.iter().position(|p| !p.is_finite()) {
            return Err(Error::NonFinitePoint { index });
        }
        batch::ordered(&self.tree.nodes.frame, places, progress, |i, (): &mut ()| {
            self.at(places[i])
        })
    }
}

/// The area that each of some points of a surface stands for: that of the disk that reaches to its k-th
/// neighbor, over k; 0 where there is none.
///
/// Errors: [`Error::InvalidOption`] for k = 0; those of [`PointTree::new`].
pub fn cloud_areas(
    points: &[DVec3],
    neighbors: usize,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Error> {
    if neighbors == 0 {
        return Err(Error::option("neighbors", 0.0, "at least 1"));
    }
    let tree = PointTree::new(points, progress.part(0.0, 0.3))?;
    progress.report(0.3)?;
    let blocks = parallel::map_blocks(points.len(), parallel::BLOCK, |range| {
        let area = |i: usize| {
            // The point itself is the nearest.
            let near = tree.nearest_points(points[i], neighbors + 1);
            let count = near.len().saturating_sub(1);
            near.last()
                .filter(|_| count > 0)
                .map_or(0.0, |last| PI * last.distance * last.distance / count as f64)
        };
        range.map(area).collect::<Vec<f64>>()
    });
    progress.report(1.0)?;
    Ok(blocks.into_iter().flatten().collect())
}
