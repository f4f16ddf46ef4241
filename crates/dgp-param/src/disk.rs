//! Whether a surface can be laid out in the plane as it is.

use dgp_mesh::{
    Connectivity, Mesh, VertexId,
    topology::{boundary_loops, components, euler_characteristic, path_length},
};

use crate::Error;

/// The boundary of a disk, counterclockwise as the surface is seen from outside: of several loops the
/// longest, the others being holes that stay open. Starts with the smallest vertex.
///
/// Errors: [`Error::Closed`]; [`Error::NotDisk`] where there are handles, several pieces or isolated vertices.
pub fn disk_boundary(mesh: &Mesh) -> Result<Vec<VertexId>, Error> {
    let loops = boundary_loops(mesh);
    check(mesh, loops.len())?;
    let lengths: Vec<f64> = loops.iter().map(|rim| path_length(mesh, rim)).collect();
    // The first of equals.
    let longest = (0..loops.len()).rev().max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]));
    // A loop has the hole on its left, so backwards it has the surface there.
    let rim = longest.map_or(&[][..], |longest| &loops[longest]);
    let mut boundary: Vec<VertexId> = rim.iter().rev().map(|&h| mesh.from(h)).collect();
    let first = (0..boundary.len()).min_by_key(|&i| boundary[i]).unwrap_or(0);
    boundary.rotate_left(first);
    Ok(boundary)
}

/// An error unless `mesh` is one piece without handles that has a boundary.
fn check(mesh: &Connectivity, loops: usize) -> Result<(), Error> {
    let euler = euler_characteristic(mesh);
    let isolated = mesh.vertices().filter(|&v| mesh.is_isolated_vertex(v)).count();
    let components = components(mesh).faces().len() + isolated;
    if loops == 0 && components == 1 {
        return Err(Error::Closed { euler });
    }
    if components != 1 || euler != 2 - loops as i64 {
        return Err(Error::NotDisk { components, euler, loops });
    }
    Ok(())
}

/// An error unless each entry of `boundary` is followed along the boundary by the next, the surface on the
/// left.
pub(crate) fn check_boundary(mesh: &Connectivity, boundary: &[VertexId]) -> Result<(), Error> {
    let mut seen = vec![false; mesh.vertex_count()];
    for (entry, &vertex) in boundary.iter().enumerate() {
        let next = boundary[(entry + 1) % boundary.len()];
        // The half-edge of the hole that leaves the next vertex arrives here.
        let known = next.index() < seen.len() && vertex.index() < seen.len();
        let hole = known.then(|| mesh.vertex_halfedge(next)).flatten();
        let follows = hole.is_some_and(|h| mesh.is_boundary_halfedge(h) && mesh.to(h) == vertex);
        if !follows || std::mem::replace(&mut seen[vertex.index()], true) {
            return Err(Error::NotBoundary { entry, vertex });
        }
    }
    Ok(())
}
