//! The command `dgp`.
//!
//! Each command is a file of `commands/`: its options, and one function from an input to a report.
//! [`session`] reads, times, writes and reports; [`cli`] holds what all commands share.

mod cli;
mod commands;
mod failure;
mod session;

use std::process::ExitCode;

use clap::Parser;

use crate::{cli::Cli, commands::Command};

fn main() -> ExitCode {
    let Cli { command, common } = Cli::parse();
    if let Some(threads) = common.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global();
        if let Err(error) = pool {
            eprintln!("dgp: cannot start {threads} threads: {error}");
            return ExitCode::from(1);
        }
    }
    let outcome = match command {
        Command::Info(command) => command.run(&common),
        Command::Check(command) => command.run(&common),
        Command::Convert(command) => command.run(&common),
        Command::Repair(command) => command.run(&common),
        Command::Smooth(command) => command.run(&common),
        Command::Subdivide(command) => command.run(&common),
        Command::Evaluate(command) => command.run(&common),
        Command::Stencils(command) => command.run(&common),
        Command::Decimate(command) => command.run(&common),
        Command::Remesh(command) => command.run(&common),
        Command::Fill(command) => command.run(&common),
        Command::Voronoi(command) => command.run(&common),
        Command::Sample(command) => command.run(&common),
        Command::Progressive(command) => command.run(&common),
        Command::Edit(command) => command.run(&common),
        Command::Geodesic(command) => command.run(&common),
        Command::Curvature(command) => command.run(&common),
        Command::Spectrum(command) => command.run(&common),
        Command::Param(command) => command.run(&common),
        Command::Partition(command) => command.run(&common),
        Command::Compress(command) => command.run(&common),
        Command::Laplacian(command) => command.run(&common),
        Command::Heat(command) => command.run(&common),
        Command::Correspond(command) => command.run(&common),
        Command::Compare(command) => command.run(&common),
        Command::Distance(command) => command.run(&common),
        Command::Solve(command) => command.run(&common),
        Command::Shape(command) => command.run(&common),
        Command::Render(command) => command.run(&common),
        Command::Demo(command) => command.run(&common),
        Command::Completions(command) => command.run(),
        Command::Manual(command) => command.run(),
    };
    match outcome {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("dgp: {failure}");
            failure.exit_code()
        }
    }
}
