//! Decimation to a tenth of the faces by quadrics, by any cost, and into levels of detail; going through the levels.
//! The input's name ends with its number of faces.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{COLOR, Color, EdgeSet, Progress, VertexSet, shapes};
use dgp_remesh::{
    DecimationOptions, Order, ProgressiveMesh, QuadricCost, QuadricOptions, Target, decimate,
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
        let passes = QuadricOptions { order: Order::Passes, ..options };
        for (name, options) in
            [("quadric", options), ("passes", passes), ("fast", QuadricOptions::fast())]
        {
            group.bench_function(BenchmarkId::new(name, &input), |b| {
                b.iter_batched(
                    || mesh.clone(),
                    |mut mesh| {
                        decimate_quadric(&mut mesh, target, &none.0, &options, Progress::NONE)
                            .expect("triangles")
                    },
                    BatchSize::LargeInput,
                );
            });
        }
        let mut painted = mesh.clone();
        let colors: Vec<Color> = mesh
            .positions()
            .values()
            .iter()
            .map(|p| Color([p.x.abs() as f32, p.y.abs() as f32, p.z.abs() as f32, 1.0]))
            .collect();
        painted.attributes_mut().vertex.insert(COLOR, colors);
        let weighted = QuadricOptions { attribute_weight: 0.05, ..options };
        group.bench_function(BenchmarkId::new("with colors", &input), |b| {
            b.iter_batched(
                || painted.clone(),
                |mut mesh| {
                    decimate_quadric(&mut mesh, target, &none.0, &weighted, Progress::NONE)
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
        group.bench_function(BenchmarkId::new("a hundred levels and back", &input), |b| {
            b.iter(|| {
                levels.set_level(finest - 100).expect("a level");
                levels.set_level(finest).expect("the finest");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, decimation);
criterion_main!(benches);
