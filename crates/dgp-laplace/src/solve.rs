//! Symmetric systems in which some unknowns are known.

use std::ops::ControlFlow;

use dgp_mesh::{DVec3, Progress};
use dgp_sparse::{CholeskyOptions, FixedSystem, SparseMatrix};

use crate::Error;

/// Runs `f` with a progress of dgp-sparse that reports to `progress`.
pub(crate) fn with_progress<T>(
    progress: Progress<'_>,
    f: impl FnOnce(dgp_sparse::Progress<'_>) -> T,
) -> T {
    let callback = |done: f64| match progress.report(done) {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    f(dgp_sparse::Progress::new(&callback))
}

/// Solves A x = b where some x are given, for one matrix after another of the same pattern.
pub(crate) struct FreeSystem {
    count: usize,
    given: Vec<u32>,
    system: Option<FixedSystem>,
}

impl FreeSystem {
    /// A system of `count` unknowns, of which `is_given` tells which ones are known.
    pub(crate) fn new(count: usize, is_given: impl Fn(usize) -> bool) -> Self {
        let given = (0..count).filter(|&i| is_given(i)).map(|i| i as u32).collect();
        FreeSystem { count, given, system: None }
    }

    /// How many unknowns are to be found.
    pub(crate) fn free_count(&self) -> usize {
        self.count - self.given.len()
    }

    /// Factors `matrix`, symmetric and positive definite on the free unknowns.
    pub(crate) fn factor(
        &mut self,
        matrix: &SparseMatrix,
        progress: Progress<'_>,
    ) -> Result<(), Error> {
        if self.free_count() == 0 {
            return Ok(progress.report(1.0)?);
        }
        with_progress(progress, |progress| {
            if let Some(system) = &mut self.system {
                return system.refactor(matrix, progress);
            }
            let options = CholeskyOptions::default();
            self.system = Some(FixedSystem::new(matrix, &self.given, &options, progress)?);
            Ok(())
        })?;
        Ok(())
    }

    /// Replaces the free entries of each of the columns of `x`, one after the other, by the solution for
    /// the right-hand sides in `rhs`; the given entries stay.
    pub(crate) fn solve(&self, rhs: &[f64], x: &mut [f64]) -> Result<(), Error> {
        // Nothing is left to be found, or the matrix was factored.
        let Some(system) = &self.system else { return Ok(()) };
        let columns = x.len().checked_div(self.count).unwrap_or(0);
        let values: Vec<f64> = x
            .chunks(self.count.max(1))
            .flat_map(|x| self.given.iter().map(|&i| x[i as usize]))
            .collect();
        x.copy_from_slice(&system.solve_many(rhs, &values, columns)?);
        Ok(())
    }
}

/// The coordinates of points, all x, then all y, then all z, times `unit`.
pub(crate) fn columns(points: &[DVec3], unit: f64) -> Vec<f64> {
    (0..3).flat_map(|k| points.iter().map(move |p| p[k] * unit)).collect()
}

/// The points with these coordinates, divided by `unit`.
pub(crate) fn points(columns: &[f64], unit: f64) -> Vec<DVec3> {
    let n = columns.len() / 3;
    (0..n).map(|i| DVec3::new(columns[i], columns[n + i], columns[2 * n + i]) / unit).collect()
}
