//! `dgp heat`: heat that spreads over a surface, and what it tells of each place.

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::{
    laplace::{
        self,
        flow::HeatFlow,
        spectral::{Eigenbasis, heat_kernel, heat_kernel_diagonal, signature_times},
    },
    mesh::{Mesh, Progress, VertexId, VertexMap, measure::edge_length_range},
    view::{ColorMap, Field},
};
use serde_json::json;

use crate::{
    cli::{Common, Input, OptionalOutput, id},
    commands::{
        scalars::{Pictured, color_vertices, csv},
        spectrum::{Operator, eigen_options},
    },
    failure::Failure,
    session::Session,
};

/// Options of `dgp heat`.
///
/// From the vertices of `--from`, each of which gets heat 1, it spreads for `--steps` times `--time`;
/// the output has the vertex attribute `heat`, in 1/area. With `--signature` it has
/// `heat_signature_0`, `heat_signature_1`, … instead: how much heat put at a vertex is still there after
/// short and long times (Sun, Ovsjanikov and Guibas 2009).
#[derive(Debug, Args)]
pub(crate) struct Heat {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: OptionalOutput,
    #[command(flatten)]
    operator: Operator,
    #[command(flatten)]
    pictured: Pictured,
    /// The vertices where the heat is in the beginning
    #[arg(long, value_name = "V,…", value_delimiter = ',', value_parser = id::<VertexId>)]
    from: Vec<VertexId>,
    /// How heat is spread
    #[arg(long, value_enum, default_value_t = Method::Steps)]
    method: Method,
    /// How many steps
    #[arg(long, value_name = "N", default_value_t = 10)]
    steps: usize,
    /// The time of a step, in squares of the mean edge length
    #[arg(long, value_name = "X", default_value_t = 10.0)]
    time: f64,
    /// The heat kernel signature at N times instead, 6 unless told
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "6", conflicts_with = "from")]
    signature: Option<usize>,
    /// How many eigenfunctions the kernel and the signature are made of
    #[arg(long, value_name = "K", default_value_t = 100)]
    count: usize,
    /// Write what is at each vertex as lines of numbers
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Implicit steps, each a solve with one factorization for all
    Steps,
    /// The heat kernel of the first eigenfunctions, for the whole time at once
    Kernel,
}

/// Values at the vertices, and the times they are for.
struct Spread {
    columns: Vec<(String, f64, VertexMap<f64>)>,
    masses: VertexMap<f64>,
}

impl Heat {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        if self.from.is_empty() && self.signature.is_none() {
            let message = "tell where the heat is with --from V,…, or ask for the --signature";
            return Err(Failure::Usage(message.to_owned()));
        }
        let mut session = Session::new("heat", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let spread = self
            .spread(&mut session, common, &mesh)
            .map_err(|failure| failure.in_file(&self.input.path))?;

        let total =
            |u: &VertexMap<f64>| -> f64 { mesh.vertices().map(|v| spread.masses[v] * u[v]).sum() };
        let values: Vec<_> = spread
            .columns
            .iter()
            .map(|(name, time, u)| {
                let (least, most) = range(u);
                json!({"name": name, "time": time, "least": least, "largest": most, "total": total(u)})
            })
            .collect();
        let (_, time, last) = &spread.columns[spread.columns.len() - 1];
        let (least, most) = range(last);
        let summary = match self.signature {
            Some(count) => format!(
                "{}: heat kernel signature at {count} times from {:.4e} to {time:.4e}",
                self.input.path.display(),
                spread.columns[0].1,
            ),
            None => format!(
                "{}: heat after {time:.4e} from {least:.4e} to {most:.4e}, {:.6} in all",
                self.input.path.display(),
                total(last),
            ),
        };
        let report = json!({
            "laplacian": self.operator.name(),
            "from": self.from.iter().map(|v| v.index()).collect::<Vec<_>>(),
            "values": values,
        });

        if let Some(path) = &self.csv {
            let mut names = vec!["vertex"];
            names.extend(spread.columns.iter().map(|(name, _, _)| name.as_str()));
            let rows = mesh.vertices().map(|v| {
                let columns = spread.columns.iter().map(|(_, _, u)| u[v]);
                std::iter::once(v.index() as f64).chain(columns).collect()
            });
            session.store(path, csv(&names, rows).as_bytes())?;
        }
        let fields = spread
            .columns
            .iter()
            .take(6)
            .map(|(_, time, u)| (format!("t = {time:.3e}"), Field::Vertices(u.clone())));
        self.pictured.draw_all(&mut session, &mesh, fields.collect(), ColorMap::Viridis)?;
        if let Some(output) = self.output.given() {
            // The middle of the signatures: the first see only noise, the last only the whole.
            let shown = spread.columns[spread.columns.len() / 2].2.clone();
            color_vertices(&mut mesh, &shown, ColorMap::Viridis, false);
            for (name, _, u) in spread.columns {
                mesh.attributes_mut().vertex.insert(&name, u);
            }
            document.set = mesh.to_indexed();
            session.write(&output, &document)?;
        }
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn spread(
        &self,
        session: &mut Session<'_>,
        common: &Common,
        mesh: &Mesh,
    ) -> Result<Spread, Failure> {
        for &v in &self.from {
            Failure::need(v, mesh.vertex_count())?;
        }
        let (laplacian, masses) =
            session.run("assembling", |progress| self.operator.of(mesh, progress))?;
        if let Some(&v) = self.from.iter().find(|&&v| masses[v] <= 0.0) {
            return Err(Failure::Usage(format!(
                "{v} is on no face with area: no heat spreads there"
            )));
        }
        let mean = edge_length_range(mesh).map_or(1.0, |range| range.mean);
        // The graph Laplacian knows no lengths.
        let unit = if self.operator.knows_lengths() { mean * mean } else { 1.0 };
        let step = self.time * unit;
        let basis = |session: &mut Session<'_>| {
            session.run("solving", |progress| {
                let options = eigen_options(common);
                Eigenbasis::new(&laplacian, &masses, self.count, &options, progress)
            })
        };
        let columns = match (self.signature, self.method) {
            (Some(count), _) => {
                let basis = basis(session)?;
                let times = signature_times(&basis, count)?;
                let column = |(i, time): (usize, f64)| {
                    let values = heat_kernel_diagonal(&basis, time)?;
                    Ok((format!("heat_signature_{i}"), time, values))
                };
                times.into_iter().enumerate().map(column).collect::<Result<_, laplace::Error>>()?
            }
            (None, Method::Kernel) => {
                let basis = basis(session)?;
                let time = step * self.steps as f64;
                let mut heat = VertexMap::filled(mesh.vertex_count(), 0.0);
                for &v in &self.from {
                    let kernel = heat_kernel(&basis, time, v)?;
                    heat.iter_mut().for_each(|(w, heat)| *heat += kernel[w]);
                }
                vec![("heat".to_owned(), time, heat)]
            }
            (None, Method::Steps) => {
                let mut heat = vec![0.0; mesh.vertex_count()];
                for &v in &self.from {
                    heat[v.index()] += 1.0 / masses[v];
                }
                let work = |progress: Progress<'_>| {
                    let part = progress.part(0.0, 0.5);
                    let flow = HeatFlow::new(&laplacian, masses.values(), step, part)?;
                    for i in 0..self.steps {
                        progress.report(0.5 + 0.5 * i as f64 / self.steps as f64)?;
                        heat = flow.step(&heat)?;
                    }
                    Ok::<_, laplace::Error>(heat)
                };
                let heat = session.run("spreading", work)?;
                vec![("heat".to_owned(), step * self.steps as f64, heat.into())]
            }
        };
        if columns.is_empty() {
            return Err(Failure::Usage("--signature needs at least one time".to_owned()));
        }
        Ok(Spread { columns, masses })
    }
}

fn range(values: &VertexMap<f64>) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    values.values().iter().fold(start, |(least, most), &x| (least.min(x), most.max(x)))
}
