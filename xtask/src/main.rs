//! `cargo xtask COMMAND`: what the project checks and measures about itself.
//!
//! | command | what it does |
//! |---|---|
//! | `ci` | everything that must hold before a change lands |
//! | `tidy` | layers, ledger, file forms, links |
//! | `index` | writes docs/book/catalogue.md from docs/catalogue.toml |
//! | `data` | unpacks the meshes of Debian's `libcgal-demo` under target/ |
//! | `golden [--regenerate \| --refined]` | compares our results with those of the peers, or of subdivision only |
//! | `bench [--quick] [--criterion]` | times peers and us in one run, writes target/bench/index.html |
//! | `drive OPERATION INPUT …` | one measured operation in a process of its own |

mod bench;
mod ci;
mod data;
mod drive;
mod golden;
mod index;
mod peers;
mod raw;
mod shell;
mod tidy;

use std::process::ExitCode;

use shell::Outcome;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Outcome<()> {
    let (command, options) = arguments.split_first().ok_or(USAGE)?;
    match command.as_str() {
        "bench" => bench::run(options),
        "ci" => ci::run(),
        "tidy" => tidy::run(),
        "index" => index::write(),
        "data" => data::unpack().map(|folder| println!("{}", folder.display())),
        "drive" => drive::run(options),
        "golden" => golden::run(options),
        "peers" => peers::Peers::build(peers::Wanted::Optimized).map(|peers| println!("{peers}")),
        _ => Err(format!("no command `{command}` {options:?}\n{USAGE}").into()),
    }
}

const USAGE: &str = "usage: cargo xtask ci | tidy | index | data | golden [--regenerate | --refined] | bench [--quick | --criterion]";
