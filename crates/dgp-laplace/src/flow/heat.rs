//! The implicit heat step: spreads values over a surface for a time.
//!
//! ```text
//! (M + t L) u = M u₀
//! ```
//!
//! One step of the backward Euler method for ∂u/∂t = Δu. An eigenfunction with L φ = λ M φ is divided by
//! 1 + t λ.
//!
//! - Input: a Laplacian with its masses, a time, values.
//! - Cost: a factorization for each time, then a solve for each set of values.
//! - Guarantees: Σ M u stays. Where weights are not negative values stay between the least and the largest.
//!   Rows without mass and weights keep their values.
//! - Reference: Desbrun, Meyer, Schröder and Barr, "Implicit fairing of irregular meshes using diffusion and
//!   curvature flow", SIGGRAPH 1999; Crane, Weischedel and Wardetzky, "Geodesics in heat", 2013.

use dgp_mesh::{Mesh, Progress, VertexMap, measure::VertexArea, measure::vertex_areas};
use dgp_sparse::SparseMatrix;

use crate::{Error, laplacian::cotangent_laplacian, solve::FreeSystem};

/// A factored heat step, for many sets of values.
pub struct HeatFlow {
    masses: Vec<f64>,
    system: FreeSystem,
}

impl HeatFlow {
    /// Prepares for steps of `time`, in units of mass over weight: length² on a surface.
    ///
    /// Errors: [`Error::InvalidOption`] unless the time is positive and finite, [`Error::NoMass`] for masses
    /// that are negative or not finite, [`Error::Sparse`] if there is not one per row or the system is not
    /// positive definite, [`Error::Cancelled`].
    pub fn new(
        laplacian: &SparseMatrix,
        masses: &[f64],
        time: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        if !(time > 0.0 && time.is_finite()) {
            return Err(Error::option("time", time, "positive and finite"));
        }
        if let Some(row) = masses.iter().position(|m| !(*m >= 0.0 && m.is_finite())) {
            return Err(Error::NoMass { row, mass: masses[row] });
        }
        let matrix = laplacian.clone().scaled(time).plus_diagonal(masses)?;
        let diagonal = matrix.diagonal();
        let mut system = FreeSystem::new(masses.len(), |i| diagonal[i] == 0.0);
        system.factor(&matrix, progress)?;
        Ok(HeatFlow { masses: masses.to_vec(), system })
    }

    /// The values a step later; several sets stand one after the other.
    ///
    /// # Panics
    /// If there is not a value per row in each set.
    pub fn step(&self, values: &[f64]) -> Result<Vec<f64>, Error> {
        let n = self.masses.len();
        assert!(n > 0 && values.len().is_multiple_of(n) || values.is_empty(), "a value per row");
        let rhs: Vec<f64> =
            values.iter().zip(self.masses.iter().cycle()).map(|(u, m)| u * m).collect();
        let mut result = values.to_vec();
        self.system.solve(&rhs, &mut result)?;
        Ok(result)
    }
}

/// What `values` at the vertices of a triangle mesh become in a step of `time` (length²), with cotangent
/// weights and barycentric masses.
///
/// Errors: those of [`HeatFlow::new`], [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`].
pub fn heat_step(
    mesh: &Mesh,
    values: &VertexMap<f64>,
    time: f64,
    progress: Progress<'_>,
) -> Result<VertexMap<f64>, Error> {
    let masses = vertex_areas(mesh, VertexArea::Barycentric);
    let flow = HeatFlow::new(&cotangent_laplacian(mesh)?, masses.values(), time, progress)?;
    Ok(flow.step(values.values())?.into())
}

#[cfg(test)]
mod tests {
    use dgp_mesh::{VertexId, shapes};

    use super::*;

    /// x² − 1/3 is an eigenfunction of the sphere with λ = 6.
    #[test]
    fn on_a_sphere_waves_are_divided_by_one_plus_lambda_t() {
        for time in [1e-3, 0.1, 10.0] {
            let mut errors = Vec::new();
            for level in 3..=5 {
                let mesh = shapes::icosphere(level).unwrap();
                let wave = mesh.positions().map(|p| p.x * p.x - 1.0 / 3.0);
                let after = heat_step(&mesh, &wave, time, Progress::NONE).unwrap();
                let exact = wave.map(|u| u / (1.0 + 6.0 * time));
                let masses = vertex_areas(&mesh, VertexArea::Barycentric);
                let square = |v| masses[v] * f64::powi(after[v] - exact[v], 2);
                errors.push(mesh.vertices().map(square).sum::<f64>().sqrt());

                // (M + t L)⁻¹ M makes no value larger where no weight is negative, so that at each vertex the error
                // is at most t times what the operator is off by there, which does not converge.
                let l = cotangent_laplacian(&mesh).unwrap().product(exact.values());
                let off = |v: VertexId| (l[v.index()] / masses[v] - 6.0 * exact[v]).abs();
                let bound = time * mesh.vertices().map(off).fold(0.0, f64::max);
                let error = |v| f64::abs(after[v] - exact[v]);
                assert!(mesh.vertices().map(error).fold(0.0, f64::max) <= bound * (1.0 + 1e-9));
            }
            // Times beyond the squares of edges: order 2 in the mean.
            let order = (errors[1] / errors[2]).log2();
            assert!(time < 0.01 || (order - 2.0).abs() < 0.1, "{time}: {order} {errors:?}");
        }
    }

    #[test]
    fn heat_is_neither_lost_nor_made_and_spreads() {
        let mesh = shapes::geodesic_sphere(7, 3).unwrap();
        let mut start = VertexMap::filled(mesh.vertex_count(), 0.0);
        start.values_mut()[5] = 1.0;
        let after = heat_step(&mesh, &start, 0.2, Progress::NONE).unwrap();
        let masses = vertex_areas(&mesh, VertexArea::Barycentric);
        let total = |u: &VertexMap<f64>| mesh.vertices().map(|v| masses[v] * u[v]).sum::<f64>();
        assert!((total(&after) / total(&start) - 1.0).abs() < 1e-12);
        assert!(after.values().iter().all(|&u| 0.0 < u && u < 1.0));
    }

    #[test]
    fn times_and_masses_must_be_positive() {
        let l = SparseMatrix::from_edges(2, &[(0, 1, 1.0)]).unwrap();
        for time in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let result = HeatFlow::new(&l, &[1.0; 2], time, Progress::NONE);
            assert!(matches!(result.err(), Some(Error::InvalidOption { .. })));
        }
        let result = HeatFlow::new(&l, &[1.0, -1.0], 1.0, Progress::NONE);
        assert!(matches!(result.err(), Some(Error::NoMass { row: 1, .. })));
        assert!(HeatFlow::new(&l, &[1.0], 1.0, Progress::NONE).is_err());
    }

    #[test]
    fn rows_without_anything_keep_their_values() {
        let l = SparseMatrix::from_edges(3, &[(0, 1, 1.0)]).unwrap();
        let flow = HeatFlow::new(&l, &[1.0, 1.0, 0.0], 4.5, Progress::NONE).unwrap();
        let after = flow.step(&[1.0, 3.0, 7.0]).unwrap();
        // The difference is divided by 1 + 2t.
        assert!((after[0] - 1.9).abs() < 1e-14 && (after[1] - 2.1).abs() < 1e-14, "{after:?}");
        assert_eq!(after[2], 7.0);
    }
}
