//! Intrinsic triangulations: lengths alone, flips, covers, clouds.

use dgp_mesh::{
    DMat3, DVec3, FaceList, IndexedFaceSet, Mesh, Progress,
    measure::{area, edge_lengths},
    shapes,
};
use dgp_sparse::SparseMatrix;

use super::*;
use crate::laplacian::{cotangent_laplacian, laplacian_report, vertex_masses};

fn delaunay(mesh: &Mesh) -> IntrinsicLaplacian {
    intrinsic_delaunay(mesh, &IntrinsicOptions::default(), Progress::NONE).unwrap()
}

fn tufted(set: &IndexedFaceSet) -> IntrinsicLaplacian {
    tufted_laplacian(set, &IntrinsicOptions::default(), Progress::NONE).unwrap()
}

fn largest(matrix: &SparseMatrix) -> f64 {
    matrix.values().iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The largest difference of entries, in units of what rounding of lengths explains: it moves a cotangent c by
/// some ε (1 + c²), and a chain of flips rounds again and again.
fn difference(a: &SparseMatrix, b: &SparseMatrix) -> f64 {
    let change = largest(&SparseMatrix::combine(1.0, a, -1.0, b).unwrap());
    change / (64.0 * f64::EPSILON * (1.0 + largest(a).powi(2)))
}

/// Irregular meshes, with many edges that want to be flipped.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let noisy = shapes::with_noise(shapes::icosphere(3).unwrap(), 0.25, 7).unwrap();
    let stretched = {
        let mut mesh = shapes::icosphere(3).unwrap();
        mesh.set_positions(mesh.positions().map(|p| DVec3::new(p.x, 8.0 * p.y, 0.3 * p.z)));
        mesh
    };
    vec![
        ("holed", shapes::with_holes(&noisy, 4, 1, 3).unwrap()),
        ("noisy", noisy),
        ("stretched", stretched),
        ("torus", shapes::torus(2.0, 0.4, 8, 40).unwrap()),
        ("genus 3", shapes::surface_of_genus(3, 2).unwrap()),
        ("cone", shapes::capped_cone(0.2, 4.0, 5, 3).unwrap()),
        ("trefoil", shapes::trefoil(60, 8).unwrap()),
        ("one triangle", {
            let faces = FaceList::from_indices(&[[0, 1, 2]]);
            let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
            Mesh::new(&IndexedFaceSet::new(corners, faces).unwrap()).unwrap()
        }),
        ("empty", Mesh::default()),
    ]
}

#[test]
fn flips_leave_no_negative_weight_and_keep_the_area() {
    for (name, mesh) in meshes() {
        let mut surface = IntrinsicTriangulation::of_mesh(&mesh).unwrap();
        let before = surface.area();
        assert!((before - area(&mesh)).abs() <= 1e-12 * before, "{name}");
        let flips = surface.flip_to_delaunay(Progress::NONE).unwrap();
        assert!((surface.area() - before).abs() <= 1e-10 * before, "{name}: {flips} flips");
        assert!(surface.least_weight().is_none_or(|w| w > -1e-9), "{name}");
        check_gluing(&surface);
        let l = surface.laplacian().unwrap();
        let report = laplacian_report(&l);
        assert!(report.row_sum_error < 1e-13 && report.asymmetry == 0.0, "{name}");
        let total: f64 = surface.masses().values().iter().sum();
        assert!((total - before).abs() <= 1e-10 * before, "{name}");
        assert_eq!(surface.flip_to_delaunay(Progress::NONE), Ok(0), "{name}: done is done");
    }
}

/// Both triangles of an edge agree on its ends and length, and no triangle breaks the inequality.
fn check_gluing(surface: &IntrinsicTriangulation) {
    for s in 0..3 * surface.triangle_count() {
        let ([a, b, c], [ab, bc, ca]) = surface.triangle(s / 3);
        assert!(ab <= (bc + ca) * (1.0 + 1e-9) && a < surface.vertex_count());
        let corners = [a, b, c];
        if let Some(t) = surface.across(s) {
            let (others, lengths) = surface.triangle(t / 3);
            assert_eq!(surface.across(t), Some(s));
            assert_eq!(corners[s % 3], others[(t + 1) % 3]);
            assert_eq!(corners[(s + 1) % 3], others[t % 3]);
            assert_eq!([ab, bc, ca][s % 3], lengths[t % 3]);
        }
    }
}

#[test]
fn where_nothing_wants_to_be_flipped_it_is_the_cotangent_laplacian() {
    for mesh in [
        shapes::icosphere(3).unwrap(),
        shapes::torus(2.0, 1.0, 60, 30).unwrap(),
        shapes::disk(5).unwrap(),
    ] {
        let found = delaunay(&mesh);
        assert_eq!((found.report.flips, found.report.added_length), (0, 0.0));
        assert!(difference(&cotangent_laplacian(&mesh).unwrap(), &found.laplacian) < 1.0);
        let masses = vertex_masses(&mesh);
        assert!(mesh.vertices().all(|v| (masses[v] - found.masses[v]).abs() < 1e-14));
    }
}

/// The same surface bent in space has the same lengths, and nothing else matters.
#[test]
fn lengths_alone_matter() {
    let turn = DMat3::from_rotation_y(2.0) * DMat3::from_rotation_z(0.3);
    for (name, mesh) in meshes() {
        let mut moved = mesh.clone();
        moved.set_positions(mesh.positions().map(|&p| turn * p + DVec3::new(3.0, -1.0, 2.0)));
        let (a, b) = (delaunay(&mesh), delaunay(&moved));
        assert!(difference(&a.laplacian, &b.laplacian) < 1.0, "{name}");
        let mut by_length =
            IntrinsicTriangulation::from_lengths(&mesh, &edge_lengths(&mesh)).unwrap();
        let mut by_mesh = IntrinsicTriangulation::of_mesh(&mesh).unwrap();
        assert_eq!(
            by_length.flip_to_delaunay(Progress::NONE),
            by_mesh.flip_to_delaunay(Progress::NONE)
        );
        assert!(by_length == by_mesh, "{name}");
    }
    // A cylinder rolled out: a grid of the same lengths.
    let (n, m) = (24, 6);
    let tube = shapes::cylinder(1.0, 2.0, n, m).unwrap();
    let rolled = delaunay(&tube);
    let lengths = edge_lengths(&tube);
    let flat = IntrinsicTriangulation::from_lengths(&tube, &lengths).unwrap();
    assert!(difference(&rolled.laplacian, &flat.laplacian().unwrap()) < 1.0);
}

#[test]
fn a_mesh_scaled_by_a_power_of_two_gives_the_same_matrix() {
    for (name, mesh) in meshes() {
        let before = delaunay(&mesh);
        let cover = tufted(&mesh.to_indexed());
        for k in [-300, 4, 300] {
            let s = 2_f64.powi(k);
            let mut scaled = mesh.clone();
            scaled.set_positions(mesh.positions().map(|&p| s * p));
            let after = delaunay(&scaled);
            assert!(before.laplacian == after.laplacian, "{name} 2^{k}");
            assert!(before.masses.map(|m| m * s * s) == after.masses, "{name} 2^{k}");
            let after = tufted(&scaled.to_indexed());
            assert!(cover.laplacian == after.laplacian, "{name} 2^{k}");
        }
    }
}

#[test]
fn the_cover_of_a_closed_mesh_is_its_intrinsic_delaunay_laplacian() {
    for (name, mesh) in meshes() {
        let a = tufted(&mesh.to_indexed());
        let report = laplacian_report(&a.laplacian);
        assert!(report.row_sum_error < 1e-13 && report.asymmetry == 0.0, "{name}");
        assert!(a.report.least_weight.is_none_or(|w| w > -1e-9), "{name}");
        let total: f64 = a.masses.values().iter().sum();
        // No triangle is so flat that edges had to grow.
        assert_eq!(a.report.added_length, 0.0, "{name}");
        assert!((total - area(&mesh)).abs() <= 1e-12 * total, "{name}");
        if mesh.vertices().all(|v| !mesh.is_boundary_vertex(v)) {
            let b = delaunay(&mesh);
            assert!(difference(&a.laplacian, &b.laplacian) < 1.0, "{name}");
        }
    }
}

/// Three half disks that meet at a line: a book of three pages.
#[test]
fn three_pages_at_a_spine_have_a_laplacian() {
    let n = 6;
    let mut positions = Vec::new();
    let mut faces: Vec<[usize; 3]> = Vec::new();
    for j in 0..=n {
        positions.push(DVec3::new(0.0, 0.0, j as f64 / n as f64));
    }
    for page in 0..3 {
        let (sin, cos) = (f64::from(page) * 2.0).sin_cos();
        let start = positions.len();
        for i in 1..=n {
            for j in 0..=n {
                let r = i as f64 / n as f64;
                positions.push(DVec3::new(r * cos, r * sin, j as f64 / n as f64));
            }
        }
        let at = |i: usize, j: usize| if i == 0 { j } else { start + (i - 1) * (n + 1) + j };
        for i in 0..n {
            for j in 0..n {
                faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                // Orientation does not matter: every other one is turned over.
                faces.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            }
        }
    }
    let set = IndexedFaceSet::new(positions, FaceList::from_indices(&faces)).unwrap();
    let found = tufted(&set);
    assert!((found.masses.values().iter().sum::<f64>() - 3.0).abs() < 1e-12);
    let report = laplacian_report(&found.laplacian);
    assert!(report.row_sum_error < 1e-13);
    assert!(found.report.least_weight.unwrap() > -1e-12);
    // z has the energy of its gradient: the area of the three pages.
    let z: Vec<f64> = set.positions().values().iter().map(|p| p.z).collect();
    assert!((found.laplacian.bilinear(&z, &z) - 3.0).abs() < 1e-12);
}

#[test]
fn triangles_of_all_bad_kinds_have_a_laplacian() {
    let sphere = shapes::icosphere(2).unwrap().to_indexed();
    let with = |change: &dyn Fn(DVec3) -> DVec3, more: &[[usize; 3]]| {
        let positions: Vec<DVec3> =
            sphere.positions().values().iter().map(|&p| change(p)).collect();
        let mut faces = sphere.faces().clone();
        for face in more {
            faces.push(&face.map(dgp_mesh::VertexId::new));
        }
        IndexedFaceSet::new(positions, faces).unwrap()
    };
    let same = |p: DVec3| p;
    for (name, set) in [
        ("a face across", with(&same, &[[0, 50, 100]])),
        ("a face three times", with(&same, &[[0, 50, 100], [0, 50, 100], [100, 50, 0]])),
        ("a face that names a vertex twice", with(&same, &[[0, 0, 100], [5, 5, 5]])),
        ("in one point", with(&|_| DVec3::ONE, &[])),
        ("on a line", with(&|p| p.x * DVec3::ONE, &[])),
        ("folded", with(&|p| DVec3::new(p.x, p.y, 0.0), &[])),
        ("on a coarse grid", with(&|p| (2.0 * p).round(), &[])),
        ("needles", with(&|p| DVec3::new(p.x, 1e-9 * p.y, 1e-9 * p.z), &[])),
        ("half in a point", with(&|p| if p.x > 0.0 { DVec3::X } else { p }, &[])),
    ] {
        let found = tufted(&set);
        let report = laplacian_report(&found.laplacian);
        assert!(found.laplacian.values().iter().all(|x| x.is_finite()), "{name}");
        assert!(found.masses.values().iter().all(|x| *x >= 0.0 && x.is_finite()), "{name}");
        assert!(report.row_sum_error < 1e-12, "{name}: {report:?}");
        let size = largest(&found.laplacian);
        assert!(found.report.least_weight.unwrap() > -1e-9 * size, "{name}: {:?}", found.report);
        assert_eq!(
            found.report.dropped_faces,
            if name.contains("twice") { 2 } else { 0 },
            "{name}"
        );
    }
    let quads = shapes::cube().to_indexed();
    let refused = tufted_laplacian(&quads, &IntrinsicOptions::default(), Progress::NONE);
    assert!(matches!(refused, Err(Error::Mesh(dgp_mesh::Error::NotTriangle { degree: 4, .. }))));
    let nan = with(&|p| if p.x > 0.9 { DVec3::NAN } else { p }, &[]);
    let refused = tufted_laplacian(&nan, &IntrinsicOptions::default(), Progress::NONE);
    assert!(matches!(refused, Err(Error::NotFinite { .. })));
}

#[test]
fn mollifying_makes_just_enough_room() {
    let mut sphere = shapes::icosphere(2).unwrap();
    let mut surface = IntrinsicTriangulation::of_mesh(&sphere).unwrap();
    assert_eq!(surface.mollify(1e-3), Ok(0.0));
    sphere.set_positions(sphere.positions().map(|p| DVec3::new(p.x, p.y, 0.0).round()));
    let mut surface = IntrinsicTriangulation::of_mesh(&sphere).unwrap();
    let mean = surface.lengths().iter().sum::<f64>() / surface.lengths().len() as f64;
    let added = surface.mollify(1e-3).unwrap();
    assert!(added > 0.0);
    let slack = |t: usize| {
        let (_, [a, b, c]) = surface.triangle(t);
        (a + b - c).min(b + c - a).min(c + a - b)
    };
    let least = (0..surface.triangle_count()).map(slack).fold(f64::INFINITY, f64::min);
    assert!((least / (1e-3 * mean) - 1.0).abs() < 1e-9, "{least}");
    for wrong in [-1.0, 2.0, f64::NAN] {
        assert!(matches!(
            surface.mollify(wrong),
            Err(Error::InvalidOption { name: "mollify", .. })
        ));
    }
}

#[test]
fn lengths_of_no_triangle_are_refused() {
    let mesh = shapes::tetrahedron();
    let mut lengths = edge_lengths(&mesh);
    lengths.values_mut()[0] = 5.0;
    let refused = IntrinsicTriangulation::from_lengths(&mesh, &lengths);
    assert!(matches!(refused, Err(Error::NoTriangle { .. })));
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        lengths.values_mut()[0] = wrong;
        assert!(IntrinsicTriangulation::from_lengths(&mesh, &lengths).is_err(), "{wrong}");
    }
}
