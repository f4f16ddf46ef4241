//! Decimation in passes, and the last step that fits vertices to the input.

use std::ops::ControlFlow;

use dgp_mesh::{
    Mesh, Progress, VertexSet, shapes,
    spatial::{DeviationOptions, TriangleTree, deviation},
    topology::euler_characteristic,
};
use dgp_remesh::{
    Error, Memory, Order, QuadricOptions, StopReason, Target, Volume, decimate_quadric,
};

fn run(mesh: &mut Mesh, target: Target, options: &QuadricOptions) -> StopReason {
    let report = decimate_quadric(mesh, target, &VertexSet::new(), options, Progress::NONE);
    mesh.validate().expect("a valid mesh");
    report.expect("a mesh of triangles").stop
}

fn inputs() -> Vec<Mesh> {
    vec![
        shapes::icosphere(4).unwrap(),
        shapes::torus(1.0, 0.3, 40, 20).unwrap(),
        shapes::with_holes(&shapes::icosphere(4).unwrap(), 3, 1, 5).unwrap(),
        shapes::surface_of_genus(3, 2).unwrap(),
        shapes::capped_cone(1.0, 2.0, 20, 5).unwrap(),
        shapes::grid(20, 15).unwrap(),
    ]
}

fn rms(from: &Mesh, to: &Mesh) -> f64 {
    let [a, b] = [from, to].map(|mesh| TriangleTree::new(mesh, Progress::NONE).unwrap());
    deviation(&a, &b, &DeviationOptions::default(), Progress::NONE).unwrap().rms
}

#[test]
fn passes_reach_every_target_on_vertices_of_the_input() {
    for input in inputs() {
        for part in [2, 5, 20] {
            let mut mesh = input.clone();
            let target = Target::Faces(input.face_count() / part);
            assert_eq!(run(&mut mesh, target, &QuadricOptions::fast()), StopReason::TargetReached);
            assert!(mesh.face_count() <= input.face_count() / part);
            assert_eq!(euler_characteristic(&mesh), euler_characteristic(&input));
            let there = input.positions().values();
            assert!(mesh.positions().values().iter().all(|p| there.contains(p)));
        }
    }
    let mut ball = shapes::icosphere(3).unwrap();
    let stop = run(&mut ball, Target::Faces(0), &QuadricOptions::fast());
    assert_eq!((ball.face_count(), stop), (4, StopReason::NothingLeft));
    let mut ball = shapes::icosphere(4).unwrap();
    let stop = run(&mut ball, Target::Error(0.02), &QuadricOptions::fast());
    assert_eq!(stop, StopReason::NothingLeft);
    assert!(ball.face_count() < 3000 && ball.face_count() > 50, "{}", ball.face_count());
}

#[test]
fn passes_are_not_far_from_the_best_order() {
    let input = shapes::blob(5).unwrap();
    let target = Target::Faces(input.face_count() / 10);
    let [mut best, mut passes] = [input.clone(), input.clone()];
    run(&mut best, target, &QuadricOptions::default());
    run(&mut passes, target, &QuadricOptions { order: Order::Passes, ..QuadricOptions::default() });
    let (best, passes) = (rms(&best, &input), rms(&passes, &input));
    assert!(passes < 1.3 * best, "{passes} {best}");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let input = shapes::blob(5).unwrap();
    for options in [
        QuadricOptions::fast(),
        QuadricOptions { order: Order::Passes, polish: 2, ..QuadricOptions::default() },
    ] {
        let results = [1, 2, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut mesh = input.clone();
            pool.install(|| run(&mut mesh, Target::Faces(999), &options));
            mesh
        });
        assert_eq!(results[0], results[1]);
        assert_eq!(results[0], results[2]);
    }
}

#[test]
fn polish_comes_closer_and_moves_nothing_that_is_held() {
    for input in [shapes::blob(5).unwrap(), shapes::torus(1.0, 0.3, 80, 40).unwrap()] {
        let target = Target::Faces(input.face_count() / 10);
        let fixed: VertexSet = input.vertices().filter(|v| v.index() % 97 == 0).collect();
        let [plain, polished] = [0, 2].map(|polish| {
            let mut mesh = input.clone();
            let options = QuadricOptions { polish, ..QuadricOptions::default() };
            let report = decimate_quadric(&mut mesh, target, &fixed, &options, Progress::NONE);
            mesh.validate().unwrap();
            for v in fixed.iter() {
                let now = report.as_ref().unwrap().vertex_map[v];
                assert_eq!(mesh.position(now), input.position(v));
            }
            mesh
        });
        assert_eq!(plain.connectivity(), polished.connectivity());
        let (before, after) = (rms(&input, &plain), rms(&input, &polished));
        assert!(after < 0.97 * before, "{before} {after}");
    }
    // Rims and flat pieces stay.
    let mut grid = shapes::grid(12, 9).unwrap();
    let bounds = dgp_mesh::measure::bounding_box(&grid);
    run(&mut grid, Target::Faces(20), &QuadricOptions { polish: 3, ..QuadricOptions::default() });
    assert_eq!(dgp_mesh::measure::bounding_box(&grid), bounds);
}

#[test]
fn cancelled_passes_leave_a_valid_mesh() {
    for limit in [0.0, 0.2, 0.6] {
        let stop =
            |x: f64| if x > limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let mut mesh = shapes::icosphere(5).unwrap();
        let options = QuadricOptions::fast();
        let none = VertexSet::new();
        let target = Target::Faces(100);
        let result = decimate_quadric(&mut mesh, target, &none, &options, Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))));
        mesh.validate().unwrap();
        assert!(mesh.face_count() >= 100);
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let plain = QuadricOptions::default();
    for (name, options) in [
        ("attribute_weight", QuadricOptions { attribute_weight: -1.0, ..plain }),
        ("largest_turn", QuadricOptions { largest_turn: f64::NAN, ..plain }),
        ("damping", QuadricOptions { damping: f64::INFINITY, ..plain }),
        ("memory", QuadricOptions { memory: Memory::Blend(-0.5), volume: Volume::Free, ..plain }),
    ] {
        let mut mesh = shapes::icosphere(1).unwrap();
        let none = VertexSet::new();
        let result =
            decimate_quadric(&mut mesh, Target::Faces(10), &none, &options, Progress::NONE);
        match result {
            Err(Error::InvalidOption { name: told, .. }) => assert_eq!(told, name),
            other => panic!("{other:?}"),
        }
    }
}
