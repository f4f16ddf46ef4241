//! Counts, topology and size of real meshes against what another program found.
//!
//! The folder of real data has a table of its files, computed by a small Python reader that shares
//! nothing with this workspace. Where it is absent, the test says so and checks nothing.

use std::{collections::BTreeMap, fs, path::Path};

use dgp_mesh::{
    DVec3, IndexedFaceSet, VertexId,
    measure::{GeometryReport, geometry_report},
    topology::{TopologyReport, topology_report},
};
use dgp_tests::data;

/// Where we differ from the table and are right: file, column, why.
const DIFFERENCES: &[(&str, &str, &str)] = &[
    (
        "broken/assimp_box_longline.obj",
        "oriented",
        "one face visits its four edges 234 times: that is non-manifold, not misoriented",
    ),
    ("broken/tinyobj_invalid-face-definition.obj", "manifold", "faces of one and two corners"),
    ("broken/tinyobj_invalid-face-definition.obj", "genus", "faces of one and two corners"),
];

/// A row of the table, by the name of the column.
type Row<'a> = BTreeMap<&'a str, &'a str>;

#[test]
fn topology_and_size_are_those_of_the_table() {
    let Some(folder) = data::shared() else {
        eprintln!("skipped: no real data; set DGP_SHARED_DATA to their folder");
        return;
    };
    let table = fs::read_to_string(folder.join("MANIFEST.tsv")).expect("the table of the data");
    let mut lines = table.lines().map(|line| line.split('\t'));
    let names: Vec<&str> = lines.next().expect("a line of names").collect();
    let mut compared = 0;
    let mut wrong = Vec::new();
    for line in lines {
        let row: Row = names.iter().copied().zip(line).collect();
        let Some(set) = read(&folder, &row) else { continue };
        compared += 1;
        let topology = topology_report(&set);
        let geometry = geometry_report(&set, &topology);
        for (column, ours) in columns(&set, &topology, &geometry) {
            let theirs = row.get(column).copied().unwrap_or("");
            // The table has a volume for whatever is closed; without agreeing faces it means nothing.
            if column == "volume" && !topology.watertight {
                continue;
            }
            let is_known = DIFFERENCES.iter().any(|d| (d.0, d.1) == (row["path"], column));
            if !theirs.is_empty() && !agree(theirs, &ours) && !is_known {
                wrong.push(format!("{} {column}: table {theirs}, ours {ours}", row["path"]));
            }
        }
    }
    eprintln!("{compared} files compared");
    assert!(
        compared > 100 && wrong.is_empty(),
        "{} differences:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// The faces in the file of `row`; `None` if the table says nothing of them, or for a format or a
/// fault that the reader refuses.
fn read(folder: &Path, row: &Row) -> Option<IndexedFaceSet> {
    (!row.get("V")?.is_empty()).then_some(())?;
    match dgp_io::read(folder.join(row["path"])) {
        Ok(document) => Some(document.set),
        Err(error) => {
            eprintln!("not compared: {error}");
            None
        }
    }
}

/// Our values of the columns of the table; empty where there is none.
fn columns(
    set: &IndexedFaceSet,
    topology: &TopologyReport,
    geometry: &GeometryReport,
) -> Vec<(&'static str, String)> {
    let yes = |is: bool| if is { "yes" } else { "no" }.to_string();
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:e}"));
    let genus = match topology.genus {
        Some(genus) => genus.to_string(),
        None if !topology.orientable => "non-orientable".to_string(),
        None => String::new(),
    };
    let degrees = [topology.triangles, topology.quads, topology.polygons];
    vec![
        ("V", set.vertex_count().to_string()),
        ("F", set.face_count().to_string()),
        ("tri/quad/ngon", degrees.map(|n| n.to_string()).join("/")),
        ("closed", yes(topology.closed)),
        ("manifold", yes(topology.manifold)),
        ("oriented", yes(topology.oriented)),
        ("components", topology.components.len().to_string()),
        ("genus", genus),
        ("boundary_loops", topology.boundary_loops.to_string()),
        ("area", number(geometry.area.map(|area| area_of_table(set, area)))),
        ("volume", number(geometry.volume.map(|volume| volume_of_table(set, volume)))),
        ("bbox_diag", number(geometry.bounding_box.map(|b| b.diagonal()))),
    ]
}

/// The table cuts polygons into fans from their first corner, we do not (decision 0060): where there
/// are polygons, the sum over their fans, which is no less than `ours`.
fn area_of_table(set: &IndexedFaceSet, ours: f64) -> f64 {
    if set.faces().is_triangles() {
        return ours;
    }
    let area = fans(set, |a, b, c| 0.5 * (b - a).cross(c - a).length());
    assert!(ours <= area * (1.0 + 1e-12), "{ours} exceeds {area}");
    area
}

/// The same for the volume, which may differ either way, but by no more than polygons bend.
fn volume_of_table(set: &IndexedFaceSet, ours: f64) -> f64 {
    if set.faces().is_triangles() {
        return ours;
    }
    let volume = fans(set, |a, b, c| a.dot(b.cross(c)) / 6.0);
    assert!((ours - volume).abs() <= 0.01 * volume.abs(), "{ours} is far from {volume}");
    volume
}

/// The sum of `term` over the triangles of the fans of all faces.
fn fans(set: &IndexedFaceSet, term: impl Fn(DVec3, DVec3, DVec3) -> f64) -> f64 {
    let point = |v: VertexId| set.position(v);
    let fan = |face: &[VertexId]| -> f64 {
        let rest = face.get(1..).unwrap_or_default();
        rest.windows(2).map(|pair| term(point(face[0]), point(pair[0]), point(pair[1]))).sum()
    };
    set.faces().iter().map(|(_, face)| fan(face)).sum()
}

/// Whether `theirs`, printed with nine digits, is `ours`.
fn agree(theirs: &str, ours: &str) -> bool {
    let theirs = theirs.trim_end_matches(" (total)");
    match (theirs.parse::<f64>(), ours.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-8 * a.abs().max(b.abs()),
        _ => theirs == ours,
    }
}
