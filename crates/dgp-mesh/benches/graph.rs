//! Planarity and coloring of the edges of spheres.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{
    graph::{Graph, five_coloring, planar_embedding, smallest_last_coloring},
    shapes::icosphere,
};

fn graphs(c: &mut Criterion) {
    for level in [5, 7] {
        let mesh = icosphere(level).expect("a level that fits");
        let graph = Graph::of_mesh(&mesh);
        let mut bench = |name: &str, run: &mut dyn FnMut()| {
            let mut group = c.benchmark_group(name);
            group.sample_size(10);
            let id = BenchmarkId::new("icosphere", graph.edge_count());
            group.bench_function(id, |b| b.iter(&mut *run));
            group.finish();
        };
        bench("planar_embedding", &mut || drop(planar_embedding(&graph)));
        bench("smallest_last_coloring", &mut || drop(smallest_last_coloring(&graph)));
        bench("five_coloring", &mut || drop(five_coloring(&graph)));
    }
}

criterion_group!(benches, graphs);
criterion_main!(benches);
