//! How a command fails: the data cannot be processed (exit code 1), or it was called wrongly (2).

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use dgp::mesh::{EditError, FaceId, Id, VertexId};

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

    /// A matrix.
    #[error("{0}")]
    Sparse(#[from] dgp::sparse::Error),

    /// Subdivision.
    #[error("{source}{}", remedy(source))]
    Subdiv {
        /// What went wrong.
        #[from]
        source: dgp::subdiv::Error,
    },

    /// Decimation and levels of detail.
    #[error("{0}")]
    Remesh(#[from] dgp::remesh::Error),

    /// Maps to the plane.
    #[error("{0}")]
    Param(#[from] dgp::param::Error),

    /// A crease or a corner of a file is too sharp, or less than smooth.
    #[error("{what} has sharpness {sharpness}, but it must be 0 (smooth) to 10 (sharp for ever)")]
    Sharpness {
        /// What has it.
        what: String,
        /// How sharp it is.
        sharpness: f64,
    },

    /// A text that is no mesh, such as a matrix.
    #[error("cannot read {}: {source}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },

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

    /// An element that was asked for does not exist.
    #[error("there is no {kind} {index}: the mesh has {count}, numbered from 0")]
    NoElement {
        /// What it should have been.
        kind: &'static str,
        /// Its number.
        index: usize,
        /// How many there are.
        count: usize,
    },

    /// Two vertices that should have an edge have none.
    #[error("no edge joins {} and {}; `dgp info --vertex {}` lists the neighbors of the first", vertices[0], vertices[1], vertices[0].index())]
    NotAnEdge {
        /// The vertices.
        vertices: [VertexId; 2],
    },

    /// Two vertices that should be corners of one face are not.
    #[error("{} and {} are not corners of one face", vertices[0], vertices[1])]
    NoCommonFace {
        /// The vertices.
        vertices: [VertexId; 2],
    },

    /// A triangle in which points have no coordinates.
    #[error("{face} has no area: points have no barycentric coordinates in it")]
    NoArea {
        /// The triangle.
        face: FaceId,
    },

    /// No path leads from some vertices to another.
    #[error(
        "no path along edges leads from {} to {to}; `dgp info` tells how many components there are",
        from.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    )]
    NoPath {
        /// Where it should have started.
        from: Vec<VertexId>,
        /// Where it should have ended.
        to: VertexId,
    },

    /// An edit was refused.
    #[error("edit {number}, --{edit}: {source}; nothing was written")]
    Edit {
        /// Which of the edits, counted from 1.
        number: usize,
        /// The edit as it was asked for.
        edit: String,
        /// Why.
        source: Box<Failure>,
    },

    /// Why an edit was refused.
    #[error("{0}")]
    Refused(#[from] EditError),

    /// A repair reached its limits.
    #[error("{0}")]
    Unrepaired(String),

    /// The options contradict each other or the input.
    #[error("{0}")]
    Usage(String),
}

impl Failure {
    /// The same, with the file it is about.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        match self {
            Failure::Io(dgp::io::Error::Tag { .. }) => {
                Failure::InFile { path: path.to_owned(), source: Box::new(self) }
            }
            Failure::Usage(_) | Failure::InFile { .. } | Failure::Io(_) | Failure::Text { .. } => {
                self
            }
            other => Failure::InFile { path: path.to_owned(), source: Box::new(other) },
        }
    }

    /// An error unless the element `id` is one of `count`.
    pub(crate) fn need<I: Id>(id: I, count: usize) -> Result<(), Self> {
        let (kind, index) = (I::KIND, id.index());
        if index < count { Ok(()) } else { Err(Failure::NoElement { kind, index, count }) }
    }

    /// The exit code for it.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(if matches!(self, Failure::Usage(_)) { 2 } else { 1 })
    }
}

/// Which command or option helps.
fn remedy(error: &dgp::subdiv::Error) -> &'static str {
    use dgp::subdiv::Error;
    match error {
        Error::NotTriangle { .. } => "; `dgp convert --triangulate` cuts all faces",
        Error::IsolatedVertex { .. } => "; `dgp repair` does",
        Error::TooLarge { .. } => " with --memory-limit",
        Error::NotQuad { .. } => ", with --levels 1",
        _ => "",
    }
}
