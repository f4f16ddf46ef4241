//! Centroidal Voronoi remeshing: angles, distance, topology, boundaries, data.

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicUsize, Ordering::Relaxed},
};

use dgp_mesh::{
    Color, DVec2, DVec3, Editor, FaceId, FaceSet, Mesh, Progress, UV, VertexId,
    curvature::principal_curvatures,
    measure::{area, edge_lengths, volume},
    shapes,
    spatial::{HausdorffOptions, TriangleTree, hausdorff},
    topology::{boundary_loops, components, euler_characteristic},
};
use dgp_remesh::{Error, VoronoiOptions, VoronoiPlacement, VoronoiReport, voronoi_remesh};

fn remeshed(mesh: &Mesh, vertices: usize, options: &VoronoiOptions) -> (Mesh, VoronoiReport) {
    let (result, report) = voronoi_remesh(mesh, vertices, options, Progress::NONE).unwrap();
    result.validate().unwrap();
    assert!(report.topology_kept, "{report:?}");
    assert_eq!(euler_characteristic(mesh), euler_characteristic(&result));
    assert_eq!(boundary_loops(mesh).len(), boundary_loops(&result).len());
    assert_eq!(components(mesh).count, components(&result).count);
    (result, report)
}

fn distance(a: &Mesh, b: &Mesh) -> f64 {
    let [a, b] = [a, b].map(|mesh| TriangleTree::new(mesh, Progress::NONE).unwrap());
    hausdorff(&a, &b, &HausdorffOptions::default(), Progress::NONE).unwrap().upper()
}

/// Without the faces whose center is so.
fn without(mut mesh: Mesh, gone: impl Fn(DVec3) -> bool) -> Mesh {
    let faces: FaceSet = mesh.faces().filter(|&f| gone(mesh.face_center(f))).collect();
    let mut editor = Editor::new(&mut mesh);
    let _ = editor.remove_faces(&faces).unwrap();
    editor.remove_isolated_vertices();
    let _ = editor.finish();
    mesh
}

#[test]
fn triangles_are_nearly_equal_and_close_to_the_input() {
    for (name, mesh, vertices) in [
        ("sphere", shapes::icosphere(5).unwrap(), 1000),
        ("coarse sphere", shapes::icosphere(2).unwrap(), 1000),
        ("torus", shapes::torus(2.0, 0.7, 200, 40).unwrap(), 1500),
        ("blob", shapes::blob(5).unwrap(), 2000),
    ] {
        let (result, report) = remeshed(&mesh, vertices, &VoronoiOptions::default());
        assert_eq!((result.vertex_count(), report.splits), (vertices, 0), "{name}");
        // An equilateral triangle of the mean area.
        let edge = (area(&mesh) / (0.5 * 3_f64.sqrt() * vertices as f64)).sqrt();
        assert!(report.minimum_angle.to_degrees() > 25.0, "{name}: {report:?}");
        assert!(report.mean_minimum_angle.to_degrees() > 50.0, "{name}: {report:?}");
        assert!(report.regular > 0.7, "{name}: {report:?}");
        assert!(report.energy < 1.0, "{name}: {report:?}");
        let lengths = edge_lengths(&result);
        let range = lengths
            .values()
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(least, most), &x| (least.min(x), most.max(x)));
        assert!(range.0 > 0.5 * edge && range.1 < 1.7 * edge, "{name}: {range:?} {edge}");
        // Chords of this length are so far from a surface that bends like a ball of radius 0.7.
        let sagitta = edge * edge / 0.7;
        assert!(distance(&mesh, &result) < sagitta, "{name}: {} {edge}", distance(&mesh, &result));
    }
}

#[test]
fn topology_stays_whatever_is_asked_for() {
    let handles = shapes::surface_of_genus(3, 2).unwrap();
    for (name, mesh, counts) in [
        ("sphere", shapes::icosphere(3).unwrap(), vec![1, 3, 4, 5, 10]),
        ("cube", shapes::cuboid(DVec3::ONE, [1, 1, 1]).unwrap(), vec![1, 4, 8, 100]),
        ("torus", shapes::torus(2.0, 0.3, 40, 12).unwrap(), vec![1, 7, 20, 60]),
        ("handles", handles, vec![1, 20, 200]),
        ("disk", shapes::disk(5).unwrap(), vec![1, 2, 3, 10, 100]),
        ("ring", shapes::annulus(0.8, 1.0, 60, 2).unwrap(), vec![1, 3, 30, 200]),
        ("triangle", without(shapes::grid(1, 1).unwrap(), |p| p.x < p.y), vec![1, 2, 3, 20]),
        ("gyroid", shapes::gyroid(2, 6).unwrap(), vec![10, 300]),
    ] {
        for count in counts {
            let (result, report) = remeshed(&mesh, count, &VoronoiOptions::default());
            assert_eq!(result.vertex_count(), report.vertices[1], "{name} {count}");
            assert!(result.vertex_count() >= count, "{name} {count}");
            assert!(result.vertex_count() < 6 * count + 400, "{name} {count} {report:?}");
        }
    }
    // Two balls and a disk, of which each has its own.
    let mut parts = shapes::icosphere(3).unwrap().to_indexed();
    let before = parts.vertex_count();
    let mut faces = parts.faces().clone();
    let mut points = parts.positions().values().to_vec();
    for (f, corners) in parts.faces().iter().collect::<Vec<_>>() {
        let _ = f;
        let moved: Vec<VertexId> =
            corners.iter().map(|v| VertexId::new(v.index() + before)).collect();
        faces.push(&moved);
    }
    points.extend(parts.positions().values().iter().map(|&p| 0.01 * p + 3.0 * DVec3::X));
    parts = dgp_mesh::IndexedFaceSet::new(points, faces).unwrap();
    let mesh = Mesh::new(&parts).unwrap();
    let (result, _) = remeshed(&mesh, 100, &VoronoiOptions::default());
    assert_eq!(components(&result).count, 2);
}

#[test]
fn boundaries_stay_where_they_are() {
    let mesh = shapes::disk(12).unwrap();
    let (result, report) = remeshed(&mesh, 300, &VoronoiOptions::default());
    assert!(report.minimum_angle.to_degrees() > 20.0, "{report:?}");
    for rim in boundary_loops(&result) {
        for h in rim {
            let p = result.position(result.from(h));
            assert!(p.length() > 0.998 && p.length() < 1.0 + 1e-12, "{p}");
        }
    }
    assert!(result.vertices().all(|v| result.position(v).z == 0.0));
    assert!((area(&result) - area(&mesh)).abs() < 0.01 * area(&mesh));
    // A plane stays a plane, nothing is turned over.
    assert!(result.faces().all(|f| result.face_normal(f).z > 0.999));
}

#[test]
fn edges_and_corners_are_kept_where_asked_for() {
    let cube = shapes::cuboid(DVec3::ONE, [8, 8, 8]).unwrap();
    let options =
        VoronoiOptions { placement: VoronoiPlacement::Sharp, ..VoronoiOptions::default() };
    let (mean, _) = remeshed(&cube, 600, &VoronoiOptions::default());
    let (sharp, _) = remeshed(&cube, 600, &options);
    let edge = (area(&cube) / (0.5 * 3_f64.sqrt() * 600.0)).sqrt();
    let (blunt, near) = (distance(&cube, &mean), distance(&cube, &sharp));
    assert!(near < 0.75 * blunt && near < 0.6 * edge, "{near} {blunt} {edge}");
    assert!((volume(&sharp) - 1.0).abs() < 0.4 * (volume(&mean) - 1.0).abs());
}

#[test]
fn more_vertices_where_it_bends() {
    // A torus bends more inside of the tube's small radius; a long ellipsoid at its ends.
    let mut mesh = shapes::icosphere(5).unwrap();
    for v in mesh.vertices().collect::<Vec<_>>() {
        let p = mesh.position(v);
        mesh.set_position(v, DVec3::new(4.0 * p.x, p.y, p.z));
    }
    let share = |mesh: &Mesh| {
        let ends = mesh.vertices().filter(|&v| mesh.position(v).x.abs() > 3.0).count();
        ends as f64 / mesh.vertex_count() as f64
    };
    let (even, _) = remeshed(&mesh, 1000, &VoronoiOptions::default());
    let options = VoronoiOptions { gradation: 1.5, ..VoronoiOptions::default() };
    let (graded, report) = remeshed(&mesh, 1000, &options);
    assert!(share(&graded) > 1.3 * share(&even), "{} {}", share(&graded), share(&even));
    assert!(report.minimum_angle.to_degrees() > 15.0 && report.regular > 0.6, "{report:?}");
    // Cells of equal Σ √ρ A: edges get shorter as c^(−γ/4).
    let curvatures = principal_curvatures(&graded).unwrap();
    let mean_edge = |least: f64, most: f64| {
        let mut lengths = Vec::new();
        for e in graded.edges() {
            let [a, b] = graded.edge_vertices(e);
            let bend = 0.5 * (curvatures[a].max.abs() + curvatures[b].max.abs());
            if (least..most).contains(&bend) {
                lengths.push(graded.edge_length(e));
            }
        }
        lengths.iter().sum::<f64>() / lengths.len() as f64
    };
    assert!(mean_edge(2.0, 3.5) < 0.8 * mean_edge(0.9, 1.1));
    assert!(distance(&mesh, &graded) < 0.9 * distance(&mesh, &even));
}

#[test]
fn data_travel() {
    let mut mesh = shapes::icosphere(4).unwrap();
    let height: Vec<f64> = mesh.vertices().map(|v| mesh.position(v).z).collect();
    mesh.attributes_mut().vertex.insert("height", height);
    let north: Vec<u8> = mesh.faces().map(|f| u8::from(mesh.face_center(f).z > 0.0)).collect();
    mesh.attributes_mut().face.insert("north", north);
    let at = |mesh: &Mesh, h| mesh.position(mesh.from(h));
    let smooth: Vec<DVec2> = mesh.halfedges().map(|h| at(&mesh, h).truncate()).collect();
    mesh.attributes_mut().corner.insert(UV, smooth);
    let jumping: Vec<Color> = mesh
        .halfedges()
        .map(|h| Color::from_rgb8([mesh.face(h).map_or(0, FaceId::index) as u8, 0, 0]))
        .collect();
    mesh.attributes_mut().corner.insert("jumping", jumping);
    let weights: Vec<f64> = mesh.edges().map(|_| 1.0).collect();
    mesh.attributes_mut().edge.insert("weight", weights);
    let (result, report) = remeshed(&mesh, 400, &VoronoiOptions::default());
    assert_eq!(report.dropped, ["weight", "jumping"]);
    for v in result.vertices() {
        let value = result.attributes().vertex.get::<f64>("height").unwrap()[v];
        assert!((value - result.position(v).z).abs() < 1e-9);
    }
    for f in result.faces() {
        let z = result.face_center(f).z;
        if z.abs() > 0.2 {
            assert_eq!(result.attributes().face.get::<u8>("north").unwrap()[f], u8::from(z > 0.0));
        }
        for h in result.face_halfedges(f) {
            let value = result.attributes().corner.get::<DVec2>(UV).unwrap()[h];
            assert!(value.distance(at(&result, h).truncate()) < 1e-9);
        }
    }
}

#[test]
fn same_bits_for_any_number_of_threads_and_scale() {
    let mesh = shapes::blob(4).unwrap();
    let run = |threads: usize, scale: f64| {
        let mut mesh = mesh.clone();
        for v in mesh.vertices().collect::<Vec<_>>() {
            mesh.set_position(v, scale * mesh.position(v));
        }
        let options = VoronoiOptions {
            gradation: 1.0,
            placement: VoronoiPlacement::Sharp,
            ..VoronoiOptions::default()
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| remeshed(&mesh, 300, &options).0)
    };
    let one = run(1, 1.0);
    for (threads, scale) in [(2, 1.0), (8, 1.0), (2, 2.0_f64.powi(40)), (2, 2.0_f64.powi(-40))] {
        let other = run(threads, scale);
        assert_eq!(one.to_faces(), other.to_faces());
        for v in one.vertices() {
            assert_eq!(one.position(v) * scale, other.position(v), "{threads} {scale} {v}");
        }
    }
}

#[test]
fn bad_input_is_named_and_runs_can_be_stopped() {
    let mesh = shapes::blob(3).unwrap();
    let default = VoronoiOptions::default();
    let call = |mesh: &Mesh, vertices, options: &VoronoiOptions| {
        voronoi_remesh(mesh, vertices, options, Progress::NONE).unwrap_err()
    };
    for (name, vertices, options) in [
        ("vertices", 0, default),
        ("vertices", usize::MAX, default),
        ("vertices", 1 << 24, VoronoiOptions { resolution: 1000.0, ..default }),
        ("resolution", 10, VoronoiOptions { resolution: f64::NAN, ..default }),
        ("gradation", 10, VoronoiOptions { gradation: -1.0, ..default }),
    ] {
        let error = call(&mesh, vertices, &options);
        assert!(
            matches!(error, Error::InvalidOption { name: found, .. } if found == name),
            "{error}"
        );
    }
    assert_eq!(call(&Mesh::default(), 10, &default), Error::NoArea);
    let error = call(&shapes::dodecahedron(), 10, &default);
    assert_eq!(error, Error::NotTriangle { face: FaceId::new(0), degree: 5 });
    let mut broken = mesh.clone();
    broken.set_position(VertexId::new(4), DVec3::INFINITY);
    assert_eq!(call(&broken, 10, &default), Error::NotFinite { vertex: VertexId::new(4) });
    let reports = AtomicUsize::new(0);
    let count = |_: f64| {
        reports.fetch_add(1, Relaxed);
        ControlFlow::Continue(())
    };
    let _ = voronoi_remesh(&mesh, 100, &default, Progress::new(&count)).unwrap();
    for stop in 0..reports.into_inner() {
        let seen = AtomicUsize::new(0);
        let report = |_: f64| match seen.fetch_add(1, Relaxed) {
            before if before < stop => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        };
        let result = voronoi_remesh(&mesh, 100, &default, Progress::new(&report));
        assert!(matches!(result, Err(Error::Cancelled(_))), "{stop}");
    }
}
