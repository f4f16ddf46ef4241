//! Time to draw a picture of 1200×900 pixels with 2×2 samples.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Progress, VertexId};
use dgp_view::{Model, RenderOptions, Scene, Style, render};

/// A torus of 2 n² triangles.
fn torus(n: usize) -> IndexedFaceSet {
    let angle = |i: usize| (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
    let point = |k: usize| {
        let ((s, c), (sb, cb)) = (angle(k / n), angle(k % n));
        DVec3::new((1.0 + 0.4 * cb) * c, 0.4 * sb, -(1.0 + 0.4 * cb) * s)
    };
    let at = |i: usize, j: usize| VertexId::new(i % n * n + j % n);
    let quad = |k: usize| {
        let (i, j) = (k / n, k % n);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let positions: Vec<DVec3> = (0..n * n).map(point).collect();
    let faces = FaceList::from_triangles((0..n * n).flat_map(quad).collect());
    IndexedFaceSet::new(positions, faces).expect("indices are below n²")
}

fn pictures(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("render");
    group.sample_size(10);
    let options = RenderOptions::default();
    let bare = RenderOptions { occlusion: 0.0, shadow: 0.0, ..options };
    for n in [187, 418, 1000] {
        let set = torus(n);
        let triangles = set.face_count();
        let cases = [
            ("smooth", Style::default(), &options),
            ("smooth without occlusion and shadow", Style::default(), &bare),
            ("faceted", Style::faceted(), &options),
        ];
        for (name, style, options) in cases {
            let scene = Scene::new(Model { style, ..Model::new(&set) });
            group.bench_function(BenchmarkId::new(name, triangles), |bencher| {
                bencher.iter(|| render(&scene, options, Progress::NONE));
            });
        }
    }
    let scene_set = torus(187);
    let (image, _) = render(&Scene::new(Model::new(&scene_set)), &options, Progress::NONE)
        .expect("default options are valid");
    group.bench_function("png/1200x900", |bencher| bencher.iter(|| image.to_png()));
    group.finish();
}

criterion_group!(benches, pictures);
criterion_main!(benches);
