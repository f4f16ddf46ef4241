//! Repair of surfaces: a sphere that needs none, and one with spikes, needles and loose patches.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{Editor, IndexedFaceSet, Mesh, Progress, VertexId, shapes};
use dgp_remesh::{
    IntersectionOptions, SliverOptions, SurfaceRepairOptions, remove_self_intersections,
    remove_slivers, repair_surface,
};

/// A sphere with twelve vertices pulled through the other side.
fn spiked(level: usize) -> Mesh {
    let mut mesh = shapes::icosphere(level).expect("a sphere");
    for v in (0..12).map(VertexId::new) {
        let p = mesh.position(v);
        mesh.set_position(v, -1.3 * p);
    }
    mesh
}

/// A mesh with two needles at one edge in fifty.
fn needled(mut mesh: Mesh) -> Mesh {
    let mut editor = Editor::new(&mut mesh);
    for e in editor.edges().step_by(50).collect::<Vec<_>>() {
        let [a, b] = editor.mesh().edge_vertices(e).map(|v| editor.mesh().position(v));
        editor.split_edge_triangles(e, a + 1e-6 * (b - a)).expect("an edge of a sphere");
    }
    let _ = editor.finish();
    mesh
}

fn loose(mesh: &Mesh) -> IndexedFaceSet {
    shapes::unweld_patch(&shapes::unweld_patch(&mesh.to_indexed(), 0.3, 1), 0.2, 2)
}

fn repairs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("surface repair");
    group.sample_size(10);
    let sound = shapes::icosphere(6).expect("a sphere").to_indexed();
    let (spiked, needled) = (spiked(6), needled(shapes::icosphere(6).expect("a sphere")));
    let loose = loose(&needled);
    let faces = sound.face_count();
    let options = SurfaceRepairOptions::default();
    for (name, set) in [("sound", &sound), ("spiked", &spiked.to_indexed()), ("loose", &loose)] {
        group.bench_function(BenchmarkId::new(name, faces), |b| {
            b.iter(|| repair_surface(black_box(set), &options, Progress::NONE));
        });
    }
    group.bench_function(BenchmarkId::new("slivers", faces), |b| {
        let slivers = SliverOptions::default();
        b.iter(|| remove_slivers(&mut black_box(needled.clone()), &slivers, Progress::NONE));
    });
    group.bench_function(BenchmarkId::new("intersections", faces), |b| {
        let cut = IntersectionOptions::default();
        b.iter(|| remove_self_intersections(&mut black_box(spiked.clone()), &cut, Progress::NONE));
    });
    group.finish();
}

criterion_group!(benches, repairs);
criterion_main!(benches);
