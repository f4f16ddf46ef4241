//! Real meshes: Debian's package `libcgal-demo` has some 180, which need no download of our own.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::shell::{self, Outcome};

/// Unpacks the meshes to target/data/cgal, if they are not there yet, and returns that folder.
pub(crate) fn unpack() -> Outcome<PathBuf> {
    let folder = shell::target("data/cgal")?;
    let done = folder.join(".unpacked");
    if done.exists() {
        return Ok(folder);
    }
    let archive = archive().ok_or(
        "the meshes of Debian's libcgal-demo are not installed; get them by\n  \
         apt-get install -y --no-install-recommends libcgal-demo",
    )?;
    let (from, to) = (archive.to_string_lossy(), folder.to_string_lossy());
    shell::run(&mut shell::command("tar", &["-xzf", &from, "-C", &to]))?;
    fs::write(done, "")?;
    Ok(folder)
}

/// The archive that the package installed; where the package lists none, where Debian 12 puts it.
fn archive() -> Option<PathBuf> {
    for package in ["libcgal-demo", "libcgal-dev"] {
        let Ok(list) = shell::output(&mut shell::command("dpkg", &["-L", package])) else {
            continue;
        };
        let found = list.lines().find(|line| line.ends_with("/data.tar.gz")).map(PathBuf::from);
        if let Some(path) = found.filter(|path| path.exists()) {
            return Some(path);
        }
    }
    Some(PathBuf::from("/usr/share/doc/libcgal-dev/data.tar.gz")).filter(|path| path.exists())
}

/// The folder of shared data, where there is one: `DGP_SHARED_DATA`, else ../shared/data.
pub(crate) fn shared() -> Option<PathBuf> {
    let named = std::env::var_os("DGP_SHARED_DATA").map(PathBuf::from);
    let folder = named.unwrap_or_else(|| shell::root().join("../shared/data"));
    folder.is_dir().then_some(folder)
}

/// All files under `folder` with one of these extensions, in order of their names.
pub(crate) fn files(folder: &Path, extensions: &[&str]) -> Outcome<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let path = entry?.path();
            let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
            if path.is_dir() {
                folders.push(path);
            } else if extension.is_some_and(|e| extensions.contains(&e.as_str())) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}
