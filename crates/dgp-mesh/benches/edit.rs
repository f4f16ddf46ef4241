//! Edits at 1.3 million triangles: flips, collapses, splits, compaction, reordering, and what
//! reordering is worth to a walk.

use std::hint::black_box;

use criterion::{
    BatchSize, BenchmarkGroup, Criterion, criterion_group, criterion_main, measurement,
};
use dgp_mesh::{DVec3, EdgeId, Editor, Mesh, VertexId, reorder, shapes, shapes::Random};

type Group<'a> = BenchmarkGroup<'a, measurement::WallTime>;

const LEVEL: usize = 8;
const FLIPS: usize = 1_000_000;
const SPLITS: usize = 100_000;
/// Of the vertices, a tenth stays.
const KEPT: usize = 10;

fn edits(criterion: &mut Criterion) {
    let sphere = shapes::icosphere(LEVEL).expect("a level that fits");
    let shuffled = Mesh::new(&shapes::shuffled(&sphere.to_indexed(), 1)).expect("the same sphere");
    let mut group = criterion.benchmark_group("edit");
    group.sample_size(10);
    for (name, mesh) in [("natural", &sphere), ("shuffled", &shuffled)] {
        on_copies(&mut group, &format!("flip/{name}/1e6"), mesh, flip_at_random);
        on_copies(&mut group, &format!("split/{name}/1e5"), mesh, split_at_random);
        on_copies(&mut group, &format!("collapse/{name}/90%"), mesh, |mesh| {
            // Not finished, to time compaction apart.
            std::mem::forget(collapsed(mesh));
        });
        on_copies(&mut group, &format!("reorder/{name}/1.3M"), mesh, |mesh| {
            black_box(reorder(mesh));
        });
    }
    group.bench_function("compact/natural/90%", |bencher| {
        bencher.iter_custom(|rounds| {
            let mut time = std::time::Duration::ZERO;
            for _ in 0..rounds {
                let mut mesh = sphere.clone();
                let editor = collapsed(&mut mesh);
                let start = std::time::Instant::now();
                black_box(editor.finish());
                time += start.elapsed();
            }
            time
        });
    });
    let mut reordered = shuffled.clone();
    let _ = reorder(&mut reordered);
    for (name, mesh) in [("natural", &sphere), ("shuffled", &shuffled), ("reordered", &reordered)] {
        group.bench_function(format!("one_ring_sum/{name}/1.3M"), |bencher| {
            bencher.iter(|| ring_sums(mesh));
        });
    }
    group.finish();
}

fn on_copies(group: &mut Group<'_>, name: &str, mesh: &Mesh, edit: impl Fn(&mut Mesh)) {
    group.bench_function(name, |bencher| {
        bencher.iter_batched_ref(|| mesh.clone(), &edit, BatchSize::PerIteration);
    });
}

fn flip_at_random(mesh: &mut Mesh) {
    let mut random = Random::new(7);
    let edges = mesh.edge_count();
    let mut editor = Editor::new(mesh);
    let done = (0..FLIPS).filter(|_| editor.flip(EdgeId::new(random.below(edges))).is_ok()).count();
    assert!(done > FLIPS / 2, "most edges can be flipped: {done}");
}

fn split_at_random(mesh: &mut Mesh) {
    let mut random = Random::new(7);
    let edges = mesh.edge_count();
    let mut editor = Editor::new(mesh);
    for _ in 0..SPLITS {
        let e = EdgeId::new(random.below(edges));
        let [a, b] = editor.mesh().edge_vertices(e).map(|v| editor.mesh().position(v));
        editor.split_edge_triangles(e, a.midpoint(b)).expect("every edge can be split");
    }
}

/// Collapses all but a tenth of the vertices, in random order, each into the first neighbor that
/// takes it.
fn collapsed(mesh: &mut Mesh) -> Editor<'_> {
    let mut order: Vec<VertexId> = mesh.vertices().collect();
    Random::new(7).shuffle(&mut order);
    let mut editor = Editor::new(mesh);
    let target = order.len() / KEPT;
    for v in order {
        if editor.vertex_count() == target {
            break;
        }
        let start = editor.mesh().vertex_halfedge(v);
        let mut spoke = start;
        while let Some(h) = spoke
            && editor.collapse(h).is_err()
        {
            spoke = Some(editor.mesh().ccw(h)).filter(|&h| Some(h) != start);
        }
    }
    editor
}

fn ring_sums(mesh: &Mesh) -> DVec3 {
    let sums = mesh
        .vertices()
        .map(|v| -> DVec3 { mesh.vertex_neighbors(v).map(|w| mesh.position(w)).sum() });
    sums.sum()
}

criterion_group!(benches, edits);
criterion_main!(benches);
