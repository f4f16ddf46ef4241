//! Euler characteristic and genus of a mesh.

use super::{boundary_loops, components};
use crate::Connectivity;

/// χ = V − E + F over the vertices that lie on a face.
pub fn euler_characteristic(mesh: &Connectivity) -> i64 {
    let vertices = mesh.vertices().filter(|&v| !mesh.is_isolated_vertex(v)).count();
    vertices as i64 - mesh.edge_count() as i64 + mesh.face_count() as i64
}

/// The number of handles of all components together, from χ = Σ (2 − 2g − b).
pub fn genus(mesh: &Connectivity) -> usize {
    let spheres = 2 * components(mesh).count as i64;
    let holes = boundary_loops(mesh).len() as i64;
    ((spheres - holes - euler_characteristic(mesh)) / 2) as usize
}
