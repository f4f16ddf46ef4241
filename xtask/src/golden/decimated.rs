//! Decimated meshes beside those of OpenMesh and CGAL: no vertex is the same, so that what counts is how far the
//! results are from the input.
//!
//! Ours may be farther than the peer's by the share that stands here and no more. `worst` in the table is our
//! distance over what is allowed.

use std::{fs, path::Path};

use dgp_mesh::{IndexedFaceSet, shapes};

use super::{Comparison, Table, Verdict};
use crate::{
    bench::{decimation::quality, measure::Quality},
    peers::{Driver, Peers},
    raw,
    shell::Outcome,
};

/// How much of the peer's mean distance ours may be.
const MEAN: f64 = 1.05;
/// How much of the peer's largest distance ours may be.
const LARGEST: f64 = 1.25;

fn inputs() -> Outcome<Vec<(&'static str, IndexedFaceSet)>> {
    let sphere = shapes::with_noise(shapes::icosphere(5)?, 0.005, 5)?;
    let holed = shapes::with_holes(&shapes::icosphere(5)?, 4, 1, 3)?;
    Ok(vec![
        ("noisy sphere", sphere.to_indexed()),
        ("holed sphere", holed.to_indexed()),
        ("blob", shapes::blob(5)?.to_indexed()),
        ("torus", shapes::torus(2.0, 0.7, 120, 60)?.to_indexed()),
        ("genus 3", shapes::surface_of_genus(3, 4)?.to_indexed()),
    ])
}

/// Compares on all inputs, decimated to a tenth, and notes it in the table.
pub(super) fn compare(peers: &Peers, folder: &Path, table: &mut Table) -> Outcome<()> {
    for (name, set) in inputs()? {
        let path = folder.join("decimated.raw");
        raw::write(&path, &set)?;
        let of = |driver: &Driver, scheme: &str| -> Outcome<Quality> {
            let out = folder.join("decimated-result");
            let levels = (set.face_count() / 10).to_string();
            let options =
                ["--scheme", scheme, "--levels", &levels, "--out", &out.to_string_lossy()];
            driver.call("decimate", &path, &options)?;
            let result = out.with_extension("raw");
            let found = quality(&set, &raw::read(&result)?)?;
            fs::remove_file(result)?;
            Ok(found)
        };
        let ours = of(&Driver::ours()?, "quadric")?;
        for (peer, driver, scheme) in [
            ("OpenMesh", &peers.openmesh, "quadric"),
            ("CGAL", &peers.cgal, "lindstrom-turk"),
            ("CGAL", &peers.cgal, "garland-heckbert"),
        ] {
            let theirs = of(driver, scheme)?;
            let input = format!("{name}, {scheme}");
            let means = judge("decimated_mean", ours.mean, theirs.mean * MEAN);
            let largest = judge("decimated_largest", ours.largest, theirs.largest * LARGEST);
            table.add(&input, peer, vec![means, largest]);
        }
        fs::remove_file(path)?;
    }
    Ok(())
}

fn judge(quantity: &str, ours: f64, allowed: f64) -> Comparison {
    let worst = ours / allowed;
    let verdict = if worst <= 1.0 {
        Verdict::Same
    } else {
        Verdict::Differs(format!("{ours:e} of the diagonal, and {allowed:e} are allowed"))
    };
    Comparison { quantity: quantity.into(), compared: 1, left_out: 0, worst, verdict }
}
