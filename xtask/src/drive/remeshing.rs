//! Isotropic remeshing, five iterations, with edges of `--levels` percent of the mean length; `sharp` keeps edges that
//! bend by more than 40 degrees. `remeshed` tells how good a result is beside the mesh `--other`, which it was made from.

use dgp_mesh::{
    EdgeSet, Mesh, Progress, VertexSet,
    measure::edge_length_range,
    spatial::{DeviationOptions, HausdorffOptions, TriangleTree, deviation, hausdorff},
};
use dgp_remesh::{RemeshOptions, remesh_isotropic, sharp_edges, triangle_quality};
use serde_json::{Map, Value, json};

use super::{Call, built, time_from};
use crate::{raw, shell::Outcome};

/// Runs the operation; what `--out` names gets the result of the last run.
pub(super) fn perform(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    if call.operation == "remeshed" {
        return judge(call, report);
    }
    let input = built(&raw::read(&call.input)?)?;
    let mean = edge_length_range(&input).map_or(0.0, |lengths| lengths.mean);
    let length = mean * percent(call.levels) / 100.0;
    let options = RemeshOptions { iterations: 5, ..RemeshOptions::default() };
    let mut last = None;
    time_from(
        report,
        call.repeat,
        || input.clone(),
        |mut mesh: Mesh| {
            let features = match call.scheme.as_str() {
                "sharp" => sharp_edges(&mesh, 40_f64.to_radians()),
                _ => EdgeSet::new(),
            };
            let kept = (&VertexSet::new(), &features);
            let done = remesh_isotropic(&mut mesh, length, kept, &options, Progress::NONE)?;
            last = Some(mesh);
            Ok(done)
        },
    )?;
    if let Some(mesh) = last {
        report.insert("length".into(), json!(length));
        report.insert("vertices".into(), json!(mesh.vertex_count()));
        report.insert("faces".into(), json!(mesh.face_count()));
        if !call.out.as_os_str().is_empty() {
            raw::write(&call.out.with_extension("raw"), &mesh.to_indexed())?;
        }
    }
    Ok(())
}

/// Angles in degrees, distances in units of the diagonal.
fn judge(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let mesh = built(&raw::read(&call.input)?)?;
    let quality = triangle_quality(&mesh)?;
    let tree = TriangleTree::new(&mesh, Progress::NONE)?;
    let input = TriangleTree::new(&raw::read(&call.other)?, Progress::NONE)?;
    let samples = DeviationOptions::default();
    let there = deviation(&tree, &input, &samples, Progress::NONE)?;
    let back = deviation(&input, &tree, &samples, Progress::NONE)?;
    let bounds = hausdorff(&tree, &input, &HausdorffOptions::default(), Progress::NONE)?;
    let diagonal = input.bounding_box().map_or(1.0, |bounds| bounds.diagonal());
    for (name, value) in [
        ("faces", mesh.face_count() as f64),
        ("least", quality.minimum_angle.to_degrees()),
        ("low", quality.low_angle.to_degrees()),
        ("mean", quality.mean_minimum_angle.to_degrees()),
        ("regular", quality.regular_share),
        ("rms", there.rms.max(back.rms) / diagonal),
        ("hausdorff", bounds.upper() / diagonal),
    ] {
        report.insert(name.into(), json!(value));
    }
    Ok(())
}

/// Without `--levels` the length is the mean one.
fn percent(levels: usize) -> f64 {
    if levels == 1 { 100.0 } else { levels as f64 }
}
