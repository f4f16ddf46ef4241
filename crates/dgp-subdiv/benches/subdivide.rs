//! Topology (the plan), values (positions of a plan that is there), both with half-edges, and limits; inputs
//! are built outside the timed part. The input's name ends with the number of refined faces.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{Mesh, Progress, shapes};
use dgp_subdiv::{
    ButterflyRule, LoopWeights, RefinementOptions, RefinementPlan, Scheme, Sharpness,
    SubdivisionOptions, subdivide,
};

const LOOP: Scheme = Scheme::Loop(LoopWeights::Original);

/// Cages with scheme and levels: one level of many faces, many levels of few.
fn cases() -> Vec<(&'static str, Mesh, Scheme, usize)> {
    let sphere = |level| shapes::icosphere(level).expect("a small level");
    let quads = |n| shapes::quad_sphere(n).expect("a small number");
    vec![
        ("loop", sphere(7), LOOP, 1),
        ("loop", sphere(2), LOOP, 6),
        ("catmull-clark", quads(128), Scheme::CatmullClark, 1),
        ("catmull-clark", quads(8), Scheme::CatmullClark, 5),
        ("butterfly", sphere(7), Scheme::Butterfly(ButterflyRule::Modified), 1),
        ("sqrt3", sphere(7), Scheme::Sqrt3, 1),
        ("doo-sabin", quads(128), Scheme::DooSabin, 1),
    ]
}

fn subdivision(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("subdivide");
    group.sample_size(10);
    for (name, mesh, scheme, levels) in cases() {
        let refinement = RefinementOptions { scheme, levels, ..RefinementOptions::default() };
        let smooth = Sharpness::new();
        let plan = || RefinementPlan::new(&mesh, &smooth, &refinement, Progress::NONE);
        let made = plan().expect("the scheme suits the cage");
        let input = format!("sphere x{levels}/{}", made.counts(levels).faces);
        let mut bench = |what: &str, run: &mut dyn FnMut()| {
            let id = BenchmarkId::new(format!("{name} {what}"), &input);
            group.bench_function(id, |b| b.iter(&mut *run));
        };
        let positions = mesh.positions().values();
        bench("topology", &mut || drop(plan().expect("as before")));
        bench("values", &mut || drop(made.refine(positions).expect("one per vertex")));
        let options = SubdivisionOptions { refinement, ..SubdivisionOptions::default() };
        bench("mesh", &mut || {
            subdivide(&mesh, &smooth, &options, Progress::NONE).map(drop).expect("as before");
        });
        if scheme.has_creases() {
            let refined = made.refine(positions).expect("one per vertex");
            bench("limit", &mut || drop(made.limit(&refined).expect("it has a limit")));
        }
        if levels == 1 {
            bench("stencils", &mut || drop(made.step_stencils(0).expect("few entries")));
        }
    }
    group.finish();
}

criterion_group!(benches, subdivision);
criterion_main!(benches);
