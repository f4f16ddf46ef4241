//! Points without faces: the operator of the surface they lie on, whatever their spacing.

use std::f64::consts::PI;

use dgp_mesh::{DVec3, Mesh, Progress, VertexMap, shapes};
use dgp_sparse::{EigenOptions, SparseMatrix};

use super::*;
use crate::{
    flow::HeatFlow,
    laplacian::{cotangent_laplacian, laplacian_report, vertex_masses},
    spectral::Eigenbasis,
};

fn cloud(points: &VertexMap<DVec3>) -> IntrinsicLaplacian {
    point_cloud_laplacian(points, &PointCloudOptions::default(), Progress::NONE).unwrap()
}

fn delaunay(mesh: &Mesh) -> IntrinsicLaplacian {
    intrinsic_delaunay(mesh, &IntrinsicOptions::default(), Progress::NONE).unwrap()
}

/// An icosphere whose vertices were moved at random and put back onto the sphere.
fn uneven_sphere(level: usize) -> Mesh {
    let mut mesh = shapes::with_noise(shapes::icosphere(level).unwrap(), 0.15, 7).unwrap();
    mesh.set_positions(mesh.positions().map(|p| p.normalize()));
    mesh
}

/// The root mean square of u − x², where (M + L) u = M f for f = 7x² − 2: on the sphere u would be x².
fn solution_error(found: &IntrinsicLaplacian, points: &VertexMap<DVec3>) -> f64 {
    let x2: Vec<f64> = points.values().iter().map(|p| p.x * p.x).collect();
    let f: Vec<f64> = x2.iter().map(|x| 7.0 * x - 2.0).collect();
    let masses = found.masses.values();
    let flow = HeatFlow::new(&found.laplacian, masses, 1.0, Progress::NONE).unwrap();
    let u = flow.step(&f).unwrap();
    let square: f64 = (0..f.len()).map(|i| masses[i] * (u[i] - x2[i]).powi(2)).sum();
    (square / masses.iter().sum::<f64>()).sqrt()
}

/// The largest |λ/l(l + 1) − 1| for each l from 1 to 4.
fn spectrum_errors(found: &IntrinsicLaplacian) -> [f64; 4] {
    let options = EigenOptions::default();
    let (laplacian, masses) = (&found.laplacian, &found.masses);
    let basis = Eigenbasis::new(laplacian, masses, 25, &options, Progress::NONE).unwrap();
    [1, 2, 3, 4].map(|l| {
        let exact = (l * (l + 1)) as f64;
        let values = &basis.values()[l * l..(l + 1) * (l + 1)];
        values.iter().map(|value| (value / exact - 1.0).abs()).fold(0.0, f64::max)
    })
}

/// log₂ of the mean factor by which errors fall from level to level.
fn order(errors: &[f64]) -> f64 {
    (errors[0] / errors[errors.len() - 1]).log2() / (errors.len() - 1) as f64
}

#[test]
fn a_regular_cloud_has_the_cotangent_laplacian_of_its_triangles() {
    for level in 2..=4 {
        let mesh = shapes::icosphere(level).unwrap();
        let found = cloud(mesh.positions());
        let exact = cotangent_laplacian(&mesh).unwrap();
        let change = SparseMatrix::combine(1.0, &found.laplacian, -1.0, &exact).unwrap();
        assert!(change.values().iter().all(|x| x.abs() < 1e-12), "level {level}");
        let masses = vertex_masses(&mesh);
        assert!(mesh.vertices().all(|v| (found.masses[v] / masses[v] - 1.0).abs() < 1e-12));
    }
}

/// Rows 1 and 4 of the oracles for points: order 2, as with the Delaunay triangles of the same points.
#[test]
fn a_cloud_of_a_sphere_has_the_operator_of_the_sphere() {
    let mut errors = [(); 6].map(|()| Vec::new());
    let mut with_faces = Vec::new();
    for level in 2..=5 {
        let mesh = uneven_sphere(level);
        let found = cloud(mesh.positions());
        let report = laplacian_report(&found.laplacian);
        assert!(report.row_sum_error < 1e-13 && report.asymmetry == 0.0, "{report:?}");
        assert!(found.report.least_weight.unwrap() > -1e-12);
        let total: f64 = found.masses.values().iter().sum();
        errors[0].push((total / (4.0 * PI) - 1.0).abs());
        errors[1].push(solution_error(&found, mesh.positions()));
        with_faces.push(solution_error(&delaunay(&mesh), mesh.positions()));
        if level < 5 {
            let spectrum = spectrum_errors(&found);
            (0..4).for_each(|l| errors[2 + l].push(spectrum[l]));
        }
    }
    // λ₁ converges faster on even spheres and is below the error of λ₂ on these: it has no order of its own.
    assert!((0..3).all(|i| errors[2][i] < 0.2 * errors[3][i]), "{errors:?}");
    errors.swap(2, 5);
    let orders = errors.each_ref().map(|errors| order(errors));
    assert!(orders[..5].iter().all(|order| (order - 2.0).abs() < 0.25), "{orders:?} {errors:?}");
    // The same triangles but where four points lie nearly on a circle; no more can be asked of points.
    let ratios = errors[1].iter().zip(&with_faces).map(|(a, b)| a / b);
    assert!(ratios.fold(0.0, f64::max) < 1.25, "{:?} {with_faces:?}", errors[1]);
}

/// On a square lattice the corners of each square disagree about its triangles; the stencil of five points is right.
#[test]
fn a_square_lattice_has_the_stencil_of_five_points() {
    let n = 12;
    let step = 0.25;
    let lattice: VertexMap<DVec3> = (0..n * n)
        .map(|i| step * DVec3::new((i % n) as f64, (i / n) as f64, 0.0))
        .collect::<Vec<_>>()
        .into();
    let found = cloud(&lattice);
    for i in 3..n - 3 {
        for j in 3..n - 3 {
            let v = j * n + i;
            let mass = found.masses.values()[v];
            assert!((mass / (step * step) - 1.0).abs() < 1e-12, "{i} {j}: {mass}");
            assert!((found.laplacian.get(v, v) - 4.0).abs() < 1e-12, "{i} {j}");
            for w in [v - 1, v + 1, v - n, v + n] {
                assert!((found.laplacian.get(v, w) + 1.0).abs() < 1e-12, "{v} {w}");
            }
        }
    }
}

#[test]
fn a_flat_cloud_has_the_delaunay_triangles_of_the_plane() {
    // In the plane intrinsic Delaunay is Delaunay; the cloud finds it but at the rim.
    let disk = shapes::disk(8).unwrap();
    let found = cloud(disk.positions());
    let exact = delaunay(&disk);
    for v in disk.vertices().filter(|&v| disk.position(v).length() < 0.8) {
        for j in 0..disk.vertex_count() {
            let (a, b) = (found.laplacian.get(v.index(), j), exact.laplacian.get(v.index(), j));
            assert!((a - b).abs() < 1e-9, "{v} {j}: {a} {b}");
        }
    }
}

#[test]
fn strange_clouds_have_finite_laplacians() {
    let line: VertexMap<DVec3> =
        (0..50).map(|i| f64::from(i) * DVec3::X).collect::<Vec<_>>().into();
    let same: VertexMap<DVec3> = vec![DVec3::ONE; 40].into();
    let lattice: VertexMap<DVec3> = (0..64)
        .map(|i| DVec3::new(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16)))
        .collect::<Vec<_>>()
        .into();
    let twice: VertexMap<DVec3> =
        shapes::icosphere(1).unwrap().positions().values().repeat(2).into();
    for points in [VertexMap::new(), vec![DVec3::ZERO].into(), line, same, lattice, twice] {
        let found = cloud(&points);
        assert_eq!(found.laplacian.rows(), points.len());
        assert!(found.laplacian.values().iter().all(|x| x.is_finite()));
        assert!(found.masses.values().iter().all(|x| *x >= 0.0 && x.is_finite()));
    }
    let options = PointCloudOptions { neighbors: 2, ..PointCloudOptions::default() };
    let refused = point_cloud_laplacian(&vec![DVec3::ZERO].into(), &options, Progress::NONE);
    assert!(matches!(refused, Err(Error::InvalidOption { name: "neighbors", .. })));
    let bad: VertexMap<DVec3> = vec![DVec3::ZERO, DVec3::INFINITY].into();
    let refused = point_cloud_laplacian(&bad, &PointCloudOptions::default(), Progress::NONE);
    assert!(matches!(refused, Err(Error::NotFinite { vertex }) if vertex.index() == 1));
}
