//! Repair of surfaces: each defect alone and several together, counted against what was planted.

use std::{f64::consts::PI, ops::ControlFlow};

use dgp_mesh::{
    COLOR, Color, DVec2, DVec3, Editor, FaceId, FaceList, FaceSet, IndexedFaceSet, Mesh, Progress,
    Severity, Tolerance, UV, VertexId, defects,
    measure::volume,
    shapes::{self, Random},
    spatial::TriangleTree,
    topology::{boundary_loops, components},
};
use dgp_remesh::{
    Error, FillOptions, IntersectionOptions, LeastComponent, OpenSurfaces, Patch, SliverOptions,
    SurfaceRepairOptions, cap_faces, drop_small_components, hidden_fronts, needle_faces,
    remove_self_intersections, remove_slivers, repair_surface, stitch_rims,
};

fn mesh_of(points: &[[f64; 3]], faces: &[[usize; 3]]) -> Mesh {
    Mesh::new(&set_of(points, faces)).unwrap()
}

fn set_of(points: &[[f64; 3]], faces: &[[usize; 3]]) -> IndexedFaceSet {
    let positions: Vec<DVec3> = points.iter().map(|&p| DVec3::from_array(p)).collect();
    IndexedFaceSet::new(positions, FaceList::from_indices(faces)).unwrap()
}

/// Several sets beside each other.
fn together(sets: &[IndexedFaceSet]) -> IndexedFaceSet {
    let (mut positions, mut faces) = (Vec::new(), FaceList::new());
    for set in sets {
        let start = positions.len();
        positions.extend_from_slice(set.positions().values());
        for (_, face) in set.faces().iter() {
            let face: Vec<VertexId> =
                face.iter().map(|v| VertexId::new(v.index() + start)).collect();
            faces.push(&face);
        }
    }
    IndexedFaceSet::new(positions, faces).unwrap()
}

fn moved(mesh: &Mesh, scale: f64, offset: DVec3) -> Mesh {
    let mut mesh = mesh.clone();
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_position(v, scale * mesh.position(v) + offset);
    }
    mesh
}

fn turned(mesh: &Mesh) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.reverse();
    mesh
}

fn meeting(mesh: &Mesh) -> usize {
    TriangleTree::new(mesh, Progress::NONE)
        .unwrap()
        .self_intersections(Progress::NONE)
        .unwrap()
        .len()
}

/// Repairs, demands that the result has no defects, and that a second repair changes nothing.
fn repaired(name: &str, set: &IndexedFaceSet, options: &SurfaceRepairOptions) -> Mesh {
    let (mesh, report) = repair_surface(set, options, Progress::NONE).unwrap();
    mesh.validate().unwrap();
    assert!(report.is_sound(), "{name}: {:?}", report.steps());
    let again = mesh.to_indexed();
    let mut left = defects(&again, Progress::NONE).unwrap();
    left.add_self_intersections(&again, Progress::NONE).unwrap();
    assert_eq!(
        left.of(Severity::Error).chain(left.of(Severity::Warning)).count(),
        0,
        "{name}: {left}"
    );
    let (second, report) = repair_surface(&again, options, Progress::NONE).unwrap();
    assert!(report.is_unchanged(), "{name} again: {:?} {:?}", report.faces.changes, report.steps());
    assert_eq!(second.to_indexed().positions(), again.positions(), "{name}");
    assert_eq!(second.to_indexed().faces(), again.faces(), "{name}");
    mesh
}

#[test]
fn what_is_sound_stays_as_it_is() {
    for (name, mesh) in [
        ("cube", shapes::cube()),
        ("sphere", shapes::icosphere(3).unwrap()),
        ("torus", shapes::torus(2.0, 0.7, 40, 20).unwrap()),
        ("annulus", shapes::annulus(0.5, 1.0, 30, 4).unwrap()),
    ] {
        let set = mesh.to_indexed();
        let (same, report) =
            repair_surface(&set, &SurfaceRepairOptions::default(), Progress::NONE).unwrap();
        assert!(report.is_unchanged(), "{name}: {:?}", report.steps());
        assert_eq!(same.to_indexed().faces(), set.faces(), "{name}");
        assert_eq!(report.vertices.values().iter().flatten().count(), set.vertex_count(), "{name}");
    }
}

/// A triangle mesh with needles beside the first vertices: each is two needles, by a vertex on an edge
/// that is all but at its start.
fn with_needles(mut mesh: Mesh, count: usize, fraction: f64) -> Mesh {
    let mut editor = Editor::new(&mut mesh);
    let edges: Vec<_> = editor.edges().step_by(7).take(count).collect();
    for e in edges {
        let [a, b] = editor.mesh().edge_vertices(e).map(|v| editor.mesh().position(v));
        let _ = editor.split_edge_triangles(e, a + fraction * (b - a)).unwrap();
    }
    let _ = editor.finish();
    mesh
}

#[test]
fn needles_are_collapsed_and_nothing_else() {
    let sphere = shapes::icosphere(3).unwrap();
    let mut mesh = with_needles(sphere.clone(), 20, 1e-6);
    let options = SliverOptions::default();
    assert_eq!(needle_faces(&mesh, options.needle_ratio).len(), 40);
    let report = remove_slivers(&mut mesh, &options, Progress::NONE).unwrap();
    mesh.validate().unwrap();
    assert_eq!((report.collapsed, report.flipped, report.left.len()), (20, 0, 0));
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (642, 1280));
    assert!(mesh.vertices().all(|v| (mesh.position(v).length() - 1.0).abs() < 1e-5));
    // A tenth of an edge is farther than the surface may move.
    let mut long = with_needles(sphere, 5, 0.1);
    let strict = SliverOptions { needle_ratio: 5.0, max_move: 1e-3, ..options };
    let report = remove_slivers(&mut long, &strict, Progress::NONE).unwrap();
    assert_eq!((report.collapsed, report.left.len()), (0, 10));
    let loose = SliverOptions { max_move: 0.05, ..strict };
    let report = remove_slivers(&mut long, &loose, Progress::NONE).unwrap();
    assert_eq!((report.collapsed, report.left.len()), (5, 0));
}

#[test]
fn caps_are_flipped_and_creases_stay() {
    // A square of four triangles around a vertex that is all but on the diagonal between two of them.
    let points = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 2.0, 0.0],
        [0.0, 2.0, 0.0],
        [1.0 + 1e-7, 1.0 - 1e-7, 0.0],
    ];
    let mut mesh = mesh_of(&points, &[[0, 1, 4], [1, 2, 4], [0, 4, 2], [0, 2, 3]]);
    let options = SliverOptions::default();
    assert_eq!(cap_faces(&mesh, options.cap_angle), [FaceId::new(2)]);
    let report = remove_slivers(&mut mesh, &options, Progress::NONE).unwrap();
    assert_eq!((report.flipped, report.collapsed, report.left.len()), (1, 0, 0));
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (5, 4));
    assert!(mesh.faces().all(|f| mesh.face_normal(f).z > 0.99));

    // At a rim the cap goes, and its corner is on the rim.
    let mut rim = mesh_of(&points, &[[0, 1, 4], [1, 2, 4], [0, 4, 2]]);
    let report = remove_slivers(&mut rim, &options, Progress::NONE).unwrap();
    assert_eq!((report.removed, rim.face_count()), (1, 2));

    // Needles along the edges of a cube: its corners stay where they are.
    let mut cube = shapes::cube();
    let _ = dgp_mesh::triangulate(&mut cube, dgp_mesh::TriangulationMethod::Ears, Progress::NONE);
    let corners: Vec<DVec3> = cube.positions().values().to_vec();
    let mut cube = with_needles(cube, 3, 1e-6);
    assert_eq!(remove_slivers(&mut cube, &options, Progress::NONE).unwrap().collapsed, 3);
    assert_eq!(cube.positions().values(), corners);
}

#[test]
fn t_junctions_are_split_and_joined() {
    // Two grids beside each other, one with edges half as long.
    let grid = |cells: usize, x: f64| {
        let size = 4.0 / cells as f64;
        let at = |i: usize, j: usize| [x + size * i as f64, size * j as f64, 0.0];
        let points: Vec<_> = (0..=cells).flat_map(|j| (0..=cells).map(move |i| at(i, j))).collect();
        let faces: Vec<[usize; 3]> = (0..cells * cells)
            .flat_map(|k| {
                let a = k / cells * (cells + 1) + k % cells;
                [[a, a + 1, a + cells + 2], [a, a + cells + 2, a + cells + 1]]
            })
            .collect();
        set_of(&points, &faces)
    };
    let set = together(&[grid(4, 0.0), grid(8, 4.0)]);
    let mut mesh = Mesh::new(&set).unwrap();
    let (vertices, faces) = (mesh.vertex_count(), mesh.face_count());
    let report = stitch_rims(&mut mesh, Tolerance::OfDiagonal(1e-9), Progress::NONE).unwrap();
    mesh.validate().unwrap();
    assert_eq!((report.junctions, report.joined, report.merged), (4, 8, 9));
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (vertices + 4 - 9, faces + 4));
    assert_eq!((components(&mesh).count, boundary_loops(&mesh).len()), (1, 1));
    let again = stitch_rims(&mut mesh, Tolerance::OfDiagonal(1e-9), Progress::NONE).unwrap();
    assert_eq!((again.junctions, again.joined, again.merged), (0, 0, 0));
    // A corner that touches an edge in its middle is no junction.
    let touching = together(&[
        set_of(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]], &[[0, 1, 2]]),
        set_of(&[[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [2.0, -1.0, 0.0]], &[[0, 1, 2]]),
    ]);
    let mut touching = Mesh::new(&touching).unwrap();
    let report = stitch_rims(&mut touching, Tolerance::OfDiagonal(1e-9), Progress::NONE).unwrap();
    assert_eq!((report.junctions, report.joined), (0, 0));
}

#[test]
fn rims_are_joined_with_components_turned_for_it() {
    let sphere = shapes::icosphere(3).unwrap();
    let halves = |upper: bool| {
        let mut half = sphere.clone();
        let gone: FaceSet =
            half.faces().filter(|&f| (half.face_center(f).z > 0.0) != upper).collect();
        let mut editor = Editor::new(&mut half);
        let _ = editor.remove_faces(&gone).unwrap();
        editor.remove_isolated_vertices();
        let _ = editor.finish();
        half
    };
    let set = together(&[halves(true).to_indexed(), turned(&halves(false)).to_indexed()]);
    let mesh = repaired("halves", &set, &SurfaceRepairOptions::default());
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (642, 1280));
    assert!(boundary_loops(&mesh).is_empty() && volume(&mesh) > 4.0);
    // A Möbius strip that was cut stays cut.
    let strip = shapes::mobius_strip(30, 4).unwrap();
    let cut = repaired("Möbius", &strip, &SurfaceRepairOptions::default());
    assert_eq!(components(&cut).count, 1);
}

#[test]
fn spikes_through_a_surface_are_cut_off() {
    let mut mesh = shapes::icosphere(4).unwrap();
    let mut random = Random::new(5);
    let mut planted = 0;
    for v in mesh.vertices().step_by(301).collect::<Vec<_>>() {
        let p = mesh.position(v);
        mesh.set_position(v, -(1.2 + 0.2 * random.normal().abs()) * p);
        planted += 1;
    }
    assert!(planted >= 8 && meeting(&mesh) > planted);
    let faces = mesh.face_count();
    let mut cut = mesh.clone();
    let report =
        remove_self_intersections(&mut cut, &IntersectionOptions::default(), Progress::NONE)
            .unwrap();
    cut.validate().unwrap();
    assert_eq!((report.found.len(), report.left.len()), (meeting(&mesh), 0));
    assert_eq!((meeting(&cut), boundary_loops(&cut).len(), report.open), (0, 0, 0));
    assert!(report.removed < faces / 5, "{} of {faces}", report.removed);
    assert!((volume(&cut) - 4.0 / 3.0 * PI).abs() < 0.1, "{}", volume(&cut));
    let again =
        remove_self_intersections(&mut cut, &IntersectionOptions::default(), Progress::NONE)
            .unwrap();
    assert_eq!((again.found.len(), again.rounds), (0, 0));
}

#[test]
fn spheres_that_overlap_lose_what_is_within() {
    let sphere = shapes::icosphere(4).unwrap();
    let other = moved(&sphere, 1.0, DVec3::new(1.1, 0.07, 0.03));
    let mut mesh = Mesh::new(&together(&[sphere.to_indexed(), other.to_indexed()])).unwrap();
    let report = remove_self_intersections(
        &mut mesh,
        &IntersectionOptions { max_removed: 0.6, ..IntersectionOptions::default() },
        Progress::NONE,
    )
    .unwrap();
    assert!(report.left.is_empty() && boundary_loops(&mesh).is_empty());
    assert_eq!((components(&mesh).count, report.pieces), (2, 2));
    // The union, by the height of the caps that overlap.
    let cap = 1.0 - 0.5 * DVec3::new(1.1, 0.07, 0.03).length();
    let union = 2.0 * (4.0 / 3.0 * PI) - 2.0 * PI * cap * cap * (3.0 - cap) / 3.0;
    assert!((volume(&mesh) - union).abs() < 0.05 * union, "{} of {union}", volume(&mesh));
}

#[test]
fn what_is_too_much_to_cut_is_left_and_told() {
    // Two tetrahedra in each other: each face meets one of the other.
    let tetrahedron = shapes::tetrahedron();
    let other = moved(&turned(&tetrahedron), -1.0, DVec3::splat(0.01));
    let set = together(&[tetrahedron.to_indexed(), other.to_indexed()]);
    let (mesh, report) =
        repair_surface(&set, &SurfaceRepairOptions::default(), Progress::NONE).unwrap();
    assert!(!report.is_sound() && report.is_unchanged(), "{:?}", report.steps());
    assert_eq!((mesh.face_count(), report.intersections.left.len()), (8, meeting(&mesh)));
    assert_eq!(report.intersections.left, report.intersections.found);
}

#[test]
fn small_components_go_by_faces_area_or_volume() {
    let sphere = shapes::icosphere(2).unwrap();
    let at = |scale: f64, x: f64| moved(&sphere, scale, DVec3::new(x, 0.0, 0.0)).to_indexed();
    let flat = moved(&shapes::annulus(0.5, 1.0, 30, 4).unwrap(), 0.2, DVec3::Z * 5.0).to_indexed();
    let set = together(&[at(1.0, 0.0), at(0.5, 3.0), at(0.1, 5.0), flat]);
    let count = |least: LeastComponent| {
        let mut mesh = Mesh::new(&set).unwrap();
        let dropped = drop_small_components(&mut mesh, &least, Progress::NONE).unwrap().len();
        assert_eq!(components(&mesh).count + dropped, 4);
        mesh.validate().unwrap();
        dropped
    };
    let none = LeastComponent::default();
    assert_eq!(count(none), 0);
    assert_eq!(count(LeastComponent { faces: 300, ..none }), 1);
    // Areas are as 1, 1/4, 1/100 and less; volumes as 1, 1/8, 1/1000, and the flat one has none.
    assert_eq!(count(LeastComponent { area: 0.1, ..none }), 2);
    assert_eq!(count(LeastComponent { volume: 0.01, ..none }), 1);
    assert_eq!(count(LeastComponent { volume: 0.5, ..none }), 2);
}

#[test]
fn closed_components_look_outward_and_cavities_inward() {
    let sphere = shapes::icosphere(2).unwrap();
    let shell = |scale: f64, outward: bool| {
        let sphere = moved(&sphere, scale, DVec3::ZERO);
        if outward { sphere.to_indexed() } else { turned(&sphere).to_indexed() }
    };
    // Outermost inside out, then a cavity, then a body within it that is inside out.
    let set = together(&[shell(3.0, false), shell(2.0, false), shell(1.0, false)]);
    let mesh = repaired("shells", &set, &SurfaceRepairOptions::default());
    let one = volume(&sphere);
    assert!(
        (volume(&mesh) - (27.0 - 8.0 + 1.0) * one).abs() < 1e-9 * one,
        "{}",
        volume(&mesh) / one
    );
}

#[test]
fn open_components_turn_to_where_they_are_seen_from() {
    let mut bowl = shapes::icosphere(3).unwrap();
    let cap: FaceSet = bowl.faces().filter(|&f| bowl.face_center(f).z > 0.7).collect();
    let mut editor = Editor::new(&mut bowl);
    let _ = editor.remove_faces(&cap).unwrap();
    editor.remove_isolated_vertices();
    let _ = editor.finish();
    let hidden = |mesh: &Mesh| hidden_fronts(mesh, Progress::NONE).unwrap().len();
    assert_eq!((hidden(&bowl), hidden(&turned(&bowl))), (0, 1));
    let flat = shapes::annulus(0.5, 1.0, 30, 4).unwrap();
    assert_eq!((hidden(&flat), hidden(&turned(&flat))), (0, 0));
    let options = SurfaceRepairOptions {
        open_surfaces: OpenSurfaces::BySight,
        ..SurfaceRepairOptions::default()
    };
    let mesh = repaired("bowl", &turned(&bowl).to_indexed(), &options);
    assert!(mesh.faces().all(|f| mesh.face_normal(f).dot(mesh.face_center(f)) > 0.0));
}

#[test]
fn many_defects_at_once_are_mended() {
    for seed in 0..6 {
        let mut sphere = shapes::icosphere(4).unwrap();
        let v = VertexId::new(100 + seed as usize);
        sphere.set_position(v, -1.3 * sphere.position(v));
        let sphere = with_needles(sphere, 10, 1e-7);
        let scan = shapes::flip_patch(&sphere.to_indexed(), 0.2, seed);
        let scan = shapes::unweld_patch(&scan, 0.15, seed + 10);
        let crumb = moved(&shapes::tetrahedron(), 1e-3, DVec3::X * 2.0).to_indexed();
        let mut positions = together(&[scan, crumb]);
        // Faces that repeat others, forwards and backwards.
        let mut faces = positions.faces().clone();
        let first = faces.face(FaceId::new(200)).to_vec();
        faces.push(&first);
        let second: Vec<VertexId> = faces.face(FaceId::new(1000)).iter().rev().copied().collect();
        faces.push(&second);
        positions = IndexedFaceSet::new(positions.positions().clone(), faces).unwrap();
        let options = SurfaceRepairOptions {
            components: LeastComponent { faces: 10, ..LeastComponent::default() },
            holes: Some(FillOptions { patch: Patch::Cover, ..FillOptions::default() }),
            ..SurfaceRepairOptions::default()
        };
        let mesh = repaired(&format!("seed {seed}"), &positions, &options);
        assert!(boundary_loops(&mesh).is_empty());
        assert_eq!(components(&mesh).count, 1);
        assert!((volume(&mesh) - 4.0 / 3.0 * PI).abs() < 0.1, "{}", volume(&mesh));
    }
}

#[test]
fn data_travel() {
    let mut sphere = shapes::icosphere(3).unwrap();
    let v = VertexId::new(7);
    sphere.set_position(v, -1.3 * sphere.position(v));
    let mut set = sphere.to_indexed();
    let at: Vec<DVec2> = set.positions().values().iter().map(|p| p.truncate()).collect();
    let corners: Vec<DVec2> = set.faces().corners().iter().map(|&v| at[v.index()]).collect();
    set.corner_attributes.insert(UV, corners);
    set.vertex_attributes.insert("x", at.iter().map(|p| p.x).collect::<Vec<f64>>());
    let colors = vec![Color([0.2, 0.4, 0.6, 1.0]); set.face_count()];
    set.face_attributes.insert(COLOR, colors.clone());
    let (mesh, report) =
        repair_surface(&set, &SurfaceRepairOptions::default(), Progress::NONE).unwrap();
    assert!(report.intersections.filled > 0);
    let new = mesh.to_indexed();
    let x = new.vertex_attributes.get::<f64>("x").unwrap();
    assert!(new.positions().iter().all(|(v, p)| (x[v] - p.x).abs() < 1e-12));
    let uv = new.corner_attributes.get::<DVec2>(UV).unwrap();
    for (c, &v) in uv.values().iter().zip(new.faces().corners()) {
        assert!(c.distance(new.position(v).truncate()) < 1e-12);
    }
    assert_eq!(
        new.face_attributes.get::<Color>(COLOR).unwrap().values(),
        &colors[..new.face_count()]
    );
    // The maps lead to the same places.
    for (v, place) in report.vertices.iter() {
        if let Some(w) = *place {
            assert_eq!(set.position(v), mesh.position(w));
        }
    }
    for (f, source) in report.face_sources.iter() {
        if let Some(g) = *source {
            let center = set.faces().face(g).iter().map(|&v| set.position(v)).sum::<DVec3>() / 3.0;
            assert!(center.distance(mesh.face_center(f)) < 1e-12);
        }
    }
}

#[test]
fn it_stops_when_asked_to_and_refuses_what_makes_no_sense() {
    let mut sphere = shapes::icosphere(3).unwrap();
    sphere.set_position(VertexId::new(0), -1.5 * sphere.position(VertexId::new(0)));
    let set = with_needles(sphere, 3, 1e-6).to_indexed();
    for limit in [0.0, 0.2, 0.4, 0.6, 0.9] {
        let stop = |done: f64| {
            if done > limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let result = repair_surface(&set, &SurfaceRepairOptions::default(), Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))), "{limit}");
    }
    let refused = |change: fn(&mut SurfaceRepairOptions)| {
        let mut options = SurfaceRepairOptions::default();
        change(&mut options);
        let result = repair_surface(&set, &options, Progress::NONE);
        matches!(result, Err(Error::InvalidOption { .. } | Error::Mesh(_)))
    };
    let slivers = SliverOptions::default();
    assert!(refused(
        |o| o.slivers = Some(SliverOptions { needle_ratio: 0.5, ..SliverOptions::default() })
    ));
    assert!(refused(
        |o| o.slivers = Some(SliverOptions { cap_angle: 1.0, ..SliverOptions::default() })
    ));
    assert!(refused(
        |o| o.slivers = Some(SliverOptions { max_move: f64::NAN, ..SliverOptions::default() })
    ));
    assert!(refused(|o| o.stitch = Some(Tolerance::Distance(-1.0))));
    assert!(refused(|o| o.components.area = 2.0));
    assert!(refused(|o| {
        o.intersections =
            Some(IntersectionOptions { max_removed: -0.1, ..IntersectionOptions::default() });
    }));
    assert!(slivers.needle_ratio >= 1.0);
    let mut lost = shapes::icosphere(1).unwrap();
    lost.set_position(VertexId::new(3), DVec3::splat(f64::NAN));
    let result = remove_slivers(&mut lost, &slivers, Progress::NONE);
    assert!(matches!(result, Err(Error::NotFinite { vertex }) if vertex == VertexId::new(3)));
}

#[test]
fn scaling_by_a_power_of_two_changes_nothing() {
    let mut sphere = shapes::icosphere(3).unwrap();
    sphere.set_position(VertexId::new(0), -1.5 * sphere.position(VertexId::new(0)));
    let set = with_needles(sphere, 5, 1e-6);
    let options = SurfaceRepairOptions::default();
    let (one, report) = repair_surface(&set.to_indexed(), &options, Progress::NONE).unwrap();
    for exponent in [-300, 40, 300] {
        let scale = 2.0_f64.powi(exponent);
        let scaled = moved(&set, scale, DVec3::ZERO).to_indexed();
        let (mesh, same) = repair_surface(&scaled, &options, Progress::NONE).unwrap();
        assert_eq!(report.steps(), same.steps(), "2^{exponent}");
        let back = moved(&mesh, 1.0 / scale, DVec3::ZERO);
        assert_eq!(back.positions(), one.positions(), "2^{exponent}");
    }
}
