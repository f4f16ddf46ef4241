//! Decimation to a tenth of the faces by quadrics, by any cost, and into levels of detail; going through the levels.
//! The input's name ends with its number of faces.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{EdgeSet, Progress, VertexSet, shapes};
use dgp_remesh::{
    DecimationOptions, ProgressiveMesh, QuadricCost, QuadricOptions, Target, decimate,
    decimate_quadric,
};

fn decimation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("decimate");
    group.sample_size(10);
    for level in [6, 7] {
        let mesh = shapes::icosphere(level).expect("a small level");
        let input = format!("sphere/{}", mesh.face_count());
        let target = Target::Faces(mesh.face_count() / 10);
        let options = QuadricOptions::default();
        let none = (VertexSet::new(), EdgeSet::new());
        group.bench_function(BenchmarkId::new("quadric", &input), |b| {
            b.iter_batched(
                || mesh.clone(),
                |mut mesh| {
                    decimate_quadric(&mut mesh, target, &none.0, &options, Progress::NONE)
                        .expect("triangles")
                },
                BatchSize::LargeInput,
            );
        });
        group.bench_function(BenchmarkId::new("any cost", &input), |b| {
            b.iter_batched(
                || (mesh.clone(), QuadricCost::new(&mesh, 1.0)),
                |(mut mesh, mut cost)| {
                    let options = DecimationOptions::default();
                    let kept = (&none.0, &none.1);
                    decimate(&mut mesh, target, &mut cost, kept, &options, Progress::NONE)
                        .expect("finite")
                },
                BatchSize::LargeInput,
            );
        });
        let mut levels =
            ProgressiveMesh::new(&mesh, target, &options, Progress::NONE).expect("triangles");
        let finest = levels.level_count();
        group.bench_function(BenchmarkId::new("all levels and back", &input), |b| {
            b.iter(|| {
                levels.set_level(0).expect("the base");
                levels.set_level(finest).expect("the finest");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, decimation);
criterion_main!(benches);
