//! Spectra, heat and functional maps of surfaces that are known, with their orders of convergence.

use std::f64::consts::{PI, TAU};

use dgp_mesh::{DVec3, Mesh, Progress, VertexId, VertexMap, shapes};
use dgp_sparse::{EigenOptions, Mass, SparseMatrix, eigenpairs};

use super::*;
use crate::{
    flow::HeatFlow,
    intrinsic::{IntrinsicLaplacian, IntrinsicOptions, intrinsic_delaunay},
    laplacian::{MassKind, cotangent_laplacian, mass_matrix, vertex_masses},
    test_shapes,
};

fn basis_of(laplacian: &SparseMatrix, masses: &VertexMap<f64>, count: usize) -> Eigenbasis {
    Eigenbasis::new(laplacian, masses, count, &EigenOptions::default(), Progress::NONE).unwrap()
}

fn cotangent_basis(mesh: &Mesh, count: usize) -> Eigenbasis {
    basis_of(&cotangent_laplacian(mesh).unwrap(), &vertex_masses(mesh), count)
}

/// λ/l(l + 1) − 1 for the 2l + 1 eigenvalues of each l from 1 on: the least and the largest.
fn sphere_errors(values: &[f64]) -> Vec<[f64; 2]> {
    let most = (values.len() as f64).sqrt() as usize;
    (1..most)
        .map(|l| {
            let errors = values[l * l..(l + 1) * (l + 1)].iter();
            let errors = errors.map(|value| value / (l * (l + 1)) as f64 - 1.0);
            errors.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], e| {
                [low.min(e), high.max(e)]
            })
        })
        .collect()
}

/// λ = l(l + 1) with multiplicity 2l + 1: row 1 of the oracles, whose numbers are those of this construction.
#[test]
fn spheres_have_the_spectrum_of_the_sphere() {
    let errors: Vec<Vec<[f64; 2]>> = [4, 5]
        .map(|level| {
            let mesh = shapes::icosphere(level).unwrap();
            sphere_errors(cotangent_basis(&mesh, 49).values())
        })
        .into();
    let known = [
        [3.2e-7, 1.42e-3, 3.6e-3, 6.7e-3, 1.19e-2, 1.57e-2],
        [2.4e-8, 3.6e-4, 9.1e-4, 1.7e-3, 3.0e-3, 3.9e-3],
    ];
    for (errors, known) in errors.iter().zip(known) {
        for (error, expected) in errors.iter().zip(known) {
            // Two digits are given; lumping makes all eigenvalues too small.
            assert!((-error[0] / expected - 1.0).abs() < 0.03 && error[1] < 0.0, "{errors:?}");
        }
    }
    let factor = |l: usize| errors[0][l - 1][0] / errors[1][l - 1][0];
    assert!((factor(1) - 13.0).abs() < 1.0, "l = 1 converges faster: {}", factor(1));
    assert!((2..=6).all(|l| (factor(l).log2() - 2.0).abs() < 0.05), "order 2: {errors:?}");
}

/// Row 2 of the oracles: eigenvalues of finite elements are too large, and a symmetry of the icosahedron keeps what
/// belongs to l = 1 and l = 2 together.
#[test]
fn finite_elements_have_it_from_above_and_keep_its_symmetry() {
    let found: Vec<Vec<f64>> = [3, 4, 5]
        .map(|level| {
            let mesh = shapes::icosphere(level).unwrap();
            let l = cotangent_laplacian(&mesh).unwrap();
            let mass = mass_matrix(&mesh, MassKind::Galerkin).unwrap();
            let options = EigenOptions::default();
            let progress = dgp_sparse::Progress::NONE;
            eigenpairs(&l, Mass::Matrix(&mass), 49, &options, progress).unwrap().values
        })
        .into();
    let errors: Vec<Vec<[f64; 2]>> = found.iter().map(|values| sphere_errors(values)).collect();
    let known = [3.6e-4, 7.3e-4, 1.3e-3, 2.0e-3, 3.2e-3, 4.1e-3];
    for (error, expected) in errors[2].iter().zip(known) {
        assert!((error[1] / expected - 1.0).abs() < 0.03 && error[0] > 0.0, "{:?}", errors[2]);
    }
    for (coarse, fine) in errors[1].iter().zip(&errors[2]) {
        let order = (coarse[1] / fine[1]).log2();
        assert!((order - 2.0).abs() < 0.05, "{order}: {coarse:?} {fine:?}");
    }
    for errors in &errors[..2] {
        assert!((0..2).all(|l| errors[l][1] - errors[l][0] < 1e-14), "{errors:?}");
        assert!(errors[2][1] - errors[2][0] > 1e-5, "l = 3 splits: {errors:?}");
    }
}

/// Rows 1 and 4 of the oracles on uneven spheres with intrinsic Delaunay triangles: solutions and eigenvalues
/// converge with order 2, values at single vertices do not converge.
#[test]
fn the_intrinsic_laplacian_of_uneven_spheres_converges() {
    let mut errors = [(); 6].map(|()| Vec::new());
    for level in 2..=5 {
        let mut mesh = shapes::with_noise(shapes::icosphere(level).unwrap(), 0.15, 7).unwrap();
        mesh.set_positions(mesh.positions().map(|p| p.normalize()));
        let options = IntrinsicOptions::default();
        let IntrinsicLaplacian { laplacian, masses, .. } =
            intrinsic_delaunay(&mesh, &options, Progress::NONE).unwrap();
        // u − Δu = f for f = 7x² − 2 and u = x².
        let x2: Vec<f64> = mesh.positions().values().iter().map(|p| p.x * p.x).collect();
        let f: Vec<f64> = x2.iter().map(|x| 7.0 * x - 2.0).collect();
        let flow = HeatFlow::new(&laplacian, masses.values(), 1.0, Progress::NONE).unwrap();
        let u = flow.step(&f).unwrap();
        let square = |v: VertexId| masses[v] * (u[v.index()] - x2[v.index()]).powi(2);
        errors[0].push(mesh.vertices().map(square).sum::<f64>().sqrt());
        let lx = laplacian.product(&x2);
        let off = |v: VertexId| (lx[v.index()] / masses[v] - 6.0 * x2[v.index()] + 2.0).abs();
        errors[1].push(mesh.vertices().map(off).fold(0.0, f64::max));
        let spectrum = sphere_errors(basis_of(&laplacian, &masses, 25).values());
        (0..4).for_each(|l| errors[2 + l].push(-spectrum[l][0]));
    }
    let order = |errors: &[f64]| (errors[0] / errors[3]).log2() / 3.0;
    for k in [0, 3, 4, 5] {
        assert!((order(&errors[k]) - 2.0).abs() < 0.2, "{k}: {errors:?}");
    }
    assert!(errors[1][3] > errors[1][0], "values do not converge: {:?}", errors[1]);
}

fn flat_torus(n: usize) -> (SparseMatrix, VertexMap<f64>) {
    let flat = test_shapes::flat_torus(n);
    (flat.laplacian().unwrap(), flat.masses())
}

/// (4 − 2 cos(2πa/n) − 2 cos(2πb/n)) n², ascending.
fn flat_torus_spectrum(n: usize) -> Vec<f64> {
    let part = |a: usize| 2.0 - 2.0 * (TAU * a as f64 / n as f64).cos();
    let mut values: Vec<f64> =
        (0..n * n).map(|i| (part(i % n) + part(i / n)) * (n * n) as f64).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Row 3 of the oracles.
#[test]
fn flat_tori_have_the_spectrum_of_their_formula() {
    for (n, expected) in [(16, -1.28e-2), (32, -3.2e-3), (64, -8.0e-4)] {
        let (laplacian, masses) = flat_torus(n);
        let basis = basis_of(&laplacian, &masses, 21);
        let exact = flat_torus_spectrum(n);
        for (value, exact) in basis.values().iter().zip(&exact).skip(1) {
            assert!((value / exact - 1.0).abs() < 1e-12, "{n}: {value} {exact}");
        }
        let error = basis.values()[1] / (4.0 * PI * PI) - 1.0;
        assert!((error / expected - 1.0).abs() < 0.02, "{n}: {error}");
    }
}

/// Row 19 of the oracles: Σ (2l + 1)/4π e^(−l(l+1)t) on the sphere, the same at all points.
#[test]
fn heat_on_the_sphere_is_what_the_series_says() {
    let series = |time: f64| -> f64 {
        let term = |l: f64| (2.0 * l + 1.0) / (4.0 * PI) * (-l * (l + 1.0) * time).exp();
        (0..60).map(f64::from).map(term).sum()
    };
    for (time, value) in [(0.01, 7.984_326), (0.1, 0.822_841), (1.0, 0.112_876)] {
        assert!((series(time) - value).abs() < 1e-6, "{time}");
    }
    let mut found = [(); 2].map(|()| Vec::new());
    for level in [4, 5] {
        let mesh = shapes::icosphere(level).unwrap();
        let basis = cotangent_basis(&mesh, 121);
        for (found, time) in found.iter_mut().zip([0.1, 1.0]) {
            let diagonal = heat_kernel_diagonal(&basis, time).unwrap();
            let count = diagonal.len() as f64;
            let mean = diagonal.values().iter().sum::<f64>() / count;
            let square: f64 = diagonal.values().iter().map(|x| (x - mean).powi(2)).sum();
            found.push([mean / series(time) - 1.0, (square / count).sqrt() / series(time)]);
            let x = VertexId::new(7);
            let row = heat_kernel(&basis, time, x).unwrap();
            assert!((row[x] - diagonal[x]).abs() < 1e-12);
            let total: f64 = mesh.vertices().map(|v| basis.masses()[v] * row[v]).sum();
            assert!((total - 1.0).abs() < 1e-9);
        }
    }
    for (found, [mean, spread]) in found.iter().zip([[1.8e-3, 2.3e-4], [3.2e-4, 1.1e-5]]) {
        assert!((found[1][0] / mean - 1.0).abs() < 0.05, "mean: {found:?}");
        assert!((found[1][1] / spread - 1.0).abs() < 0.05, "spread: {found:?}");
        let orders = [0, 1].map(|k| (found[0][k] / found[1][k]).log2());
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "{orders:?}");
    }
}

/// The same on the flat torus: Σ e^(−4π²(a² + b²)t).
#[test]
fn heat_on_the_flat_torus_is_what_the_series_says() {
    let time = 0.05;
    let line: f64 = (-9..=9).map(|a| (-4.0 * PI * PI * f64::from(a * a) * time).exp()).sum();
    let exact = line * line;
    let mut errors = Vec::new();
    for n in [16, 32, 64] {
        let (laplacian, masses) = flat_torus(n);
        // The waves left out are below e^(−40).
        let basis = basis_of(&laplacian, &masses, 80);
        let diagonal = heat_kernel_diagonal(&basis, time).unwrap();
        let sum: f64 = flat_torus_spectrum(n).iter().map(|value| (-value * time).exp()).sum();
        assert!(diagonal.values().iter().all(|x| (x / sum - 1.0).abs() < 1e-10), "{n}");
        errors.push((sum / exact - 1.0).abs());
    }
    let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "{orders:?} {errors:?}");
}

#[test]
fn signatures_are_taken_over_the_times_of_the_waves() {
    let basis = cotangent_basis(&shapes::icosphere(3).unwrap(), 16);
    let times = signature_times(&basis, 5).unwrap();
    let last = basis.values()[15];
    assert!((times[0] * last / (4.0 * 10.0_f64.ln()) - 1.0).abs() < 1e-12);
    assert!((times[4] * basis.values()[1] / (4.0 * 10.0_f64.ln()) - 1.0).abs() < 1e-12);
    let ratio = times[1] / times[0];
    assert!(times.windows(2).all(|t| (t[1] / t[0] / ratio - 1.0).abs() < 1e-12), "{times:?}");
    let middle = signature_times(&basis, 1).unwrap();
    assert!((middle[0] / times[2] - 1.0).abs() < 1e-12);
    assert!(signature_times(&basis, 0).is_err());
    assert!(signature_times(&basis.truncated(1), 3).is_err(), "a constant knows no time");
    for time in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(heat_kernel_diagonal(&basis, time).is_err());
        assert!(heat_kernel(&basis, time, VertexId::new(0)).is_err());
    }
}

/// The vertex at the place where `map` takes each vertex.
fn moved_onto_itself(mesh: &Mesh, map: fn(DVec3) -> DVec3) -> VertexMap<VertexId> {
    mesh.map_vertices(|v| {
        let place = map(mesh.position(v));
        let found = mesh.vertices().find(|&w| mesh.position(w).distance(place) < 1e-9);
        found.expect("the mesh is symmetric")
    })
}

/// Row 31 of the oracles: an isometry permutes nothing but signs where eigenvalues are single.
#[test]
fn a_mirror_image_changes_signs_alone() {
    let mut mesh = shapes::icosphere(3).unwrap();
    mesh.set_positions(mesh.positions().map(|p| DVec3::new(p.x, 1.3 * p.y, 1.7 * p.z)));
    let basis = cotangent_basis(&mesh, 12);
    let mirrored = moved_onto_itself(&mesh, |p| DVec3::new(-p.x, p.y, p.z));
    let map = map_of_points(&basis, &basis, &mirrored);
    let mut signs = [0; 2];
    for i in 0..12 {
        for j in 0..12 {
            let entry = map.get(i, j);
            if i == j {
                assert!((entry.abs() - 1.0).abs() < 1e-8, "{i}: {entry}");
                signs[usize::from(entry < 0.0)] += 1;
            } else {
                assert!(entry.abs() < 1e-7, "{i} {j}: {entry}");
            }
        }
    }
    assert!(signs[0] >= 3 && signs[1] >= 3, "waves even and odd in x: {signs:?}");
}

/// … and mixes within eigenspaces where they are multiple; it keeps areas and commutes with the Laplacian.
#[test]
fn a_turn_of_the_sphere_mixes_within_eigenspaces_alone() {
    let mesh = shapes::icosphere(3).unwrap();
    // l = 1 to 2 whole, and l = 3 in the two parts that the icosahedron leaves of it.
    let basis = cotangent_basis(&mesh, 16);
    let turned = moved_onto_itself(&mesh, |p| DVec3::new(p.y, p.z, p.x));
    let map = map_of_points(&basis, &basis, &turned);
    assert!(map.orthogonality_defect() < 1e-10, "{}", map.orthogonality_defect());
    let largest = basis.values()[15];
    for i in 0..16 {
        for j in 0..16 {
            let gap = (basis.values()[i] - basis.values()[j]) / largest;
            assert!((map.get(i, j) * gap).abs() < 1e-10, "{i} {j}");
        }
    }
    let inside: f64 = (1..4).map(|i| map.get(i, i).abs()).sum();
    assert!(inside < 2.9, "coordinates are exchanged: {inside}");
}

/// … and a conformal map keeps the energy of every function, but not areas: pulled back from a sphere by a
/// Möbius transformation that doubles lengths at one pole, smooth functions have the energy they had, up to
/// an error of second order.
#[test]
fn a_conformal_map_keeps_energies_alone() {
    // Stereographic coordinates times k: z becomes ((1 + z)k² − (1 − z)) / ((1 + z)k² + (1 − z)).
    let moebius = |p: DVec3| {
        let (up, down) = (4.0 * (1.0 + p.z), 1.0 - p.z);
        let sum = up + down;
        DVec3::new(4.0 * p.x, 4.0 * p.y, up - down) / sum
    };
    let functions: [fn(DVec3) -> f64; 4] = [|p| p.x, |p| p.z, |p| p.x * p.y, |p| p.z * p.z];
    let mut errors = Vec::new();
    for level in [3, 4, 5] {
        let mesh = shapes::icosphere(level).unwrap();
        let mut image = mesh.clone();
        image.set_positions(mesh.positions().map(|&p| moebius(p)));
        let (masses, of_image) = (vertex_masses(&mesh), vertex_masses(&image));
        let energy = |mesh: &Mesh, values: &[f64]| {
            let laplacian = cotangent_laplacian(mesh).unwrap();
            let product = laplacian.product(values);
            values.iter().zip(product).map(|(x, y)| x * y).sum::<f64>()
        };
        let mut worst = 0.0_f64;
        for function in functions {
            let values: Vec<f64> =
                image.positions().values().iter().map(|&p| function(p)).collect();
            let [there, here] = [&image, &mesh].map(|mesh| energy(mesh, &values));
            worst = worst.max((here / there - 1.0).abs());
        }
        let stretch = mesh.vertices().map(|v| of_image[v] / masses[v]);
        let [least, most] = stretch.fold([f64::INFINITY, 0.0], |[a, b], x| [a.min(x), b.max(x)]);
        assert!(least < 0.3 && most > 3.0, "areas are not kept: {least} to {most}");
        errors.push(worst);
    }
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.3, "{errors:?}");
    }
}

/// A map that keeps areas and not lengths: orthogonal, but it does not commute.
#[test]
fn a_shear_of_the_torus_keeps_areas_alone() {
    let n = 6;
    let (laplacian, masses) = flat_torus(n);
    let basis = basis_of(&laplacian, &masses, n * n);
    let sheared = VertexMap::from_fn(n * n, |v: VertexId| {
        let (i, j) = (v.index() % n, v.index() / n);
        VertexId::new((i + j) % n + n * j)
    });
    let map = map_of_points(&basis, &basis, &sheared);
    assert!(map.orthogonality_defect() < 1e-10);
    let mut worst = 0.0_f64;
    for i in 0..n * n {
        for j in 0..n * n {
            let gap = (basis.values()[i] - basis.values()[j]) / basis.values()[n * n - 1];
            worst = worst.max((map.get(i, j) * gap).abs());
        }
    }
    assert!(worst > 0.1, "{worst}");
}
