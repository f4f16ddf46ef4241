//! What the methods share: validation, iterations, the volume, the report.

use std::mem;

use dgp_mesh::{
    DVec3, FaceId, Mesh, Progress, VertexId, VertexMap, VertexSet,
    measure::{self, Surface},
    parallel,
};

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
    check_finite(mesh)?;
    let rim = mesh.vertices().find(|&v| !mesh.is_isolated_vertex(v) && mesh.is_boundary_vertex(v));
    if task.volume == Volume::Keep {
        check_volume_can_be_kept(rim, task.fixed)?;
    }
    let volume_of = |positions: &mut Vec<DVec3>| {
        let placed = Placed { mesh, positions: mem::take(positions).into() };
        let volume = rim.is_none().then(|| measure::volume(&placed));
        *positions = placed.positions.into_values();
        volume
    };
    let original = mesh.positions();
    let unit = power_of_two_near(original.values());
    let rings = Rings::new(mesh, task.fixed, task.boundary);
    let mut positions: Vec<DVec3> = original.values().iter().map(|&p| p * unit).collect();
    let volume_before = volume_of(&mut positions);

    let mut room = vec![DVec3::ZERO; positions.len()];
    let mut stopped = Ok(());
    for iteration in 0..task.iterations {
        stopped = task.progress.report(iteration as f64 / task.iterations as f64);
        if stopped.is_err() {
            break;
        }
        step(&rings, &mut positions, &mut room);
    }
    drop(room);
    let mut volume_after = volume_of(&mut positions);
    let is_rescaled = task.volume == Volume::Keep && stopped.is_ok();
    if let (true, Some(before), Some(after)) = (is_rescaled, volume_before, volume_after) {
        let ratio = before / after;
        if !(ratio > 0.0 && ratio.is_finite()) {
            let [before, after] = [before, after].map(|volume| volume / unit / unit / unit);
            return Err(Error::VolumeLost { before, after });
        }
        scale_about_mean(&mut positions, ratio.cbrt());
        volume_after = volume_of(&mut positions);
    }

    let moves = |v: usize| is_rescaled || !rings.is_fixed(v);
    let blocks = parallel::map_blocks(positions.len(), parallel::BLOCK, |range| {
        let moving = range.filter(|&v| moves(v));
        moving.fold((0, 0.0, 0.0_f64), |(count, sum, max), v| {
            let distance = positions[v].distance(unit * original.values()[v]);
            (count + 1, sum + distance, max.max(distance))
        })
    });
    let (free_vertices, sum, max) =
        blocks.into_iter().fold((0, 0.0, 0.0_f64), |a, b| (a.0 + b.0, a.1 + b.1, a.2.max(b.2)));
    parallel::for_each_chunk(&mut positions, parallel::BLOCK, |first, chunk| {
        for (i, p) in chunk.iter_mut().enumerate() {
            // What stays does so bit for bit, however small it is beside the rest.
            let v = first + i;
            *p = if moves(v) { clamp(*p / unit) } else { original.values()[v] };
        }
    });
    let report = SmoothReport {
        iterations: task.iterations,
        free_vertices,
        volume_before: volume_before.map(|volume| volume / unit / unit / unit),
        volume_after: volume_after.map(|volume| volume / unit / unit / unit),
        mean_displacement: sum / positions.len().max(1) as f64 / unit,
        max_displacement: max / unit,
    };
    mesh.set_positions(positions.into());
    stopped?;
    Ok(report)
}

/// The faces of a mesh with other positions.
struct Placed<'a> {
    mesh: &'a Mesh,
    positions: VertexMap<DVec3>,
}

impl Surface for Placed<'_> {
    #[inline]
    fn vertex_positions(&self) -> &VertexMap<DVec3> {
        &self.positions
    }

    fn number_of_faces(&self) -> usize {
        self.mesh.face_count()
    }

    fn polygon(&self, f: FaceId) -> impl Iterator<Item = VertexId> + Clone {
        self.mesh.polygon(f)
    }

    #[inline]
    fn corners_of_triangle(&self, f: FaceId) -> Option<[VertexId; 3]> {
        self.mesh.triangle(f)
    }
}

/// `value`, if it is above 0 and at most 1.
pub(super) fn fraction(name: &'static str, value: f64) -> Result<f64, Error> {
    if value > 0.0 && value <= 1.0 {
        return Ok(value);
    }
    Err(Error::option(name, value, "above 0 and at most 1"))
}

/// Refuses positions that would spread over their neighbors and on.
pub(super) fn check_finite(mesh: &Mesh) -> Result<(), Error> {
    match mesh.vertices().find(|&v| !mesh.position(v).is_finite()) {
        Some(vertex) => Err(Error::NotFinite { vertex }),
        None => Ok(()),
    }
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
