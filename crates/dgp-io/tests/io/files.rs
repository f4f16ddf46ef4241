//! Files on the disk: whole or not at all.

use std::{
    env, fs,
    ops::ControlFlow,
    path::PathBuf,
    process,
    sync::atomic::{AtomicUsize, Ordering},
};

use dgp_io::{
    Document, Encoding, Error, Format, ReadOptions, WriteOptions, read, read_with, write,
    write_bytes, write_to,
};
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

/// A sheet of 720,000 triangles, more than any buffer holds.
fn sheet() -> Document {
    let mut document = Document::from(&dgp_mesh::shapes::grid(600, 600).unwrap());
    let thirds: Vec<f64> = (0..document.set.vertex_count()).map(|v| v as f64 / 3.0).collect();
    document.set.vertex_attributes.insert("heat", thirds);
    document
}

/// Counts reports, and stops at the first one beyond `limit`.
struct Clock {
    limit: f64,
    reports: AtomicUsize,
}

impl Clock {
    fn new(limit: f64) -> Self {
        Clock { limit, reports: AtomicUsize::new(0) }
    }

    fn tick(&self, x: f64) -> ControlFlow<()> {
        self.reports.fetch_add(1, Ordering::Relaxed);
        if x > self.limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn large_files_report_often_and_stop_in_the_middle() {
    let folder = Folder::new("large");
    let document = sheet();
    let cases = [
        ("obj", Encoding::Text),
        ("ply", Encoding::LittleEndian),
        ("ply", Encoding::Text),
        ("stl", Encoding::LittleEndian),
        ("off", Encoding::BigEndian),
        ("off", Encoding::Text),
    ];
    for (extension, encoding) in cases {
        let path = folder.0.join("mesh").with_extension(extension);
        let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
        let stops = Clock::new(0.3);
        let tick = |x: f64| stops.tick(x);
        let result = write(&path, &document, &options, Progress::new(&tick));
        assert!(matches!(result, Err(Error::Cancelled(_))), "{extension} {encoding}");
        assert_eq!(folder.names(), [""; 0], "{extension} {encoding}");

        // A report every four megabytes at least.
        let runs = Clock::new(2.0);
        let tick = |x: f64| runs.tick(x);
        let report = write(&path, &document, &options, Progress::new(&tick)).unwrap();
        let reports = runs.reports.into_inner();
        assert!(reports > report.bytes >> 22, "{extension} {encoding}: {reports}");
        let runs = Clock::new(2.0);
        let tick = |x: f64| runs.tick(x);
        let _ = read_with(&path, &ReadOptions::default(), Progress::new(&tick)).unwrap();
        let reports = runs.reports.into_inner();
        assert!(reports > 2 * (report.bytes >> 22), "{extension} {encoding}: {reports}");
        for limit in [0.1, 0.5, 0.7] {
            let stops = Clock::new(limit);
            let tick = |x: f64| stops.tick(x);
            let result = read_with(&path, &ReadOptions::default(), Progress::new(&tick));
            assert!(matches!(result, Err(Error::Cancelled(_))), "{extension} {encoding} {limit}");
        }
        fs::remove_file(&path).unwrap();
    }
}

#[test]
fn a_full_device_is_an_error_and_gets_no_more() {
    let document = sheet();
    for format in Format::ALL {
        let mut device = vec![0_u8; 100_000];
        let mut full = &mut device[..];
        let result =
            write_to(&mut full, &document, format, &WriteOptions::default(), Progress::NONE);
        assert!(matches!(result, Err(Error::Sink { .. })), "{format}: {result:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_full_device_of_the_system_is_told_as_such() {
    let mut full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let options = WriteOptions::default();
    let result = write_to(&mut full, &triangle(), Format::Ply, &options, Progress::NONE);
    let message = result.unwrap_err().to_string();
    assert!(message.starts_with("cannot write: No space left on device"), "{message}");
}

#[test]
fn what_goes_to_a_pipe_is_what_goes_to_a_file() {
    let document = sheet();
    for format in [Format::Ply, Format::Obj] {
        let mut piped = Vec::new();
        let options = WriteOptions::default();
        let report = write_to(&mut piped, &document, format, &options, Progress::NONE).unwrap();
        let (bytes, same) = write_bytes(&document, format, &options, Progress::NONE).unwrap();
        assert_eq!((piped.len(), &report), (report.bytes, &same));
        assert!(piped == bytes);
    }
}
