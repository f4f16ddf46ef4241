//! Decimation by quadrics: what must hold on any input.

use std::ops::ControlFlow;

use dgp_mesh::{DVec2, DVec3, Mesh, NORMAL, Progress, UV, VertexId, VertexSet, shapes};
use dgp_remesh::{
    Boundary, DecimationReport, Error, Memory, Placement, QuadricOptions, StopReason, Target,
    decimate_quadric, seam_edges,
};

fn run_with(mesh: &mut Mesh, target: Target, options: &QuadricOptions) -> DecimationReport {
    let report = decimate_quadric(mesh, target, &VertexSet::new(), options, Progress::NONE);
    let report = report.expect("a mesh of triangles");
    mesh.validate().expect("a valid mesh");
    assert_eq!(report.vertices[1], mesh.vertex_count());
    assert_eq!(report.faces[1], mesh.face_count());
    report
}

fn run(mesh: &mut Mesh, target: Target) -> DecimationReport {
    run_with(mesh, target, &QuadricOptions::default())
}

#[test]
fn a_cube_of_any_refinement_becomes_twelve_triangles_without_error() {
    for n in [1, 2, 3, 4, 7, 16] {
        let mut mesh = shapes::cuboid(DVec3::ONE, [n, n + 1, 2]).unwrap();
        let report = run(&mut mesh, Target::Faces(12));
        assert_eq!(report.stop, StopReason::TargetReached);
        assert_eq!((mesh.vertex_count(), mesh.face_count()), (8, 12));
        assert!(report.largest_error < 1e-15, "{n}: {}", report.largest_error);
        for &p in mesh.positions().values() {
            assert!(p.abs().to_array().iter().all(|&x| (x - 0.5).abs() < 1e-15 || x == 1.0), "{p}");
        }
    }
}

#[test]
fn flat_pieces_cost_nothing() {
    let mut mesh = shapes::grid(20, 30).unwrap();
    let area = dgp_mesh::measure::area(&mesh);
    let report = run(&mut mesh, Target::Faces(2));
    assert_eq!(mesh.face_count(), 2);
    assert!(report.largest_error < 1e-15, "{}", report.largest_error);
    assert!((dgp_mesh::measure::area(&mesh) - area).abs() < 1e-12 * area);
}

#[test]
fn targets_that_are_met_change_nothing() {
    let sphere = shapes::icosphere(2).unwrap();
    for target in [Target::Faces(320), Target::Faces(10_000), Target::Vertices(162)] {
        let mut mesh = sphere.clone();
        let report = run(&mut mesh, target);
        assert_eq!(mesh, sphere);
        assert_eq!((report.collapses, report.stop), (0, StopReason::TargetReached));
    }
}

#[test]
fn a_closed_component_stays_a_tetrahedron_and_one_triangle_stays() {
    let mut mesh = shapes::icosphere(3).unwrap();
    let report = run(&mut mesh, Target::Faces(0));
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (4, 4));
    assert_eq!(report.stop, StopReason::NothingLeft);
    assert!(report.refusals.topology > 0);
    let mut triangle = Mesh::new(
        &dgp_mesh::IndexedFaceSet::new(
            vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            dgp_mesh::FaceList::from_indices(&[[0, 1, 2]]),
        )
        .unwrap(),
    )
    .unwrap();
    let report = run(&mut triangle, Target::Vertices(0));
    assert_eq!((triangle.face_count(), report.stop), (1, StopReason::NothingLeft));
}

#[test]
fn everything_protected_is_said() {
    let mut mesh = shapes::icosphere(2).unwrap();
    let all: VertexSet = mesh.vertices().collect();
    let options = QuadricOptions::default();
    let report =
        decimate_quadric(&mut mesh, Target::Faces(10), &all, &options, Progress::NONE).unwrap();
    assert_eq!((report.collapses, report.stop), (0, StopReason::NothingLeft));
    assert!(report.refusals.protected > 0);
}

#[test]
fn fixed_vertices_and_kept_rims_stay() {
    let input = shapes::with_holes(&shapes::icosphere(4).unwrap(), 2, 2, 3).unwrap();
    let fixed: VertexSet = input.vertices().filter(|v| v.index() % 50 == 0).collect();
    let options = QuadricOptions { boundary: Boundary::Kept, ..QuadricOptions::default() };
    let mut mesh = input.clone();
    let report =
        decimate_quadric(&mut mesh, Target::Faces(700), &fixed, &options, Progress::NONE).unwrap();
    mesh.validate().unwrap();
    for v in input.vertices().filter(|&v| fixed.contains(v) || input.is_boundary_vertex(v)) {
        assert_eq!(mesh.position(report.vertex_map[v]), input.position(v));
    }
    let rim = |mesh: &Mesh| mesh.edges().filter(|&e| mesh.is_boundary_edge(e)).count();
    assert_eq!(rim(&mesh), rim(&input));
}

#[test]
fn numbers_that_are_none_and_polygons_are_refused() {
    let mut mesh = shapes::icosphere(1).unwrap();
    mesh.set_position(VertexId::new(3), DVec3::new(0.0, f64::NAN, 0.0));
    let options = QuadricOptions::default();
    let none = VertexSet::new();
    let result = decimate_quadric(&mut mesh, Target::Faces(10), &none, &options, Progress::NONE);
    assert_eq!(result, Err(Error::NotFinite { vertex: VertexId::new(3) }));
    let result =
        decimate_quadric(&mut shapes::cube(), Target::Faces(4), &none, &options, Progress::NONE);
    assert!(matches!(result, Ok(_) | Err(Error::NotTriangle { .. })));
    let mut sphere = shapes::quad_sphere(4).unwrap();
    let result = decimate_quadric(&mut sphere, Target::Faces(4), &none, &options, Progress::NONE);
    assert!(matches!(result, Err(Error::NotTriangle { degree: 4, .. })));
    let target = Target::Error(f64::NAN);
    let result = decimate_quadric(&mut sphere, target, &none, &options, Progress::NONE);
    assert!(matches!(result, Err(Error::InvalidOption { name: "error", .. })));
}

#[test]
fn errors_stop_it() {
    let mut mesh = shapes::icosphere(4).unwrap();
    let options = QuadricOptions { memory: Memory::Kept, ..QuadricOptions::default() };
    let report = run_with(&mut mesh, Target::Error(0.002), &options);
    assert!(report.largest_error <= 0.002 && report.refusals.error > 0);
    assert!(mesh.face_count() < 2000, "{}", mesh.face_count());
    for &p in mesh.positions().values() {
        assert!((p.length() - 1.0).abs() < 0.01, "{}", p.length());
    }
}

#[test]
fn powers_of_two_scale_the_result_exactly() {
    let input = shapes::blob(3).unwrap();
    let mut plain = input.clone();
    let _ = run(&mut plain, Target::Faces(200));
    for scale in [2_f64.powi(-900), 2_f64.powi(900)] {
        let mut mesh = input.clone();
        mesh.set_positions(mesh.positions().map(|&p| p * scale));
        let _ = run(&mut mesh, Target::Faces(200));
        assert_eq!(mesh.connectivity(), plain.connectivity());
        for v in mesh.vertices() {
            assert_eq!(mesh.position(v), plain.position(v) * scale);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let input = shapes::blob(5).unwrap();
    let results = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut mesh = input.clone();
        let report = pool.install(|| run(&mut mesh, Target::Faces(999)));
        (mesh, report)
    });
    assert_eq!(results[0], results[1]);
    assert_eq!(results[0], results[2]);
}

#[test]
fn a_cancelled_run_leaves_a_valid_mesh() {
    for limit in [0.0, 0.08, 0.3, 0.9] {
        let stop =
            |x: f64| if x > limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let mut mesh = shapes::icosphere(5).unwrap();
        let options = QuadricOptions::default();
        let result = decimate_quadric(
            &mut mesh,
            Target::Faces(100),
            &VertexSet::new(),
            &options,
            Progress::new(&stop),
        );
        assert!(matches!(result, Err(Error::Cancelled(_))));
        mesh.validate().unwrap();
        assert!(mesh.face_count() >= 100);
    }
}

#[test]
fn data_travel_as_on_plain_meshes() {
    let mut plain = shapes::blob(4).unwrap();
    let mut dressed = plain.clone();
    let heights: Vec<f64> = dressed.positions().values().iter().map(|p| p.z).collect();
    dressed.attributes_mut().vertex.remove(NORMAL);
    dressed.attributes_mut().vertex.insert("height", heights);
    *plain.attributes_mut() =
        Mesh::from_parts(plain.connectivity().clone(), plain.positions().clone())
            .attributes()
            .clone();
    let report = run(&mut plain, Target::Faces(300));
    let other = run(&mut dressed, Target::Faces(300));
    assert_eq!((report.vertex_map, report.face_map), (other.vertex_map, other.face_map));
    assert_eq!(plain.positions(), dressed.positions());
    let heights = dressed.attributes().vertex.get::<f64>("height").unwrap();
    for v in dressed.vertices() {
        assert!((heights[v] - dressed.position(v).z).abs() < 0.1);
    }
}

#[test]
fn seams_of_texture_coordinates_stay_seams() {
    // A chart to each half of a flat grid: u jumps by 10 where x changes its sign.
    let mut mesh = shapes::grid(16, 16).unwrap();
    let middle =
        0.5 * (mesh.positions().values()[0] + mesh.positions().values()[mesh.vertex_count() - 1]);
    let uv: Vec<DVec2> = mesh
        .halfedges()
        .map(|h| {
            let Some(f) = mesh.face(h) else { return DVec2::ZERO };
            let jump = if mesh.face_center(f).x < middle.x { 0.0 } else { 10.0 };
            let p = mesh.position(mesh.from(h));
            DVec2::new(p.x + jump, p.y)
        })
        .collect();
    mesh.attributes_mut().corner.insert(UV, uv);
    assert_eq!(seam_edges(&mesh).len(), 16);
    // At ends, where data are exact.
    let options = QuadricOptions { placement: Placement::Ends, ..QuadricOptions::default() };
    let report = run_with(&mut mesh, Target::Faces(30), &options);
    assert!(report.faces[1] <= 30);
    let uv = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
    for h in mesh.halfedges().filter(|&h| mesh.face(h).is_some()) {
        let p = mesh.position(mesh.from(h));
        let off = uv[h] - DVec2::new(p.x, p.y);
        assert!(off.y.abs() < 1e-9 && (off.x.abs() < 1e-9 || (off.x - 10.0).abs() < 1e-9), "{off}");
    }
    for e in seam_edges(&mesh).iter() {
        assert!((mesh.edge_midpoint(e).x - middle.x).abs() < 1e-12);
    }
}

#[test]
fn all_shapes_stay_valid() {
    let inputs = [
        shapes::torus(1.0, 0.3, 20, 10).unwrap(),
        shapes::annulus(0.5, 1.0, 24, 4).unwrap(),
        shapes::surface_of_genus(3, 2).unwrap(),
        shapes::capped_cone(1.0, 2.0, 20, 5).unwrap(),
        shapes::trefoil(60, 8).unwrap(),
        shapes::disk(6).unwrap(),
        shapes::gyroid(1, 10).unwrap(),
    ];
    for input in inputs {
        for share in [2, 5, 20, 1000] {
            let mut mesh = input.clone();
            let _ = run(&mut mesh, Target::Faces(input.face_count() / share));
            assert_eq!(
                dgp_mesh::topology::euler_characteristic(&mesh),
                dgp_mesh::topology::euler_characteristic(&input)
            );
        }
    }
}
