//! A Laplacian for points without faces: local Delaunay triangles, then the tufted cover.
//!
//! Around each point its neighbors are projected to the plane that fits them best, where the Voronoi cell of
//! the point tells its Delaunay neighbors; consecutive ones make triangles with it. Where the points
//! are regular each triangle is found from all three corners, where not, from some: all of them together,
//! each counting a third, are triangles that form no manifold, and have a
//! [tufted Laplacian](super::tufted_laplacian).
//!
//! - Input: points on or near a surface.
//! - Cost: O(n k²) at worst for n points of k neighbors, in parallel; then the flips.
//! - Guarantees: weights not negative but for rounding, L·1 = 0. Masses sum to about the area.
//! - Reference: Sharp and Crane, "A Laplacian for nonmanifold triangle meshes", SGP 2020, section 5.7.
//! - Departs from it: of the copies of a triangle none is glued to another, which would make them
//!   pockets apart from the surface, but to the triangles opposite; the Delaunay neighbors come from clipping a Voronoi cell, which needs no
//!   triangulation of the neighborhood.

use dgp_mesh::{
    DMat3, DVec2, DVec3, Progress, VertexId, VertexMap, linear::symmetric_eigen, parallel,
};

use super::{
    IntrinsicLaplacian, IntrinsicOptions,
    tufted::{Gluing, Soup, of_triangles},
};
use crate::{Error, nearest::Nearest, unit::unit_of};

/// How [`point_cloud_laplacian`] finds triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointCloudOptions {
    /// k, how many of the nearest points to look at; 30 in the paper.
    pub neighbors: usize,
    /// What happens to triangles of little area.
    pub intrinsic: IntrinsicOptions,
}

impl Default for PointCloudOptions {
    fn default() -> Self {
        PointCloudOptions { neighbors: 30, intrinsic: IntrinsicOptions::default() }
    }
}

/// The Laplacian and masses of a surface of which only points are known.
///
/// Points far from all others, or all on a line, are joined to nothing: their rows and masses are 0.
/// Errors: [`Error::NotFinite`], [`Error::InvalidOption`] for fewer than three neighbors,
/// [`Error::Cancelled`].
pub fn point_cloud_laplacian(
    points: &VertexMap<DVec3>,
    options: &PointCloudOptions,
    progress: Progress<'_>,
) -> Result<IntrinsicLaplacian, Error> {
    if options.neighbors < 3 {
        return Err(Error::option("neighbors", options.neighbors as f64, "at least 3"));
    }
    let unit = unit_of(points.values());
    let scaled: Vec<DVec3> = points.values().iter().map(|&p| p * unit).collect();
    let tree = Nearest::new(&scaled).map_err(|_| not_finite(points))?;
    progress.report(0.0)?;
    let stars = parallel::map(points.len(), |v: VertexId| {
        star(&scaled, v.index(), &tree.neighbors(v.index(), options.neighbors))
    });
    progress.report(0.4)?;
    let triangles: Vec<[u32; 3]> = stars.into_values().into_iter().flatten().collect();
    // Each triangle is expected to be found from its three corners.
    let (share, part) = (1.0 / 3.0, progress.part(0.5, 1.0));
    let soup = Soup { positions: points.values(), triangles: &triangles };
    of_triangles(&soup, Gluing::Across, share, options.intrinsic, part)
}

fn not_finite(points: &VertexMap<DVec3>) -> Error {
    let bad = points.iter().find(|(_, p)| !p.is_finite()).map(|(v, _)| v);
    Error::NotFinite { vertex: bad.unwrap_or(VertexId::new(0)) }
}

/// The triangles around point `i` in the plane that fits it and its neighbors best.
fn star(points: &[DVec3], i: usize, neighbors: &[u32]) -> Vec<[u32; 3]> {
    let center = points[i];
    let offset = |j: u32| points[j as usize] - center;
    let count = neighbors.len() as f64 + 1.0;
    let mean = neighbors.iter().map(|&j| offset(j)).sum::<DVec3>() / count;
    let mut covariance = outer(-mean);
    for &j in neighbors {
        covariance += outer(offset(j) - mean);
    }
    let vectors = symmetric_eigen(&covariance).vectors;
    // Across the direction of least extent.
    let (right, up) = (vectors.col(2), vectors.col(1));
    let flat = |j: u32| DVec2::new(offset(j).dot(right), offset(j).dot(up));
    let sites: Vec<DVec2> = neighbors.iter().map(|&j| flat(j)).collect();
    let around = voronoi_neighbors(&sites);
    let mut triangles = Vec::with_capacity(around.len());
    for (k, &first) in around.iter().enumerate() {
        let second = around[(k + 1) % around.len()];
        if let (Some(a), Some(b)) = (first, second)
            && a != b
        {
            triangles.push([i as u32, neighbors[a], neighbors[b]]);
        }
    }
    triangles
}

fn outer(x: DVec3) -> DMat3 {
    DMat3::from_cols(x * x.x, x * x.y, x * x.z)
}

/// The sites whose bisectors bound the Voronoi cell of the origin, counterclockwise; `None` for where it is
/// open.
fn voronoi_neighbors(sites: &[DVec2]) -> Vec<Option<usize>> {
    // Cells that reach farther than this many times the farthest neighbor count as open.
    const OPEN: f64 = 16.0;
    let reach = sites.iter().fold(0.0_f64, |reach, p| reach.max(p.length()));
    if reach == 0.0 {
        return Vec::new();
    }
    // The corners of the cell, each with the site of the side that follows it.
    let far = OPEN * reach;
    let mut cell: Vec<(DVec2, Option<usize>)> =
        [(-far, -far), (far, -far), (far, far), (-far, far)]
            .map(|(x, y)| (DVec2::new(x, y), None))
            .to_vec();
    let mut clipped = Vec::new();
    for (s, &site) in sites.iter().enumerate() {
        if site == DVec2::ZERO {
            continue;
        }
        // Beyond the bisector.
        let height = |p: DVec2| p.dot(site) - 0.5 * site.length_squared();
        clipped.clear();
        for (k, &(p, side)) in cell.iter().enumerate() {
            let (q, _) = cell[(k + 1) % cell.len()];
            let (a, b) = (height(p), height(q));
            let cut = || p + (q - p) * (a / (a - b));
            match (a <= 0.0, b <= 0.0) {
                (true, true) => clipped.push((p, side)),
                (true, false) => clipped.extend([(p, side), (cut(), Some(s))]),
                (false, true) => clipped.push((cut(), side)),
                (false, false) => {}
            }
        }
        std::mem::swap(&mut cell, &mut clipped);
        if cell.is_empty() {
            return Vec::new();
        }
    }
    cell.into_iter().map(|(_, side)| side).collect()
}
