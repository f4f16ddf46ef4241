//! `dgp decimate`: fewer faces for the same shape.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    mesh::{
        EdgeSet, Mesh, Progress, VertexSet,
        measure::bounding_box,
        spatial::{HausdorffOptions, HausdorffReport, TriangleTree, hausdorff},
    },
    remesh::{
        self, Boundary, CurvatureCost, DecimationOptions, DecimationReport, LengthCost, Memory,
        Placement, QuadricCost, QuadricOptions, StopReason, Target, decimate, decimate_quadric,
        seam_edges, sharp_edges,
    },
};
use serde_json::{Value, json};

use super::before_after::{BeforeAfter, cut_polygons};
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
    /// Keep the result and the input that close to each other: a length, or a percentage of the diagonal of the
    /// input such as 0.1%; the report holds the bounds of the Hausdorff distance
    #[arg(long, value_name = "H", value_parser = amount)]
    max_hausdorff: Option<Amount>,
    /// Let all vertices be ones of the input (quadric)
    #[arg(long)]
    keep_positions: bool,
    /// How much data count: a difference of 1 in normals, colors of 0 to 1 and texture coordinates is as long as this
    /// part of the diagonal, such as 5% (quadric)
    #[arg(long, value_name = "W", value_parser = amount, conflicts_with = "max_hausdorff")]
    attribute_weight: Option<Amount>,
    /// Take a fraction of the time, and come out farther from the input (quadric)
    #[arg(long, conflicts_with_all = ["max_hausdorff", "polish"])]
    fast: bool,
    /// How often vertices move in the end to where the input is nearest; 1 unless told (quadric)
    #[arg(long, value_name = "N", conflicts_with = "max_hausdorff")]
    polish: Option<usize>,
    #[command(flatten)]
    pictured: BeforeAfter,
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
        let is_for_quadrics = self.fast || self.polish.is_some() || self.attribute_weight.is_some();
        if is_for_quadrics && self.cost != Cost::Quadric {
            let what = "--fast, --polish and --attribute-weight need --cost quadric";
            return Err(Failure::Usage(what.to_owned()));
        }
        let mut session = Session::new("decimate", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let in_file = |failure: Failure| failure.in_file(path);
        if self.is_of_triangles() {
            cut_polygons(&mut session, &self.input, &mut mesh)?;
        }
        let before = self.pictured.before(&mesh);
        let (report, bounds) = if let Some(limit) = self.max_hausdorff {
            let limit = limit.of(bounding_box(&mesh).map_or(0.0, |bounds| bounds.diagonal()));
            let found = session.run("decimating", |p| self.apply_within(&mut mesh, limit, p));
            let (report, bounds) = found.map_err(in_file)?;
            if bounds.is_some_and(|bounds| bounds.upper() > limit) {
                session.warn(format!(
                    "{}: that the distance stays below {limit:e} is not sure; see `hausdorff` in the report",
                    path.display()
                ));
            }
            (report, bounds)
        } else {
            let apply = |p: Progress<'_>| self.apply(&mut mesh, f64::INFINITY, p);
            (session.run("decimating", apply).map_err(in_file)?, None)
        };
        if report.stop == StopReason::NothingLeft && self.goal.error.is_none() {
            session.warn(format!(
                "{}: no collapse is left at {} faces; `refusals` in the report says why",
                path.display(),
                report.faces[1]
            ));
        }
        self.pictured.draw(&mut session, before.as_ref(), &mesh, &[])?;
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
        if let Some(bounds) = bounds {
            told["hausdorff"] = json!({"lower": bounds.lower(), "upper": bounds.upper()});
        }
        session.finish(&summary, &told)?;
        Ok(ExitCode::SUCCESS)
    }

    /// Whether nothing is asked for that needs the general decimator.
    fn is_of_triangles(&self) -> bool {
        self.cost == Cost::Quadric && self.max_hausdorff.is_none()
    }

    /// Decimates such that the Hausdorff distance is surely at most `limit`: vertices of the input are kept that close,
    /// then the distance is measured both ways, and where it is larger all begins anew with less.
    fn apply_within(
        &self,
        mesh: &mut Mesh,
        limit: f64,
        progress: Progress<'_>,
    ) -> Result<(DecimationReport, Option<HausdorffReport>), Failure> {
        /// Each costs a decimation; two are the rule.
        const TRIES: usize = 5;
        let diagonal = bounding_box(mesh).map_or(0.0, |bounds| bounds.diagonal());
        if mesh.face_count() == 0 || !(diagonal > 0.0) {
            return Ok((self.apply(mesh, limit, progress)?, None));
        }
        let input = TriangleTree::new(mesh, Progress::NONE)?;
        let tolerance = (0.02 * limit / diagonal).clamp(1e-6, 1e-2);
        let options = HausdorffOptions { tolerance, queries: 5_000_000 };
        let (mut inner, mut tries) = (limit, 0);
        loop {
            let part = |from: f64, to: f64| {
                let share = |x: f64| (tries as f64 + x) / TRIES as f64;
                progress.part(share(from), share(to))
            };
            let mut copy = mesh.clone();
            let report = self.apply(&mut copy, inner, part(0.0, 0.7))?;
            let result = TriangleTree::new(&copy, Progress::NONE)?;
            let bounds = hausdorff(&input, &result, &options, part(0.7, 1.0))?;
            tries += 1;
            if bounds.upper() <= limit || tries == TRIES {
                *mesh = copy;
                return Ok((report, Some(bounds)));
            }
            inner *= (0.95 * limit / bounds.upper()).min(0.9);
        }
    }

    fn apply(
        &self,
        mesh: &mut Mesh,
        max_distance: f64,
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
        if self.is_of_triangles() {
            let start = if self.fast { QuadricOptions::fast() } else { QuadricOptions::default() };
            let mut options = QuadricOptions { boundary, ..start };
            if let Some(weight) = self.attribute_weight {
                options.attribute_weight = weight.of(1.0);
            }
            if let Some(rounds) = self.polish {
                options.polish = rounds;
            }
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
