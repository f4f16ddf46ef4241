//! Real meshes, where the machine has them.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

/// The folder of real data: the environment variable `DGP_SHARED_DATA`, or `../shared/data` beside
/// the workspace; `None` where there is neither, and then a test says that it skips that part.
pub fn shared() -> Option<PathBuf> {
    let named = env::var_os("DGP_SHARED_DATA").map(PathBuf::from);
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    named.into_iter().chain([beside]).find(|folder| folder.is_dir())
}

/// The folder of Debian's meshes: the environment variable `DGP_DEBIAN_DATA`, or where `cargo xtask
/// data` unpacks them; `None` where there is neither.
pub fn debian() -> Option<PathBuf> {
    let named = env::var_os("DGP_DEBIAN_DATA").map(PathBuf::from);
    let unpacked = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/data/cgal");
    named.into_iter().chain([unpacked]).find(|folder| folder.is_dir())
}

/// The fixtures of this workspace.
pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures")
}

/// All files under `folder`, in order of their paths.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
