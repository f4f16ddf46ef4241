//! Welding, defects and repair on spheres of 82 thousand and 1.3 million triangles, good and bad.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{
    FaceId, FaceList, IndexedFaceSet, PolygonSoup, Progress, RepairOptions, Tolerance, defects,
    repair, repair_faces, shapes::icosphere, weld_exact, weld_within,
};

/// Times `run` on an input of that many faces.
fn bench<T>(c: &mut Criterion, name: &str, input: &str, faces: usize, mut run: impl FnMut() -> T) {
    let mut group = c.benchmark_group(name);
    group.sample_size(10);
    group.bench_function(BenchmarkId::new(input, faces), |b| b.iter(&mut run));
    group.finish();
}

fn welding(c: &mut Criterion) {
    for level in [6, 8] {
        let sphere = icosphere(level).expect("a level that fits").to_indexed();
        let n = sphere.face_count();
        let soup = PolygonSoup::from_indexed(&sphere);
        let corners = soup.positions().values();
        bench(c, "weld_exact", "soup", n, || weld_exact(corners));
        let tolerance = Tolerance::OfDiagonal(1e-6);
        bench(c, "weld_within", "soup", n, || weld_within(corners, tolerance, Progress::NONE));
        let welded = RepairOptions { weld: Some(Tolerance::Exact), ..RepairOptions::default() };
        let separate = soup.to_separate();
        bench(c, "repair", "soup", n, || repair(&separate, &welded, Progress::NONE));
    }
}

fn repairing(c: &mut Criterion) {
    for level in [6, 8] {
        let sphere = icosphere(level).expect("a level that fits").to_indexed();
        let n = sphere.face_count();
        for (name, set) in [("sphere", sphere.clone()), ("turned", turned(&sphere))] {
            let options = RepairOptions::default();
            bench(c, "defects", name, n, || defects(&set, Progress::NONE));
            bench(c, "repair", name, n, || repair(&set, &options, Progress::NONE));
            // What `orient_polygon_soup` of CGAL does: faces, but no half-edges.
            bench(c, "repair_faces", name, n, || {
                repair_faces(&set, &options, Progress::NONE).map(|(faces, _)| faces.face_count())
            });
        }
    }
}

/// The same faces, about half of them turned over.
fn turned(set: &IndexedFaceSet) -> IndexedFaceSet {
    let mut faces: FaceList = set.faces().clone();
    let mut state = 12345_u64;
    for f in (0..faces.len()).map(FaceId::new) {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if state >> 63 == 1 {
            faces.face_mut(f).reverse();
        }
    }
    IndexedFaceSet::new(set.positions().clone(), faces).expect("the same vertices")
}

criterion_group!(benches, welding, repairing);
criterion_main!(benches);
