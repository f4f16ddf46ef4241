//! Remeshing: five iterations at the mean length, and within a tolerance. The input's name ends with its number of faces.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{EdgeSet, Progress, VertexSet, measure::edge_length_range, shapes};
use dgp_remesh::{
    AdaptiveOptions, RemeshOptions, remesh_adaptive, remesh_isotropic, triangle_quality,
};

fn remeshing(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("remesh");
    group.sample_size(10);
    let none = (VertexSet::new(), EdgeSet::new());
    let kept = (&none.0, &none.1);
    for level in [5, 6] {
        let sphere = shapes::icosphere(level).expect("a small level");
        let mesh = shapes::with_noise(sphere, 0.005, 1).expect("a small amplitude");
        let input = format!("sphere/{}", mesh.face_count());
        let length = edge_length_range(&mesh).expect("edges").mean;
        let options = RemeshOptions { iterations: 5, ..RemeshOptions::default() };
        group.bench_function(BenchmarkId::new("isotropic", &input), |b| {
            b.iter_batched(
                || mesh.clone(),
                |mut mesh| {
                    remesh_isotropic(&mut mesh, length, kept, &options, Progress::NONE)
                        .expect("triangles")
                },
                BatchSize::LargeInput,
            );
        });
        group.bench_function(BenchmarkId::new("quality", &input), |b| {
            b.iter(|| triangle_quality(&mesh).expect("triangles"));
        });
    }
    let mesh = shapes::torus(1.0, 0.2, 200, 60).expect("a torus");
    let input = format!("torus/{}", mesh.face_count());
    let options = AdaptiveOptions::default();
    group.bench_function(BenchmarkId::new("adaptive", &input), |b| {
        b.iter_batched(
            || mesh.clone(),
            |mut mesh| {
                remesh_adaptive(&mut mesh, 0.005, kept, &options, Progress::NONE)
                    .expect("triangles")
            },
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

criterion_group!(benches, remeshing);
criterion_main!(benches);
