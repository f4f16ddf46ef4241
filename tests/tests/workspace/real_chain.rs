//! Real files through what a user does first: say what is wrong, mend, smooth, draw. Files of up to two
//! megabytes, where the machine has them; whatever is in them, each step ends in a valid result or an
//! error.

use std::{
    fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use dgp_laplace::smooth::{TaubinOptions, UniformOptions, taubin, uniform};
use dgp_mesh::{
    IndexedFaceSet, Mesh, Progress, RepairOptions, VertexSet, curvature, defects, repair,
};
use dgp_tests::data;
use dgp_view::{Model, RenderOptions, Scene, Shape, render};

const LARGEST: u64 = 2_000_000;

#[test]
fn real_files_are_judged_mended_smoothed_and_drawn() {
    let folders = [data::shared(), data::debian()];
    if folders.iter().all(Option::is_none) {
        eprintln!("skipped: no real data; set DGP_SHARED_DATA to their folder");
        return;
    }
    let (mut tried, mut failures) = (0, Vec::new());
    for path in folders.iter().flatten().flat_map(|folder| data::files(folder)) {
        if fs::metadata(&path).is_ok_and(|file| file.len() > LARGEST) {
            continue;
        }
        // Which files are refused, and why, is another test's business.
        let Ok(document) = dgp_io::read(&path) else { continue };
        tried += 1;
        let chain = catch_unwind(AssertUnwindSafe(|| chain(&document.set)));
        match chain {
            Ok(Ok(())) => {}
            Ok(Err(failure)) => failures.push(told(&path, &failure)),
            Err(_) => failures.push(told(&path, "panics")),
        }
    }
    eprintln!("{tried} files tried");
    assert!(tried > 0 && failures.is_empty(), "{}", failures.join("\n"));
}

fn told(path: &Path, failure: &str) -> String {
    format!("{}: {failure}", path.display())
}

/// All steps; an error tells the promise that was broken.
fn chain(set: &IndexedFaceSet) -> Result<(), String> {
    let report = defects(set, Progress::NONE).map_err(|error| error.to_string())?;
    if report.is_manifold() != Mesh::new(set).is_ok() {
        return Err(format!("the report does not say whether it is a mesh: {report}"));
    }
    let options = RepairOptions::default();
    let (mesh, _) = repair(set, &options, Progress::NONE).map_err(|error| error.to_string())?;
    mesh.validate().map_err(|error| format!("repaired: {error}"))?;
    let mended = mesh.to_indexed();
    let report = defects(&mended, Progress::NONE).map_err(|error| error.to_string())?;
    if !report.is_manifold() {
        return Err(format!("repaired, and still: {report}"));
    }
    for is_taubin in [false, true] {
        smoothing_moves_vertices_only(&mesh, is_taubin)?;
    }
    // Polygons and faces without area have none, and say so.
    if let Ok(angles) = curvature::angle_defects(&mesh)
        && let Some((v, angle)) = angles.iter().find(|(_, angle)| !angle.is_finite())
    {
        return Err(format!("the angle defect of {v} is {angle}"));
    }
    let small = RenderOptions { width: 64, height: 48, ..RenderOptions::default() };
    for shape in [Shape::Faces(set), Shape::Mesh(&mesh)] {
        let scene = Scene::new(Model::new(shape));
        let (image, _) =
            render(&scene, &small, Progress::NONE).map_err(|error| error.to_string())?;
        if (image.width(), image.height()) != (64, 48) {
            return Err(format!("a picture of {} × {}", image.width(), image.height()));
        }
    }
    Ok(())
}

/// An error, such as for a mesh whose weights mean nothing, must leave the mesh as it was.
fn smoothing_moves_vertices_only(before: &Mesh, is_taubin: bool) -> Result<(), String> {
    let mut mesh = before.clone();
    let (fixed, progress) = (VertexSet::new(), Progress::NONE);
    let result = if is_taubin {
        taubin(&mut mesh, &fixed, &TaubinOptions::default(), progress).map(drop)
    } else {
        uniform(&mut mesh, &fixed, &UniformOptions::default(), progress).map(drop)
    };
    if let Err(error) = result {
        return if mesh == *before { Ok(()) } else { Err(format!("changed in spite of: {error}")) };
    }
    if mesh.connectivity() != before.connectivity() {
        return Err("smoothing changed the faces".into());
    }
    match mesh.positions().iter().find(|(_, p)| !p.is_finite()) {
        Some((v, p)) => Err(format!("smoothing moves {v} to {p}")),
        None => Ok(()),
    }
}
