//! Alternating runs and their medians.

use std::{collections::BTreeMap, fmt::Write, path::Path, time::Duration};

use serde_json::{Value, json};

use super::{
    Effort,
    cases::{Case, Data, Figure},
    inputs::{Input, Purpose},
};
use crate::peers::{Driver, Peers};

/// How long a driver may look for eigenpairs.
const PATIENCE: Duration = Duration::from_secs(900);

/// One case on one input.
pub(super) struct Row {
    pub(super) case: &'static str,
    pub(super) what: &'static str,
    pub(super) input: String,
    pub(super) triangles: usize,
    pub(super) unit: &'static str,
    pub(super) ours: Series,
    pub(super) peers: Vec<(String, Series)>,
    /// Why a driver has no figure.
    pub(super) failures: Vec<String>,
}

/// The figures of one driver, one per round.
#[derive(Default)]
pub(super) struct Series {
    values: Vec<f64>,
    processor: Vec<f64>,
    peak: Vec<f64>,
    pub(super) quality: Option<Quality>,
}

/// How far a result is from the input; distances in units of its diagonal.
#[derive(Clone, Copy)]
pub(crate) struct Quality {
    pub(crate) faces: usize,
    pub(crate) mean: f64,
    pub(crate) rms: f64,
    pub(crate) largest: f64,
}

/// Runs one case in alternation; `None` where the input is not made for it.
pub(super) fn case(
    case: &Case,
    input: &Input,
    peers: &Peers,
    effort: Effort,
    folder: &Path,
) -> Option<Row> {
    let (is_meant, levels) = match (input.purpose, case.data) {
        (Purpose::Refinement(cage, levels), Data::Cage(wanted)) => (cage == wanted, Some(levels)),
        (Purpose::Refinement(..) | Purpose::Decimation, _) | (_, Data::Cage(_)) => (false, None),
        (Purpose::Holes, data) => (matches!(data, Data::Holed), None),
        (_, Data::Holed) => (false, None),
        (Purpose::Solvers, _) => (case.handles, None),
        (Purpose::Any, _) => (true, None),
    };
    if !is_meant || input.triangles > case.largest {
        return None;
    }
    let (path, out) = match (case.data, &input.files) {
        (Data::Soup, _) => (input.soup.clone(), None),
        (Data::Raw | Data::Cage(_) | Data::Holed, _) => (input.raw.clone(), None),
        (Data::File(name), Some(files)) => (files.join(name), None),
        (Data::Output(name), Some(_)) => (input.raw.clone(), Some(folder.join(name))),
        (_, None) => return None,
    };
    let mut drivers = vec![(Driver::ours().ok()?, case.ours)];
    drivers.extend(case.openmesh.map(|operation| (peers.openmesh.clone(), operation)));
    drivers.extend(case.cgal.map(|operation| (peers.cgal.clone(), operation)));
    if let Some(cholmod) = &peers.cholmod {
        drivers.extend(
            case.cholmod
                .iter()
                .map(|&order| (cholmod.named(format!("{} {order}", cholmod.name)), order)),
        );
    }
    if let Some(opensubdiv) = &peers.opensubdiv {
        let named = |&(operation, name): &(_, &str)| (opensubdiv.named(name.into()), operation);
        drivers.extend(case.opensubdiv.iter().map(named));
    }
    if let (Some(scipy), Some(operation)) = (&peers.scipy, case.scipy) {
        drivers.push((scipy.clone(), operation));
    }
    for (driver, _) in &mut drivers {
        if case.scipy.is_some() {
            *driver = driver.clone().within(PATIENCE);
        }
        if case.one_thread {
            *driver = driver.clone().on_one_thread();
        }
    }

    let (rounds, repeat) = match effort {
        Effort::Quick => (1, "1"),
        Effort::Full if case.scipy.is_some() => (3, "1"),
        Effort::Full if input.triangles > 1_000_000 => (3, "2"),
        Effort::Full => (5, "3"),
    };
    let levels = levels.map(|levels| levels.to_string());
    let mut series: Vec<Series> = drivers.iter().map(|_| Series::default()).collect();
    let mut failures = BTreeMap::new();
    for _ in 0..rounds {
        for ((driver, operation), series) in drivers.iter().zip(&mut series) {
            let mut options = vec!["--repeat", repeat];
            if let (Some(scheme), Some(levels)) = (case.scheme, &levels) {
                options.extend(["--scheme", scheme, "--levels", levels]);
            }
            let out = out.as_ref().map(|path| path.to_string_lossy().into_owned());
            options.extend(out.iter().flat_map(|path| ["--out", path.as_str()]));
            match driver.call(operation, &path, &options) {
                Ok(answer) => series.add(case.figure, &answer, input.triangles),
                Err(error) => {
                    failures.insert(driver.name.clone(), error.to_string());
                }
            }
        }
    }
    if let Some(path) = out {
        // Nothing is there if every driver failed.
        let _ = std::fs::remove_file(path);
    }
    let mut series = series.into_iter();
    let ours = series.next().unwrap_or_default();
    let names = drivers.iter().skip(1).map(|(driver, _)| driver.name.clone());
    let row = Row {
        case: case.name,
        what: case.what,
        input: input.name.clone(),
        triangles: input.triangles,
        unit: match case.figure {
            Figure::Time => "ms",
            Figure::Bytes(_) => "B/triangle",
            Figure::Entries(_) => "entries/triangle",
        },
        ours,
        peers: names.zip(series).collect(),
        failures: failures.into_iter().map(|(name, error)| format!("{name}: {error}")).collect(),
    };
    row.print();
    Some(row)
}

impl Series {
    /// Takes the times of an answer.
    pub(super) fn add_time(&mut self, answer: &Value) {
        self.add(Figure::Time, answer, 1);
    }

    fn add(&mut self, figure: Figure, answer: &Value, triangles: usize) {
        let list = |name: &str| -> Vec<f64> {
            answer[name].as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
        };
        match figure {
            Figure::Time => {
                self.values.extend(median(&list("ms")));
                self.processor.extend(median(&list("cpu_ms")));
            }
            Figure::Bytes(name) | Figure::Entries(name) => {
                self.values.extend(answer[name].as_f64().map(|bytes| bytes / triangles as f64));
            }
        }
        self.peak.extend(answer["peak_bytes"].as_f64());
    }

    fn to_json(&self) -> Value {
        json!({
            "median": median(&self.values),
            "min": self.values.iter().copied().reduce(f64::min),
            "max": self.values.iter().copied().reduce(f64::max),
            "cpu": median(&self.processor),
            "peak_bytes": median(&self.peak),
            "quality": self.quality.map(|q| json!({
                "faces": q.faces, "mean": q.mean, "rms": q.rms, "largest": q.largest,
            })),
        })
    }
}

impl Row {
    /// Whether there is a figure of ours.
    pub(super) fn is_measured(&self) -> bool {
        !self.ours.values.is_empty()
    }

    fn ratios(&self, peer: &Series) -> Vec<f64> {
        peer.values.iter().zip(&self.ours.values).map(|(peer, ours)| peer / ours).collect()
    }

    pub(super) fn to_json(&self) -> Value {
        let peers = self.peers.iter().map(|(name, series)| {
            let ratios = self.ratios(series);
            let processor = series.processor.iter().zip(&self.ours.processor);
            let processor: Vec<f64> = processor.map(|(peer, ours)| peer / ours).collect();
            let mut value = series.to_json();
            value["name"] = json!(name);
            value["ratio"] = json!(median(&ratios));
            value["ratio_min"] = json!(ratios.iter().copied().reduce(f64::min));
            value["ratio_max"] = json!(ratios.iter().copied().reduce(f64::max));
            value["cpu_ratio"] = json!(median(&processor));
            value
        });
        json!({
            "case": self.case,
            "what": self.what,
            "input": self.input,
            "triangles": self.triangles,
            "unit": self.unit,
            "ours": self.ours.to_json(),
            "peers": peers.collect::<Vec<_>>(),
            "failures": self.failures,
        })
    }

    pub(super) fn print(&self) {
        let mut line = format!("{:16} {:24}", self.case, self.input);
        if let Some(ours) = median(&self.ours.values) {
            let _ = write!(line, " {ours:9.2} {}", self.unit);
        }
        if self.ours.quality.is_some() {
            println!("{line}");
            return self.print_qualities();
        }
        for (name, series) in &self.peers {
            if let (Some(value), Some(ratio)) =
                (median(&series.values), median(&self.ratios(series)))
            {
                let processor = match (median(&series.processor), median(&self.ours.processor)) {
                    (Some(peer), Some(ours)) => format!(", processor {:.2}×", peer / ours),
                    _ => String::new(),
                };
                let _ = write!(line, "  {name} {value:.2} ({ratio:.2}×{processor})");
            }
        }
        println!("{line}");
        for failure in &self.failures {
            println!("    no figure: {failure}");
        }
    }
}

impl Row {
    /// A line for each driver: times, and distances in 10⁻⁴ of the diagonal.
    fn print_qualities(&self) {
        let ours = ("dgp".to_owned(), &self.ours);
        let peers = self.peers.iter().map(|(name, series)| (name.clone(), series));
        for (name, series) in std::iter::once(ours).chain(peers) {
            let (Some(q), Some(ms)) = (series.quality, median(&series.values)) else { continue };
            let processor = median(&series.processor).unwrap_or_default();
            println!(
                "    {name:24} {ms:9.1} ms {processor:9.1} cpu ms {:8} faces   mean {:8.4}   rms {:8.4}   largest {:8.3}",
                q.faces,
                1e4 * q.mean,
                1e4 * q.rms,
                1e4 * q.largest
            );
        }
        for failure in &self.failures {
            println!("    no figure: {failure}");
        }
    }
}

/// The middle value; `None` of none.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[middle]),
        _ => Some(0.5 * (sorted[middle - 1] + sorted[middle])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_in_the_middle() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
    }

    #[test]
    fn ratios_are_of_pairs_and_above_one_where_we_are_faster() {
        let series = |values: &[f64]| Series { values: values.to_vec(), ..Series::default() };
        let row = Row {
            case: "x",
            what: "",
            input: String::new(),
            triangles: 1,
            unit: "ms",
            ours: series(&[1.0, 2.0, 4.0]),
            peers: vec![("peer".into(), series(&[3.0, 2.0, 8.0]))],
            failures: Vec::new(),
        };
        let json = row.to_json();
        assert_eq!(json["peers"][0]["ratio"], 2.0);
        assert_eq!(json["peers"][0]["ratio_min"], 1.0);
    }
}
