//! All holes of a mesh filled: `fill-cover`, `fill-refined` or `fill-fair`.

use dgp_mesh::{Mesh, Progress};
use dgp_remesh::{FillOptions, HoleOutcome, Patch, fill_holes};
use serde_json::{Map, Value, json};

use super::{Call, built, time_from};
use crate::{raw, shell::Outcome};

/// The operations by name.
pub(super) const OPERATIONS: [&str; 3] = ["fill-cover", "fill-refined", "fill-fair"];

/// Runs the operation; what `--out` names gets the result of the last run, with the faces that were there first.
pub(super) fn perform(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let input = built(&raw::read(&call.input)?)?;
    let patch = match call.operation.as_str() {
        "fill-cover" => Patch::Cover,
        "fill-refined" => Patch::Refined,
        _ => Patch::Fair,
    };
    let options = FillOptions { patch, ..FillOptions::default() };
    let mut last = None;
    time_from(
        report,
        call.repeat,
        || input.clone(),
        |mut mesh: Mesh| {
            let done = fill_holes(&mut mesh, &options, Progress::NONE)?;
            let is_filled = done.count(HoleOutcome::Filled) == done.holes.len();
            last = Some((mesh, is_filled));
            Ok(done)
        },
    )?;
    if let Some((mesh, is_filled)) = last {
        report.insert("filled".into(), json!(is_filled));
        report.insert("vertices".into(), json!(mesh.vertex_count()));
        report.insert("faces".into(), json!(mesh.face_count()));
        if !call.out.as_os_str().is_empty() {
            raw::write(&call.out.with_extension("raw"), &mesh.to_indexed())?;
        }
    }
    Ok(())
}
