//! The whole problem: cut into connected components, each scaled to numbers near one, and put together
//! again.

use super::{
    EigenReport, Eigenpairs, Mass, Shift,
    component::Solved,
    pencil::{OwnMass, Pencil},
};
use crate::{Error, SparseMatrix, cholesky::power_of_two};

/// L φ = λ M φ by components.
pub(super) struct Problem {
    pub(super) parts: Vec<Part>,
    rows: usize,
    /// Powers of two by which L and M were divided.
    scale_of_laplacian: f64,
    scale_of_mass: f64,
}

/// A connected component.
pub(super) struct Part {
    /// Its rows, ascending.
    pub(super) rows: Vec<u32>,
    pub(super) pencil: Pencil,
}

impl Problem {
    pub(super) fn new(
        laplacian: &SparseMatrix,
        mass: Mass<'_>,
        shift: Shift,
    ) -> Result<Problem, Error> {
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let scale_of_laplacian = power_of_two(largest(&laplacian.diagonal()));
        let scale_of_mass = match mass {
            Mass::Identity => 1.0,
            Mass::Diagonal(masses) => power_of_two(largest(masses)),
            Mass::Matrix(mass) => power_of_two(largest(&mass.diagonal())),
        };
        let shift = match shift {
            Shift::Automatic => None,
            Shift::Value(shift) => Some(shift / scale_of_laplacian * scale_of_mass),
        };
        let rows = laplacian.rows();
        // Where each row stands in its component.
        let mut place = vec![0; rows];
        let components = components(laplacian, mass);
        for component in &components {
            for (k, &row) in component.iter().enumerate() {
                place[row as usize] = k as u32;
            }
        }
        let mut parts = Vec::with_capacity(components.len());
        for rows in components {
            let of_laplacian = extracted(laplacian, &rows, &place, 1.0 / scale_of_laplacian)?;
            let factor = 1.0 / scale_of_mass;
            let mass = match mass {
                Mass::Identity => OwnMass::Identity,
                Mass::Diagonal(masses) => OwnMass::Diagonal(
                    rows.iter().map(|&row| masses[row as usize] * factor).collect(),
                ),
                Mass::Matrix(mass) => OwnMass::Matrix(extracted(mass, &rows, &place, factor)?),
            };
            parts.push(Part { rows, pencil: Pencil::new(of_laplacian, mass, shift) });
        }
        Ok(Problem { parts, rows, scale_of_laplacian, scale_of_mass })
    }

    /// By what eigenvalues of the parts are to be multiplied.
    fn scale(&self) -> f64 {
        self.scale_of_laplacian / self.scale_of_mass
    }

    /// The error in terms of the caller's matrix.
    pub(super) fn error(&self, error: Error, part: &Part) -> Error {
        match error.renumbered(&part.rows) {
            Error::NotPositiveDefinite { row, pivot, diagonal } => Error::NotPositiveDefinite {
                row,
                pivot: pivot * self.scale_of_laplacian,
                diagonal: diagonal * self.scale_of_laplacian,
            },
            Error::EigenvaluesMissed { found, counted, bound } => {
                Error::EigenvaluesMissed { found, counted, bound: bound * self.scale() }
            }
            error => error,
        }
    }

    /// The `count` smallest of all pairs.
    pub(super) fn merged(&self, solved: &[Solved], count: usize) -> Eigenpairs {
        let mut all: Vec<(usize, usize)> = solved
            .iter()
            .enumerate()
            .flat_map(|(part, solved)| (0..solved.values.len()).map(move |i| (part, i)))
            .collect();
        // Stable: of equal eigenvalues that of the first component comes first.
        all.sort_by(|&(a, i), &(b, j)| solved[a].values[i].total_cmp(&solved[b].values[j]));
        all.truncate(count);
        let mut report = EigenReport {
            components: self.parts.len(),
            confirmed: all.iter().filter(|&&(part, i)| i < solved[part].confirmed).count(),
            orthogonality: solved.iter().map(|part| part.orthogonality).fold(0.0, f64::max),
            solves: solved.iter().map(|part| part.solves).sum(),
            restarts: solved.iter().map(|part| part.restarts).sum(),
            ..EigenReport::default()
        };
        if let Some(part) = self.parts.iter().rev().max_by_key(|part| part.rows.len()) {
            report.shift = part.pencil.shift * self.scale();
        }
        let mut vectors = vec![0.0; self.rows * all.len()];
        let mut values = Vec::with_capacity(all.len());
        let factor = 1.0 / self.scale_of_mass.sqrt();
        for (k, &(p, i)) in all.iter().enumerate() {
            let (part, solved) = (&self.parts[p], &solved[p]);
            let size = part.rows.len();
            let vector = &mut vectors[k * self.rows..(k + 1) * self.rows];
            for (&row, x) in part.rows.iter().zip(&solved.vectors[i * size..]) {
                vector[row as usize] = x * factor;
            }
            values.push(solved.values[i] * self.scale());
            report.residuals.push(solved.residuals[i]);
            report.zeros += usize::from(solved.values[i].abs() <= 1e-11 * part.pencil.shift);
        }
        Eigenpairs { values, vectors, report }
    }
}

/// The rows of each component of the graph of L and M, ascending; in order of their first rows.
fn components(laplacian: &SparseMatrix, mass: Mass<'_>) -> Vec<Vec<u32>> {
    let mut seen = vec![false; laplacian.rows()];
    let mut components = Vec::new();
    for first in 0..laplacian.rows() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut component = vec![first as u32];
        let mut next = 0;
        while next < component.len() {
            let column = component[next] as usize;
            let mut follow = |matrix: &SparseMatrix| {
                let (rows, values) = matrix.column(column);
                for (&row, &value) in rows.iter().zip(values) {
                    if value != 0.0 && !std::mem::replace(&mut seen[row as usize], true) {
                        component.push(row);
                    }
                }
            };
            follow(laplacian);
            if let Mass::Matrix(mass) = mass {
                follow(mass);
            }
            next += 1;
        }
        component.sort_unstable();
        components.push(component);
    }
    components
}

/// The entries of `factor` · `matrix` in the rows and columns of a component.
fn extracted(
    matrix: &SparseMatrix,
    component: &[u32],
    place: &[u32],
    factor: f64,
) -> Result<SparseMatrix, Error> {
    if component.len() == matrix.rows() {
        return Ok(matrix.clone().scaled(factor));
    }
    let mut starts = vec![0_u32];
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for &j in component {
        let (rows, of_column) = matrix.column(j as usize);
        for (&i, &value) in rows.iter().zip(of_column) {
            // What is stored outside of the component is zero.
            if value != 0.0 || i == j {
                indices.push(place[i as usize]);
                values.push(value * factor);
            }
        }
        starts.push(indices.len() as u32);
    }
    SparseMatrix::from_columns(component.len(), starts, indices, values)
}
