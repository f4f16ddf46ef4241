//! What the methods share: validation, iterations, the volume, the report.

use dgp_mesh::{DVec3, Mesh, Progress, VertexId, VertexMap, VertexSet, measure, parallel};

use super::{Boundary, SmoothReport, Volume, rings::Rings};
use crate::Error;

/// What all methods have to know.
pub(super) struct Task<'a> {
    pub(super) fixed: &'a VertexSet,
    pub(super) boundary: Boundary,
    pub(super) volume: Volume,
    pub(super) iterations: usize,
    pub(super) progress: Progress<'a>,
}

/// Iterates `step(rings, positions, room for new positions)`, which leaves the result in either.
///
/// Positions are worked on times a power of two that brings them to about 1, so that no sum overflows
/// and no product vanishes that would not at another scale.
pub(super) fn run(
    mesh: &mut Mesh,
    task: &Task<'_>,
    mut step: impl FnMut(&Rings, &mut Vec<DVec3>, &mut Vec<DVec3>),
) -> Result<SmoothReport, Error> {
    let rim = mesh.vertices().find(|&v| !mesh.is_isolated_vertex(v) && mesh.is_boundary_vertex(v));
    if task.volume == Volume::Keep {
        check_volume_can_be_kept(rim, task.fixed)?;
    }
    let original = mesh.positions().clone();
    let unit = power_of_two_near(original.values());
    let rings = Rings::new(mesh, task.fixed, task.boundary);
    let mut positions: Vec<DVec3> = original.values().iter().map(|&p| p * unit).collect();
    let volume_of = |mesh: &mut Mesh, positions: &[DVec3]| {
        mesh.set_positions(positions.to_vec().into());
        measure::volume(&*mesh)
    };
    let is_closed = rim.is_none();
    let volume_before = is_closed.then(|| volume_of(mesh, &positions));

    let mut room = positions.clone();
    let mut stopped = Ok(());
    for iteration in 0..task.iterations {
        stopped = task.progress.report(iteration as f64 / task.iterations as f64);
        if stopped.is_err() {
            break;
        }
        step(&rings, &mut positions, &mut room);
    }
    let mut volume_after = is_closed.then(|| volume_of(mesh, &positions));
    if let (Volume::Keep, Some(before), Some(after), true) =
        (task.volume, volume_before, volume_after, stopped.is_ok())
    {
        let ratio = before / after;
        if !(ratio > 0.0 && ratio.is_finite()) {
            mesh.set_positions(original);
            let per_unit = unit.powi(3).recip();
            return Err(Error::VolumeLost { before: before * per_unit, after: after * per_unit });
        }
        scale_about_mean(&mut positions, ratio.cbrt());
        volume_after = Some(volume_of(mesh, &positions));
    }

    let is_rescaled = task.volume == Volume::Keep;
    for (v, p) in positions.iter_mut().enumerate() {
        // What stays does so bit for bit, however small it is beside the rest.
        *p =
            if rings.is_fixed(v) && !is_rescaled { original.values()[v] } else { clamp(*p / unit) };
    }
    let moved: VertexMap<DVec3> = positions.into();
    let (sum, max_displacement) = parallel::reduce(
        moved.len(),
        (0.0, 0.0_f64),
        |v: VertexId| {
            let distance = (unit * moved[v] - unit * original[v]).length();
            (distance, distance)
        },
        |a, b| (a.0 + b.0, a.1.max(b.1)),
    );
    let report = SmoothReport {
        iterations: task.iterations,
        free_vertices: (0..moved.len()).filter(|&v| !rings.is_fixed(v)).count(),
        volume_before: volume_before.map(|volume| volume / unit / unit / unit),
        volume_after: volume_after.map(|volume| volume / unit / unit / unit),
        mean_displacement: sum / moved.len().max(1) as f64 / unit,
        max_displacement: max_displacement / unit,
    };
    mesh.set_positions(moved);
    stopped?;
    Ok(report)
}

/// `value`, if it is above 0 and at most 1.
pub(super) fn fraction(name: &'static str, value: f64) -> Result<f64, Error> {
    if value > 0.0 && value <= 1.0 {
        return Ok(value);
    }
    Err(Error::option(name, value, "above 0 and at most 1"))
}

fn check_volume_can_be_kept(rim: Option<VertexId>, fixed: &VertexSet) -> Result<(), Error> {
    if let Some(vertex) = rim {
        return Err(Error::NotClosed { vertex });
    }
    if !fixed.is_empty() {
        return Err(Error::VolumeMovesFixed { fixed: fixed.len() });
    }
    Ok(())
}

/// A power of two that brings the largest coordinate to between 1 and 2; 1 where all are zero.
fn power_of_two_near(positions: &[DVec3]) -> f64 {
    let largest = positions.iter().fold(DVec3::ZERO, |largest, p| largest.max(p.abs()));
    let largest = largest.max_element();
    if largest == 0.0 {
        return 1.0;
    }
    // Beyond these the inverse would not be a normal number.
    let exponent = ((largest.to_bits() >> 52) as i32 - 1023).clamp(-1000, 1000);
    2.0_f64.powi(-exponent)
}

/// A step may end a little beyond the largest number there is.
fn clamp(p: DVec3) -> DVec3 {
    p.clamp(DVec3::splat(-f64::MAX), DVec3::splat(f64::MAX))
}

fn scale_about_mean(positions: &mut [DVec3], factor: f64) {
    let mean = positions.iter().sum::<DVec3>() / positions.len().max(1) as f64;
    for p in positions {
        *p = mean + factor * (*p - mean);
    }
}
