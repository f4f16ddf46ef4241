//! What cannot be laid out, and how that is said.

use std::ops::ControlFlow;

use dgp_mesh::{DVec2, Progress, VertexId, shapes};
use dgp_param::{
    Error, Outline, Pin, Weights, convex_boundary, disk_boundary, distortion,
    least_squares_conformal, map_to_boundary,
};

#[test]
fn what_is_no_disk_is_named() {
    let sphere = shapes::icosphere(1).unwrap();
    assert_eq!(disk_boundary(&sphere), Err(Error::Closed { euler: 2 }));
    let torus = shapes::torus(1.0, 0.3, 8, 6).unwrap();
    assert_eq!(disk_boundary(&torus), Err(Error::Closed { euler: 0 }));
    let cut = shapes::with_holes(&torus, 1, 1, 1).unwrap();
    let error = disk_boundary(&cut).unwrap_err();
    assert_eq!(error, Error::NotDisk { components: 1, euler: -1, loops: 1 });
    assert!(error.to_string().contains("cut handles open"), "{error}");
    assert!(least_squares_conformal(&sphere, &[], Progress::NONE).is_err());
}

#[test]
fn boundaries_that_are_none_are_refused() {
    let mesh = shapes::disk(3).unwrap();
    let rim = disk_boundary(&mesh).unwrap();
    let mut wrong = rim.clone();
    wrong.swap(2, 4);
    let error = convex_boundary(&mesh, &wrong, &Outline::Circle).unwrap_err();
    assert!(matches!(error, Error::NotBoundary { .. }), "{error}");
    let backwards: Vec<VertexId> = rim.iter().rev().copied().collect();
    assert!(convex_boundary(&mesh, &backwards, &Outline::Circle).is_err());
    let clockwise = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]].map(DVec2::from).to_vec();
    let error = convex_boundary(&mesh, &rim, &Outline::Polygon(clockwise)).unwrap_err();
    assert!(matches!(error, Error::NotConvex { .. }), "{error}");
    let star: Vec<DVec2> =
        (0..5).map(|k| DVec2::from_angle(0.8 * std::f64::consts::PI * f64::from(k))).collect();
    assert!(convex_boundary(&mesh, &rim, &Outline::Polygon(star)).is_err());
    let short = map_to_boundary(&mesh, &rim, &[], Weights::Uniform, Progress::NONE);
    assert!(matches!(short, Err(Error::WrongLength { .. })));
    let triangle = shapes::grid(1, 1).unwrap();
    let rim = disk_boundary(&triangle).unwrap();
    let many: Vec<DVec2> = (0..9).map(|k| DVec2::from_angle(0.6 * f64::from(k))).collect();
    let error = convex_boundary(&triangle, &rim, &Outline::Polygon(many)).unwrap_err();
    assert_eq!(error, Error::TooFewVertices { vertices: 4, corners: 9 });
}

#[test]
fn pins_that_hold_nothing_are_refused() {
    let mesh = shapes::disk(2).unwrap();
    let pin =
        |vertex: usize, u: f64| Pin { vertex: VertexId::new(vertex), position: DVec2::new(u, 0.0) };
    for pins in [
        vec![pin(0, 0.0)],
        vec![pin(0, 0.0), pin(0, 1.0)],
        vec![pin(0, 1.0), pin(1, 1.0)],
        vec![pin(0, f64::NAN), pin(1, 1.0)],
        vec![pin(0, 0.0), pin(99, 1.0)],
    ] {
        let error = least_squares_conformal(&mesh, &pins, Progress::NONE).unwrap_err();
        assert!(matches!(error, Error::Pins { .. }), "{error}");
    }
}

#[test]
fn faces_without_area_are_named() {
    let mut mesh = shapes::disk(2).unwrap();
    let face = mesh.faces().next().unwrap();
    let corners: Vec<VertexId> = mesh.face_vertices(face).collect();
    let place = mesh.position(corners[0]);
    mesh.set_position(corners[1], place);
    let map = mesh.positions().map(|p| p.truncate());
    assert!(matches!(distortion(&mesh, &map), Err(Error::NoArea { .. })));
    let error = least_squares_conformal(&mesh, &[], Progress::NONE).unwrap_err();
    assert!(matches!(error, Error::NoArea { .. }), "{error}");
}

#[test]
fn cancelling_ends_a_map() {
    let mesh = shapes::disk(6).unwrap();
    let rim = disk_boundary(&mesh).unwrap();
    let held = convex_boundary(&mesh, &rim, &Outline::Circle).unwrap();
    let stop = |_: f64| ControlFlow::Break(());
    for weights in [Weights::Uniform, Weights::MeanValue, Weights::Harmonic] {
        let result = map_to_boundary(&mesh, &rim, &held, weights, Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))), "{weights:?}");
    }
    let result = least_squares_conformal(&mesh, &[], Progress::new(&stop));
    assert!(matches!(result, Err(Error::Cancelled(_))));
}

#[test]
fn all_vertices_held_is_no_error() {
    let mesh = shapes::grid(1, 1).unwrap();
    let rim = disk_boundary(&mesh).unwrap();
    let held = convex_boundary(&mesh, &rim, &Outline::Square).unwrap();
    for weights in [Weights::Uniform, Weights::MeanValue] {
        let map = map_to_boundary(&mesh, &rim, &held, weights, Progress::NONE).unwrap();
        assert!(rim.iter().zip(&held).all(|(&v, &p)| map[v] == p));
    }
}
