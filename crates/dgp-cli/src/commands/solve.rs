//! `dgp solve`: sparse systems and eigenvalues from files.

use std::{
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Args, ValueEnum};
use dgp::{
    mesh,
    sparse::{
        self, Cholesky, CholeskyOptions, ConjugateGradients, ConjugateGradientsOptions,
        EqualitySystem, FixedSystem, LeastSquaresMethod, Lu, Mass, SoftSystem, SparseMatrix,
        eigenpairs, least_squares,
    },
};
use serde_json::{Value, json};

use crate::{
    cli::Common,
    commands::{scalars::csv, spectrum::eigen_options},
    failure::Failure,
    session::Session,
};

/// Options of `dgp solve`.
///
/// Matrices are in the Matrix Market format (coordinates), as `dgp laplacian` writes them; right-hand sides
/// too, or as lines of numbers, a line for each row. Rows count from 0.
#[derive(Debug, Args)]
pub(crate) struct Solve {
    /// The matrix
    #[arg(value_name = "MTX")]
    matrix: PathBuf,
    /// The right-hand side; of several columns each is solved for
    #[arg(long, value_name = "FILE", required_unless_present = "eigenvalues")]
    rhs: Option<PathBuf>,
    /// How to solve
    #[arg(long, value_enum, default_value_t = Method::Cholesky)]
    method: Method,
    /// Rows whose unknowns are given, such as `0=1.5,7=0` (cholesky)
    #[arg(long, value_name = "ROW=X,…", value_delimiter = ',', value_parser = given)]
    fix: Vec<(u32, f64)>,
    /// Equations C x = d beside the system, a row of C each: exact ones, unless they have weights (cholesky)
    #[arg(long, value_name = "MTX", conflicts_with = "fix", requires = "rhs")]
    equations: Option<PathBuf>,
    /// The right-hand sides d of the equations; zeros if not given
    #[arg(long, value_name = "FILE", requires = "equations")]
    targets: Option<PathBuf>,
    /// The weights of the equations: one number for all, or a file with a line for each
    #[arg(long, value_name = "W|FILE", requires = "equations", allow_negative_numbers = true)]
    weights: Option<String>,
    /// The K smallest eigenvalues of a symmetric semidefinite matrix instead
    #[arg(long, value_name = "K", conflicts_with_all = ["rhs", "fix", "method"])]
    eigenvalues: Option<usize>,
    /// The mass matrix of the eigenvalues: L φ = λ M φ
    #[arg(long, value_name = "MTX", requires = "eigenvalues")]
    mass: Option<PathBuf>,
    /// Write the solution, or the eigenvectors, a column each, `-` for standard output
    #[arg(id = "output", long = "output", short = 'o', value_name = "CSV")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// A symmetric positive definite matrix, by factors
    Cholesky,
    /// Any square matrix, by factors
    Lu,
    /// A symmetric positive definite matrix, by iterations (conjugate gradients)
    Cg,
    /// More rows than columns: the smallest residual, by orthogonal factors
    LeastSquares,
}

/// C x = d for each right-hand side, with weights or exactly.
struct Equations {
    matrix: SparseMatrix,
    /// Column after column.
    targets: Vec<f64>,
    weights: Option<Vec<f64>>,
}

/// What was found: columns one after the other.
struct Found {
    columns: Vec<f64>,
    names: Vec<String>,
    report: Value,
    summary: String,
}

impl Solve {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let options = [("--fix", !self.fix.is_empty()), ("--equations", self.equations.is_some())];
        for (name, given) in options {
            if given && self.method != Method::Cholesky {
                return Err(Failure::Usage(format!("{name} goes with --method cholesky")));
            }
        }
        let mut session = Session::new("solve", common);
        let matrix = read_matrix(&self.matrix)?;
        let found = match (self.eigenvalues, &self.rhs) {
            (Some(count), _) => self.eigen(&mut session, common, &matrix, count),
            (None, Some(path)) => {
                let rhs = read_columns(path, matrix.rows())?;
                let equations = self.equations(&rhs, matrix.rows())?;
                match &equations {
                    Some(equations) => self.solve_with(equations, &mut session, &matrix, &rhs),
                    None => self.solve(&mut session, &matrix, &rhs),
                }
            }
            (None, None) => {
                return Err(Failure::Usage("give --rhs FILE or --eigenvalues K".to_owned()));
            }
        };
        let found = found.map_err(|failure| failure.in_file(&self.matrix))?;
        if let Some(path) = &self.output {
            let names: Vec<&str> = found.names.iter().map(String::as_str).collect();
            let rows = found.columns.len() / names.len().max(1);
            let line = |i: usize| found.columns.iter().skip(i).step_by(rows).copied().collect();
            let bytes = csv(&names, (0..rows).map(line)).into_bytes();
            let described = json!({
                "path": path.to_string_lossy(), "format": "csv", "bytes": bytes.len(),
                "rows": rows, "columns": names.len(),
            });
            session.write_bytes(path, &bytes, described)?;
        }
        session.finish(&found.summary, &found.report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn solve(
        &self,
        session: &mut Session<'_>,
        matrix: &SparseMatrix,
        rhs: &[f64],
    ) -> Result<Found, Failure> {
        let (m, n) = (matrix.rows(), matrix.columns());
        let count = rhs.len().checked_div(m).unwrap_or(0);
        let mut iterations = None;
        let x = session.run("solving", |progress| {
            with_progress(progress, |progress| {
                Ok::<_, sparse::Error>(match self.method {
                    Method::Cholesky if !self.fix.is_empty() => {
                        let rows: Vec<u32> = self.fix.iter().map(|fixed| fixed.0).collect();
                        let values: Vec<f64> = self.fix.iter().map(|fixed| fixed.1).collect();
                        let options = CholeskyOptions::default();
                        let system = FixedSystem::new(matrix, &rows, &options, progress)?;
                        system.solve_many(rhs, &values.repeat(count), count)?
                    }
                    Method::Cholesky => {
                        let options = CholeskyOptions::default();
                        Cholesky::new(matrix, &options, progress)?.solve_many(rhs)?
                    }
                    Method::Lu => Lu::new(matrix, progress)?.solve_many(rhs)?,
                    Method::Cg => {
                        let options = ConjugateGradientsOptions::default();
                        let solver = ConjugateGradients::new(matrix, &options)?;
                        let mut all = Vec::with_capacity(rhs.len());
                        for b in rhs.chunks(m.max(1)) {
                            let (x, report) = solver.solve(b, progress)?;
                            iterations = iterations.max(Some(report.iterations));
                            all.extend(x);
                        }
                        all
                    }
                    Method::LeastSquares => {
                        least_squares(matrix, rhs, LeastSquaresMethod::Qr, progress)?.solution
                    }
                })
            })
        })?;
        let residuals: Vec<f64> = x
            .chunks(n.max(1))
            .zip(rhs.chunks(m.max(1)))
            .map(|(x, b)| self.residual(matrix, x, b))
            .collect();
        let worst = residuals.iter().copied().fold(0.0, f64::max);
        let method = self.method.to_possible_value().map(|v| v.get_name().to_owned());
        let summary = format!(
            "{}: {m} rows, {n} columns, {} entries, {count} solved for; residuals up to {worst:.1e}; {}",
            self.matrix.display(),
            matrix.entries(),
            session.spent(),
        );
        let report = json!({
            "rows": m, "columns": n, "entries": matrix.entries(), "method": method,
            "fixed": self.fix.len(), "residuals": residuals, "iterations": iterations,
        });
        let names = (0..count).map(|k| format!("x_{k}")).collect();
        Ok(Found { columns: x, names, report, summary })
    }

    /// The equations beside the system, of which `rhs` holds right-hand sides for `rows` rows.
    fn equations(&self, rhs: &[f64], rows: usize) -> Result<Option<Equations>, Failure> {
        let Some(path) = &self.equations else { return Ok(None) };
        let matrix = read_matrix(path)?;
        let (count, columns) = (matrix.rows(), rhs.len().checked_div(rows).unwrap_or(0));
        let targets = match &self.targets {
            Some(path) => read_columns(path, count)?,
            None => vec![0.0; count * columns],
        };
        // One column of targets is good for all right-hand sides.
        let targets = match targets.len() {
            given if given == count => targets.repeat(columns),
            given if given == count * columns => targets,
            given => {
                return Err(Failure::Usage(format!(
                    "--targets: {} columns, but there are {columns} right-hand sides",
                    given / count.max(1)
                )));
            }
        };
        let weights = self.weights.as_deref().map(|text| equation_weights(text, count));
        Ok(Some(Equations { matrix, targets, weights: weights.transpose()? }))
    }

    /// Minimizes ½ xᵀAx − bᵀx while the equations hold, exactly or as well as their weights demand.
    fn solve_with(
        &self,
        equations: &Equations,
        session: &mut Session<'_>,
        matrix: &SparseMatrix,
        rhs: &[f64],
    ) -> Result<Found, Failure> {
        let (n, count) = (matrix.rows(), equations.matrix.rows());
        let options = CholeskyOptions::default();
        let mut multipliers = Vec::new();
        let x = session.run("solving", |progress| {
            with_progress(progress, |progress| {
                let pairs = rhs
                    .chunks(n.max(1))
                    .enumerate()
                    .map(|(k, rhs)| (rhs, &equations.targets[k * count..(k + 1) * count]));
                let mut all = Vec::with_capacity(rhs.len());
                if let Some(weights) = &equations.weights {
                    let constraints = &equations.matrix;
                    let system = SoftSystem::new(matrix, constraints, weights, &options, progress)?;
                    for (rhs, targets) in pairs {
                        all.extend(system.solve(rhs, targets)?);
                    }
                } else {
                    let system =
                        EqualitySystem::new(matrix, &equations.matrix, &options, progress)?;
                    for (rhs, targets) in pairs {
                        let (x, forces) = system.solve(rhs, targets)?;
                        all.extend(x);
                        multipliers.push(forces);
                    }
                }
                Ok::<_, sparse::Error>(all)
            })
        })?;
        let off: Vec<f64> = x
            .chunks(n.max(1))
            .zip(equations.targets.chunks(count.max(1)))
            .map(|(x, targets)| {
                let values = equations.matrix.product(x);
                values.iter().zip(targets).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            })
            .collect();
        let worst = off.iter().copied().fold(0.0, f64::max);
        let solved = rhs.len().checked_div(n).unwrap_or(0);
        let kind = if equations.weights.is_some() { "weighted" } else { "exact" };
        let summary = format!(
            "{}: {n} rows, {} entries, {count} {kind} equations, {solved} solved for; equations off by up to \
             {worst:.1e}; {}",
            self.matrix.display(),
            matrix.entries(),
            session.spent(),
        );
        let report = json!({
            "rows": n, "columns": n, "entries": matrix.entries(), "method": "cholesky",
            "equations": count, "kind": kind, "equations_off_by": off, "multipliers": multipliers,
        });
        let names = (0..solved).map(|k| format!("x_{k}")).collect();
        Ok(Found { columns: x, names, report, summary })
    }

    /// ‖A x − b‖ / ‖b‖ over the rows that are to be fulfilled.
    fn residual(&self, matrix: &SparseMatrix, x: &[f64], b: &[f64]) -> f64 {
        let mut off = matrix.product(x);
        off.iter_mut().zip(b).for_each(|(off, b)| *off -= b);
        self.fix.iter().for_each(|fixed| off[fixed.0 as usize] = 0.0);
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let size = norm(b);
        if size > 0.0 { norm(&off) / size } else { norm(&off) }
    }

    fn eigen(
        &self,
        session: &mut Session<'_>,
        common: &Common,
        matrix: &SparseMatrix,
        count: usize,
    ) -> Result<Found, Failure> {
        let mass = self.mass.as_deref().map(read_matrix).transpose()?;
        let mass = mass.as_ref().map_or(Mass::Identity, Mass::Matrix);
        let pairs = session.run("solving", |progress| {
            with_progress(progress, |progress| {
                eigenpairs(matrix, mass, count, &eigen_options(common), progress)
            })
        })?;
        let worst = pairs.report.residuals.iter().copied().fold(0.0, f64::max);
        let ends = pairs.values.first().zip(pairs.values.last());
        let summary = format!(
            "{}: {} eigenvalues{}, {} of them zero; residuals up to {worst:.1e}; {}",
            self.matrix.display(),
            pairs.values.len(),
            ends.map_or(String::new(), |(a, b)| format!(" from {a:.6e} to {b:.6e}")),
            pairs.report.zeros,
            session.spent(),
        );
        let report = json!({
            "rows": matrix.rows(),
            "eigenvalues": pairs.values,
            "residuals": pairs.report.residuals,
            "zero_eigenvalues": pairs.report.zeros,
            "components": pairs.report.components,
            "orthogonality": pairs.report.orthogonality,
        });
        let names = (0..pairs.values.len()).map(|k| format!("eigenvector_{k}")).collect();
        Ok(Found { columns: pairs.vectors, names, report, summary })
    }
}

/// A weight for each of `count` equations: one number for all, or a file.
fn equation_weights(text: &str, count: usize) -> Result<Vec<f64>, Failure> {
    if let Ok(weight) = text.parse::<f64>() {
        return Ok(vec![weight; count]);
    }
    let weights = read_columns(Path::new(text), count)?;
    if weights.len() != count {
        return Err(Failure::Usage("--weights: one number a line is needed".to_owned()));
    }
    Ok(weights)
}

/// `ROW=X`.
fn given(text: &str) -> Result<(u32, f64), String> {
    let wrong = || format!("`{text}` is no ROW=X, such as 12=0.5");
    let (row, value) = text.split_once('=').ok_or_else(wrong)?;
    let row = row.trim().parse().map_err(|_| wrong())?;
    let value = value.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong)?;
    Ok((row, value))
}

fn read_text(path: &Path) -> Result<String, Failure> {
    fs::read_to_string(path).map_err(|source| Failure::Text { path: path.to_owned(), source })
}

fn read_matrix(path: &Path) -> Result<SparseMatrix, Failure> {
    let matrix = SparseMatrix::from_matrix_market(&read_text(path)?);
    matrix.map_err(|error| Failure::from(error).in_file(path))
}

/// The columns of a file, one after the other.
fn read_columns(path: &Path, rows: usize) -> Result<Vec<f64>, Failure> {
    let text = read_text(path)?;
    let wrong = |message: String| Failure::Usage(format!("{}: {message}", path.display()));
    if text.starts_with("%%MatrixMarket") {
        let matrix = read_matrix(path)?;
        if matrix.rows() != rows {
            return Err(wrong(format!("{} rows, but the matrix has {rows}", matrix.rows())));
        }
        let mut columns = vec![0.0; rows * matrix.columns()];
        matrix.triplets().for_each(|(i, j, value)| columns[j * rows + i] = value);
        return Ok(columns);
    }
    let mut lines: Vec<Vec<f64>> = Vec::with_capacity(rows);
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let words = line.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
        let values: Result<Vec<f64>, _> = words.map(str::parse).collect();
        match values {
            Ok(values) => lines.push(values),
            // A line of names above the numbers, as `dgp` itself writes it.
            Err(_) if number == 0 => {}
            Err(_) => return Err(wrong(format!("line {} is no list of numbers", number + 1))),
        }
    }
    let count = lines.first().map_or(0, Vec::len);
    if lines.len() != rows || count == 0 || lines.iter().any(|line| line.len() != count) {
        let found = lines.len();
        return Err(wrong(format!("{rows} lines of equally many numbers are needed, not {found}")));
    }
    Ok((0..count).flat_map(|j| lines.iter().map(move |line| line[j])).collect())
}

/// Runs `work` with a progress of dgp-sparse that reports to `progress`.
fn with_progress<T>(
    progress: mesh::Progress<'_>,
    work: impl FnOnce(sparse::Progress<'_>) -> T,
) -> T {
    let report = |done: f64| match progress.report(done) {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    work(sparse::Progress::new(&report))
}
