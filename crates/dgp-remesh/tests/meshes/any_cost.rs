//! Decimation with any cost: constraints hold, data travel, reports add up.

use std::ops::ControlFlow;

use dgp_mesh::{DVec3, EdgeSet, HalfedgeId, Mesh, Progress, VertexSet, shapes};
use dgp_remesh::{
    Boundary, CollapseCost, CurvatureCost, DecimationOptions, DecimationReport, Error, LengthCost,
    QuadricCost, StopReason, Target, decimate, sharp_edges,
};

fn run(
    mesh: &mut Mesh,
    target: Target,
    cost: &mut impl CollapseCost,
    options: &DecimationOptions,
) -> DecimationReport {
    let none = (&VertexSet::new(), &EdgeSet::new());
    let report = decimate(mesh, target, cost, none, options, Progress::NONE).expect("finite");
    mesh.validate().expect("a valid mesh");
    assert_eq!((report.vertices[1], report.faces[1]), (mesh.vertex_count(), mesh.face_count()));
    assert_eq!(report.vertices[0] - report.vertices[1], report.collapses);
    report
}

fn inputs() -> Vec<Mesh> {
    vec![
        shapes::icosphere(3).unwrap(),
        shapes::quad_sphere(8).unwrap(),
        shapes::goldberg(3, 1).unwrap(),
        shapes::with_holes(&shapes::icosphere(4).unwrap(), 3, 1, 5).unwrap(),
        shapes::annulus(0.5, 1.0, 24, 4).unwrap(),
        shapes::surface_of_genus(2, 2).unwrap(),
    ]
}

#[test]
fn every_cost_reaches_its_target_on_every_shape() {
    for input in inputs() {
        let target = Target::Vertices(input.vertex_count() / 3);
        let options = DecimationOptions::default();
        let check = |cost: &mut dyn FnMut(&mut Mesh) -> DecimationReport| {
            let mut mesh = input.clone();
            let report = cost(&mut mesh);
            assert_eq!(report.stop, StopReason::TargetReached, "{report:?}");
            assert_eq!(mesh.vertex_count(), input.vertex_count() / 3);
        };
        check(&mut |mesh| run(mesh, target, &mut LengthCost, &options));
        check(&mut |mesh| run(mesh, target, &mut CurvatureCost, &options));
        let mut quadric = QuadricCost::new(&input, 10.0);
        check(&mut |mesh| run(mesh, target, &mut quadric, &options));
        let mut quadric = QuadricCost::probabilistic(&input, 0.01);
        check(&mut |mesh| run(mesh, target, &mut quadric, &options));
        let mut own = |mesh: &Mesh, h: HalfedgeId| mesh.position(mesh.from(h)).z;
        check(&mut |mesh| run(mesh, target, &mut own, &options));
    }
}

#[test]
fn a_cube_becomes_twelve_triangles_by_quadrics_and_curvature() {
    for n in [2, 5] {
        let input = shapes::cuboid(DVec3::ONE, [n; 3]).unwrap();
        let options = DecimationOptions::default();
        let mut mesh = input.clone();
        let mut cost = QuadricCost::new(&mesh, 10.0);
        let report = run(&mut mesh, Target::Faces(12), &mut cost, &options);
        assert_eq!(mesh.face_count(), 12);
        assert!(report.largest_error < 1e-7, "{}", report.largest_error);
        let mut mesh = input.clone();
        let report = run(&mut mesh, Target::Error(0.0), &mut CurvatureCost, &options);
        assert_eq!(report.largest_error, 0.0);
        assert!((dgp_mesh::measure::volume(&mesh) - 1.0).abs() < 1e-14);
    }
}

#[test]
fn the_input_stays_within_the_distance_asked_for() {
    let input = shapes::blob(4).unwrap();
    let limit = 0.01;
    let options = DecimationOptions { max_distance: limit, ..DecimationOptions::default() };
    let mut mesh = input.clone();
    let mut cost = QuadricCost::new(&input, 10.0);
    let report = run(&mut mesh, Target::Faces(0), &mut cost, &options);
    assert!(report.refusals.distance > 0);
    assert!(mesh.face_count() < input.face_count() / 4, "{}", mesh.face_count());
    // By brute force over samples of the result.
    let samples: Vec<DVec3> = mesh
        .faces()
        .flat_map(|f| {
            let [p, q, r] = mesh.triangle(f).unwrap().map(|v| mesh.position(v));
            let steps = 12_u32;
            (0..=steps).flat_map(move |i| {
                (0..=steps - i).map(move |j| {
                    let (s, t) = (f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps));
                    p + (q - p) * s + (r - p) * t
                })
            })
        })
        .collect();
    let spacing = mesh.edges().map(|e| mesh.edge_length(e)).fold(0.0, f64::max) / 12.0;
    for &p in input.positions().values() {
        let nearest = samples.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
        // Between samples the surface is at most half of their spacing closer.
        assert!(nearest <= limit + 0.6 * spacing, "{nearest}");
    }
}

#[test]
fn features_rims_and_corners_stay_lines() {
    let mut mesh = shapes::capped_cylinder(1.0, 2.0, 32, 8).unwrap();
    let features = sharp_edges(&mesh, 1.0);
    assert_eq!(features.len(), 64);
    let options = DecimationOptions::default();
    let none = VertexSet::new();
    let _ = decimate(
        &mut mesh,
        Target::Faces(60),
        &mut LengthCost,
        (&none, &features),
        &options,
        Progress::NONE,
    )
    .unwrap();
    mesh.validate().unwrap();
    let sharp = sharp_edges(&mesh, 0.9);
    assert!(sharp.len() >= 6);
    let rim_points = mesh.positions().values().iter().filter(|p| {
        (p.z.abs() - 1.0).abs() < 1e-12 || p.z.abs() < 1e-12 || (p.z - 2.0).abs() < 1e-12
    });
    for p in rim_points {
        let radius = p.x.hypot(p.y);
        assert!(radius < 1.0 + 1e-12);
    }
    let input = shapes::grid(8, 8).unwrap();
    let mut mesh = input.clone();
    let options = DecimationOptions { boundary: Boundary::Kept, ..options };
    let _ = run(&mut mesh, Target::Faces(0), &mut LengthCost, &options);
    let rim = |mesh: &Mesh| mesh.edges().filter(|&e| mesh.is_boundary_edge(e)).count();
    assert_eq!(rim(&mesh), rim(&input));
}

#[test]
fn costs_that_are_no_numbers_stop_it_and_everything_protected_is_said() {
    let mut mesh = shapes::icosphere(2).unwrap();
    let before = mesh.clone();
    let options = DecimationOptions::default();
    let report =
        run(&mut mesh, Target::Faces(10), &mut |_: &Mesh, _: HalfedgeId| f64::NAN, &options);
    assert_eq!((report.stop, report.collapses), (StopReason::NothingLeft, 0));
    assert_eq!((report.refusals.error, &mesh), (2 * mesh.edge_count(), &before));
    let all: VertexSet = mesh.vertices().collect();
    let none = EdgeSet::new();
    let target = Target::Faces(10);
    let report =
        decimate(&mut mesh, target, &mut LengthCost, (&all, &none), &options, Progress::NONE)
            .unwrap();
    assert_eq!((report.refusals.protected, report.collapses), (mesh.edge_count(), 0));
    let wrong = DecimationOptions { max_distance: -1.0, ..options };
    let result =
        decimate(&mut mesh, target, &mut LengthCost, (&all, &none), &wrong, Progress::NONE);
    assert!(matches!(result, Err(Error::InvalidOption { name: "max_distance", .. })));
}

#[test]
fn a_cancelled_run_leaves_a_valid_mesh() {
    for limit in [0.0, 0.1, 0.5] {
        let stop =
            |x: f64| if x > limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let mut mesh = shapes::icosphere(5).unwrap();
        let none = (&VertexSet::new(), &EdgeSet::new());
        let options = DecimationOptions::default();
        let target = Target::Faces(100);
        let result =
            decimate(&mut mesh, target, &mut LengthCost, none, &options, Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))));
        mesh.validate().unwrap();
        assert!(mesh.face_count() > 100);
    }
}

#[test]
fn thin_triangles_are_refused() {
    let input = shapes::torus(1.0, 0.3, 40, 20).unwrap();
    let options = DecimationOptions { least_shape: 0.4, ..DecimationOptions::default() };
    let mut mesh = input.clone();
    let mut cost = QuadricCost::new(&input, 10.0);
    let report = run(&mut mesh, Target::Faces(200), &mut cost, &options);
    assert!(report.refusals.shape > 0);
}
