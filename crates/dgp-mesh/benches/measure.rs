//! Measures, one-rings and search on spheres of 82 thousand, 328 thousand and 1.3 million triangles.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{
    DVec3, Progress, VertexId,
    graph::{Until, dijkstra},
    measure::{
        NormalWeight, VertexArea, area, edge_lengths, face_normals, oriented_box, vertex_areas,
        vertex_normals, volume,
    },
    shapes::icosphere,
    topology::{components, face_list_report},
};

/// Times `run` on a sphere of that many faces.
fn bench<T>(c: &mut Criterion, name: &str, faces: usize, mut run: impl FnMut() -> T) {
    let mut group = c.benchmark_group(name);
    group.sample_size(10);
    group.bench_function(BenchmarkId::new("icosphere", faces), |b| b.iter(&mut run));
    group.finish();
}

fn measures(c: &mut Criterion) {
    for level in 6..=8 {
        let mesh = icosphere(level).expect("a level that fits");
        let n = mesh.face_count();
        for (name, weight) in [
            ("vertex_normals_area", NormalWeight::Area),
            ("vertex_normals_angle", NormalWeight::Angle),
            ("vertex_normals_max", NormalWeight::Max),
        ] {
            bench(c, name, n, || vertex_normals(&mesh, weight));
        }
        bench(c, "face_normals", n, || face_normals(&mesh));
        bench(c, "vertex_areas", n, || vertex_areas(&mesh, VertexArea::MixedVoronoi));
        bench(c, "area", n, || area(&mesh));
        bench(c, "volume", n, || volume(&mesh));
        bench(c, "oriented_box", n, || oriented_box(&mesh));
        // Sums over one-rings on one thread, by half-edges and by lists.
        bench(c, "ring_sums_halfedges", n, || {
            let sum = |v| mesh.vertex_neighbors(v).map(|w| mesh.position(w)).sum::<DVec3>();
            mesh.vertices().map(sum).collect::<Vec<_>>()
        });
        let lists = mesh.vertex_adjacency();
        bench(c, "ring_sums_lists", n, || {
            let sum = |v| lists.neighbors(v).iter().map(|&w| mesh.position(w)).sum::<DVec3>();
            mesh.vertices().map(sum).collect::<Vec<_>>()
        });
        bench(c, "vertex_adjacency", n, || mesh.vertex_adjacency());
        bench(c, "components", n, || components(&mesh));
        let list = mesh.to_faces();
        bench(c, "topology_report", n, || face_list_report(mesh.vertex_count(), &list));
        let lengths = edge_lengths(&mesh);
        let source = [VertexId::new(0)];
        bench(c, "dijkstra", n, || {
            dijkstra(&mesh, &lengths, &source, Until::AllReached, Progress::NONE)
        });
    }
}

criterion_group!(benches, measures);
criterion_main!(benches);
