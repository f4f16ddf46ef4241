//! Laws of the methods by cotangents, by solving and by normals.

use std::ops::ControlFlow;

use dgp_mesh::{
    DMat3, DVec3, Mesh, Progress, VertexId, VertexMap, VertexSet, measure, shapes, shapes::Random,
};

use super::*;
use crate::Error;

type Method =
    Box<dyn Fn(&mut Mesh, &VertexSet, Progress<'_>) -> Result<SmoothReport, Error> + Sync>;

/// All methods of this file with this boundary rule and volume.
fn methods(boundary: Boundary, volume: Volume) -> Vec<(&'static str, Method)> {
    let plain = CotangentOptions { boundary, volume, ..CotangentOptions::default() };
    let solved = ImplicitOptions { boundary, volume, iterations: 2, ..ImplicitOptions::default() };
    let even = ImplicitOptions { weight: ImplicitWeight::Uniform, ..solved };
    let normals = BilateralOptions { boundary, volume, ..BilateralOptions::default() };
    let scheme = BilateralScheme::Global { fidelity: 0.01 };
    let global = BilateralOptions { scheme, neighborhood: FaceNeighborhood::Edges, ..normals };
    vec![
        ("cotangent", Box::new(move |m, f, p| cotangent(m, f, &plain, p))),
        ("implicit", Box::new(move |m, f, p| implicit(m, f, &solved, p))),
        ("implicit uniform", Box::new(move |m, f, p| implicit(m, f, &even, p))),
        ("bilateral", Box::new(move |m, f, p| bilateral(m, f, &normals, p))),
        ("bilateral global", Box::new(move |m, f, p| bilateral(m, f, &global, p))),
    ]
}

fn plain_methods() -> Vec<(&'static str, Method)> {
    methods(Boundary::Fixed, Volume::MayChange)
}

fn moved(mesh: &Mesh, change: impl Fn(DVec3) -> DVec3) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.set_positions(mesh.positions().map(|&p| change(p)));
    mesh
}

/// A flat patch with vertices at random places.
fn uneven_plane() -> Mesh {
    let mut random = Random::new(6);
    let mut mesh = shapes::grid(12, 12).unwrap();
    let offset = |p: DVec3, random: &mut Random| {
        let inside = p.x > 0.0 && p.x < 1.0 && p.y > 0.0 && p.y < 1.0;
        let size = if inside { 0.04 } else { 0.0 };
        p + size * DVec3::new(random.uniform() - 0.5, random.uniform() - 0.5, 0.0)
    };
    let positions: Vec<DVec3> =
        mesh.positions().values().iter().map(|&p| offset(p, &mut random)).collect();
    mesh.set_positions(positions.into());
    mesh
}

#[test]
fn a_plane_stays_vertex_by_vertex_with_cotangents_and_stays_flat_with_all() {
    let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(1.0);
    let flat = uneven_plane();
    for (name, method) in plain_methods() {
        let mut mesh = flat.clone();
        let _ = method(&mut mesh, &VertexSet::new(), Progress::NONE).unwrap();
        assert!(mesh.positions().values().iter().all(|p| p.z == 0.0), "{name}: exactly flat");
        let mut tilted = moved(&flat, |p| turn * p);
        let start = tilted.clone();
        let _ = method(&mut tilted, &VertexSet::new(), Progress::NONE).unwrap();
        for v in flat.vertices() {
            assert!((turn.transpose() * tilted.position(v)).z.abs() < 1e-13, "{name} {v}");
            if name != "implicit uniform" {
                let way = tilted.position(v).distance(start.position(v));
                assert!(way < 1e-12, "{name} {v}: moved by {way}");
            }
        }
    }
}

/// The standard deviation of how far the vertices of two spheres differ in their distance from the origin.
fn radial_difference(mesh: &Mesh, other: &Mesh) -> f64 {
    let off = |v| mesh.position(v).length() - other.position(v).length();
    let count = mesh.vertex_count() as f64;
    let mean = mesh.vertices().map(off).sum::<f64>() / count;
    (mesh.vertices().map(|v| (off(v) - mean).powi(2)).sum::<f64>() / count).sqrt()
}

#[test]
fn noise_on_a_sphere_falls_and_the_volume_is_kept_on_request() {
    // Noise of normals well below σs, so that none of it counts as an edge.
    let sphere = shapes::icosphere(4).unwrap();
    let noisy = shapes::with_noise(sphere.clone(), 0.05, 7).unwrap();
    let before = radial_difference(&noisy, &sphere);
    for (name, method) in methods(Boundary::Fixed, Volume::Keep) {
        let [mut mesh, mut clean] = [noisy.clone(), sphere.clone()];
        let report = method(&mut mesh, &VertexSet::new(), Progress::NONE).unwrap();
        let _ = method(&mut clean, &VertexSet::new(), Progress::NONE).unwrap();
        // What is left of the noise; what becomes of the sphere itself is not noise.
        let after = radial_difference(&mesh, &clean);
        // The mean over a ring of seven leaves 1/√7 of white noise, and all of them average over more.
        assert!(after < before / 7.0_f64.sqrt(), "{name}: {before} → {after}");
        let (start, end) = (report.volume_before.unwrap(), report.volume_after.unwrap());
        assert!((end / start - 1.0).abs() < 1e-12, "{name}");
        assert!((end / measure::volume(&mesh) - 1.0).abs() < 1e-12, "{name}");
    }
}

/// A wave that is an eigenvector of the uniform Laplacian is divided by 1 + λk.
#[test]
fn an_implicit_step_divides_waves() {
    let (n, m) = (24, 16);
    let mut mesh = shapes::quad_torus(2.0, 1.0, n, m).unwrap();
    let angle = |a: usize, n: usize| std::f64::consts::TAU * a as f64 / n as f64;
    let wave =
        |a: usize, b: usize, v: usize| angle(a * (v % n), n).cos() * angle(b * (v / n), m).cos();
    let waves = [(1, 0), (3, 5), (12, 8)];
    let start = VertexMap::from_fn(n * m, |v: VertexId| {
        DVec3::from(waves.map(|(a, b)| wave(a, b, v.index())))
    });
    mesh.set_positions(start.clone());
    let options = ImplicitOptions {
        weight: ImplicitWeight::Uniform,
        lambda: 7.0,
        iterations: 3,
        ..ImplicitOptions::default()
    };
    let _ = implicit(&mut mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
    let gain = DVec3::from(waves.map(|(a, b)| {
        let k = 1.0 - 0.5 * (angle(a, n).cos() + angle(b, m).cos());
        (1.0 + 7.0 * k).powi(-3)
    }));
    for (v, p) in mesh.positions().iter() {
        assert!(p.abs_diff_eq(gain * start[v], 1e-12), "{v}");
    }
}

/// The mean angle between the normals of two meshes with the same faces.
fn normal_error(mesh: &Mesh, clean: &Mesh) -> f64 {
    let angle = |f| mesh.face_normal(f).angle_between(clean.face_normal(f));
    mesh.faces().map(angle).sum::<f64>() / mesh.face_count() as f64
}

#[test]
fn bilateral_filtering_keeps_the_edges_of_a_cube_and_the_others_do_not() {
    let clean = shapes::cuboid(DVec3::splat(2.0), [16, 16, 16]).unwrap();
    // 11° on average, below σs; at twice that noise looks like edges.
    let noisy = shapes::with_noise(clean.clone(), 0.1, 3).unwrap();
    let before = normal_error(&noisy, &clean);
    let run = |method: &Method| {
        let mut mesh = noisy.clone();
        let _ = method(&mut mesh, &VertexSet::new(), Progress::NONE).unwrap();
        normal_error(&mesh, &clean)
    };
    let errors: Vec<(&str, f64)> =
        plain_methods().iter().map(|(name, method)| (*name, run(method))).collect();
    let of = |name: &str| errors.iter().find(|error| error.0 == name).unwrap().1;
    // Of faint noise the global scheme leaves a tenth (as predicted beside it); here a part passes for edges.
    assert!(of("bilateral global") < 0.25 * before, "{before}: {errors:?}");
    assert!(of("bilateral") < of("bilateral global"), "{errors:?}");
    // Methods that know no edges turn the normals of the faces there: a rounded edge of two faces of 1/16 of a side
    // at 90° alone is 12 edges · 32 of 3072 faces by 22° or more.
    let rounded = 12.0 * 32.0 / 3072.0 * 22.5_f64.to_radians();
    assert!(of("cotangent") > rounded && of("implicit") > rounded, "{errors:?}");
    assert!(of("bilateral") < 0.5 * rounded, "{rounded} {errors:?}");
}

#[test]
fn what_is_to_stay_stays() {
    let blob = shapes::with_noise(shapes::blob(3).unwrap(), 0.2, 1).unwrap();
    let open = shapes::with_holes(&blob, 4, 2, 2).unwrap();
    let fixed: VertexSet = (10..20).map(VertexId::new).collect();
    for boundary in [Boundary::Fixed, Boundary::Free] {
        for (name, method) in methods(boundary, Volume::MayChange) {
            let mut mesh = open.clone();
            let report = method(&mut mesh, &fixed, Progress::NONE).unwrap();
            let mut free = 0;
            for v in open.vertices() {
                let is_held = boundary == Boundary::Fixed && open.is_boundary_vertex(v);
                let stays = fixed.contains(v) || is_held;
                free += usize::from(!stays);
                if stays {
                    assert_eq!(mesh.position(v), open.position(v), "{name} {boundary:?} {v}");
                }
            }
            assert_eq!(report.free_vertices, free, "{name} {boundary:?}");
            assert!(report.max_displacement > 0.0, "{name}");
        }
    }
    for (name, method) in methods(Boundary::Curve, Volume::MayChange) {
        let result = method(&mut open.clone(), &fixed, Progress::NONE);
        assert_eq!(result.is_ok(), name == "cotangent", "{name}: a rim is a curve by steps only");
    }
}

#[test]
fn motion_and_scale_change_only_motion_and_scale() {
    let turn = DMat3::from_rotation_y(0.8) * DMat3::from_rotation_x(2.0);
    let offset = DVec3::new(0.5, -2.0, 1.0);
    let start = shapes::with_noise(shapes::blob(3).unwrap(), 0.1, 5).unwrap();
    for (name, method) in plain_methods() {
        let run = |mut mesh: Mesh| {
            let _ = method(&mut mesh, &VertexSet::new(), Progress::NONE).unwrap();
            mesh
        };
        let plain = run(start.clone());
        let other = run(moved(&start, |p| turn * p + offset));
        for v in start.vertices() {
            let error = (turn * plain.position(v) + offset).distance(other.position(v));
            assert!(error < 1e-9, "{name} {v}: {error}");
        }
        for k in [-200, 3, 200] {
            let s = 2_f64.powi(k);
            let scaled = run(moved(&start, |p| s * p));
            assert!(
                start.vertices().all(|v| scaled.position(v) == s * plain.position(v)),
                "{name} 2^{k}"
            );
        }
    }
}

#[test]
fn bad_triangles_and_options_do_no_harm() {
    let sphere = shapes::icosphere(2).unwrap();
    for (name, method) in plain_methods() {
        for change in [
            (|_| DVec3::ONE) as fn(DVec3) -> DVec3,
            |p| p.x * DVec3::ONE,
            |p| (2.0 * p).round(),
            |p| DVec3::new(p.x, 1e-150 * p.y, 0.0),
            |p| f64::MAX * p,
            |p| 1e-310 * p,
        ] {
            let mut mesh = moved(&sphere, change);
            match method(&mut mesh, &VertexSet::new(), Progress::NONE) {
                Ok(_) => assert!(mesh.positions().values().iter().all(|p| p.is_finite()), "{name}"),
                Err(error) => assert!(matches!(error, Error::Sparse(_)), "{name}: {error}"),
            }
        }
        let mut empty = Mesh::default();
        assert!(method(&mut empty, &VertexSet::new(), Progress::NONE).is_ok(), "{name}");
        let stop = |_| ControlFlow::Break(());
        let mut mesh = sphere.clone();
        let result = method(&mut mesh, &VertexSet::new(), Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))), "{name}");
        assert_eq!(mesh, sphere, "{name}");
    }
    let mut mesh = sphere.clone();
    let none = VertexSet::new();
    for lambda in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = ImplicitOptions { lambda, ..ImplicitOptions::default() };
        assert!(implicit(&mut mesh, &none, &options, Progress::NONE).is_err());
        let options = CotangentOptions { lambda, ..CotangentOptions::default() };
        assert!(cotangent(&mut mesh, &none, &options, Progress::NONE).is_err());
        let options = BilateralOptions { sigma: lambda, ..BilateralOptions::default() };
        assert!(bilateral(&mut mesh, &none, &options, Progress::NONE).is_err());
    }
    let quads = CotangentOptions::default();
    let refused = cotangent(&mut shapes::cube(), &none, &quads, Progress::NONE);
    assert!(matches!(refused, Err(Error::Mesh(dgp_mesh::Error::NotTriangle { .. }))));
    let polygons = BilateralOptions::default();
    assert!(bilateral(&mut shapes::dodecahedron(), &none, &polygons, Progress::NONE).is_ok());
}

#[cfg(feature = "rayon")]
#[test]
fn threads_change_no_bit() {
    let noisy = shapes::with_noise(shapes::icosphere(5).unwrap(), 0.1, 4).unwrap();
    for (name, method) in plain_methods() {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut mesh = noisy.clone();
            let report = pool.install(|| method(&mut mesh, &VertexSet::new(), Progress::NONE));
            (mesh, report)
        };
        let one = run(1);
        assert!(one == run(2) && one == run(8), "{name}");
    }
}
