//! Where, when and with what a run was made.

use std::fs;

use serde_json::{Value, json};

use crate::shell::{self, Outcome};

/// What the dashboard says of a run.
pub(super) fn describe(openmesh: &str) -> Outcome<Value> {
    let text = |program: &str, arguments: &[&str]| -> String {
        let output = shell::output(&mut shell::command(program, arguments));
        output
            .map(|text| text.lines().next().unwrap_or_default().trim().to_string())
            .unwrap_or_default()
    };
    let changed = shell::output(&mut shell::command("git", &["status", "--porcelain"]))?;
    let commit = text("git", &["rev-parse", "--short=12", "HEAD"]);
    let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    Ok(json!({
        "processor": model.unwrap_or("unknown"),
        "threads": std::thread::available_parallelism()?.get(),
        "load at the end": load.split(' ').next(),
        "date": text("date", &["-u", "+%Y-%m-%d %H:%M UTC"]),
        "commit": if changed.trim().is_empty() { commit } else { format!("{commit} with changes") },
        "rustc": text("rustc", &["--version"]),
        "g++": text("g++", &["--version"]),
        "OpenMesh": openmesh,
        "libopenmesh-dev": text("dpkg-query", &["-W", "-f=${Version}", "libopenmesh-dev"]),
        "libcgal-dev": text("dpkg-query", &["-W", "-f=${Version}", "libcgal-dev"]),
        "libosd-dev": text("dpkg-query", &["-W", "-f=${Version}", "libosd-dev"]),
    }))
}
