//! Spectra and their uses; where they are many, on a sphere small enough to be looked at ten times.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_laplace::{
    laplacian::{cotangent_laplacian, uniform_laplacian, vertex_masses},
    spectral::{
        CompressionOptions, Eigenbasis, FunctionalMap, PartitionOptions, ZoomOutOptions, compress,
        fiedler, heat_kernel_diagonal, partition, zoomout,
    },
};
use dgp_mesh::{Progress, VertexMap, shapes};
use dgp_sparse::EigenOptions;

fn spectra(criterion: &mut Criterion) {
    let mesh = shapes::with_noise(shapes::icosphere(5).unwrap(), 0.05, 1).unwrap();
    let size = mesh.vertex_count();
    let (laplacian, masses) = (cotangent_laplacian(&mesh).unwrap(), vertex_masses(&mesh));
    let (graph, ones) = (uniform_laplacian(&mesh).unwrap(), VertexMap::filled(size, 1.0));
    let eigen = EigenOptions::default();
    let waves =
        |count| Eigenbasis::new(&laplacian, &masses, count, &eigen, Progress::NONE).unwrap();
    let basis = waves(60);
    let of_graph = Eigenbasis::new(&graph, &ones, 60, &eigen, Progress::NONE).unwrap();
    let mut bench = |name: &str, run: &mut dyn FnMut()| {
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10);
        group.bench_function(BenchmarkId::new("noisy sphere", size), |b| b.iter(&mut *run));
        group.finish();
    };
    bench("eigenbasis", &mut || drop(waves(60)));
    bench("fiedler", &mut || drop(fiedler(&laplacian, &masses, Progress::NONE).unwrap()));
    bench("partition", &mut || {
        let options = PartitionOptions::default();
        drop(partition(&graph, &ones, 6, &options, Progress::NONE).unwrap());
    });
    bench("compress", &mut || {
        drop(compress(&mesh, &of_graph, 60, &CompressionOptions { bits: 14 }).unwrap());
    });
    bench("zoomout", &mut || {
        let (start, options) =
            (FunctionalMap::identity(20), ZoomOutOptions { step: 4, samples: 1000 });
        drop(zoomout(&basis, &basis, &start, &options, Progress::NONE).unwrap());
    });
    bench("heat_kernel_diagonal", &mut || drop(heat_kernel_diagonal(&basis, 0.1).unwrap()));
}

criterion_group!(benches, spectra);
criterion_main!(benches);
