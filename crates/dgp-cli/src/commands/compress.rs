//! `dgp compress`: a shape as the first waves of its connectivity.

use std::{path::PathBuf, process::ExitCode};

use clap::Args;
use dgp::{
    laplace::{
        laplacian::uniform_laplacian,
        spectral::{CompressionOptions, Eigenbasis, RatePoint, compress, rate_distortion},
    },
    mesh::VertexMap,
    view::{Axis, Curve, Plot},
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, OptionalOutput},
    commands::{scalars::csv, spectrum::eigen_options},
    failure::Failure,
    session::Session,
};

/// Options of `dgp compress`.
///
/// Keeps the first coefficients of the positions in the eigenfunctions of the graph (Karni and Gotsman
/// 2000). The output is the mesh that comes back; the curve tells what more or fewer coefficients would give.
#[derive(Debug, Args)]
pub(crate) struct Compress {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: OptionalOutput,
    /// How many coefficients of each coordinate to keep
    #[arg(long, value_name = "K", default_value_t = 100)]
    coefficients: usize,
    /// Bits of the largest coefficient
    #[arg(long, value_name = "N", default_value_t = 14)]
    bits: u32,
    /// Write rate and distortion as lines of numbers
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw rate against distortion into this SVG
    #[arg(long, value_name = "SVG")]
    plot: Option<PathBuf>,
}

impl Compress {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("compress", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let options = CompressionOptions { bits: self.bits };
        let count = self.coefficients;
        let (kept, curve) = session
            .run("compressing", |progress| {
                let laplacian = uniform_laplacian(&mesh)?;
                let ones = VertexMap::filled(mesh.vertex_count(), 1.0);
                let eigen = eigen_options(common);
                let part = progress.part(0.0, 0.9);
                let basis = Eigenbasis::new(&laplacian, &ones, count, &eigen, part)?;
                let counts = steps(count);
                let part = progress.part(0.9, 1.0);
                let curve = rate_distortion(&mesh, &basis, &counts, &options, part)?;
                Ok::<_, dgp::laplace::Error>((compress(&mesh, &basis, count, &options)?, curve))
            })
            .map_err(|failure| failure.in_file(&self.input.path))?;
        if let Some(path) = &self.csv {
            let names = ["coefficients", "bits_per_vertex", "distance", "roughness", "relative"];
            let rows = curve.iter().map(|p| {
                let k = p.coefficients as f64;
                vec![k, p.bits_per_vertex, p.distance, p.roughness, p.relative]
            });
            session.store(path, csv(&names, rows).as_bytes())?;
        }
        if let Some(path) = &self.plot {
            session.store(path, plot(&curve).to_svg().as_bytes())?;
        }
        mesh.set_positions(kept.positions);
        if let Some(output) = self.output.given() {
            document.set = mesh.to_indexed();
            session.write(&output, &document)?;
        }
        let last = curve[curve.len() - 1];
        let summary = format!(
            "{}: {count} coefficients of {} bits, {:.3} bits per vertex, off by {:.3e} \
             ({:.3e} of the diagonal)",
            self.input.path.display(),
            self.bits,
            last.bits_per_vertex,
            last.distance,
            last.relative,
        );
        let points: Vec<Value> = curve.iter().map(to_json).collect();
        session.finish(&summary, &json!({"step": kept.step, "curve": points}))?;
        Ok(ExitCode::SUCCESS)
    }
}

/// Numbers up to `count`, each about a quarter larger than the one before.
fn steps(count: usize) -> Vec<usize> {
    let mut steps = Vec::new();
    let mut k = 1;
    while k < count {
        steps.push(k);
        k += k.div_ceil(4);
    }
    steps.push(count);
    steps
}

fn plot(curve: &[RatePoint]) -> Plot {
    let points = |f: fn(&RatePoint) -> f64| {
        curve.iter().map(|p| [p.bits_per_vertex, f(p)]).collect::<Vec<_>>()
    };
    Plot {
        y_axis: Axis::Logarithmic,
        curves: vec![
            Curve::new("distance", points(|p| p.distance)),
            Curve::new("roughness", points(|p| p.roughness)),
        ],
        ..Plot::new("Rate and distortion", "bits per vertex", "error (units of length)")
    }
}

fn to_json(point: &RatePoint) -> Value {
    json!({
        "coefficients": point.coefficients,
        "bits_per_vertex": point.bits_per_vertex,
        "distance": point.distance,
        "roughness": point.roughness,
        "relative": point.relative,
    })
}
