//! Decimation to `--levels` faces: on triangles with rings (`quadric`, `quadric-passes`, `quadric-fast`), with any
//! cost (`quadric-any`, `length`), or by the peer that is a crate (`meshoptimizer`).

use dgp_mesh::{EdgeSet, Mesh, Progress, VertexSet};
use dgp_remesh::{
    DecimationOptions, LengthCost, Order, ProgressiveMesh, QuadricCost, QuadricOptions, Target,
    decimate, decimate_quadric,
};
use serde_json::{Map, Value, json};

use super::{Call, built, time, time_from};
use crate::{raw, shell::Outcome};

/// Runs the operation; what `--out` names gets the result of the last run.
pub(super) fn perform(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    if call.scheme == "meshoptimizer" {
        return meshoptimizer(call, report);
    }
    let input = built(&raw::read(&call.input)?)?;
    let target = Target::Faces(call.levels);
    let quadric = match call.scheme.as_str() {
        "quadric-passes" => QuadricOptions { order: Order::Passes, ..QuadricOptions::default() },
        "quadric-fast" => QuadricOptions::fast(),
        _ => QuadricOptions::default(),
    };
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

/// What meshoptimizer's `simplify` makes of 32-bit positions, copied there and back outside the timed part. Positions are
/// written as they were.
#[cfg(feature = "meshoptimizer")]
fn meshoptimizer(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let set = raw::read(&call.input)?;
    let single = |p: &dgp_mesh::DVec3| p.to_array().map(|x| x as f32);
    let positions: Vec<[f32; 3]> = set.positions().values().iter().map(single).collect();
    let indices: Vec<u32> = set.faces().corners().iter().map(|v| v.index() as u32).collect();
    let adapter = meshopt::VertexDataAdapter::new(meshopt::typed_to_bytes(&positions), 12, 0)?;
    let mut last = Vec::new();
    time(report, call.repeat, || {
        let options = meshopt::SimplifyOptions::None;
        last = meshopt::simplify(&indices, &adapter, 3 * call.levels, f32::MAX, options, None);
        Ok(())
    })?;
    report.insert("faces".into(), json!(last.len() / 3));
    if !call.out.as_os_str().is_empty() {
        let faces: Vec<[usize; 3]> =
            last.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|v| v as usize)).collect();
        let faces = dgp_mesh::FaceList::from_indices(&faces);
        let result = dgp_mesh::IndexedFaceSet::new(set.positions().clone(), faces)?;
        raw::write(&call.out.with_extension("raw"), &result)?;
    }
    Ok(())
}

#[cfg(not(feature = "meshoptimizer"))]
fn meshoptimizer(_: &Call, _: &mut Map<String, Value>) -> Outcome<()> {
    Err("built without meshoptimizer; build with `--features meshoptimizer`".into())
}
