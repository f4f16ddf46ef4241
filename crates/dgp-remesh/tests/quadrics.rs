//! Decimation by quadrics: what must hold on any input.

use dgp_mesh::{Mesh, Progress, VertexSet, shapes, triangulate, TriangulationMethod};
use dgp_remesh::{DecimationReport, Error, QuadricOptions, StopReason, Target, decimate_quadric};

fn run(mesh: &mut Mesh, target: Target) -> DecimationReport {
    let options = QuadricOptions::default();
    let report = decimate_quadric(mesh, target, &VertexSet::new(), &options, Progress::NONE);
    let report = report.expect("a mesh of triangles");
    mesh.validate().expect("a valid mesh");
    report
}

#[test]
fn a_cube_of_any_refinement_becomes_twelve_triangles_without_error() {
    for n in [1, 2, 3, 4, 7] {
        let mut mesh = shapes::cuboid(dgp_mesh::DVec3::ONE, [n; 3]).unwrap();
        triangulate(&mut mesh, TriangulationMethod::default(), Progress::NONE).unwrap();
        let report = run(&mut mesh, Target::Faces(12));
        assert_eq!(report.stop, StopReason::TargetReached);
        assert_eq!((mesh.vertex_count(), mesh.face_count()), (8, 12));
        assert!(report.largest_error < 1e-15, "{n}: {}", report.largest_error);
    }
}

#[test]
fn a_sphere_reaches_its_target() {
    let mut mesh = shapes::icosphere(4).unwrap();
    let report = run(&mut mesh, Target::Faces(512));
    assert_eq!(mesh.face_count(), 512);
    assert_eq!(report.faces, [5120, 512]);
}
