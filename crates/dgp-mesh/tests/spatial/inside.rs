//! Winding numbers and signed distances.

use dgp_mesh::{
    DVec3, Error, FaceList, IndexedFaceSet, Progress,
    shapes::{self, Random},
    spatial::{
        AREA_NEIGHBORS, CloudWinding, SignedDistances, WindingNumbers, WindingOptions, cloud_areas,
    },
};

use super::{random_point, soup, tree};

#[test]
fn closed_surfaces_wind_once_or_not_at_all() {
    // ORACLES.md, row 28: 0 or 1 to 1e-12.
    for mesh in [
        shapes::cube(),
        shapes::icosphere(4).unwrap(),
        shapes::quad_torus(2.0, 0.7, 40, 20).unwrap(),
    ] {
        let tree = tree(&mesh);
        let fast = WindingNumbers::new(&tree, WindingOptions::default()).unwrap();
        let signed = SignedDistances::new(&tree);
        let mut random = Random::new(1);
        for _ in 0..200 {
            let p = 2.5 * random_point(&mut random);
            let exact = tree.winding_number(p);
            let right = if signed.at(p).unwrap().distance < 0.0 { 1.0 } else { 0.0 };
            assert!((exact - right).abs() < 1e-12, "{p}: {exact}");
            assert!((fast.at(p) - right).abs() < 0.01, "{p}: {}", fast.at(p));
        }
    }
}

#[test]
fn an_open_disk_is_seen_at_its_solid_angle() {
    // ORACLES.md, row 28: (1 − z/√(z² + r²))/2 on the axis of a disk; here of a square of side 2, whose
    // solid angle is 4 asin(1/(1 + z²)).
    let square = IndexedFaceSet::new(
        vec![
            DVec3::new(-1.0, -1.0, 0.0),
            DVec3::new(1.0, -1.0, 0.0),
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::new(-1.0, 1.0, 0.0),
        ],
        FaceList::from_indices(&[[0, 1, 2, 3]]),
    )
    .unwrap();
    let tree = tree(&square);
    for z in [0.01_f64, 0.5, 1.0, 7.0, 1e5] {
        let right = 4.0 * (1.0 / (1.0 + z * z)).asin() / (4.0 * std::f64::consts::PI);
        let above = tree.winding_number(DVec3::new(0.0, 0.0, z));
        let below = tree.winding_number(DVec3::new(0.0, 0.0, -z));
        assert!((above.abs() / right - 1.0).abs() < 1e-9, "{z}: {above}, not {right}");
        assert_eq!(above, -below);
    }
    assert_eq!(tree.winding_number(DVec3::new(0.3, 0.1, 0.0)), 0.0, "the mean of both sides");
}

#[test]
fn the_fast_form_comes_near_the_exact_one_as_its_accuracy_grows() {
    let noisy = shapes::with_noise(shapes::icosphere(4).unwrap(), 0.02, 1).unwrap();
    let open = shapes::with_holes(&noisy, 5, 2, 3).unwrap().to_indexed();
    for (name, set) in [("holed sphere", open), ("soup", soup(3000, 0.1, 7))] {
        let tree = tree(&set);
        let mut random = Random::new(2);
        let points: Vec<DVec3> = (0..400).map(|_| 1.5 * random_point(&mut random)).collect();
        let mut last = f64::INFINITY;
        for (accuracy, bound) in [(1.5, 0.03), (2.0, 0.01), (4.0, 1e-3), (8.0, 1e-4)] {
            let fast = WindingNumbers::new(&tree, WindingOptions { accuracy }).unwrap();
            let values = fast.at_points(&points, Progress::NONE).unwrap();
            let off = |(&p, w): (&DVec3, &f64)| (w - tree.winding_number(p)).abs();
            let worst = points.iter().zip(&values).map(off).fold(0.0, f64::max);
            println!("{name}: accuracy {accuracy}, error {worst:.1e}");
            assert!(worst < bound && worst < last, "{name}: {accuracy} gives {worst}");
            assert!(points.iter().zip(&values).all(|(&p, w)| fast.at(p) == *w));
            last = worst;
        }
    }
    let cube = tree(&shapes::cube());
    let error = WindingNumbers::new(&cube, WindingOptions { accuracy: 0.5 });
    assert!(matches!(error, Err(Error::InvalidOption { name: "accuracy", .. })));
}

#[test]
fn signs_are_right_where_edges_and_vertices_are_nearest() {
    let cube = shapes::cube();
    let tree = tree(&cube);
    let signed = SignedDistances::new(&tree);
    let bounds = tree.bounding_box().unwrap();
    let (center, half) = (bounds.center(), 0.5 * bounds.size());
    let mut random = Random::new(6);
    for _ in 0..500 {
        let p = center + 2.0 * half * random_point(&mut random);
        let q = (p - center).abs() - half;
        let right = q.max(DVec3::ZERO).length() + q.max_element().min(0.0);
        let found = signed.at(p).unwrap();
        assert!((found.distance - right).abs() < 1e-14, "{p}: {found:?}, not {right}");
    }
    // The sphere, analytically: h²/8 inside.
    let sphere = shapes::icosphere(5).unwrap();
    let tree = super::tree(&sphere);
    let signed = SignedDistances::new(&tree);
    let points: Vec<DVec3> = (0..500).map(|_| 1.5 * random_point(&mut random)).collect();
    for (p, found) in points.iter().zip(signed.at_points(&points, Progress::NONE).unwrap()) {
        assert!((found.distance - (p.length() - 1.0)).abs() < 6e-4, "{p}: {found:?}");
    }
}

#[test]
fn nothing_winds_around_nothing() {
    let empty = tree(&IndexedFaceSet::default());
    let fast = WindingNumbers::new(&empty, WindingOptions::default()).unwrap();
    assert_eq!((fast.at(DVec3::ZERO), empty.winding_number(DVec3::ZERO)), (0.0, 0.0));
    let error = fast.at_points(&[DVec3::NAN], Progress::NONE);
    assert_eq!(error, Err(Error::NonFinitePoint { index: 0 }));
    assert!(SignedDistances::new(&empty).at(DVec3::ZERO).is_none());
}

/// Points of a sphere and of a torus with the normals of their formulas, and the surface itself.
fn clouds() -> Vec<(Vec<DVec3>, Vec<DVec3>, dgp_mesh::Mesh)> {
    let mut random = Random::new(3);
    let sphere: Vec<DVec3> = (0..4000).map(|_| random.direction()).collect();
    let torus = shapes::torus(2.0, 0.7, 120, 60).unwrap();
    let normal = |p: &DVec3| {
        let ring = 2.0 * DVec3::new(p.x, p.y, 0.0).normalize();
        (*p - ring).normalize()
    };
    let points = torus.positions().values().to_vec();
    let normals = points.iter().map(normal).collect();
    vec![(sphere.clone(), sphere, shapes::icosphere(5).unwrap()), (points, normals, torus)]
}

#[test]
fn clouds_wind_as_the_surfaces_they_were_taken_from() {
    for (points, normals, surface) in clouds() {
        let areas = cloud_areas(&points, AREA_NEIGHBORS, Progress::NONE).unwrap();
        let total: f64 = areas.iter().sum();
        let right = dgp_mesh::measure::area(&surface);
        assert!((total / right - 1.0).abs() < 0.15, "{total} of {right}");
        let vectors: Vec<DVec3> = normals.iter().zip(&areas).map(|(n, a)| *a * *n).collect();
        let fast = CloudWinding::new(&points, &vectors, WindingOptions::default(), Progress::NONE)
            .unwrap();
        let options = WindingOptions { accuracy: 1e9 };
        let exact = CloudWinding::new(&points, &vectors, options, Progress::NONE).unwrap();
        let tree = tree(&surface);
        let signed = SignedDistances::new(&tree);
        let mut random = Random::new(7);
        let places: Vec<DVec3> = (0..500).map(|_| 2.9 * random_point(&mut random)).collect();
        let many = fast.at_points(&places, Progress::NONE).unwrap();
        let mut inside = 0;
        for (&p, &winding) in places.iter().zip(&many) {
            assert_eq!(winding.to_bits(), fast.at(p).to_bits());
            let distance = signed.at(p).unwrap().distance;
            // By summing over all points as the formula says.
            let sum: f64 = points
                .iter()
                .zip(&vectors)
                .map(|(&x, a)| {
                    let r = x - p;
                    a.dot(r) / r.length().powi(3)
                })
                .sum::<f64>()
                / (4.0 * std::f64::consts::PI);
            assert!((exact.at(p) - sum).abs() < 1e-9, "{p}");
            assert!((winding - sum).abs() < 0.02, "{p}: {winding}, not {sum}");
            if distance.abs() > 0.15 {
                assert_eq!(winding > 0.5, distance < 0.0, "{p}: {winding} at {distance}");
                inside += usize::from(distance < 0.0);
            }
        }
        assert!(inside > 5);
        // A power of two scales places and areas, not the number.
        let scale = 2.0_f64.powi(90);
        let large: Vec<DVec3> = points.iter().map(|&p| scale * p).collect();
        let wide: Vec<DVec3> = vectors.iter().map(|&a| scale * scale * a).collect();
        let scaled =
            CloudWinding::new(&large, &wide, WindingOptions::default(), Progress::NONE).unwrap();
        assert!(
            places.iter().zip(&many).all(|(&p, w)| scaled.at(scale * p).to_bits() == w.to_bits())
        );
    }
    let options = WindingOptions::default();
    let refused = |areas: &[DVec3]| {
        CloudWinding::new(&[DVec3::X], areas, options, Progress::NONE).err().unwrap()
    };
    assert!(matches!(refused(&[]), Error::InvalidOption { .. }));
    assert!(matches!(refused(&[DVec3::NAN]), Error::NonFinitePoint { index: 0 }));
    let nothing = CloudWinding::new(&[], &[], options, Progress::NONE).unwrap();
    assert_eq!(nothing.at(DVec3::X), 0.0);
}
