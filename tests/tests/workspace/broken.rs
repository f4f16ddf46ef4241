//! Broken faces, made here and real ones: what is found, and that each becomes a mesh.

use std::collections::BTreeMap;

use dgp_io::read;
use dgp_mesh::{
    CrowdedEdges, DVec3, DefectKind, FaceId, FlatFaces, IndexedFaceSet, KeepComponents, Progress,
    RepairAction, RepairOptions, Severity, Tolerance, defects, repair, shapes,
};
use dgp_tests::data;

/// Every way to repair that differs.
fn options() -> Vec<(&'static str, RepairOptions)> {
    let safe = RepairOptions::default();
    vec![
        ("safe", safe),
        ("cut", RepairOptions { crowded_edges: CrowdedEdges::Cut, ..safe }),
        ("weld", RepairOptions { weld: Some(Tolerance::Exact), ..safe }),
        (
            "all",
            RepairOptions {
                weld: Some(Tolerance::OfDiagonal(1e-6)),
                flat_faces: FlatFaces::Remove,
                components: KeepComponents::Largest(3),
                hole_edges: 500,
                ..safe
            },
        ),
    ]
}

fn repairs(name: &str, set: &IndexedFaceSet) {
    for (how, options) in options() {
        let (mesh, report) = repair(set, &options, Progress::NONE)
            .unwrap_or_else(|error| panic!("{name}, {how}: {error}"));
        let again = mesh.to_indexed();
        let left = defects(&again, Progress::NONE).unwrap();
        let errors: Vec<_> = left.of(Severity::Error).collect();
        assert!(errors.is_empty(), "{name}, {how}: {left}");
        let kept = report.faces.values().iter().flatten().count();
        let from = report.face_sources.values().iter().flatten().count();
        assert_eq!(kept, from, "{name}, {how}");
        if how == "safe" {
            let (_, second) = repair(&again, &options, Progress::NONE).unwrap();
            assert_eq!(second.changes, [], "{name}: repairing twice");
        }
    }
}

#[test]
fn damaged_shapes_become_meshes() {
    let sphere = shapes::icosphere(3).unwrap().to_indexed();
    repairs("a sphere", &sphere);
    repairs("a scan", &shapes::like_a_scan(&shapes::icosphere(4).unwrap(), 7).unwrap());
    repairs("a Möbius strip", &shapes::mobius_strip(30, 4).unwrap());
    let mut turned = sphere.faces().clone();
    for f in (0..turned.len()).step_by(3).map(FaceId::new) {
        turned.face_mut(f).reverse();
    }
    let positions = sphere.positions().clone();
    repairs("turned faces", &IndexedFaceSet::new(positions.clone(), turned).unwrap());

    let mut crowded = sphere.faces().clone();
    let first = crowded.face(FaceId::new(0)).to_vec();
    let far = crowded.face(FaceId::new(900)).to_vec();
    crowded.push(&[first[0], first[1], far[0]]);
    crowded.push(&[first[1], first[0], far[1]]);
    crowded.push(&first);
    crowded.push(&[first[0], first[0], far[2]]);
    crowded.push(&[far[0]]);
    repairs("faces too many", &IndexedFaceSet::new(positions.clone(), crowded).unwrap());

    let mut nowhere = positions;
    nowhere.values_mut()[17] = DVec3::new(f64::NAN, 0.0, 0.0);
    nowhere.values_mut()[18] = DVec3::new(f64::INFINITY, 0.0, 0.0);
    repairs("no numbers", &IndexedFaceSet::new(nowhere, sphere.faces().clone()).unwrap());
}

#[test]
fn each_broken_file_becomes_a_mesh_without_errors() {
    let Some(folder) = data::shared() else {
        println!("skipped: there are no shared data");
        return;
    };
    let mut repaired = 0;
    for path in data::files(&folder.join("broken")) {
        // What cannot be read is the matter of dgp-io, which says why.
        if let Ok(document) = read(&path) {
            repairs(&path.display().to_string(), &document.set);
            repaired += 1;
        }
    }
    assert!(repaired >= 40, "{repaired} files");
}

/// Kinds that the manifest of the shared data counts too, under its names.
const COUNTED: [(&str, DefectKind); 5] = [
    ("nm_edges", DefectKind::NonManifoldEdge),
    ("nm_vertices", DefectKind::NonManifoldVertex),
    ("flipped_edges", DefectKind::MisorientedEdge),
    ("unreferenced_v", DefectKind::IsolatedVertex),
    ("nonfinite_v", DefectKind::NonFiniteVertex),
];

#[test]
fn defects_of_real_files_are_those_known() {
    let Some(folder) = data::shared() else {
        println!("skipped: there are no shared data");
        return;
    };
    let manifest = std::fs::read_to_string(folder.join("MANIFEST.tsv")).unwrap();
    let (mut checked, mut different) = (0, Vec::new());
    for row in manifest.lines().skip(1).map(|line| line.split('\t').collect::<Vec<_>>()) {
        // Where the program that wrote the manifest gave up, it counted nothing: there is no V either.
        if row[3].is_empty() {
            continue;
        }
        let Ok(document) = read(folder.join(row[0])) else { continue };
        let report = defects(&document.set, Progress::NONE).unwrap();
        let known: BTreeMap<&str, usize> = row[15]
            .split("; ")
            .filter_map(|issue| issue.split_once('='))
            .filter_map(|(name, count)| Some((name, count.parse().ok()?)))
            .collect();
        // The manifest also counts edges of faces that are no polygons, and its reader splits polygons.
        let no_polygons =
            report.count(DefectKind::RepeatedVertex) + report.count(DefectKind::ShortFace);
        if no_polygons > 0 || document.set.face_count() == 0 {
            continue;
        }
        for (name, kind) in COUNTED {
            let (expected, found) = (known.get(name).copied().unwrap_or(0), report.count(kind));
            if found != expected {
                different.push(format!("{}: {name} {expected}, found {found}", row[0]));
            }
            checked += 1;
        }
    }
    assert!(checked > 500, "{checked} counts");
    assert_eq!(different, [""; 0], "of {checked}");
}

#[test]
fn solids_that_touch_come_apart_closed() {
    let Some(folder) = data::shared() else {
        println!("skipped: there are no shared data");
        return;
    };
    for name in ["cow_nm_vertex.obj", "hourglass_ico.obj"] {
        let document = read(folder.join("broken").join(name)).unwrap();
        let (mesh, report) =
            repair(&document.set, &RepairOptions::default(), Progress::NONE).unwrap();
        assert_eq!(report.count(RepairAction::SplitVertices), 1, "{name}");
        assert!(mesh.halfedges().all(|h| mesh.face(h).is_some()), "{name}");
    }
}
