//! One connected problem L φ = λ M φ, scaled to numbers near one.

use crate::{Error, SparseMatrix, cholesky::sums_to_zero};

/// M of a connected problem.
pub(super) enum OwnMass {
    Identity,
    Diagonal(Vec<f64>),
    Matrix(SparseMatrix),
}

/// L and M of a connected problem, and what is known about it beforehand.
pub(super) struct Pencil {
    pub(super) laplacian: SparseMatrix,
    pub(super) mass: OwnMass,
    /// σ > 0: L + σ M is factored.
    pub(super) shift: f64,
    /// Whether the rows of L sum to zero, so that constants are eigenvectors for 0.
    pub(super) constant: bool,
    /// Σ of the other entries of each row of L, where they do not sum to zero.
    row_sums: Vec<f64>,
}

impl Pencil {
    pub(super) fn new(laplacian: SparseMatrix, mass: OwnMass, shift: Option<f64>) -> Pencil {
        let all: Vec<u32> = (0..laplacian.rows() as u32).collect();
        let constant = sums_to_zero(&laplacian, &all);
        let row_sums = if constant {
            Vec::new()
        } else {
            (0..all.len()).map(|j| laplacian.column(j).1.iter().sum()).collect()
        };
        let mut pencil = Pencil { laplacian, mass, shift: 1.0, constant, row_sums };
        pencil.shift = shift.unwrap_or_else(|| pencil.automatic_shift());
        pencil
    }

    /// About the first eigenvalue of a surface, which is 4π/area where it is round (Weyl's law).
    ///
    /// Where all triangles are equilateral and weights are cotangents, the diagonal of L is 2√3 at each
    /// vertex; that makes up for weights of another size.
    fn automatic_shift(&self) -> f64 {
        let n = self.rows() as f64;
        let trace: f64 = self.laplacian.diagonal().iter().sum();
        let masses: f64 = match &self.mass {
            OwnMass::Identity => n,
            OwnMass::Diagonal(masses) => masses.iter().sum(),
            OwnMass::Matrix(mass) => {
                mass.values().iter().sum::<f64>().max(mass.diagonal().iter().sum())
            }
        };
        let weight = trace / n / (2.0 * 3.0_f64.sqrt());
        let shift = 4.0 * std::f64::consts::PI * weight / masses;
        if shift > 0.0 && shift.is_finite() { shift } else { 1.0 / masses }
    }

    pub(super) fn rows(&self) -> usize {
        self.laplacian.rows()
    }

    /// L + factor · M; the pattern does not depend on the factor.
    pub(super) fn shifted(&self, factor: f64) -> Result<SparseMatrix, Error> {
        match &self.mass {
            OwnMass::Identity => self.laplacian.plus_diagonal(&vec![factor; self.rows()]),
            OwnMass::Diagonal(masses) => {
                let diagonal: Vec<f64> = masses.iter().map(|mass| factor * mass).collect();
                self.laplacian.plus_diagonal(&diagonal)
            }
            OwnMass::Matrix(mass) => SparseMatrix::combine(1.0, &self.laplacian, factor, mass),
        }
    }

    /// X ← M X, column by column.
    pub(super) fn weigh(&self, columns: &mut Vec<f64>) {
        match &self.mass {
            OwnMass::Identity => {}
            OwnMass::Diagonal(masses) => {
                for column in columns.chunks_exact_mut(self.rows()) {
                    column.iter_mut().zip(masses).for_each(|(x, mass)| *x *= mass);
                }
            }
            OwnMass::Matrix(mass) => *columns = mass.transpose_product_many(columns),
        }
    }

    /// xᵀ L x / xᵀ M x.
    ///
    /// As a sum of squares of differences: eigenvectors of small eigenvalues are smooth, and the terms
    /// of xᵀ (L x) would cancel.
    pub(super) fn quotient(&self, x: &[f64], weighted: &[f64]) -> f64 {
        let energy: f64 = (0..self.rows())
            .map(|j| {
                let (rows, values) = self.laplacian.column(j);
                let entries = rows.iter().zip(values).take_while(|&(&i, _)| (i as usize) < j);
                let sum: f64 =
                    entries.map(|(&i, value)| value * (x[i as usize] - x[j]).powi(2)).sum();
                self.row_sums.get(j).copied().unwrap_or(0.0) * x[j].powi(2) - sum
            })
            .sum();
        energy / dot(x, weighted)
    }
}

pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

pub(super) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}
