//! Closed forms on small solids.

use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::{DVec3, FaceList, IndexedFaceSet, Mesh};

/// A box with one corner at `low` and sides of 1, 2 and 3, as six quads.
fn brick(low: DVec3, scale: f64) -> Mesh {
    let corner =
        |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64 * 2.0, (i >> 2) as f64 * 3.0);
    let positions: Vec<DVec3> = (0..8).map(|i| (low + corner(i)) * scale).collect();
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh::new(&IndexedFaceSet::new(positions, FaceList::from_indices(&faces)).unwrap()).unwrap()
}

#[test]
fn a_brick_measures_what_it_should() {
    let mesh = brick(DVec3::ZERO, 1.0);
    assert_eq!((area(&mesh), volume(&mesh)), (22.0, 6.0));
    assert_eq!(bounding_box(&mesh).unwrap().size(), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(edge_length_range(&mesh), Some(Range { min: 1.0, mean: 2.0, max: 3.0 }));
    assert_eq!(minimum_angle(&mesh), Some(FRAC_PI_2));
    for e in mesh.edges() {
        assert!((mesh.dihedral_angle(e).unwrap() - FRAC_PI_2).abs() < 1e-15, "{e}");
    }
    for weight in [NormalWeight::Area, NormalWeight::Angle, NormalWeight::Max] {
        let normals = vertex_normals(&mesh, weight);
        for v in mesh.vertices() {
            assert!((normals[v].length() - 1.0).abs() < 1e-15);
            assert!((normals[v] - vertex_normal(&mesh, v, weight)).length() < 1e-15);
            assert!(normals[v].dot(mesh.position(v) - DVec3::new(0.5, 1.0, 1.5)) > 0.0);
        }
    }
    let sum: f64 = corner_angles(&mesh).values().iter().sum();
    assert!((sum - 12.0 * PI).abs() < 1e-13);
}

#[test]
fn far_from_the_origin_no_digits_are_lost() {
    let mesh = brick(DVec3::splat(1e9), 1.0);
    assert_eq!((area(&mesh), volume(&mesh)), (22.0, 6.0));
}

#[test]
fn huge_and_tiny_solids_are_measured_too() {
    for k in [-1000, -660, -300, 300, 330, 660, 1000] {
        let scale = 2_f64.powi(k);
        let (mesh, unit) = (brick(DVec3::ZERO, scale), brick(DVec3::ZERO, 1.0));
        let power = |n: i32| (0..n).fold(1.0, |x, _| x * scale);
        assert_eq!(area(&mesh), 22.0 * power(2), "2^{k}");
        assert_eq!(volume(&mesh), 6.0 * power(3), "2^{k}");
        assert_eq!(face_normals(&mesh), face_normals(&unit), "2^{k}");
        assert_eq!(minimum_angle(&mesh), minimum_angle(&unit), "2^{k}");
        for weight in [NormalWeight::Area, NormalWeight::Angle, NormalWeight::Max] {
            assert_eq!(vertex_normals(&mesh, weight), vertex_normals(&unit, weight), "2^{k}");
        }
    }
    let huge = brick(DVec3::splat(-1.0), 0.4 * f64::MAX);
    assert_eq!(face_normals(&huge), face_normals(&brick(DVec3::ZERO, 1.0)));
}

/// Schwarz's lantern of radius and height 1, with m corners around and m³ bands of triangles.
fn lantern(m: usize) -> Mesh {
    let bands = m * m * m;
    let ring = |k: usize| {
        (0..m).map(move |i| {
            let angle = 2.0 * PI * (i as f64 + 0.5 * (k % 2) as f64) / m as f64;
            DVec3::new(angle.cos(), angle.sin(), k as f64 / bands as f64)
        })
    };
    let positions: Vec<DVec3> = (0..=bands).flat_map(ring).collect();
    let faces: Vec<[usize; 3]> = (0..bands)
        .flat_map(|k| {
            (0..m).flat_map(move |i| {
                let (low, high) = (m * k, m * (k + 1));
                let (j, next) = ((i + k % 2) % m, (i + 1) % m);
                // A side on this ring with a corner above its middle, and the other way round.
                let before = (j + m - 1) % m;
                let up = [low + i, low + next, high + j];
                let down = [low + i, high + j, high + before];
                [up, down]
            })
        })
        .collect();
    Mesh::new(&IndexedFaceSet::new(positions, FaceList::from_indices(&faces)).unwrap()).unwrap()
}

/// Row 24 of the oracles: inscribed meshes come as near to a cylinder as one likes, while their area grows
/// without bound and their normals turn away. What converges needs triangles that do not degenerate.
#[test]
fn the_lantern_of_schwarz_has_no_area_in_the_limit() {
    let mut areas = Vec::new();
    for m in [3, 6, 12] {
        let mesh = lantern(m);
        let bands = (m * m * m) as f64;
        let angle = PI / m as f64;
        // From the middles of the sides, which are farthest from the cylinder, to it.
        let depth = 1.0 - angle.cos();
        let exact = 2.0 * bands * m as f64 * angle.sin() * (bands.powi(-2) + depth * depth).sqrt();
        assert!((area(&mesh) / exact - 1.0).abs() < 1e-12, "{} {exact}", area(&mesh));
        for e in mesh.edges() {
            let middle = mesh.edge_midpoint(e);
            assert!(middle.truncate().length() > angle.cos() - 1e-12);
        }
        let slope = 1.0 / (1.0 + (bands * depth).powi(2)).sqrt();
        for f in mesh.faces() {
            let out = mesh.face_center(f).truncate().extend(0.0).normalize();
            assert!((mesh.face_normal(f).dot(out) - slope).abs() < 1e-9, "{f}");
        }
        areas.push(exact);
    }
    // 2π is the cylinder's.
    assert!(areas[1] > 1.8 * areas[0] && areas[2] > 1.9 * areas[1], "{areas:?}");
}
