//! `dgp curvature`: how much a surface bends at each vertex.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::mesh::{
    Mesh, Progress, VertexMap,
    curvature::{
        CurvatureReport, Neighborhood, PrincipalCurvatures, curvature_report, gaussian_curvatures,
        mean_curvatures, normal_cycle_curvatures, principal_curvatures,
    },
    measure::{Range, VertexArea, edge_lengths},
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, OptionalOutput},
    commands::scalars::{Pictured, color_vertices},
    failure::Failure,
    session::Session,
};

/// Options of `dgp curvature`.
///
/// The output has the vertex attributes `gaussian_curvature`, `mean_curvature`, `maximum_curvature`,
/// `minimum_curvature`, `maximum_direction`, `minimum_direction`, and colors that show the quantity asked for.
#[derive(Debug, Args)]
pub(crate) struct Curvature {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: OptionalOutput,
    #[command(flatten)]
    pictured: Pictured,
    /// Where principal curvatures come from
    #[arg(long, value_enum, default_value_t = Method::Rusinkiewicz)]
    method: Method,
    /// Length over which the normal cycle averages, in mean edge lengths
    #[arg(long, value_name = "X", default_value_t = 3.0)]
    radius: f64,
    /// What the colors show
    #[arg(long, value_enum, default_value_t = Quantity::Mean)]
    quantity: Quantity,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Method {
    /// Differences of normals in the faces around a vertex (Rusinkiewicz 2004)
    Rusinkiewicz,
    /// Bends of the edges within a distance: for noisy surfaces (Cohen-Steiner and Morvan 2003)
    NormalCycle,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Quantity {
    /// The product of the principal curvatures, by angle defects
    Gaussian,
    /// Their mean, by cotangents
    Mean,
    /// The larger one
    Maximum,
    /// The smaller one
    Minimum,
}

impl Curvature {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("curvature", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let found = session
            .run("measuring", |progress| self.measure(&mesh, progress))
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let Found { gaussian, mean, principal, report } = found;
        let shown = match self.quantity {
            Quantity::Gaussian => gaussian.clone(),
            Quantity::Mean => mean.clone(),
            Quantity::Maximum => principal.map(|k| k.max),
            Quantity::Minimum => principal.map(|k| k.min),
        };
        let name = match self.quantity {
            Quantity::Gaussian => "gaussian_curvature",
            Quantity::Mean => "mean_curvature",
            Quantity::Maximum => "maximum_curvature",
            Quantity::Minimum => "minimum_curvature",
        };
        let data = &mut mesh.attributes_mut().vertex;
        data.insert("gaussian_curvature", gaussian);
        data.insert("mean_curvature", mean);
        data.insert("maximum_curvature", principal.map(|k| k.max));
        data.insert("minimum_curvature", principal.map(|k| k.min));
        data.insert("maximum_direction", principal.map(|k| k.max_direction));
        data.insert("minimum_direction", principal.map(|k| k.min_direction));
        color_vertices(&mut mesh, &shown, dgp::view::ColorMap::CoolWarm, true);
        self.pictured.draw(&mut session, &mesh, shown, name)?;
        if let Some(output) = self.output.given() {
            document.set = mesh.to_indexed();
            session.write(&output, &document)?;
        }
        let summary = format!(
            "{}: total Gaussian curvature {:.9}, off 2πχ by {:.1e} (χ = {}); mean curvature {}",
            self.input.path.display(),
            report.total_gaussian,
            report.gauss_bonnet_error,
            report.euler_characteristic,
            words(report.mean.as_ref()),
        );
        session.finish(&summary, &to_json(&report))?;
        Ok(ExitCode::SUCCESS)
    }

    fn measure(&self, mesh: &Mesh, progress: Progress<'_>) -> Result<Found, Failure> {
        let principal = match self.method {
            Method::Rusinkiewicz => principal_curvatures(mesh)?,
            Method::NormalCycle => {
                let lengths = edge_lengths(mesh);
                let mean = lengths.values().iter().sum::<f64>() / lengths.len().max(1) as f64;
                let ball = Neighborhood::Ball(self.radius * mean);
                normal_cycle_curvatures(mesh, ball, progress)?
            }
        };
        Ok(Found {
            gaussian: gaussian_curvatures(mesh, VertexArea::MixedVoronoi)?,
            mean: mean_curvatures(mesh, VertexArea::MixedVoronoi)?,
            principal,
            report: curvature_report(mesh)?,
        })
    }
}

struct Found {
    gaussian: VertexMap<f64>,
    mean: VertexMap<f64>,
    principal: VertexMap<PrincipalCurvatures>,
    report: CurvatureReport,
}

fn words(range: Option<&Range>) -> String {
    range.map_or_else(
        || "of nothing".to_owned(),
        |range| format!("from {:.4e} to {:.4e}", range.min, range.max),
    )
}

fn to_json(report: &CurvatureReport) -> Value {
    let range =
        |range: Option<&Range>| range.map(|r| json!({"min": r.min, "mean": r.mean, "max": r.max}));
    json!({
        "total_gaussian": report.total_gaussian,
        "euler_characteristic": report.euler_characteristic,
        "gauss_bonnet_error": report.gauss_bonnet_error,
        "gaussian": range(report.gaussian.as_ref()),
        "mean": range(report.mean.as_ref()),
        "maximum": range(report.max.as_ref()),
        "minimum": range(report.min.as_ref()),
    })
}
