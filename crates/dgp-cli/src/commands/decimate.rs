//! `dgp decimate`: fewer faces for the same shape.

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::{
    mesh::{
        EdgeSet, Mesh, Progress, TriangulationMethod, VertexSet, measure::bounding_box, triangulate,
    },
    remesh::{
        self, Boundary, CurvatureCost, DecimationOptions, DecimationReport, LengthCost, Memory,
        Placement, QuadricCost, QuadricOptions, StopReason, Target, decimate, decimate_quadric,
        seam_edges, sharp_edges,
    },
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp decimate`.
///
/// Texture coordinates keep their seams; groups, colors and other data travel.
#[derive(Debug, Args)]
pub(crate) struct Decimate {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    goal: Goal,
    /// What orders collapses
    #[arg(long, value_enum, default_value_t = Cost::Quadric)]
    cost: Cost,
    /// Leave the rims of holes as they are
    #[arg(long)]
    keep_boundary: bool,
    /// Keep edges sharp at which the normals of faces differ by more than DEG degrees
    #[arg(long, value_name = "DEG", value_parser = degrees)]
    feature_angle: Option<f64>,
    /// Keep every vertex of the input that close to the result: a length, or a percentage of the diagonal of the
    /// input such as 0.1%
    #[arg(long, value_name = "H", value_parser = amount)]
    max_hausdorff: Option<Amount>,
    /// Let all vertices be ones of the input (quadric)
    #[arg(long)]
    keep_positions: bool,
    /// Draw the mesh before and after into a PNG
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

/// Where to stop.
#[derive(Clone, Debug, Args)]
#[group(required = true, multiple = false)]
struct Goal {
    /// Stop at N faces, or at P% of those there are
    #[arg(long, value_name = "N|P%", value_parser = amount)]
    faces: Option<Amount>,
    /// Stop at N vertices, or at P% of those there are
    #[arg(long, value_name = "N|P%", value_parser = amount)]
    vertices: Option<Amount>,
    /// Stop before a collapse of a larger error: a length, or a percentage of the diagonal of the input
    #[arg(long, value_name = "E", value_parser = amount)]
    error: Option<Amount>,
}

/// What orders collapses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Cost {
    /// Squared distances to planes (Garland and Heckbert 1997; Lindstrom and Turk 1998)
    Quadric,
    /// Length of edges
    Length,
    /// Length times curvature (Melax 1998)
    Curvature,
}

/// A number, or a percentage of something.
#[derive(Clone, Copy, Debug)]
pub(super) enum Amount {
    Number(f64),
    Share(f64),
}

impl Amount {
    pub(super) fn of(self, whole: f64) -> f64 {
        match self {
            Amount::Number(x) => x,
            Amount::Share(share) => share * whole,
        }
    }

    pub(super) fn count(self, whole: usize) -> usize {
        self.of(whole as f64).floor() as usize
    }
}

/// A number that is not negative, with or without a percent sign.
pub(super) fn amount(text: &str) -> Result<Amount, String> {
    let (number, is_share) = match text.strip_suffix('%') {
        Some(number) => (number, true),
        None => (text, false),
    };
    match number.trim().parse::<f64>() {
        Ok(x) if x >= 0.0 && x.is_finite() && is_share => Ok(Amount::Share(x / 100.0)),
        Ok(x) if x >= 0.0 && x.is_finite() => Ok(Amount::Number(x)),
        _ => Err(format!("`{text}` is neither a number from 0 nor a percentage such as 10%")),
    }
}

pub(super) fn degrees(text: &str) -> Result<f64, String> {
    let found = text.parse::<f64>().ok().filter(|x| (0.0..=180.0).contains(x));
    found.ok_or_else(|| format!("`{text}` is no angle from 0 to 180 degrees"))
}

impl Decimate {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("decimate", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let in_file = |failure: Failure| failure.in_file(path);
        if self.is_fast() && mesh.faces().any(|f| mesh.degree(f) != 3) {
            session.warn(format!("{}: polygons are cut into triangles first", path.display()));
            session
                .run("triangulating", |p| triangulate(&mut mesh, TriangulationMethod::default(), p))
                .map_err(in_file)?;
        }
        let before = self.picture.is_some().then(|| mesh.clone());
        let report = session.run("decimating", |p| self.apply(&mut mesh, p)).map_err(in_file)?;
        if report.stop == StopReason::NothingLeft && self.goal.error.is_none() {
            session.warn(format!(
                "{}: no collapse is left at {} faces; `refusals` in the report says why",
                path.display(),
                report.faces[1]
            ));
        }
        if let (Some(picture), Some(before)) = (&self.picture, before) {
            let png = session.run("drawing", |p| picture_of([&before, &mesh], p))?;
            session.store(picture, &png)?;
        }
        document.set = mesh.to_indexed();
        session.write(&self.output, &document)?;
        let summary = format!(
            "{} → {}: {} → {} vertices, {} → {} faces, largest error {:.3e}",
            path.display(),
            self.output.path.display(),
            report.vertices[0],
            report.vertices[1],
            report.faces[0],
            report.faces[1],
            report.largest_error,
        );
        let mut told = to_json(&report);
        told["cost"] = json!(self.cost.to_possible_value().map(|v| v.get_name().to_owned()));
        session.finish(&summary, &told)?;
        Ok(ExitCode::SUCCESS)
    }

    /// Whether nothing is asked for that needs the general decimator.
    fn is_fast(&self) -> bool {
        self.cost == Cost::Quadric && self.max_hausdorff.is_none()
    }

    fn apply(
        &self,
        mesh: &mut Mesh,
        progress: Progress<'_>,
    ) -> Result<DecimationReport, remesh::Error> {
        let diagonal = bounding_box(mesh).map_or(0.0, |bounds| bounds.diagonal());
        let target = match (&self.goal.faces, &self.goal.vertices, &self.goal.error) {
            (Some(faces), _, _) => Target::Faces(faces.count(mesh.face_count())),
            (_, Some(vertices), _) => Target::Vertices(vertices.count(mesh.vertex_count())),
            (_, _, error) => Target::Error(error.map_or(0.0, |error| error.of(diagonal))),
        };
        let boundary = if self.keep_boundary { Boundary::Kept } else { Boundary::Weighted };
        let fixed = VertexSet::new();
        let angle = self.feature_angle.map(f64::to_radians);
        if self.is_fast() {
            let mut options = QuadricOptions { boundary, ..QuadricOptions::default() };
            if let Some(angle) = angle {
                options.feature_angle = angle;
            }
            if self.keep_positions {
                options.placement = Placement::Ends;
            }
            // Errors add up, so that they must be known from the input on.
            if self.goal.error.is_some() {
                options.memory = Memory::Kept;
            }
            return decimate_quadric(mesh, target, &fixed, &options, progress);
        }
        let max_distance = self.max_hausdorff.map_or(f64::INFINITY, |limit| limit.of(diagonal));
        let options = DecimationOptions { boundary, max_distance, ..DecimationOptions::default() };
        let mut features: EdgeSet = seam_edges(mesh);
        if let Some(angle) = angle {
            features.extend(sharp_edges(mesh, angle).iter());
        }
        let kept = (&fixed, &features);
        match self.cost {
            Cost::Quadric => {
                let mut cost = QuadricCost::new(mesh, 1.0);
                decimate(mesh, target, &mut cost, kept, &options, progress)
            }
            Cost::Length => decimate(mesh, target, &mut LengthCost, kept, &options, progress),
            Cost::Curvature => decimate(mesh, target, &mut CurvatureCost, kept, &options, progress),
        }
    }
}

fn to_json(report: &DecimationReport) -> Value {
    let refusals = report.refusals;
    json!({
        "vertices": report.vertices,
        "faces": report.faces,
        "collapses": report.collapses,
        "largest_error": report.largest_error,
        "stop": match report.stop {
            StopReason::TargetReached => "target reached",
            StopReason::NothingLeft => "nothing left",
        },
        "refusals": {
            "topology": refusals.topology,
            "flipped": refusals.flipped,
            "protected": refusals.protected,
            "error": refusals.error,
            "shape": refusals.shape,
            "distance": refusals.distance,
        },
    })
}

/// The mesh before and after, side by side.
pub(super) fn picture_of(
    meshes: [&Mesh; 2],
    progress: Progress<'_>,
) -> Result<Vec<u8>, dgp::view::Error> {
    use dgp::view::{Framing, Model, Panel, RenderOptions, Scene, Stroke, Style, render};
    /// More faces than this make a wireframe black.
    const WIRED: usize = 20_000;
    let [before, after] = meshes;
    let panels = [("before", before), ("after", after)].map(|(name, mesh)| {
        let wireframe = if mesh.face_count() > WIRED { Stroke::NONE } else { Stroke::THIN };
        let style = Style { wireframe, boundary: Stroke::BOLD, ..Style::faceted() };
        Panel::new(
            format!("{name}: {} faces", mesh.face_count()),
            Model { style, ..Model::new(mesh) },
        )
    });
    let scene = Scene { panels: panels.into() };
    let framing = Framing::Shared;
    let options = RenderOptions { width: 1200, height: 600, framing, ..RenderOptions::default() };
    Ok(render(&scene, &options, progress)?.0.to_png())
}
