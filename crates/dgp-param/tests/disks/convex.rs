//! Maps to a convex outline: linear precision, folds, arc length, threads.

use dgp_laplace::intrinsic::{IntrinsicOptions, intrinsic_delaunay};
use dgp_mesh::{DVec2, DVec3, Progress, VertexId, VertexMap, shapes};
use dgp_param::{
    Outline, Weights, boundary_crossings, convex_boundary, disk_boundary, distortion,
    map_to_boundary, map_with_laplacian,
};

use super::{bent_grid, hills};

const ALL: [Weights; 3] = [Weights::Uniform, Weights::Harmonic, Weights::MeanValue];

#[test]
fn a_flat_mesh_maps_to_itself() {
    // A disk with vertices moved about, and another numbering of the plane.
    let mut mesh = shapes::disk(9).unwrap();
    mesh.set_positions(mesh.positions().map(|p| {
        let inside = 0.02 * (1.0 - p.length_squared());
        *p + inside * DVec3::new((37.0 * p.y).sin(), (41.0 * p.x).cos(), 0.0)
    }));
    let flat: VertexMap<DVec2> = mesh.positions().map(|p| p.truncate());
    let rim = disk_boundary(&mesh).unwrap();
    let held: Vec<DVec2> = rim.iter().map(|&v| flat[v]).collect();
    // Turned out of its plane.
    let [x, y] = [DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.48, 0.8, -0.36)];
    mesh.set_positions(mesh.positions().map(|p| x * p.x + y * p.y));
    for weights in [Weights::Harmonic, Weights::MeanValue] {
        let map = map_to_boundary(&mesh, &rim, &held, weights, Progress::NONE).unwrap();
        let worst = mesh.vertices().map(|v| map[v].distance(flat[v])).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{weights:?}: {worst:e}");
    }
    let intrinsic = intrinsic_delaunay(&mesh, &IntrinsicOptions::default(), Progress::NONE);
    let laplacian = intrinsic.unwrap().laplacian;
    let map = map_with_laplacian(&laplacian, &rim, &held, Progress::NONE).unwrap();
    let worst = mesh.vertices().map(|v| map[v].distance(flat[v])).fold(0.0, f64::max);
    assert!(worst < 1e-12, "intrinsic: {worst:e}");
}

#[test]
fn each_vertex_inside_is_the_mean_of_its_neighbors_under_tutte() {
    let mesh = hills(12);
    let rim = disk_boundary(&mesh).unwrap();
    let held = convex_boundary(&mesh, &rim, &Outline::Circle).unwrap();
    let map = map_to_boundary(&mesh, &rim, &held, Weights::Uniform, Progress::NONE).unwrap();
    for v in mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)) {
        let around: Vec<DVec2> = mesh.vertex_neighbors(v).map(|w| map[w]).collect();
        let mean = around.iter().sum::<DVec2>() / around.len() as f64;
        assert!(mean.distance(map[v]) < 1e-14, "{v}");
    }
    for (v, p) in rim.iter().zip(&held) {
        assert_eq!(map[*v], *p);
    }
}

#[test]
fn positive_weights_never_fold() {
    // Long thin triangles, among which cotangents are negative.
    let wild = bent_grid(14, |p| {
        let q = 3.0 * p;
        DVec3::new(12.0 * q.x + 4.0 * (2.0 * q.y).sin(), q.y, 6.0 * (3.0 * q.x + q.y).sin())
    });
    for mesh in [hills(20), wild] {
        let rim = disk_boundary(&mesh).unwrap();
        // A pentagon has corners of more than a right angle, where the grid has a vertex on one face only.
        for outline in [Outline::Circle, Outline::Square] {
            let held = convex_boundary(&mesh, &rim, &outline).unwrap();
            assert!(boundary_crossings(&held).is_empty());
            for weights in [Weights::Uniform, Weights::MeanValue] {
                let map = map_to_boundary(&mesh, &rim, &held, weights, Progress::NONE).unwrap();
                let report = distortion(&mesh, &map).unwrap();
                assert_eq!(report.flipped, 0, "{outline:?} {weights:?}");
            }
        }
    }
}

#[test]
fn boundaries_follow_their_outline_by_arc_length() {
    let mesh = hills(10);
    let rim = disk_boundary(&mesh).unwrap();
    let length = |i: usize| mesh.position(rim[i]).distance(mesh.position(rim[(i + 1) % rim.len()]));
    let total: f64 = (0..rim.len()).map(length).sum();
    let circle = convex_boundary(&mesh, &rim, &Outline::Circle).unwrap();
    let center = DVec2::splat(0.5);
    for i in 0..rim.len() {
        let (a, b) = (circle[i] - center, circle[(i + 1) % rim.len()] - center);
        assert!((a.length() - 0.5).abs() < 1e-15);
        let turned = a.angle_to(b);
        assert!((turned - std::f64::consts::TAU * length(i) / total).abs() < 1e-12);
    }
    let pentagon: Vec<DVec2> =
        (0..5).map(|k| DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 5.0)).collect();
    let points = convex_boundary(&mesh, &rim, &Outline::Polygon(pentagon.clone())).unwrap();
    assert_eq!(points[0], pentagon[0]);
    let at: Vec<usize> =
        pentagon.iter().map(|c| points.iter().position(|p| p == c).unwrap()).collect();
    assert!(at.windows(2).all(|pair| pair[0] < pair[1]), "{at:?}");
    // The corners come within half an edge or so of a fifth of the way each.
    for (k, &corner) in at.iter().enumerate() {
        let done: f64 = (0..corner).map(length).sum();
        let off = (done - total * k as f64 / 5.0).abs();
        assert!(off <= length(corner).max(length((corner + rim.len() - 1) % rim.len())), "{k}");
    }
}

#[test]
fn holes_stay_open_and_the_longest_loop_is_the_boundary() {
    let mesh = shapes::annulus(0.4, 1.0, 24, 4).unwrap();
    let rim = disk_boundary(&mesh).unwrap();
    let outer = |v: VertexId| mesh.position(v).length() > 0.99;
    assert_eq!(rim.len(), 24);
    assert!(rim.iter().all(|&v| outer(v)));
    let held: Vec<DVec2> = rim.iter().map(|&v| mesh.position(v).truncate()).collect();
    for weights in ALL {
        let map = map_to_boundary(&mesh, &rim, &held, weights, Progress::NONE).unwrap();
        let report = distortion(&mesh, &map).unwrap();
        assert_eq!(report.flipped, 0, "{weights:?}");
    }
}

#[test]
fn a_rim_is_given_counterclockwise_and_starts_with_its_smallest_vertex() {
    let mesh = shapes::disk(5).unwrap();
    let rim = disk_boundary(&mesh).unwrap();
    assert_eq!(rim.first(), rim.iter().min());
    for i in 0..rim.len() {
        let (a, b) = (mesh.position(rim[i]), mesh.position(rim[(i + 1) % rim.len()]));
        assert!(a.cross(b).z > 0.0);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mesh = hills(40);
    let rim = disk_boundary(&mesh).unwrap();
    let held = convex_boundary(&mesh, &rim, &Outline::Square).unwrap();
    for weights in ALL {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let map = map_to_boundary(&mesh, &rim, &held, weights, Progress::NONE).unwrap();
                map.values().iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>()
            })
        };
        assert!(run(1) == run(3), "{weights:?}");
    }
}
