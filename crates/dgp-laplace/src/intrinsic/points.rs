//! A Laplacian for points without faces: local Delaunay triangles, then the tufted cover.
//!
//! Around each point its neighbors are projected to the plane that fits them best, where the Voronoi cell of
//! the point tells its Delaunay neighbors; consecutive ones make triangles with it, its star. All of them together
//! are triangles that form no manifold, and have a [tufted Laplacian](super::tufted_laplacian). It is divided by how
//! often they cover the surface: three times where each triangle is found from all its corners, twice on a square
//! lattice, where each corner of a square finds another triangle.
//!
//! ```text
//! m(i) = Σ angles at i of all triangles / Σ angles at i of the star of i
//! M(i) ← M(i)/m(i)      W(i, j) ← W(i, j) (1/m(i) + 1/m(j))/2
//! ```
//!
//! - Input: points on or near a surface.
//! - Cost: O(n k²) at worst for n points of k neighbors, in parallel; then the flips.
//! - Guarantees: weights not negative but for rounding, L·1 = 0. Masses sum to about the area.
//! - Reference: Sharp and Crane, "A Laplacian for nonmanifold triangle meshes", SGP 2020, section 5.7.
//! - Departs from it: there each triangle counts a third, which is too little where corners disagree (on a square
//!   lattice by a third). Of the copies of a triangle none is glued to another, which would make them pockets apart
//!   from the surface, but to the triangles opposite. The Delaunay neighbors come from clipping a Voronoi cell, which
//!   needs no triangulation of the neighborhood.

use dgp_mesh::{
    DMat3, DVec2, DVec3, Progress, VertexId, VertexMap, linear::symmetric_eigen, parallel,
};

use super::{
    IntrinsicLaplacian, IntrinsicOptions,
    tufted::{Gluing, Soup, of_triangles},
};
use dgp_sparse::SparseMatrix;

use crate::{Error, laplacian::laplacian_report, nearest::Nearest, unit::unit_of};

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
    let shares: Vec<f64> = layers(&scaled, stars.values()).iter().map(|m| 1.0 / m).collect();
    let triangles: Vec<[u32; 3]> = stars.into_values().into_iter().flatten().collect();
    let soup = Soup { positions: points.values(), triangles: &triangles };
    let part = progress.part(0.5, 1.0);
    let mut found = of_triangles(&soup, Gluing::Across, 1.0, options.intrinsic, part)?;
    share(&mut found.laplacian, &shares);
    found.masses.iter_mut().for_each(|(v, mass)| *mass *= shares[v.index()]);
    found.report.least_weight = laplacian_report(&found.laplacian).least_weight;
    Ok(found)
}

/// How often the triangles of all stars cover the angle around each point that its own star covers once.
fn layers(points: &[DVec3], stars: &[Vec<[u32; 3]>]) -> Vec<f64> {
    let (mut own, mut all) = (vec![0.0; points.len()], vec![0.0; points.len()]);
    for (center, star) in stars.iter().enumerate() {
        for triangle in star {
            for k in 0..3 {
                let [p, q, r] = [k, k + 1, k + 2].map(|i| points[triangle[i % 3] as usize]);
                let (u, v) = (q - p, r - p);
                let angle = u.cross(v).length().atan2(u.dot(v));
                let corner = triangle[k] as usize;
                all[corner] += angle;
                if corner == center {
                    own[corner] += angle;
                }
            }
        }
    }
    // A point without a star has but the triangles of others, found by some of their corners.
    let ratio = |(all, own): (f64, f64)| if own > 0.0 { all / own } else { 2.0 };
    all.into_iter().zip(own).map(ratio).collect()
}

/// Multiplies weights by the mean of the factors of their ends.
fn share(laplacian: &mut SparseMatrix, factors: &[f64]) {
    for j in 0..laplacian.columns() {
        let start = laplacian.starts()[j] as usize;
        let rows = laplacian.column(j).0.to_vec();
        let values = &mut laplacian.values_mut()[start..start + rows.len()];
        let (mut diagonal, mut sum) = (None, 0.0);
        for (k, &i) in rows.iter().enumerate() {
            if i as usize == j {
                diagonal = Some(k);
            } else {
                values[k] *= 0.5 * (factors[i as usize] + factors[j]);
                sum -= values[k];
            }
        }
        if let Some(k) = diagonal {
            values[k] = sum;
        }
    }
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
    // A bisector that does but touch the cell, as those of the diagonals of a square lattice, is no side of it.
    const TOUCH: f64 = 1e-9;
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
        let square = site.length_squared();
        let height = |p: DVec2| p.dot(site) - 0.5 * square;
        if cell.iter().all(|&(p, _)| height(p) <= TOUCH * square) {
            continue;
        }
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
