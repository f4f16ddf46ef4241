//! Smoothing on the real meshes that the field shows it on. Where there are no real data, the tests say so and
//! check nothing.

use std::path::Path;

use dgp_laplace::smooth::{BilateralOptions, TaubinOptions, bilateral, taubin};
use dgp_mesh::{EdgeId, FaceId, Mesh, Progress, VertexSet, shapes};
use dgp_tests::data;

/// The mesh in this file of the real data.
fn mesh(file: &str) -> Option<Mesh> {
    let Some(folder) = data::shared() else {
        eprintln!("skipped: no real data; set DGP_SHARED_DATA to their folder");
        return None;
    };
    let path = folder.join(Path::new(file));
    let document = dgp_io::read(&path).unwrap_or_else(|error| panic!("{error}"));
    Some(Mesh::new(&document.set).unwrap_or_else(|error| panic!("{file}: {error}")))
}

fn radius_and_noise(mesh: &Mesh) -> (f64, f64) {
    let radii = mesh.positions().map(|p| p.length());
    let count = radii.len() as f64;
    let radius = radii.values().iter().sum::<f64>() / count;
    let square: f64 = radii.values().iter().map(|r| (r - radius).powi(2)).sum();
    (radius, (square / count).sqrt())
}

#[test]
fn taubin_smooths_the_noisy_sphere_and_keeps_its_volume() {
    let Some(noisy) = mesh("closed/sphere-noisy.obj") else { return };
    let (_, before) = radius_and_noise(&noisy);
    let mut smooth = noisy.clone();
    let options = TaubinOptions { iterations: 20, ..TaubinOptions::default() };
    let report = taubin(&mut smooth, &VertexSet::new(), &options, Progress::NONE).unwrap();
    let (_, after) = radius_and_noise(&smooth);
    let volume = report.volume_after.unwrap() / report.volume_before.unwrap();
    eprintln!("noise {before:.5} → {after:.5}, by {:.2}; volume × {volume:.5}", before / after);
    assert!(after < before / 3.0, "{before} → {after}");
    assert!((volume - 1.0).abs() < 0.01, "{volume}");
}

/// A mesh beside the clean one, in degrees: mean angle between normals, the same at faces with a sharp edge, and
/// which part of the sharp edges has kept more than half its angle.
#[derive(Debug)]
struct State {
    everywhere: f64,
    at_edges: f64,
    kept: f64,
}

fn state(mesh: &Mesh, clean: &Mesh, sharp: &[EdgeId]) -> State {
    let error = |f: FaceId| mesh.face_normal(f).angle_between(clean.face_normal(f)).to_degrees();
    let mean = |faces: &[FaceId]| faces.iter().map(|&f| error(f)).sum::<f64>() / faces.len() as f64;
    let mut beside: Vec<FaceId> =
        sharp.iter().flat_map(|&e| clean.edge_faces(e)).flatten().collect();
    beside.sort_unstable();
    beside.dedup();
    let angle = |mesh: &Mesh, e: EdgeId| mesh.dihedral_angle(e).unwrap_or(0.0);
    let kept = sharp.iter().filter(|&&e| angle(mesh, e) / angle(clean, e) > 0.5).count();
    State {
        everywhere: mean(&clean.faces().collect::<Vec<_>>()),
        at_edges: mean(&beside),
        kept: kept as f64 / sharp.len() as f64,
    }
}

#[test]
fn bilateral_filtering_keeps_the_edges_of_a_noisy_fandisk() {
    let Some(clean) = mesh("closed/fandisk.off") else { return };
    // More than 34°: far above what its smooth parts have between faces.
    let is_sharp = |e: &EdgeId| clean.dihedral_angle(*e).is_some_and(|angle| angle.abs() > 0.6);
    let sharp: Vec<EdgeId> = clean.edges().filter(is_sharp).collect();
    let noisy = shapes::with_noise(clean.clone(), 0.1, 1).unwrap();
    let before = state(&noisy, &clean, &sharp);
    let none = VertexSet::new();
    let mut filtered = noisy.clone();
    let options = BilateralOptions::default();
    let _ = bilateral(&mut filtered, &none, &options, Progress::NONE).unwrap();
    let filtered = state(&filtered, &clean, &sharp);
    let mut rounded = noisy.clone();
    let _ = taubin(&mut rounded, &none, &TaubinOptions::default(), Progress::NONE).unwrap();
    let rounded = state(&rounded, &clean, &sharp);
    eprintln!(
        "{} sharp edges; noisy {before:?}\nbilateral {filtered:?}\nTaubin {rounded:?}",
        sharp.len()
    );
    // The mean over a face and the dozen around it leaves 1/√13 of the noise of their normals.
    assert!(filtered.everywhere < before.everywhere / 13.0_f64.sqrt(), "{filtered:?}");
    // An edge that is rounded, if by no more than one row of faces, has half its angle and turns the normals beside
    // it by a quarter: by 8.6° or more at 34.4°. That is what filters do that know no edges.
    assert!(filtered.kept > 0.95 && filtered.at_edges < 0.25 * before.at_edges, "{filtered:?}");
    assert!(rounded.kept < 0.7 && rounded.at_edges > 8.6, "{rounded:?}");
}
