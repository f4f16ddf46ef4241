//! Spectra of shapes that are known, and what is done with them.

use dgp_mesh::{Mesh, Progress, VertexId, VertexMap, shapes};
use dgp_sparse::EigenOptions;

use super::*;
use crate::{
    Error,
    laplacian::{cotangent_laplacian, uniform_laplacian, vertex_masses},
};

fn cotangent_basis(mesh: &Mesh, count: usize) -> Eigenbasis {
    let laplacian = cotangent_laplacian(mesh).unwrap();
    let masses = vertex_masses(mesh);
    Eigenbasis::new(&laplacian, &masses, count, &EigenOptions::default(), Progress::NONE).unwrap()
}

fn graph_basis(mesh: &Mesh, count: usize) -> Eigenbasis {
    let laplacian = uniform_laplacian(mesh).unwrap();
    let ones = VertexMap::filled(mesh.vertex_count(), 1.0);
    Eigenbasis::new(&laplacian, &ones, count, &EigenOptions::default(), Progress::NONE).unwrap()
}

/// Meshes side by side, none touching another.
fn together(meshes: &[Mesh]) -> Mesh {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for (k, mesh) in meshes.iter().enumerate() {
        let start = positions.len();
        positions.extend(mesh.positions().values().iter().map(|&p| p + 10.0 * k as f64));
        for f in mesh.faces() {
            faces.push(mesh.face_vertices(f).map(|v| v.index() + start).collect::<Vec<_>>());
        }
    }
    let faces = dgp_mesh::FaceList::from_indices(&faces);
    Mesh::new(&dgp_mesh::IndexedFaceSet::new(positions, faces).unwrap()).unwrap()
}

#[test]
fn zero_eigenvalues_count_the_parts() {
    let parts = [
        shapes::icosphere(2).unwrap(),
        shapes::torus(2.0, 0.5, 12, 8).unwrap(),
        shapes::grid(5, 4).unwrap(),
    ];
    for count in 1..=3 {
        let mesh = together(&parts[..count]);
        assert_eq!(cotangent_basis(&mesh, 6).zero_count(), count);
        assert_eq!(graph_basis(&mesh, 6).zero_count(), count);
    }
}

#[test]
fn vertices_on_no_face_have_no_part_in_it() {
    let mesh = shapes::icosphere(1).unwrap();
    let mut set = mesh.to_indexed();
    let mut positions = set.positions().clone().into_values();
    positions.insert(0, dgp_mesh::DVec3::ONE);
    let mut faces = set.faces().clone();
    faces.corners_mut().iter_mut().for_each(|v| *v = VertexId::new(v.index() + 1));
    set = dgp_mesh::IndexedFaceSet::new(positions, faces).unwrap();
    let lonely = Mesh::new(&set).unwrap();
    let (a, b) = (cotangent_basis(&mesh, 5), cotangent_basis(&lonely, 5));
    assert_eq!(a.values(), b.values());
    assert!(b.function(0)[0] == 0.0 && b.function(0)[1..] == *a.function(0));
}

#[test]
fn more_functions_than_vertices_are_refused() {
    let mesh = shapes::tetrahedron();
    let laplacian = uniform_laplacian(&mesh).unwrap();
    let ones = VertexMap::filled(4, 1.0);
    for count in [0, 5] {
        let result =
            Eigenbasis::new(&laplacian, &ones, count, &EigenOptions::default(), Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidOption { name: "count", .. })));
    }
}

#[test]
fn waves_change_sign_as_often_as_they_should() {
    let mesh = shapes::grid(24, 5).unwrap();
    let basis = graph_basis(&mesh, 4);
    for i in 0..4 {
        let domains = nodal_domains(&mesh, basis.function(i));
        // Along a strip the first waves divide the length.
        assert_eq!(domains.positive + domains.negative, i + 1);
    }
}

#[test]
fn a_dumbbell_comes_apart_at_its_neck() {
    let mesh = shapes::dumbbell(0.2, 32, 48).unwrap();
    let laplacian = cotangent_laplacian(&mesh).unwrap();
    let masses = vertex_masses(&mesh);
    let slow = fiedler(&laplacian, &masses, Progress::NONE).unwrap();
    let axis = mesh.vertices().map(|v| mesh.position(v).z).fold(0.0, f64::max);
    for v in mesh.vertices() {
        let z = mesh.position(v).z;
        if z.abs() > 0.1 * axis {
            let with = mesh.vertices().find(|&w| mesh.position(w).z > 0.9 * axis).unwrap();
            assert_eq!(slow.vector[v] * slow.vector[with] > 0.0, z > 0.0, "{v} at {z}");
        }
    }
    let uniform = uniform_laplacian(&mesh).unwrap();
    for method in [PartitionMethod::Bisection, PartitionMethod::Clusters] {
        let options = PartitionOptions { method, ..PartitionOptions::default() };
        let cut = partition(&uniform, &masses, 2, &options, Progress::NONE).unwrap();
        assert_eq!(cut.pieces, [1, 1]);
        let share = cut.masses[0] / (cut.masses[0] + cut.masses[1]);
        assert!((share - 0.5).abs() < 0.05, "{method:?} {share}");
        for v in mesh.vertices().filter(|&v| mesh.position(v).z.abs() > 0.1 * axis) {
            let top = cut.part[v] == cut.part[VertexId::new(0)];
            assert_eq!(top, mesh.position(v).z * mesh.position(VertexId::new(0)).z > 0.0);
        }
    }
}

#[test]
fn parts_of_a_bisection_have_equal_mass() {
    let mesh = shapes::torus(2.0, 0.7, 40, 20).unwrap();
    let laplacian = uniform_laplacian(&mesh).unwrap();
    let ones = VertexMap::filled(mesh.vertex_count(), 1.0);
    for count in [1, 2, 3, 5, 8] {
        let options =
            PartitionOptions { method: PartitionMethod::Bisection, ..PartitionOptions::default() };
        let cut = partition(&laplacian, &ones, count, &options, Progress::NONE).unwrap();
        assert_eq!(cut.masses.len(), count);
        let mean = mesh.vertex_count() as f64 / count as f64;
        assert!(cut.masses.iter().all(|m| (m - mean).abs() <= 2.0), "{:?}", cut.masses);
    }
}

#[test]
fn separate_parts_are_cut_for_nothing() {
    let mesh = together(&[
        shapes::icosphere(2).unwrap(),
        shapes::icosphere(2).unwrap(),
        shapes::icosphere(2).unwrap(),
    ]);
    let laplacian = uniform_laplacian(&mesh).unwrap();
    let ones = VertexMap::filled(mesh.vertex_count(), 1.0);
    for method in [PartitionMethod::Bisection, PartitionMethod::Clusters] {
        let options = PartitionOptions { method, ..PartitionOptions::default() };
        let cut = partition(&laplacian, &ones, 3, &options, Progress::NONE).unwrap();
        assert_eq!((cut.cut, &cut.pieces[..]), (0.0, &[1, 1, 1][..]), "{method:?}");
    }
    let halves = fiedler(&laplacian, &ones, Progress::NONE);
    assert!(matches!(halves, Err(Error::NotConnected { parts: 3, .. })));
}

#[test]
fn negative_weights_are_not_cut() {
    let laplacian = dgp_sparse::SparseMatrix::from_edges(3, &[(0, 1, 1.0), (1, 2, -0.5)]).unwrap();
    let ones = VertexMap::filled(3, 1.0);
    let result = partition(&laplacian, &ones, 2, &PartitionOptions::default(), Progress::NONE);
    assert!(matches!(result, Err(Error::NegativeWeight { weight, .. }) if weight == -0.5));
}

#[test]
fn more_coefficients_are_nearer_and_all_are_the_mesh() {
    let mesh = shapes::with_noise(shapes::icosphere(2).unwrap(), 0.1, 3).unwrap();
    let n = mesh.vertex_count();
    let basis = graph_basis(&mesh, n);
    let options = CompressionOptions { bits: 40 };
    let counts: Vec<usize> = (0..=n).step_by(9).chain([n]).collect();
    let curve = rate_distortion(&mesh, &basis, &counts, &options, Progress::NONE).unwrap();
    assert!(curve.windows(2).all(|p| p[1].distance <= p[0].distance));
    assert!(curve.windows(2).all(|p| p[1].bits_per_vertex >= p[0].bits_per_vertex));
    assert!(curve.last().unwrap().relative < 1e-10, "{:?}", curve.last());
    let coarse = compress(&mesh, &basis, n, &CompressionOptions { bits: 6 }).unwrap();
    assert!(coarse.bits < compress(&mesh, &basis, n, &options).unwrap().bits / 3.0);
    let worst = mesh.vertices().map(|v| (coarse.positions[v] - mesh.position(v)).length());
    // Each coordinate is off by at most half a step per wave, and waves are orthonormal.
    let bound = 0.5 * coarse.step * (3.0 * n as f64).sqrt();
    assert!(worst.fold(0.0, f64::max) < bound);
}

#[test]
fn the_map_of_a_shape_to_itself_is_the_identity() {
    let mesh = shapes::blob(3).unwrap();
    let basis = cotangent_basis(&mesh, 12);
    let id: VertexMap<VertexId> = mesh.vertices().collect::<Vec<_>>().into();
    let map = map_of_points(&basis, &basis, &id);
    let off = |map: &FunctionalMap| {
        let identity = FunctionalMap::identity(12);
        map.entries.iter().zip(&identity.entries).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(off(&map) < 1e-9, "{}", off(&map));
    assert_eq!(point_map(&basis, &basis, &map, Progress::NONE).unwrap(), id);
    let functions: Vec<VertexMap<f64>> =
        (0..12).map(|i| basis.function(i).to_vec().into()).collect();
    let options = FunctionalMapOptions::default();
    let found = functional_map(&basis, &basis, &functions, &functions, &options, Progress::NONE);
    let found = found.unwrap();
    assert!(off(&found) < 1e-8 && found.orthogonality_defect() < 1e-8, "{}", off(&found));
}

/// Numbers of vertices are shuffled and the shape is moved: the isometry is known.
#[test]
fn zoomout_finds_the_isometry_from_a_rough_start() {
    let mesh = shapes::blob(3).unwrap();
    let other = Mesh::new(&shapes::shuffled(&mesh.to_indexed(), 5)).unwrap();
    let truth: Vec<VertexId> = other
        .vertices()
        .map(|v| mesh.vertices().find(|&w| mesh.position(w) == other.position(v)).unwrap())
        .collect();
    let (a, b) = (cotangent_basis(&mesh, 40), cotangent_basis(&other, 40));
    let heights = |mesh: &Mesh| -> Vec<VertexMap<f64>> {
        (0..3).map(|k| mesh.positions().map(|p| p[k])).collect()
    };
    let rough = functional_map(
        &a.truncated(6),
        &b.truncated(6),
        &heights(&mesh),
        &heights(&other),
        &FunctionalMapOptions::default(),
        Progress::NONE,
    );
    let options = ZoomOutOptions { step: 2, samples: 400 };
    let fine = zoomout(&a, &b, &rough.unwrap(), &options, Progress::NONE).unwrap();
    assert_eq!(fine.points.values(), truth);
    assert!(fine.map.orthogonality_defect() < 1e-8);
    assert_eq!(fine.changed.last(), Some(&0));
}
