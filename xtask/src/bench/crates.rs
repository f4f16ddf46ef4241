//! What each crate costs its user: dependencies, and seconds to build it from nothing.

use std::{collections::BTreeSet, fs, time::Instant};

use serde_json::{Value, json};

use crate::{
    shell::{self, Outcome},
    tidy,
};

/// One entry per published crate.
pub(super) fn measure() -> Outcome<Value> {
    let folder = shell::target("bench")?.join("build");
    let mut rows = Vec::new();
    for name in tidy::published()? {
        let tree = [
            "tree",
            "--package",
            &name,
            "--edges",
            "normal",
            "--prefix",
            "none",
            "--format",
            "{p}",
        ];
        let tree = shell::output(&mut shell::cargo(&tree))?;
        let packages: BTreeSet<&str> = tree
            .lines()
            .filter_map(|line| line.split(' ').next())
            .filter(|package| *package != name)
            .collect();
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        let start = Instant::now();
        let mut build = shell::cargo(&["build", "--release", "--quiet", "--package", &name]);
        shell::output(build.env("CARGO_TARGET_DIR", &folder))?;
        let seconds = start.elapsed().as_secs_f64();
        println!("{name:16} {} dependencies, built in {seconds:.1} s", packages.len());
        rows.push(json!({"crate": name, "dependencies": packages.len(), "seconds": seconds}));
    }
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    Ok(Value::Array(rows))
}
