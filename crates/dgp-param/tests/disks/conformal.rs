//! Conformal maps: what can be unrolled, order of convergence, pins.

use dgp_mesh::{DVec2, DVec3, Progress, VertexId};
use dgp_param::{Pin, distortion, least_squares_conformal};

use super::{bent_grid, difference_of_shape, hills};

#[test]
fn what_can_be_unrolled_is_unrolled() {
    for n in [16, 32, 64] {
        let half_cylinder = bent_grid(n, |p| {
            let angle = std::f64::consts::PI * p.x;
            DVec3::new(angle.cos(), angle.sin(), 2.0 * p.y)
        });
        let cone = bent_grid(n, |p| {
            let (radius, angle) = (1.0 + p.x, 2.0 * p.y);
            DVec3::new(0.6 * radius * angle.cos(), 0.6 * radius * angle.sin(), 0.8 * radius)
        });
        for (name, mesh) in [("half cylinder", half_cylinder), ("cone", cone)] {
            let map = least_squares_conformal(&mesh, &[], Progress::NONE).unwrap();
            let report = distortion(&mesh, &map).unwrap();
            assert_eq!(report.flipped, 0, "{name}");
            // Chords for arcs: the polyhedral cylinder is developable, the cone nearly so.
            let off = if name == "cone" { 2.0 / (n * n) as f64 } else { 1e-9 };
            assert!(
                report.conformal.mean - 1.0 < off,
                "{name} {n}: {:e}",
                report.conformal.mean - 1.0
            );
            assert!(report.areal.mean - 1.0 < off, "{name} {n}");
            assert!(report.symmetric_dirichlet.mean - 4.0 < 8.0 * off, "{name} {n}");
        }
    }
}

#[test]
fn angles_of_a_sphere_are_kept_to_second_order() {
    let off: Vec<f64> = [16, 32, 64]
        .map(|n| {
            let patch = bent_grid(n, |p| {
                let q = 1.2 * (p - DVec2::splat(0.5));
                q.extend((1.0 - q.length_squared()).sqrt())
            });
            let map = least_squares_conformal(&patch, &[], Progress::NONE).unwrap();
            let report = distortion(&patch, &map).unwrap();
            assert_eq!(report.flipped, 0);
            // Areas cannot be kept as well: a sphere is curved.
            assert!((2.0 * report.areal.mean - 2.005_69).abs() < 5e-5, "{}", report.areal.mean);
            report.conformal.mean - 1.0
        })
        .to_vec();
    for pair in off.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.15, "{off:?}");
    }
}

#[test]
fn pins_move_turn_and_scale_the_map() {
    let mesh = hills(15);
    let first = least_squares_conformal(&mesh, &[], Progress::NONE).unwrap();
    let last = VertexId::new(mesh.vertex_count() - 1);
    let pins = [VertexId::new(0), last].map(|vertex| Pin {
        vertex,
        position: DVec2::new(3.0, -7.0) + first[vertex].rotate(DVec2::new(-5.0, 2.0)),
    });
    let second = least_squares_conformal(&mesh, &pins, Progress::NONE).unwrap();
    // Only where the energy is zero do pins not matter; with the same two vertices they never do.
    let again = pins.map(|pin| Pin { position: pin.position * 0.25, ..pin });
    let third = least_squares_conformal(&mesh, &again, Progress::NONE).unwrap();
    assert!(difference_of_shape(&second, &third) < 1e-9);
    for pin in pins {
        assert_eq!(second[pin.vertex], pin.position);
    }
}
