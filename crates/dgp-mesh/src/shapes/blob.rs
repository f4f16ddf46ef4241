//! A sphere with gentle bumps.

use glam::DVec3;

use super::icosphere;
use crate::{Error, Mesh};

/// A smooth closed shape with bumps and dents and no symmetry: [`icosphere`]`(level)` with its radius
/// changed between 0.7 and 1.4 or so by waves over the directions. Every ray from the origin meets it once.
pub fn blob(level: usize) -> Result<Mesh, Error> {
    let mut mesh = icosphere(level)?;
    let positions = mesh.map_vertices(|v| radius(mesh.position(v)) * mesh.position(v));
    mesh.set_positions(positions);
    Ok(mesh)
}

/// Products of sines are smooth on the sphere and cheap; amplitudes fall as waves get shorter.
fn radius(d: DVec3) -> f64 {
    let broad = (2.1 * d.x + 0.4).sin() * (1.7 * d.y - 0.3).sin();
    let middle = (4.3 * d.y + 1.1).sin() * (3.9 * d.z + 0.6).sin();
    let narrow = (7.1 * d.z - 0.2).sin() * (6.3 * d.x + 0.9).sin() * (5.7 * d.y).cos();
    1.0 + 0.22 * broad + 0.14 * middle + 0.07 * narrow
}
