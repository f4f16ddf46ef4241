//! Our results against OpenMesh's, CGAL's and OpenSubdiv's, on the same bits.
//!
//! Every input is written as a raw mesh, each peer answers in a process of its own, and every number is
//! compared with its tolerance. docs/book/golden.md names the differences of convention.

mod charts;
mod compare;
mod decimated;
mod estimates;
mod facts;
pub(crate) mod holes;
mod inputs;
mod mending;
mod refined;
mod remeshing;
mod spatial;
mod stored;
mod table;

use std::{fs, path::Path};

use dgp_mesh::{IndexedFaceSet, NotManifold, VertexId, topology::topology_report};

use crate::{
    peers::{Peers, Wanted},
    raw,
    shell::{self, Outcome},
};
use compare::{Comparison, Verdict, compare};
use facts::Facts;
use inputs::Input;
use table::Table;

/// What compares one subject.
type Part = fn(&Peers, &Path, &mut Table) -> Outcome<()>;

/// The subjects that can be asked for alone, and whether they are a part of the whole. Those that are not compare
/// quality, where ours is not always the better.
const PARTS: [(&str, Part, bool); 6] = [
    ("--refined", refined::compare, true),
    ("--spatial", spatial::compare, true),
    ("--mending", mending::compare, true),
    ("--decimated", decimated::compare, false),
    ("--holes", holes::compare, false),
    ("--remeshing", remeshing::compare, false),
];

/// Compares all inputs and prints a table; an error if anything differs.
pub(crate) fn run(options: &[String]) -> Outcome<()> {
    let regenerate = match options {
        [] => false,
        [option] if option == "--regenerate" => true,
        [option] => {
            let Some((_, part, _)) = PARTS.iter().find(|(name, ..)| name == option) else {
                return Err(usage());
            };
            let (peers, folder) = (Peers::build(Wanted::Any)?, shell::target("golden")?);
            let mut table = Table::default();
            part(&peers, &folder, &mut table)?;
            table.print();
            return table.verdict();
        }
        _ => return Err(usage()),
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
    for input in inputs::real()? {
        answers(&peers, &folder, &input, &mut table)?;
    }
    estimates::compare(&peers, &folder, &mut table)?;
    for (_, part, _) in PARTS.iter().filter(|(.., is_part)| *is_part) {
        part(&peers, &folder, &mut table)?;
    }
    table.print();
    fs::write(folder.join("golden.json"), table.to_json().to_string())?;
    table.verdict()
}

fn usage() -> Box<dyn std::error::Error> {
    let parts: Vec<&str> = PARTS.iter().map(|(name, ..)| *name).collect();
    format!("usage: golden [--regenerate | {}]", parts.join(" | ")).into()
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
    let mut ours = facts::ours(&input.set);
    let first_is_used = input.set.faces().corners().contains(&VertexId::new(0));
    if ours.refusal.is_none() && first_is_used {
        facts::distances(&input.set, &mut ours)?;
    }
    let mut all = Vec::new();
    for (peer, driver) in [("OpenMesh", &peers.openmesh), ("CGAL", &peers.cgal)] {
        let mut answer = facts::theirs(driver, &path, &input.set);
        if let (Ok(theirs), "CGAL") = (&mut answer, peer)
            && theirs.values["accepted"] == true
            && first_is_used
        {
            theirs.add(driver, "dijkstra", &path, &path.with_extension("dijkstra"))?;
        }
        match answer {
            Ok(theirs) => {
                table.add(&input.name, peer, compare(&input.set, &ours, &theirs, peer));
                all.push((peer, theirs));
            }
            Err(error) => table.silent(&input.name, peer, &ours, &error.to_string()),
        }
    }
    if ours.refusal.is_some_and(|reason| !matches!(reason, NotManifold::NonFinite { .. })) {
        compare_repairs(peers, &path, input, table)?;
    }
    fs::remove_file(path)?;
    Ok(all)
}

/// Compares how CGAL and we repair faces that make no mesh. CGAL leaves equal and degenerate faces
/// alone, and where a one-sided surface is cut is anybody's choice: those inputs are left out.
fn compare_repairs(peers: &Peers, path: &Path, input: &Input, table: &mut Table) -> Outcome<()> {
    let report = topology_report(&input.set);
    if report.degenerate_faces > 0 || !report.orientable || has_equal_faces(&input.set) {
        return Ok(());
    }
    let (ours, mesh) = facts::repaired(&input.set)?;
    let (theirs, faces) = facts::their_repair(&peers.cgal, path)?;
    let mut comparisons = compare(&input.set, &ours, &theirs, "CGAL");
    comparisons.push(compare::orientation(&input.set, &mesh, &faces));
    table.add(&input.name, "CGAL", comparisons);
    Ok(())
}

fn has_equal_faces(set: &IndexedFaceSet) -> bool {
    let mut faces: Vec<Vec<usize>> = raw::faces(set);
    for face in &mut faces {
        face.sort_unstable();
    }
    faces.sort_unstable();
    faces.windows(2).any(|pair| pair[0] == pair[1])
}
