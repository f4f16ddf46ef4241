//! Decimation to a tenth and a hundredth of the faces: time and distance to the input in one row.
//!
//! Distances are those of the last result of each driver from the input and back: of the two means, root mean
//! squares and largest distances found the larger, in units of the input's diagonal.

use std::{fs, path::Path, time::Duration};

use dgp_mesh::{
    IndexedFaceSet, Progress,
    spatial::{DeviationOptions, HausdorffOptions, TriangleTree, deviation, hausdorff},
};

use super::{
    Effort,
    inputs::{Input, Purpose},
    measure::{Quality, Row, Series},
};
use crate::{
    data,
    peers::{Driver, Peers},
    raw,
    shell::Outcome,
};

/// The cases: a name, what it is, and one face in how many is left.
const CASES: [(&str, &str, usize); 2] = [
    ("decimate-10", "triangles decimated to a tenth", 10),
    ("decimate-1", "triangles decimated to a hundredth", 100),
];

/// How long a driver may take.
const PATIENCE: Duration = Duration::from_secs(600);

/// Real meshes that are decimated where they are there.
const REAL: [&str; 6] = [
    "data/meshes/armadillo.off",
    "closed/armadillo_29k.obj",
    "closed/lucy_100k.ply",
    "closed/igea_269k.ply",
    "closed/elephant_40k.off",
    "closed/fandisk.off",
];

/// The inputs that are only decimated.
pub(super) fn inputs(effort: Effort, folder: &Path) -> Outcome<Vec<Input>> {
    let mut inputs = Vec::new();
    if effort == Effort::Quick {
        return Ok(inputs);
    }
    let folders: Vec<_> = data::unpack().into_iter().chain(data::shared()).collect();
    for (place, file) in folders.iter().flat_map(|place| REAL.iter().map(move |f| (place, f))) {
        let Ok(document) = dgp_io::read(place.join(file)) else { continue };
        let name = Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let raw = folder.join(format!("{name}.raw"));
        raw::write(&raw, &document.set)?;
        inputs.push(Input {
            name,
            triangles: document.set.face_count(),
            soup: raw.clone(),
            raw,
            files: None,
            purpose: Purpose::Decimation,
        });
    }
    Ok(inputs)
}

/// Both cases on one input, if they are among those wanted and the input is for them.
pub(super) fn rows(
    input: &Input,
    peers: &Peers,
    effort: Effort,
    folder: &Path,
    is_wanted: impl Fn(&str) -> bool,
) -> Outcome<Vec<Row>> {
    let is_meant = matches!(input.purpose, Purpose::Decimation)
        || matches!(input.purpose, Purpose::Any) && input.files.is_some();
    let wanted = CASES.iter().filter(|(name, ..)| is_meant && is_wanted(name));
    wanted
        .map(|&(name, what, part)| row(input, peers, effort, folder, (name, what, part)))
        .collect()
}

fn drivers(peers: &Peers) -> Outcome<Vec<(Driver, &'static str)>> {
    let ours = Driver::ours()?;
    let mut drivers = vec![
        (ours.clone(), "quadric"),
        (ours.named("dgp, passes".into()), "quadric-passes"),
        (ours.named("dgp, fast".into()), "quadric-fast"),
        (peers.openmesh.clone(), "quadric"),
        (peers.cgal.named("CGAL Lindstrom–Turk".into()), "lindstrom-turk"),
        (peers.cgal.named("CGAL Garland–Heckbert".into()), "garland-heckbert"),
    ];
    if cfg!(feature = "meshoptimizer") {
        drivers.push((ours.named("meshoptimizer".into()), "meshoptimizer"));
    } else {
        eprintln!("without meshoptimizer: run with `--features meshoptimizer`, which needs g++");
    }
    Ok(drivers)
}

fn row(
    input: &Input,
    peers: &Peers,
    effort: Effort,
    folder: &Path,
    (case, what, part): (&'static str, &'static str, usize),
) -> Outcome<Row> {
    let (rounds, repeat) = match effort {
        Effort::Quick => (1, "1"),
        Effort::Full if input.triangles > 200_000 => (3, "1"),
        Effort::Full => (5, "1"),
    };
    let levels = (input.triangles / part).to_string();
    let drivers = drivers(peers)?;
    let out = |k: usize| folder.join(format!("decimated-{k}"));
    let mut series: Vec<Series> = drivers.iter().map(|_| Series::default()).collect();
    let mut failures = Vec::new();
    for round in 0..rounds {
        for (k, ((driver, scheme), series)) in drivers.iter().zip(&mut series).enumerate() {
            let out = out(k).to_string_lossy().into_owned();
            let options =
                ["--repeat", repeat, "--scheme", scheme, "--levels", &levels, "--out", &out];
            match driver.clone().within(PATIENCE).call("decimate", &input.raw, &options) {
                Ok(answer) => series.add_time(&answer),
                Err(error) if round == 0 => failures.push(format!("{}: {error}", driver.name)),
                Err(_) => {}
            }
        }
    }
    let original = raw::read(&input.raw)?;
    for (k, series) in series.iter_mut().enumerate() {
        let path = out(k).with_extension("raw");
        if path.exists() {
            series.quality = Some(quality(&original, &raw::read(&path)?)?);
            fs::remove_file(path)?;
        }
    }
    let mut series = series.into_iter();
    let row = Row {
        case,
        what,
        input: input.name.clone(),
        triangles: input.triangles,
        unit: "ms",
        ours: series.next().unwrap_or_default(),
        peers: drivers.into_iter().skip(1).map(|(driver, _)| driver.name).zip(series).collect(),
        failures,
    };
    row.print();
    Ok(row)
}

/// How far the result is from the input, both ways.
pub(crate) fn quality(input: &IndexedFaceSet, result: &IndexedFaceSet) -> Outcome<Quality> {
    let [a, b] =
        [TriangleTree::new(input, Progress::NONE)?, TriangleTree::new(result, Progress::NONE)?];
    let diagonal = a.bounding_box().map_or(1.0, |bounds| bounds.diagonal());
    let options = DeviationOptions { samples: 300_000 };
    let [there, back] = [
        deviation(&a, &b, &options, Progress::NONE)?,
        deviation(&b, &a, &options, Progress::NONE)?,
    ];
    let options = HausdorffOptions { tolerance: 1e-5, queries: 3_000_000 };
    let bounds = hausdorff(&a, &b, &options, Progress::NONE)?;
    Ok(Quality {
        faces: result.face_count(),
        mean: there.mean.max(back.mean) / diagonal,
        rms: there.rms.max(back.rms) / diagonal,
        largest: bounds.lower() / diagonal,
    })
}
