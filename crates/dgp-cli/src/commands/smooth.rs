//! `dgp smooth`: removes noise.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    laplace::{
        self,
        smooth::{
            Boundary, NeighborWeight, SmoothReport, TangentialOptions, TaubinOptions,
            UniformOptions, Volume, tangential, taubin, uniform,
        },
    },
    mesh::{Mesh, Progress, VertexSet},
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp smooth`.
#[derive(Debug, Args)]
pub(crate) struct Smooth {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    smoothing: Smoothing,
}

/// How to smooth.
#[derive(Clone, Debug, Args)]
pub(crate) struct Smoothing {
    /// How to smooth
    #[arg(long, value_enum, default_value_t = Method::Taubin)]
    pub(crate) method: Method,
    /// How often
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub(crate) iterations: usize,
    /// λ, the part of the way to the mean of its neighbors that a vertex moves; by default that of
    /// the method
    #[arg(long, value_name = "X")]
    pub(crate) lambda: Option<f64>,
    /// The frequency below which a wave is shape (Taubin)
    #[arg(long, value_name = "K")]
    pub(crate) pass_band: Option<f64>,
    /// What becomes of the boundary
    #[arg(long, value_enum, default_value_t = BoundaryRule::Fixed)]
    pub(crate) boundary: BoundaryRule,
    /// Weigh neighbors by area, so that areas even out (tangential)
    #[arg(long)]
    pub(crate) by_area: bool,
    /// Scale a closed surface back to its volume
    #[arg(long)]
    pub(crate) keep_volume: bool,
}

/// A method of smoothing.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Method {
    /// Toward the mean of the neighbors: smooths and shrinks
    Uniform,
    /// Forth and back: smooths without shrinking (Taubin 1995)
    Taubin,
    /// Along the surface: evens out triangles, keeps the shape
    Tangential,
}

/// What becomes of the boundary.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum BoundaryRule {
    /// It stays
    Fixed,
    /// It is smoothed as a curve of its own
    Curve,
    /// It moves like the rest
    Free,
}

impl Smooth {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("smooth", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let report = session.run("smoothing", |p| self.smoothing.apply(&mut mesh, p))?;
        document.set = mesh.to_indexed();
        session.write(&self.output, &document)?;
        let summary = format!(
            "{} → {}: {} iterations, moved {:.3e} on average and {:.3e} at most",
            self.input.path.display(),
            self.output.path.display(),
            report.iterations,
            report.mean_displacement,
            report.max_displacement,
        );
        session.finish(&summary, &to_json(&report))?;
        Ok(ExitCode::SUCCESS)
    }
}

impl Smoothing {
    fn apply(
        &self,
        mesh: &mut Mesh,
        progress: Progress<'_>,
    ) -> Result<SmoothReport, laplace::Error> {
        let Smoothing { iterations, boundary, .. } = *self;
        let boundary = match boundary {
            BoundaryRule::Fixed => Boundary::Fixed,
            BoundaryRule::Curve => Boundary::Curve,
            BoundaryRule::Free => Boundary::Free,
        };
        let volume = if self.keep_volume { Volume::Keep } else { Volume::MayChange };
        let fixed = VertexSet::new();
        match self.method {
            Method::Uniform => {
                let default = UniformOptions::default();
                let lambda = self.lambda.unwrap_or(default.lambda);
                let options = UniformOptions { iterations, lambda, boundary, volume };
                uniform(mesh, &fixed, &options, progress)
            }
            Method::Taubin => {
                let default = TaubinOptions::default();
                let lambda = self.lambda.unwrap_or(default.lambda);
                let pass_band = self.pass_band.unwrap_or(default.pass_band);
                let options = TaubinOptions { iterations, lambda, pass_band, boundary, volume };
                taubin(mesh, &fixed, &options, progress)
            }
            Method::Tangential => {
                let default = TangentialOptions::default();
                let lambda = self.lambda.unwrap_or(default.lambda);
                let weight =
                    if self.by_area { NeighborWeight::Area } else { NeighborWeight::Equal };
                let options = TangentialOptions { iterations, lambda, weight, boundary, volume };
                tangential(mesh, &fixed, &options, progress)
            }
        }
    }
}

fn to_json(report: &SmoothReport) -> Value {
    json!({
        "iterations": report.iterations,
        "free_vertices": report.free_vertices,
        "volume_before": report.volume_before,
        "volume_after": report.volume_after,
        "mean_displacement": report.mean_displacement,
        "max_displacement": report.max_displacement,
    })
}
