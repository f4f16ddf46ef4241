//! How fast refined meshes approach their limit, from the eigenvalues of a level around a vertex.

use dgp_mesh::{EdgeId, HalfedgeId, Mesh, VertexId};
use dgp_subdiv::{LoopWeights, SHARP, Scheme, Sharpness};

use crate::identities::{cages, plan_of, some_sharpness};

pub(crate) fn limit_kinds() -> [Scheme; 2] {
    [Scheme::Loop(LoopWeights::Original), Scheme::CatmullClark]
}

/// The largest factor by which a level shrinks the way from a vertex of the cage to its limit, once finite
/// sharpness has worn off: of the eigenvalues below 1 of the matrix that refines a vertex and its ring, the
/// largest that moves the vertex.
///
/// ```text
/// corner          0
/// crease, rim     1/4: a cubic spline, whose 1/2 leaves the middle where it is
/// smooth          Loop (3/8 + cos(2π/d)/4)², Catmull–Clark 1/4 at d = 4: the waves that go once around
///                 have no part at the middle either
/// dart            the reflection that keeps the crease does not turn the wave along it over, so it moves
///                 the middle unless the vertex is regular: 0.452, 0.481, 0.514 of Loop at d = 4, 5, 7;
///                 0.462, 0.526, 0.548 of Catmull–Clark at d = 3, 5, 6
/// ```
fn slowest(mesh: &Mesh, scheme: Scheme, sharpness: &Sharpness) -> f64 {
    let of_vertex = |v: VertexId| {
        let around = mesh.vertex_halfedges(v).map(HalfedgeId::edge);
        let is_sharp = |e: &EdgeId| mesh.is_boundary_edge(*e) || sharpness.edge(*e) >= SHARP;
        match around.filter(is_sharp).count() {
            0 => ring_factor(scheme, mesh.valence(v), false),
            1 => ring_factor(scheme, mesh.valence(v), true),
            2 => 0.25,
            _ => 0.0,
        }
    };
    mesh.vertices().map(of_vertex).fold(0.0, f64::max)
}

/// That factor of a smooth vertex, or one where a crease ends, by repeating the step from the left.
fn ring_factor(scheme: Scheme, d: usize, dart: bool) -> f64 {
    // The vertex, its neighbors, the corners across (none for triangles).
    let quads = scheme == Scheme::CatmullClark;
    let size = if quads { 2 * d + 1 } else { d + 1 };
    let mut matrix = vec![vec![0.0; size]; size];
    let add = |matrix: &mut Vec<Vec<f64>>, row: usize, parts: &[(usize, f64)]| {
        for &(column, weight) in parts {
            matrix[row][column] += weight;
        }
    };
    let (spoke, n) = (|i: usize| 1 + i % d, d as f64);
    let face = |i: usize, weight: f64| {
        let corners = [0, spoke(i), spoke(i + 1), 1 + d + i % d];
        corners.map(|column| (column, weight / 4.0))
    };
    for i in 0..d {
        let (own, before) = (spoke(i), spoke(i + d - 1));
        match (i == 0 && dart, quads) {
            (true, _) => add(&mut matrix, own, &[(0, 0.5), (own, 0.5)]),
            (false, true) => {
                add(&mut matrix, own, &[(0, 0.25), (own, 0.25)]);
                add(&mut matrix, own, &face(i, 0.25));
                add(&mut matrix, own, &face(i + d - 1, 0.25));
            }
            (false, false) => {
                let sides = [(before, 0.125), (spoke(i + 1), 0.125)];
                add(&mut matrix, own, &[(0, 0.375), (own, 0.375), sides[0], sides[1]]);
            }
        }
        if quads {
            add(&mut matrix, 0, &[(0, (n - 2.0) / (n * n)), (own, 1.0 / (n * n))]);
            add(&mut matrix, 0, &face(i, 1.0 / (n * n)));
            add(&mut matrix, 1 + d + i, &face(i, 1.0));
        } else {
            let inner = 3.0 / 8.0 + (std::f64::consts::TAU / n).cos() / 4.0;
            let beta = (5.0 / 8.0 - inner * inner) / n;
            add(&mut matrix, 0, &[(0, 1.0 / n - beta), (own, beta)]);
        }
    }
    let step = |row: &[f64]| -> Vec<f64> {
        (0..size).map(|j| (0..size).map(|i| row[i] * matrix[i][j]).sum()).collect()
    };
    // What the vertex is made of after ever more steps, less its limit.
    let start: Vec<f64> = (0..size).map(|i| f64::from(u8::from(i == 0))).collect();
    let limit = (0..200).fold(start.clone(), |row, _| step(&row));
    let mut left: Vec<f64> = start.iter().zip(&limit).map(|(a, b)| a - b).collect();
    let mut factor = 0.0;
    for _ in 0..200 {
        let mut next = step(&left);
        // Rounding brings the limit back.
        let sum: f64 = next.iter().sum();
        next.iter_mut().zip(&limit).for_each(|(x, part)| *x -= sum * part);
        let size = |row: &[f64]| row.iter().map(|x| x.abs()).fold(0.0, f64::max);
        factor = size(&next) / size(&left);
        let scale = size(&next);
        left = next.iter().map(|x| x / scale).collect();
    }
    factor
}

#[test]
fn factors_of_rings_are_the_known_ones() {
    let [of_loop, clark] = limit_kinds();
    for (factor, expected) in [
        (ring_factor(of_loop, 3, false), 1.0 / 16.0),
        (ring_factor(of_loop, 4, false), 9.0 / 64.0),
        (ring_factor(of_loop, 6, false), 0.25),
        (ring_factor(clark, 4, false), 0.25),
    ] {
        assert!((factor - expected).abs() < 1e-9, "{factor} {expected}");
    }
    // The wave along a crease that ends at a regular vertex does not move it.
    assert!(ring_factor(of_loop, 6, true) < 0.4 && ring_factor(clark, 4, true) < 0.4);
}

#[test]
fn refinement_approaches_the_limit() {
    for scheme in limit_kinds() {
        for mesh in cages(scheme) {
            for sharpness in [Sharpness::new(), some_sharpness(&mesh, scheme)] {
                let cage = plan_of(&mesh, scheme, 0, &sharpness);
                let limit = cage.limit(mesh.positions().values()).unwrap();
                let mut errors = Vec::new();
                for levels in [5, 6] {
                    let plan = plan_of(&mesh, scheme, levels, &sharpness);
                    let refined = plan.refine(mesh.positions().values()).unwrap();
                    // From any level on the limit is the same.
                    let again = plan.limit(&refined).unwrap();
                    for (p, q) in limit.iter().zip(&again) {
                        assert!(p.distance(*q) < 1e-12, "{scheme:?} {p} {q}");
                    }
                    let distances = limit.iter().zip(&refined).map(|(p, q)| p.distance(*q));
                    errors.push(distances.fold(0.0, f64::max));
                }
                let ratio = errors[0] / errors[1].max(1e-300);
                // Up to rounding, as all shrink alike where every vertex is regular.
                let least = (1.0 - 1e-9) / slowest(&mesh, scheme, &sharpness);
                assert!(
                    errors[1] < 1e-14 || (least..17.0).contains(&ratio),
                    "{scheme:?} {errors:?}"
                );
            }
        }
    }
}
