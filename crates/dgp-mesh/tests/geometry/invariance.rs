//! Identities, and what motion and scale must not change.

use std::f64::consts::PI;

use dgp_mesh::{
    DVec3, Mesh,
    measure::{
        NormalWeight, VertexArea, area, bounding_box, corner_angles, cotangent_weights,
        edge_length_range, edge_lengths, face_areas, face_normals, face_vector_areas,
        geometry_report, mass_properties, minimum_angle, oriented_box, surface_centroid,
        vertex_areas, vertex_centroid, vertex_normal, vertex_normals, volume,
    },
    shapes::Random,
    topology::{euler_characteristic, topology_report},
};

use crate::{is_close, meshes, moved, random_point, rotation};

const WEIGHTS: [NormalWeight; 3] = [NormalWeight::Area, NormalWeight::Angle, NormalWeight::Max];
const KINDS: [VertexArea; 2] = [VertexArea::Barycentric, VertexArea::MixedVoronoi];

#[test]
fn parts_sum_to_the_whole() {
    for (name, mesh) in meshes() {
        let whole = area(&mesh);
        let faces: f64 = face_areas(&mesh).values().iter().sum();
        assert!(is_close(faces, whole, 1e-13), "{name}");
        for kind in KINDS {
            let areas = vertex_areas(&mesh, kind);
            assert!(areas.values().iter().all(|&a| a >= 0.0), "{name}");
            assert!(is_close(areas.values().iter().sum(), whole, 1e-13), "{name} {kind:?}");
        }
        let is_closed = mesh.edges().all(|e| !mesh.is_boundary_edge(e));
        let is_triangles = mesh.faces().all(|f| mesh.triangle(f).is_some());
        if is_closed {
            let sum: DVec3 = face_vector_areas(&mesh).values().iter().sum();
            assert!(sum.length() < 1e-13 * whole, "{name}: a closed surface has no vector area");
        }
        if is_closed && is_triangles {
            let angles: f64 = corner_angles(&mesh).values().iter().sum();
            let defect = 2.0 * PI * mesh.vertex_count() as f64 - angles;
            let expected = 2.0 * PI * euler_characteristic(&mesh) as f64;
            assert!((defect - expected).abs() < 1e-12 * mesh.vertex_count() as f64, "{name}");
        }
    }
}

#[test]
fn the_energy_of_a_linear_function_is_that_of_its_gradient() {
    // Σ w (x(a) − x(b))² = ∫ |∇x|²: summed over the coordinates, the gradients are those of the
    // identity on the surface, and the integral is twice the area.
    for (name, mesh) in meshes() {
        let Ok(weights) = cotangent_weights(&mesh) else {
            assert!(mesh.faces().any(|f| mesh.degree(f) > 3), "{name}");
            continue;
        };
        let lengths = edge_lengths(&mesh);
        let energy: f64 = mesh.edges().map(|e| weights[e] * lengths[e] * lengths[e]).sum();
        assert!(is_close(energy, 2.0 * area(&mesh), 1e-12), "{name}");
    }
}

#[test]
fn rigid_motion_changes_nothing_but_place() {
    let mut random = Random::new(11);
    for (name, mesh) in meshes() {
        let angles = 3.0 * random_point(&mut random);
        let turn = rotation(angles);
        let offset = 100.0 * random_point(&mut random);
        let other = moved(&mesh, |p| turn * p + offset);
        assert!(is_close(area(&mesh), area(&other), 1e-12), "{name}");
        assert!(close_option(minimum_angle(&mesh), minimum_angle(&other)), "{name}");
        let [a, b] = [&mesh, &other].map(|m| edge_length_range(m).unwrap().mean);
        assert!(is_close(a, b, 1e-12), "{name}");
        for weight in WEIGHTS {
            let [before, after] = [&mesh, &other].map(|m| vertex_normals(m, weight));
            for v in mesh.vertices() {
                assert!((turn * before[v] - after[v]).length() < 1e-10, "{name} {weight:?} {v}");
                assert!((vertex_normal(&mesh, v, weight) - before[v]).length() < 1e-12, "{name}");
            }
        }
        let [a, b] = [&mesh, &other].map(|m| vertex_centroid(m).unwrap());
        assert!((turn * a + offset - b).length() < 1e-10, "{name}");
        let [a, b] = [&mesh, &other].map(|m| surface_centroid(m).unwrap());
        assert!((turn * a + offset - b).length() < 1e-10, "{name}");
        if mesh.edges().all(|e| !mesh.is_boundary_edge(e)) {
            assert!(is_close(volume(&mesh), volume(&other), 1e-12), "{name}");
            let [a, b] = [&mesh, &other].map(|m| mass_properties(m).unwrap());
            let turned = turn * a.inertia * turn.transpose();
            let size = a.principal_moments.z;
            assert!(turned.abs_diff_eq(b.inertia, 1e-11 * size), "{name}");
            assert!((turn * a.centroid + offset - b.centroid).length() < 1e-11, "{name}");
        }
    }
}

fn close_option(a: Option<f64>, b: Option<f64>) -> bool {
    matches!((a, b), (Some(a), Some(b)) if is_close(a, b, 1e-10))
}

/// Everything that is a length, an area, a volume, …, by power, and everything without unit.
fn everything(mesh: &Mesh) -> Vec<(i32, Vec<f64>)> {
    let flat = |vectors: &[DVec3]| vectors.iter().flat_map(DVec3::to_array).collect::<Vec<f64>>();
    let bounds = bounding_box(mesh).unwrap();
    let tight = oriented_box(mesh).unwrap();
    let lengths = edge_length_range(mesh).unwrap();
    let mut all = vec![
        (1, edge_lengths(mesh).into_values()),
        (1, vec![lengths.min, lengths.mean, lengths.max]),
        (1, vec![bounds.diagonal()]),
        (1, flat(&[bounds.min, bounds.max, bounds.center(), tight.size, tight.center])),
        (1, flat(&[vertex_centroid(mesh).unwrap(), surface_centroid(mesh).unwrap()])),
        (1, flat(&mesh.faces().map(|f| mesh.face_center(f)).collect::<Vec<_>>())),
        (2, vec![area(mesh)]),
        (2, face_areas(mesh).into_values()),
        (2, flat(face_vector_areas(mesh).values())),
        (3, vec![volume(mesh)]),
        (0, tight.axes.to_cols_array().to_vec()),
        (0, flat(face_normals(mesh).values())),
        (0, corner_angles(mesh).into_values()),
        (0, mesh.edges().filter_map(|e| mesh.dihedral_angle(e)).collect()),
        (0, mesh.halfedges().map(|h| mesh.cotangent(h)).collect()),
        (0, vec![minimum_angle(mesh).unwrap()]),
    ];
    all.extend(KINDS.map(|kind| (2, vertex_areas(mesh, kind).into_values())));
    all.extend(WEIGHTS.map(|weight| (0, flat(vertex_normals(mesh, weight).values()))));
    if let Some(mass) = mass_properties(mesh) {
        all.push((3, vec![mass.volume]));
        all.push((1, mass.centroid.to_array().to_vec()));
        all.push((5, mass.inertia.to_cols_array().to_vec()));
        all.push((5, mass.principal_moments.to_array().to_vec()));
        all.push((0, mass.principal_axes.to_cols_array().to_vec()));
    }
    all
}

#[test]
fn scaling_by_a_power_of_two_scales_every_result_exactly() {
    for (name, mesh) in meshes() {
        let before = everything(&mesh);
        for k in [-60, -3, 1, 44] {
            let after = everything(&moved(&mesh, |p| p * 2_f64.powi(k)));
            assert_eq!(before.len(), after.len(), "{name}");
            for (row, ((power, a), (_, b))) in before.iter().zip(&after).enumerate() {
                let scaled: Vec<f64> = a.iter().map(|x| x * 2_f64.powi(k * power)).collect();
                assert_eq!(&scaled, b, "{name}, row {row}, scaled by 2^{k}");
            }
        }
    }
}

#[test]
fn sizes_near_the_ends_of_the_range_give_the_same_shape() {
    for (name, mesh) in meshes() {
        let before = everything(&mesh);
        for k in [-664, 664] {
            let after = everything(&moved(&mesh, |p| p * 2_f64.powi(k)));
            for (row, ((power, a), (_, b))) in before.iter().zip(&after).enumerate() {
                // Areas and volumes of that size may leave the range of f64, but are never NaN.
                assert!(b.iter().all(|x| !x.is_nan()), "{name}, row {row}, scaled by 2^{k}");
                if *power <= 1 {
                    let scaled: Vec<f64> = a.iter().map(|x| x * 2_f64.powi(k * power)).collect();
                    assert_eq!(&scaled, b, "{name}, row {row}, scaled by 2^{k}");
                }
            }
        }
    }
}

#[test]
fn far_from_the_origin_nothing_gets_lost_but_what_the_coordinates_lost() {
    for (name, mesh) in meshes() {
        // First onto a grid that survives the offset, so that the shapes are the same.
        let near = moved(&mesh, |p| (p * 1e6).round() / 1_048_576.0);
        let far = moved(&near, |p| p + DVec3::new(1_048_576.0, -2_097_152.0, 524_288.0));
        assert!(is_close(area(&near), area(&far), 1e-13), "{name}");
        let [a, b] = [&near, &far].map(|m| vertex_normals(m, NormalWeight::Angle));
        assert_eq!(a, b, "{name}");
        if mesh.edges().all(|e| !mesh.is_boundary_edge(e)) {
            assert!(is_close(volume(&near), volume(&far), 1e-12), "{name}");
            let [a, b] = [&near, &far].map(|m| mass_properties(m).unwrap().principal_moments);
            assert!(a.abs_diff_eq(b, 1e-11 * a.max_element()), "{name}");
        }
    }
}

#[test]
fn the_oriented_box_holds_all_vertices_and_is_no_larger_than_the_other() {
    let mut random = Random::new(5);
    for (name, mesh) in meshes() {
        let angles = 3.0 * random_point(&mut random);
        let turn = rotation(angles);
        let mesh = moved(&mesh, |p| turn * p);
        let found = oriented_box(&mesh).unwrap();
        for v in mesh.vertices() {
            let local = found.axes.transpose() * (mesh.position(v) - found.center);
            let room = 0.5 * found.size + 1e-13 * found.size.x;
            assert!(local.abs().cmple(room).all(), "{name} {v}");
        }
        let plain = bounding_box(&mesh).unwrap().size();
        assert!(found.volume() <= plain.x * plain.y * plain.z * (1.0 + 1e-12), "{name}");
        assert!((found.axes.determinant() - 1.0).abs() < 1e-12, "{name}");
    }
}

#[test]
fn a_mesh_and_its_face_set_measure_the_same() {
    for (name, mesh) in meshes() {
        let set = mesh.to_indexed();
        let topology = topology_report(&set);
        let report = geometry_report(&set, &topology);
        assert_eq!(report.area, Some(area(&mesh)), "{name}");
        assert_eq!(report.volume, topology.closed.then(|| volume(&mesh)), "{name}");
        assert_eq!(report.bounding_box, bounding_box(&mesh), "{name}");
        assert_eq!(report.minimum_angle, minimum_angle(&mesh), "{name}");
        let [a, b] = [report.edge_length, edge_length_range(&mesh)].map(Option::unwrap);
        assert_eq!((a.min, a.max), (b.min, b.max), "{name}");
        assert!(is_close(a.mean, b.mean, 1e-14), "{name}");
        assert_eq!((report.zero_area_faces, report.non_finite_vertices), (0, 0), "{name}");
    }
}
