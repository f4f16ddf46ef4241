//! Rays and segments.

use dgp_mesh::{
    DVec3, Error, Progress,
    shapes::{self, Random},
    spatial::Ray,
};

use super::{random_point, surfaces, tree, triangles};

/// Where a line through a triangle's plane meets it, by Möller and Trumbore.
fn brute_force(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac, d) = (b - a, c - a, ray.direction);
    let p = d.cross(ac);
    let det = ab.dot(p);
    let q = (ray.origin - a).cross(ab);
    let (u, v) = ((ray.origin - a).dot(p) / det, d.dot(q) / det);
    let t = ac.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= ray.end).then_some(t)
}

fn rays() -> Vec<Ray> {
    let mut random = Random::new(3);
    let mut rays = Vec::new();
    for k in 0..150 {
        let (a, b) = (3.0 * random_point(&mut random), random_point(&mut random));
        rays.push(if k % 3 == 0 { Ray::segment(a, b) } else { Ray::new(a, b - a) });
    }
    // Along axes, from afar, and with directions of any length.
    for k in 0..30 {
        let p = random_point(&mut random);
        let axis = DVec3::AXES[k % 3];
        rays.push(Ray::new(p - 5.0 * axis, axis));
        rays.push(Ray::new(p + 5.0 * axis, -1e-200 * axis));
        rays.push(Ray::new(p + 1e6 * random.direction(), 1e200 * random.direction()));
        let far = 1e4 * random.direction();
        rays.push(Ray::new(p + far, -far));
    }
    rays
}

#[test]
fn hits_are_those_of_trying_all_triangles() {
    for (name, set) in surfaces() {
        let (tree, all) = (tree(&set), triangles(&set));
        for ray in rays() {
            let mut right: Vec<_> = all.iter().filter_map(|&(t, _)| brute_force(&ray, t)).collect();
            right.sort_by(f64::total_cmp);
            let hits = tree.all_hits(&ray);
            let size = ray.direction.abs().max_element();
            let scale = 1.0 + ray.origin.length();
            if name != "points and lines" && name != "needles" {
                assert_eq!(hits.len(), right.len(), "{name} {ray:?}");
            }
            for (hit, t) in hits.iter().zip(&right).filter(|_| name != "needles") {
                assert!(
                    ((hit.t - t) * size).abs() < 1e-11 * scale,
                    "{name} {ray:?}: {hit:?}, not {t}"
                );
                let on_ray = ray.origin + hit.t * ray.direction;
                assert!((hit.point - on_ray).length() < 1e-9 * scale, "{name} {ray:?}: {hit:?}");
                let corners = hit.vertices.map(|v| set.position(v));
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                assert_eq!(hit.is_front, normal.dot(ray.direction / size) < 0.0, "{name} {ray:?}");
            }
            assert_eq!(tree.first_hit(&ray), hits.first().copied(), "{name} {ray:?}");
            assert_eq!(tree.is_hit(&ray), !hits.is_empty(), "{name} {ray:?}");
        }
    }
}

#[test]
fn no_ray_slips_through_a_closed_surface() {
    for mesh in [shapes::icosphere(4).unwrap(), shapes::cube(), shapes::quad_sphere(8).unwrap()] {
        let tree = tree(&mesh);
        // From inside toward vertices and middles of edges.
        let ends = mesh.vertices().map(|v| mesh.position(v));
        let middles = mesh.edges().map(|e| {
            let [v, w] = mesh.edge_vertices(e);
            0.5 * (mesh.position(v) + mesh.position(w))
        });
        for end in ends.chain(middles) {
            let origin = DVec3::new(0.01, -0.02, 0.03);
            assert!(tree.first_hit(&Ray::new(origin, end - origin)).is_some(), "{end}");
            assert!(tree.is_hit(&Ray::segment(origin, origin + 1.01 * (end - origin))), "{end}");
        }
    }
}

#[test]
fn many_rays_give_the_bits_of_one_by_one_and_bad_ones_are_named() {
    let tree = tree(&shapes::blob(4).unwrap());
    let rays = rays();
    let together = tree.first_hits(&rays, Progress::NONE).unwrap();
    assert!(together.iter().zip(&rays).all(|(hit, ray)| *hit == tree.first_hit(ray)));
    let are_hit = tree.are_hit(&rays, Progress::NONE).unwrap();
    assert!(are_hit.iter().zip(&together).all(|(is_hit, hit)| *is_hit == hit.is_some()));
    for bad in [
        Ray::new(DVec3::ZERO, DVec3::ZERO),
        Ray::new(DVec3::NAN, DVec3::X),
        Ray { end: -1.0, ..Ray::new(DVec3::ZERO, DVec3::X) },
    ] {
        let error = tree.first_hits(&[rays[0], bad], Progress::NONE);
        assert_eq!(error, Err(Error::InvalidRay { index: 1 }));
        assert!(
            tree.first_hit(&bad).is_none() && !tree.is_hit(&bad) && tree.all_hits(&bad).is_empty()
        );
    }
}

#[test]
fn powers_of_two_scale_hits_exactly() {
    let set = shapes::blob(3).unwrap().to_indexed();
    let before: Vec<_> = rays().iter().take(150).map(|ray| tree(&set).first_hit(ray)).collect();
    for k in [-600, -3, 500] {
        let factor = 2_f64.powi(k);
        let mut scaled = set.clone();
        scaled.positions_mut().iter_mut().for_each(|p| *p *= factor);
        let tree = tree(&scaled);
        for (ray, before) in rays().iter().zip(&before) {
            let ray = Ray {
                origin: ray.origin * factor,
                direction: ray.direction * factor,
                end: ray.end,
            };
            let after = tree.first_hit(&ray);
            let expected = before.map(|hit| (hit.t, hit.point * factor, hit.face));
            assert_eq!(after.map(|hit| (hit.t, hit.point, hit.face)), expected, "2^{k}");
        }
    }
}
