//! What must not be returned as garbage: too few constraints, vertices on no face, no numbers, too many functions.

use dgp_mesh::{
    DVec3, FaceList, IndexedFaceSet, Mesh, Progress, VertexId, VertexMap, VertexSet, shapes,
};
use dgp_sparse::{EigenOptions, SparseMatrix};

use crate::{
    Error,
    differential::{DifferentialOperator, EdgeWeight, Reconstruction, RowScale},
    flow::{FlowOptions, HeatFlow, heat_step, mean_curvature_flow},
    intrinsic::{IntrinsicOptions, intrinsic_delaunay, tufted_laplacian},
    laplacian::{cotangent_laplacian, uniform_laplacian, vertex_masses},
    smooth::{
        BilateralOptions, CotangentOptions, ImplicitOptions, TangentialOptions, TaubinOptions,
        UniformOptions, bilateral, cotangent, implicit, tangential, taubin, uniform,
    },
    spectral::{
        CompressionOptions, Eigenbasis, FunctionalMap, PartitionOptions, ZoomOutOptions, compress,
        fiedler, partition, zoomout,
    },
};

/// Two spheres beside each other, and a vertex on no face after them.
fn two_spheres_and_a_vertex() -> Mesh {
    let sphere = shapes::icosphere(1).unwrap();
    let n = sphere.vertex_count();
    let mut positions: Vec<DVec3> = sphere.positions().values().to_vec();
    positions.extend(sphere.positions().values().iter().map(|p| p + 5.0 * DVec3::X));
    positions.push(9.0 * DVec3::Y);
    let mut faces: Vec<[usize; 3]> = Vec::new();
    for start in [0, n] {
        faces
            .extend(sphere.faces().map(|f| sphere.triangle(f).unwrap().map(|v| v.index() + start)));
    }
    Mesh::new(&IndexedFaceSet::new(positions, FaceList::from_indices(&faces)).unwrap()).unwrap()
}

#[test]
fn a_part_in_which_nothing_is_fixed_is_named() {
    let mesh = two_spheres_and_a_vertex();
    let n = (mesh.vertex_count() - 1) / 2;
    for weight in [EdgeWeight::Uniform, EdgeWeight::Cotangent, EdgeWeight::MeanValue] {
        let operator = DifferentialOperator::new(&mesh, weight, RowScale::Weights).unwrap();
        let solver = |fixed: &[usize]| {
            let fixed: VertexSet = fixed.iter().map(|&v| VertexId::new(v)).collect();
            Reconstruction::new(&operator, &fixed, Progress::NONE)
        };
        // The second sphere, the first, the vertex on no face.
        for (fixed, rows) in
            [([0, 2 * n], n..2 * n), ([n, 2 * n], 0..n), ([0, n], 2 * n..2 * n + 1)]
        {
            let error = solver(&fixed).err().unwrap_or_else(|| panic!("{weight:?} {fixed:?}"));
            let text = error.to_string();
            let numbers = text.split(|c: char| !c.is_ascii_digit()).filter_map(|w| w.parse().ok());
            let named: Vec<usize> = numbers.collect();
            assert!(named.iter().any(|row| rows.contains(row)), "{weight:?} {fixed:?}: {text}");
        }
        let delta = operator.coordinates(mesh.positions());
        let found = solver(&[0, n, 2 * n]).unwrap().solve(&delta, mesh.positions()).unwrap();
        assert!(mesh.vertices().all(|v| found[v].distance(mesh.position(v)) < 1e-6));
    }
}

#[test]
fn vertices_on_no_face_are_left_out_or_stay() {
    let mesh = two_spheres_and_a_vertex();
    let lonely = VertexId::new(mesh.vertex_count() - 1);
    let (laplacian, masses) = (cotangent_laplacian(&mesh).unwrap(), vertex_masses(&mesh));
    assert_eq!(masses[lonely], 0.0);
    let options = EigenOptions::default();
    let basis = Eigenbasis::new(&laplacian, &masses, 6, &options, Progress::NONE).unwrap();
    assert_eq!(basis.zero_count(), 2);
    assert!((0..6).all(|i| basis.function(i)[lonely.index()] == 0.0));
    let heat = mesh.positions().map(|p| p.y);
    assert_eq!(heat_step(&mesh, &heat, 0.5, Progress::NONE).unwrap()[lonely], 9.0);
    let mut moved = mesh.clone();
    let flow = FlowOptions::default();
    let none = VertexSet::new();
    assert!(mean_curvature_flow(&mut moved, &none, 0.01, &flow, Progress::NONE).is_ok());
    assert!(implicit(&mut moved, &none, &ImplicitOptions::default(), Progress::NONE).is_ok());
    assert_eq!(moved.position(lonely), mesh.position(lonely));
    let intrinsic =
        intrinsic_delaunay(&mesh, &IntrinsicOptions::default(), Progress::NONE).unwrap();
    assert_eq!(
        (intrinsic.masses[lonely], intrinsic.laplacian.diagonal()[lonely.index()]),
        (0.0, 0.0)
    );
    let parts = partition(
        &laplacian_of_graph(&mesh),
        &masses,
        2,
        &PartitionOptions::default(),
        Progress::NONE,
    );
    assert_eq!(parts.unwrap().part[lonely], None);
}

fn laplacian_of_graph(mesh: &Mesh) -> SparseMatrix {
    uniform_laplacian(mesh).unwrap()
}

#[test]
fn what_is_no_number_is_an_error_with_its_place() {
    let clean = shapes::icosphere(2).unwrap();
    let options = EigenOptions::default();
    for bad in [f64::NAN, f64::INFINITY] {
        let mut mesh = clean.clone();
        mesh.set_positions(mesh.map_vertices(|v| {
            let p = mesh.position(v);
            if v.index() == 17 { p.with_y(bad) } else { p }
        }));
        let none = VertexSet::new();
        let flat = IntrinsicOptions::default();
        let laplacian = cotangent_laplacian(&clean).unwrap();
        let results: Vec<(&str, Option<Error>)> = vec![
            ("intrinsic", intrinsic_delaunay(&mesh, &flat, Progress::NONE).err()),
            ("tufted", tufted_laplacian(&mesh.to_indexed(), &flat, Progress::NONE).err()),
            (
                "basis",
                Eigenbasis::new(&laplacian, &vertex_masses(&mesh), 3, &options, Progress::NONE)
                    .err(),
            ),
            ("heat", heat_step(&mesh, &mesh.map_vertices(|_| 1.0), 0.1, Progress::NONE).err()),
            ("heat of no number", {
                let flow =
                    HeatFlow::new(&laplacian, vertex_masses(&clean).values(), 0.1, Progress::NONE);
                let mut values = vec![1.0; clean.vertex_count()];
                values[17] = bad;
                flow.unwrap().step(&values).err()
            }),
            ("flow", {
                let flow = FlowOptions::default();
                mean_curvature_flow(&mut mesh.clone(), &none, 0.1, &flow, Progress::NONE).err()
            }),
            ("uniform", {
                uniform(&mut mesh.clone(), &none, &UniformOptions::default(), Progress::NONE).err()
            }),
            ("Taubin", {
                taubin(&mut mesh.clone(), &none, &TaubinOptions::default(), Progress::NONE).err()
            }),
            ("tangential", {
                let tangents = TangentialOptions::default();
                tangential(&mut mesh.clone(), &none, &tangents, Progress::NONE).err()
            }),
            ("cotangent", {
                let cotangents = CotangentOptions::default();
                cotangent(&mut mesh.clone(), &none, &cotangents, Progress::NONE).err()
            }),
            ("bilateral", {
                let filter = BilateralOptions::default();
                bilateral(&mut mesh.clone(), &none, &filter, Progress::NONE).err()
            }),
            ("implicit", {
                implicit(&mut mesh.clone(), &none, &ImplicitOptions::default(), Progress::NONE)
                    .err()
            }),
        ];
        for (name, error) in results {
            let error = error.unwrap_or_else(|| panic!("{name} of {bad} gave a result"));
            let text = error.to_string();
            assert!(text.chars().any(|c| c.is_ascii_digit()), "{name} of {bad}: {text}");
        }
    }
}

#[test]
fn more_functions_or_parts_than_there_can_be_are_refused() {
    let mesh = shapes::octahedron();
    let graph = uniform_laplacian(&mesh).unwrap();
    let ones = VertexMap::filled(6, 1.0);
    let options = EigenOptions::default();
    let basis = |count| Eigenbasis::new(&graph, &ones, count, &options, Progress::NONE);
    let all = basis(6).unwrap();
    assert!(matches!(basis(7), Err(Error::InvalidOption { name: "count", .. })));
    for parts in [0, 7] {
        let cut = partition(&graph, &ones, parts, &PartitionOptions::default(), Progress::NONE);
        assert!(cut.is_err(), "{parts} parts");
    }
    assert!(compress(&mesh, &all, 7, &CompressionOptions { bits: 14 }).is_err());
    let one = VertexMap::filled(1, 1.0);
    let single = SparseMatrix::from_edges(1, &[]).unwrap();
    assert!(matches!(fiedler(&single, &one, Progress::NONE), Err(Error::TooFewPoints { .. })));
    let large = FunctionalMap::identity(7);
    let result = zoomout(&all, &all, &large, &ZoomOutOptions::default(), Progress::NONE);
    assert!(matches!(result, Err(Error::InvalidOption { name: "map", .. })));
    let few = ZoomOutOptions { samples: 3, ..ZoomOutOptions::default() };
    let result = zoomout(&all, &all, &FunctionalMap::identity(2), &few, Progress::NONE);
    assert!(matches!(result, Err(Error::InvalidOption { name: "samples", .. })));
}
