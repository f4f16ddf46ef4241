//! Matrices of spheres of 82 thousand and 1.3 million triangles, and what is solved with them.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_laplace::{
    differential::{DifferentialOperator, EdgeWeight, RowScale},
    flow::heat_step,
    intrinsic::{
        IntrinsicOptions, PointCloudOptions, intrinsic_delaunay, point_cloud_laplacian,
        tufted_laplacian,
    },
    kernel::{HeatKernel, Neighbors, gaussian_laplacian, mesh_heat_laplacian},
    laplacian::{
        MassKind, cotangent_laplacian, mass_matrix, mean_value_laplacian, uniform_laplacian,
    },
};
use dgp_mesh::{Progress, shapes};

fn matrices(criterion: &mut Criterion) {
    for level in [6, 8] {
        let sphere = shapes::icosphere(level).expect("a small level");
        let mesh = shapes::with_noise(sphere, 0.1, 1).expect("a small amplitude");
        let set = mesh.to_indexed();
        let size = mesh.face_count();
        let mut bench = |name: &str, run: &mut dyn FnMut()| {
            let mut group = criterion.benchmark_group(name);
            group.sample_size(10);
            group.bench_function(BenchmarkId::new("noisy sphere", size), |b| b.iter(&mut *run));
            group.finish();
        };
        bench("uniform_laplacian", &mut || drop(uniform_laplacian(&mesh)));
        bench("cotangent_laplacian", &mut || drop(cotangent_laplacian(&mesh)));
        bench("mean_value_laplacian", &mut || drop(mean_value_laplacian(&mesh)));
        bench("galerkin_mass", &mut || drop(mass_matrix(&mesh, MassKind::Galerkin)));
        let options = IntrinsicOptions::default();
        bench("intrinsic_delaunay", &mut || {
            drop(intrinsic_delaunay(&mesh, &options, Progress::NONE));
        });
        bench("tufted_laplacian", &mut || drop(tufted_laplacian(&set, &options, Progress::NONE)));
        bench("differential_coordinates", &mut || {
            let operator =
                DifferentialOperator::new(&mesh, EdgeWeight::Cotangent, RowScale::Weights);
            drop(operator.expect("positive weights").coordinates(mesh.positions()));
        });
        if level == 6 {
            bench("point_cloud_laplacian", &mut || {
                let options = PointCloudOptions::default();
                drop(point_cloud_laplacian(mesh.positions(), &options, Progress::NONE));
            });
            bench("gaussian_laplacian", &mut || {
                drop(gaussian_laplacian(mesh.positions(), 1e4, Neighbors::Nearest(12)));
            });
            bench("mesh_heat_laplacian", &mut || {
                drop(mesh_heat_laplacian(&mesh, 1e-4, &HeatKernel { cutoff: 1e-4 }));
            });
            let values = mesh.positions().map(|p| p.x);
            bench("heat_step", &mut || drop(heat_step(&mesh, &values, 1e-3, Progress::NONE)));
        }
    }
}

criterion_group!(benches, matrices);
criterion_main!(benches);
