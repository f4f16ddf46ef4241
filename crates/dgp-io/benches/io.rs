//! Reading and writing each format, in memory: `read/ply_little_endian/1310720` and the like.

use std::{hint::black_box, time::Duration};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use dgp_io::{Document, Encoding, Format, WriteOptions, read_bytes, write_bytes};
use dgp_mesh::{Progress, shapes};

/// Spheres of 81,920 and 1,310,720 triangles whose coordinates are of single precision, as scanners
/// and binary files give them.
const LEVELS: [usize; 2] = [6, 8];

const CASES: [(Format, Encoding); 8] = [
    (Format::Ply, Encoding::LittleEndian),
    (Format::Ply, Encoding::BigEndian),
    (Format::Ply, Encoding::Text),
    (Format::Stl, Encoding::LittleEndian),
    (Format::Stl, Encoding::Text),
    (Format::Off, Encoding::Text),
    (Format::Obj, Encoding::Text),
    (Format::Xyz, Encoding::Text),
];

fn sphere(level: usize) -> Document {
    let mesh = shapes::icosphere(level).expect("the level is in range");
    let mut document = Document::from(&mesh);
    for position in document.set.positions_mut() {
        *position = position.as_vec3().as_dvec3();
    }
    document
}

fn files(criterion: &mut Criterion) {
    for level in LEVELS {
        let document = sphere(level);
        let triangles = document.set.face_count();
        for (format, encoding) in CASES {
            let name = format!("{}_{}", format.name(), encoding.to_string().replace(' ', "_"));
            let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
            let write = || write_bytes(&document, format, &options, Progress::NONE);
            let (bytes, _) = write().expect("every format takes triangles");
            let mut group = criterion.benchmark_group("read");
            group.sample_size(10).measurement_time(Duration::from_secs(2));
            group.throughput(Throughput::Bytes(bytes.len() as u64));
            group.bench_function(BenchmarkId::new(&name, triangles), |bencher| {
                bencher.iter(|| read_bytes(black_box(&bytes), format));
            });
            group.finish();
            let mut group = criterion.benchmark_group("write");
            group.sample_size(10).measurement_time(Duration::from_secs(2));
            group.throughput(Throughput::Bytes(bytes.len() as u64));
            group.bench_function(BenchmarkId::new(&name, triangles), |bencher| bencher.iter(write));
            group.finish();
        }
    }
}

criterion_group!(benches, files);
criterion_main!(benches);
