//! Building shapes, and cutting polygons into triangles.

use std::f64::consts::TAU;

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{
    DVec3, Progress, TriangulationMethod, shapes, shapes::Random, triangulate, triangulate_polygon,
};

fn building(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("shapes");
    group.sample_size(10);
    for level in [6, 8] {
        group.bench_function(BenchmarkId::new("icosphere", 20 << (2 * level)), |b| {
            b.iter(|| shapes::icosphere(level).expect("a small level"));
        });
    }
    group.bench_function(BenchmarkId::new("trefoil", 101_400), |b| {
        b.iter(|| shapes::trefoil(780, 65).expect("a small size"));
    });
    group.finish();
}

fn cutting(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("triangulate");
    group.sample_size(10);
    for n in [1_000, 100_000] {
        let mut random = Random::new(5);
        let circle: Vec<DVec3> = (0..n)
            .map(|i| {
                let (sin, cos) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
                (1.0 + random.uniform()) * DVec3::new(cos, sin, 0.3 * cos)
            })
            .collect();
        group.bench_function(BenchmarkId::new("polygon/rough circle", n), |b| {
            b.iter(|| triangulate_polygon(&circle, TriangulationMethod::Ears));
        });
    }
    let quads = shapes::quad_torus(2.0, 1.0, 1024, 640).expect("a small size");
    group.bench_function(BenchmarkId::new("mesh/quad torus", quads.face_count()), |b| {
        b.iter_batched_ref(
            || quads.clone(),
            |mesh| triangulate(mesh, TriangulationMethod::Ears, Progress::NONE).map(drop),
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

criterion_group!(benches, building, cutting);
criterion_main!(benches);
