//! Decimation to `--levels` faces: on triangles with rings (`quadric`), or with any cost (`quadric-any`, `length`).

use dgp_mesh::{EdgeSet, Mesh, Progress, VertexSet};
use dgp_remesh::{
    DecimationOptions, LengthCost, ProgressiveMesh, QuadricCost, QuadricOptions, Target, decimate,
    decimate_quadric,
};
use serde_json::{Map, Value, json};

use super::{Call, built, time, time_from};
use crate::{raw, shell::Outcome};

/// Runs the operation; what `--out` names gets the result of the last run.
pub(super) fn perform(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let input = built(&raw::read(&call.input)?)?;
    let target = Target::Faces(call.levels);
    let quadric = QuadricOptions::default();
    if call.operation == "progressive" {
        return time(report, call.repeat, || {
            Ok(ProgressiveMesh::new(&input, target, &quadric, Progress::NONE)?.to_bytes())
        });
    }
    let none = (VertexSet::new(), EdgeSet::new());
    let kept = (&none.0, &none.1);
    let options = DecimationOptions::default();
    let mut last = None;
    time_from(
        report,
        call.repeat,
        || input.clone(),
        |mut mesh: Mesh| {
            let done = match call.scheme.as_str() {
                "quadric-any" => {
                    let mut cost = QuadricCost::new(&mesh, 1.0);
                    decimate(&mut mesh, target, &mut cost, kept, &options, Progress::NONE)?
                }
                "length" => {
                    decimate(&mut mesh, target, &mut LengthCost, kept, &options, Progress::NONE)?
                }
                _ => decimate_quadric(&mut mesh, target, kept.0, &quadric, Progress::NONE)?,
            };
            last = Some(mesh);
            Ok(done)
        },
    )?;
    if let Some(mesh) = last {
        report.insert("vertices".into(), json!(mesh.vertex_count()));
        report.insert("faces".into(), json!(mesh.face_count()));
        if !call.out.as_os_str().is_empty() {
            raw::write(&call.out.with_extension("raw"), &mesh.to_indexed())?;
        }
    }
    Ok(())
}
