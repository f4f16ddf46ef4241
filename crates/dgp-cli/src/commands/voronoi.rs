//! `dgp voronoi`: a new triangulation by centroidal Voronoi cells.

use std::process::ExitCode;

use clap::Args;
use dgp::remesh::{VoronoiOptions, VoronoiPlacement, VoronoiReport, voronoi_remesh};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, Output},
    commands::{
        before_after::{BeforeAfter, cut_polygons},
        decimate::{Amount, amount},
    },
    failure::Failure,
    session::Session,
};

/// Options of `dgp voronoi`.
///
/// Centroidal Voronoi remeshing: vertices evenly spread over the surface, nearly equal triangles, the same topology. Data
/// of vertices and faces travel; those of corners do where they do not jump between faces.
#[derive(Debug, Args)]
pub(crate) struct Voronoi {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// Have N vertices, or P% of those there are; a few more where the topology needs them
    #[arg(long, value_name = "N|P%", value_parser = amount)]
    vertices: Amount,
    /// Denser where the surface bends: 0 nowhere, 1.5 much
    #[arg(long, value_name = "GAMMA", default_value_t = 0.0)]
    gradation: f64,
    /// Put vertices onto sharp edges and into corners where a cell has them
    #[arg(long)]
    sharp: bool,
    /// Refine the input to so many vertices for each of the result at least
    #[arg(long, value_name = "N", default_value_t = VoronoiOptions::default().resolution)]
    resolution: f64,
    #[command(flatten)]
    pictured: BeforeAfter,
}

impl Voronoi {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("voronoi", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let in_file = |failure: Failure| failure.in_file(path);
        cut_polygons(&mut session, &self.input, &mut mesh)?;
        let options = VoronoiOptions {
            seed: common.seed,
            resolution: self.resolution,
            gradation: self.gradation,
            placement: if self.sharp { VoronoiPlacement::Sharp } else { VoronoiPlacement::Mean },
            ..VoronoiOptions::default()
        };
        let count = self.vertices.count(mesh.vertex_count());
        let (result, report) = session
            .run("remeshing", |p| voronoi_remesh(&mesh, count, &options, p))
            .map_err(in_file)?;
        if !report.dropped.is_empty() {
            session.warn(format!(
                "{}: no place for {}: values of edges, or of corners that jump between faces",
                path.display(),
                report.dropped.join(", ")
            ));
        }
        self.pictured.draw(&mut session, Some(&mesh), &result, &[])?;
        document.set = result.to_indexed();
        // Lines, points and tags name vertices that are gone.
        let comments = std::mem::take(&mut document.comments);
        let document = dgp::io::Document { comments, ..dgp::io::Document::from(document.set) };
        session.write(&self.output, &document)?;
        let summary = format!(
            "{} → {}: {} → {} vertices, angles from {:.1}°, {:.1}° on average, {:.0} % of valence 6",
            path.display(),
            self.output.path.display(),
            report.vertices[0],
            report.vertices[1],
            report.minimum_angle.to_degrees(),
            report.mean_minimum_angle.to_degrees(),
            100.0 * report.regular,
        );
        session.finish(&summary, &to_json(&report))?;
        Ok(ExitCode::SUCCESS)
    }
}

fn to_json(report: &VoronoiReport) -> Value {
    json!({
        "vertices": report.vertices,
        "faces": report.faces,
        "refined": report.refined,
        "energy": report.energy,
        "moves": report.moves,
        "splits": report.splits,
        "topology_kept": report.topology_kept,
        "minimum_angle": report.minimum_angle.to_degrees(),
        "mean_minimum_angle": report.mean_minimum_angle.to_degrees(),
        "regular": report.regular,
        "dropped": report.dropped,
    })
}
