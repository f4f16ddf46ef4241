//! Isotropic remeshing beside CGAL's: as many triangles, the same number of iterations, by the figures of the results.
//!
//! Remeshing has no one answer, so what is compared is how good it is: ours must not be worse. Angles are those
//! that the smallest of a triangle is below in one of a hundred triangles, and in the mean; distances are those of the
//! result to the input and back, the root mean square being the larger of both.

use std::{fs, path::Path};

use dgp_mesh::{IndexedFaceSet, shapes};

use super::{Comparison, Table, Verdict};
use crate::{
    data,
    peers::{Driver, Peers},
    raw,
    shell::Outcome,
};

/// An input, how it is remeshed, and at which percentage of its mean edge.
struct Case {
    name: String,
    set: IndexedFaceSet,
    scheme: &'static str,
    percent: u32,
}

fn cases() -> Outcome<Vec<Case>> {
    let mut cases = Vec::new();
    let mut add = |name: &str, set: IndexedFaceSet, scheme, percents: &[u32]| {
        for &percent in percents {
            let name = format!("{name} {percent} %");
            cases.push(Case { name, set: set.clone(), scheme, percent });
        }
    };
    let sphere = shapes::with_noise(shapes::icosphere(5)?, 0.005, 3)?;
    add("noisy sphere", sphere.to_indexed(), "free", &[100, 150, 60]);
    add("torus", shapes::torus(2.0, 0.7, 120, 60)?.to_indexed(), "free", &[100, 200]);
    if let Some(folder) = data::shared() {
        for (name, scheme) in [
            ("fandisk.off", "sharp"),
            ("armadillo_29k.obj", "free"),
            ("bunny_7k.off", "free"),
            ("igea_269k.ply", "free"),
        ] {
            if let Ok(document) = dgp_io::read(folder.join("closed").join(name)) {
                add(name, document.set, scheme, &[100]);
            }
        }
    }
    Ok(cases)
}

/// The figures of one result.
struct Figures {
    faces: f64,
    least: f64,
    low: f64,
    mean: f64,
    regular: f64,
    rms: f64,
    hausdorff: f64,
    milliseconds: f64,
}

/// Compares on all inputs, prints the figures, and notes them in the table.
pub(super) fn compare(peers: &Peers, folder: &Path, table: &mut Table) -> Outcome<()> {
    println!(
        "{:24} {:6} {:>8} {:>7} {:>7} {:>7} {:>8} {:>10} {:>10} {:>8}",
        "remeshing",
        "",
        "faces",
        "least °",
        "1 % °",
        "mean °",
        "valence6",
        "rms",
        "Hausdorff",
        "ms"
    );
    for case in cases()? {
        let path = folder.join("remeshing.raw");
        raw::write(&path, &case.set)?;
        let theirs = figures(&peers.cgal, &case, case.percent, &path)?;
        // CGAL's edges come out shorter than asked for: ours get the length that gives as many triangles.
        let driver = Driver::ours()?;
        let first = figures(&driver, &case, case.percent, &path)?;
        let percent = f64::from(case.percent) * (first.faces / theirs.faces).sqrt();
        let ours = figures(&driver, &case, percent.round() as u32, &path)?;
        for (name, figures) in [("dgp", &ours), ("CGAL", &theirs)] {
            println!(
                "{:24} {name:6} {:8} {:7.2} {:7.2} {:7.2} {:8.4} {:10.3e} {:10.3e} {:8.1}",
                case.name,
                figures.faces,
                figures.least,
                figures.low,
                figures.mean,
                figures.regular,
                figures.rms,
                figures.hausdorff,
                figures.milliseconds,
            );
        }
        let judge = |quantity: &str, worse: f64, allowed: f64, pair: [f64; 2]| {
            let verdict = if worse <= allowed {
                Verdict::Same
            } else {
                Verdict::Differs(format!("{} and {}", pair[0], pair[1]))
            };
            let worst = (worse / allowed).max(0.0);
            let quantity = quantity.to_owned();
            Comparison { quantity, compared: 1, left_out: 0, worst, verdict }
        };
        let less = |a: f64, b: f64| b - a;
        let more = |a: f64, b: f64| a / b - 1.0;
        let comparisons = vec![
            judge("remeshed_low_angle", less(ours.low, theirs.low), 0.5, [ours.low, theirs.low]),
            judge(
                "remeshed_mean_angle",
                less(ours.mean, theirs.mean),
                0.5,
                [ours.mean, theirs.mean],
            ),
            judge(
                "remeshed_regular",
                less(ours.regular, theirs.regular),
                0.01,
                [ours.regular, theirs.regular],
            ),
            judge("remeshed_rms", more(ours.rms, theirs.rms), 0.05, [ours.rms, theirs.rms]),
            judge(
                "remeshed_hausdorff",
                more(ours.hausdorff, theirs.hausdorff),
                0.1,
                [ours.hausdorff, theirs.hausdorff],
            ),
        ];
        table.add(&case.name, "CGAL", comparisons);
        fs::remove_file(path)?;
    }
    Ok(())
}

fn figures(driver: &Driver, case: &Case, percent: u32, path: &Path) -> Outcome<Figures> {
    let result = path.with_file_name("remeshed.raw");
    let out = path.with_file_name("remeshed");
    let out = out.to_string_lossy();
    let percent = percent.to_string();
    let options = [
        "--scheme",
        case.scheme,
        "--levels",
        percent.as_str(),
        "--out",
        out.as_ref(),
        "--repeat",
        "3",
    ];
    let answer = driver.call("remesh", path, &options)?;
    let times = answer["ms"].as_array().into_iter().flatten();
    let milliseconds = times.filter_map(serde_json::Value::as_f64).fold(f64::INFINITY, f64::min);
    let other = path.to_string_lossy();
    let found = Driver::ours()?.call("remeshed", &result, &["--other", other.as_ref()])?;
    fs::remove_file(result)?;
    let number = |name: &str| found[name].as_f64().unwrap_or(f64::NAN);
    Ok(Figures {
        faces: number("faces"),
        least: number("least"),
        low: number("low"),
        mean: number("mean"),
        regular: number("regular"),
        rms: number("rms"),
        hausdorff: number("hausdorff"),
        milliseconds,
    })
}
