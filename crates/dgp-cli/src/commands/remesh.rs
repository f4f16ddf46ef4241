//! `dgp remesh`: triangles nearly equilateral, of one size or as fine as the shape needs.

use std::{fmt::Write, process::ExitCode};

use clap::Args;
use dgp::{
    mesh::{
        EdgeId, EdgeSet, GROUP, Label, MATERIAL, Mesh, OBJECT, Progress, VertexSet,
        measure::{bounding_box, edge_length_range},
        spatial::{
            Deviation, DeviationOptions, HausdorffOptions, HausdorffReport, TriangleTree,
            deviation, hausdorff,
        },
    },
    remesh::{
        self, AdaptiveOptions, RemeshOptions, RemeshReport, Rims, TriangleQuality, remesh_adaptive,
        remesh_isotropic, seam_edges, sharp_edges,
    },
};
use serde_json::{Value, json};

use super::{
    before_after::{BeforeAfter, cut_polygons},
    decimate::{Amount, amount, degrees},
};
use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp remesh`.
///
/// Without options edges get the length that they have in the mean. Seams of texture coordinates and borders of
/// groups, objects and materials are kept as lines; data of vertices, corners and faces are taken from the input.
#[derive(Debug, Args)]
pub(crate) struct Remesh {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    goal: Goal,
    /// How often to split, collapse, flip and relax
    #[arg(long, value_name = "N", default_value_t = RemeshOptions::default().iterations)]
    iterations: usize,
    /// Keep edges sharp at which the normals of faces differ by more than DEG degrees
    #[arg(long, value_name = "DEG", value_parser = degrees)]
    feature_angle: Option<f64>,
    /// Keep the edges sharp that the file marks as creases (the tag `crease` of OBJ)
    #[arg(long)]
    features: bool,
    /// Keep vertices at which sharp lines and rims turn by more than DEG degrees
    #[arg(long, value_name = "DEG", value_parser = degrees, default_value = "45")]
    corner_angle: f64,
    /// Leave the rims of holes as they are
    #[arg(long)]
    keep_boundary: bool,
    /// The shortest edge wanted with --adaptive: a length, or a percentage of the diagonal of the input
    #[arg(long, value_name = "L", value_parser = amount, requires = "adaptive")]
    min_edge: Option<Amount>,
    /// The longest edge wanted with --adaptive: a length, or a percentage of the diagonal of the input
    #[arg(long, value_name = "L", value_parser = amount, requires = "adaptive")]
    max_edge: Option<Amount>,
    /// By how much the length wanted may grow over a distance of one with --adaptive
    #[arg(long, value_name = "X", requires = "adaptive")]
    gradation: Option<f64>,
    /// Measure how far the result is from the input
    #[arg(long)]
    measure: bool,
    #[command(flatten)]
    pictured: BeforeAfter,
}

/// How long edges should be.
#[derive(Clone, Debug, Args)]
#[group(multiple = false)]
struct Goal {
    /// Edges of length L, or of F times the mean one: 0.5x
    #[arg(long, value_name = "L|Fx", value_parser = length)]
    edge: Option<Length>,
    /// Edges as long as a distance of ERR from the input allows: a length, or a percentage of the diagonal such as
    /// 0.1%
    #[arg(long, value_name = "ERR", value_parser = amount)]
    adaptive: Option<Amount>,
}

/// A length, or so many times the mean one.
#[derive(Clone, Copy, Debug)]
enum Length {
    Of(f64),
    Times(f64),
}

fn length(text: &str) -> Result<Length, String> {
    let (number, is_factor) = match text.strip_suffix('x') {
        Some(number) => (number, true),
        None => (text, false),
    };
    match number.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() && is_factor => Ok(Length::Times(x)),
        Ok(x) if x > 0.0 && x.is_finite() => Ok(Length::Of(x)),
        _ => Err(format!("`{text}` is neither a positive length nor a factor such as 0.5x")),
    }
}

impl Remesh {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("remesh", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let in_file = |failure: Failure| failure.in_file(path);
        let mut features = EdgeSet::new();
        if self.features {
            for ([v, w], _) in
                document.subdivision_rules()?.creases.into_iter().filter(|(_, s)| *s > 0.0)
            {
                let no_edge = Failure::NotAnEdge { vertices: [v, w] };
                features
                    .insert(mesh.halfedge_between(v, w).ok_or(no_edge).map_err(in_file)?.edge());
            }
        }
        // Edges stay and keep their numbers.
        cut_polygons(&mut session, &self.input, &mut mesh)?;
        let before = if self.measure { Some(mesh.clone()) } else { self.pictured.before(&mesh) };
        let report =
            session.run("remeshing", |p| self.apply(&mut mesh, features, p)).map_err(in_file)?;
        self.warn(&mut session, &report);
        let mut told = to_json(&report);
        if let (true, Some(before)) = (self.measure, &before) {
            let distance = session.run("measuring", |p| measured([&mesh, before], p))?;
            told["distance"] = distance;
        }
        self.pictured.draw(&mut session, before.as_ref(), &mesh, &[])?;
        document.set = mesh.to_indexed();
        session.write(&self.output, &document)?;
        session.finish(&self.summary(&report, &told), &told)?;
        Ok(ExitCode::SUCCESS)
    }

    fn apply(
        &self,
        mesh: &mut Mesh,
        mut features: EdgeSet,
        progress: Progress<'_>,
    ) -> Result<RemeshReport, remesh::Error> {
        features.extend(seam_edges(mesh).iter());
        features.extend(borders(mesh).iter());
        if let Some(angle) = self.feature_angle {
            features.extend(sharp_edges(mesh, angle.to_radians()).iter());
        }
        let kept = (&VertexSet::new(), &features);
        let options = RemeshOptions {
            iterations: self.iterations,
            rims: if self.keep_boundary { Rims::Kept } else { Rims::Resampled },
            corner_angle: self.corner_angle.to_radians(),
        };
        let diagonal = bounding_box(mesh).map_or(0.0, |bounds| bounds.diagonal());
        if let Some(tolerance) = self.goal.adaptive {
            let tolerance = tolerance.of(diagonal);
            let default = AdaptiveOptions::default();
            let options = AdaptiveOptions {
                remesh: options,
                shortest: self.min_edge.map_or(default.shortest, |l| l.of(diagonal) / tolerance),
                longest: self.max_edge.map_or(default.longest, |l| l.of(diagonal) / diagonal),
                gradation: self.gradation.unwrap_or(default.gradation),
                ..default
            };
            return remesh_adaptive(mesh, tolerance, kept, &options, progress);
        }
        let mean = edge_length_range(mesh).map_or(0.0, |lengths| lengths.mean);
        let length = match self.goal.edge {
            Some(Length::Of(length)) => length,
            Some(Length::Times(factor)) => factor * mean,
            None => mean,
        };
        remesh_isotropic(mesh, length, kept, &options, progress)
    }

    fn warn(&self, session: &mut Session<'_>, report: &RemeshReport) {
        let path = self.input.path.display();
        let edges = 3 * report.faces[1] / 2;
        if report.distance.is_some_and(|distance| !distance.is_within_tolerance) {
            session.warn(format!(
                "{path}: the result may be further from the input than asked for; lower --min-edge, or raise \
                 --iterations"
            ));
        }
        if report.short_edges > edges / 4 {
            session.warn(format!(
                "{path}: {} edges are shorter than 4/5 of the length wanted, since corners, lines or the smallest \
                 closed surfaces cannot have fewer",
                report.short_edges
            ));
        }
        if report.long_edges > edges / 4 {
            session.warn(format!(
                "{path}: {} edges are longer than 4/3 of the length wanted; raise --iterations",
                report.long_edges
            ));
        }
    }

    fn summary(&self, report: &RemeshReport, told: &Value) -> String {
        let [before, after] = &report.quality;
        let angles = |quality: &TriangleQuality| {
            [quality.minimum_angle, quality.low_angle, quality.mean_minimum_angle]
                .map(f64::to_degrees)
        };
        let ([a, b, c], [x, y, z]) = (angles(before), angles(after));
        let mut summary = format!(
            "{} → {}: {} → {} vertices, {} → {} faces\n\
             smallest angle {a:.1}° → {x:.1}°, of 99 % of the faces {b:.1}° → {y:.1}°, in the mean {c:.1}° → {z:.1}°\n\
             six edges at {:.1} % → {:.1} % of the vertices inside",
            self.input.path.display(),
            self.output.path.display(),
            report.vertices[0],
            report.vertices[1],
            report.faces[0],
            report.faces[1],
            100.0 * before.regular_share,
            100.0 * after.regular_share,
        );
        let distance = &told["distance"];
        if let (Some(lower), Some(upper)) = (distance["lower"].as_f64(), distance["upper"].as_f64())
        {
            let _ = write!(summary, "\nHausdorff distance from {lower:.6e} to {upper:.6e}");
        }
        summary
    }
}

/// The edges between faces of different groups, objects or materials.
fn borders(mesh: &Mesh) -> EdgeSet {
    let mut borders = EdgeSet::new();
    for name in [GROUP, OBJECT, MATERIAL] {
        let Some(labels) = mesh.attributes().face.get::<Label>(name) else { continue };
        borders.extend(mesh.edges().filter(|&e: &EdgeId| {
            let [left, right] = mesh.edge_faces(e);
            left.zip(right).is_some_and(|(f, g)| labels[f] != labels[g])
        }));
    }
    borders
}

/// How far the first mesh is from the second.
fn measured(meshes: [&Mesh; 2], progress: Progress<'_>) -> Result<Value, dgp::mesh::Error> {
    let a = TriangleTree::new(meshes[0], progress.part(0.0, 0.1))?;
    let b = TriangleTree::new(meshes[1], progress.part(0.1, 0.2))?;
    if a.is_empty() || b.is_empty() {
        return Ok(Value::Null);
    }
    let hausdorff: HausdorffReport =
        hausdorff(&a, &b, &HausdorffOptions::default(), progress.part(0.2, 0.8))?;
    let options = DeviationOptions::default();
    let forward: Deviation = deviation(&a, &b, &options, progress.part(0.8, 0.9))?;
    let backward: Deviation = deviation(&b, &a, &options, progress.part(0.9, 1.0))?;
    Ok(json!({
        "lower": hausdorff.lower(),
        "upper": hausdorff.upper(),
        "mean": forward.mean.max(backward.mean),
        "rms": forward.rms.max(backward.rms),
    }))
}

fn to_json(report: &RemeshReport) -> Value {
    json!({
        "vertices": report.vertices,
        "faces": report.faces,
        "splits": report.splits,
        "collapses": report.collapses,
        "flips": report.flips,
        "lines": report.lines,
        "corners": report.corners,
        "short_edges": report.short_edges,
        "long_edges": report.long_edges,
        "quality": report.quality.map(|quality| json!({
            "minimum_angle": quality.minimum_angle,
            "low_angle": quality.low_angle,
            "mean_minimum_angle": quality.mean_minimum_angle,
            "regular_share": quality.regular_share,
            "edge_length": quality.edge_length.map(|length| json!({
                "min": length.min, "mean": length.mean, "max": length.max,
            })),
        })),
        "distance": report.distance.map(|distance| json!({
            "lower": distance.lower,
            "upper": distance.upper,
            "within_tolerance": distance.is_within_tolerance,
            "corrections": distance.corrections,
        })),
    })
}
