//! Ten iterations of each method; inputs are built outside the timed part.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_laplace::smooth::{
    BilateralOptions, CotangentOptions, ImplicitOptions, NeighborWeight, TangentialOptions,
    TaubinOptions, UniformOptions, bilateral, cotangent, implicit, tangential, taubin, uniform,
};
use dgp_mesh::{Mesh, Progress, VertexSet, shapes};

fn smoothing(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("smooth");
    group.sample_size(10);
    for level in [6, 8] {
        let sphere = shapes::icosphere(level).expect("a small level");
        let mesh = shapes::with_noise(sphere, 0.1, 1).expect("a small amplitude");
        let input = format!("noisy sphere/{}", mesh.face_count());
        let mut bench = |name: &str, method: &dyn Fn(&mut Mesh)| {
            group.bench_function(BenchmarkId::new(name, &input), |b| {
                b.iter_batched_ref(|| mesh.clone(), |mesh| method(mesh), BatchSize::LargeInput);
            });
        };
        let none = VertexSet::new();
        bench("uniform", &|mesh| {
            uniform(mesh, &none, &UniformOptions::default(), Progress::NONE).map(drop).unwrap();
        });
        bench("taubin", &|mesh| {
            taubin(mesh, &none, &TaubinOptions::default(), Progress::NONE).map(drop).unwrap();
        });
        bench("tangential", &|mesh| {
            tangential(mesh, &none, &TangentialOptions::default(), Progress::NONE)
                .map(drop)
                .unwrap();
        });
        let area =
            TangentialOptions { weight: NeighborWeight::Area, ..TangentialOptions::default() };
        bench("tangential by area", &|mesh| {
            tangential(mesh, &none, &area, Progress::NONE).map(drop).unwrap();
        });
        bench("cotangent", &|mesh| {
            cotangent(mesh, &none, &CotangentOptions::default(), Progress::NONE).map(drop).unwrap();
        });
        if level == 6 {
            bench("implicit", &|mesh| {
                implicit(mesh, &none, &ImplicitOptions::default(), Progress::NONE)
                    .map(drop)
                    .unwrap();
            });
            bench("bilateral", &|mesh| {
                let options = BilateralOptions::default();
                bilateral(mesh, &none, &options, Progress::NONE).map(drop).unwrap();
            });
        }
    }
    group.finish();
}

criterion_group!(benches, smoothing);
criterion_main!(benches);
