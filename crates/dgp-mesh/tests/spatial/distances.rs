//! Hausdorff, mean and Chamfer distances.

use dgp_mesh::{
    DVec3, Error, IndexedFaceSet, Progress,
    shapes::{self, Random},
    spatial::{
        DeviationOptions, HausdorffOptions, PointTree, chamfer, deviation, hausdorff,
        one_sided_hausdorff,
    },
};

use super::{faces, random_point, tree};

fn bounds(a: &IndexedFaceSet, b: &IndexedFaceSet) -> (f64, f64) {
    let options = HausdorffOptions { tolerance: 1e-6, ..HausdorffOptions::default() };
    let found = one_sided_hausdorff(&tree(a), &tree(b), &options, Progress::NONE).unwrap();
    assert!(found.is_within_tolerance && found.lower <= found.upper, "{found:?}");
    let distance = tree(b).closest_point(found.point).unwrap();
    assert!((distance.distance - found.lower).abs() < 1e-13, "{found:?}, but {distance:?}");
    assert_eq!(distance.point, found.nearest);
    (found.lower, found.upper)
}

fn moved(set: &IndexedFaceSet, change: impl Fn(DVec3) -> DVec3) -> IndexedFaceSet {
    let mut set = set.clone();
    set.positions_mut().iter_mut().for_each(|p| *p = change(*p));
    set
}

#[test]
fn distances_that_can_be_worked_out_lie_between_the_bounds() {
    let cube = shapes::cube().to_indexed();
    let side = tree(&cube).bounding_box().unwrap().size().x;
    let far = moved(&cube, |p| p + DVec3::new(0.0, 0.0, 0.25 * side));
    let (lower, upper) = bounds(&cube, &far);
    assert!(
        lower <= 0.25 * side && 0.25 * side <= upper && upper - lower < 1e-5,
        "{lower} {upper}"
    );
    let (lower, upper) = bounds(&cube, &cube);
    assert!(lower == 0.0 && upper < 1e-13, "{lower} {upper}");

    // A square above the ridge of a roof: the farthest point is in the middle of no vertex.
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let square = faces(
        vec![p(-1.0, -1.0, 1.0), p(1.0, -1.0, 1.0), p(1.0, 1.0, 1.0), p(-1.0, 1.0, 1.0)],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let valley = faces(
        vec![
            p(-1.0, -1.0, 1.0),
            p(0.0, -1.0, 0.0),
            p(1.0, -1.0, 1.0),
            p(-1.0, 1.0, 1.0),
            p(0.0, 1.0, 0.0),
            p(1.0, 1.0, 1.0),
        ],
        &[[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]],
    );
    // Over the bottom of the valley the walls are at 1/√2.
    let right = 0.5_f64.sqrt();
    let (lower, upper) = bounds(&square, &valley);
    assert!(lower <= right && right <= upper && upper - lower < 1e-5, "{lower} {upper}");
    // The bottom itself is 1 below.
    let (lower, upper) = bounds(&valley, &square);
    assert!(lower <= 1.0 && 1.0 <= upper && upper - lower < 1e-5, "{lower} {upper}");
}

#[test]
fn bounds_hold_for_samples_of_everything() {
    let mut random = Random::new(8);
    let coarse = shapes::icosphere(2).unwrap().to_indexed();
    let blob = shapes::blob(3).unwrap().to_indexed();
    let soup = super::soup(60, 0.6, 4);
    for (a, b) in [(&coarse, &blob), (&blob, &coarse), (&soup, &coarse), (&coarse, &soup)] {
        let options = HausdorffOptions { tolerance: 1e-3, ..HausdorffOptions::default() };
        let (from, to) = (tree(a), tree(b));
        let both = hausdorff(&from, &to, &options, Progress::NONE).unwrap();
        let found = both.forward;
        assert!(found.is_within_tolerance);
        let mut most = 0.0_f64;
        for (triangle, _) in super::triangles(a) {
            for _ in 0..20 {
                let (x, y) = (random.uniform(), random.uniform());
                let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
                let [p, q, r] = triangle;
                most = most.max(to.closest_point(p + x * (q - p) + y * (r - p)).unwrap().distance);
            }
        }
        assert!(most <= found.upper, "{most} {found:?}");
        assert!(both.lower() >= found.lower && both.upper() >= found.upper);
        let measured =
            deviation(&from, &to, &DeviationOptions { samples: 5000 }, Progress::NONE).unwrap();
        assert!(measured.mean <= measured.rms && measured.rms <= measured.largest);
        assert!(measured.largest <= found.upper, "{measured:?} {found:?}");
    }
}

#[test]
fn a_budget_ends_the_search_with_bounds_that_hold() {
    let sphere = shapes::icosphere(2).unwrap().to_indexed();
    let blob = shapes::blob(3).unwrap().to_indexed();
    // Large triangles over small ones, so that no triangle is settled by its corners.
    let options = HausdorffOptions { tolerance: 1e-9, queries: 1 };
    let found =
        one_sided_hausdorff(&tree(&sphere), &tree(&blob), &options, Progress::NONE).unwrap();
    assert!(!found.is_within_tolerance && found.lower > 0.0, "{found:?}");
    assert!(found.upper > found.lower && found.upper < found.lower + 0.5, "{found:?}");
}

#[test]
fn a_larger_copy_is_settled_by_a_point_for_each_triangle() {
    let sphere = shapes::icosphere(4).unwrap().to_indexed();
    let larger = moved(&sphere, |p| 1.01 * p);
    let options = HausdorffOptions { tolerance: 1e-9, ..HausdorffOptions::default() };
    let found =
        one_sided_hausdorff(&tree(&larger), &tree(&sphere), &options, Progress::NONE).unwrap();
    assert!(found.is_within_tolerance && found.queries < 3 * 5120, "{found:?}");
    assert!(found.lower <= 0.01 && 0.01 <= found.upper, "{found:?}");
}

#[test]
fn the_mean_distance_of_a_slope_is_that_of_its_integral() {
    // The distance of (x, y, x) from the plane z = 0 is x for x from 0 to 1: mean 1/2, rms 1/√3.
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let slope = faces(
        vec![p(0.0, 0.0, 0.0), p(1.0, 0.0, 1.0), p(1.0, 1.0, 1.0), p(0.0, 1.0, 0.0)],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let plane = faces(
        vec![p(-9.0, -9.0, 0.0), p(9.0, -9.0, 0.0), p(9.0, 9.0, 0.0), p(-9.0, 9.0, 0.0)],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let mut last = f64::INFINITY;
    for samples in [200, 3200, 51_200] {
        let options = DeviationOptions { samples };
        let found = deviation(&tree(&slope), &tree(&plane), &options, Progress::NONE).unwrap();
        assert_eq!(found.samples, samples);
        assert!((found.mean - 0.5).abs() < 1e-12, "{found:?}");
        let off = (found.rms - (1.0_f64 / 3.0).sqrt()).abs();
        assert!(off < last / 12.0, "of second order: {off} after {last}");
        last = off;
    }
}

#[test]
fn what_has_no_points_has_no_distance() {
    let (cube, empty) = (tree(&shapes::cube()), tree(&IndexedFaceSet::default()));
    let options = HausdorffOptions::default();
    assert_eq!(hausdorff(&cube, &empty, &options, Progress::NONE).unwrap_err(), Error::Empty);
    assert_eq!(hausdorff(&empty, &cube, &options, Progress::NONE).unwrap_err(), Error::Empty);
    let nothing = DeviationOptions::default();
    assert_eq!(deviation(&empty, &cube, &nothing, Progress::NONE).unwrap_err(), Error::Empty);
    let bad = HausdorffOptions { tolerance: f64::NAN, ..options };
    assert!(hausdorff(&cube, &cube, &bad, Progress::NONE).is_err());
    assert_eq!(chamfer(&[], &[DVec3::ONE], Progress::NONE), Err(Error::Empty));
    let error = chamfer(&[DVec3::ONE], &[DVec3::ONE, DVec3::NAN], Progress::NONE);
    assert_eq!(error, Err(Error::NonFinitePoint { index: 1 }));
}

#[test]
fn nearest_points_are_those_of_looking_at_all() {
    let mut random = Random::new(12);
    let mut points: Vec<DVec3> = (0..700).map(|_| random_point(&mut random)).collect();
    // Equal points, and a grid in a plane.
    points.extend([DVec3::splat(0.5); 50]);
    points.extend((0..100).map(|i| DVec3::new(f64::from(i % 10), f64::from(i / 10), 0.0)));
    let tree = PointTree::new(&points, Progress::NONE).unwrap();
    let mut queries: Vec<DVec3> = (0..200).map(|_| 2.0 * random_point(&mut random)).collect();
    queries.extend([DVec3::splat(0.5), DVec3::splat(1e9), DVec3::new(2.5, 2.5, 0.0)]);
    let all = tree.nearest_each(&queries, Progress::NONE).unwrap();
    for (&q, together) in queries.iter().zip(&all) {
        let mut right: Vec<(f64, usize)> =
            points.iter().enumerate().map(|(i, p)| ((*p - q).length_squared(), i)).collect();
        right.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let near = tree.nearest_points(q, 7);
        let indices: Vec<usize> = near.iter().map(|n| n.index).collect();
        assert_eq!(indices, right[..7].iter().map(|r| r.1).collect::<Vec<_>>(), "{q}");
        assert_eq!(tree.nearest(q).unwrap().index, right[0].1, "{q}");
        assert_eq!(together.index, right[0].1, "{q}");
    }
    assert!(tree.nearest(DVec3::splat(1e308)).is_some());

    let others: Vec<DVec3> = points.iter().map(|&p| p + DVec3::new(0.0, 0.0, 1e-4)).collect();
    let found = chamfer(&points, &others, Progress::NONE).unwrap();
    assert!((found.distance() - 2e-4).abs() < 1e-9 && found.largest < 1.1e-4, "{found:?}");
    assert!((found.forward_square - 1e-8).abs() < 1e-12, "{found:?}");
}
