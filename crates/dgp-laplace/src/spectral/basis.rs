//! The lowest eigenfunctions of a Laplacian: L φ = λ M φ.
//!
//! ```text
//! f = Σ ⟨f, φᵢ⟩ φᵢ     ⟨f, g⟩ = Σ m(v) f(v) g(v)     0 = λ₀ ≤ λ₁ ≤ …
//! ```
//!
//! - Input: a symmetric positive semidefinite Laplacian and a mass for each row; masses of 1 give the
//!   spectrum of a graph, L φ = λ φ.
//! - Cost: that of [`dgp_sparse::eigenpairs`]: one factorization, then O(k² n).
//! - Guarantees: functions are orthonormal in ⟨·, ·⟩, each pair's residual is known. As many eigenvalues
//!   are zero as there are parts.
//! - Reference: Vallet and Lévy, "Spectral geometry processing with manifold harmonics", Eurographics
//!   2008; Lévy, "Laplace–Beltrami eigenfunctions: towards an algorithm that understands geometry", SMI 2006.
//! - Departs from it: vertices on no face have no mass; there all functions are zero.

use dgp_mesh::{Progress, VertexMap};
use dgp_sparse::{EigenOptions, EigenReport, Mass, SparseMatrix, eigenpairs};

use crate::{Error, solve::with_progress};

/// The eigenfunctions with the smallest eigenvalues, orthonormal.
#[derive(Clone, Debug)]
pub struct Eigenbasis {
    values: Vec<f64>,
    /// One function after the other.
    functions: Vec<f64>,
    masses: VertexMap<f64>,
    report: EigenReport,
}

impl Eigenbasis {
    /// The first `count` eigenfunctions of L φ = λ M φ, where `masses` is the diagonal of M.
    ///
    /// Rows without mass must have no weights either.
    /// Errors: [`Error::NoMass`] for other masses, [`Error::InvalidOption`] unless `count` is between 1 and
    /// the number of rows with mass, [`Error::Sparse`] if L is not symmetric or the iteration does not
    /// converge, [`Error::Cancelled`].
    ///
    /// # Panics
    /// If there is not a mass per row.
    pub fn new(
        laplacian: &SparseMatrix,
        masses: &VertexMap<f64>,
        count: usize,
        options: &EigenOptions,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        assert_eq!(masses.len(), laplacian.rows(), "a mass per row");
        let rows = rows_with_mass(laplacian, masses.values())?;
        let n = masses.len();
        if count == 0 || count > rows.len() {
            let expected = "between 1 and the number of vertices with mass";
            return Err(Error::option("count", count as f64, expected));
        }
        let pairs = with_progress(progress, |progress| {
            if rows.len() == n {
                return eigenpairs(
                    laplacian,
                    Mass::Diagonal(masses.values()),
                    count,
                    options,
                    progress,
                );
            }
            let reduced = laplacian.submatrix(&rows, &rows)?;
            let diagonal: Vec<f64> = rows.iter().map(|&i| masses.values()[i as usize]).collect();
            eigenpairs(&reduced, Mass::Diagonal(&diagonal), count, options, progress)
        })?;
        let functions = if rows.len() == n {
            pairs.vectors
        } else {
            let mut functions = vec![0.0; count * n];
            for (all, some) in functions.chunks_mut(n).zip(pairs.vectors.chunks(rows.len())) {
                rows.iter().zip(some).for_each(|(&i, &value)| all[i as usize] = value);
            }
            functions
        };
        let (values, report) = (pairs.values, pairs.report);
        Ok(Eigenbasis { values, functions, masses: masses.clone(), report })
    }

    /// How many functions there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// How many vertices there are.
    pub fn vertex_count(&self) -> usize {
        self.masses.len()
    }

    /// The eigenvalues, ascending; in units of weight over mass: 1/length² on a surface.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// How well each pair solves the equation, see [`EigenReport::residuals`].
    pub fn residuals(&self) -> &[f64] {
        &self.report.residuals
    }

    /// What was checked, and what it cost.
    pub fn report(&self) -> &EigenReport {
        &self.report
    }

    /// The mass of each vertex.
    pub fn masses(&self) -> &VertexMap<f64> {
        &self.masses
    }

    /// Function `i`, a value per vertex.
    ///
    /// # Panics
    /// If there are not more than `i` functions.
    pub fn function(&self, i: usize) -> &[f64] {
        let n = self.masses.len();
        &self.functions[i * n..(i + 1) * n]
    }

    /// How many eigenvalues are zero but for rounding: the number of parts, if there are functions enough.
    pub fn zero_count(&self) -> usize {
        self.report.zeros
    }

    /// The first functions alone.
    ///
    /// # Panics
    /// If there are fewer than `count`.
    pub fn truncated(&self, count: usize) -> Eigenbasis {
        let mut basis = self.clone();
        assert!(count <= basis.values.len(), "{count} functions of {}", basis.values.len());
        basis.values.truncate(count);
        basis.report.residuals.truncate(count);
        basis.report.zeros = basis.report.zeros.min(count);
        basis.functions.truncate(count * basis.masses.len());
        basis
    }

    /// ⟨f, φᵢ⟩ for each function.
    ///
    /// # Panics
    /// If there is not a value per vertex.
    pub fn coefficients(&self, f: &[f64]) -> Vec<f64> {
        assert_eq!(f.len(), self.masses.len(), "a value per vertex");
        let weighted: Vec<f64> = f.iter().zip(self.masses.values()).map(|(f, m)| f * m).collect();
        let dot = |phi: &[f64]| phi.iter().zip(&weighted).map(|(a, b)| a * b).sum();
        self.functions.chunks(self.masses.len().max(1)).map(dot).collect()
    }

    /// Σ cᵢ φᵢ, for as many functions as there are coefficients.
    ///
    /// # Panics
    /// If there are more coefficients than functions.
    pub fn combination(&self, coefficients: &[f64]) -> Vec<f64> {
        assert!(coefficients.len() <= self.len(), "no more coefficients than functions");
        let mut sum = vec![0.0; self.masses.len()];
        for (i, &c) in coefficients.iter().enumerate() {
            sum.iter_mut().zip(self.function(i)).for_each(|(sum, phi)| *sum += c * phi);
        }
        sum
    }

    /// The values of the first `count` functions at each vertex, vertex after vertex.
    pub(super) fn rows(&self, count: usize) -> Vec<f64> {
        let n = self.masses.len();
        let mut rows = vec![0.0; count * n];
        for i in 0..count {
            let column = self.function(i);
            rows.iter_mut().skip(i).step_by(count.max(1)).zip(column).for_each(|(r, &f)| *r = f);
        }
        rows
    }
}

/// The rows that have mass; the others must be empty.
fn rows_with_mass(laplacian: &SparseMatrix, masses: &[f64]) -> Result<Vec<u32>, Error> {
    let mut rows = Vec::with_capacity(masses.len());
    for (row, &mass) in masses.iter().enumerate() {
        if mass > 0.0 && mass.is_finite() {
            rows.push(row as u32);
        } else if mass != 0.0 || laplacian.column(row).1.iter().any(|&weight| weight != 0.0) {
            return Err(Error::NoMass { row, mass });
        }
    }
    Ok(rows)
}
