//! Measures, one-rings and search on spheres of 82 thousand, 328 thousand and 1.3 million triangles.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{
    DVec3, Mesh, Progress, VertexId,
    graph::{Until, dijkstra},
    measure::{
        NormalWeight, VertexArea, area, edge_lengths, face_normals, oriented_box, vertex_areas,
        vertex_normals, volume,
    },
    shapes,
    topology::{components, face_list_report},
};

fn spheres() -> Vec<(usize, Mesh)> {
    (6..=8)
        .map(|level| shapes::icosphere(level).expect("a level that fits"))
        .map(|mesh| (mesh.face_count(), mesh))
        .collect()
}

fn measures(c: &mut Criterion) {
    for (faces, mesh) in spheres() {
        let mut bench = |name: &str, run: &dyn Fn()| {
            let mut group = c.benchmark_group(name);
            group.sample_size(10);
            group.bench_function(BenchmarkId::new("icosphere", faces), |b| b.iter(run));
            group.finish();
        };
        let normals = |weight| drop(black_box(vertex_normals(&mesh, weight)));
        bench("vertex_normals_area", &|| normals(NormalWeight::Area));
        bench("vertex_normals_angle", &|| normals(NormalWeight::Angle));
        bench("vertex_normals_max", &|| normals(NormalWeight::Max));
        bench("face_normals", &|| drop(black_box(face_normals(&mesh))));
        bench("vertex_areas_voronoi", &|| {
            drop(black_box(vertex_areas(&mesh, VertexArea::MixedVoronoi)));
        });
        bench("area", &|| drop(black_box(area(&mesh))));
        bench("volume", &|| drop(black_box(volume(&mesh))));
        bench("oriented_box", &|| drop(black_box(oriented_box(&mesh))));
        // One-ring sums one after the other, by half-edges and by lists.
        bench("ring_sums_halfedges", &|| {
            let sum = |v| mesh.vertex_neighbors(v).map(|w| mesh.position(w)).sum::<DVec3>();
            drop(black_box(mesh.vertices().map(sum).collect::<Vec<_>>()));
        });
        let lists = mesh.vertex_adjacency();
        bench("ring_sums_lists", &|| {
            let sum = |v| lists.neighbors(v).iter().map(|&w| mesh.position(w)).sum::<DVec3>();
            drop(black_box(mesh.vertices().map(sum).collect::<Vec<_>>()));
        });
        bench("vertex_adjacency", &|| drop(black_box(mesh.vertex_adjacency())));
        bench("components", &|| drop(black_box(components(&mesh))));
        let list = mesh.to_faces();
        bench("topology_report", &|| {
            drop(black_box(face_list_report(mesh.vertex_count(), &list)));
        });
        let lengths = edge_lengths(&mesh);
        bench("dijkstra", &|| {
            let source = [VertexId::new(0)];
            let found = dijkstra(&mesh, &lengths, &source, Until::AllReached, Progress::NONE);
            drop(black_box(found));
        });
    }
}

criterion_group!(benches, measures);
criterion_main!(benches);
