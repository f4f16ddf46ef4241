//! Peers and us on the same inputs in one run: alternating processes, medians of pairs.
//!
//! Writes target/bench/results.json and target/bench/index.html. docs/book/benchmarks.md explains the
//! columns; no number there or here is typed by hand.

mod cases;
mod crates;
pub(crate) mod decimation;
mod inputs;
mod machine;
pub(crate) mod measure;
mod page;

use std::fs;

use serde_json::{Value, json};

use crate::{
    peers::{Peers, Wanted},
    shell::{self, Outcome},
};

/// How thorough a run is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Effort {
    /// One small size, one pair: shows that everything runs.
    Quick,
    /// All sizes.
    Full,
}

/// Runs the benchmarks; `only` are words that the name of a case must contain.
pub(crate) fn run(options: &[String]) -> Outcome<()> {
    let mut effort = Effort::Full;
    let mut only = Vec::new();
    for option in options {
        match option.as_str() {
            "--quick" => effort = Effort::Quick,
            "--criterion" => return shell::run(&mut shell::cargo(&["bench", "--workspace"])),
            word if !word.starts_with('-') => only.push(word),
            _ => return Err("usage: bench [--quick | --criterion] [CASE…]".into()),
        }
    }
    let (wanted, folder) = match effort {
        Effort::Quick => (Wanted::Any, "bench-quick"),
        Effort::Full => (Wanted::Optimized, "bench"),
    };
    let peers = Peers::build(wanted)?;
    let folder = shell::target(folder)?;
    let mut inputs = inputs::prepare(effort, &folder)?;
    inputs.extend(decimation::inputs(effort, &folder)?);
    let is_wanted =
        |name: &str| only.is_empty() || only.iter().any(|word: &&str| name.contains(word));
    let mut rows = Vec::new();
    for input in &inputs {
        for case in cases::all().iter().filter(|case| is_wanted(case.name)) {
            rows.extend(measure::case(case, input, &peers, effort, &folder));
        }
        rows.extend(decimation::rows(input, &peers, effort, &folder, is_wanted)?);
    }
    let crates =
        if effort == Effort::Full && only.is_empty() { crates::measure()? } else { Value::Null };
    let golden = fs::read_to_string(shell::target("golden")?.join("golden.json"));
    let golden: Value =
        golden.ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
    let unmeasured = rows.iter().filter(|row| !row.is_measured()).count();
    let rows: Vec<Value> = rows.iter().map(measure::Row::to_json).collect();
    let results = json!({
        "machine": machine::describe(&peers.openmesh.name)?,
        "rows": rows,
        "crates": crates,
        "golden": golden,
    });
    let (json, html) = (folder.join("results.json"), folder.join("index.html"));
    fs::write(&json, serde_json::to_string_pretty(&results)?)?;
    fs::write(&html, page::html(&results))?;
    println!("{}\n{}", json.display(), html.display());
    match unmeasured {
        0 => Ok(()),
        count => Err(format!("{count} cases have no figure of ours").into()),
    }
}
