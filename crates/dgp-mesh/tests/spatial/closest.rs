//! Nearest points.

use std::ops::ControlFlow;

use dgp_mesh::{
    DVec3, Error, IndexedFaceSet, Progress, VertexId,
    measure::BoundingBox,
    shapes::{self, Random},
    spatial::TriangleTree,
};

use super::{faces, probes, random_point, surfaces, tree, triangles};

/// The squared distance from `p` to a triangle by projection on its plane and its sides.
fn square_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_segment = |a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        let t = if t.is_nan() { 0.0 } else { t };
        (p - a - t * (b - a)).length_squared()
    };
    let sides = to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a));
    let normal = (b - a).cross(c - a);
    let inside = [[a, b], [b, c], [c, a]];
    let is_above = |[u, v]: [DVec3; 2]| (v - u).cross(p - u).dot(normal) >= 0.0;
    if normal.length_squared() > 0.0 && inside.into_iter().all(is_above) {
        return sides.min((p - a).dot(normal).powi(2) / normal.length_squared());
    }
    sides
}

fn brute_force(set: &IndexedFaceSet, p: DVec3) -> f64 {
    let squares = triangles(set).into_iter().map(|(t, _)| square_to_triangle(p, t));
    squares.fold(f64::INFINITY, f64::min).sqrt()
}

#[test]
fn the_nearest_point_is_as_near_as_looking_at_all_triangles_says() {
    for (name, set) in surfaces() {
        let tree = tree(&set);
        for p in probes(&set, 60) {
            let hit = tree.closest_point(p).unwrap();
            let right = brute_force(&set, p);
            let tolerance = 1e-13 * (p.length() + 10.0) + 1e-12 * right;
            assert!((hit.distance - right).abs() < tolerance, "{name} {p}: {hit:?}, not {right}");
            let [x, y, z] = hit.barycentric;
            assert!(
                x.min(y).min(z) >= -1e-15 && (x + y + z - 1.0).abs() < 1e-15,
                "{name}: {hit:?}"
            );
            let corners = hit.vertices.map(|v| set.position(v));
            let point = x * corners[0] + y * corners[1] + z * corners[2];
            assert!(
                (point - hit.point).length() < 1e-13 * (1.0 + point.length()),
                "{name}: {hit:?}"
            );
            assert!(hit.vertices.iter().all(|v| set.faces().face(hit.face).contains(v)), "{name}");
        }
    }
}

#[test]
fn vertices_are_at_distance_zero_exactly() {
    for (name, set) in surfaces() {
        let tree = tree(&set);
        let used = set.faces().corners().iter().copied();
        for v in used.take(200) {
            let hit = tree.closest_point(set.position(v)).unwrap();
            assert_eq!((hit.distance, hit.point), (0.0, set.position(v)), "{name} {v}");
        }
    }
}

#[test]
fn many_at_once_give_the_bits_of_one_by_one() {
    let set = shapes::blob(5).unwrap();
    let tree = TriangleTree::new(&set, Progress::NONE).unwrap();
    let mut random = Random::new(4);
    let points: Vec<DVec3> = (0..5000).map(|_| 1.5 * random_point(&mut random)).collect();
    let together = tree.closest_points(&points, Progress::NONE).unwrap();
    let alone: Vec<_> = points.iter().map(|&p| tree.closest_point(p).unwrap()).collect();
    assert!(together == alone);
}

#[test]
fn powers_of_two_scale_the_result_exactly() {
    let (_, set) = surfaces().swap_remove(8);
    let points = probes(&set, 30);
    let before = tree(&set).closest_points(&points, Progress::NONE).unwrap();
    for k in [-900, -300, -1, 7, 400, 900] {
        let factor = 2_f64.powi(k);
        let mut scaled = set.clone();
        scaled.positions_mut().iter_mut().for_each(|p| *p *= factor);
        let points: Vec<DVec3> = points.iter().map(|p| *p * factor).collect();
        let after = tree(&scaled).closest_points(&points, Progress::NONE).unwrap();
        for (a, b) in before.iter().zip(after) {
            assert_eq!((a.point * factor, a.distance * factor), (b.point, b.distance), "2^{k}");
            assert_eq!((a.face, a.barycentric), (b.face, b.barycentric), "2^{k}");
        }
    }
}

#[test]
fn far_from_the_origin_and_at_the_ends_of_the_range_answers_stay_right() {
    let sphere = shapes::icosphere(3).unwrap().to_indexed();
    let mut far = sphere.clone();
    far.positions_mut().iter_mut().for_each(|p| *p = 1e6 * DVec3::ONE + *p);
    let hit = tree(&far).closest_point(1e6 * DVec3::ONE + 3.0 * DVec3::Z).unwrap();
    assert!((hit.distance - 2.0).abs() < 1e-9, "{hit:?}");
    let hit = tree(&sphere).closest_point(DVec3::new(0.0, 0.0, 1e300)).unwrap();
    assert_eq!((hit.point, hit.distance), (DVec3::Z, 1e300));
    let hit = tree(&sphere).closest_point(DVec3::splat(-1e308)).unwrap();
    assert!(hit.point.distance(-DVec3::ONE.normalize()) < 0.1, "{hit:?}");
    let mut huge = sphere.clone();
    huge.positions_mut().iter_mut().for_each(|p| *p *= 1e308);
    let hit = tree(&huge).closest_point(DVec3::ZERO).unwrap();
    assert!((hit.distance / 1e308 - 1.0).abs() < 0.02, "{hit:?}");
    let mut tiny = sphere;
    tiny.positions_mut().iter_mut().for_each(|p| *p *= 1e-306);
    let hit = tree(&tiny).closest_point(DVec3::new(0.0, 0.0, 3e-306)).unwrap();
    assert!((hit.distance / 2e-306 - 1.0).abs() < 1e-6, "{hit:?}");
}

#[test]
fn what_cannot_be_asked_is_said() {
    let empty = tree(&IndexedFaceSet::default());
    assert!(empty.is_empty() && empty.closest_point(DVec3::ZERO).is_none());
    assert_eq!(empty.closest_points(&[DVec3::ZERO], Progress::NONE), Err(Error::Empty));
    let bad = faces(vec![DVec3::ZERO, DVec3::X, DVec3::NAN], &[[0, 1, 2]]);
    let error = TriangleTree::new(&bad, Progress::NONE).unwrap_err();
    assert_eq!(error, Error::NonFinite { vertex: VertexId::new(2) });
    let cube = TriangleTree::new(&shapes::cube(), Progress::NONE).unwrap();
    assert!(cube.closest_point(DVec3::NAN).is_none());
    let points = [DVec3::ZERO, DVec3::splat(f64::INFINITY)];
    let error = cube.closest_points(&points, Progress::NONE);
    assert_eq!(error, Err(Error::NonFinitePoint { index: 1 }));
    let stop = |_| ControlFlow::Break(());
    let error = cube.closest_points(&[DVec3::ZERO], Progress::new(&stop));
    assert!(matches!(error, Err(Error::Cancelled(_))));
    assert!(matches!(
        TriangleTree::new(&shapes::cube(), Progress::new(&stop)),
        Err(Error::Cancelled(_))
    ));
}

#[test]
fn equal_centers_and_coplanar_grids_are_fine() {
    // 2000 times the same triangle, and a grid in one plane.
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let same = faces(corners, &vec![[0, 1, 2]; 2000]);
    let hit = tree(&same).closest_point(DVec3::new(0.2, 0.2, 1.0)).unwrap();
    assert_eq!((hit.distance, hit.face.index()), (1.0, 0), "of equals the first");
    let grid = shapes::grid(60, 60).unwrap();
    let tree = TriangleTree::new(&grid, Progress::NONE).unwrap();
    let hit = tree.closest_point(DVec3::new(0.3, 0.4, -2.0)).unwrap();
    assert_eq!(hit.distance, 2.0);
}

#[test]
fn faces_near_a_point_are_those_of_looking_at_all() {
    for (name, set) in surfaces() {
        let (tree, all) = (tree(&set), triangles(&set));
        for p in probes(&set, 12) {
            let mut near: Vec<_> =
                all.iter().map(|&(t, f)| (square_to_triangle(p, t).sqrt(), f)).collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut seen = Vec::new();
            near.retain(|&(_, f)| {
                !seen.contains(&f) && {
                    seen.push(f);
                    true
                }
            });
            let found = tree.nearest_faces(p, 5);
            assert_eq!(found.len(), near.len().min(5), "{name} {p}");
            for (hit, right) in found.iter().zip(&near) {
                let tolerance = 1e-12 * (p.length() + 10.0);
                assert!((hit.distance - right.0).abs() < tolerance, "{name} {p}: {found:?}");
            }
            // A radius between two distances.
            let k = near.len() / 2;
            let radius = if k + 1 < near.len() { 0.5 * (near[k].0 + near[k + 1].0) } else { 1e300 };
            let gap = near.iter().map(|x| (x.0 - radius).abs()).fold(f64::INFINITY, f64::min);
            if gap > 1e-9 * (1.0 + p.length()) {
                let mut right: Vec<_> =
                    near.iter().filter(|x| x.0 <= radius).map(|x| x.1).collect();
                right.sort_unstable();
                assert_eq!(tree.faces_within(p, radius), right, "{name} {p} {radius}");
            }
        }
    }
}

#[test]
fn faces_in_a_box_have_points_in_it() {
    for (name, set) in surfaces() {
        let (tree, all) = (tree(&set), triangles(&set));
        let mut random = Random::new(9);
        for _ in 0..40 {
            let (a, b) = (1.5 * random_point(&mut random), 1.5 * random_point(&mut random));
            let query = BoundingBox { min: a.min(b), max: a.max(b) };
            let mut right: Vec<_> =
                all.iter().filter(|(t, _)| clipped(t, &query)).map(|x| x.1).collect();
            right.sort_unstable();
            right.dedup();
            assert_eq!(tree.faces_in_box(&query), right, "{name} {query:?}");
        }
    }
}

/// Whether something of a triangle is left when the six sides of a box have cut off what is outside.
fn clipped(triangle: &[DVec3; 3], query: &BoundingBox) -> bool {
    let mut polygon = triangle.to_vec();
    for axis in 0..3 {
        for (sign, bound) in [(1.0, query.max[axis]), (-1.0, -query.min[axis])] {
            let out = |p: DVec3| sign * p[axis] - bound;
            let mut rest = Vec::new();
            for (i, &p) in polygon.iter().enumerate() {
                let q = polygon[(i + 1) % polygon.len()];
                if out(p) <= 0.0 {
                    rest.push(p);
                }
                if out(p) * out(q) < 0.0 {
                    let mut cut = p + (q - p) * (out(p) / (out(p) - out(q)));
                    cut[axis] = sign * bound;
                    rest.push(cut);
                }
            }
            polygon = rest;
        }
    }
    !polygon.is_empty()
}
