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

use crate::{Error, nearest::Nearest, unit::unit_of};

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

/// How far each point is from the nearest of the others: what to choose t by. Infinite where there is no other.
///
/// Errors: [`Error::NotFinite`] names a point.
pub fn nearest_distances(points: &VertexMap<DVec3>) -> Result<VertexMap<f64>, Error> {
    let unit = unit_of(points.values());
    let scaled: Vec<DVec3> = points.values().iter().map(|&p| p * unit).collect();
    let tree = Nearest::new(&scaled)?;
    Ok(parallel::map(points.len(), |v: VertexId| {
        let nearest = tree.neighbors(v.index(), 1);
        nearest
            .first()
            .map_or(f64::INFINITY, |&j| scaled[v.index()].distance(scaled[j as usize]) / unit)
    }))
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
    use std::f64::consts::{PI, TAU};

    use dgp_mesh::{Progress, shapes};
    use dgp_sparse::EigenOptions;

    use super::*;
    use crate::{laplacian::laplacian_report, spectral::Eigenbasis};

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

    /// Points of equal areas on the unit sphere: a spiral by the golden section.
    fn spiral(n: usize) -> VertexMap<DVec3> {
        let turn = TAU * 2.0 / (1.0 + 5.0_f64.sqrt());
        let point = |i: usize| {
            let z = 1.0 - (2 * i + 1) as f64 / n as f64;
            let (sin, cos) = (turn * i as f64).sin_cos();
            DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
        };
        (0..n).map(point).collect::<Vec<_>>().into()
    }

    /// On the unit sphere the integral that the sum stands for has the eigenvalues 8t² ∫ (1 − Pₗ(1 − s)) e^(−2ts) ds
    /// over 0 < s < 2, with Legendre's polynomials: 2 and 6 − 3/t for l = 1 and 2, but for e^(−4t).
    #[test]
    fn the_spectrum_of_a_sphere_is_that_of_the_kernel_and_tends_to_that_of_the_operator() {
        let spectrum = |n: usize, t: f64| -> Vec<f64> {
            let l = gaussian_laplacian(&spiral(n), t, Neighbors::All).unwrap();
            let ones = VertexMap::filled(n, 1.0);
            let options = EigenOptions::default();
            let basis = Eigenbasis::new(&l, &ones, 9, &options, Progress::NONE).unwrap();
            let factor = 4.0 * t * t / PI * (4.0 * PI / n as f64);
            basis.values().iter().map(|value| factor * value).collect()
        };
        let mut bias = Vec::new();
        for t in [4.0, 8.0, 16.0] {
            // e^(−4t) (1 + 4t) is below 2e-6.
            let exact = |i: usize| if i < 4 { 2.0 } else { 6.0 - 3.0 / t };
            let off = |values: &[f64]| {
                let errors = values.iter().enumerate().skip(1);
                errors.map(|(i, value)| (value / exact(i) - 1.0).abs()).fold(0.0, f64::max)
            };
            let (few, many) = (spectrum(400, t), spectrum(1600, t));
            // The sum tends to the integral, with order 1 in the number of points or better.
            let errors = [off(&few), off(&many)];
            assert!(errors[1] < errors[0] / 4.0, "{t}: {errors:?}");
            bias.push(6.0 - many[4..].iter().sum::<f64>() / 5.0);
        }
        // The integral tends to the operator with order 1 in 1/t.
        let orders = [bias[0] / bias[1], bias[1] / bias[2]].map(f64::log2);
        assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.05), "{orders:?} {bias:?}");
    }

    #[test]
    fn distances_to_the_nearest_are_those_of_all_pairs() {
        let points = spiral(60);
        let found = nearest_distances(&points).unwrap();
        for (v, p) in points.iter() {
            let others = points.iter().filter(|(w, _)| *w != v);
            let least = others.map(|(_, q)| q.distance(*p)).fold(f64::INFINITY, f64::min);
            assert!((found[v] - least).abs() < 1e-15, "{v}");
        }
        let alone: VertexMap<DVec3> = vec![DVec3::ONE].into();
        assert_eq!(nearest_distances(&alone).unwrap().values(), [f64::INFINITY]);
        let huge: VertexMap<DVec3> = vec![DVec3::ZERO, f64::MAX * DVec3::X].into();
        assert_eq!(nearest_distances(&huge).unwrap().values(), [f64::MAX; 2]);
        let bad: VertexMap<DVec3> = vec![DVec3::ZERO, DVec3::NAN].into();
        assert!(matches!(nearest_distances(&bad), Err(Error::NotFinite { .. })));
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
