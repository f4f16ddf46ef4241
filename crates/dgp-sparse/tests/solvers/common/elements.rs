//! Linear finite elements on triangle meshes: cotangent Laplacian and masses.

use std::collections::BTreeMap;

use dgp_sparse::SparseMatrix;

pub(crate) type Point = [f64; 3];

/// Positions and triangles.
pub(crate) type Triangles = (Vec<Point>, Vec<[u32; 3]>);

/// Laplacian, lumped mass and mass of linear elements.
pub(crate) struct Elements {
    pub(crate) laplacian: SparseMatrix,
    pub(crate) lumped: Vec<f64>,
    pub(crate) galerkin: SparseMatrix,
}

/// A unit icosahedron whose faces are cut in four so often, with vertices on the unit sphere.
pub(crate) fn icosphere(level: usize) -> Triangles {
    let height = 1.0 / 5.0_f64.sqrt();
    let ring = |i: u32, z: f64, turn: f64| {
        let angle = std::f64::consts::TAU * (f64::from(i) + turn) / 5.0;
        [2.0 * height * angle.cos(), 2.0 * height * angle.sin(), z]
    };
    let mut points: Vec<Point> = vec![[0.0, 0.0, 1.0]];
    points.extend((0..5).map(|i| ring(i, height, 0.0)));
    points.extend((0..5).map(|i| ring(i, -height, 0.5)));
    points.push([0.0, 0.0, -1.0]);
    let mut faces: Vec<[u32; 3]> = (0..5)
        .flat_map(|i| {
            let (a, b, c, d) = (1 + i, 1 + (i + 1) % 5, 6 + i, 6 + (i + 1) % 5);
            [[0, a, b], [a, c, b], [b, c, d], [c, 11, d]]
        })
        .collect();
    for _ in 0..level {
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (points[a as usize], points[b as usize]);
                let sum = [p[0] + q[0], p[1] + q[1], p[2] + q[2]];
                let length = dot(sum, sum).sqrt();
                points.push(sum.map(|x| x / length));
                points.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (x, y, z) = (middle(b, c), middle(c, a), middle(a, b));
                [[a, z, y], [b, x, z], [c, y, x], [x, y, z]]
            })
            .collect();
    }
    (points, faces)
}

/// The matrices of a mesh of which only edge vectors are used: `edge(i, j)` leads from i to j.
pub(crate) fn elements_with(
    n: usize,
    faces: &[[u32; 3]],
    edge: impl Fn(u32, u32) -> Point,
) -> Elements {
    let mut weights = Vec::new();
    let mut lumped = vec![0.0; n];
    let mut masses = Vec::new();
    for &[a, b, c] in faces {
        let (u, v) = (edge(a, b), edge(a, c));
        let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
        let area = 0.5 * (uu * vv - uv * uv).sqrt();
        for ((i, j, k), dot_at_k) in
            [(b, c, a), (c, a, b), (a, b, c)].into_iter().zip([uv, uu - uv, vv - uv])
        {
            weights.push((i, j, 0.25 * dot_at_k / area));
            lumped[k as usize] += area / 3.0;
            masses.extend([(i, j, area / 12.0), (j, i, area / 12.0), (k, k, area / 6.0)]);
        }
    }
    Elements {
        laplacian: SparseMatrix::from_edges(n, &weights).unwrap(),
        lumped,
        galerkin: SparseMatrix::from_triplets(n, n, &masses).unwrap(),
    }
}

/// The matrices of a mesh in space.
pub(crate) fn elements((points, faces): &Triangles) -> Elements {
    elements_with(points.len(), faces, |i, j| {
        let (p, q) = (points[i as usize], points[j as usize]);
        [q[0] - p[0], q[1] - p[1], q[2] - p[2]]
    })
}

/// The matrices of the flat unit torus, of n × n squares cut in two.
pub(crate) fn flat_torus(n: u32) -> Elements {
    let index = |x: u32, y: u32| x % n + y % n * n;
    let squares = (0..n * n).map(|i| (i % n, i / n));
    let faces: Vec<[u32; 3]> = squares
        .flat_map(|(x, y)| {
            let corners = [index(x, y), index(x + 1, y), index(x + 1, y + 1), index(x, y + 1)];
            [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
        })
        .collect();
    // The shortest way around.
    let step = |from: u32, to: u32| match (to + n - from) % n {
        0 => 0.0,
        1 => 1.0 / f64::from(n),
        _ => -1.0 / f64::from(n),
    };
    elements_with((n * n) as usize, &faces, |i, j| [step(i % n, j % n), step(i / n, j / n), 0.0])
}

fn dot(a: Point, b: Point) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
