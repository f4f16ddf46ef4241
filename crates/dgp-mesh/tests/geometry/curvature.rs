//! Curvature: Gauss–Bonnet, closed forms with measured orders, planes, degenerate input, invariance.

use std::{
    f64::consts::{PI, TAU},
    ops::ControlFlow,
};

use dgp_mesh::{
    DVec3, Error, FaceList, IndexedFaceSet, Mesh, Progress, VertexId, VertexMap,
    curvature::{
        Neighborhood, PrincipalCurvatures, angle_defects, curvature_report, gaussian_curvatures,
        mean_curvature_vectors, mean_curvatures, normal_cycle_curvatures, principal_curvatures,
    },
    measure::{VertexArea, vertex_areas},
    shapes::{self, Random},
    topology::euler_characteristic,
};

use crate::{is_close, meshes, moved, random_point, rotation};

/// The fixtures that are triangle meshes.
fn triangle_meshes() -> impl Iterator<Item = (&'static str, Mesh)> {
    meshes().into_iter().filter(|(_, mesh)| mesh.faces().all(|f| mesh.triangle(f).is_some()))
}

fn normal_cycle(mesh: &Mesh, at: Neighborhood) -> VertexMap<PrincipalCurvatures> {
    normal_cycle_curvatures(mesh, at, Progress::NONE).unwrap()
}

/// The square root of the mean over the area of `error`².
fn l2(mesh: &Mesh, error: impl Fn(VertexId) -> f64) -> f64 {
    let areas = vertex_areas(mesh, VertexArea::Barycentric);
    let total: f64 = areas.values().iter().sum();
    let inner = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v));
    (inner.map(|v| areas[v] * error(v).powi(2)).sum::<f64>() / total).sqrt()
}

/// log₂ of the last quotient of errors.
fn order(errors: &[f64]) -> f64 {
    (errors[errors.len() - 2] / errors[errors.len() - 1]).log2()
}

#[test]
fn the_defects_sum_to_the_euler_characteristic() {
    for (name, mesh) in triangle_meshes() {
        let sum: f64 = angle_defects(&mesh).unwrap().values().iter().sum();
        let expected = TAU * euler_characteristic(&mesh) as f64;
        assert!((sum - expected).abs() <= 1e-12 * mesh.vertex_count() as f64, "{name}: {sum}");
        let report = curvature_report(&mesh).unwrap();
        assert_eq!(report.gauss_bonnet_error, (sum - expected).abs(), "{name}");
    }
    // Triangles without area count as limits of such with area.
    for (name, mesh) in degenerate() {
        let sum: f64 = angle_defects(&mesh).unwrap().values().iter().sum();
        let expected = TAU * euler_characteristic(&mesh) as f64;
        assert!((sum - expected).abs() <= 1e-12 * mesh.vertex_count() as f64, "{name}: {sum}");
    }
}

fn degenerate() -> Vec<(&'static str, Mesh)> {
    let sphere = shapes::icosphere(2).unwrap();
    let needle = |change: &dyn Fn(DVec3) -> DVec3| moved(&sphere, change);
    vec![
        ("a point", needle(&|_| DVec3::ONE)),
        ("a line", needle(&|p| p.x * DVec3::new(1.0, 2.0, 3.0))),
        ("folded flat", needle(&|p| DVec3::new(p.x, p.y, 0.0))),
        ("a thin disk", needle(&|p| DVec3::new(p.x, p.y, 1e-200 * p.z))),
        ("half of it in a point", needle(&|p| if p.x > 0.0 { DVec3::X } else { p })),
        ("rounded to a coarse grid", needle(&|p| (3.0 * p).round())),
        ("huge", needle(&|p| f64::MAX * p)),
        ("tiny", needle(&|p| 1e-310 * p)),
    ]
}

#[test]
fn whatever_the_triangles_the_answer_is_finite() {
    for (name, mesh) in degenerate() {
        let area = VertexArea::MixedVoronoi;
        let is_finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
        assert!(is_finite(gaussian_curvatures(&mesh, area).unwrap().values()) || name == "tiny");
        assert!(is_finite(mean_curvatures(&mesh, area).unwrap().values()) || name == "tiny");
        let no_nan = |p: &PrincipalCurvatures| {
            let directions = (p.max_direction + p.min_direction).is_finite();
            !p.max.is_nan() && !p.min.is_nan() && p.max >= p.min && directions
        };
        assert!(principal_curvatures(&mesh).unwrap().values().iter().all(no_nan), "{name}");
        for at in [Neighborhood::OneRing, Neighborhood::Ball(0.1)] {
            assert!(normal_cycle(&mesh, at).values().iter().all(no_nan), "{name} {at:?}");
        }
        let vectors = mean_curvature_vectors(&mesh, area).unwrap();
        assert!(vectors.values().iter().all(|x| !x.is_nan()), "{name}");
        assert!(curvature_report(&mesh).unwrap().gauss_bonnet_error < 1e-9, "{name}");
    }
}

/// Row 10 of the oracles: R = 2, r = 1, K = cos v/(2 + cos v), H = (1 + cos v)/(2 + cos v).
#[test]
fn a_torus_converges_with_order_two() {
    let cosine = |mesh: &Mesh, v: VertexId| {
        let p = mesh.position(v);
        p.x.hypot(p.y) - 2.0
    };
    let mut errors = [(); 6].map(|()| Vec::new());
    for n in [24, 48, 96] {
        let mesh = shapes::torus(2.0, 1.0, 2 * n, n).unwrap();
        let exact = mesh.map_vertices(|v| {
            let c = cosine(&mesh, v);
            (c / (2.0 + c), (1.0 + c) / (2.0 + c))
        });
        let area = VertexArea::MixedVoronoi;
        let gaussian = gaussian_curvatures(&mesh, area).unwrap();
        let mean = mean_curvatures(&mesh, area).unwrap();
        let principal = principal_curvatures(&mesh).unwrap();
        errors[0].push(l2(&mesh, |v| gaussian[v] - exact[v].0));
        errors[1].push(l2(&mesh, |v| mean[v] - exact[v].1));
        errors[2].push(l2(&mesh, |v| principal[v].max - 1.0));
        errors[3].push(l2(&mesh, |v| principal[v].min - exact[v].0));
        // The direction of κ₁ runs around the tube, that of κ₂ around the axis.
        let around = |v: VertexId| {
            let p = mesh.position(v);
            DVec3::new(-p.y, p.x, 0.0).normalize()
        };
        errors[4].push(l2(&mesh, |v| principal[v].max_direction.dot(around(v))));
        errors[5].push(l2(&mesh, |v| 1.0 - principal[v].min_direction.dot(around(v)).abs()));
    }
    let orders = errors.each_ref().map(|errors| order(errors));
    assert!(orders[..4].iter().all(|order| *order > 1.9), "{orders:?} {errors:?}");
    assert!(orders[4] > 1.9, "{orders:?} {errors:?}");
    assert!(errors[5][2] < 1e-3, "{errors:?}");
    assert!(errors[0][2] < 3e-4 && errors[1][2] < 2e-4, "{errors:?}");
}

#[test]
fn a_sphere_has_one_curvature_everywhere() {
    let radius = 2.5;
    let mut errors = [(); 4].map(|()| Vec::new());
    for level in 3..=5 {
        let mesh = moved(&shapes::icosphere(level).unwrap(), |p| radius * p);
        let area = VertexArea::MixedVoronoi;
        let gaussian = gaussian_curvatures(&mesh, area).unwrap();
        let mean = mean_curvatures(&mesh, area).unwrap();
        let principal = principal_curvatures(&mesh).unwrap();
        errors[0].push(l2(&mesh, |v| gaussian[v] - 1.0 / radius.powi(2)));
        errors[1].push(l2(&mesh, |v| mean[v] - 1.0 / radius));
        // Max's normals are exact here, so that the tensor is that of the sphere but for rounding.
        errors[2].push(l2(&mesh, |v| principal[v].max - 1.0 / radius));
        errors[3].push(l2(&mesh, |v| principal[v].min - 1.0 / radius));
    }
    assert!(order(&errors[0]) > 1.9 && order(&errors[1]) > 1.9, "{errors:?}");
    assert!(errors[2..].iter().flatten().all(|error| *error < 1e-10), "{errors:?}");
}

#[test]
fn a_cylinder_bends_one_way() {
    let radius = 0.5;
    let mut errors = [(); 3].map(|()| Vec::new());
    for n in [16, 32, 64] {
        let mesh = shapes::cylinder(radius, 2.0, n, n).unwrap();
        let inner: Vec<VertexId> =
            mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        let gaussian = gaussian_curvatures(&mesh, VertexArea::MixedVoronoi).unwrap();
        assert!(inner.iter().all(|&v| gaussian[v] == 0.0), "it unfolds into the plane");
        let mean = mean_curvatures(&mesh, VertexArea::MixedVoronoi).unwrap();
        let principal = principal_curvatures(&mesh).unwrap();
        errors[0].push(l2(&mesh, |v| mean[v] - 0.5 / radius));
        errors[1].push(l2(&mesh, |v| principal[v].max - 1.0 / radius));
        errors[2].push(l2(&mesh, |v| principal[v].min));
        for &v in &inner {
            assert!(principal[v].min_direction.z.abs() > 0.999, "{v}: {:?}", principal[v]);
        }
    }
    // Even rings around the axis are exact at any resolution.
    assert!(errors.iter().flatten().all(|error| *error < 1e-13), "{errors:?}");
}

#[test]
fn the_normal_cycle_converges_while_balls_shrink_more_slowly_than_edges() {
    let (mut errors, mut directions) = (Vec::new(), Vec::new());
    for n in [16, 32, 64] {
        let mesh = shapes::torus(2.0, 1.0, 2 * n, n).unwrap();
        // The radius falls with the square root of the edge length.
        let found = normal_cycle(&mesh, Neighborhood::Ball(1.6 / (n as f64).sqrt()));
        let cosine = |v: VertexId| mesh.position(v).x.hypot(mesh.position(v).y) - 2.0;
        errors.push(l2(&mesh, |v| {
            let c = cosine(v);
            (found[v].max - 1.0).hypot(found[v].min - c / (2.0 + c))
        }));
        directions.push(l2(&mesh, |v| {
            let p = mesh.position(v);
            found[v].max_direction.dot(DVec3::new(-p.y, p.x, 0.0).normalize())
        }));
    }
    assert!(order(&errors) > 0.9 && errors[2] < 0.04, "{errors:?}");
    assert!(directions[2] < 0.1, "{directions:?}");
}

#[test]
fn one_rings_of_the_normal_cycle_hold_the_whole_bend() {
    // Σ area · 2H over the vertices is Σ β l over the edges.
    let smooth = [shapes::icosphere(3).unwrap(), shapes::torus(2.0, 0.7, 24, 12).unwrap()];
    for mesh in smooth {
        let found = normal_cycle(&mesh, Neighborhood::OneRing);
        let areas = vertex_areas(&mesh, VertexArea::Barycentric);
        let bends =
            mesh.edges().filter_map(|e| Some(mesh.dihedral_angle(e)? * mesh.edge_length(e)));
        let total: f64 = bends.sum();
        let in_planes: f64 = mesh.vertices().map(|v| 2.0 * areas[v] * found[v].mean()).sum();
        // But for the part of the tensor along the normal, which is left out.
        assert!(is_close(total, in_planes, 0.03), "{total} {in_planes}");
    }
}

#[test]
fn planes_have_no_curvature_however_they_lie() {
    let mut random = Random::new(3);
    let flat = [shapes::grid(9, 7).unwrap(), shapes::disk(6).unwrap()];
    for k in 0..8 {
        let angles = 3.0 * random_point(&mut random);
        let (turn, offset) = (rotation(angles), random_point(&mut random));
        for mesh in &flat {
            let mesh = if k == 0 { mesh.clone() } else { moved(mesh, |p| turn * p + offset) };
            let inner = || mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v));
            let area = VertexArea::MixedVoronoi;
            let gaussian = gaussian_curvatures(&mesh, area).unwrap();
            let mean = mean_curvatures(&mesh, area).unwrap();
            let principal = principal_curvatures(&mesh).unwrap();
            let cycle = normal_cycle(&mesh, Neighborhood::Ball(0.3));
            let ring = normal_cycle(&mesh, Neighborhood::OneRing);
            for v in inner() {
                assert_eq!((gaussian[v], mean[v]), (0.0, 0.0), "{v}");
                for found in [principal[v], cycle[v], ring[v]] {
                    assert_eq!((found.max, found.min), (0.0, 0.0), "{v}");
                }
            }
        }
    }
}

#[test]
fn the_cube_has_all_its_curvature_at_the_corners() {
    let cube = shapes::cuboid(DVec3::splat(2.0), [3, 3, 3]).unwrap();
    for (v, defect) in angle_defects(&cube).unwrap().iter() {
        let at = cube.position(v).abs().to_array().iter().filter(|x| **x == 1.0).count();
        let expected = if at == 3 { 0.5 * PI } else { 0.0 };
        assert!((defect - expected).abs() < 1e-14, "{v}: {defect}");
        assert!(at == 3 || *defect == 0.0, "{v}: exactly flat, {defect}");
    }
    let disk = shapes::disk(2).unwrap();
    let report = curvature_report(&disk).unwrap();
    assert!(is_close(report.total_gaussian, TAU, 1e-14) && report.euler_characteristic == 1);
}

#[test]
fn motion_changes_only_directions_and_scale_only_the_unit() {
    let mut random = Random::new(8);
    for (name, mesh) in triangle_meshes() {
        let angles = 3.0 * random_point(&mut random);
        let (turn, offset) = (rotation(angles), 3.0 * random_point(&mut random));
        let other = moved(&mesh, |p| turn * p + offset);
        let before = principal_curvatures(&mesh).unwrap();
        let after = principal_curvatures(&other).unwrap();
        let size = before.values().iter().fold(0.0_f64, |m, p| m.max(p.max.abs()).max(p.min.abs()));
        for v in mesh.vertices() {
            let (a, b) = (before[v], after[v]);
            assert!((a.max - b.max).abs() + (a.min - b.min).abs() <= 1e-9 * size, "{name} {v}");
            if a.max - a.min > 1e-2 * size {
                let along = (turn * a.max_direction).dot(b.max_direction).abs();
                assert!((along - 1.0).abs() < 1e-8, "{name} {v}");
            }
        }
        let everything = |mesh: &Mesh, unit: f64| {
            let flat = |p: &PrincipalCurvatures| [p.max, p.min];
            let area = VertexArea::MixedVoronoi;
            let mut one = mean_curvatures(mesh, area).unwrap().into_values();
            one.extend(principal_curvatures(mesh).unwrap().values().iter().flat_map(flat));
            one.extend(normal_cycle(mesh, Neighborhood::OneRing).values().iter().flat_map(flat));
            let ball = Neighborhood::Ball(0.25 * unit);
            one.extend(normal_cycle(mesh, ball).values().iter().flat_map(flat));
            let two = gaussian_curvatures(mesh, area).unwrap().into_values();
            (one, two, angle_defects(mesh).unwrap().into_values())
        };
        let (one, two, zero) = everything(&mesh, 1.0);
        for k in [-40, 3] {
            let s = 2_f64.powi(k);
            let scaled = everything(&moved(&mesh, |p| s * p), s);
            assert_eq!(one.iter().map(|x| x / s).collect::<Vec<_>>(), scaled.0, "{name} 2^{k}");
            assert_eq!(two.iter().map(|x| x / s / s).collect::<Vec<_>>(), scaled.1, "{name}");
            assert_eq!(zero, scaled.2, "{name}");
        }
    }
}

#[test]
fn polygons_wrong_radii_and_cancelling_are_told() {
    let quads = shapes::cube();
    assert!(matches!(angle_defects(&quads), Err(Error::NotTriangle { degree: 4, .. })));
    assert!(matches!(principal_curvatures(&quads), Err(Error::NotTriangle { .. })));
    let sphere = shapes::icosphere(1).unwrap();
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = normal_cycle_curvatures(&sphere, Neighborhood::Ball(radius), Progress::NONE);
        assert!(matches!(found, Err(Error::InvalidOption { name: "radius", .. })));
    }
    let stop = |_| ControlFlow::Break(());
    let found = normal_cycle_curvatures(&sphere, Neighborhood::Ball(1.0), Progress::new(&stop));
    assert!(matches!(found, Err(Error::Cancelled(_))));
    let stray = IndexedFaceSet::new(
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        FaceList::from_indices(&[[0, 1, 2]]),
    );
    let mesh = Mesh::new(&stray.unwrap()).unwrap();
    let stray = VertexId::new(3);
    assert_eq!(angle_defects(&mesh).unwrap()[stray], 0.0);
    assert_eq!(principal_curvatures(&mesh).unwrap()[stray], PrincipalCurvatures::default());
}

#[cfg(feature = "rayon")]
#[test]
fn threads_change_no_bit() {
    let mesh = shapes::with_noise(shapes::icosphere(5).unwrap(), 0.1, 2).unwrap();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let area = VertexArea::MixedVoronoi;
            (
                gaussian_curvatures(&mesh, area).unwrap(),
                mean_curvatures(&mesh, area).unwrap(),
                principal_curvatures(&mesh).unwrap(),
                normal_cycle(&mesh, Neighborhood::Ball(0.1)),
            )
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(8));
}
