//! Laws of Laplacians and curvature on real meshes: those that are manifolds, and the tufted cover on those
//! that are not. Where there are no real data, the test says so and checks nothing.

use std::path::Path;

use dgp_laplace::{
    intrinsic::{IntrinsicOptions, intrinsic_delaunay, tufted_laplacian},
    laplacian::{
        cotangent_laplacian, laplacian_report, mean_value_laplacian, uniform_laplacian,
        vertex_masses,
    },
    spectral::Eigenbasis,
};
use dgp_mesh::{
    DMat3, DVec3, IndexedFaceSet, Mesh, Progress, TriangulationMethod, VertexMap,
    curvature::curvature_report, measure::area, shapes::Random, topology::face_list_components,
    triangulate, triangulate_faces,
};
use dgp_sparse::{EigenOptions, SparseMatrix};
use dgp_tests::data;

/// Larger meshes take too long for a test.
const MOST_FACES: usize = 150_000;

#[test]
fn laplacians_of_real_meshes_are_laplacians() {
    let Some(folder) = data::shared() else {
        eprintln!("skipped: no real data; set DGP_SHARED_DATA to their folder");
        return;
    };
    let (mut manifolds, mut others) = (0, 0);
    for path in data::files(&folder) {
        let Ok(document) = dgp_io::read(&path) else { continue };
        let set = document.set;
        if set.face_count() == 0 || set.face_count() > MOST_FACES {
            continue;
        }
        match Mesh::new(&set) {
            Ok(mut mesh) => {
                if triangulate(&mut mesh, TriangulationMethod::Ears, Progress::NONE).is_ok() {
                    manifolds += 1;
                    check_mesh(&path, &mesh);
                }
            }
            Err(_) => others += usize::from(check_set(&path, &set)),
        }
    }
    eprintln!("{manifolds} manifolds, {others} others");
    assert!(manifolds > 30 && others > 5, "{manifolds} manifolds, {others} others");
}

/// As many eigenvalues are zero as there are components, on all files of several; of those that are no manifold the
/// graph of their faces' edges, of the others the Laplacian of the surface too.
#[test]
fn zero_eigenvalues_count_the_components_of_real_meshes() {
    let Some(folder) = data::shared() else {
        eprintln!("skipped: no real data; set DGP_SHARED_DATA to their folder");
        return;
    };
    let (mut graphs, mut surfaces) = (0, 0);
    for path in data::files(&folder) {
        let Ok(document) = dgp_io::read(&path) else { continue };
        let set = document.set;
        let parts = face_list_components(set.vertex_count(), set.faces()).count;
        if parts < 2 || set.face_count() > MOST_FACES {
            continue;
        }
        let name = path.display().to_string();
        graphs += 1;
        check_zeros(&format!("{name}, graph"), &graph_laplacian(&set), parts);
        let Ok(mut mesh) = Mesh::new(&set) else { continue };
        if triangulate(&mut mesh, TriangulationMethod::Ears, Progress::NONE).is_ok() {
            let l = intrinsic_delaunay(&mesh, &IntrinsicOptions::default(), Progress::NONE);
            let l = l.unwrap_or_else(|error| panic!("{name}: {error}"));
            surfaces += 1;
            check_zeros(&format!("{name}, surface"), &(l.laplacian, l.masses), parts);
        }
    }
    eprintln!("{graphs} graphs, {surfaces} surfaces of several components");
    assert!(graphs > 20 && surfaces > 10, "{graphs} {surfaces}");
}

/// Weights and masses 1 for the edges and corners of faces.
fn graph_laplacian(set: &IndexedFaceSet) -> (SparseMatrix, VertexMap<f64>) {
    let mut edges: Vec<(u32, u32)> = Vec::new();
    let mut masses = VertexMap::filled(set.vertex_count(), 0.0);
    for (_, face) in set.faces().iter() {
        for (k, &v) in face.iter().enumerate() {
            let w = face[(k + 1) % face.len()];
            masses[v] = 1.0;
            if v != w {
                edges.push((v.min(w).index() as u32, v.max(w).index() as u32));
            }
        }
    }
    edges.sort_unstable();
    edges.dedup();
    let edges: Vec<(u32, u32, f64)> = edges.into_iter().map(|(v, w)| (v, w, 1.0)).collect();
    (SparseMatrix::from_edges(set.vertex_count(), &edges).unwrap(), masses)
}

fn check_zeros(name: &str, (laplacian, masses): &(SparseMatrix, VertexMap<f64>), parts: usize) {
    let rows = masses.values().iter().filter(|m| **m > 0.0).count();
    // One more, which must not be zero, where there is one.
    let count = (parts + 1).min(rows);
    let basis = Eigenbasis::new(laplacian, masses, count, &EigenOptions::default(), Progress::NONE)
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(basis.zero_count(), parts, "{name}: {:?}", basis.values());
    let values = basis.values();
    // Zero beside the next, or beside the largest there can be where there is no next.
    let size = values.get(parts).copied().unwrap_or_else(|| laplacian.row_norm());
    assert!(values[..parts].iter().all(|value| value.abs() < 1e-6 * size), "{name}: {values:?}");
}

fn check_mesh(path: &Path, mesh: &Mesh) {
    let name = path.display();
    let cotangent = cotangent_laplacian(mesh).unwrap();
    let uniform = uniform_laplacian(mesh).unwrap();
    for l in [&uniform, &cotangent] {
        let report = laplacian_report(l);
        assert!(report.row_sum_error < 1e-12, "{name}: {report:?}");
        assert_eq!(report.asymmetry, 0.0, "{name}");
        check_not_negative(&name.to_string(), l);
    }
    match mean_value_laplacian(mesh) {
        Ok(l) => {
            let report = laplacian_report(&l);
            assert_eq!(report.negative_weights, 0, "{name}");
            assert!(report.row_sum_error < 1e-12, "{name}: {report:?}");
        }
        Err(error) => assert!(error.to_string().contains("too short"), "{name}: {error}"),
    }
    let total: f64 = vertex_masses(mesh).values().iter().sum();
    assert!((total - area(mesh)).abs() <= 1e-11 * total, "{name}");

    // Rigid motion, as far as the coordinates stay what they are; scaling by a power of two exactly.
    let turn = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
    let mut moved = mesh.clone();
    moved.set_positions(mesh.positions().map(|&p| 4.0 * (turn * p)));
    let other = cotangent_laplacian(&moved).unwrap();
    let change = SparseMatrix::combine(1.0, &cotangent, -1.0, &other).unwrap();
    // Rounding of the angle moves a cotangent c by ε (1 + c²): in needles that is much.
    let largest = |m: &SparseMatrix| m.values().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let bound = 1e-13 * (1.0 + largest(&cotangent).powi(2));
    assert!(largest(&change) < bound, "{name}: turned, weights differ by {}", largest(&change));

    let report = curvature_report(mesh).unwrap();
    let rounding = 1e-12 * mesh.vertex_count() as f64;
    assert!(report.gauss_bonnet_error <= rounding, "{name}: {report:?}");

    let found = intrinsic_delaunay(mesh, &IntrinsicOptions::default(), Progress::NONE)
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    check_intrinsic(&name.to_string(), &found);
}

/// Whether `set` could be checked.
fn check_set(path: &Path, set: &IndexedFaceSet) -> bool {
    let name = path.display().to_string();
    let mut triangles = set.clone();
    if !set.faces().is_triangles() {
        match triangulate_faces(set, TriangulationMethod::Ears, Progress::NONE) {
            Ok((cut, _)) => triangles = cut,
            Err(_) => return false,
        }
    }
    match tufted_laplacian(&triangles, &IntrinsicOptions::default(), Progress::NONE) {
        Ok(found) => {
            check_intrinsic(&name, &found);
            check_not_negative(&name, &found.laplacian);
            true
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.contains("not a number") || text.contains("corners"), "{name}: {text}");
            false
        }
    }
}

fn check_intrinsic(name: &str, found: &dgp_laplace::intrinsic::IntrinsicLaplacian) {
    let report = laplacian_report(&found.laplacian);
    let size = found.laplacian.row_norm();
    assert!(report.row_sum_error < 1e-11, "{name}: {report:?}");
    assert_eq!(report.asymmetry, 0.0, "{name}");
    assert!(found.masses.values().iter().all(|m| *m >= 0.0 && m.is_finite()), "{name}");
    let least = found.report.least_weight.unwrap_or(0.0);
    assert!(least > -1e-9 * size.max(1.0), "{name}: {:?}", found.report);
}

/// xᵀ L x for random x, relative to Σ |L(i, j)| x².
fn check_not_negative(name: &str, l: &SparseMatrix) {
    let mut random = Random::new(1);
    for _ in 0..3 {
        let x: Vec<f64> = (0..l.rows()).map(|_| 2.0 * random.uniform() - 1.0).collect();
        let size: f64 = l.triplets().map(|(i, _, value)| value.abs() * x[i] * x[i]).sum();
        assert!(l.bilinear(&x, &x) >= -1e-14 * size, "{name}");
    }
}
