//! Measures, topology and search on every shape.

mod closed_forms;
mod convergence;
mod curvature;
mod invariance;
mod neighborhoods;
mod search;

use dgp_mesh::{
    DMat3, DVec3, Mesh,
    shapes::{self, Random},
};

/// Meshes of every kind: closed and open, of triangles, quads and polygons, of genus 0 to 3.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let noisy = shapes::with_noise(shapes::icosphere(3).unwrap(), 0.02, 7).unwrap();
    vec![
        ("tetrahedron", shapes::tetrahedron()),
        ("cube", shapes::cube()),
        ("octahedron", shapes::octahedron()),
        ("dodecahedron", shapes::dodecahedron()),
        ("icosahedron", shapes::icosahedron()),
        ("icosphere", shapes::icosphere(3).unwrap()),
        ("quad sphere", shapes::quad_sphere(6).unwrap()),
        ("uv sphere", shapes::uv_sphere(16, 9).unwrap()),
        ("noisy sphere", noisy.clone()),
        ("holed sphere", shapes::with_holes(&noisy, 4, 1, 3).unwrap()),
        ("torus", shapes::torus(2.0, 0.7, 24, 12).unwrap()),
        ("quad torus", shapes::quad_torus(2.0, 0.7, 24, 12).unwrap()),
        ("genus 3", shapes::surface_of_genus(3, 2).unwrap()),
        ("grid", shapes::grid(5, 7).unwrap()),
        ("annulus", shapes::annulus(0.5, 1.5, 12, 3).unwrap()),
        ("cylinder", shapes::cylinder(1.0, 2.0, 12, 3).unwrap()),
        ("cone", shapes::capped_cone(1.0, 2.0, 12, 3).unwrap()),
        ("trefoil", shapes::trefoil(60, 8).unwrap()),
        ("blob", shapes::blob(3).unwrap()),
    ]
}

/// The same mesh with its vertices moved by `change`.
fn moved(mesh: &Mesh, change: impl Fn(DVec3) -> DVec3) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.set_positions(mesh.positions().map(|&p| change(p)));
    mesh
}

/// Whether `a` and `b` differ by less than `tolerance` of the larger.
fn is_close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs())
}

/// A point in the cube from −1 to 1.
fn random_point(random: &mut Random) -> DVec3 {
    DVec3::new(
        2.0 * random.uniform() - 1.0,
        2.0 * random.uniform() - 1.0,
        2.0 * random.uniform() - 1.0,
    )
}

/// The rotation by these angles about x, y and z.
fn rotation(angles: DVec3) -> DMat3 {
    DMat3::from_rotation_x(angles.x)
        * DMat3::from_rotation_y(angles.y)
        * DMat3::from_rotation_z(angles.z)
}
