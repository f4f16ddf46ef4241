//! A scan from file to file: read, look what is wrong, mend, smooth, write.
//!
//! `cargo run --release -p dgp --example clean_scan`

use std::{env, error::Error, fs};

use dgp::{
    io::{self, Document, WriteOptions},
    laplace::smooth::{TaubinOptions, taubin},
    mesh::{
        Progress, RepairOptions, Tolerance, VertexSet, defects, repair, shapes,
        topology::topology_report,
    },
};

fn main() -> Result<(), Box<dyn Error>> {
    // Something that looks like a scan: noise, holes, a flipped patch, vertices twice.
    let folder = env::temp_dir().join(format!("dgp-clean-scan-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let (input, output) = (folder.join("scan.ply"), folder.join("clean.obj"));
    let scan = shapes::like_a_scan(&shapes::icosphere(4)?, 7)?;
    let written = io::write(&input, &scan.into(), &WriteOptions::default(), Progress::NONE)?;
    println!("a scan of {} bytes", written.bytes);

    let mut document = io::read(&input)?;
    let found = defects(&document.set, Progress::NONE)?;
    println!("{}: manifold: {}", input.display(), found.is_manifold());
    for defect in &found.defects {
        println!("  {defect}");
    }

    let options =
        RepairOptions { weld: Some(Tolerance::Exact), hole_edges: 500, ..RepairOptions::default() };
    let (mut mesh, changes) = repair(&document.set, &options, Progress::NONE)?;
    for change in &changes.changes {
        println!("  {}: {} elements", change.action.name(), change.elements.len());
    }

    let fixed = VertexSet::new();
    let smoothed = taubin(&mut mesh, &fixed, &TaubinOptions::default(), Progress::NONE)?;
    println!("smoothed: moved by {:.4} on average", smoothed.mean_displacement);

    // Lines, points and tags of the file follow their vertices; then everything is written.
    document.follow(mesh.to_indexed(), &changes.vertices);
    let facts = topology_report(&document.set);
    assert!(facts.manifold && facts.oriented && facts.closed);
    let written = io::write(&output, &document, &WriteOptions::default(), Progress::NONE)?;
    println!("{}: {} bytes, lost: {:?}", output.display(), written.bytes, written.losses);
    let again: Document = io::read(&output)?;
    assert_eq!(again.set.faces(), document.set.faces());
    fs::remove_dir_all(&folder)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_runs() {
        super::main().unwrap();
    }
}
