//! Smallest eigenpairs of spheres of 41 and 164 thousand vertices.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use dgp_sparse::{EigenOptions, Mass, Progress, eigenpairs};

#[path = "../tests/solvers/common/elements.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod elements;
use elements::{elements, icosphere};

fn spheres(c: &mut Criterion) {
    let mut group = c.benchmark_group("eigenpairs");
    group.sample_size(10);
    for level in [6, 7] {
        let elements = elements(&icosphere(level));
        let size = elements.lumped.len();
        for count in [50, 100, 300] {
            let id = BenchmarkId::new(format!("sphere, {count} pairs"), size);
            group.bench_function(id, |b| {
                b.iter(|| {
                    let mass = Mass::Diagonal(&elements.lumped);
                    let options = EigenOptions::default();
                    eigenpairs(&elements.laplacian, mass, count, &options, Progress::NONE)
                        .expect("a sphere has a spectrum")
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, spheres);
criterion_main!(benches);
