//! All real files, where the machine has them: read, written to each format, read back.

use std::{collections::BTreeMap, fs, path::Path};

use dgp_io::{Document, Encoding, Format, WriteOptions, read, read_bytes, write_bytes};
use dgp_mesh::{DVec3, IndexedFaceSet, Progress};
use dgp_tests::data;

/// The files that must be refused, and a part of the message that says why.
const REFUSED: [(&str, &str); 9] = [
    ("broken/assimp_OutOfMemory.off", "line 2: the file claims 353535235358 vertices"),
    ("broken/assimp_box_UTF16BE.obj", "UTF-16"),
    ("broken/assimp_empty.off", "there is nothing in the file"),
    ("broken/assimp_invalid.off", "line 7, face 1: there is no vertex 20"),
    ("broken/assimp_issue623.ply", "vertex"),
    ("broken/assimp_malformed.obj", "line 28, face: vertex 0 is named"),
    ("broken/assimp_number_formats.obj", "line 11, vertex: `3.1+e2` is not a number"),
    ("broken/tinyobj_invalid-relative-vertex-index.obj", "vertex -4 is named"),
    ("broken/tinyobj_issue-140-zero-face-idx.obj", "vertex 0 is named"),
];

#[test]
fn shared_files_have_the_counts_of_their_manifest() {
    let Some(folder) = data::shared() else {
        println!("skipped: there are no shared data");
        return;
    };
    let manifest = fs::read_to_string(folder.join("MANIFEST.tsv")).unwrap();
    let counts: BTreeMap<&str, [Option<usize>; 2]> = manifest
        .lines()
        .skip(1)
        .map(|line| line.split('\t').collect::<Vec<_>>())
        .map(|row| (row[0], [row[3].parse().ok(), row[4].parse().ok()]))
        .collect();
    let mut checked = 0;
    for path in data::files(&folder) {
        if Format::from_path(&path).is_err() {
            continue;
        }
        let name = path.strip_prefix(&folder).unwrap().to_string_lossy().into_owned();
        match (read(&path), REFUSED.iter().find(|(refused, _)| *refused == name)) {
            (Ok(document), None) => {
                if let Some([Some(v), Some(f)]) = counts.get(name.as_str()).copied() {
                    let set = &document.set;
                    assert_eq!((set.vertex_count(), set.face_count()), (v, f), "{name}");
                    checked += 1;
                }
            }
            (Err(error), Some((_, why))) => {
                let message = error.to_string();
                assert!(message.contains(why) && message.contains(&name), "{message}");
            }
            (Ok(_), Some(_)) => panic!("{name} was read"),
            (Err(error), None) => panic!("{error}"),
        }
    }
    assert!(checked > 100, "{checked} files have counts");
}

#[test]
fn real_files_come_back_from_each_format() {
    let folders = [data::shared(), data::debian(), Some(data::fixtures())];
    for folder in folders.iter().flatten() {
        for path in data::files(folder) {
            if let Ok(document) = read(&path) {
                round_trips(&path, &document);
            }
        }
    }
}

#[test]
fn files_of_debian_are_read() {
    let Some(folder) = data::debian() else {
        println!("skipped: there are no files of libcgal-demo; `cargo xtask data` unpacks them");
        return;
    };
    let mut refused = Vec::new();
    for path in data::files(&folder) {
        if Format::from_path(&path).is_ok()
            && let Err(error) = read(&path)
        {
            refused.push(error.to_string());
        }
    }
    assert_eq!(refused, [""; 0]);
}

fn round_trips(path: &Path, document: &Document) {
    for format in Format::ALL {
        for encoding in [Encoding::Text, Encoding::LittleEndian, Encoding::BigEndian] {
            if !format.has_encoding(encoding) {
                continue;
            }
            let what = format!("{} to {format} as {encoding}", path.display());
            let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
            let (bytes, report) = write_bytes(document, format, &options, Progress::NONE).unwrap();
            let again =
                read_bytes(&bytes, format).unwrap_or_else(|error| panic!("{what}: {error}"));
            let single = match (format, encoding) {
                (Format::Stl | Format::Off, encoding) => encoding != Encoding::Text,
                _ => false,
            };
            let (before, after) = (&document.set, &again.set);
            match format {
                Format::Stl => same_triangles(before, after, single, &what),
                Format::Xyz | Format::Pwn => same_positions(before, after, single, &what),
                _ => {
                    same_positions(before, after, single, &what);
                    assert!(before.faces() == after.faces(), "{what}");
                }
            }
            let own = Format::from_path(path).is_ok_and(|own| own == format);
            if own && report.losses.is_empty() && is_finite(before) {
                assert!(again == *document, "{what}");
            }
        }
    }
}

fn is_finite(set: &IndexedFaceSet) -> bool {
    let colors = set.vertex_attributes.get::<dgp_mesh::Color>(dgp_mesh::COLOR);
    let finite = |color: &dgp_mesh::Color| color.0.iter().all(|x| x.is_finite());
    set.positions().values().iter().all(|p| p.is_finite())
        && colors.is_none_or(|colors| colors.values().iter().all(finite))
}

fn same(p: DVec3, q: DVec3, single: bool) -> bool {
    (0..3).all(|k| {
        let x = if single { f64::from(p[k] as f32) } else { p[k] };
        x.to_bits() == q[k].to_bits() || (x.is_nan() && q[k].is_nan())
    })
}

fn same_positions(before: &IndexedFaceSet, after: &IndexedFaceSet, single: bool, what: &str) {
    assert_eq!(before.vertex_count(), after.vertex_count(), "{what}");
    for (v, &p) in before.positions().iter() {
        assert!(same(p, after.position(v), single), "{what}: {v}, {p} and {}", after.position(v));
    }
}

/// Triangles keep their corners and order; polygons become as many triangles as they have corners
/// but two.
fn same_triangles(before: &IndexedFaceSet, after: &IndexedFaceSet, single: bool, what: &str) {
    let triangles = before.faces().iter().map(|(_, face)| face.len().saturating_sub(2));
    assert_eq!(triangles.sum::<usize>(), after.face_count(), "{what}");
    if before.faces().is_triangles() {
        for (&v, &w) in before.faces().corners().iter().zip(after.faces().corners()) {
            // −0 is welded with 0.
            let (p, q) = (before.position(v) + DVec3::ZERO, after.position(w) + DVec3::ZERO);
            assert!(same(p, q, single), "{what}: {v}, {p} and {q}");
        }
    }
}
