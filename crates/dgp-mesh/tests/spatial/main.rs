//! Spatial queries against looking at everything.

mod closest;
mod distances;
mod inside;
mod intersections;
mod rays;

use dgp_mesh::{
    DVec3, FaceId, FaceList, IndexedFaceSet, Progress, TriangulationMethod,
    measure::Surface,
    shapes::{self, Random},
    spatial::TriangleTree,
    triangulate_faces,
};

/// Face sets of every kind: meshes, triangles at random, and what has no area.
fn surfaces() -> Vec<(&'static str, IndexedFaceSet)> {
    let noisy = shapes::with_noise(shapes::icosphere(3).unwrap(), 0.02, 7).unwrap();
    let meshes = [
        ("cube", shapes::cube()),
        ("dodecahedron", shapes::dodecahedron()),
        ("holed sphere", shapes::with_holes(&noisy, 4, 1, 3).unwrap()),
        ("noisy sphere", noisy),
        ("quad torus", shapes::quad_torus(2.0, 0.7, 24, 12).unwrap()),
        ("grid", shapes::grid(5, 7).unwrap()),
        ("cone", shapes::capped_cone(1.0, 2.0, 12, 3).unwrap()),
        ("trefoil", shapes::trefoil(60, 8).unwrap()),
        ("blob", shapes::blob(3).unwrap()),
    ];
    let mut all: Vec<_> = meshes.map(|(name, mesh)| (name, mesh.to_indexed())).into();
    all.push(("soup", soup(300, 0.5, 1)));
    all.push(("large soup", soup(40, 4.0, 2)));
    all.push(("needles", needles()));
    all.push(("points and lines", degenerate()));
    all.push(("one triangle", faces(vec![DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]])));
    all.push(("möbius", shapes::mobius_strip(20, 2).unwrap()));
    all
}

fn faces(positions: Vec<DVec3>, faces: &[[usize; 3]]) -> IndexedFaceSet {
    IndexedFaceSet::new(positions, FaceList::from_indices(faces)).unwrap()
}

/// Triangles of some `size`, anywhere in a cube.
fn soup(count: usize, size: f64, seed: u64) -> IndexedFaceSet {
    let mut random = Random::new(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = random_point(&mut random);
        positions.extend([0; 3].map(|_| center + size * random_point(&mut random)));
    }
    let triangles: Vec<[usize; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    faces(positions, &triangles)
}

/// Triangles a billion times as long as high.
fn needles() -> IndexedFaceSet {
    let mut random = Random::new(5);
    let mut positions = Vec::new();
    for k in 0..60 {
        let (start, end) = (random_point(&mut random), random_point(&mut random));
        let height = 0.1_f64.powi(k % 16);
        positions.extend([start, end, 0.5 * (start + end) + height * random_point(&mut random)]);
    }
    let triangles: Vec<[usize; 3]> = (0..60).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    faces(positions, &triangles)
}

/// Triangles whose corners lie in a line or at one point.
fn degenerate() -> IndexedFaceSet {
    let line = |k: usize| DVec3::new(k as f64, 2.0 * k as f64, 0.0);
    let mut positions: Vec<DVec3> = (0..6).map(line).collect();
    positions.extend([DVec3::splat(5.0); 3]);
    faces(positions, &[[0, 2, 1], [3, 3, 5], [6, 7, 8], [4, 4, 4], [1, 0, 2]])
}

/// Points near, on and far from a surface around the origin.
fn probes(set: &IndexedFaceSet, count: usize) -> Vec<DVec3> {
    let mut random = Random::new(11);
    let mut points: Vec<DVec3> = (0..count).map(|_| 2.5 * random_point(&mut random)).collect();
    points.extend((0..count).map(|_| 1e-3 * random_point(&mut random)));
    points.extend((0..20).map(|k| 10_f64.powi(k) * random_point(&mut random)));
    points.extend(set.positions().values().iter().take(40));
    points.extend(set.positions().values().windows(2).take(40).map(|w| 0.5 * (w[0] + w[1])));
    points
}

/// A point in the cube from −1 to 1.
fn random_point(random: &mut Random) -> DVec3 {
    let mut x = || 2.0 * random.uniform() - 1.0;
    DVec3::new(x(), x(), x())
}

/// The corners of all triangles, and the face of each.
fn triangles(set: &IndexedFaceSet) -> Vec<([DVec3; 3], FaceId)> {
    let (cut, sources) = triangulate_faces(set, TriangulationMethod::Ears, Progress::NONE).unwrap();
    let corners =
        cut.faces().iter().map(|(f, face)| ([0, 1, 2].map(|k| cut.position(face[k])), sources[f]));
    corners.collect()
}

fn tree(surface: &impl Surface) -> TriangleTree {
    TriangleTree::new(surface, Progress::NONE).unwrap()
}
