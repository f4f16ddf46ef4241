//! Holes: covers of rims of several lengths, and a fair patch.

use std::{f64::consts::PI, hint::black_box};

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{Editor, FaceSet, Mesh, Progress, shapes};
use dgp_remesh::{FillOptions, LongestRim, Patch, fill_holes};

/// A ring whose inner rim has so many corners and goes up and down.
fn ring(corners: usize) -> Mesh {
    let mut mesh = shapes::annulus(0.5, 1.0, corners, 1).expect("a ring");
    for v in mesh.vertices().collect::<Vec<_>>() {
        let mut p = mesh.position(v);
        p.z = 0.2 * (6.0 * p.y.atan2(p.x)).sin() * (2.0 * PI * p.x).cos();
        mesh.set_position(v, p);
    }
    mesh
}

/// A sphere without a cap.
fn bowl(level: usize) -> Mesh {
    let mut mesh = shapes::icosphere(level).expect("a sphere");
    let cap: FaceSet = mesh.faces().filter(|&f| mesh.face_center(f).z > 0.8).collect();
    let mut editor = Editor::new(&mut mesh);
    let _ = editor.remove_faces(&cap).expect("faces that are there");
    editor.remove_isolated_vertices();
    let _ = editor.finish();
    mesh
}

fn holes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("holes");
    group.sample_size(10);
    for corners in [100, 300, 1000, 5000] {
        let mesh = ring(corners);
        let longest = LongestRim::Keep;
        let options = FillOptions { patch: Patch::Cover, longest, ..FillOptions::default() };
        group.bench_function(BenchmarkId::new("cover", corners), |b| {
            let run = |mut mesh| fill_holes(black_box(&mut mesh), &options, Progress::NONE);
            b.iter_batched(|| mesh.clone(), run, BatchSize::LargeInput);
        });
    }
    let mesh = bowl(6);
    group.bench_function(BenchmarkId::new("fair", mesh.face_count()), |b| {
        let options = FillOptions::default();
        let run = |mut mesh| fill_holes(black_box(&mut mesh), &options, Progress::NONE);
        b.iter_batched(|| mesh.clone(), run, BatchSize::LargeInput);
    });
    group.finish();
}

criterion_group!(benches, holes);
criterion_main!(benches);
