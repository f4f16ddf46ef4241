//! Time to lay out a bowl in the plane.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{Mesh, Progress, shapes};
use dgp_param::{
    Outline, Weights, convex_boundary, disk_boundary, distortion, least_squares_conformal,
    map_to_boundary,
};

fn bowl(rings: usize) -> Mesh {
    let mut mesh = shapes::disk(rings).expect("a disk");
    mesh.set_positions(mesh.positions().map(|p| p.with_z(p.length_squared())));
    mesh
}

fn maps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("param");
    group.sample_size(10);
    let mesh = bowl(80);
    let rim = disk_boundary(&mesh).expect("a disk");
    let outline = convex_boundary(&mesh, &rim, &Outline::Circle).expect("a loop");
    for (name, weights) in [
        ("tutte", Weights::Uniform),
        ("harmonic", Weights::Harmonic),
        ("mean value", Weights::MeanValue),
    ] {
        group.bench_function(BenchmarkId::new(name, mesh.face_count()), |b| {
            b.iter(|| map_to_boundary(black_box(&mesh), &rim, &outline, weights, Progress::NONE));
        });
    }
    group.bench_function(BenchmarkId::new("lscm", mesh.face_count()), |b| {
        b.iter(|| least_squares_conformal(black_box(&mesh), &[], Progress::NONE));
    });
    let map = map_to_boundary(&mesh, &rim, &outline, Weights::Uniform, Progress::NONE);
    let map = map.expect("a map");
    group.bench_function(BenchmarkId::new("distortion", mesh.face_count()), |b| {
        b.iter(|| distortion(black_box(&mesh), &map));
    });
    group.finish();
}

criterion_group!(benches, maps);
criterion_main!(benches);
