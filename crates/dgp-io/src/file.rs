//! Files: read whole, written whole or not at all.

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, Read, Write},
    path::{Path, PathBuf},
    process,
    sync::atomic::{AtomicU32, Ordering},
};

use dgp_mesh::Progress;

use crate::Error;

/// How much is read between two reports.
const STEP: u64 = 1 << 22;

/// The bytes of a regular file.
pub(crate) fn load(path: &Path, progress: Progress<'_>) -> Result<Vec<u8>, Error> {
    let refused = |source| Error::File { action: "read", path: path.to_owned(), source };
    let metadata = fs::metadata(path).map_err(refused)?;
    refuse_special(path, &metadata)?;
    let mut bytes = Vec::new();
    let mut file = File::open(path).map_err(refused)?;
    let size =
        usize::try_from(metadata.len()).map_err(|_| refused(io::ErrorKind::FileTooLarge.into()))?;
    bytes.try_reserve_exact(size).map_err(|_| refused(io::ErrorKind::OutOfMemory.into()))?;
    // The size is only what it was a moment ago: what counts is where the file ends.
    while Read::by_ref(&mut file).take(STEP).read_to_end(&mut bytes).map_err(refused)? > 0 {
        progress.report((bytes.len() as f64 / size.max(1) as f64).min(1.0))?;
    }
    Ok(bytes)
}

/// Makes a new file of what `fill` writes that takes the place of `path` when all of it is on the
/// disk. If that fails or is cancelled, `path` is as before and nothing is left beside it.
pub(crate) fn store<T>(
    path: &Path,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<T, Error>,
) -> Result<T, Error> {
    // A link is followed, or the file would take the place of the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let refused = |source| Error::File { action: "write", path: path.to_owned(), source };
    let old = fs::metadata(&target).ok();
    if let Some(metadata) = &old {
        refuse_special(&target, metadata)?;
        if metadata.permissions().readonly() {
            return Err(refused(io::ErrorKind::PermissionDenied.into()));
        }
    }
    let mut draft = Draft::new(&target).map_err(refused)?;
    let filled = fill(&mut draft.file).map_err(|error| match error {
        Error::Sink { source } => refused(source),
        other => other,
    })?;
    if let Some(metadata) = old {
        draft.file.set_permissions(metadata.permissions()).map_err(refused)?;
    }
    draft.file.sync_data().map_err(refused)?;
    draft.publish(&target).map_err(refused)?;
    Ok(filled)
}

fn refuse_special(path: &Path, metadata: &Metadata) -> Result<(), Error> {
    let kind = match () {
        () if metadata.is_file() => return Ok(()),
        () if metadata.is_dir() => "a folder",
        () => "a device or a pipe",
    };
    Err(Error::NotAFile { path: path.to_owned(), kind })
}

/// A file beside its target that vanishes unless it is published.
struct Draft {
    file: File,
    path: Option<PathBuf>,
}

impl Draft {
    fn new(target: &Path) -> io::Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = target.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_string_lossy();
        // Names are limited to 255 bytes on most systems: the name is cut to stay below.
        let name: String = name.chars().take(40).collect();
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = target.with_file_name(format!(".{name}.{}.{count}.part", process::id()));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok(Draft { file, path: Some(path) }),
                // Left over by a process of the same number that was killed.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    fn publish(mut self, target: &Path) -> io::Result<()> {
        if let Some(path) = &self.path {
            fs::rename(path, target)?;
        }
        self.path = None;
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            // Nothing can be done about a failure here, and the first error is being reported.
            let _ = fs::remove_file(path);
        }
    }
}
