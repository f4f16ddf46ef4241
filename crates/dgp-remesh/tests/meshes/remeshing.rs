//! Remeshing: angles, lines, rims, data, and what must hold on any input.

use std::{env, fs, ops::ControlFlow, path::PathBuf};

use dgp_mesh::{
    AttributeTable, DVec2, DVec3, EdgeSet, FaceList, HalfedgeMap, IndexedFaceSet, Mesh, Progress,
    TriangulationMethod, UV, VertexId, VertexSet,
    measure::{area, bounding_box, edge_length_range},
    shapes,
    spatial::{HausdorffOptions, TriangleTree, hausdorff},
    topology::euler_characteristic,
    triangulate,
};
use dgp_remesh::{
    AdaptiveOptions, Error, RemeshOptions, RemeshReport, Rims, remesh_adaptive, remesh_isotropic,
    seam_edges, sharp_edges, triangle_quality,
};

fn run_with(
    mesh: &mut Mesh,
    length: f64,
    features: &EdgeSet,
    options: &RemeshOptions,
) -> RemeshReport {
    let kept = (&VertexSet::new(), features);
    let euler = euler_characteristic(mesh);
    let report = remesh_isotropic(mesh, length, kept, options, Progress::NONE).unwrap();
    mesh.validate().expect("a valid mesh");
    assert_eq!(report.vertices[1], mesh.vertex_count());
    assert_eq!(report.faces[1], mesh.face_count());
    assert_eq!(report.origins.len(), mesh.vertex_count());
    assert_eq!(euler, euler_characteristic(mesh), "the same topology");
    report
}

fn run(mesh: &mut Mesh, length: f64) -> RemeshReport {
    run_with(mesh, length, &EdgeSet::new(), &RemeshOptions::default())
}

fn triangles(mut mesh: Mesh) -> Mesh {
    let _ = triangulate(&mut mesh, TriangulationMethod::default(), Progress::NONE).unwrap();
    mesh
}

fn distance(a: &Mesh, b: &Mesh) -> f64 {
    let [a, b] = [a, b].map(|mesh| TriangleTree::new(mesh, Progress::NONE).unwrap());
    hausdorff(&a, &b, &HausdorffOptions::default(), Progress::NONE).unwrap().upper()
}

#[test]
fn triangles_become_nearly_equilateral() {
    for (mut mesh, length) in [
        (shapes::with_noise(shapes::icosphere(4).unwrap(), 0.004, 1).unwrap(), 0.08),
        (triangles(shapes::uv_sphere(60, 40).unwrap()), 0.07),
        (shapes::torus(2.0, 0.7, 50, 90).unwrap(), 0.12),
        (shapes::torus(2.0, 0.7, 24, 12).unwrap(), 0.12),
        (shapes::blob(4).unwrap(), 0.06),
    ] {
        let input = mesh.clone();
        let report = run(&mut mesh, length);
        let quality = report.quality[1];
        let degrees = [quality.minimum_angle, quality.low_angle, quality.mean_minimum_angle]
            .map(f64::to_degrees);
        assert!(degrees[0] > 25.0 && degrees[1] > 38.0 && degrees[2] > 51.0, "{degrees:?}");
        assert!(quality.regular_share > 0.7, "{}", quality.regular_share);
        let mean = quality.edge_length.unwrap().mean;
        assert!((mean / length - 1.0).abs() < 0.1, "{mean} is not about {length}");
        assert!(distance(&mesh, &input) < 0.25 * length);
        assert!(report.short_edges + report.long_edges < mesh.edge_count() / 50);
    }
}

#[test]
fn vertices_are_points_of_the_input() {
    let input = shapes::blob(4).unwrap();
    let mut mesh = input.clone();
    let report = run(&mut mesh, 0.1);
    for (v, origin) in report.origins.iter() {
        let origin = origin.expect("every vertex is on a face");
        let point: DVec3 =
            (0..3).map(|k| origin.barycentric[k] * input.position(origin.vertices[k])).sum();
        assert!(point.distance(mesh.position(v)) < 1e-12);
        assert_eq!(input.triangle(origin.face).unwrap(), origin.vertices);
    }
}

#[test]
fn edges_and_corners_of_a_box_stay_where_they_are() {
    let size = DVec3::new(1.0, 2.0, 3.0);
    for (n, length) in [([1, 1, 1], 0.2), ([20, 30, 40], 0.2), ([3, 50, 2], 0.15), ([2, 2, 2], 5.0)]
    {
        let mut mesh = shapes::cuboid(size, n).unwrap();
        let features = sharp_edges(&mesh, 1.0);
        let report = run_with(&mut mesh, length, &features, &RemeshOptions::default());
        assert_eq!((report.lines, report.corners), (12, 8));
        assert!((area(&mesh) - 22.0).abs() < 1e-9, "no corner is cut: {}", area(&mesh));
        let half = 0.5 * size;
        let corners = mesh.positions().values().iter().filter(|p| p.abs() == half).count();
        assert_eq!(corners, 8, "corners stay to the last bit");
        for e in sharp_edges(&mesh, 1.0).iter() {
            for v in mesh.edge_vertices(e) {
                let p = mesh.position(v).abs();
                let on = (0..3).filter(|&k| (p[k] - half[k]).abs() < 1e-12).count();
                assert!(on >= 2, "{p} is not on an edge of the box");
            }
        }
        if length < 1.0 {
            let angle = report.quality[1].minimum_angle.to_degrees();
            assert!(angle > 25.0, "{n:?}: {angle}");
        }
    }
}

#[test]
fn rims_keep_their_shape_or_their_vertices() {
    let mut mesh = shapes::grid(13, 9).unwrap();
    let bounds = bounding_box(&mesh).unwrap();
    let whole = area(&mesh);
    let length = 0.7 * edge_length_range(&mesh).unwrap().mean;
    let report = run(&mut mesh, length);
    assert_eq!((report.lines, report.corners), (4, 4), "a rectangle has four corners");
    assert!((area(&mesh) - whole).abs() < 1e-12 * whole);
    assert_eq!(bounding_box(&mesh).unwrap(), bounds);
    assert!(report.quality[1].minimum_angle.to_degrees() > 30.0, "{:?}", report.quality[1]);

    let input = shapes::annulus(0.5, 1.0, 40, 3).unwrap();
    for (rims, is_kept) in [(Rims::Kept, true), (Rims::Resampled, false)] {
        let mut mesh = input.clone();
        let options = RemeshOptions { rims, ..RemeshOptions::default() };
        let report = run_with(&mut mesh, 0.05, &EdgeSet::new(), &options);
        let rim = |mesh: &Mesh| {
            let rim = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v));
            let mut rim: Vec<_> =
                rim.map(|v| mesh.position(v).to_array().map(f64::to_bits)).collect();
            rim.sort_unstable();
            rim
        };
        assert_eq!(rim(&mesh) == rim(&input), is_kept, "{report:?}");
        assert!((area(&mesh) - area(&input)).abs() < 0.01 * area(&input));
        assert!(mesh.face_count() < 4000, "{}", mesh.face_count());
    }
}

#[test]
fn loops_without_corners_keep_at_least_three_vertices() {
    let mut mesh = shapes::capped_cylinder(0.2, 4.0, 64, 40).unwrap();
    let features = sharp_edges(&mesh, 1.0);
    let report = run_with(&mut mesh, 0.5, &features, &RemeshOptions::default());
    assert_eq!((report.lines, report.corners), (2, 0));
    // Each loop encloses a cap.
    let on_loops = sharp_edges(&mesh, 1.0);
    assert!(on_loops.len() >= 6, "{}", on_loops.len());
}

#[test]
fn data_are_those_of_the_input_at_the_same_place() {
    let mut mesh = shapes::grid(8, 8).unwrap();
    let height = |p: DVec3| 1.0 + 2.0 * p.x - 3.0 * p.y;
    let values = mesh.map_vertices(|v| height(mesh.position(v)));
    mesh.attributes_mut().vertex.insert("height", values);
    // Texture coordinates that jump in the middle.
    let middle = bounding_box(&mesh).unwrap().center().x;
    let chart = |mesh: &Mesh, h| {
        let center: f64 =
            mesh.face_vertices(mesh.face(h).unwrap()).map(|v| mesh.position(v).x).sum();
        f64::from(u8::from(center / 3.0 > middle))
    };
    let uv = |p: DVec3, chart: f64| DVec2::new(p.x + 10.0 * chart, p.y);
    let corners: HalfedgeMap<DVec2> = mesh.map_halfedges(|h| match mesh.face(h) {
        Some(_) => uv(mesh.position(mesh.from(h)), chart(&mesh, h)),
        None => DVec2::ZERO,
    });
    mesh.attributes_mut().corner.insert(UV, corners);
    let side = mesh.map_faces(|f| chart(&mesh, mesh.face_halfedge(f)) as u8);
    mesh.attributes_mut().face.insert("side", side);
    let seams = seam_edges(&mesh);
    assert_eq!(seams.len(), 8);
    let length = 0.6 * edge_length_range(&mesh).unwrap().mean;
    let report = run_with(&mut mesh, length, &seams, &RemeshOptions::default());
    assert!(report.splits > 0);
    let values = mesh.attributes().vertex.get::<f64>("height").unwrap();
    for v in mesh.vertices() {
        assert!((values[v] - height(mesh.position(v))).abs() < 1e-12);
    }
    let found = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
    let sides = mesh.attributes().face.get::<u8>("side").unwrap();
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary_halfedge(h)) {
        let wanted = uv(mesh.position(mesh.from(h)), chart(&mesh, h));
        assert!(found[h].distance(wanted) < 1e-9, "{} is not {wanted}", found[h]);
        assert_eq!(f64::from(sides[mesh.face(h).unwrap()]), chart(&mesh, h));
    }
    assert!(seam_edges(&mesh).len() >= 8, "seams are nowhere else");
    let on_seam = |v: VertexId| (mesh.position(v).x - middle).abs() < 1e-12;
    assert!(seam_edges(&mesh).iter().all(|e| mesh.edge_vertices(e).into_iter().all(on_seam)));
}

#[test]
fn lengths_that_are_none_are_refused_and_change_nothing() {
    let input = shapes::icosphere(2).unwrap();
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        let mut mesh = input.clone();
        let none = (VertexSet::new(), EdgeSet::new());
        let options = RemeshOptions { iterations: 1, ..RemeshOptions::default() };
        if length == 1e-300 {
            // As many triangles are no number; it stops before it starts.
            let result =
                remesh_isotropic(&mut mesh, length, (&none.0, &none.1), &options, Progress::NONE);
            assert!(matches!(result, Err(Error::InvalidOption { name: "length", .. })));
            continue;
        }
        let result =
            remesh_isotropic(&mut mesh, length, (&none.0, &none.1), &options, Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidOption { name: "length", .. })), "{length}");
        let result = remesh_adaptive(
            &mut mesh,
            length,
            (&none.0, &none.1),
            &AdaptiveOptions::default(),
            Progress::NONE,
        );
        assert!(matches!(result, Err(Error::InvalidOption { name: "tolerance", .. })), "{length}");
        assert!(mesh == input);
    }
    let mut quads = shapes::cube();
    let none = (VertexSet::new(), EdgeSet::new());
    let options = RemeshOptions::default();
    let result = remesh_isotropic(&mut quads, 0.1, (&none.0, &none.1), &options, Progress::NONE);
    assert!(matches!(result, Err(Error::NotTriangle { .. })));
}

#[test]
fn a_length_beyond_the_mesh_leaves_the_least_surface_of_its_topology() {
    for (mut mesh, least) in [
        (shapes::icosphere(3).unwrap(), 4),
        (shapes::tetrahedron(), 4),
        (shapes::torus(2.0, 0.7, 30, 20).unwrap(), 14),
        (shapes::disk(4).unwrap(), 1),
    ] {
        let start = mesh.face_count();
        let report = run(&mut mesh, 100.0);
        assert!(mesh.face_count() >= least, "{}", mesh.face_count());
        assert!(mesh.face_count() <= least.max(start / 8), "{} of {start}", mesh.face_count());
        assert_eq!(report.long_edges, 0);
        assert!(report.short_edges > 0);
        assert!(mesh.positions().values().iter().all(|p| p.is_finite()));
    }
}

#[test]
fn meshes_of_one_triangle_and_of_none_and_flat_ones_have_an_answer() {
    let set = IndexedFaceSet::new(
        vec![DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.9, 0.0), DVec3::ONE],
        FaceList::from_indices(&[[0, 1, 2]]),
    )
    .unwrap();
    let one = Mesh::new(&set).unwrap();
    let mut mesh = one.clone();
    let _ = run(&mut mesh, 3.0);
    assert_eq!((mesh.face_count(), mesh.vertex_count()), (1, 4), "the loose vertex stays");
    let mut mesh = one.clone();
    let report = run(&mut mesh, 0.05);
    assert!((area(&mesh) - area(&one)).abs() < 1e-12);
    assert!(report.quality[1].minimum_angle.to_degrees() > 30.0, "{:?}", report.quality[1]);
    assert_eq!(report.origins.values().iter().filter(|origin| origin.is_none()).count(), 1);
    let mut empty = Mesh::default();
    let report = run(&mut empty, 1.0);
    assert_eq!(report.faces, [0, 0]);
    // All in one point, and all on one line.
    for scale in [DVec3::ZERO, DVec3::X] {
        let mut mesh = shapes::icosphere(1).unwrap();
        mesh.set_positions(mesh.map_vertices(|v| mesh.position(v) * scale));
        let _ = run(&mut mesh, 0.3);
        assert!(mesh.positions().values().iter().all(|p| p.is_finite()));
    }
}

#[test]
fn no_iteration_changes_nothing_but_the_numbers() {
    let input = shapes::blob(3).unwrap();
    let mut mesh = input.clone();
    let options = RemeshOptions { iterations: 0, ..RemeshOptions::default() };
    let report = run_with(&mut mesh, 0.01, &EdgeSet::new(), &options);
    assert_eq!((report.splits, report.collapses, report.flips), (0, 0, 0));
    assert!(mesh.positions().values() == input.positions().values());
    assert!(mesh.to_faces() == input.to_faces());
}

#[test]
fn fixed_vertices_stay() {
    let mut mesh = shapes::blob(4).unwrap();
    let fixed: VertexSet = (0..mesh.vertex_count()).step_by(97).map(VertexId::new).collect();
    let places: Vec<DVec3> = fixed.iter().map(|v| mesh.position(v)).collect();
    let options = RemeshOptions::default();
    let kept = (&fixed, &EdgeSet::new());
    let report = remesh_isotropic(&mut mesh, 0.15, kept, &options, Progress::NONE).unwrap();
    assert_eq!(report.corners, places.len());
    for place in places {
        assert!(mesh.positions().values().contains(&place));
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut input = shapes::blob(5).unwrap();
    let values = input.map_vertices(|v| input.position(v).x);
    input.attributes_mut().vertex.insert("x", values);
    let features = sharp_edges(&input, 0.2);
    let results = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut mesh = input.clone();
        let options = RemeshOptions { iterations: 3, ..RemeshOptions::default() };
        let report = pool.install(|| run_with(&mut mesh, 0.03, &features, &options));
        (mesh, report)
    });
    assert!(results[0] == results[1] && results[0] == results[2]);
}

#[test]
fn powers_of_two_scale_the_result_exactly() {
    let input = shapes::with_noise(shapes::torus(2.0, 0.7, 30, 20).unwrap(), 0.01, 2).unwrap();
    let mut plain = input.clone();
    let _ = run(&mut plain, 0.2);
    for exponent in [-200, 3, 300] {
        let factor = 2_f64.powi(exponent);
        let mut mesh = input.clone();
        mesh.set_positions(mesh.map_vertices(|v| mesh.position(v) * factor));
        let _ = run(&mut mesh, 0.2 * factor);
        assert!(mesh.to_faces() == plain.to_faces());
        for v in mesh.vertices() {
            assert_eq!(mesh.position(v), plain.position(v) * factor);
        }
    }
}

#[test]
fn a_cancelled_run_leaves_the_mesh_as_it_was() {
    let input = shapes::icosphere(4).unwrap();
    let none = (VertexSet::new(), EdgeSet::new());
    let kept = (&none.0, &none.1);
    for limit in [0.0, 0.05, 0.3, 0.6, 0.95] {
        let stop =
            |x: f64| if x > limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let progress = Progress::new(&stop);
        let mut mesh = input.clone();
        let options = RemeshOptions::default();
        let result = remesh_isotropic(&mut mesh, 0.05, kept, &options, progress);
        assert!(matches!(result, Err(Error::Cancelled(_))), "{limit}");
        let options = AdaptiveOptions::default();
        let result = remesh_adaptive(&mut mesh, 0.01, kept, &options, progress);
        assert!(matches!(result, Err(Error::Cancelled(_))), "{limit}");
        assert!(mesh == input);
    }
}

#[test]
fn small_components_shrink_but_never_vanish() {
    let sphere = shapes::icosphere(2).unwrap().to_indexed();
    let mut positions = sphere.positions().values().to_vec();
    let mut faces: Vec<[usize; 3]> = Vec::new();
    for (copy, scale) in [(0, 1.0), (1, 0.01)] {
        let start = copy * sphere.vertex_count();
        if copy > 0 {
            let moved = sphere.positions().values().iter();
            positions.extend(moved.map(|&p| p * scale + DVec3::X * 3.0));
        }
        faces.extend((0..sphere.face_count()).map(|f| {
            let face = sphere.faces().face(dgp_mesh::FaceId::new(f));
            [0, 1, 2].map(|k| face[k].index() + start)
        }));
    }
    let set = IndexedFaceSet::new(positions, FaceList::from_indices(&faces)).unwrap();
    let mut mesh = Mesh::new(&set).unwrap();
    let report = run(&mut mesh, 0.3);
    let small = mesh.positions().values().iter().filter(|p| p.x > 2.0).count();
    assert!((4..12).contains(&small), "{small}");
    assert!(report.short_edges >= 6);
}

#[test]
fn adaptive_remeshing_stays_within_its_tolerance() {
    let none = (VertexSet::new(), EdgeSet::new());
    let options = AdaptiveOptions::default();
    for input in [
        shapes::icosphere(4).unwrap(),
        shapes::torus(1.0, 0.3, 80, 40).unwrap(),
        triangles(shapes::dumbbell(0.2, 40, 50).unwrap()),
    ] {
        let mut counts = Vec::new();
        for tolerance in [0.03, 0.01] {
            let mut mesh = input.clone();
            let report =
                remesh_adaptive(&mut mesh, tolerance, (&none.0, &none.1), &options, Progress::NONE)
                    .unwrap();
            mesh.validate().unwrap();
            let told = report.distance.unwrap();
            assert!(told.is_within_tolerance && told.upper <= tolerance, "{told:?}");
            assert!(distance(&mesh, &input) <= tolerance * 1.1);
            let quality = triangle_quality(&mesh).unwrap();
            assert!(quality.low_angle.to_degrees() > 30.0, "{quality:?}");
            counts.push(mesh.face_count());
        }
        assert!(counts[0] < counts[1] && counts[1] < input.face_count(), "{counts:?}");
    }
}

#[test]
fn adaptive_edges_are_short_where_the_surface_bends() {
    let mut mesh = shapes::capped_cylinder(0.2, 4.0, 96, 60).unwrap();
    let features = sharp_edges(&mesh, 1.0);
    let kept = (&VertexSet::new(), &features);
    let options = AdaptiveOptions::default();
    let report = remesh_adaptive(&mut mesh, 0.01, kept, &options, Progress::NONE).unwrap();
    assert!(report.distance.unwrap().is_within_tolerance);
    let mut mesh = shapes::torus(1.0, 0.2, 200, 60).unwrap();
    // A ball at the end of a wide surface: lengths follow curvature.
    mesh.set_positions(mesh.map_vertices(|v| {
        let p = mesh.position(v);
        if p.x > 0.0 { p } else { DVec3::new(p.x, p.y, 0.3 * p.z) }
    }));
    let none = (VertexSet::new(), EdgeSet::new());
    let report =
        remesh_adaptive(&mut mesh, 0.004, (&none.0, &none.1), &options, Progress::NONE).unwrap();
    let lengths = report.quality[1].edge_length.unwrap();
    assert!(lengths.max > 3.0 * lengths.min, "{lengths:?}");
}

/// Real meshes, where `../shared` or `DGP_SHARED_DATA` has them.
fn real(name: &str) -> Option<Mesh> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = env::var_os("DGP_SHARED_DATA").map_or(beside, PathBuf::from);
    let text = fs::read_to_string(data.join(name)).ok()?;
    let mut numbers = text.split_ascii_whitespace().skip(1).map(str::parse::<f64>);
    let mut next = || numbers.next()?.ok();
    let (vertices, faces) = (next()? as usize, next()? as usize);
    next()?;
    let mut positions = Vec::new();
    for _ in 0..vertices {
        positions.push(DVec3::new(next()?, next()?, next()?));
    }
    let mut list = Vec::new();
    for _ in 0..faces {
        next()?;
        list.push([next()? as usize, next()? as usize, next()? as usize]);
    }
    let set = IndexedFaceSet::new(positions, FaceList::from_indices(&list)).ok()?;
    Mesh::new(&set).ok()
}

#[test]
fn sharp_edges_of_fandisk_are_kept() {
    let Some(input) = real("closed/fandisk.off") else { return };
    let features = sharp_edges(&input, 40_f64.to_radians());
    let mut mesh = input.clone();
    let length = edge_length_range(&mesh).unwrap().mean;
    let options = RemeshOptions { iterations: 5, ..RemeshOptions::default() };
    let report = run_with(&mut mesh, length, &features, &options);
    assert!(report.quality[1].low_angle.to_degrees() > 30.0, "{:?}", report.quality);
    // The vertices of what is sharp now lie on what was sharp.
    let diagonal = bounding_box(&input).unwrap().diagonal();
    let segments: Vec<[DVec3; 2]> =
        features.iter().map(|e| input.edge_vertices(e).map(|v| input.position(v))).collect();
    let to_segments = |p: DVec3| {
        let to = |[a, b]: &[DVec3; 2]| {
            let side = *b - *a;
            let t = (side.dot(p - *a) / side.length_squared()).clamp(0.0, 1.0);
            p.distance(*a + side * t)
        };
        segments.iter().map(to).fold(f64::INFINITY, f64::min)
    };
    let now = sharp_edges(&mesh, 40_f64.to_radians());
    let (mut kept, mut whole) = (0.0, 0.0);
    for e in now.iter() {
        let [a, b] = mesh.edge_vertices(e).map(|v| mesh.position(v));
        whole += a.distance(b);
        if [a, b].into_iter().all(|p| to_segments(p) < 1e-9 * diagonal) {
            kept += a.distance(b);
        }
    }
    let before: f64 = segments.iter().map(|[a, b]| a.distance(*b)).sum();
    assert!(kept > 0.99 * before, "of {before} sharp {kept} are kept of {whole} sharp now");
}

#[test]
fn tables_without_columns_stay_so() {
    let mut mesh = shapes::icosphere(2).unwrap();
    let _ = run(&mut mesh, 0.3);
    let data = mesh.attributes();
    assert!(data.vertex.is_empty() && data.corner.is_empty() && data.face.is_empty());
    assert_eq!(data.vertex, AttributeTable::new(mesh.vertex_count()));
}
