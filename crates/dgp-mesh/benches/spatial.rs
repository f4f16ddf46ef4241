//! The hierarchy of triangles on spheres of 82 thousand to 1.3 million triangles: build and queries.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use dgp_mesh::{
    DVec3, Progress,
    shapes::{Random, icosphere, with_noise},
    spatial::TriangleTree,
};

/// How many points are asked for.
const QUERIES: usize = 100_000;

/// Points in the box around the unit sphere.
fn points_in_box() -> Vec<DVec3> {
    let mut random = Random::new(1);
    let mut x = || 2.0 * random.uniform() - 1.0;
    (0..QUERIES).map(|_| DVec3::new(x(), x(), x())).collect()
}

/// Points not further than 1% from the unit sphere.
fn points_near() -> Vec<DVec3> {
    let mut random = Random::new(2);
    (0..QUERIES).map(|_| (0.99 + 0.02 * random.uniform()) * random.direction()).collect()
}

/// Times `run` on a sphere of that many faces.
fn bench<T>(c: &mut Criterion, name: &str, faces: usize, mut run: impl FnMut() -> T) {
    let mut group = c.benchmark_group(name);
    group.sample_size(10).throughput(Throughput::Elements(QUERIES as u64));
    group.bench_function(BenchmarkId::new("icosphere", faces), |b| b.iter(&mut run));
    group.finish();
}

fn spatial(c: &mut Criterion) {
    for level in 6..=8 {
        let mesh = icosphere(level).expect("a level that fits");
        let edge = 1.1 / f64::from(1 << level);
        let mesh = with_noise(mesh, 0.1 * edge, 3).expect("little noise");
        let n = mesh.face_count();
        bench(c, "tree_build", n, || TriangleTree::new(&mesh, Progress::NONE));
        let tree = TriangleTree::new(&mesh, Progress::NONE).expect("finite");
        for (name, points) in [("box", points_in_box()), ("near", points_near())] {
            bench(c, &format!("closest_{name}"), n, || {
                tree.closest_points(&points, Progress::NONE)
            });
            bench(c, &format!("closest_{name}_one_by_one"), n, || {
                points
                    .iter()
                    .filter_map(|&p| tree.closest_point(p))
                    .map(|x| x.distance)
                    .sum::<f64>()
            });
        }
    }
}

criterion_group!(benches, spatial);
criterion_main!(benches);
