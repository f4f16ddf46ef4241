//! Laws of smoothing: waves, planes, volumes, places that stay, threads, scale and motion.

use std::{f64::consts::TAU, ops::ControlFlow};

use dgp_mesh::{
    DVec3, FaceList, IndexedFaceSet, Mesh, Progress, VertexId, VertexMap, VertexSet, measure,
    shapes,
};

use super::*;
use crate::Error;

/// All methods with this boundary rule, ten iterations each.
fn all_methods(boundary: Boundary) -> Vec<(&'static str, Smoother)> {
    let equal = TangentialOptions { boundary, ..TangentialOptions::default() };
    let area = TangentialOptions { weight: NeighborWeight::Area, ..equal };
    let plain = UniformOptions { boundary, ..UniformOptions::default() };
    let band = TaubinOptions { boundary, ..TaubinOptions::default() };
    vec![
        ("uniform", Box::new(move |m, f, p| uniform(m, f, &plain, p))),
        ("taubin", Box::new(move |m, f, p| taubin(m, f, &band, p))),
        ("tangential", Box::new(move |m, f, p| tangential(m, f, &equal, p))),
        ("tangential by area", Box::new(move |m, f, p| tangential(m, f, &area, p))),
    ]
}

type Smoother =
    Box<dyn Fn(&mut Mesh, &VertexSet, Progress<'_>) -> Result<SmoothReport, Error> + Sync>;

fn smooth_all(method: &Smoother, mesh: &mut Mesh) -> SmoothReport {
    method(mesh, &VertexSet::new(), Progress::NONE).unwrap()
}

fn test_meshes() -> Vec<(&'static str, Mesh)> {
    let noisy = |mesh, seed| shapes::with_noise(mesh, 0.2, seed).unwrap();
    let blob = noisy(shapes::blob(3).unwrap(), 1);
    vec![
        ("empty", Mesh::default()),
        ("cube", shapes::cube()),
        ("holed blob", shapes::with_holes(&blob, 4, 2, 2).unwrap()),
        ("blob", blob),
        ("disk", noisy(shapes::disk(9).unwrap(), 3)),
        ("quads", noisy(shapes::quad_surface_of_genus(2, 2).unwrap(), 4)),
        ("dodecahedron", shapes::dodecahedron()),
        ("one triangle and a stray vertex", {
            let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
            let faces = FaceList::from_indices(&[[0, 1, 2]]);
            Mesh::new(&IndexedFaceSet::new(corners, faces).unwrap()).unwrap()
        }),
        ("all in one point", {
            let mut mesh = shapes::torus(2.0, 1.0, 6, 5).unwrap();
            mesh.set_positions(VertexMap::filled(mesh.vertex_count(), DVec3::ONE));
            mesh
        }),
        ("all on a line", {
            let mut mesh = shapes::icosphere(2).unwrap();
            mesh.set_positions(mesh.positions().map(|p| p.x * DVec3::new(1.0, 2.0, 3.0)));
            mesh
        }),
        ("huge", {
            let mut mesh = shapes::icosphere(2).unwrap();
            mesh.set_positions(mesh.positions().map(|&p| f64::MAX * p));
            mesh
        }),
        ("tiny", {
            let mut mesh = shapes::icosphere(2).unwrap();
            mesh.set_positions(mesh.positions().map(|&p| 1e-310 * p));
            mesh
        }),
    ]
}

/// Waves over the vertices of a torus of quads, x(i, j) = cos(2πai/n) cos(2πbj/m), are
/// eigenvectors with k = 1 − (cos(2πa/n) + cos(2πb/m))/2.
#[test]
fn waves_are_scaled_by_the_transfer_function() {
    let (n, m) = (24, 16);
    let waves = [(1, 0), (3, 5), (12, 8)];
    let angle = |a: usize, n: usize| TAU * a as f64 / n as f64;
    let frequency = |(a, b)| 1.0 - 0.5 * (angle(a, n).cos() + angle(b, m).cos());
    let mut start = shapes::quad_torus(2.0, 1.0, n, m).unwrap();
    start.set_positions(VertexMap::from_fn(n * m, |v: VertexId| {
        let (i, j) = (v.index() % n, v.index() / n);
        let wave = |(a, b)| angle(a * i, n).cos() * angle(b * j, m).cos();
        DVec3::from(waves.map(wave))
    }));
    for iterations in [1, 10, 50] {
        let band = 1.0 / 0.5 - 1.0 / 0.53;
        let options = TaubinOptions { iterations, pass_band: band, ..TaubinOptions::default() };
        assert!((options.mu() + 0.53).abs() < 1e-15);
        let mut mesh = start.clone();
        let _ = taubin(&mut mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
        let power = iterations as i32;
        let gain = DVec3::from(waves.map(|wave| options.gain(frequency(wave)).powi(power)));
        for (v, p) in mesh.positions().iter() {
            assert!(p.abs_diff_eq(gain * start.position(v), 1e-12), "{v} after {iterations}");
        }

        let options = UniformOptions { iterations, lambda: 0.4, ..UniformOptions::default() };
        let mut mesh = start.clone();
        let _ = uniform(&mut mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
        let gain = DVec3::from(waves.map(|wave| (1.0 - 0.4 * frequency(wave)).powi(power)));
        for (v, p) in mesh.positions().iter() {
            assert!(p.abs_diff_eq(gain * start.position(v), 1e-12), "{v} after {iterations}");
        }
    }
}

#[test]
fn the_pass_band_is_where_the_gain_is_one() {
    let options = TaubinOptions { pass_band: 2.0 - 1.0 / 0.53, ..TaubinOptions::default() };
    assert!((options.pass_band - 0.1132).abs() < 1e-4);
    assert!((options.gain(options.pass_band) - 1.0).abs() < 1e-15);
    let after_fifty = [(0.01, 1.01377), (0.1, 1.01765), (1.0, 1.524e-6), (2.0, 0.0)];
    for (k, expected) in after_fifty {
        assert!((options.gain(k).powi(50) - expected).abs() < 1e-5 * f64::max(expected, 1e-3));
    }
}

/// Mean distance from the origin, and its standard deviation.
fn radius_and_noise(mesh: &Mesh) -> (f64, f64) {
    let radii = mesh.positions().map(|p| p.length());
    let count = radii.len() as f64;
    let radius = radii.values().iter().sum::<f64>() / count;
    let square = radii.values().iter().map(|r| (r - radius).powi(2)).sum::<f64>();
    (radius, (square / count).sqrt())
}

#[test]
fn taubin_removes_noise_and_keeps_the_volume_and_uniform_shrinks() {
    let noisy = shapes::with_noise(shapes::icosphere(5).unwrap(), 0.15, 7).unwrap();
    let (_, noise_before) = radius_and_noise(&noisy);
    let mut mesh = noisy.clone();
    let options = TaubinOptions { iterations: 20, ..TaubinOptions::default() };
    let report = taubin(&mut mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
    let (_, noise) = radius_and_noise(&mesh);
    assert!(noise < noise_before / 3.0, "{noise_before} → {noise}");
    let (before, after) = (report.volume_before.unwrap(), report.volume_after.unwrap());
    assert!((after / before - 1.0).abs() < 0.01, "{before} → {after}");
    assert!((after / measure::volume(&mesh) - 1.0).abs() < 1e-14);

    let mut mesh = noisy.clone();
    let options = UniformOptions { iterations: 50, ..UniformOptions::default() };
    let report = uniform(&mut mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
    let shrunk = report.volume_after.unwrap() / report.volume_before.unwrap();
    assert!(shrunk < 0.97, "{shrunk}");
}

#[test]
fn a_scanned_sphere_loses_its_noise() {
    let folder = std::env::var_os("DGP_SHARED_DATA").map_or_else(
        || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        Into::into,
    );
    let Ok(text) = std::fs::read_to_string(folder.join("closed/sphere-noisy.obj")) else {
        eprintln!("sphere-noisy.obj is not here: skipped");
        return;
    };
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let x: Vec<f64> = words.take(3).map(|word| word.parse().unwrap()).collect();
                corners.push(DVec3::new(x[0], x[1], x[2]));
            }
            Some("f") => faces.push(
                words
                    .map(|word| word.split('/').next().unwrap().parse::<usize>().unwrap() - 1)
                    .collect::<Vec<usize>>(),
            ),
            _ => {}
        }
    }
    let center = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let corners: Vec<DVec3> = corners.iter().map(|&p| p - center).collect();
    let set = IndexedFaceSet::new(corners, FaceList::from_indices(&faces)).unwrap();
    let mut mesh = Mesh::new(&set).unwrap();
    let (_, before) = radius_and_noise(&mesh);
    let options = TaubinOptions { iterations: 20, ..TaubinOptions::default() };
    let report = taubin(&mut mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
    let (_, after) = radius_and_noise(&mesh);
    assert!(after < before / 3.0, "noise {before} → {after}");
    let ratio = report.volume_after.unwrap() / report.volume_before.unwrap();
    assert!((ratio - 1.0).abs() < 0.01, "volume × {ratio}");
}

#[test]
fn the_volume_is_kept_on_request() {
    let noisy = shapes::with_noise(shapes::blob(4).unwrap(), 0.2, 3).unwrap();
    let expected = measure::volume(&noisy);
    let none = VertexSet::new();
    let mut mesh = noisy.clone();
    let options =
        UniformOptions { iterations: 100, volume: Volume::Keep, ..UniformOptions::default() };
    let report = uniform(&mut mesh, &none, &options, Progress::NONE).unwrap();
    assert!((measure::volume(&mesh) / expected - 1.0).abs() < 1e-12);
    assert_eq!(report.volume_after.unwrap().to_bits(), measure::volume(&mesh).to_bits());
    let options = TaubinOptions { volume: Volume::Keep, ..TaubinOptions::default() };
    let _ = taubin(&mut mesh, &none, &options, Progress::NONE).unwrap();
    assert!((measure::volume(&mesh) / expected - 1.0).abs() < 1e-12);

    let holed = shapes::with_holes(&noisy, 1, 2, 3).unwrap();
    let mut mesh = holed.clone();
    let result = taubin(&mut mesh, &none, &options, Progress::NONE);
    assert!(matches!(result, Err(Error::NotClosed { vertex }) if holed.is_boundary_vertex(vertex)));
    assert_eq!(mesh, holed);
    let mut mesh = noisy.clone();
    let fixed = VertexSet::all(2);
    let result = taubin(&mut mesh, &fixed, &options, Progress::NONE);
    assert_eq!(result, Err(Error::VolumeMovesFixed { fixed: 2 }));
    let mut flat = shapes::icosphere(1).unwrap();
    flat.set_positions(flat.positions().map(|p| DVec3::new(p.x, p.y, 0.0)));
    let result = taubin(&mut flat.clone(), &none, &options, Progress::NONE);
    assert!(matches!(result, Err(Error::VolumeLost { .. })));
}

#[test]
fn what_is_flat_stays_flat() {
    for boundary in [Boundary::Fixed, Boundary::Curve, Boundary::Free] {
        for (name, method) in all_methods(boundary) {
            let mut mesh = shapes::grid(12, 9).unwrap();
            let bumpy = mesh.positions().map(|p| {
                let bump = 0.05 * (20.0 * p.x).sin() * (15.0 * p.y).sin();
                DVec3::new(p.x + bump * p.y, p.y - bump * p.x, 0.7)
            });
            mesh.set_positions(bumpy);
            let report = smooth_all(&method, &mut mesh);
            assert!(mesh.positions().values().iter().all(|p| p.z == 0.7), "{name}, {boundary:?}");
            assert!(report.mean_displacement > 1e-4, "{name}, {boundary:?}");
        }
    }
}

/// The quads of a grid have two mirror axes; so has what becomes of them.
#[test]
fn tangential_smoothing_keeps_symmetry() {
    let (n, m) = (10, 8);
    for (name, method) in all_methods(Boundary::Curve) {
        let mut mesh = shapes::quad_grid(n, m).unwrap();
        // Squeezed toward the middle from all sides.
        let squeezed = mesh.positions().map(|&p| {
            let q = 2.0 * p - DVec3::new(1.0, 1.0, 0.0);
            DVec3::new(q.x.powi(3), q.y.powi(3), 0.0)
        });
        mesh.set_positions(squeezed);
        let _ = smooth_all(&method, &mut mesh);
        let at = |i: usize, j: usize| mesh.position(VertexId::new(j * (n + 1) + i));
        for j in 0..=m {
            for i in 0..=n {
                let (p, q, r) = (at(i, j), at(n - i, j), at(i, m - j));
                assert!((p.x + q.x).abs() + (p.y - q.y).abs() < 1e-14, "{name}");
                assert!((p.x - r.x).abs() + (p.y + r.y).abs() < 1e-14, "{name}");
            }
        }
    }
}

/// Vertices slide but the sphere remains: spacing evens out, radii hardly change.
#[test]
fn tangential_smoothing_evens_the_spacing_on_the_surface() {
    let sphere = shapes::icosphere(4).unwrap();
    let uneven = shapes::with_noise(sphere.clone(), 0.15, 6).unwrap();
    let uneven = uneven.positions().map(|p| p.normalize());
    let spread = |mesh: &Mesh| {
        let areas = measure::face_areas(mesh);
        let (low, high) = areas
            .values()
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(low, high), &a| (low.min(a), high.max(a)));
        high / low
    };
    for weight in [NeighborWeight::Equal, NeighborWeight::Area] {
        let mut mesh = sphere.clone();
        mesh.set_positions(uneven.clone());
        let before = spread(&mesh);
        let options = TangentialOptions { iterations: 20, weight, ..TangentialOptions::default() };
        let _ = tangential(&mut mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
        assert!(spread(&mesh) < 0.5 * before, "{before} → {}", spread(&mesh));
        let (radius, noise) = radius_and_noise(&mesh);
        assert!((radius - 1.0).abs() < 2e-3 && noise < 2e-3, "{radius} ± {noise}");
    }
}

#[test]
fn vertices_stay_where_they_should() {
    let noisy = shapes::with_noise(shapes::disk(8).unwrap(), 0.3, 2).unwrap();
    let fixed: VertexSet = noisy.vertices().filter(|v| v.index() % 7 == 0).collect();
    for (boundary, rim_stays) in
        [(Boundary::Fixed, true), (Boundary::Curve, false), (Boundary::Free, false)]
    {
        for (name, method) in all_methods(boundary) {
            let mut mesh = noisy.clone();
            let report = method(&mut mesh, &fixed, Progress::NONE).unwrap();
            let mut free = 0;
            for v in mesh.vertices() {
                let stays = fixed.contains(v) || (rim_stays && mesh.is_boundary_vertex(v));
                free += usize::from(!stays);
                let stayed = mesh.position(v) == noisy.position(v);
                assert_eq!(stays, stayed, "{name}, {boundary:?}, {v}");
            }
            assert_eq!(report.free_vertices, free);
        }
    }
}

/// With the rim as a curve, a bumpy circle becomes rounder and interior vertices have no say.
#[test]
fn a_rim_is_smoothed_as_a_curve() {
    let mut mesh = shapes::disk(6).unwrap();
    let start: VertexMap<DVec3> = mesh.map_vertices(|v| {
        let p = mesh.position(v);
        if v.index() % 2 == 0 { 1.05 * p } else { 0.95 * p }
    });
    mesh.set_positions(start);
    let mut other = mesh.clone();
    other.set_positions(mesh.map_vertices(|v| {
        let lift = if mesh.is_boundary_vertex(v) { 0.0 } else { 0.2 };
        mesh.position(v) + lift * DVec3::Z
    }));
    let options = UniformOptions { boundary: Boundary::Curve, ..UniformOptions::default() };
    for mesh in [&mut mesh, &mut other] {
        let _ = uniform(mesh, &VertexSet::new(), &options, Progress::NONE).unwrap();
    }
    let rim: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
    assert!(rim.iter().all(|&v| mesh.position(v) == other.position(v)));
    let radii: Vec<f64> = rim.iter().map(|&v| mesh.position(v).length()).collect();
    let (low, high) =
        radii.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
    assert!(high - low < 1e-3, "{low} to {high}");
}

#[test]
fn every_mesh_gives_finite_positions() {
    for boundary in [Boundary::Fixed, Boundary::Curve, Boundary::Free] {
        for (name, method) in all_methods(boundary) {
            for (shape, mesh) in test_meshes() {
                let mut smooth = mesh.clone();
                let report = smooth_all(&method, &mut smooth);
                let finite = smooth.positions().values().iter().all(|p| p.is_finite());
                assert!(finite, "{name}, {boundary:?}, {shape}");
                assert!(!report.mean_displacement.is_nan() && !report.max_displacement.is_nan());
                assert_eq!(smooth.connectivity(), mesh.connectivity());
            }
        }
    }
}

#[test]
fn scaling_by_powers_of_two_scales_the_result_exactly() {
    for (name, method) in all_methods(Boundary::Curve) {
        let start = shapes::with_noise(shapes::blob(3).unwrap(), 0.2, 4).unwrap();
        let start = shapes::with_holes(&start, 3, 2, 1).unwrap();
        let mut expected = start.clone();
        let _ = smooth_all(&method, &mut expected);
        for scale in [2.0_f64.powi(-500), 0.25, 1024.0, 2.0_f64.powi(900)] {
            let mut mesh = start.clone();
            mesh.set_positions(start.positions().map(|&p| scale * p));
            let report = smooth_all(&method, &mut mesh);
            for v in mesh.vertices() {
                assert_eq!(mesh.position(v), scale * expected.position(v), "{name}, × {scale}");
            }
            assert!(report.max_displacement > 0.0);
        }
    }
}

#[test]
fn moving_the_mesh_moves_the_result() {
    let turn = dgp_mesh::DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.8);
    let motion = |p: DVec3| turn * p + DVec3::new(4.0, -5.0, 6.0);
    for (name, method) in all_methods(Boundary::Curve) {
        let start = shapes::with_noise(shapes::blob(3).unwrap(), 0.2, 4).unwrap();
        let start = shapes::with_holes(&start, 3, 2, 1).unwrap();
        let mut moved = start.clone();
        moved.set_positions(start.positions().map(|&p| motion(p)));
        let mut expected = start.clone();
        let _ = smooth_all(&method, &mut expected);
        let _ = smooth_all(&method, &mut moved);
        for v in start.vertices() {
            let error = moved.position(v).distance(motion(expected.position(v)));
            assert!(error < 1e-12, "{name}, {v}: {error}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let start = shapes::with_noise(shapes::icosphere(5).unwrap(), 0.2, 4).unwrap();
    for (name, method) in all_methods(Boundary::Fixed) {
        let results: Vec<_> = [1, 2, 8]
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let mut mesh = start.clone();
                    let report = smooth_all(&method, &mut mesh);
                    (mesh.positions().clone(), report)
                })
            })
            .into();
        assert!(results.iter().all(|result| *result == results[0]), "{name}");
    }
}

#[test]
fn options_out_of_range_are_refused_and_change_nothing() {
    let start = shapes::icosphere(1).unwrap();
    let none = VertexSet::new();
    let mut mesh = start.clone();
    for lambda in [0.0, -0.5, 1.5, f64::NAN, f64::INFINITY] {
        let options = UniformOptions { lambda, ..UniformOptions::default() };
        let result = uniform(&mut mesh, &none, &options, Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidOption { name: "lambda", .. })));
        let options = TangentialOptions { lambda, ..TangentialOptions::default() };
        let result = tangential(&mut mesh, &none, &options, Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidOption { name: "lambda", .. })));
    }
    for (lambda, pass_band, name) in [
        (0.0, 0.1, "lambda"),
        (0.9, 0.1, "lambda"),
        (f64::NAN, 0.1, "lambda"),
        (0.5, 0.0, "pass_band"),
        (0.5, 2.0, "pass_band"),
        (0.5, f64::NAN, "pass_band"),
    ] {
        let options = TaubinOptions { lambda, pass_band, ..TaubinOptions::default() };
        let result = taubin(&mut mesh, &none, &options, Progress::NONE);
        let is_named = matches!(result, Err(Error::InvalidOption { name: n, .. }) if n == name);
        assert!(is_named, "{lambda} {pass_band}: {result:?}");
    }
    assert_eq!(mesh, start);
}

#[test]
fn cancelling_keeps_the_iterations_done() {
    let start = shapes::with_noise(shapes::icosphere(3).unwrap(), 0.2, 4).unwrap();
    let stop = |x: f64| if x >= 0.3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let mut cancelled = start.clone();
    let options = UniformOptions::default();
    let result = uniform(&mut cancelled, &VertexSet::new(), &options, Progress::new(&stop));
    assert!(matches!(result, Err(Error::Cancelled(_))));
    let mut expected = start;
    let options = UniformOptions { iterations: 3, ..options };
    let _ = uniform(&mut expected, &VertexSet::new(), &options, Progress::NONE).unwrap();
    assert_eq!(cancelled, expected);
}
