//! `dgp fill`: closes holes.

use std::{fmt::Write, process::ExitCode};

use clap::Args;
use dgp::{
    mesh::Color,
    remesh::{FillOptions, FillReport, HoleOutcome, LongestRim, Patch, fill_holes},
    view::{Mark, Marked},
};
use serde_json::{Value, json};

use super::before_after::BeforeAfter;
use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp fill`.
///
/// Without options holes are filled with as few triangles as there can be, such that neighbors bend least.
/// What was there keeps its numbers; new faces continue the data around them.
#[derive(Debug, Args)]
pub(crate) struct Fill {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// Fill holes of up to N edges only
    #[arg(long, value_name = "N")]
    max_edges: Option<usize>,
    /// Keep the longest rim open: it is where a scan ends
    #[arg(long)]
    keep_longest: bool,
    /// Triangles as small as those around
    #[arg(long)]
    refine: bool,
    /// A smooth surface of triangles as small as those around
    #[arg(long)]
    fair: bool,
    /// How much longer than those around edges of `--refine` and `--fair` may be
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    density: Option<f64>,
    #[command(flatten)]
    pictured: BeforeAfter,
}

fn factor(text: &str) -> Result<f64, String> {
    let found = text.parse::<f64>().ok().filter(|x| *x >= 0.1 && x.is_finite());
    found.ok_or_else(|| format!("`{text}` is no number from 0.1"))
}

impl Fill {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("fill", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let before = self.pictured.before(&mesh);
        let options = self.options();
        let report = session
            .run("filling", |progress| fill_holes(&mut mesh, &options, progress))
            .map_err(|failure| failure.in_file(path))?;
        let impossible = report.count(HoleOutcome::NoTriangulation);
        if impossible > 0 {
            session.warn(format!(
                "{}: {impossible} holes stay open, since the edges that could fill them are there already",
                path.display()
            ));
        }
        let fresh = Mark {
            elements: Marked::Faces(report.faces.clone()),
            color: Color::from_rgb8([0xe8, 0x9c, 0x3f]),
            width: 1.0,
        };
        self.pictured.draw(&mut session, before.as_ref(), &mesh, &[fresh])?;
        document.set = mesh.to_indexed();
        session.write(&self.output, &document)?;
        let mut summary = format!(
            "{} → {}: {} of {} holes filled with {} faces",
            path.display(),
            self.output.path.display(),
            report.count(HoleOutcome::Filled),
            report.holes.len(),
            report.faces.len(),
        );
        for (outcome, text) in [
            (HoleOutcome::TooManyEdges, "have too many edges"),
            (HoleOutcome::Kept, "kept as the longest"),
        ] {
            if report.count(outcome) > 0 {
                let _ = write!(summary, ", {} {text}", report.count(outcome));
            }
        }
        session.finish(&summary, &to_json(&report))?;
        Ok(ExitCode::SUCCESS)
    }

    fn options(&self) -> FillOptions {
        let default = FillOptions::default();
        FillOptions {
            max_edges: self.max_edges.unwrap_or(default.max_edges),
            longest: if self.keep_longest { LongestRim::Keep } else { LongestRim::Fill },
            patch: match (self.fair, self.refine || self.density.is_some()) {
                (true, _) => Patch::Fair,
                (false, true) => Patch::Refined,
                (false, false) => Patch::Cover,
            },
            density: self.density.unwrap_or(default.density),
        }
    }
}

fn to_json(report: &FillReport) -> Value {
    let holes = report.holes.iter().map(|hole| {
        json!({
            "edges": hole.edges,
            "length": hole.length,
            "outcome": match hole.outcome {
                HoleOutcome::Filled => "filled",
                HoleOutcome::TooManyEdges => "too many edges",
                HoleOutcome::Kept => "kept",
                HoleOutcome::NoTriangulation => "no triangulation",
            },
            "largest_bend": hole.largest_bend,
            "area": hole.area,
            "faces": hole.faces,
            "vertices": hole.vertices,
        })
    });
    json!({
        "filled": report.count(HoleOutcome::Filled),
        "faces": report.faces.len(),
        "holes": holes.collect::<Vec<Value>>(),
    })
}
