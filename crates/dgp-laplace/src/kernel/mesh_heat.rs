//! The mesh Laplacian of Belkin, Sun and Wang: heat kernels times areas, which converges pointwise.
//!
//! ```text
//! Δ f(i) ≈ 1/(4π h²) Σ A(j) exp(−|x(i) − x(j)|²/4h) (f(j) − f(i))        over all vertices j
//! ```
//!
//! with the vertex areas A. Written as masses and symmetric weights: W(i, j) = A(i) A(j) exp(…)/(4π h²) and
//! M = A, so that −Δ is M⁻¹ L. Unlike the cotangent Laplacian its values converge at each point, not only
//! its solutions, if h falls more slowly than the edges; rims draw values inward.
//!
//! - Input: any mesh; h in units of length².
//! - Cost: O(n m) for m vertices within reach, in parallel.
//! - Guarantees: symmetric, no weight is negative, L·1 = 0.
//! - Reference: Belkin, Sun and Wang, "Discrete Laplace operator on meshed surfaces", SoCG 2008.
//! - Departs from it: vertices whose kernel is below a cutoff are left out.

use dgp_mesh::{Mesh, VertexId, VertexMap, measure::VertexArea, measure::vertex_areas, parallel};
use dgp_sparse::SparseMatrix;

use crate::{Error, nearest::Nearest, unit::unit_of};

/// How far [`mesh_heat_laplacian`] looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatKernel {
    /// The value of exp(−d²/4h) below which a vertex is too far away to count.
    pub cutoff: f64,
}

impl Default for HeatKernel {
    fn default() -> Self {
        HeatKernel { cutoff: 1e-8 }
    }
}

/// The stiffness matrix and the masses of the kernel of time `h` (length²).
///
/// Errors: [`Error::InvalidOption`] unless h is positive and finite and the cutoff between 0 and 1,
/// [`Error::Sparse`] for more entries than a matrix can hold.
pub fn mesh_heat_laplacian(
    mesh: &Mesh,
    h: f64,
    options: &HeatKernel,
) -> Result<(SparseMatrix, VertexMap<f64>), Error> {
    if !(h > 0.0 && h.is_finite()) {
        return Err(Error::option("h", h, "positive and finite"));
    }
    let cutoff = options.cutoff;
    if !(cutoff > 0.0 && cutoff < 1.0) {
        return Err(Error::option("cutoff", cutoff, "between 0 and 1"));
    }
    let unit = unit_of(mesh.positions().values());
    let points: Vec<_> = mesh.positions().values().iter().map(|&p| p * unit).collect();
    let areas = vertex_areas(mesh, VertexArea::Barycentric);
    let scaled: Vec<f64> = areas.values().iter().map(|a| a * unit * unit).collect();
    let h = h * unit * unit;
    let tree = Nearest::new(&points)?;
    let reach = -4.0 * h * cutoff.ln();
    let factor = 1.0 / (4.0 * std::f64::consts::PI * h * h);
    let rows = parallel::map(points.len(), |v: VertexId| {
        let i = v.index();
        let near = tree.within(i, reach).into_iter().filter(|&j| j as usize > i);
        let weight = |j: u32| {
            let square = points[i].distance_squared(points[j as usize]);
            factor * scaled[i] * scaled[j as usize] * (-square / (4.0 * h)).exp()
        };
        near.map(|j| (i as u32, j, weight(j))).collect::<Vec<_>>()
    });
    let edges: Vec<_> = rows.into_values().into_iter().flatten().collect();
    // (length⁴/length⁴): the weights have no unit, as those by cotangents.
    Ok((SparseMatrix::from_edges(points.len(), &edges)?, areas))
}

#[cfg(test)]
mod tests {
    use dgp_mesh::shapes;

    use super::*;
    use crate::laplacian::laplacian_report;

    /// Row 4 of the oracles: where cotangents do not converge pointwise, this does. x² − 1/3 is an eigenfunction of
    /// the unit sphere, and the integral that the sum stands for has the eigenvalue 6 − 12h there, so that the
    /// largest error is 12h · 2/3.
    #[test]
    fn values_converge_at_each_point() {
        let (mut errors, mut quadrature) = (Vec::new(), Vec::new());
        for (level, h) in [(3, 0.04), (4, 0.02), (5, 0.01)] {
            let mesh = shapes::icosphere(level).unwrap();
            let (l, masses) = mesh_heat_laplacian(&mesh, h, &HeatKernel::default()).unwrap();
            let f: Vec<f64> = mesh.positions().values().iter().map(|p| p.x * p.x).collect();
            let found = l.product(&f);
            let off = |eigenvalue: f64| {
                let error = |v: VertexId| {
                    found[v.index()] / masses[v] - eigenvalue * (f[v.index()] - 1.0 / 3.0)
                };
                mesh.vertices().map(|v| error(v).abs()).fold(0.0, f64::max)
            };
            errors.push(off(6.0));
            quadrature.push(off(6.0 - 12.0 * h));
            assert!(errors[errors.len() - 1] < 1.1 * 8.0 * h, "{h}: {errors:?}");
        }
        let order = (errors[0] / errors[2]).log2() / 2.0;
        assert!((order - 1.0).abs() < 0.1, "{errors:?}");
        // The sum comes nearer to the integral as kernels get wider than edges; no rate is known.
        assert!(quadrature.windows(2).all(|pair| pair[1] < pair[0]), "{quadrature:?}");
    }

    #[test]
    fn it_is_a_laplacian_without_unit() {
        let mesh = shapes::blob(3).unwrap();
        let (l, masses) = mesh_heat_laplacian(&mesh, 0.01, &HeatKernel::default()).unwrap();
        let report = laplacian_report(&l);
        assert_eq!((report.negative_weights, report.asymmetry), (0, 0.0));
        assert!(report.row_sum_error < 1e-13);
        for k in [-200, 3] {
            let s = 2_f64.powi(k);
            let mut scaled = mesh.clone();
            scaled.set_positions(mesh.positions().map(|&p| s * p));
            let (other, heavy) =
                mesh_heat_laplacian(&scaled, 0.01 * s * s, &HeatKernel::default()).unwrap();
            assert!(other == l && heavy == masses.map(|m| m * s * s), "2^{k}");
        }
        for (h, cutoff) in [(0.0, 0.1), (f64::NAN, 0.1), (1.0, 0.0), (1.0, 1.0)] {
            assert!(mesh_heat_laplacian(&mesh, h, &HeatKernel { cutoff }).is_err());
        }
    }
}
