//! Approximation order: on a smooth surface errors fall by four when edges are halved.
//!
//! Linear interpolation of a surface of curvature κ by edges of length h is off by κ h² / 8 at most
//! (MESH-9), so area, volume and Hausdorff distance converge with order 2.

use std::f64::consts::PI;

use dgp_mesh::{
    DVec3, Mesh,
    measure::{area, mass_properties, volume},
    shapes::{icosphere, torus},
};

/// log₂ of the last quotient of errors.
fn order(errors: &[f64]) -> f64 {
    (errors[errors.len() - 2] / errors[errors.len() - 1]).log2()
}

/// The largest distance of points of the mesh, many on each face, from the surface, whose distance
/// function is `distance`. As vertices lie on it, this is the Hausdorff distance but for sampling.
fn farthest(mesh: &Mesh, distance: impl Fn(DVec3) -> f64) -> f64 {
    const N: usize = 8;
    let mut farthest: f64 = 0.0;
    for f in mesh.faces() {
        let [a, b, c] = mesh.triangle(f).unwrap().map(|v| mesh.position(v));
        for i in 0..=N {
            for j in 0..=N - i {
                let (s, t) = (i as f64 / N as f64, j as f64 / N as f64);
                farthest = farthest.max(distance(a + s * (b - a) + t * (c - a)).abs());
            }
        }
    }
    farthest
}

#[test]
fn spheres_converge_with_order_two() {
    let meshes: Vec<Mesh> = (3..=5).map(|level| icosphere(level).unwrap()).collect();
    let errors = |f: &dyn Fn(&Mesh) -> f64| meshes.iter().map(f).collect::<Vec<f64>>();
    let orders = [
        order(&errors(&|m| 4.0 * PI - area(m))),
        order(&errors(&|m| 4.0 * PI / 3.0 - volume(m))),
        order(&errors(&|m| farthest(m, |p| 1.0 - p.length()))),
        order(&errors(&|m| 8.0 * PI / 15.0 - mass_properties(m).unwrap().principal_moments.x)),
    ];
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?}");
}

#[test]
fn tori_converge_with_order_two() {
    let (major, minor) = (2.0, 0.75);
    let meshes: Vec<Mesh> =
        [24, 48, 96].map(|n| torus(major, minor, 2 * n, n).unwrap()).into_iter().collect();
    let errors = |f: &dyn Fn(&Mesh) -> f64| meshes.iter().map(f).collect::<Vec<f64>>();
    let exact_volume = 2.0 * PI * PI * major * minor * minor;
    let about_axis = exact_volume * (major * major + 0.75 * minor * minor);
    let about_diameter = exact_volume * (0.5 * major * major + 0.625 * minor * minor);
    let distance = |p: DVec3| DVec3::new(p.x.hypot(p.y) - major, p.z, 0.0).length() - minor;
    let moments = |m: &Mesh| mass_properties(m).unwrap().principal_moments;
    let orders = [
        order(&errors(&|m| 4.0 * PI * PI * major * minor - area(m))),
        order(&errors(&|m| exact_volume - volume(m))),
        order(&errors(&|m| farthest(m, distance))),
        order(&errors(&|m| about_axis - moments(m).z)),
        order(&errors(&|m| about_diameter - moments(m).x)),
    ];
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{orders:?}");
}
