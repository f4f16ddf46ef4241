//! How a command fails: the data cannot be processed (exit code 1), or it was called wrongly (2).

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// A file.
    #[error("{0}")]
    Io(#[from] dgp::io::Error),

    /// A mesh.
    #[error("{0}")]
    Mesh(#[from] dgp::mesh::Error),

    /// Something about the contents of this file.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file, or `-`.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<Failure>,
    },

    /// Smoothing.
    #[error("{0}")]
    Laplace(#[from] dgp::laplace::Error),

    /// A picture.
    #[error("{0}")]
    View(#[from] dgp::view::Error),

    /// Standard input or output.
    #[error("{what}: {source}")]
    Pipe {
        /// Which.
        what: &'static str,
        /// Why.
        source: std::io::Error,
    },

    /// A folder to write into.
    #[error("cannot create the folder {}: {source}", path.display())]
    Folder {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },

    /// The options contradict each other or the input.
    #[error("{0}")]
    Usage(String),
}

impl Failure {
    /// The same, with the file it is about.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        match self {
            Failure::Usage(_) | Failure::InFile { .. } | Failure::Io(_) => self,
            other => Failure::InFile { path: path.to_owned(), source: Box::new(other) },
        }
    }

    /// The exit code for it.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(if matches!(self, Failure::Usage(_)) { 2 } else { 1 })
    }
}
