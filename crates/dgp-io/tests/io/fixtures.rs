//! The fixtures of the workspace: what each comes to, and that what is read is written and read again.

use std::{
    collections::BTreeSet,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};

use dgp_io::{
    Document, Encoding, Error, Format, ReadOptions, WriteOptions, read_bytes, read_with,
    write_bytes,
};
use dgp_mesh::Progress;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures")
}

/// The files of all formats, by their path from the folder of fixtures.
fn names() -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for subject in fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()) {
        if subject.is_dir() {
            for path in fs::read_dir(&subject).unwrap().map(|entry| entry.unwrap().path()) {
                let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
                names.insert(format!("{}/{}", name(&subject), name(&path)));
            }
        }
    }
    names
}

/// All files and what is in them.
fn documents() -> Vec<(String, Result<Document, Error>)> {
    let read = |name: String| {
        let result = dgp_io::read(folder().join(&name));
        (name, result)
    };
    names().into_iter().map(read).collect()
}

/// What a file holds in a line, what was odd about it in others; or why it cannot be read.
fn told(name: &str) -> String {
    let result = read_with(folder().join(name), &ReadOptions::default(), Progress::NONE);
    let (document, report) = match result {
        Ok(read) => read,
        // The folder is another one on each machine.
        Err(Error::InFile { source, .. }) => return format!("{name}: {source}\n"),
        Err(error) => panic!("{name}: {error}"),
    };
    let set = &document.set;
    let mut text = format!("{name}: {} vertices, {} faces", set.vertex_count(), set.face_count());
    let vertex = set.vertex_attributes.names().map(|name| ("vertex", name));
    let corner = set.corner_attributes.names().map(|name| ("corner", name));
    let face = set.face_attributes.names().map(|name| ("face", name));
    for (kind, column) in vertex.chain(corner).chain(face) {
        write!(text, ", {kind} {column}").unwrap();
    }
    let others = [
        (document.polylines.len(), "lines"),
        (document.points.len(), "points"),
        (document.tags.len(), "tags"),
        (document.elements.len(), "other elements"),
        (document.comments.len(), "comments"),
        (document.material_libraries.len(), "material libraries"),
    ];
    for (count, what) in others.into_iter().filter(|&(count, _)| count > 0) {
        write!(text, ", {count} {what}").unwrap();
    }
    text.push('\n');
    for warning in report.warnings {
        writeln!(text, "    {warning}").unwrap();
    }
    text
}

#[test]
fn each_fixture_is_read_or_refused_as_before() {
    let told: String = documents().iter().map(|(name, _)| told(name)).collect();
    insta::assert_snapshot!(told);
}

#[test]
fn the_readme_names_each_fixture_and_tells_the_bad_ones() {
    let readme = fs::read_to_string(folder().join("README.md")).unwrap();
    let row = |line: &str| {
        let (name, what) = line.strip_prefix("| `")?.split_once("` | ")?;
        Some((name.to_owned(), what.starts_with("bad:")))
    };
    let rows: Vec<(String, bool)> = readme.lines().filter_map(row).collect();
    let found: Vec<(String, bool)> =
        documents().into_iter().map(|(name, result)| (name, result.is_err())).collect();
    let sorted: BTreeSet<_> = rows.into_iter().collect();
    assert_eq!(sorted, found.into_iter().collect());
}

#[test]
fn what_is_read_comes_back_from_every_encoding() {
    for (name, document) in documents() {
        let Ok(document) = document else { continue };
        let format = Format::from_path(Path::new(&name)).unwrap();
        for encoding in [Encoding::Text, Encoding::LittleEndian, Encoding::BigEndian] {
            if !format.has_encoding(encoding) {
                continue;
            }
            let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
            let (bytes, report) = write_bytes(&document, format, &options, Progress::NONE).unwrap();
            let again = read_bytes(&bytes, format).unwrap();
            assert_eq!(again.set.faces(), document.set.faces(), "{name} as {encoding}");
            // What is no number equals nothing, itself included.
            if report.losses.is_empty()
                && !name.contains("not-finite")
                && !name.contains("no-numbers")
            {
                assert_eq!(again, document, "{name} as {encoding}");
            }
        }
    }
}

#[test]
fn the_three_encodings_of_one_ply_file_hold_the_same() {
    let read = |name: &str| dgp_io::read(folder().join("ply").join(name)).unwrap();
    let text = read("everything-ascii.ply");
    let (little, big) = (read("everything-little.ply"), read("everything-big.ply"));
    assert_eq!(little, big);
    assert_eq!(text, little);
}
