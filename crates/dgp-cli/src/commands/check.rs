//! `dgp check`: lists every defect.

use std::{fmt::Write, process::ExitCode};

use clap::Args;
use dgp::mesh::{Defect, DefectReport, Elements, FaceId, Severity, VertexId, defects};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input},
    failure::Failure,
    session::Session,
};

/// Options of `dgp check`.
#[derive(Debug, Args)]
pub(crate) struct Check {
    #[command(flatten)]
    input: Input,
    /// Do not look for faces that pass through each other, which takes longer than all else
    #[arg(long)]
    skip_intersections: bool,
}

impl Check {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("check", common);
        let document = session.read(&self.input)?;
        let report = session
            .run("checking", |progress| {
                if self.skip_intersections {
                    return defects(&document.set, progress);
                }
                let mut report = defects(&document.set, progress.part(0.0, 0.3))?;
                report.add_self_intersections(&document.set, progress.part(0.3, 1.0))?;
                Ok(report)
            })
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let is_valid = listed(&report).next().is_none();
        session.finish(&to_text(&report), &to_json(&report))?;
        Ok(if is_valid { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}

/// The defects that make a mesh invalid or doubtful; the others are worth a note.
fn listed(report: &DefectReport) -> impl Iterator<Item = &Defect> {
    report.of(Severity::Error).chain(report.of(Severity::Warning))
}

pub(crate) fn to_text(report: &DefectReport) -> String {
    let mut text = String::new();
    for (severity, word) in
        [(Severity::Error, "error"), (Severity::Warning, "warning"), (Severity::Info, "note")]
    {
        for defect in report.of(severity) {
            let _ = writeln!(text, "{word}: {defect}");
        }
    }
    text += match (report.is_manifold(), listed(report).next().is_none()) {
        (true, true) => "valid: an oriented manifold without defects",
        (true, false) => "an oriented manifold with defects",
        (false, _) => {
            "no oriented manifold: most commands refuse it until `dgp repair` has mended it"
        }
    };
    text
}

pub(crate) fn to_json(report: &DefectReport) -> Value {
    let item = |defect: &Defect| {
        json!({
            "kind": defect.kind.name(),
            "severity": match defect.severity() {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Info => "note",
            },
            "count": defect.count(),
            "element_kind": element_kind(&defect.elements),
            "elements": elements(&defect.elements),
            "remedy": defect.remedy(),
        })
    };
    let defects: Vec<Value> = listed(report).map(item).collect();
    let notes: Vec<Value> = report.of(Severity::Info).map(item).collect();
    json!({
        "valid": defects.is_empty(),
        "manifold": report.is_manifold(),
        "defects": defects,
        "notes": notes,
    })
}

/// What the ids in a list are.
pub(crate) fn element_kind(list: &Elements) -> &'static str {
    match list {
        Elements::Vertices(_) => "vertex",
        Elements::VertexPairs(_) => "vertex, vertex",
        Elements::Edges(_) => "edge by its vertices",
        Elements::Faces(_) => "face",
        Elements::FacePairs(_) => "face, face",
        Elements::FaceGroups(_) => "faces",
        Elements::Loops(_) => "vertices of a loop",
    }
}

/// Ids as numbers counted from 0; pairs and groups as lists of them.
pub(crate) fn elements(list: &Elements) -> Value {
    match list {
        Elements::Vertices(list) => list.iter().map(|v| v.index()).collect(),
        Elements::Faces(list) => list.iter().map(|f| f.index()).collect(),
        Elements::VertexPairs(list) | Elements::Edges(list) => {
            list.iter().map(|pair| Value::from(pair.map(VertexId::index).to_vec())).collect()
        }
        Elements::FacePairs(list) => {
            list.iter().map(|pair| Value::from(pair.map(FaceId::index).to_vec())).collect()
        }
        Elements::FaceGroups(groups) => {
            groups.iter().map(|group| group.iter().map(|f| f.index()).collect::<Value>()).collect()
        }
        Elements::Loops(groups) => {
            groups.iter().map(|group| group.iter().map(|v| v.index()).collect::<Value>()).collect()
        }
    }
}
