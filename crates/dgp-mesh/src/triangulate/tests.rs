//! Areas, orientation, counts and total behavior of all methods.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{TriangulationMethod::*, *};
use crate::{
    Error, FaceId, FaceList, IndexedFaceSet, Mesh, Progress, UV, VertexId, shapes, shapes::Random,
};

const METHODS: [TriangulationMethod; 4] = [Ears, MaxMinAngle, MinArea, Fan];

/// A polygon put into a tilted plane by an integer shear, so that its corners stay exact.
fn tilt(polygon: &[[f64; 2]]) -> Vec<DVec3> {
    polygon.iter().map(|&[x, y]| DVec3::new(x + 2.0 * y, y - x, 3.0 * x - y)).collect()
}

/// Twice the area of a triangle in the coordinates of [`tilt`]'s input, signed.
fn signed(polygon: &[[f64; 2]], [a, b, c]: [usize; 3]) -> f64 {
    let [p, q, r] = [a, b, c].map(|i| DVec2::from(polygon[i]));
    (q - p).perp_dot(r - p)
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    (2..polygon.len()).map(|k| signed(polygon, [0, k - 1, k])).sum()
}

/// The triangles cover the polygon, do not overlap and none is inverted.
fn assert_valid(name: &str, polygon: &[[f64; 2]], triangles: &[[usize; 3]]) {
    assert_eq!(triangles.len(), polygon.len() - 2, "{name}");
    let areas: Vec<f64> = triangles.iter().map(|&t| signed(polygon, t)).collect();
    let sum: f64 = areas.iter().sum();
    assert!((sum / area(polygon) - 1.0).abs() < 1e-9, "{name}: {sum} of {}", area(polygon));
    let inverted = areas.iter().filter(|&&a| a <= 0.0).count();
    assert_eq!(inverted, 0, "{name}: inverted or flat triangles");
    // Sides of the polygon come once and diagonals twice, in opposite directions.
    let mut sides: Vec<_> =
        triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.sort_unstable();
    for pair in sides.windows(2) {
        assert_ne!(pair[0], pair[1], "{name}");
    }
    let n = polygon.len();
    let is_matched =
        |&[a, b]: &[usize; 2]| (a + 1) % n == b || sides.binary_search(&[b, a]).is_ok();
    assert!(sides.iter().all(is_matched), "{name}");
}

fn rough_circle(n: usize, seed: u64) -> Vec<[f64; 2]> {
    let mut random = Random::new(seed);
    let corner = |i: usize| {
        let radius = 1.0 + random.uniform();
        let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
        [radius * cos, radius * sin]
    };
    (0..n).map(corner).collect()
}

/// Teeth hanging from a bar.
fn comb(teeth: usize) -> Vec<[f64; 2]> {
    let mut corners = vec![[2.0 * teeth as f64, 10.0], [0.0, 10.0]];
    for i in 0..teeth {
        let x = 2.0 * i as f64;
        corners.extend([[x, 0.0], [x + 1.0, 0.0], [x + 1.25, 9.0], [x + 1.75, 9.0]]);
    }
    corners
}

/// A corridor that winds inward.
fn spiral(n: usize) -> Vec<[f64; 2]> {
    let point = |i: usize, width: f64| {
        let t = 0.1 * i as f64;
        let radius = 1.0 + t / TAU + width;
        [radius * t.cos(), radius * t.sin()]
    };
    (0..n).map(|i| point(i, 0.4)).chain((0..n).rev().map(|i| point(i, 0.0))).collect()
}

fn simple_polygons() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    vec![
        ("triangle", vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
        ("arrow", vec![[0.0, 0.0], [2.0, 1.0], [4.0, 0.0], [2.0, 4.0]]),
        ("square with corners on its sides", {
            let ring =
                [[0., 0.], [1., 0.], [2., 0.], [2., 1.], [2., 2.], [1., 2.], [0., 2.], [0., 1.]];
            ring.to_vec()
        }),
        ("triangle with many corners on one side", {
            let mut corners: Vec<_> = (0..20).map(|i| [f64::from(i), 0.0]).collect();
            corners.push([7.0, 5.0]);
            corners
        }),
        ("square with a square hole, joined by a cut", {
            let ring = [[0., 0.], [4., 0.], [4., 4.], [0., 4.], [0., 0.]];
            let hole = [[1., 1.], [1., 2.], [2., 2.], [2., 1.], [1., 1.]];
            [&ring[..], &hole[..]].concat()
        }),
        ("comb", comb(20)),
        ("spiral", spiral(100)),
        ("rough circle", rough_circle(90, 1)),
        ("rougher circle", rough_circle(500, 2)),
    ]
}

#[test]
fn simple_polygons_keep_their_area_without_inverted_triangles() {
    for (name, polygon) in simple_polygons() {
        for method in [Ears, MaxMinAngle, MinArea] {
            if name.contains("cut") && method == MinArea {
                continue;
            }
            let triangles = triangulate_polygon(&tilt(&polygon), method);
            assert_valid(&format!("{name}, {method:?}"), &polygon, &triangles);
            let mut turned = polygon.clone();
            turned.reverse();
            let triangles = triangulate_polygon(&tilt(&turned), method);
            let mirrored: Vec<[f64; 2]> = turned.iter().map(|&[x, y]| [-x, y]).collect();
            assert_valid(&format!("{name} reversed, {method:?}"), &mirrored, &triangles);
        }
    }
}

#[test]
fn random_polygons_are_triangulated_from_any_first_corner() {
    for seed in 0..200 {
        let mut polygon = rough_circle(4 + seed as usize % 40, seed);
        polygon.rotate_left(seed as usize % 4);
        for method in [Ears, MaxMinAngle] {
            let triangles = triangulate_polygon(&tilt(&polygon), method);
            assert_valid(&format!("seed {seed}, {method:?}"), &polygon, &triangles);
        }
    }
}

#[test]
fn fans_serve_convex_polygons() {
    let polygon: Vec<[f64; 2]> =
        (0..9).map(|i| (TAU * f64::from(i) / 9.0).sin_cos()).map(|(y, x)| [x, y]).collect();
    let fan: Vec<[usize; 3]> = (1..8).map(|k| [0, k, k + 1]).collect();
    for method in [Ears, Fan] {
        assert_eq!(triangulate_polygon(&tilt(&polygon), method), fan);
    }
}

/// All triangulations of the part of a polygon between two corners.
fn all_triangulations(i: usize, k: usize) -> Vec<Vec<[usize; 3]>> {
    if k < i + 2 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for j in i + 1..k {
        for left in all_triangulations(i, j) {
            for right in all_triangulations(j, k) {
                all.push([left.as_slice(), &right, &[[i, j, k]]].concat());
            }
        }
    }
    all
}

#[test]
fn the_search_finds_what_enumeration_finds() {
    for seed in 0..60 {
        let polygon = rough_circle(4 + seed as usize % 5, seed);
        let corners = tilt(&polygon);
        let smallest_angle = |triangles: &[[usize; 3]]| {
            let angle = |[a, b, c]: [usize; 3]| {
                let [p, q, r] = [a, b, c].map(|i| corners[i]);
                let sizes = [
                    (q - p).angle_between(r - p),
                    (r - q).angle_between(p - q),
                    (p - r).angle_between(q - r),
                ];
                let smallest = sizes.into_iter().fold(f64::INFINITY, f64::min);
                if signed(&polygon, [a, b, c]) > 0.0 { smallest } else { -1.0 }
            };
            triangles.iter().map(|&t| angle(t)).fold(f64::INFINITY, f64::min)
        };
        let all = all_triangulations(0, polygon.len() - 1);
        assert_eq!(all.len(), [2, 5, 14, 42, 132][polygon.len() - 4]);
        let best = all.iter().map(|t| smallest_angle(t)).fold(f64::NEG_INFINITY, f64::max);
        let found = smallest_angle(&triangulate_polygon(&corners, MaxMinAngle));
        assert!((found - best).abs() < 1e-12, "seed {seed}: {found} instead of {best}");

        let bent: Vec<DVec3> = polygon.iter().map(|&[x, y]| DVec3::new(x, y, x * y)).collect();
        let total = |triangles: &[[usize; 3]]| {
            let area =
                |&[a, b, c]: &[usize; 3]| (bent[b] - bent[a]).cross(bent[c] - bent[a]).length();
            triangles.iter().map(area).sum::<f64>()
        };
        let least = all.iter().map(|t| total(t)).fold(f64::INFINITY, f64::min);
        let found = total(&triangulate_polygon(&bent, MinArea));
        assert!((found - least).abs() < 1e-12, "seed {seed}: {found} instead of {least}");
    }
}

#[test]
fn bad_polygons_still_give_triangles() {
    let mut random = Random::new(3);
    let mut tangle = |n: usize| -> Vec<DVec3> { (0..n).map(|_| random.direction()).collect() };
    let polygons = [
        vec![DVec3::ONE; 7],
        (0..9).map(|i| DVec3::X * f64::from(i % 5)).collect(),
        tangle(10),
        tangle(300),
        vec![DVec3::NAN; 6],
        vec![DVec3::ZERO, DVec3::X, DVec3::NAN, DVec3::Y, DVec3::INFINITY, DVec3::Z],
        [0.0, 1.0, 1.0, 0.0, 0.5].map(|x| DVec3::new(1e300 * x, 1e300 * x * x, x)).to_vec(),
        // A figure eight, whose vector area is zero.
        [[0., 0.], [2., 2.], [2., 0.], [0., 2.]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
    ];
    for (i, polygon) in polygons.iter().enumerate() {
        for method in METHODS {
            let triangles = triangulate_polygon(polygon, method);
            assert_eq!(triangles.len(), polygon.len() - 2, "polygon {i}, {method:?}");
            let has_repeats = |&[a, b, c]: &[usize; 3]| a == b || b == c || c == a;
            assert!(!triangles.iter().any(has_repeats), "polygon {i}, {method:?}");
        }
    }
    for n in 0..3 {
        assert!(triangulate_polygon(&vec![DVec3::ZERO; n], Ears).is_empty());
    }
}

#[test]
fn scaling_changes_nothing() {
    for (name, polygon) in simple_polygons() {
        let corners = tilt(&polygon);
        for method in METHODS {
            let expected = triangulate_polygon(&corners, method);
            for scale in [2.0_f64.powi(-400), 2.0_f64.powi(400)] {
                let scaled: Vec<DVec3> = corners.iter().map(|&p| scale * p).collect();
                assert_eq!(triangulate_polygon(&scaled, method), expected, "{name}, {method:?}");
            }
        }
    }
}

#[test]
fn polygons_of_a_hundred_thousand_corners_do_not_hang() {
    for (name, polygon) in [
        ("rough circle", rough_circle(100_000, 5)),
        ("comb", comb(25_000)),
        ("spiral", spiral(50_000)),
    ] {
        let triangles = triangulate_polygon(&tilt(&polygon), Ears);
        assert_valid(name, &polygon, &triangles);
    }
    let mut random = Random::new(4);
    let tangle: Vec<DVec3> = (0..10_000).map(|_| random.direction()).collect();
    assert_eq!(triangulate_polygon(&tangle, Ears).len(), 9_998);
}

#[test]
fn meshes_keep_their_area_topology_and_data() {
    let shapes = [
        shapes::cube(),
        shapes::dodecahedron(),
        shapes::quad_torus(2.0, 1.0, 12, 8).unwrap(),
        shapes::uv_sphere(8, 6).unwrap(),
        shapes::quad_grid(5, 4).unwrap(),
    ];
    for mesh in shapes {
        for method in METHODS {
            let mut set = mesh.to_indexed();
            let vertices = set.faces().corners().to_vec();
            let faces: Vec<u32> = (0..set.face_count() as u32).collect();
            let uv: Vec<DVec2> = vertices.iter().map(|&v| set.position(v).truncate()).collect();
            set.corner_attributes.insert(UV, uv);
            set.face_attributes.insert("number", faces);
            let mut triangles = Mesh::new(&set).unwrap();
            let sources = triangulate(&mut triangles, method, Progress::NONE).unwrap();
            assert!(triangles.faces().all(|f| triangles.triangle(f).is_some()));
            let euler = |m: &Mesh| m.vertex_count() + m.face_count() - m.edge_count();
            assert_eq!(euler(&triangles), euler(&mesh));
            // Built anew from its faces it is the same mesh but for the numbers of edges.
            let again = Mesh::new(&triangles.to_indexed()).unwrap();
            assert_eq!(again.edge_count(), triangles.edge_count());
            assert_eq!(again.to_indexed(), triangles.to_indexed());
            let numbers = triangles.attributes().face.get::<u32>("number").unwrap();
            assert!(triangles.faces().all(|f| numbers[f] as usize == sources[f].index()));
            let uv = triangles.attributes().corner.get::<DVec2>(UV).unwrap();
            for h in triangles.halfedges().filter(|&h| !triangles.is_boundary_halfedge(h)) {
                assert_eq!(uv[h], triangles.position(triangles.from(h)).truncate());
            }
            assert!(mesh.edges().all(|e| mesh.edge_vertices(e) == triangles.edge_vertices(e)));

            let (list, list_sources) = triangulate_faces(&set, method, Progress::NONE).unwrap();
            assert!(list.faces().is_triangles() && list.face_count() == triangles.face_count());
            assert!(list_sources.values().is_sorted());
        }
    }
}

/// Two quads back to back: the same diagonal on both sides would be a double edge.
#[test]
fn quads_back_to_back_get_different_diagonals() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    let faces = FaceList::from_indices(&[[0, 1, 2, 3], [3, 2, 1, 0]]);
    let set = IndexedFaceSet::new(corners, faces).unwrap();
    for method in METHODS {
        let mut mesh = Mesh::new(&set).unwrap();
        let sources = triangulate(&mut mesh, method, Progress::NONE).unwrap();
        assert_eq!(sources.values(), [0, 1, 0, 1].map(FaceId::new));
        let ends: Vec<_> = mesh.edges().skip(4).map(|e| mesh.edge_vertices(e)).collect();
        assert_ne!(ends[0], ends[1], "{method:?}");
        assert!(Mesh::new(&mesh.to_indexed()).is_ok());
    }
}

/// A quad on a surface with a handle, where edges outside the quad join both pairs of opposite corners.
#[test]
fn a_face_that_cannot_be_cut_is_named() {
    let faces = FaceList::from_indices::<&[usize]>(&[
        &[1, 0, 5],
        &[0, 1, 2, 3],
        &[1, 5, 3],
        &[0, 3, 6],
        &[0, 6, 2],
        &[6, 3, 5],
        &[3, 2, 7],
        &[7, 2, 6],
    ]);
    let corners: Vec<DVec3> =
        (0..8).map(|i| DVec3::new(f64::from(i), f64::from(i * i), f64::from(i * i * i))).collect();
    let mut mesh = Mesh::new(&IndexedFaceSet::new(corners, faces).unwrap()).unwrap();
    let before = mesh.clone();
    let result = triangulate(&mut mesh, Ears, Progress::NONE);
    assert_eq!(result, Err(Error::NoTriangulation { face: FaceId::new(1) }));
    assert_eq!(mesh, before);
}

#[test]
fn face_sets_lose_only_what_has_no_area() {
    let v = VertexId::new;
    let mut faces = FaceList::new();
    for face in [&[0, 1, 2, 3][..], &[0, 1], &[], &[2, 2, 1], &[0, 1, 1, 2]] {
        faces.push(&face.iter().map(|&i| v(i)).collect::<Vec<_>>());
    }
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    let set = IndexedFaceSet::new(corners, faces).unwrap();
    let (triangles, sources) = triangulate_faces(&set, Ears, Progress::NONE).unwrap();
    assert_eq!(sources.values(), [0, 0, 3, 4].map(FaceId::new));
    assert_eq!(triangles.faces().face(FaceId::new(2)), [v(2), v(2), v(1)]);
}

#[test]
fn cancelling_leaves_the_mesh_as_it_was() {
    let stop = |x: f64| {
        if x >= 0.7 {
            std::ops::ControlFlow::Break(())
        } else {
            std::ops::ControlFlow::Continue(())
        }
    };
    let mut mesh = shapes::cube();
    let result = triangulate(&mut mesh, Ears, Progress::new(&stop));
    assert!(matches!(result, Err(Error::Cancelled(_))));
    assert_eq!(mesh, shapes::cube());
}
