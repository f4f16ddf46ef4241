//! Our results against OpenMesh's and CGAL's, on the same bits.
//!
//! Every input is written as a raw mesh, each peer answers in a process of its own, and every number is
//! compared with its tolerance. docs/book/golden.md names the differences of convention.

mod compare;
mod facts;
mod inputs;
mod stored;
mod table;

use std::{fs, path::Path};

use crate::{
    peers::{Peers, Wanted},
    raw,
    shell::{self, Outcome},
};
use compare::{Comparison, Verdict, compare};
use facts::Facts;
use inputs::Input;
use table::Table;

/// Compares all inputs and prints a table; an error if anything differs.
pub(crate) fn run(options: &[String]) -> Outcome<()> {
    let regenerate = match options {
        [] => false,
        [option] if option == "--regenerate" => true,
        _ => return Err("usage: golden [--regenerate]".into()),
    };
    let peers = Peers::build(Wanted::Any)?;
    let folder = shell::target("golden")?;
    let mut table = Table::default();
    let small = inputs::small()?;
    for input in &small {
        let answers = answers(&peers, &folder, input, &mut table)?;
        if regenerate {
            stored::write(input, &answers)?;
        }
    }
    for input in inputs::large()? {
        answers(&peers, &folder, &input, &mut table)?;
    }
    table.print();
    fs::write(folder.join("golden.json"), table.to_json().to_string())?;
    table.verdict()
}

/// Asks every peer about one input, and notes how the answers compare with ours.
fn answers(
    peers: &Peers,
    folder: &Path,
    input: &Input,
    table: &mut Table,
) -> Outcome<Vec<(&'static str, Facts)>> {
    let path = folder.join(format!("{}.raw", input.name));
    raw::write(&path, &input.set)?;
    let ours = facts::ours(&input.set);
    let mut all = Vec::new();
    for (peer, driver) in [("OpenMesh", &peers.openmesh), ("CGAL", &peers.cgal)] {
        match facts::theirs(driver, &path, &input.set) {
            Ok(theirs) => {
                table.add(&input.name, peer, compare(&input.set, &ours, &theirs, peer));
                all.push((peer, theirs));
            }
            Err(error) => table.silent(&input.name, peer, &ours, &error.to_string()),
        }
    }
    fs::remove_file(path)?;
    Ok(all)
}
