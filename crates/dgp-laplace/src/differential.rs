//! Differential coordinates: where each vertex is, seen from its neighbors; and the way back.
//!
//! ```text
//! δ(i) = (1/s(i)) Σ w(i, j) (v(i) − v(j)) over the neighbors j
//!
//! s(i) = 1                   the plain Laplacian
//! s(i) = Σ w(i, j)           rows 1, −w/Σw: the vertex less the mean of its neighbors
//! s(i) = mass of i           twice the mean curvature times the normal, for cotangent weights
//! ```
//!
//! They are the same wherever the mesh is moved, so a vertex of each part must be fixed to find the
//! positions again. For symmetric weights s is multiplied out and the system solved by Cholesky; mean value
//! weights are not symmetric, and their equations are solved in the sense of least squares, exactly if they can
//! be.
//!
//! - Input: a mesh, or anything with a Laplacian.
//! - Cost: O(V) there; back one factorization, which serves any number of solutions.
//! - Guarantees: back and forth is the identity but for rounding. A part without fixed vertex is an
//!   error that names a vertex of it.
//! - Reference: Alexa, "Differential coordinates for local mesh morphing and deformation", The Visual
//!   Computer 19, 2003; Sorkine, "Laplacian mesh processing", Eurographics STAR 2005.

use dgp_mesh::{DVec3, Mesh, Progress, VertexId, VertexMap, VertexSet};
use dgp_sparse::SparseMatrix;

use crate::{
    Error,
    laplacian::{cotangent_laplacian, mean_value_laplacian, uniform_laplacian, vertex_masses},
    solve::{FreeSystem, columns, points},
    unit::unit_of,
};

/// The weights of neighbors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EdgeWeight {
    /// All the same.
    Uniform,
    /// (cot α + cot β)/2.
    #[default]
    Cotangent,
    /// Mean value coordinates.
    MeanValue,
}

/// What each row is divided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RowScale {
    /// Nothing.
    None,
    /// The sum of its weights, so that the diagonal is 1.
    #[default]
    Weights,
    /// A third of the area around the vertex.
    Mass,
}

/// A Laplacian whose rows may be divided by something: δ = S⁻¹ L v.
#[derive(Clone, Debug, PartialEq)]
pub struct DifferentialOperator {
    laplacian: SparseMatrix,
    /// S.
    scales: Vec<f64>,
    is_symmetric: bool,
}

impl DifferentialOperator {
    /// The operator of `mesh`. Rows of vertices on no face are zero.
    ///
    /// Errors: those of the Laplacians; [`Error::NonPositiveDiagonal`], [`Error::NoMass`] if a row cannot be
    /// divided.
    pub fn new(mesh: &Mesh, weight: EdgeWeight, scale: RowScale) -> Result<Self, Error> {
        let laplacian = match weight {
            EdgeWeight::Uniform => uniform_laplacian(mesh)?,
            EdgeWeight::Cotangent => cotangent_laplacian(mesh)?,
            EdgeWeight::MeanValue => mean_value_laplacian(mesh)?,
        };
        let lonely = |v: usize| mesh.is_isolated_vertex(VertexId::new(v));
        let mut scales = match scale {
            RowScale::None => vec![1.0; mesh.vertex_count()],
            RowScale::Weights => laplacian.diagonal(),
            RowScale::Mass => vertex_masses(mesh).into_values(),
        };
        for (row, s) in scales.iter_mut().enumerate() {
            if lonely(row) {
                *s = 1.0;
            } else if !(*s > 0.0 && s.is_finite()) {
                return Err(match scale {
                    RowScale::Mass => Error::NoMass { row, mass: *s },
                    _ => Error::NonPositiveDiagonal { row, diagonal: *s },
                });
            }
        }
        Ok(DifferentialOperator {
            laplacian,
            scales,
            is_symmetric: weight != EdgeWeight::MeanValue,
        })
    }

    /// S⁻¹ L, the general Laplacian.
    pub fn matrix(&self) -> Result<SparseMatrix, Error> {
        let factors: Vec<f64> = self.scales.iter().map(|s| 1.0 / s).collect();
        let ones = vec![1.0; factors.len()];
        Ok(self.laplacian.clone().scaled_by(&factors, &ones)?)
    }

    /// δ of these positions.
    ///
    /// # Panics
    /// If there is not one position per row.
    pub fn coordinates(&self, positions: &VertexMap<DVec3>) -> VertexMap<DVec3> {
        assert_eq!(positions.len(), self.scales.len(), "one position per row");
        let unit = unit_of(positions.values());
        let product = self.laplacian.product_many(&columns(positions.values(), unit));
        let mut delta = points(&product, unit);
        delta.iter_mut().zip(&self.scales).for_each(|(d, s)| *d /= *s);
        delta.into()
    }
}

/// Finds positions with given differential coordinates.
///
/// ```
/// use dgp_laplace::differential::{DifferentialOperator, EdgeWeight, Reconstruction, RowScale};
/// use dgp_mesh::{Progress, VertexId, shapes};
///
/// let mesh = shapes::icosphere(3)?;
/// let operator = DifferentialOperator::new(&mesh, EdgeWeight::Cotangent, RowScale::Weights)?;
/// let delta = operator.coordinates(mesh.positions());
/// let fixed = [VertexId::new(7)].into_iter().collect();
/// let found = Reconstruction::new(&operator, &fixed, Progress::NONE)?.solve(&delta, mesh.positions())?;
/// assert!(mesh.vertices().all(|v| found[v].distance(mesh.position(v)) < 1e-10));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Reconstruction<'a> {
    operator: &'a DifferentialOperator,
    system: FreeSystem,
}

impl<'a> Reconstruction<'a> {
    /// Prepares for solutions in which the vertices of `fixed` stay.
    ///
    /// Errors: [`Error::Sparse`] with the row of a vertex of a part in which none is fixed,
    /// [`Error::Cancelled`].
    pub fn new(
        operator: &'a DifferentialOperator,
        fixed: &VertexSet,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let count = operator.scales.len();
        let mut system = FreeSystem::new(count, |i| fixed.contains(VertexId::new(i)));
        if operator.is_symmetric {
            system.factor(&operator.laplacian, progress)?;
        } else {
            system.factor(&operator.laplacian.gram(&vec![1.0; count])?, progress)?;
        }
        Ok(Reconstruction { operator, system })
    }

    /// The positions whose differential coordinates are `delta`, with those of fixed vertices as given in
    /// `positions`; the others there do not matter. With mean value weights, and where they cannot be so at
    /// all vertices, those for which Σ |S δ − L v|² is least.
    ///
    /// At a fixed vertex symmetric weights leave δ as it comes.
    ///
    /// # Panics
    /// If there is not one value per row.
    pub fn solve(
        &self,
        delta: &VertexMap<DVec3>,
        positions: &VertexMap<DVec3>,
    ) -> Result<VertexMap<DVec3>, Error> {
        let scales = &self.operator.scales;
        assert_eq!((delta.len(), positions.len()), (scales.len(), scales.len()), "one per row");
        let unit = unit_of(positions.values());
        let scaled: Vec<DVec3> = delta.values().iter().zip(scales).map(|(d, s)| *d * *s).collect();
        let mut rhs = columns(&scaled, unit);
        if !self.operator.is_symmetric {
            rhs = self.operator.laplacian.transpose_product_many(&rhs);
        }
        let mut x = columns(positions.values(), unit);
        self.system.solve(&rhs, &mut x)?;
        Ok(points(&x, unit).into())
    }
}

#[cfg(test)]
mod tests {
    use dgp_mesh::{FaceList, IndexedFaceSet, shapes};

    use super::*;

    const WEIGHTS: [EdgeWeight; 3] =
        [EdgeWeight::Uniform, EdgeWeight::Cotangent, EdgeWeight::MeanValue];
    const SCALES: [RowScale; 3] = [RowScale::None, RowScale::Weights, RowScale::Mass];

    /// The vertex (1, 1, 1) with the neighbors (0, 1, 1), (1, 0, 1), (1, 1, 0).
    fn corner() -> Mesh {
        let positions = vec![
            DVec3::ONE,
            DVec3::new(0.0, 1.0, 1.0),
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::new(1.0, 1.0, 0.0),
        ];
        let faces = FaceList::from_indices(&[[0, 1, 2], [0, 2, 3], [0, 3, 1]]);
        Mesh::new(&IndexedFaceSet::new(positions, faces).unwrap()).unwrap()
    }

    #[test]
    fn the_corner_of_a_cube_is_a_third_beyond_the_mean_of_its_neighbors() {
        let mesh = corner();
        for weight in WEIGHTS {
            let operator = DifferentialOperator::new(&mesh, weight, RowScale::Weights).unwrap();
            let delta = operator.coordinates(mesh.positions())[VertexId::new(0)];
            assert!(delta.abs_diff_eq(DVec3::splat(1.0 / 3.0), 1e-15), "{weight:?} {delta}");
            let matrix = operator.matrix().unwrap();
            assert!((matrix.get(0, 0) - 1.0).abs() < 1e-15);
            assert!((1..4).all(|j| (matrix.get(0, j) + 1.0 / 3.0).abs() < 1e-15), "{weight:?}");
        }
    }

    #[test]
    fn there_and_back_is_the_identity() {
        let blob = shapes::with_noise(shapes::blob(3).unwrap(), 0.2, 4).unwrap();
        let open = shapes::with_holes(&blob, 3, 2, 5).unwrap();
        for mesh in [shapes::torus(2.0, 1.0, 18, 9).unwrap(), blob, open] {
            for weight in WEIGHTS {
                for scale in SCALES {
                    for fixed in [vec![3], vec![0, 50, 51]] {
                        let fixed: VertexSet = fixed.into_iter().map(VertexId::new).collect();
                        let operator = DifferentialOperator::new(&mesh, weight, scale).unwrap();
                        let delta = operator.coordinates(mesh.positions());
                        let solver =
                            Reconstruction::new(&operator, &fixed, Progress::NONE).unwrap();
                        let found = solver.solve(&delta, mesh.positions()).unwrap();
                        // Least squares loses digits twice.
                        let tolerance = if weight == EdgeWeight::MeanValue { 1e-7 } else { 1e-10 };
                        for v in mesh.vertices() {
                            let error = found[v].distance(mesh.position(v));
                            assert!(error < tolerance, "{weight:?} {scale:?} {v}: {error}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_moved_fixed_vertex_moves_all() {
        let mesh = shapes::blob(2).unwrap();
        let v = VertexId::new(11);
        let fixed = [v].into_iter().collect();
        let operator =
            DifferentialOperator::new(&mesh, EdgeWeight::Cotangent, RowScale::Mass).unwrap();
        let delta = operator.coordinates(mesh.positions());
        let offset = DVec3::new(1.0, 2.0, -3.0);
        let moved = mesh.positions().map(|&p| if p == mesh.position(v) { p + offset } else { p });
        let solver = Reconstruction::new(&operator, &fixed, Progress::NONE).unwrap();
        let found = solver.solve(&delta, &moved).unwrap();
        assert!(mesh.vertices().all(|w| found[w].distance(mesh.position(w) + offset) < 1e-10));
    }

    #[test]
    fn a_part_without_fixed_vertex_is_named() {
        let mesh = shapes::icosphere(2).unwrap();
        for weight in WEIGHTS {
            let operator = DifferentialOperator::new(&mesh, weight, RowScale::None).unwrap();
            let result = Reconstruction::new(&operator, &VertexSet::new(), Progress::NONE);
            assert!(matches!(result.err(), Some(Error::Sparse(_))), "{weight:?}");
        }
    }
}
