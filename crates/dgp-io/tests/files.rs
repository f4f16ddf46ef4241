//! Files on the disk: whole or not at all.

use std::{env, fs, ops::ControlFlow, path::PathBuf, process};

use dgp_io::{Document, Error, Format, ReadOptions, WriteOptions, read, read_with, write};
use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Progress};

fn triangle() -> Document {
    let faces = FaceList::from_indices(&[[0, 1, 2]]);
    IndexedFaceSet::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], faces).unwrap().into()
}

/// An empty folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = env::temp_dir().join(format!("dgp-io-{name}-{}", process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}

#[test]
fn what_is_written_can_be_read() {
    let folder = Folder::new("written");
    for format in Format::ALL {
        let path = folder.0.join("mesh").with_extension(format.name());
        let report = write(&path, &triangle(), &WriteOptions::default(), Progress::NONE).unwrap();
        assert_eq!(report.bytes as u64, fs::metadata(&path).unwrap().len());
        assert_eq!(read(&path).unwrap().set.vertex_count(), 3, "{format}");
    }
    assert_eq!(folder.names().len(), Format::ALL.len());
}

#[test]
fn a_cancelled_or_refused_file_leaves_the_old_one() {
    let folder = Folder::new("cancelled");
    let path = folder.0.join("mesh.obj");
    fs::write(&path, "v 0 0 0\n").unwrap();
    let stop = |_: f64| ControlFlow::Break(());
    let options = WriteOptions::default();
    let result = write(&path, &triangle(), &options, Progress::new(&stop));
    assert!(matches!(result, Err(Error::Cancelled(_))));
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let result = write(&path, &triangle(), &options, Progress::NONE);
    assert!(matches!(result, Err(Error::File { action: "write", .. })));
    assert_eq!(fs::read(&path).unwrap(), b"v 0 0 0\n");
    assert_eq!(folder.names(), ["mesh.obj"]);
}

#[test]
fn reading_stops_when_asked_to() {
    let folder = Folder::new("stopped");
    for format in Format::ALL {
        let path = folder.0.join("mesh").with_extension(format.name());
        let _ = write(&path, &triangle(), &WriteOptions::default(), Progress::NONE).unwrap();
        let stop = |_: f64| ControlFlow::Break(());
        let result = read_with(&path, &ReadOptions::default(), Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))), "{format}");
    }
}

#[test]
fn what_is_no_file_is_named() {
    let folder = Folder::new("folders");
    let inside = folder.0.join("folder.obj");
    fs::create_dir(&inside).unwrap();
    let options = WriteOptions::default();
    let written = write(&inside, &triangle(), &options, Progress::NONE);
    for result in [read(&inside).map(|_| ()), written.map(|_| ())] {
        let message = result.unwrap_err().to_string();
        assert!(message.contains("folder.obj is a folder"), "{message}");
    }
    assert!(matches!(read(folder.0.join("none.obj")), Err(Error::File { action: "read", .. })));
    let nowhere = folder.0.join("none").join("mesh.obj");
    let result = write(nowhere, &triangle(), &options, Progress::NONE);
    assert!(matches!(result, Err(Error::File { action: "write", .. })));
    fs::write(folder.0.join("empty.ply"), "").unwrap();
    let message = read(folder.0.join("empty.ply")).unwrap_err().to_string();
    assert!(message.ends_with("empty.ply: PLY, line 1: there is nothing in the file"), "{message}");
    let result = read(folder.0.join("mesh.fbx"));
    assert!(result.unwrap_err().to_string().contains("no format is known as \"fbx\""));
}

#[cfg(unix)]
#[test]
fn links_stay_links_and_devices_are_refused() {
    let folder = Folder::new("links");
    let (target, link) = (folder.0.join("target.obj"), folder.0.join("link.obj"));
    fs::write(&target, "v 0 0 0\n").unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    let options = WriteOptions::default();
    let _ = write(&link, &triangle(), &options, Progress::NONE).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(read(&target).unwrap(), triangle());
    let options = ReadOptions { format: Some(Format::Obj) };
    let result = read_with("/dev/null", &options, Progress::NONE);
    assert!(matches!(result, Err(Error::NotAFile { .. })));
}
