//! Faces that pass through each other.

use dgp_mesh::{DVec3, FaceId, Progress, shapes};

use super::{faces, soup, tree};

fn pairs(set: &dgp_mesh::IndexedFaceSet) -> Vec<[usize; 2]> {
    let found = tree(set).self_intersections(Progress::NONE).unwrap();
    found.into_iter().map(|pair| pair.map(FaceId::index)).collect()
}

#[test]
fn neighbors_on_a_surface_do_not_count() {
    for mesh in [
        shapes::icosphere(3).unwrap(),
        shapes::cube(),
        shapes::grid(8, 5).unwrap(),
        shapes::quad_torus(2.0, 0.7, 24, 12).unwrap(),
    ] {
        assert_eq!(pairs(&mesh.to_indexed()), Vec::<[usize; 2]>::new());
    }
    // Nor where corners are at the same place without being the same.
    let sphere = shapes::icosphere(2).unwrap().to_indexed();
    let corners: Vec<DVec3> =
        sphere.faces().corners().iter().map(|&v| sphere.position(v)).collect();
    let list: Vec<[usize; 3]> =
        (0..corners.len() / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    assert!(pairs(&faces(corners, &list)).is_empty());
}

#[test]
fn each_way_to_meet_is_seen() {
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let (o, x, y) = (p(0.0, 0.0, 0.0), p(2.0, 0.0, 0.0), p(0.0, 2.0, 0.0));
    // The triangle o x y and another; whether they meet.
    for (what, other, meets) in [
        ("through", [p(0.5, 0.5, -1.0), p(0.5, 0.6, 1.0), p(0.6, 0.5, 1.0)], true),
        ("beside", [p(3.0, 3.0, -1.0), p(3.0, 3.1, 1.0), p(3.1, 3.0, 1.0)], false),
        ("touching with a corner", [p(0.5, 0.5, 0.0), p(0.5, 0.6, 1.0), p(0.6, 0.5, 1.0)], true),
        ("barely above", [p(0.5, 0.5, 1e-300), p(0.5, 0.6, 1.0), p(0.6, 0.5, 1.0)], false),
        ("in the plane, crossing", [p(-1.0, 0.5, 0.0), p(3.0, 0.5, 0.0), p(3.0, 0.6, 0.0)], true),
        ("in the plane, within", [p(0.2, 0.2, 0.0), p(0.4, 0.2, 0.0), p(0.2, 0.4, 0.0)], true),
        ("in the plane, apart", [p(2.0, 2.0, 0.0), p(3.0, 2.0, 0.0), p(2.0, 3.0, 0.0)], false),
        ("a side, unfolded", [o, x, p(0.5, -1.0, 0.0)], false),
        ("a side, folded over", [o, x, p(0.5, 1.0, 0.0)], true),
        ("a side, folded up", [o, x, p(0.5, 1.0, 1e-300)], false),
        ("a corner, away", [o, p(-1.0, 0.0, 0.0), p(0.0, -1.0, 0.0)], false),
        ("a corner, standing", [o, p(1.0, 1.0, 1.0), p(1.0, 2.0, 1.0)], false),
        ("a corner, through", [o, p(1.0, 0.4, 1.0), p(0.4, 1.0, -1.0)], true),
        ("a corner, through beyond", [x, p(-1.0, 0.5, 1.0), p(-1.0, 0.5, -1.0)], true),
        ("a corner, lying on it", [o, p(1.0, 0.4, 0.0), p(0.4, 1.0, 0.0)], true),
        ("a corner, in the plane away", [o, p(-1.0, 0.4, 0.0), p(-1.0, -1.0, 0.0)], false),
        ("a corner, along a side", [o, p(1.0, 0.0, 0.0), p(1.0, -1.0, 0.0)], true),
        ("a T", [p(1.0, 0.0, 0.0), p(1.0, -1.0, 0.0), p(2.0, -1.0, 0.0)], true),
        ("the same", [x, y, o], true),
    ] {
        let [a, b, c] = other;
        let corners = vec![o, x, y, a, b, c];
        let expected: Vec<[usize; 2]> = if meets { vec![[0, 1]] } else { Vec::new() };
        for turn in 0..3 {
            let second = [3 + turn, 3 + (turn + 1) % 3, 3 + (turn + 2) % 3];
            assert_eq!(pairs(&faces(corners.clone(), &[[0, 1, 2], second])), expected, "{what}");
            let back = [second[2], second[1], second[0]];
            assert_eq!(pairs(&faces(corners.clone(), &[back, [1, 2, 0]])), expected, "{what}");
        }
    }
}

#[test]
fn pairs_of_a_soup_are_those_of_trying_all() {
    let set = soup(250, 0.3, 3);
    let found = pairs(&set);
    let mut right = Vec::new();
    let face = |i: usize| [3 * i, 3 * i + 1, 3 * i + 2];
    for i in 0..250 {
        for j in i + 1..250 {
            let both = faces(set.positions().values().to_vec(), &[face(i), face(j)]);
            if !pairs(&both).is_empty() {
                right.push([i, j]);
            }
        }
    }
    assert!(right.len() > 50, "{}", right.len());
    assert_eq!(found, right);
}

#[test]
fn two_spheres_meet_along_a_circle() {
    let sphere = shapes::icosphere(3).unwrap().to_indexed();
    let n = sphere.vertex_count();
    let mut positions = sphere.positions().values().to_vec();
    positions.extend(sphere.positions().values().iter().map(|&p| p + DVec3::new(1.0, 0.1, 0.2)));
    let one: Vec<[usize; 3]> = sphere
        .faces()
        .iter()
        .map(|(_, face)| [face[0].index(), face[1].index(), face[2].index()])
        .collect();
    let other = one.iter().map(|face| face.map(|v| v + n));
    let list: Vec<[usize; 3]> = one.iter().copied().chain(other).collect();
    let found = pairs(&faces(positions.clone(), &list));
    assert!(!found.is_empty());
    for [f, g] in found {
        assert!(f < one.len() && g >= one.len(), "only faces of different spheres");
        let at = |f: usize| list[f].iter().map(|&v| positions[v]).sum::<DVec3>() / 3.0;
        assert!((at(f).length() - 1.0).abs() < 0.05 && (at(g).length() - 1.0).abs() < 0.3);
    }
}
