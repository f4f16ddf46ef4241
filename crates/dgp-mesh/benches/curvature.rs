//! Curvatures of spheres of 82 thousand and 1.3 million triangles.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_mesh::{
    Progress,
    curvature::{
        Neighborhood, angle_defects, gaussian_curvatures, mean_curvatures, normal_cycle_curvatures,
        principal_curvatures,
    },
    measure::{VertexArea, edge_length_range},
    shapes::{icosphere, with_noise},
};

fn curvatures(c: &mut Criterion) {
    for level in [6, 8] {
        let sphere = icosphere(level).expect("a level that fits");
        let mesh = with_noise(sphere, 0.1, 1).expect("a small amplitude");
        let size = mesh.face_count();
        let mut bench = |name: &str, run: &mut dyn FnMut()| {
            let mut group = c.benchmark_group(name);
            group.sample_size(10);
            group.bench_function(BenchmarkId::new("noisy sphere", size), |b| b.iter(&mut *run));
            group.finish();
        };
        bench("angle_defects", &mut || drop(angle_defects(&mesh)));
        let area = VertexArea::MixedVoronoi;
        bench("gaussian_curvatures", &mut || drop(gaussian_curvatures(&mesh, area)));
        bench("mean_curvatures", &mut || drop(mean_curvatures(&mesh, area)));
        bench("principal_curvatures", &mut || drop(principal_curvatures(&mesh)));
        let ring = Neighborhood::OneRing;
        bench("normal_cycle_one_ring", &mut || {
            drop(normal_cycle_curvatures(&mesh, ring, Progress::NONE));
        });
        if level == 6 {
            let edge = edge_length_range(&mesh).expect("edges").mean;
            let ball = Neighborhood::Ball(3.0 * edge);
            bench("normal_cycle_ball", &mut || {
                drop(normal_cycle_curvatures(&mesh, ball, Progress::NONE));
            });
        }
    }
}

criterion_group!(benches, curvatures);
criterion_main!(benches);
