//! What each shape promises: topology, counts, orientation, place, and errors.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::*;
use crate::{HalfedgeSet, IndexedFaceSet, NotManifold, VertexId};

/// V − E + F, and the number of boundary loops.
fn topology(mesh: &Mesh) -> (i64, usize) {
    let euler = mesh.vertex_count() + mesh.face_count();
    let mut met = HalfedgeSet::new();
    let mut loops = 0;
    for h in mesh.halfedges().filter(|&h| mesh.is_boundary_halfedge(h)) {
        loops += usize::from(!met.contains(h));
        met.extend(mesh.loop_halfedges(h));
    }
    (euler as i64 - mesh.edge_count() as i64, loops)
}

/// The volume enclosed and the area, faces fanned.
fn volume_and_area(mesh: &Mesh) -> (f64, f64) {
    let (mut volume, mut area) = (0.0, 0.0);
    for f in mesh.faces() {
        let face: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
        for k in 2..face.len() {
            let [a, b, c] = [face[0], face[k - 1], face[k]];
            volume += a.dot(b.cross(c)) / 6.0;
            area += (b - a).cross(c - a).length() / 2.0;
        }
    }
    (volume, area)
}

fn radii(mesh: &Mesh) -> impl Iterator<Item = f64> {
    mesh.positions().values().iter().map(|p| p.length())
}

#[test]
fn platonic_solids_have_their_counts_and_equal_edges() {
    let solids = [
        (tetrahedron(), [4, 6, 4], 8.0 / 3.0_f64.sqrt().powi(3)),
        (cube(), [8, 12, 6], 8.0 / 3.0_f64.sqrt().powi(3)),
        (octahedron(), [6, 12, 8], 4.0 / 3.0),
        (dodecahedron(), [20, 30, 12], 2.785_163_863),
        (icosahedron(), [12, 30, 20], 2.536_150_710),
    ];
    for (mesh, counts, volume) in solids {
        assert_eq!([mesh.vertex_count(), mesh.edge_count(), mesh.face_count()], counts);
        assert_eq!(topology(&mesh), (2, 0));
        assert!(radii(&mesh).all(|r| (r - 1.0).abs() < 1e-15));
        // The tetrahedron fills a third of the cube whose corners it shares.
        let volume = if counts[0] == 4 { volume / 3.0 } else { volume };
        assert!((volume_and_area(&mesh).0 - volume).abs() < 1e-9, "{counts:?}");
        let length = |e| {
            let [v, w] = mesh.edge_vertices(e);
            mesh.position(v).distance(mesh.position(w))
        };
        let first = length(mesh.edges().next().unwrap());
        assert!(mesh.edges().all(|e| (length(e) - first).abs() < 1e-15), "{counts:?}");
    }
}

#[test]
fn icospheres_have_the_counts_of_splitting() {
    for level in 0..5 {
        let mesh = icosphere(level).unwrap();
        let power = 4_usize.pow(level as u32);
        assert_eq!([mesh.vertex_count(), mesh.face_count()], [10 * power + 2, 20 * power]);
        assert_eq!(topology(&mesh), (2, 0));
        assert!(radii(&mesh).all(|r| (r - 1.0).abs() < 1e-15));
        assert_eq!(mesh.vertices().filter(|&v| mesh.valence(v) == 5).count(), 12);
    }
}

/// The vertices of a level are those of the level before and the midpoints of its edges.
#[test]
fn icospheres_split_edges_at_their_midpoints() {
    let key = |p: DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    for level in 0..4 {
        let (coarse, fine) = (icosphere(level).unwrap(), icosphere(level + 1).unwrap());
        let mut expected: Vec<_> = coarse.positions().values().iter().map(|&p| key(p)).collect();
        expected.extend(coarse.edges().map(|e| {
            let [v, w] = coarse.edge_vertices(e);
            key((coarse.position(v) + coarse.position(w)).normalize())
        }));
        let mut found: Vec<_> = fine.positions().values().iter().map(|&p| key(p)).collect();
        expected.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, expected);
    }
}

#[test]
fn closed_shapes_are_closed_and_look_outward() {
    let size = DVec3::new(1.0, 2.0, 3.0);
    let shapes = [
        ("uv_sphere", uv_sphere(64, 64).unwrap(), 2, 4.0 / 3.0 * PI),
        ("quad_sphere", quad_sphere(32).unwrap(), 2, 4.0 / 3.0 * PI),
        ("cuboid", cuboid(size, [3, 4, 5]).unwrap(), 2, 6.0),
        ("quad_cuboid", quad_cuboid(size, [1, 1, 2]).unwrap(), 2, 6.0),
        ("capped_cylinder", capped_cylinder(1.0, 2.0, 128, 4).unwrap(), 2, TAU),
        ("capped_cone", capped_cone(1.0, 2.0, 128, 4).unwrap(), 2, TAU / 3.0),
        ("torus", torus(2.0, 1.0, 128, 64).unwrap(), 0, 4.0 * PI * PI),
        ("quad_torus", quad_torus(2.0, 1.0, 128, 64).unwrap(), 0, 4.0 * PI * PI),
    ];
    for (name, mesh, euler, volume) in shapes {
        assert_eq!(topology(&mesh), (euler, 0), "{name}");
        let found = volume_and_area(&mesh).0;
        assert!((found / volume - 1.0).abs() < 5e-3, "{name}: {found} instead of {volume}");
    }
    for mesh in [blob(3).unwrap(), dumbbell(0.2, 24, 48).unwrap()] {
        assert_eq!(topology(&mesh), (2, 0));
        assert!(volume_and_area(&mesh).0 > 1.0);
    }
}

#[test]
fn open_shapes_have_their_rims() {
    let shapes = [
        ("grid", grid(4, 3).unwrap(), 1, 1, 1.0),
        ("quad_grid", quad_grid(4, 3).unwrap(), 1, 1, 1.0),
        ("disk", disk(12).unwrap(), 1, 1, PI),
        ("annulus", annulus(1.0, 2.0, 96, 5).unwrap(), 0, 2, 3.0 * PI),
        ("cylinder", cylinder(1.0, 2.0, 96, 5).unwrap(), 0, 2, 2.0 * TAU),
        ("cone", cone(1.0, 3.0_f64.sqrt(), 96, 5).unwrap(), 1, 1, TAU),
    ];
    for (name, mesh, euler, loops, area) in shapes {
        assert_eq!(topology(&mesh), (euler, loops), "{name}");
        let found = volume_and_area(&mesh).1;
        assert!((found / area - 1.0).abs() < 5e-3, "{name}: {found} instead of {area}");
    }
    for mesh in [grid(2, 2).unwrap(), disk(3).unwrap(), annulus(1.0, 2.0, 9, 2).unwrap()] {
        let faces = mesh.to_faces();
        for (_, face) in faces.iter() {
            let [a, b, c] = [face[0], face[1], face[2]].map(|v| mesh.position(v));
            assert!((b - a).cross(c - a).z > 0.0, "flat shapes face +z");
        }
    }
}

#[test]
fn any_genus_can_be_had() {
    for genus in 0..6 {
        for level in 0..3 {
            let quads = quad_surface_of_genus(genus, level).unwrap();
            let euler = 2 - 2 * genus as i64;
            assert_eq!(topology(&quads), (euler, 0), "genus {genus}");
            assert!(volume_and_area(&quads).0 > 0.5);
            let triangles = surface_of_genus(genus, level).unwrap();
            assert_eq!(triangles.face_count(), 2 * quads.face_count());
            assert_eq!(topology(&triangles), (euler, 0));
        }
    }
    assert!(surface_of_genus(usize::MAX, 1).is_err() && surface_of_genus(1, usize::MAX).is_err());
}

/// The tube has the volume of its cross-sections, so it does not cut or twist itself badly.
#[test]
fn the_knot_is_a_torus_with_round_sections() {
    let mesh = trefoil(780, 65).unwrap();
    assert_eq!((mesh.face_count(), topology(&mesh)), (101_400, (0, 0)));
    let edge = |e| {
        let [v, w] = mesh.edge_vertices(e);
        mesh.position(v).distance(mesh.position(w))
    };
    let (shortest, longest) =
        mesh.edges().map(edge).fold((f64::INFINITY, 0.0_f64), |(s, l), x| (s.min(x), l.max(x)));
    assert!(longest < 5.0 * shortest, "edges from {shortest} to {longest}");
    // Pappus: each piece of the curve sweeps its length times the area of its section.
    let center = |i: usize| {
        (0..65).map(|j| mesh.position(VertexId::new(i % 780 * 65 + j))).sum::<DVec3>() / 65.0
    };
    let piece = |i: usize| {
        let radius = mesh.position(VertexId::new(i * 65)).distance(center(i));
        PI * radius * radius * center(i + 779).distance(center(i + 1)) / 2.0
    };
    let expected: f64 = (0..780).map(piece).sum();
    let volume = volume_and_area(&mesh).0;
    assert!((volume / expected - 1.0).abs() < 0.01, "{volume} instead of {expected}");
}

#[test]
fn a_mobius_strip_is_refused_as_misoriented() {
    let strip = mobius_strip(24, 4).unwrap();
    let refusal = Mesh::new(&strip);
    assert!(matches!(refusal, Err(Error::NotManifold(NotManifold::Misoriented { .. }))));
    // Cut across once, it can be laid flat.
    let is_kept =
        |t: &&[VertexId; 3]| t.iter().max().unwrap().index() < t.iter().min().unwrap().index() + 10;
    let triangles = strip.faces().corners().as_chunks::<3>().0.iter().filter(is_kept);
    let cut = triangles.copied().collect();
    let open =
        IndexedFaceSet::new(strip.positions().clone(), FaceList::from_triangles(cut)).unwrap();
    assert_eq!(topology(&Mesh::new(&open).unwrap()), (1, 1));
}

#[test]
fn impossible_sizes_are_refused() {
    let nan = f64::NAN;
    let huge = usize::MAX;
    let results = [
        icosphere(11),
        icosphere(huge),
        uv_sphere(2, 5),
        uv_sphere(3, 1),
        uv_sphere(huge, huge),
        quad_sphere(0),
        cuboid(DVec3::ONE, [huge, 1, 1]),
        cuboid(DVec3::new(1.0, 0.0, 1.0), [1; 3]),
        cuboid(DVec3::splat(1e200), [1; 3]),
        torus(1.0, 1.0, 5, 5),
        torus(nan, 1.0, 5, 5),
        torus(2.0, 1.0, 2, 5),
        grid(0, 4),
        grid(huge, 2),
        disk(0),
        disk(huge),
        annulus(2.0, 1.0, 8, 1),
        cylinder(1.0, f64::INFINITY, 8, 1),
        cylinder(1.0, 1.0, 8, huge),
        cone(0.0, 1.0, 8, 1),
        dumbbell(0.0, 8, 8),
        dumbbell(nan, 8, 8),
        trefoil(huge, 3),
        gyroid(huge, 2),
        gyroid(0, 9),
        gyroid(1, 1),
        blob(99),
        surface_of_revolution(&[], 8),
        surface_of_revolution(&[DVec2::ZERO, DVec2::Y], 8),
        surface_of_revolution(&[DVec2::X, DVec2::Y, DVec2::ONE], 8),
    ];
    for (i, result) in results.into_iter().enumerate() {
        assert!(matches!(result, Err(Error::InvalidOption { .. })), "case {i}: {result:?}");
    }
    assert!(mobius_strip(2, 1).is_err() && mobius_strip(huge, huge).is_err());
}

#[test]
fn noise_has_the_size_asked_for_and_scales_exactly() {
    let sphere = icosphere(4).unwrap();
    let noisy = with_noise(sphere.clone(), 0.1, 5).unwrap();
    let offset = |v| noisy.position(v) - sphere.position(v);
    let mean_square = sphere.vertices().map(|v| offset(v).length_squared()).sum::<f64>()
        / (3.0 * sphere.vertex_count() as f64);
    let edge = sphere.edges().map(|e| {
        let [v, w] = sphere.edge_vertices(e);
        sphere.position(v).distance(sphere.position(w))
    });
    let edge = edge.sum::<f64>() / sphere.edge_count() as f64;
    assert!((mean_square.sqrt() / (0.1 * edge) - 1.0).abs() < 0.05);

    let mut large = sphere.clone();
    large.set_positions(sphere.positions().map(|&p| 1024.0 * p));
    let large = with_noise(large, 0.1, 5).unwrap();
    assert!(sphere.vertices().all(|v| large.position(v) == 1024.0 * noisy.position(v)));
    assert_eq!(with_noise(sphere.clone(), 0.1, 5).unwrap(), noisy);
    assert_ne!(with_noise(sphere.clone(), 0.1, 6).unwrap(), noisy);
    assert!(with_noise(sphere.clone(), f64::NAN, 0).is_err());
    assert!(with_noise(cube(), f64::MAX, 0).is_err());
}

#[test]
fn holes_leave_a_manifold_and_keep_attributes() {
    let mut mesh = icosphere(4).unwrap();
    let height = mesh.positions().map(|p| p.z);
    mesh.attributes_mut().vertex.insert("height", height);
    for seed in 0..20 {
        let holed = with_holes(&mesh, 12, 3, seed).unwrap();
        let (_, loops) = topology(&holed);
        assert!((1..=12).contains(&loops), "seed {seed}: {loops} holes");
        assert!(holed.face_count() < mesh.face_count());
        let heights = holed.attributes().vertex.get::<f64>("height").unwrap();
        assert!(holed.vertices().all(|v| heights[v] == holed.position(v).z));
        assert!(holed.vertices().all(|v| !holed.is_isolated_vertex(v)));
    }
    assert_eq!(with_holes(&mesh, 0, 3, 0).unwrap(), mesh);
    assert_eq!(with_holes(&mesh, usize::MAX, usize::MAX, 0).unwrap().face_count(), 0);
    assert_eq!(with_holes(&Mesh::default(), 3, 3, 0).unwrap(), Mesh::default());
}

#[test]
fn shuffling_renumbers_and_changes_nothing_else() {
    let mesh = torus(2.0, 1.0, 12, 8).unwrap();
    let mut set = mesh.to_indexed();
    set.vertex_attributes.insert("x", set.positions().map(|p| p.x));
    let other = shuffled(&set, 9);
    assert_ne!(other.faces(), set.faces());
    assert!(
        other
            .positions()
            .iter()
            .all(|(v, p)| { other.vertex_attributes.get::<f64>("x").unwrap()[v] == p.x })
    );
    let other = Mesh::new(&other).unwrap();
    assert_eq!(topology(&other), (0, 0));
    assert!((volume_and_area(&other).0 - volume_and_area(&mesh).0).abs() < 1e-12);
}

#[test]
fn flipped_and_unwelded_patches_are_what_they_say() {
    let set = icosphere(3).unwrap().to_indexed();
    let flipped = flip_patch(&set, 0.1, 4);
    assert!(matches!(
        Mesh::new(&flipped),
        Err(Error::NotManifold(NotManifold::Misoriented { .. }))
    ));
    assert_eq!(flip_patch(&set, 2.0, 4).face_count(), set.face_count());
    let loose = Mesh::new(&unweld_patch(&set, 0.1, 4)).unwrap();
    assert_eq!(topology(&loose), (2, 2));
    assert!(loose.vertex_count() > set.vertex_count());
}

#[test]
fn a_scan_has_every_kind_of_damage() {
    let mesh = blob(4).unwrap();
    let scan = like_a_scan(&mesh, 1).unwrap();
    assert_eq!(scan, like_a_scan(&mesh, 1).unwrap());
    assert!(Mesh::new(&scan).is_err());
    let degenerate = scan.faces().iter().filter(|(_, face)| face[1] == face[2]).count();
    assert_eq!(degenerate, 5);
    let mut used = vec![false; scan.vertex_count()];
    for v in scan.faces().corners() {
        used[v.index()] = true;
    }
    assert_eq!(used.iter().filter(|&&used| !used).count(), 5);
    let confidence = scan.vertex_attributes.get::<f64>(CONFIDENCE).unwrap();
    assert!(confidence.values().iter().all(|c| (0.0..=1.0).contains(c)));
    assert!(scan.vertex_attributes.contains(crate::COLOR));
    assert!(scan.positions().values().iter().all(|p| p.is_finite()));
    assert_eq!(like_a_scan(&Mesh::default(), 1).unwrap().vertex_count(), 0);
}
