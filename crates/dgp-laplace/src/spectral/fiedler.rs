//! The Fiedler vector: the slowest wave, which changes its sign at the narrowest place.
//!
//! ```text
//! λ₁ = min Σ w(i, j) (f(i) − f(j))² / Σ m(i) f(i)²   over f with Σ m f = 0
//! ```
//!
//! - Input: the Laplacian of a connected graph or surface, masses.
//! - Cost: two eigenpairs.
//! - Guarantees: orthogonal to constants, residual known. Where all weights are positive, both signs form
//!   one part each (Fiedler 1975).
//! - Reference: Fiedler, "Algebraic connectivity of graphs", 1973; "A property of eigenvectors of
//!   nonnegative symmetric matrices and its application to graph theory", 1975.

use dgp_mesh::{Progress, VertexId, VertexMap};
use dgp_sparse::{EigenOptions, SparseMatrix};

use super::{basis::Eigenbasis, graph::parts};
use crate::Error;

/// How tightly a surface hangs together, and where it would come apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Fiedler {
    /// λ₁, the algebraic connectivity.
    pub value: f64,
    /// Its function, Σ m f² = 1.
    pub vector: VertexMap<f64>,
    /// How well both solve the equation, see [`dgp_sparse::EigenReport::residuals`].
    pub residual: f64,
}

/// The second eigenvalue of L φ = λ M φ and its function.
///
/// Vertices without mass and weights have the value 0.
/// Errors: [`Error::NotConnected`], [`Error::TooFewPoints`] for fewer than two vertices with mass, those of
/// [`Eigenbasis::new`].
pub fn fiedler(
    laplacian: &SparseMatrix,
    masses: &VertexMap<f64>,
    progress: Progress<'_>,
) -> Result<Fiedler, Error> {
    let rows: Vec<u32> =
        (0..masses.len() as u32).filter(|&row| masses.values()[row as usize] > 0.0).collect();
    if rows.len() < 2 {
        return Err(Error::TooFewPoints { count: rows.len(), least: 2 });
    }
    let (labels, count) = parts(laplacian, &rows);
    if count > 1 {
        let other = labels.iter().position(|&label| label > 0).unwrap_or(0);
        return Err(Error::NotConnected {
            vertices: [rows[0], rows[other]].map(|row| VertexId::new(row as usize)),
            parts: count,
        });
    }
    let basis = Eigenbasis::new(laplacian, masses, 2, &EigenOptions::default(), progress)?;
    Ok(Fiedler {
        value: basis.values()[1],
        vector: basis.function(1).to_vec().into(),
        residual: basis.residuals()[1],
    })
}
