//! Everything that must hold before a change lands, in one run.

use std::{
    env, fs,
    process::Command,
    time::{Duration, Instant},
};

use crate::{
    bench, golden,
    shell::{self, Outcome, cargo},
    tidy,
};

/// Runs all steps in order and stops at the first that fails, naming it.
pub(crate) fn run() -> Outcome<()> {
    let mut steps = Steps { times: Vec::new() };
    steps.cargo("format", &["fmt", "--all", "--", "--check"])?;
    steps.step("tidy", tidy::run)?;
    steps.cargo("lints", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])?;
    steps.cargo("tests", &["test", "--workspace"])?;
    for library in tidy::libraries()? {
        let name = format!("tests of {library} without default features");
        steps.cargo(&name, &["test", "--package", &library, "--no-default-features"])?;
    }
    steps.cargo("licenses, bans, sources", &["deny", "check", "bans", "licenses", "sources"])?;
    steps.step("documentation", || {
        let mut command = cargo(&["doc", "--workspace", "--no-deps"]);
        shell::run(command.env("RUSTDOCFLAGS", "-D warnings"))
    })?;
    steps.step("room", make_room)?;
    steps.step("demo", demo)?;
    steps.step("golden comparisons", || golden::run(&[]))?;
    steps.step("benchmarks run", || bench::run(&["--quick".into()]))?;
    steps.print();
    Ok(())
}

/// On a machine that is there for this run only, takes away what the steps before have built without
/// optimization: the machine may have little disk.
fn make_room() -> Outcome<()> {
    match env::var_os("CI") {
        Some(_) => shell::run(&mut cargo(&["clean", "--profile", "dev"])),
        None => Ok(()),
    }
}

/// The README's command for running, from the workspace's root but into a folder that is then removed.
fn demo() -> Outcome<()> {
    let folder = shell::target("ci-demo")?;
    let path = folder.to_string_lossy().into_owned();
    shell::run(&mut cargo(&["run", "--release", "--", "demo", "--output", &path]))?;
    if !folder.join("index.html").exists() {
        return Err("the demo wrote no index.html".into());
    }
    fs::remove_dir_all(folder)?;
    Ok(())
}

struct Steps {
    times: Vec<(String, Duration)>,
}

impl Steps {
    fn step(&mut self, name: &str, run: impl FnOnce() -> Outcome<()>) -> Outcome<()> {
        println!("\n=== {name}");
        let start = Instant::now();
        run().map_err(|error| format!("step \"{name}\" failed: {error}"))?;
        let time = start.elapsed();
        println!("=== {name}: {:.1} s", time.as_secs_f64());
        self.times.push((name.into(), time));
        Ok(())
    }

    fn cargo(&mut self, name: &str, arguments: &[&str]) -> Outcome<()> {
        let mut command: Command = cargo(arguments);
        // A machine that builds once has no use for what the next build would reuse, nor for line numbers;
        // they are half of what is written.
        command.env("CARGO_INCREMENTAL", "0").env("CARGO_PROFILE_DEV_DEBUG", "0");
        self.step(name, || shell::run(&mut command))
    }

    fn print(&self) {
        println!("\n=== all steps passed");
        for (name, time) in &self.times {
            println!("{:8.1} s  {name}", time.as_secs_f64());
        }
        let total: Duration = self.times.iter().map(|(_, time)| *time).sum();
        println!("{:8.1} s  in all", total.as_secs_f64());
    }
}
