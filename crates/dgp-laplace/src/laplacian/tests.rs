//! Hand examples, identities over all kinds of meshes, closed forms.

use std::f64::consts::{PI, TAU};

use dgp_mesh::{
    DMat3, DVec3, EdgeId, Editor, FaceList, IndexedFaceSet, Mesh, Progress, VertexId,
    measure::{VertexArea, area, vertex_areas},
    shapes::{self, Random},
};
use dgp_sparse::SparseMatrix;

use super::*;
use crate::{Error, flow::HeatFlow, test_shapes::flat_torus};

fn mesh(positions: &[DVec3], faces: &[[usize; 3]]) -> Mesh {
    let faces = FaceList::from_indices(faces);
    Mesh::new(&IndexedFaceSet::new(positions.to_vec(), faces).unwrap()).unwrap()
}

/// Meshes of triangles of every kind.
fn triangle_meshes() -> Vec<(&'static str, Mesh)> {
    let noisy = shapes::with_noise(shapes::icosphere(3).unwrap(), 0.2, 7).unwrap();
    let shuffled = shapes::shuffled(&shapes::blob(2).unwrap().to_indexed(), 3);
    vec![
        ("empty", Mesh::default()),
        ("tetrahedron", shapes::tetrahedron()),
        ("icosphere", shapes::icosphere(3).unwrap()),
        ("holed", shapes::with_holes(&noisy, 4, 1, 3).unwrap()),
        ("noisy", noisy),
        ("torus", shapes::torus(2.0, 0.7, 24, 12).unwrap()),
        ("genus 3", shapes::surface_of_genus(3, 2).unwrap()),
        ("grid", shapes::grid(5, 7).unwrap()),
        ("cone", shapes::capped_cone(1.0, 2.0, 12, 3).unwrap()),
        ("trefoil", shapes::trefoil(60, 8).unwrap()),
        ("blob", Mesh::new(&shuffled).unwrap()),
    ]
}

/// A Laplacian of each kind.
fn all(mesh: &Mesh) -> Vec<(&'static str, SparseMatrix)> {
    let cotangent = cotangent_laplacian(mesh).unwrap();
    vec![
        ("uniform", uniform_laplacian(mesh).unwrap()),
        ("mean value", mean_value_laplacian(mesh).unwrap()),
        ("random walk", random_walk_laplacian(&cotangent).unwrap()),
        ("cotangent", cotangent),
    ]
}

fn quadratic(l: &SparseMatrix, x: &[f64]) -> f64 {
    l.product(x).iter().zip(x).map(|(a, b)| a * b).sum()
}

fn random_values(n: usize, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..n).map(|_| 2.0 * random.uniform() - 1.0).collect()
}

#[test]
fn the_triangle_graph_has_two_on_the_diagonal_and_minus_one_beside() {
    let triangle = mesh(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]);
    let l = uniform_laplacian(&triangle).unwrap();
    for i in 0..3 {
        for j in 0..3 {
            assert_eq!(l.get(i, j), if i == j { 2.0 } else { -1.0 });
        }
    }
}

#[test]
fn angles_of_60_and_45_degrees_give_half_of_one_over_root_three_plus_one() {
    // The edge from 0 to 1; an equilateral triangle above, a right one with 45° at its tip below.
    let up = DVec3::new(0.5, 0.75_f64.sqrt(), 0.0);
    let positions = [DVec3::ZERO, DVec3::X, up, DVec3::new(0.0, -1.0, 0.0)];
    let l = cotangent_laplacian(&mesh(&positions, &[[0, 1, 2], [1, 0, 3]])).unwrap();
    let expected = 0.5 * (1.0 / 3.0_f64.sqrt() + 1.0);
    assert!((l.get(0, 1) + expected).abs() < 1e-15 && l.get(0, 1) == l.get(1, 0));
    // The right angle is opposite the edge from 1 to 3.
    assert!(l.get(1, 3).abs() < 1e-15);
}

#[test]
fn mean_values_of_a_regular_fan_are_equal_and_reproduce_linear_functions_in_a_flat_one() {
    let mut random = Random::new(3);
    let mut positions = vec![DVec3::ZERO];
    positions.extend((0..7).map(|k| {
        let (sin, cos) = ((k as f64 + 0.8 * random.uniform()) * TAU / 7.0).sin_cos();
        (0.5 + random.uniform()) * DVec3::new(cos, sin, 0.0)
    }));
    let faces: Vec<[usize; 3]> = (0..7).map(|k| [0, 1 + k, 1 + (k + 1) % 7]).collect();
    let fan = mesh(&positions, &faces);
    let l = mean_value_laplacian(&fan).unwrap();
    for k in 0..2 {
        let x: Vec<f64> = positions.iter().map(|p| p[k]).collect();
        assert!(l.product(&x)[0].abs() < 1e-13);
    }
    // Row 0 by the formula.
    let w = |k: usize| {
        let p = positions[k];
        let angle = |q: DVec3| p.angle_between(q);
        let sides = [positions[1 + (k + 5) % 7], positions[1 + k % 7]];
        sides.map(|q| (0.5 * angle(q)).tan()).iter().sum::<f64>() / (2.0 * p.length())
    };
    for k in 1..8 {
        assert!((l.get(0, k) + w(k)).abs() < 1e-13, "{k}");
    }
}

#[test]
fn constants_are_mapped_to_zero_and_symmetric_ones_are_symmetric_and_not_negative() {
    for (name, mesh) in triangle_meshes() {
        for (kind, l) in all(&mesh) {
            let report = laplacian_report(&l);
            assert!(report.row_sum_error < 1e-13, "{name} {kind}: {report:?}");
            assert_eq!(report.edges, mesh.edge_count(), "{name} {kind}");
            if kind == "mean value" {
                assert!(report.least_weight.is_none_or(|w| w > 0.0), "{name}: positive");
            }
            if kind == "uniform" || kind == "cotangent" {
                assert_eq!(report.asymmetry, 0.0, "{name} {kind}");
                for seed in 0..5 {
                    let x = random_values(mesh.vertex_count(), seed);
                    let size = l.row_norm() * x.iter().map(|x| x * x).sum::<f64>();
                    assert!(quadratic(&l, &x) >= -1e-15 * size, "{name} {kind}");
                }
                // The energy of constants alone is zero: with a little mass it is definite.
                let ones = vec![1e-6 * l.row_norm().max(1.0); mesh.vertex_count()];
                assert!(HeatFlow::new(&l, &ones, 1.0, Progress::NONE).is_ok(), "{name} {kind}");
            }
        }
    }
}

#[test]
fn negative_weights_are_counted() {
    // Two obtuse triangles at an edge: both angles are above 90°.
    let tip = |y: f64| DVec3::new(0.5, y, 0.0);
    let flat = mesh(&[DVec3::ZERO, DVec3::X, tip(0.1), tip(-0.1)], &[[0, 1, 2], [1, 0, 3]]);
    let report = laplacian_report(&cotangent_laplacian(&flat).unwrap());
    assert_eq!(report.negative_weights, 2);
    // cot α = −(0.25 − 0.01)/(2·0.5·0.1) at both tips.
    assert!((report.least_weight.unwrap() + 2.4).abs() < 1e-14, "{report:?}");
}

#[test]
fn the_energy_of_a_function_is_that_of_its_gradient() {
    for (name, mesh) in triangle_meshes() {
        let l = cotangent_laplacian(&mesh).unwrap();
        let x = random_values(mesh.vertex_count(), 9);
        let energy: f64 = mesh
            .faces()
            .map(|f| {
                let corners = mesh.triangle(f).unwrap();
                let [a, b, c] = corners.map(|v| mesh.position(v));
                let [p, q, r] = corners.map(|v| x[v.index()]);
                let normal = mesh.face_normal(f);
                // ∇x = Σ value · (normal × opposite side) / (2 area).
                let sum =
                    p * normal.cross(c - b) + q * normal.cross(a - c) + r * normal.cross(b - a);
                sum.length_squared() / (4.0 * mesh.face_area(f))
            })
            .sum();
        assert!((quadratic(&l, &x) - energy).abs() <= 1e-11 * energy, "{name}");
    }
}

#[test]
fn motion_changes_nothing_and_scale_only_the_unit() {
    let turn = DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(-1.1);
    for (name, mesh) in triangle_meshes() {
        let moved = |change: &dyn Fn(DVec3) -> DVec3| {
            let mut other = mesh.clone();
            other.set_positions(mesh.positions().map(|&p| change(p)));
            other
        };
        let rigid = moved(&|p| turn * p + DVec3::new(1.0, -2.0, 0.5));
        for ((kind, a), (_, b)) in all(&mesh).into_iter().zip(all(&rigid)) {
            let difference = SparseMatrix::combine(1.0, &a, -1.0, &b).unwrap();
            let most = difference.values().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(most <= 1e-10 * a.row_norm(), "{name} {kind}: {most}");
        }
        for k in [-300, -7, 300] {
            let s = 2_f64.powi(k);
            let scaled = moved(&|p| s * p);
            for ((kind, a), (_, b)) in all(&mesh).into_iter().zip(all(&scaled)) {
                let unit = if kind == "mean value" { 1.0 / s } else { 1.0 };
                assert!(a.scaled(unit) == b, "{name} {kind} 2^{k}");
            }
        }
    }
}

#[test]
fn masses_sum_to_the_area() {
    for (name, mesh) in triangle_meshes() {
        let total = area(&mesh);
        for kind in [MassKind::Barycentric, MassKind::MixedVoronoi, MassKind::Galerkin] {
            let mass = mass_matrix(&mesh, kind).unwrap();
            let sum: f64 = mass.values().iter().sum();
            assert!((sum - total).abs() <= 1e-12 * total, "{name} {kind:?}");
            assert!(mass.check_symmetric().is_ok() && mass.values().iter().all(|m| *m >= 0.0));
        }
        let lumped = mass_matrix(&mesh, MassKind::Galerkin)
            .unwrap()
            .product(&vec![1.0; mesh.vertex_count()]);
        let masses = vertex_masses(&mesh);
        for (v, mass) in masses.iter() {
            assert!(
                (lumped[v.index()] - mass).abs() <= 1e-12 * mass,
                "{name}: rows of one sum to the other"
            );
        }
    }
    // ∫ x² over the unit square is 1/3 for the piecewise linear x.
    let square = shapes::grid(4, 3).unwrap();
    let x: Vec<f64> = square.positions().values().iter().map(|p| p.x).collect();
    let integral = quadratic(&mass_matrix(&square, MassKind::Galerkin).unwrap(), &x);
    assert!((integral - 1.0 / 3.0).abs() < 1e-14);
}

#[test]
fn normalized_forms_have_their_diagonals() {
    let mesh = shapes::blob(3).unwrap();
    let l = uniform_laplacian(&mesh).unwrap();
    let walk = random_walk_laplacian(&l).unwrap();
    let normalized = normalized_laplacian(&l, &l.diagonal()).unwrap();
    assert!(walk.diagonal().iter().all(|d| *d == 1.0));
    assert!(normalized.diagonal().iter().all(|d| (d - 1.0).abs() < 1e-15));
    assert!(normalized.check_symmetric().is_ok());
    // √valence is in the null space of the one, constants in that of the other.
    let roots: Vec<f64> = l.diagonal().iter().map(|d| d.sqrt()).collect();
    assert!(normalized.product(&roots).iter().all(|x| x.abs() < 1e-13));
    let stray = mesh_with_stray();
    let l = uniform_laplacian(&stray).unwrap();
    assert_eq!(random_walk_laplacian(&l).unwrap().get(3, 3), 0.0);
    let masses = vertex_masses(&stray);
    let refused = normalized_laplacian(&l, masses.values());
    assert!(matches!(refused, Err(Error::NoMass { row: 3, .. })));
    let wrong = SparseMatrix::from_edges(2, &[(0, 1, -1.0)]).unwrap();
    assert!(matches!(
        random_walk_laplacian(&wrong),
        Err(Error::NonPositiveDiagonal { row: 0, .. })
    ));
}

fn mesh_with_stray() -> Mesh {
    mesh(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], &[[0, 1, 2]])
}

#[test]
fn bad_meshes_are_named_or_finite() {
    let quads = shapes::cube();
    assert!(matches!(
        cotangent_laplacian(&quads),
        Err(Error::Mesh(dgp_mesh::Error::NotTriangle { .. }))
    ));
    assert!(mean_value_laplacian(&quads).is_ok() && uniform_laplacian(&quads).is_ok());
    let sphere = shapes::icosphere(2).unwrap();
    for change in [
        (|_| DVec3::ONE) as fn(DVec3) -> DVec3,
        |p| p.x * DVec3::ONE,
        |p| DVec3::new(p.x, p.y, 0.0),
        |p| (2.0 * p).round(),
        |p| DVec3::new(p.x, 1e-200 * p.y, 1e-200 * p.z),
    ] {
        let mut flat = sphere.clone();
        flat.set_positions(sphere.positions().map(|&p| change(p)));
        let l = cotangent_laplacian(&flat).unwrap();
        assert!(l.values().iter().all(|x| x.is_finite()));
        match mean_value_laplacian(&flat) {
            Ok(l) => assert!(l.values().iter().all(|x| x.is_finite())),
            Err(error) => assert!(matches!(error, Error::NoLength { .. })),
        }
    }
}

/// Row 3 of the oracles: the flat torus, known by its lengths alone.
#[test]
fn waves_on_a_flat_torus_are_eigenvectors() {
    let n = 16;
    let step = 1.0 / n as f64;
    let flat = flat_torus(n);
    let (l, masses) = (flat.laplacian().unwrap(), flat.masses());
    assert!(masses.values().iter().all(|m| (m - step * step).abs() < 1e-15));
    for (a, b) in [(0, 0), (1, 0), (3, 2), (8, 8), (5, 7)] {
        let angle = |k: usize| TAU * k as f64 / n as f64;
        let lambda = (4.0 - 2.0 * angle(a).cos() - 2.0 * angle(b).cos()) / (step * step);
        let wave: Vec<f64> =
            (0..n * n).map(|v| (angle(a * (v % n)) + angle(b * (v / n))).cos()).collect();
        let product = l.product(&wave);
        for v in 0..n * n {
            let error = product[v] - lambda * step * step * wave[v];
            assert!(error.abs() < 1e-13 * 8.0, "({a}, {b}) at {v}: {error}");
        }
    }
}

/// Row 4 of the oracles: solutions of (M + L) u = M f converge, values of M⁻¹ L f do not.
#[test]
fn solutions_converge_with_order_two_and_values_do_not() {
    let (mut solutions, mut values) = (Vec::new(), Vec::new());
    for level in 3..=5 {
        let mesh = shapes::icosphere(level).unwrap();
        let masses = vertex_areas(&mesh, VertexArea::Barycentric);
        let l = cotangent_laplacian(&mesh).unwrap();
        let x2: Vec<f64> = mesh.positions().values().iter().map(|p| p.x * p.x).collect();
        // −Δ x² = 6x² − 2, so that u − Δu = f for f = 7x² − 2 and u = x².
        let f: Vec<f64> = x2.iter().map(|x| 7.0 * x - 2.0).collect();
        let flow = HeatFlow::new(&l, masses.values(), 1.0, Progress::NONE).unwrap();
        let u = flow.step(&f).unwrap();
        let square: f64 =
            mesh.vertices().map(|v| masses[v] * (u[v.index()] - x2[v.index()]).powi(2)).sum();
        solutions.push(square.sqrt());
        let lx = l.product(&x2);
        let error = |v: VertexId| (lx[v.index()] / masses[v] - (6.0 * x2[v.index()] - 2.0)).abs();
        values.push(mesh.vertices().map(error).fold(0.0, f64::max));
    }
    let order = (solutions[1] / solutions[2]).log2();
    assert!((order - 2.0).abs() < 0.05, "{solutions:?}");
    for (found, expected) in solutions.iter().zip([1.5e-3, 3.7e-4, 9.3e-5]) {
        // The oracle may divide by the area: 4π.
        let relative = found / (4.0 * PI).sqrt();
        assert!(
            (found / expected - 1.0).abs() < 0.05 || (relative / expected - 1.0).abs() < 0.05,
            "{solutions:?}"
        );
    }
    for (found, expected) in values.iter().zip([0.322, 0.337, 0.340]) {
        assert!((found / expected - 1.0).abs() < 0.01, "{values:?}");
    }
}

#[cfg(feature = "rayon")]
#[test]
fn threads_change_no_bit() {
    let mesh = shapes::with_noise(shapes::icosphere(5).unwrap(), 0.1, 2).unwrap();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (all(&mesh), mass_matrix(&mesh, MassKind::Galerkin).unwrap()))
    };
    let one = run(1);
    assert!(one == run(2) && one == run(8));
}

#[test]
fn rows_are_sorted_whatever_the_order_of_the_edges() {
    // An edited mesh numbers its edges as they were made.
    let mut mesh = shapes::icosphere(2).unwrap();
    let mut editor = Editor::new(&mut mesh);
    for e in [7, 40, 100, 3] {
        editor.flip(EdgeId::new(e)).unwrap();
    }
    let _ = editor.finish();
    let l = uniform_laplacian(&mesh).unwrap();
    let dense = |i: usize, j: usize| {
        let (v, w) = (VertexId::new(i), VertexId::new(j));
        if i == j { mesh.valence(v) as f64 } else { -f64::from(mesh.are_adjacent(v, w)) }
    };
    for i in 0..mesh.vertex_count() {
        for j in 0..mesh.vertex_count() {
            assert_eq!(l.get(i, j), dense(i, j), "{i} {j}");
        }
    }
}
