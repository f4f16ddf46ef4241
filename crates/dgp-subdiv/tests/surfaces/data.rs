//! Data that travel, faces left out at rims, and runs that are stopped.

use std::ops::ControlFlow;

use dgp_mesh::{DVec2, DVec3, Mesh, Progress, UV, VertexId, shapes};
use dgp_subdiv::{
    BoundaryRule, Error, FaceVarying, LoopWeights, RefinementOptions, SHARPNESS, Scheme, Sharpness,
    SubdivisionOptions, subdivide,
};

fn options(scheme: Scheme, levels: usize) -> SubdivisionOptions {
    let refinement = RefinementOptions { scheme, levels, ..RefinementOptions::default() };
    SubdivisionOptions { refinement, ..SubdivisionOptions::default() }
}

const LOOP: Scheme = Scheme::Loop(LoopWeights::Original);

/// A cube with a chart of its own on each face, a color per vertex, a part per face and a name per edge.
pub(crate) fn decorated(mut mesh: Mesh) -> Mesh {
    let mut uv = vec![DVec2::ZERO; mesh.halfedge_count()];
    for f in mesh.faces() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        for (h, (x, y)) in mesh.face_halfedges(f).zip(corners) {
            uv[h.index()] = DVec2::new(x + 10.0 * f.index() as f64, y);
        }
    }
    let place: Vec<DVec3> = mesh.positions().values().to_vec();
    let part: Vec<u32> = (0..mesh.face_count() as u32).collect();
    let edge: Vec<u32> = (1..=mesh.edge_count() as u32).collect();
    let attributes = mesh.attributes_mut();
    attributes.corner.insert(UV, uv);
    attributes.vertex.insert("place", place);
    attributes.face.insert("part", part);
    attributes.edge.insert("edge", edge);
    mesh
}

#[test]
fn data_travel() {
    let cases = [
        (shapes::cube(), Scheme::CatmullClark),
        (shapes::cube(), Scheme::Bilinear),
        (shapes::octahedron(), LOOP),
    ];
    for (mesh, scheme) in cases {
        let mesh = decorated(mesh);
        let (refined, report) =
            subdivide(&mesh, &Sharpness::new(), &options(scheme, 2), Progress::NONE).unwrap();
        assert!(report.left_out.is_empty());
        let data = refined.attributes();
        // The same stencils as positions.
        let place = data.vertex.get::<DVec3>("place").unwrap();
        for v in refined.vertices() {
            assert!(place[v].distance(refined.position(v)) < 1e-15, "{scheme:?} {v}");
        }
        let (part, uv) =
            (data.face.get::<u32>("part").unwrap(), data.corner.get::<DVec2>(UV).unwrap());
        let mut areas = vec![0.0; mesh.face_count()];
        for f in refined.faces() {
            let corners: Vec<DVec2> = refined.face_halfedges(f).map(|h| uv[h]).collect();
            // Each chart lies where that of its part does, and its pieces cover it.
            let low = 10.0 * f64::from(part[f]);
            assert!(corners.iter().all(|p| (low..=low + 1.0).contains(&p.x)), "{scheme:?} {f}");
            for (k, p) in corners.iter().enumerate() {
                areas[part[f] as usize] += p.perp_dot(corners[(k + 1) % corners.len()]) / 2.0;
            }
        }
        let whole = if scheme == LOOP { 0.5 } else { 1.0 };
        assert!(areas.iter().all(|area| (area - whole).abs() < 1e-12), "{areas:?}");
        // Each edge of the cage is four now, all others are new; its first and last end are those of it.
        let edge = data.edge.get::<u32>("edge").unwrap();
        for e in mesh.edges() {
            let pieces: Vec<_> =
                refined.edges().filter(|&x| edge[x] == e.index() as u32 + 1).collect();
            assert_eq!(pieces.len(), 4);
            let ends: Vec<VertexId> =
                pieces.iter().flat_map(|&x| refined.edge_vertices(x)).collect();
            assert!(mesh.edge_vertices(e).iter().all(|v| ends.contains(v)), "{scheme:?} {e}");
        }
    }
}

#[test]
fn what_is_sharp_still_is_written_down() {
    let mut mesh = shapes::cube();
    let mut sharpness = Sharpness::new();
    sharpness.set_edge(dgp_mesh::EdgeId::new(4), 2.25);
    sharpness.set_vertex(VertexId::new(3), 1.5);
    sharpness.to_attributes(&mut mesh);
    assert_eq!(Sharpness::from_attributes(&mesh).edge(dgp_mesh::EdgeId::new(4)), 2.25);
    let read = Sharpness::from_attributes(&mesh);
    let twice = subdivide(&mesh, &read, &options(Scheme::CatmullClark, 2), Progress::NONE).unwrap();
    // Refining once and again from what is written gives the same.
    let once =
        subdivide(&mesh, &read, &options(Scheme::CatmullClark, 1), Progress::NONE).unwrap().0;
    let left = Sharpness::from_attributes(&once);
    assert_eq!(left.vertex(VertexId::new(3)), 0.5);
    let sharp = once.attributes().edge.get::<f64>(SHARPNESS).unwrap();
    assert_eq!(sharp.values().iter().filter(|&&s| s == 1.25).count(), 2);
    let again =
        subdivide(&once, &left, &options(Scheme::CatmullClark, 1), Progress::NONE).unwrap().0;
    // Vertices may be numbered by other edges and faces, so compare as sets.
    let sorted = |mesh: &Mesh| {
        let mut points: Vec<[i64; 3]> = mesh
            .positions()
            .values()
            .iter()
            .map(|p| p.to_array().map(|x| (x * 1e12).round() as i64))
            .collect();
        points.sort_unstable();
        points
    };
    let (a, b) = (sorted(&twice.0), sorted(&again));
    assert!(a.iter().zip(&b).all(|(p, q)| (0..3).all(|k| (p[k] - q[k]).abs() <= 1)));
}

#[test]
fn without_a_rule_for_rims_the_outer_faces_only_support() {
    let mesh = shapes::quad_grid(5, 4).unwrap();
    let refinement = RefinementOptions {
        levels: 2,
        boundary: BoundaryRule::None,
        ..RefinementOptions::default()
    };
    let options = SubdivisionOptions { refinement, ..SubdivisionOptions::default() };
    let (refined, report) = subdivide(&mesh, &Sharpness::new(), &options, Progress::NONE).unwrap();
    assert_eq!(refined.face_count(), 3 * 2 * 16);
    assert_eq!(report.euler_characteristic, [1, 1]);
    // A regular grid refines to a regular grid.
    let whole = mesh.positions().values().iter().fold(0.0, |x, p| f64::max(x, p.x));
    let inner = refined.positions().values().iter().fold(0.0, |x, p| f64::max(x, p.x));
    assert!((inner - 0.8 * whole).abs() < 1e-14, "{inner} {whole}");
}

#[test]
fn coordinates_that_overflow_or_are_none_are_refused() {
    let mut mesh = shapes::icosahedron();
    mesh.set_position(VertexId::new(5), DVec3::new(0.0, f64::NAN, 0.0));
    let error = subdivide(&mesh, &Sharpness::new(), &options(LOOP, 1), Progress::NONE).unwrap_err();
    assert_eq!(error, Error::NotFinite { vertex: VertexId::new(5) });
    let mut mesh = shapes::icosahedron();
    let huge = mesh.map_vertices(|v| {
        let far = if v.index() % 2 == 0 { f64::MAX } else { -f64::MAX };
        DVec3::new(far, -far, far)
    });
    mesh.set_positions(huge);
    let scheme = Scheme::Butterfly(dgp_subdiv::ButterflyRule::Modified);
    match subdivide(&mesh, &Sharpness::new(), &options(scheme, 3), Progress::NONE) {
        Ok((refined, _)) => assert!(refined.positions().values().iter().all(|p| p.is_finite())),
        Err(error) => assert!(matches!(error, Error::NotFinite { .. }), "{error}"),
    }
}

#[test]
fn it_stops_when_asked_to() {
    let mesh = decorated(shapes::cube());
    for limit in 0..12 {
        let calls = std::sync::atomic::AtomicUsize::new(0);
        let stop = |_| {
            let count = calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if count == limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let options = options(Scheme::CatmullClark, 2);
        let result = subdivide(&mesh, &Sharpness::new(), &options, Progress::new(&stop));
        let stopped = calls.into_inner() > limit;
        assert_eq!(matches!(result, Err(Error::Cancelled(_))), stopped, "{limit}");
    }
}

#[test]
fn smooth_texture_coordinates_follow_positions_up_to_seams() {
    // A texture that is the position itself has no seams but rims: the surface and its chart stay one.
    let mut mesh = shapes::quad_grid(4, 3).unwrap();
    let flat =
        |mesh: &Mesh, v: VertexId| DVec2::new(mesh.position(v).x, mesh.position(v).y.powi(2));
    let uv: Vec<DVec2> = mesh.halfedges().map(|h| flat(&mesh, mesh.from(h))).collect();
    let place: Vec<DVec2> = mesh.vertices().map(|v| flat(&mesh, v)).collect();
    mesh.attributes_mut().corner.insert(UV, uv);
    mesh.attributes_mut().vertex.insert("uv of vertices", place);
    let smooth = |boundary| {
        let mut options = options(Scheme::CatmullClark, 2);
        options.refinement.boundary = boundary;
        options.face_varying = FaceVarying::Smooth;
        subdivide(&mesh, &Sharpness::new(), &options, Progress::NONE).unwrap().0
    };
    let refined = smooth(BoundaryRule::EdgeAndCorner);
    let uv = refined.attributes().corner.get::<DVec2>(UV).unwrap();
    let place = refined.attributes().vertex.get::<DVec2>("uv of vertices").unwrap();
    for h in refined.halfedges().filter(|&h| !refined.is_boundary_halfedge(h)) {
        assert!(uv[h].distance(place[refined.from(h)]) < 1e-14, "{h}");
    }
}

#[test]
fn seams_cut_charts_and_nothing_crosses_them() {
    let mesh = decorated(shapes::cube());
    let mut options = options(Scheme::CatmullClark, 3);
    options.face_varying = FaceVarying::Smooth;
    let (refined, _) = subdivide(&mesh, &Sharpness::new(), &options, Progress::NONE).unwrap();
    let uv = refined.attributes().corner.get::<DVec2>(UV).unwrap();
    let part = refined.attributes().face.get::<u32>("part").unwrap();
    for f in refined.faces() {
        let low = 10.0 * f64::from(part[f]);
        // Each face is a chart of one face: a square whose corners stay, so it is refined as a grid.
        for h in refined.face_halfedges(f) {
            let p = (uv[h] - DVec2::new(low, 0.0)) * 8.0;
            assert!((p - p.round()).length() < 1e-12 && (0.0..=8.0).contains(&p.x.round()), "{p}");
        }
    }
}
