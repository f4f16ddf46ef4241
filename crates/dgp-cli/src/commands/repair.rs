//! `dgp repair`: mends a mesh and says what it changed.

use std::{fmt::Write, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::mesh::{
    CrowdedEdges, Facing, FlatFaces, IndexedFaceSet, IsolatedVertices, KeepComponents, OneSided,
    RepairAction, RepairOptions, RepairReport, Tolerance, repair_faces,
};
use serde_json::{Value, json};

use super::check::{element_kind, elements};
use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp repair`.
///
/// Always done, since the result is a manifold: vertices that are no numbers and their faces go, and so
/// do faces that are no polygons and copies of faces; faces are turned to agree, closed surfaces to
/// look outward; edges of three or more faces and vertices of several fans are taken apart; vertices of
/// no face go. The options change how, or ask for more.
#[derive(Debug, Args)]
pub(crate) struct Repair {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    mending: Mending,
}

/// How to mend.
#[derive(Clone, Debug, Args)]
pub(crate) struct Mending {
    /// Make vertices one that are up to EPS apart: 0 for those at the same place, a length, or a
    /// percentage of the diagonal such as 0.01%
    #[arg(long, value_name = "EPS", value_parser = tolerance)]
    weld: Option<Tolerance>,
    /// Which way faces are to look
    #[arg(long, value_name = "WAY", num_args = 0..=1, default_missing_value = "outward", default_value = "outward")]
    orient: Way,
    /// What becomes of edges of three or more faces
    #[arg(long, value_name = "HOW", num_args = 0..=1, default_missing_value = "pair", default_value = "pair")]
    split_non_manifold: Split,
    /// Refuse surfaces that have only one side instead of cutting them
    #[arg(long)]
    refuse_one_sided: bool,
    /// Remove faces of zero area, without opening the surface
    #[arg(long)]
    drop_degenerate: bool,
    /// Keep only the N components with the most faces
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "1")]
    keep_largest: Option<usize>,
    /// Keep only components of at least N faces
    #[arg(long, value_name = "N", conflicts_with = "keep_largest")]
    drop_small: Option<usize>,
    /// Fill holes of up to N edges; without N all
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "4294967295")]
    fill_holes: Option<usize>,
    /// Keep vertices of no face
    #[arg(long)]
    keep_isolated: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Way {
    /// As neighbors do, closed surfaces outward
    Outward,
    /// As neighbors do
    Consistent,
    /// As they do; the surface is cut where neighbors disagree
    Keep,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Split {
    /// Faces that belong together stay in twos
    Pair,
    /// All faces are cut apart
    Cut,
}

impl Mending {
    pub(crate) fn options(&self) -> RepairOptions {
        RepairOptions {
            weld: self.weld,
            flat_faces: if self.drop_degenerate { FlatFaces::Remove } else { FlatFaces::Keep },
            orientation: match self.orient {
                Way::Outward => Facing::Outward,
                Way::Consistent => Facing::Consistent,
                Way::Keep => Facing::Keep,
            },
            one_sided: if self.refuse_one_sided { OneSided::Refuse } else { OneSided::Cut },
            crowded_edges: match self.split_non_manifold {
                Split::Pair => CrowdedEdges::Pair,
                Split::Cut => CrowdedEdges::Cut,
            },
            components: match (self.keep_largest, self.drop_small) {
                (Some(count), _) => KeepComponents::Largest(count),
                (None, Some(faces)) => KeepComponents::AtLeast(faces),
                (None, None) => KeepComponents::All,
            },
            hole_edges: self.fill_holes.unwrap_or(0),
            isolated_vertices: if self.keep_isolated {
                IsolatedVertices::Keep
            } else {
                IsolatedVertices::Drop
            },
        }
    }
}

impl Repair {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("repair", common);
        let mut document = session.read(&self.input)?;
        let (set, report) = session
            .run("repairing", |progress| {
                let (set, report) = repair_faces(&document.set, &self.mending.options(), progress)?;
                Ok::<_, dgp::mesh::Error>((set.into_owned(), report))
            })
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let summary = format!("{}{} → {}", to_text(&report), size(&document.set), size(&set));
        let lost = document.follow(set, &report.vertices);
        if lost > 0 {
            session.warn(format!("{lost} lines and points ended at vertices that were dropped"));
        }
        session.write(&self.output, &document)?;
        session.finish(&summary, &to_json(&report))?;
        Ok(ExitCode::SUCCESS)
    }
}

fn size(set: &IndexedFaceSet) -> String {
    format!("{} vertices, {} faces", set.vertex_count(), set.face_count())
}

/// What was done to how many elements, a line each.
pub(crate) fn to_text(report: &RepairReport) -> String {
    const SHOWN: usize = 3;
    let mut text = String::new();
    for change in &report.changes {
        let (count, first) = (change.elements.len(), change.elements.first(SHOWN));
        let _ = writeln!(text, "{}: {first} ({count} in all)", sentence(change.action));
    }
    if text.is_empty() {
        text.push_str("nothing to repair: ");
    }
    text
}

pub(crate) fn to_json(report: &RepairReport) -> Value {
    let changes = report.changes.iter().map(|change| {
        json!({
            "step": change.action.step(),
            "action": change.action.name(),
            "count": change.elements.len(),
            "element_kind": element_kind(&change.elements),
            "elements": elements(&change.elements),
        })
    });
    json!({"changes": changes.collect::<Vec<Value>>()})
}

/// An action in words.
pub(crate) fn sentence(action: RepairAction) -> String {
    action.name().replace('_', " ")
}

/// 0, a length, or a percentage of the diagonal.
pub(super) fn tolerance(text: &str) -> Result<Tolerance, String> {
    let (number, is_percentage) = match text.strip_suffix('%') {
        Some(number) => (number, true),
        None => (text, false),
    };
    match number.trim().parse::<f64>() {
        Ok(0.0) => Ok(Tolerance::Exact),
        Ok(x) if x > 0.0 && x.is_finite() && is_percentage => Ok(Tolerance::OfDiagonal(x / 100.0)),
        Ok(x) if x > 0.0 && x.is_finite() => Ok(Tolerance::Distance(x)),
        _ => Err("a tolerance is 0, a length, or a percentage of the diagonal".to_owned()),
    }
}
