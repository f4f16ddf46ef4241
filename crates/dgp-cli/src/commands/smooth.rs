//! `dgp smooth`: removes noise.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    laplace::{
        self,
        flow::{FlowKind, FlowOptions, FlowSize, mean_curvature_flow},
        smooth::{
            BilateralOptions, BilateralScheme, Boundary, CotangentOptions, ImplicitOptions,
            ImplicitWeight, NeighborWeight, SmoothReport, TangentialOptions, TaubinOptions,
            UniformOptions, Volume, bilateral, cotangent, implicit, tangential, taubin, uniform,
        },
    },
    mesh::{
        Mesh, Progress, VertexSet,
        measure::{edge_length_range, volume},
        topology::boundary_loops,
    },
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
    /// How often; for bilateral smoothing how often normals are filtered
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub(crate) iterations: usize,
    /// λ, the part of the way to the mean of its neighbors that a vertex moves; for implicit smoothing
    /// and flows the time of a step in squares of the mean edge length; by default that of the method
    #[arg(long, value_name = "X")]
    pub(crate) lambda: Option<f64>,
    /// The frequency below which a wave is shape (Taubin)
    #[arg(long, value_name = "K")]
    pub(crate) pass_band: Option<f64>,
    /// What becomes of the boundary
    #[arg(long, value_enum, default_value_t = BoundaryRule::Fixed)]
    pub(crate) boundary: BoundaryRule,
    /// How much unit normals differ at an edge of the shape that is to stay (bilateral)
    #[arg(long, value_name = "X")]
    pub(crate) sigma: Option<f64>,
    /// Filter all normals at once, this close to the given ones: from 0 to 1 (bilateral)
    #[arg(long, value_name = "MU")]
    pub(crate) global: Option<f64>,
    /// Let neighbors count the same instead of by cotangents (implicit)
    #[arg(long)]
    pub(crate) uniform_weights: bool,
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
    /// Against the curvature: smooths and shrinks, and leaves the spacing as it is
    Cotan,
    /// Large steps at once by solving for where they lead (Desbrun 1999)
    Implicit,
    /// Within the faces of the shape; its edges stay (Zheng 2011)
    Bilateral,
    /// By mean curvature, weights anew in each step: convex shapes become round points
    Flow,
    /// The same by the angles of the beginning: no necks pinch off (Kazhdan 2012)
    Conformal,
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
            Method::Cotan => {
                let lambda = self.lambda.unwrap_or(CotangentOptions::default().lambda);
                let options = CotangentOptions { iterations, lambda, boundary, volume };
                cotangent(mesh, &fixed, &options, progress)
            }
            Method::Implicit => {
                let lambda = self.lambda.unwrap_or(ImplicitOptions::default().lambda);
                let weight = if self.uniform_weights {
                    ImplicitWeight::Uniform
                } else {
                    ImplicitWeight::Cotangent
                };
                let options = ImplicitOptions { iterations, lambda, weight, boundary, volume };
                implicit(mesh, &fixed, &options, progress)
            }
            Method::Bilateral => {
                let default = BilateralOptions::default();
                let scheme = match self.global {
                    Some(fidelity) => BilateralScheme::Global { fidelity },
                    None => BilateralScheme::Local { iterations },
                };
                let sigma = self.sigma.unwrap_or(default.sigma);
                let options = BilateralOptions { scheme, sigma, boundary, volume, ..default };
                bilateral(mesh, &fixed, &options, progress)
            }
            Method::Flow => self.flow(mesh, FlowKind::MeanCurvature, progress),
            Method::Conformal => self.flow(mesh, FlowKind::Conformalized, progress),
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

impl Smoothing {
    /// The flow, told as a smoothing; `--keep-volume` keeps the area instead.
    fn flow(
        &self,
        mesh: &mut Mesh,
        kind: FlowKind,
        progress: Progress<'_>,
    ) -> Result<SmoothReport, laplace::Error> {
        let size = if self.keep_volume { FlowSize::KeepsArea } else { FlowSize::Shrinks };
        let edge = edge_length_range(mesh).map_or(0.0, |range| range.mean);
        let time = self.lambda.unwrap_or(1.0) * edge * edge;
        let options = FlowOptions { steps: self.iterations, kind, size };
        let (before, volume_before) = (mesh.positions().clone(), closed_volume(mesh));
        let report = mean_curvature_flow(mesh, &VertexSet::new(), time, &options, progress)?;
        let moved = mesh.vertices().map(|v| (mesh.position(v) - before[v]).length());
        let moved: Vec<f64> = moved.collect();
        Ok(SmoothReport {
            iterations: report.steps,
            free_vertices: report.free_vertices,
            volume_before,
            volume_after: closed_volume(mesh),
            mean_displacement: moved.iter().sum::<f64>() / moved.len().max(1) as f64,
            max_displacement: moved.iter().copied().fold(0.0, f64::max),
        })
    }
}

fn closed_volume(mesh: &Mesh) -> Option<f64> {
    boundary_loops(mesh).is_empty().then(|| volume(mesh))
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
