//! The Gaussian graph Laplacian of points.
//!
//! ```text
//! W(i, j) = exp(−t |x(i) − x(j)|²)        L = D − W
//! ```
//!
//! For points spread evenly over a surface of area A, (4 t²/π) (A/n) L tends to −Δ when n grows and t grows more
//! slowly.
//!
//! - Input: points in space.
//! - Cost: O(n²) for all pairs, O(n k log n) for nearest neighbors.
//! - Guarantees: symmetric, weights from 0 to 1, positive semidefinite, L·1 = 0.
//! - Reference: Belkin and Niyogi, "Laplacian eigenmaps for dimensionality reduction and data representation",
//!   Neural Computation 15(6), 2003.

use dgp_mesh::{DVec3, VertexId, VertexMap, parallel};
use dgp_sparse::SparseMatrix;

use crate::{Error, nearest::Nearest};

/// Which points are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Neighbors {
    /// Each to each.
    All,
    /// Each to that many of the nearest, and those to it.
    Nearest(usize),
}

/// The graph Laplacian of `points` with Gaussian weights; `t`, per length², tells how fast they fall.
///
/// Errors: [`Error::NotFinite`] names a point, [`Error::InvalidOption`] unless t is positive and finite,
/// [`Error::Sparse`] for more entries than a matrix can hold: 46 thousand points for all pairs.
pub fn gaussian_laplacian(
    points: &VertexMap<DVec3>,
    t: f64,
    neighbors: Neighbors,
) -> Result<SparseMatrix, Error> {
    if !(t > 0.0 && t.is_finite()) {
        return Err(Error::option("t", t, "positive and finite"));
    }
    let n = points.len();
    let tree = Nearest::new(points.values())?;
    let pairs: Vec<Vec<u32>> = match neighbors {
        Neighbors::All => {
            // What no matrix can hold must not be listed first.
            let entries = n.saturating_mul(n);
            if entries > dgp_sparse::MAX_ENTRIES {
                let (kind, limit) = ("entries", dgp_sparse::MAX_ENTRIES);
                return Err(Error::Sparse(dgp_sparse::Error::TooLarge {
                    kind,
                    count: entries,
                    limit,
                }));
            }
            (0..n as u32).map(|i| (i + 1..n as u32).collect()).collect()
        }
        Neighbors::Nearest(count) => {
            let near = parallel::map(n, |v: VertexId| tree.neighbors(v.index(), count));
            symmetric_pairs(near.values())
        }
    };
    let weight = |i: usize, j: u32| {
        let distance = points.values()[i].distance(points.values()[j as usize]);
        (-t * distance * distance).exp()
    };
    let edges: Vec<(u32, u32, f64)> = pairs
        .iter()
        .enumerate()
        .flat_map(|(i, others)| others.iter().map(move |&j| (i as u32, j, weight(i, j))))
        .collect();
    Ok(SparseMatrix::from_edges(n, &edges)?)
}

/// For each point the larger numbers of those that it names or that name it, in order.
fn symmetric_pairs(near: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut pairs: Vec<Vec<u32>> = vec![Vec::new(); near.len()];
    for (i, others) in near.iter().enumerate() {
        for &j in others {
            let i = i as u32;
            pairs[i.min(j) as usize].push(i.max(j));
        }
    }
    for others in &mut pairs {
        others.sort_unstable();
        others.dedup();
    }
    pairs
}

#[cfg(test)]
mod tests {
    use dgp_mesh::shapes;

    use super::*;
    use crate::laplacian::laplacian_report;

    #[test]
    fn weights_are_gaussians_of_the_distance() {
        let points: VertexMap<DVec3> = vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::Y].into();
        let l = gaussian_laplacian(&points, 0.5, Neighbors::All).unwrap();
        let w = |square: f64| (-0.5 * square).exp();
        assert!((l.get(0, 1) + w(1.0)).abs() < 1e-16 && (l.get(1, 2) + w(5.0)).abs() < 1e-16);
        assert!((l.get(0, 0) - w(1.0) - w(4.0)).abs() < 1e-16);
        // Each has one nearest point: 1 and 2 name 0, 0 names 1.
        let l = gaussian_laplacian(&points, 0.5, Neighbors::Nearest(1)).unwrap();
        assert_eq!((l.entries(), l.get(1, 2)), (7, 0.0));
    }

    #[test]
    fn all_neighbors_and_as_many_nearest_agree() {
        let points = shapes::icosphere(2).unwrap().positions().clone();
        let all = gaussian_laplacian(&points, 3.0, Neighbors::All).unwrap();
        let near = gaussian_laplacian(&points, 3.0, Neighbors::Nearest(points.len())).unwrap();
        assert_eq!(all, near);
        let report = laplacian_report(&all);
        assert!(
            report.negative_weights == 0 && report.row_sum_error < 1e-14 && report.asymmetry == 0.0
        );
    }

    /// x² + … on a sphere: the coordinates are eigenfunctions with λ = 2.
    #[test]
    fn on_a_sphere_it_tends_to_the_operator() {
        let errors: Vec<f64> = [3, 4]
            .iter()
            .map(|&level| {
                let mesh = shapes::icosphere(level).unwrap();
                let n = mesh.vertex_count() as f64;
                let t = 0.15 * n.sqrt();
                let l = gaussian_laplacian(mesh.positions(), t, Neighbors::All).unwrap();
                let factor = 4.0 * t * t / std::f64::consts::PI * (4.0 * std::f64::consts::PI / n);
                let z: Vec<f64> = mesh.positions().values().iter().map(|p| p.z).collect();
                let lz = l.product(&z);
                // Rayleigh's quotient.
                let quotient = factor * z.iter().zip(&lz).map(|(a, b)| a * b).sum::<f64>()
                    / z.iter().map(|a| a * a).sum::<f64>();
                (quotient - 2.0).abs()
            })
            .collect();
        assert!(errors.iter().all(|error| *error < 2e-3), "of 2: {errors:?}");
    }

    #[test]
    fn bad_points_and_times_are_refused() {
        let points: VertexMap<DVec3> = vec![DVec3::ZERO, DVec3::splat(f64::NAN)].into();
        assert!(matches!(
            gaussian_laplacian(&points, 1.0, Neighbors::All),
            Err(Error::NotFinite { .. })
        ));
        let points: VertexMap<DVec3> = vec![DVec3::ZERO; 50_000].into();
        for t in [0.0, f64::NAN] {
            assert!(gaussian_laplacian(&points, t, Neighbors::All).is_err());
        }
        assert!(matches!(gaussian_laplacian(&points, 1.0, Neighbors::All), Err(Error::Sparse(_))));
        let empty = VertexMap::new();
        assert_eq!(gaussian_laplacian(&empty, 1.0, Neighbors::All).unwrap().rows(), 0);
    }
}
