//! Points on a sphere, and its remeshing by centroidal Voronoi cells.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{Progress, shapes};
use dgp_remesh::{
    BlueNoiseOptions, PoissonOptions, VoronoiOptions, sample_blue_noise, sample_poisson_disk,
    sample_stratified, sample_uniform, voronoi_remesh,
};

fn sampling(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sample");
    group.sample_size(10);
    let mesh = shapes::icosphere(6).expect("a sphere");
    let count = 10_000;
    group.bench_function(BenchmarkId::new("uniform/sphere", count), |b| {
        b.iter(|| sample_uniform(black_box(&mesh), count, 1, Progress::NONE));
    });
    group.bench_function(BenchmarkId::new("stratified/sphere", count), |b| {
        b.iter(|| sample_stratified(black_box(&mesh), count, 1, Progress::NONE));
    });
    group.bench_function(BenchmarkId::new("blue noise/sphere", count), |b| {
        let options = BlueNoiseOptions::default();
        b.iter(|| sample_blue_noise(black_box(&mesh), count, &options, Progress::NONE));
    });
    group.bench_function(BenchmarkId::new("poisson disk/sphere", count), |b| {
        // About as many points.
        let radius = 0.0296;
        let options = PoissonOptions::default();
        b.iter(|| sample_poisson_disk(black_box(&mesh), radius, &options, Progress::NONE));
    });
    group.finish();

    let mut group = criterion.benchmark_group("voronoi");
    group.sample_size(10);
    for vertices in [1000, 10_000] {
        group.bench_function(BenchmarkId::new("sphere", vertices), |b| {
            let options = VoronoiOptions::default();
            b.iter(|| voronoi_remesh(black_box(&mesh), vertices, &options, Progress::NONE));
        });
    }
    group.finish();
}

criterion_group!(benches, sampling);
criterion_main!(benches);
