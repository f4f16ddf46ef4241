//! Surfaces at their limit: adaptive refinement, Phong tessellation, evaluation at parameters.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{
    FaceId, Mesh, Progress,
    measure::{NormalWeight, vertex_normals},
    shapes,
};
use dgp_subdiv::{
    AdaptiveOptions, LoopWeights, PhongOptions, RefinementOptions, RefinementPlan, Scheme,
    Sharpness, phong_tessellate, refine_to_tolerance,
};

/// Evaluations of one run.
const POINTS: usize = 100_000;

fn cases() -> [(&'static str, Mesh, Scheme); 2] {
    [
        (
            "loop",
            shapes::icosphere(3).expect("a small sphere"),
            Scheme::Loop(LoopWeights::Original),
        ),
        (
            "catmull-clark",
            shapes::quad_torus(2.0, 0.7, 40, 20).expect("a small torus"),
            Scheme::CatmullClark,
        ),
    ]
}

fn surfaces(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("surface");
    group.sample_size(10);
    for (name, mesh, scheme) in cases() {
        let smooth = Sharpness::new();
        let input = format!("{name}/{}", mesh.face_count());
        let refinement = RefinementOptions { scheme, levels: 10, ..RefinementOptions::default() };
        let options = AdaptiveOptions { refinement, ..AdaptiveOptions::default() };
        group.bench_function(BenchmarkId::new("to a tolerance", &input), |b| {
            b.iter(|| {
                refine_to_tolerance(black_box(&mesh), &smooth, &options, 1e-5, Progress::NONE)
            });
        });
        let options = RefinementOptions { scheme, levels: 1, ..RefinementOptions::default() };
        let plan = RefinementPlan::new(&mesh, &smooth, &options, Progress::NONE)
            .expect("a cage of the right faces");
        let values = plan.refine(mesh.positions().values()).expect("a value for each vertex");
        let faces = plan.counts(1).faces as usize;
        group.bench_function(BenchmarkId::new("evaluate", format!("{name}/{POINTS}")), |b| {
            b.iter(|| {
                for i in 0..POINTS {
                    let (u, v) = ((i % 37) as f64 / 74.0, (i % 41) as f64 / 82.0);
                    let point = plan.evaluate(&values, FaceId::new(i % faces), [u, v]);
                    black_box(point).expect("parameters inside of the face");
                }
            });
        });
    }
    let mesh = shapes::icosphere(5).expect("a small sphere");
    let normals = vertex_normals(&mesh, NormalWeight::Angle);
    let options = PhongOptions { segments: 8, ..PhongOptions::default() };
    let id = BenchmarkId::new("phong", mesh.face_count());
    group.bench_function(id, |b| {
        b.iter(|| phong_tessellate(black_box(&mesh), &normals, &options, Progress::NONE));
    });
    group.finish();
}

criterion_group!(benches, surfaces);
criterion_main!(benches);
