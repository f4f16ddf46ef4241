//! Points on surfaces: how they are spread, what they know, and what is refused.

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicUsize, Ordering::Relaxed},
};

use dgp_mesh::{
    Color, DVec2, DVec3, FaceId, IndexedFaceSet, Mesh, Progress, UV, VertexId,
    measure::{area, face_areas},
    shapes,
    spatial::PointTree,
};
use dgp_remesh::{
    BlueNoiseOptions, Error, PoissonOptions, SampleNormal, SurfaceSample, sample_attributes,
    sample_blue_noise, sample_normals, sample_poisson_disk, sample_stratified, sample_uniform,
};

fn positions(samples: &[SurfaceSample]) -> Vec<DVec3> {
    samples.iter().map(|sample| sample.position).collect()
}

/// Each sample is where its face and weights say.
fn are_on(mesh: &Mesh, samples: &[SurfaceSample]) {
    for sample in samples {
        let weights = sample.barycentric;
        assert!(weights.iter().all(|&x| (0.0..=1.0).contains(&x)), "{sample:?}");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{sample:?}");
        let corners = mesh.face_vertices(sample.face).zip(weights);
        let p: DVec3 = corners.map(|(v, weight)| weight * mesh.position(v)).sum();
        assert!(p.distance(sample.position) < 1e-14 * (1.0 + p.length()), "{sample:?}");
    }
}

/// A sphere whose triangles have areas from 1 to 30.
fn uneven() -> Mesh {
    let mut mesh = shapes::icosphere(3).unwrap();
    for v in mesh.vertices().collect::<Vec<_>>() {
        let p = mesh.position(v);
        mesh.set_position(v, p * (1.5 + p.z).powi(2));
    }
    mesh
}

fn cube() -> Mesh {
    shapes::cuboid(DVec3::ONE, [1, 1, 1]).unwrap()
}

/// χ² of the numbers of samples in faces against areas, per degree of freedom.
fn chi_square(mesh: &Mesh, samples: &[SurfaceSample]) -> f64 {
    let areas = face_areas(mesh);
    let whole = area(mesh);
    let mut counts = vec![0.0; mesh.face_count()];
    for sample in samples {
        counts[sample.face.index()] += 1.0;
    }
    let expected = |f: usize| areas[FaceId::new(f)] / whole * samples.len() as f64;
    let sum: f64 = counts
        .iter()
        .enumerate()
        .map(|(f, count)| (count - expected(f)).powi(2) / expected(f))
        .sum();
    sum / (mesh.face_count() - 1) as f64
}

#[test]
fn points_fall_on_faces_as_on_areas() {
    let mesh = uneven();
    for seed in 0..4 {
        let samples = sample_uniform(&mesh, 200_000, seed, Progress::NONE).unwrap();
        assert_eq!(samples.len(), 200_000);
        are_on(&mesh, &samples);
        // 1279 degrees of freedom: the deviation of the quotient is √(2/1279) = 0.04.
        let quotient = chi_square(&mesh, &samples);
        assert!((quotient - 1.0).abs() < 0.16, "{seed}: {quotient}");
    }
    // Within a triangle all places are alike: numbers in its 64 parts.
    let triangle = shapes::grid(1, 1).unwrap();
    let samples = sample_uniform(&triangle, 100_000, 1, Progress::NONE).unwrap();
    let mut counts = vec![0.0; 128];
    for sample in &samples {
        let [x, y, _] = sample.position.to_array();
        let (x, y) = ((8.0 * x) as usize, (8.0 * y) as usize);
        counts[64 * sample.face.index() + 8 * y.min(7) + x.min(7)] += 1.0;
    }
    let whole = 2.0 * 100_000.0 / 128.0;
    // Squares on the diagonal have half in each triangle.
    let full: Vec<f64> = counts.iter().copied().filter(|&count| count > 0.75 * whole).collect();
    assert_eq!(full.len(), 56);
    assert!(full.iter().all(|count| (count - whole).abs() < 5.0 * whole.sqrt()), "{full:?}");
}

#[test]
fn strata_have_one_point_each() {
    let mesh = uneven();
    let areas = face_areas(&mesh);
    for count in [100, 1000, 50_000] {
        let samples = sample_stratified(&mesh, count, 5, Progress::NONE).unwrap();
        assert_eq!(samples.len(), count);
        are_on(&mesh, &samples);
        let mut counts = vec![0.0; mesh.face_count()];
        for sample in samples {
            counts[sample.face.index()] += 1.0;
        }
        let expected = |f: usize| areas[FaceId::new(f)] / area(&mesh) * count as f64;
        let most = (0..counts.len()).map(|f| (counts[f] - expected(f)).abs()).fold(0.0, f64::max);
        assert!(most < 2.0, "{count}: {most}");
    }
    // Better than independent points: χ² is far below 1 where parts are smaller than faces.
    let samples = sample_stratified(&mesh, 50_000, 5, Progress::NONE).unwrap();
    assert!(chi_square(&mesh, &samples) < 0.1);
}

#[test]
fn disks_neither_overlap_nor_leave_room() {
    let plate = shapes::cuboid(DVec3::new(2.0, 1.0, 0.01), [1, 1, 1]).unwrap();
    for (name, mesh, radius) in [
        ("uneven", uneven(), 0.2),
        ("large faces", cube(), 0.05),
        ("small faces", shapes::icosphere(5).unwrap(), 0.3),
        ("thin", plate, 0.1),
        ("one point", shapes::icosphere(2).unwrap(), 3.0),
    ] {
        let options = PoissonOptions { seed: 3, ..PoissonOptions::default() };
        let (samples, report) =
            sample_poisson_disk(&mesh, radius, &options, Progress::NONE).unwrap();
        are_on(&mesh, &samples);
        let points = positions(&samples);
        let mut least = f64::INFINITY;
        for (i, p) in points.iter().enumerate() {
            for q in &points[..i] {
                least = least.min(p.distance(*q));
            }
        }
        assert!(least >= radius, "{name}: {least}");
        assert_eq!(least, report.least_distance, "{name}");
        assert!(report.coverage <= radius * (1.0 + 2e-5), "{name}: {report:?}");
        let tree = PointTree::new(&points, Progress::NONE).unwrap();
        let anywhere = sample_uniform(&mesh, 50_000, 9, Progress::NONE).unwrap();
        let found = tree.nearest_each(&positions(&anywhere), Progress::NONE).unwrap();
        let farthest = found.iter().map(|near| near.distance).fold(0.0, f64::max);
        assert!(farthest <= report.coverage, "{name}: {farthest}");
        if radius > 2.0 {
            assert_eq!(samples.len(), 1);
        }
    }
}

/// The density of pairs at distances of up to `reach`, in `bins`, over that of independent points.
fn pair_correlation(points: &[DVec3], area: f64, reach: f64, bins: usize) -> Vec<f64> {
    let mut counts = vec![0.0; bins];
    for (i, p) in points.iter().enumerate() {
        for q in &points[..i] {
            let bin = (p.distance(*q) / reach * bins as f64) as usize;
            if bin < bins {
                counts[bin] += 1.0;
            }
        }
    }
    let n = points.len() as f64;
    let ring = |k: usize| {
        let at = |k: usize| (k as f64 * reach / bins as f64).powi(2);
        std::f64::consts::PI * (at(k + 1) - at(k))
    };
    counts.iter().enumerate().map(|(k, count)| count / (0.5 * n * n * ring(k) / area)).collect()
}

/// The mean power of waves on the unit square with so many periods, 1 for independent points.
fn power(points: &[DVec3], periods: i32) -> f64 {
    let mut powers = Vec::new();
    for kx in -periods..=periods {
        for ky in 0..=periods {
            let length = f64::from(kx * kx + ky * ky).sqrt();
            if (length - f64::from(periods)).abs() < 0.5 {
                let (mut re, mut im) = (0.0, 0.0);
                for p in points {
                    let phase = std::f64::consts::TAU * (f64::from(kx) * p.x + f64::from(ky) * p.y);
                    re += phase.cos();
                    im += phase.sin();
                }
                powers.push((re * re + im * im) / points.len() as f64);
            }
        }
    }
    powers.iter().sum::<f64>() / powers.len() as f64
}

#[test]
fn the_noise_is_blue() {
    let square = shapes::grid(1, 1).unwrap();
    let n = 1500;
    let white = positions(&sample_uniform(&square, n, 2, Progress::NONE).unwrap());
    let options = BlueNoiseOptions { seed: 2, ..BlueNoiseOptions::default() };
    let (samples, report) = sample_blue_noise(&square, n, &options, Progress::NONE).unwrap();
    assert_eq!((samples.len(), report.candidates), (n, 5 * n));
    let blue = positions(&samples);
    let packed = (2.0 / (3_f64.sqrt() * n as f64)).sqrt();
    assert!((report.largest_possible - packed).abs() < 1e-12);
    assert!(report.least_distance > 0.65 * packed, "{report:?}");
    let (darts, _) =
        sample_poisson_disk(&square, 0.7 * packed, &PoissonOptions::default(), Progress::NONE)
            .unwrap();
    let darts = positions(&darts);
    for (name, points, least) in [("eliminated", &blue, 0.65), ("darts", &darts, 0.7)] {
        let pairs = pair_correlation(points, 1.0, 2.0 * packed, 20);
        // No pairs near each other, many just beyond, none more than elsewhere far away.
        let empty = (least * 10.0) as usize;
        assert!(pairs[..empty].iter().all(|&x| x == 0.0), "{name}: {pairs:?}");
        assert!(pairs.iter().copied().fold(0.0, f64::max) > 1.3, "{name}: {pairs:?}");
        assert!((pairs[17..].iter().sum::<f64>() / 3.0 - 1.0).abs() < 0.25, "{name}: {pairs:?}");
        // Long waves are missing: low powers up to half the frequency of the points, then full ones.
        let low = (1..=6).map(|k| power(points, 2 * k)).fold(0.0, f64::max);
        assert!(low < 0.3, "{name}: {low}");
        let high = power(points, (1.2 / packed) as i32);
        assert!(high > 0.5, "{name}: {high}");
    }
    let long: f64 = (1..=6).map(|k| power(&white, 2 * k)).sum::<f64>() / 6.0;
    assert!((0.6..1.5).contains(&long), "{long}");
    let pairs = pair_correlation(&white, 1.0, 2.0 * packed, 20);
    assert!((pairs.iter().sum::<f64>() / 20.0 - 1.0).abs() < 0.2, "{pairs:?}");
}

#[test]
fn so_many_points_on_curved_surfaces_are_far_apart() {
    for mesh in [uneven(), shapes::torus(2.0, 0.7, 60, 30).unwrap(), cube()] {
        let options = BlueNoiseOptions::default();
        let (samples, report) = sample_blue_noise(&mesh, 2000, &options, Progress::NONE).unwrap();
        are_on(&mesh, &samples);
        let ratio = report.least_distance / report.largest_possible;
        assert!(samples.len() == 2000 && ratio > 0.65, "{report:?}");
        // As dense everywhere: no half space has more than its share of the area.
        let (all, size) = (sample_uniform(&mesh, 100_000, 1, Progress::NONE).unwrap(), 2000.0);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 2.0, -1.0)] {
            let share = |samples: &[SurfaceSample]| {
                let inside = samples.iter().filter(|s| s.position.dot(axis) > 0.1).count();
                inside as f64 / samples.len() as f64
            };
            let off = (share(&samples) - share(&all)).abs() * size;
            assert!(off < 20.0, "{axis}: {off}");
        }
    }
}

#[test]
fn points_know_what_the_surface_has() {
    let mut mesh = shapes::icosphere(4).unwrap();
    let height: Vec<f64> = mesh.vertices().map(|v| mesh.position(v).z).collect();
    mesh.attributes_mut().vertex.insert("height", height);
    let colors: Vec<Color> =
        mesh.faces().map(|f| Color::from_rgb8([f.index() as u8, 0, 0])).collect();
    mesh.attributes_mut().face.insert("paint", colors);
    let uv: Vec<DVec2> = mesh
        .halfedges()
        .map(|h| {
            let p = mesh.position(mesh.from(h));
            DVec2::new(p.x, p.y)
        })
        .collect();
    mesh.attributes_mut().corner.insert(UV, uv);
    let set: IndexedFaceSet = mesh.to_indexed();
    let samples = sample_uniform(&set, 3000, 4, Progress::NONE).unwrap();
    assert_eq!(samples, sample_uniform(&mesh, 3000, 4, Progress::NONE).unwrap());
    let table = sample_attributes(&set, &samples);
    let normals = sample_normals(&set, &samples, SampleNormal::Smooth);
    let flat = sample_normals(&mesh, &samples, SampleNormal::Face);
    for (i, sample) in samples.iter().enumerate() {
        let v = VertexId::new(i);
        let p = sample.position;
        assert!((table.get::<f64>("height").unwrap()[v] - p.z).abs() < 1e-14);
        assert!(table.get::<DVec2>(UV).unwrap()[v].distance(p.truncate()) < 1e-14);
        let paint = table.get::<Color>("paint").unwrap()[v].to_rgba8()[0];
        assert_eq!(paint, sample.face.index() as u8);
        assert!(normals[i].distance(p.normalize()) < 0.01, "{p} {}", normals[i]);
        assert!(flat[i].distance(mesh.face_normal(sample.face)) < 1e-14);
    }
}

type Method = fn(&Mesh, f64, Progress<'_>) -> Result<Vec<SurfaceSample>, Error>;

/// Every method, by a length that it makes of the size of the surface.
const METHODS: [Method; 4] = [
    |m, _, p| sample_uniform(m, 400, 8, p),
    |m, _, p| sample_stratified(m, 400, 8, p),
    |m, _, p| sample_blue_noise(m, 400, &BlueNoiseOptions::default(), p).map(|found| found.0),
    |m, scale, p| {
        sample_poisson_disk(m, 0.2 * scale, &PoissonOptions::default(), p).map(|found| found.0)
    },
];

#[test]
fn same_bits_for_any_number_of_threads_and_scale() {
    let mesh = uneven();
    for method in METHODS {
        let run = |threads: usize, scale: f64| {
            let mut mesh = mesh.clone();
            for v in mesh.vertices().collect::<Vec<_>>() {
                mesh.set_position(v, scale * mesh.position(v));
            }
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| method(&mesh, scale, Progress::NONE)).unwrap()
        };
        let one = run(1, 1.0);
        for (threads, scale) in
            [(2, 1.0), (8, 1.0), (2, 2.0_f64.powi(300)), (2, 2.0_f64.powi(-300))]
        {
            let other = run(threads, scale);
            assert_eq!(one.len(), other.len());
            for (a, b) in one.iter().zip(&other) {
                assert_eq!((a.face, a.barycentric), (b.face, b.barycentric));
                assert_eq!(a.position * scale, b.position);
            }
        }
        // Another seed gives other points.
        assert_ne!(one, sample_uniform(&mesh, 400, 9, Progress::NONE).unwrap());
    }
}

#[test]
fn bad_input_is_named_and_runs_can_be_stopped() {
    let mesh = uneven();
    let flat = {
        let mut mesh = mesh.clone();
        for v in mesh.vertices().collect::<Vec<_>>() {
            mesh.set_position(v, DVec3::splat(mesh.position(v).x));
        }
        mesh
    };
    let mut broken = mesh.clone();
    broken.set_position(VertexId::new(4), DVec3::NAN);
    for method in METHODS {
        assert_eq!(method(&flat, 1.0, Progress::NONE), Err(Error::NoArea));
        assert_eq!(method(&Mesh::default(), 1.0, Progress::NONE), Err(Error::NoArea));
        let error = method(&broken, 1.0, Progress::NONE).unwrap_err();
        assert_eq!(error, Error::NotFinite { vertex: VertexId::new(4) });
        let error = method(&shapes::dodecahedron(), 1.0, Progress::NONE).unwrap_err();
        assert_eq!(error, Error::NotTriangle { face: FaceId::new(0), degree: 5 });
        let reports = AtomicUsize::new(0);
        let count = |_: f64| {
            reports.fetch_add(1, Relaxed);
            ControlFlow::Continue(())
        };
        let _ = method(&mesh, 1.0, Progress::new(&count)).unwrap();
        for stop in 0..reports.into_inner() {
            let seen = AtomicUsize::new(0);
            let report = |_: f64| match seen.fetch_add(1, Relaxed) {
                before if before < stop => ControlFlow::Continue(()),
                _ => ControlFlow::Break(()),
            };
            let result = method(&mesh, 1.0, Progress::new(&report));
            assert!(matches!(result, Err(Error::Cancelled(_))), "{stop}");
        }
    }
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9] {
        let options = PoissonOptions::default();
        let error = sample_poisson_disk(&mesh, radius, &options, Progress::NONE).unwrap_err();
        assert!(matches!(error, Error::InvalidOption { name: "radius", .. }), "{radius}");
    }
    let few = PoissonOptions { max_count: 50, ..PoissonOptions::default() };
    let error = sample_poisson_disk(&mesh, 0.3, &few, Progress::NONE).unwrap_err();
    assert!(matches!(error, Error::InvalidOption { name: "radius", .. }));
    let error = sample_uniform(&mesh, usize::MAX, 0, Progress::NONE).unwrap_err();
    assert!(matches!(error, Error::InvalidOption { name: "count", .. }));
    let options = BlueNoiseOptions { candidates: 0.5, ..BlueNoiseOptions::default() };
    let error = sample_blue_noise(&mesh, 10, &options, Progress::NONE).unwrap_err();
    assert!(matches!(error, Error::InvalidOption { name: "candidates", .. }));
    assert!(
        sample_blue_noise(&mesh, 0, &BlueNoiseOptions::default(), Progress::NONE)
            .unwrap()
            .0
            .is_empty()
    );
}
