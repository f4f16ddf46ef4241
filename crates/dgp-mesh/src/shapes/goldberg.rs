//! Spheres of triangles with five or six at a vertex, and their duals of pentagons and hexagons.
//!
//! Caspar and Klug's construction: the plane is tiled with triangles, its points are the numbers
//! x + y ω with ω = exp(iπ/3), and a face of the icosahedron is the triangle 0, a + b ω, (a + b ω) ω.
//! It holds T = a² + ab + b² small triangles; where they cross its sides they fold over to the
//! neighboring face.
//!
//! Reference: Goldberg, "A class of multi-symmetric polyhedra", Tohoku Mathematical Journal 43, 1937;
//! Caspar and Klug, "Physical principles in the construction of regular viruses", 1962.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{face_count, manifold, platonic::icosahedron};
use crate::{Error, FaceId, FaceList, HalfedgeId, Mesh, VertexId};

/// The truncated icosahedron, the football: 12 pentagons and 20 hexagons, all regular, with its 60
/// vertices on the unit sphere.
pub fn truncated_icosahedron() -> Mesh {
    let solid = icosahedron();
    // Each half-edge gives the vertex at a third of its way.
    let position = |h: HalfedgeId| {
        let [from, to] = [solid.from(h), solid.to(h)].map(|v| solid.position(v));
        (2.0 * from + to).normalize()
    };
    let mut faces: Vec<Vec<usize>> = solid
        .vertices()
        .map(|v| solid.vertex_halfedges(v).map(HalfedgeId::index).collect())
        .collect();
    for f in solid.faces() {
        let sides = solid.face_halfedges(f).flat_map(|h| [h.index(), h.twin().index()]);
        faces.push(sides.collect());
    }
    manifold(solid.halfedges().map(position).collect(), &FaceList::from_indices(&faces))
        .expect("a truncated solid is a manifold")
}

/// The Goldberg polyhedron GP(a, b): 12 pentagons and 10(T − 1) hexagons, three at each of its 20 T
/// vertices, where T = a² + ab + b². Its faces are flat and touch the unit sphere.
///
/// GP(1, 0) is the dodecahedron; GP(1, 1) has the faces of [`truncated_icosahedron`], GP(2, 1) and
/// GP(1, 2) are mirror images. Errors: [`Error::InvalidOption`] if a and b are 0 or T is too large.
pub fn goldberg(a: usize, b: usize) -> Result<Mesh, Error> {
    let dual = geodesic_sphere(a, b)?;
    // The vertex of a triangle is where the planes that touch the sphere at its corners meet.
    let corner = |f: FaceId| {
        let [p, q, r] = dual.triangle(f).expect("triangles").map(|v| dual.position(v));
        let normal = (q - p).cross(r - p);
        normal / normal.dot(p)
    };
    let face = |v: VertexId| dual.vertex_faces(v).map(FaceId::index).collect();
    let faces: Vec<Vec<usize>> = dual.vertices().map(face).collect();
    manifold(dual.faces().map(corner).collect(), &FaceList::from_indices(&faces))
}

/// The unit sphere of 20 T triangles and 10 T + 2 vertices, T = a² + ab + b²: five triangles at 12
/// vertices, six at all others, none of them on a plane of symmetry unless b = 0 or a = b.
///
/// `geodesic_sphere(n, 0)` splits the edges of the icosahedron into n parts.
/// Errors: [`Error::InvalidOption`] if a and b are 0 or T is too large.
pub fn geodesic_sphere(a: usize, b: usize) -> Result<Mesh, Error> {
    if a == 0 && b == 0 {
        return Err(Error::option("a", 0.0, "above 0 where b is 0"));
    }
    let longest = a.max(b).saturating_add(a.min(b));
    face_count(&[20, longest, longest])?;
    let (a, b) = (a as i64, b as i64);
    let size = a * a + a * b + b * b;

    let solid = icosahedron();
    let mut ids: BTreeMap<[(usize, i64); 3], usize> = BTreeMap::new();
    let mut positions = Vec::new();
    let mut triangles: Vec<[usize; 3]> = Vec::new();
    for f in solid.faces() {
        for (x, y) in points(a, b) {
            // The two small triangles above (x, y): one points up, one down.
            for small in
                [[(x, y), (x + 1, y), (x, y + 1)], [(x + 1, y), (x + 1, y + 1), (x, y + 1)]]
            {
                let places = small.map(|point| barycentric(point, a, b));
                let sum = |k: usize| places.iter().map(|place| place[k]).sum::<i64>();
                if [0, 1, 2].iter().any(|&k| sum(k) < 0) {
                    continue;
                }
                triangles.push(places.map(|place| {
                    let key = key(&solid, f, place);
                    *ids.entry(key).or_insert_with(|| {
                        let part = |&(v, weight): &(usize, i64)| {
                            if weight == 0 {
                                return DVec3::ZERO;
                            }
                            solid.position(VertexId::new(v)) * (weight as f64 / size as f64)
                        };
                        positions.push(key.iter().map(part).sum::<DVec3>().normalize());
                        positions.len() - 1
                    })
                }));
            }
        }
    }
    // Triangles with their center on a side of the icosahedron were met from both faces.
    for triangle in &mut triangles {
        let first = (0..3).min_by_key(|&k| triangle[k]).expect("three corners");
        triangle.rotate_left(first);
    }
    triangles.sort_unstable();
    triangles.dedup();
    manifold(positions, &FaceList::from_indices(&triangles))
}

/// The lower left corners of all rhombi that can meet the triangle 0, a + b ω, (a + b ω) ω.
fn points(a: i64, b: i64) -> impl Iterator<Item = (i64, i64)> {
    (-b - 1..=a).flat_map(move |x| (-1..=a + b).map(move |y| (x, y)))
}

/// T times the barycentric coordinates of x + y ω in the triangle 0, a + b ω, (a + b ω) ω.
fn barycentric((x, y): (i64, i64), a: i64, b: i64) -> [i64; 3] {
    // (a + b ω) ω = −b + (a + b) ω.
    let (s, t) = ((a + b) * x + b * y, a * y - b * x);
    [a * a + a * b + b * b - s - t, s, t]
}

/// What names a point of the icosahedron whatever the face it is seen from: the corners whose mean it is
/// and their weights, in order, padded with nothing.
fn key(solid: &Mesh, f: FaceId, mut place: [i64; 3]) -> [(usize, i64); 3] {
    let mut h = solid.face_halfedge(f);
    // `place` belongs to the corners of h, next(h), prev(h).
    while let Some(k) = (0..3).find(|&k| place[k] < 0) {
        // Beyond the side opposite corner k: unfold the face there. With the fourth corner d of the
        // parallelogram, corner k is the sum of the other two less d.
        let side = [solid.next(h), solid.prev(h), h][k];
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        // The side leads from corner i to corner j, its twin from j to i; then comes d.
        h = side.twin();
        place = [place[j] + place[k], place[i] + place[k], -place[k]];
    }
    let vertices = [h, solid.next(h), solid.prev(h)].map(|h| solid.from(h).index());
    let mut key =
        [0, 1, 2].map(|k| if place[k] > 0 { (vertices[k], place[k]) } else { (usize::MAX, 0) });
    key.sort_unstable();
    key
}
