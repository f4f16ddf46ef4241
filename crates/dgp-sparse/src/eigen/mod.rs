//! The smallest eigenvalues and their eigenvectors.
//!
//! ```text
//! L φ = λ M φ,   φᵢᵀ M φⱼ = δᵢⱼ
//! ```
//!
//! Each connected component is a problem of its own; so a mesh of many parts yields as many zeros, and
//! parts that are alike do not hide each other's eigenvalues. Of a component,
//!
//! 1. the constant is known to belong to 0 if the rows of L sum to zero;
//! 2. L + σ M is factored once, for a σ about the first eigenvalue;
//! 3. block Lanczos finds the largest eigenvalues 1/(λ + σ) of (L + σ M)⁻¹ M, where the basis is kept
//!    orthonormal to rounding and restarted where it grows too long;
//! 4. λ is computed anew from φ, as a sum of squares of differences, and the residual with it;
//! 5. the negative pivots of L − τ M, for a τ in a gap of the spectrum, tell how many eigenvalues lie
//!    below (Sylvester's law of inertia). If some were missed, the search goes on, orthogonal to those
//!    found.
//!
//! Small components, and those of which a third of all pairs is asked for, are solved densely.
//!
//! - Input: L symmetric, positive semidefinite, both triangles stored; masses positive.
//! - Cost: for k pairs of n rows about 2k to 3k solves, O(n k²) for orthogonality, 20 n k bytes.
//! - Guarantees: residuals are checked, and none of the eigenvalues below was missed where the report
//!   says so. Same bits for any number of threads; scaling L or M by 2ᵏ scales eigenvalues exactly.
//! - Reference: Grimes, Lewis and Simon, "A shifted block Lanczos algorithm for solving sparse symmetric
//!   generalized eigenproblems", 1994; Wu and Simon, "Thick-restart Lanczos method for large symmetric
//!   eigenvalue problems", 2000.
//! - Departs from it: one shift, all of the basis kept orthonormal.

mod component;
mod dense;
mod lanczos;
mod pencil;
mod problem;
mod tall;

use component::solve;
use problem::Problem;

use crate::{Error, Progress, SparseMatrix};

/// M in L φ = λ M φ.
#[derive(Clone, Copy, Debug)]
pub enum Mass<'a> {
    /// The identity.
    Identity,
    /// A diagonal of positive masses (lumped).
    Diagonal(&'a [f64]),
    /// A symmetric positive definite matrix (of finite elements).
    Matrix(&'a SparseMatrix),
}

/// σ in L + σ M, which is factored.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Shift {
    /// About the first eigenvalue that is not zero, were L the Laplacian of a round surface: 4π/area.
    #[default]
    Automatic,
    /// This one, which must be positive. Far below the first eigenvalues digits are lost; far above
    /// those wanted it takes more solves.
    Value(f64),
}

/// How [`eigenpairs`] computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EigenOptions {
    /// The largest residual ‖L φ − λ M φ‖ / ((λ + σ) ‖M φ‖), in Euclidean norms.
    pub tolerance: f64,
    /// σ, for which L + σ M is factored.
    pub shift: Shift,
    /// How many systems may be solved per eigenpair before giving up.
    pub solves_per_pair: usize,
    /// Of the random numbers to start from.
    pub seed: u64,
}

impl Default for EigenOptions {
    fn default() -> Self {
        EigenOptions { tolerance: 1e-10, shift: Shift::Automatic, solves_per_pair: 100, seed: 0 }
    }
}

/// The smallest eigenvalues and their eigenvectors.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Eigenpairs {
    /// λ, ascending.
    pub values: Vec<f64>,
    /// φ, one after the other, of length one in the norm of M. The entry that is largest in size (the
    /// first of those within rounding) is positive.
    pub vectors: Vec<f64>,
    /// What was checked.
    pub report: EigenReport,
}

impl Eigenpairs {
    /// The eigenvector of `values[i]`.
    pub fn vector(&self, i: usize) -> &[f64] {
        let rows = self.vectors.len() / self.values.len();
        &self.vectors[i * rows..(i + 1) * rows]
    }
}

/// How good [`Eigenpairs`] are, and what they cost.
#[derive(Clone, Debug, Default, PartialEq)]
#[must_use]
pub struct EigenReport {
    /// ‖L φ − λ M φ‖ / ((λ + σ) ‖M φ‖) of each pair, in Euclidean norms.
    pub residuals: Vec<f64>,
    /// The largest |φᵢᵀ M φⱼ − δᵢⱼ|.
    pub orthogonality: f64,
    /// How many eigenvalues are zero: to rounding, or because constants on a component belong to it.
    pub zeros: usize,
    /// How many of the pairs are known to be the smallest of their component: from a dense solve, or
    /// below a gap below which Sylvester's law confirmed the number of eigenvalues. The others belong to
    /// clusters that `count` cuts.
    pub confirmed: usize,
    /// The components of the matrix graph.
    pub components: usize,
    /// σ of the largest component.
    pub shift: f64,
    /// Solves with one right-hand side.
    pub solves: usize,
    /// How often a basis was restarted.
    pub restarts: usize,
}

/// The `count` smallest eigenvalues of L φ = λ M φ, and their eigenvectors.
///
/// L is symmetric positive semidefinite. An error names the row where L or M is not as it must be; pairs
/// that do not reach the tolerance, nor what rounding permits, are an error too.
///
/// ```
/// use dgp_sparse::{EigenOptions, Mass, Progress, SparseMatrix, eigenpairs};
///
/// // A cycle of four vertices: 0, 2, 2, 4.
/// let edges = [(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (3, 0, 1.0)];
/// let laplacian = SparseMatrix::from_edges(4, &edges)?;
/// let options = EigenOptions::default();
/// let pairs = eigenpairs(&laplacian, Mass::Identity, 3, &options, Progress::NONE)?;
/// assert_eq!(pairs.values[0], 0.0);
/// assert!((pairs.values[2] - 2.0).abs() < 1e-14);
/// assert_eq!(pairs.vector(0), [0.5; 4]);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
pub fn eigenpairs(
    laplacian: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
    progress: Progress<'_>,
) -> Result<Eigenpairs, Error> {
    progress.report(0.0)?;
    check(laplacian, mass, count, options)?;
    let problem = Problem::new(laplacian, mass, options.shift)?;
    // Each component whose constant belongs to zero leaves fewer of the pairs to the others.
    let zeros = problem.parts.iter().filter(|part| part.pencil.constant).count();
    let rows = laplacian.rows() as f64;
    let mut done = 0.0;
    let mut solved = Vec::with_capacity(problem.parts.len());
    for part in &problem.parts {
        let (size, own) = (part.rows.len(), usize::from(part.pencil.constant));
        let wanted = count.saturating_sub(zeros - own).max(own).min(size).min(count);
        let after = done + size as f64;
        let span = progress.part(done / rows, after / rows);
        let result = solve(&part.pencil, wanted, options, span);
        solved.push(result.map_err(|error| problem.error(error, part))?);
        done = after;
    }
    progress.report(1.0)?;
    Ok(problem.merged(&solved, count))
}

/// Errors of the input.
fn check(
    laplacian: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
) -> Result<(), Error> {
    laplacian.check_square()?;
    laplacian.check_finite()?;
    laplacian.check_symmetric()?;
    let rows = laplacian.rows();
    if let Some((row, diagonal)) =
        laplacian.diagonal().into_iter().enumerate().find(|&(_, diagonal)| diagonal < 0.0)
    {
        return Err(Error::NotPositiveDefinite { row, pivot: diagonal, diagonal });
    }
    let masses = match mass {
        Mass::Identity => Vec::new(),
        Mass::Diagonal(masses) => {
            Error::check_length("the mass", masses.len(), rows)?;
            Error::check_finite("the mass", masses)?;
            masses.to_vec()
        }
        Mass::Matrix(mass) => {
            Error::check_length("the mass (rows)", mass.rows(), rows)?;
            mass.check_finite()?;
            mass.check_symmetric()?;
            mass.diagonal()
        }
    };
    if let Some(row) = masses.iter().position(|&mass| mass <= 0.0) {
        return Err(Error::MassNotPositive { row, mass: masses[row] });
    }
    if count > rows {
        return Err(Error::TooManyEigenpairs { count, rows });
    }
    if !(options.tolerance > 0.0 && options.tolerance < 1.0) {
        return Err(Error::option("tolerance", options.tolerance, "between 0 and 1"));
    }
    match options.shift {
        Shift::Value(shift) if !(shift > 0.0 && shift.is_finite()) => {
            Err(Error::option("shift", shift, "positive and finite"))
        }
        _ => Ok(()),
    }
}
