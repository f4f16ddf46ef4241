//! Refinement: mesh to mesh as OpenMesh and CGAL do it, or plan and values apart as OpenSubdiv does.

use dgp_mesh::Progress;
use dgp_subdiv::{
    ButterflyRule, LoopWeights, RefinementOptions, RefinementPlan, Scheme, Sharpness,
    SubdivisionOptions, subdivide,
};
use serde_json::{Map, Value, json};

use super::{Call, built, time};
use crate::{raw, shell::Outcome};

/// The scheme of this name.
pub(crate) fn scheme(name: &str) -> Outcome<Scheme> {
    Ok(match name {
        "loop" => Scheme::Loop(LoopWeights::Original),
        "catmull-clark" => Scheme::CatmullClark,
        "butterfly" => Scheme::Butterfly(ButterflyRule::Modified),
        "sqrt3" => Scheme::Sqrt3,
        "doo-sabin" => Scheme::DooSabin,
        _ => return Err(format!("no scheme `{name}`").into()),
    })
}

/// Runs the operation. Planning starts from indexed faces, as a refiner of OpenSubdiv does, and ends with the
/// faces of the last level, which a plan of ours makes only when asked and a refiner of theirs has.
pub(super) fn perform(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let set = raw::read(&call.input)?;
    let scheme = scheme(&call.scheme)?;
    let refinement = RefinementOptions { scheme, levels: call.levels, ..Default::default() };
    let smooth = Sharpness::new();
    let planned = || -> Outcome<RefinementPlan> {
        let cage = built(&set)?;
        Ok(RefinementPlan::new(&cage, &smooth, &refinement, Progress::NONE)?)
    };
    let with_faces = || planned().map(|plan| (plan.faces(call.levels), plan));
    let positions = set.positions().values();
    match call.operation.as_str() {
        "subdivide" => {
            let cage = built(&set)?;
            let options = SubdivisionOptions { refinement, ..SubdivisionOptions::default() };
            time(report, call.repeat, || Ok(subdivide(&cage, &smooth, &options, Progress::NONE)?))?;
        }
        "plan-refine" => time(report, call.repeat, || {
            let (faces, plan) = with_faces()?;
            let refined = plan.refine(positions)?;
            Ok((faces, plan, refined))
        })?,
        "plan" => time(report, call.repeat, with_faces)?,
        "refine" => {
            let plan = planned()?;
            time(report, call.repeat, || Ok(plan.refine(positions)?))?;
        }
        _ => {
            let stencils = planned()?.stencils()?;
            report.insert("entries".into(), json!(stencils.entries()));
            time(report, call.repeat, || Ok(stencils.apply(positions)?))?;
        }
    }
    Ok(())
}
