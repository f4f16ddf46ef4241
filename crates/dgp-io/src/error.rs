//! What can go wrong with a file, and where in it.

use std::{fmt, io, path::PathBuf};

use dgp_mesh::{Cancelled, FaceList, VertexId};

use crate::{Encoding, Format};

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller asked to stop. A file being written is then left as it was before.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),

    /// The operating system refused.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// What was tried, as in "read".
        action: &'static str,
        /// With which file.
        path: PathBuf,
        /// Why it failed.
        source: io::Error,
    },

    /// The writer that the bytes of a file went to took no more of them.
    #[error("cannot write: {source}")]
    Sink {
        /// Why not.
        source: io::Error,
    },

    /// Not a regular file: a folder, a device, a pipe.
    #[error("{} is {kind}; name a regular file, or go by `read_bytes` and `write_to`", path.display())]
    NotAFile {
        /// What was named.
        path: PathBuf,
        /// What it is, as in "a folder".
        kind: &'static str,
    },

    /// Something else went wrong with this file.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: Box<Error>,
    },

    /// No format goes by this name or extension.
    #[error("no format is known as {name:?}; known are obj, ply, stl, off, xyz and pwn")]
    UnknownFormat {
        /// The name or extension.
        name: String,
    },

    /// The format has no such encoding.
    #[error("{format} cannot be written as {encoding}; leave the encoding to the format")]
    UnsupportedEncoding {
        /// The format.
        format: Format,
        /// What was asked for.
        encoding: Encoding,
    },

    /// What is in the file is not what the format says.
    #[error("{format}, {place}{}: {cause}", Named(*element))]
    Malformed {
        /// The format it was read as.
        format: Format,
        /// Where in the file.
        place: Place,
        /// What was being read there, as in "vertex", and its number from 0 where that is known.
        element: Option<(&'static str, Option<usize>)>,
        /// What is wrong.
        cause: Cause,
    },

    /// The document cannot be a mesh.
    #[error(transparent)]
    Mesh(dgp_mesh::Error),

    /// A table of attributes does not fit the elements it belongs to.
    #[error(
        "the attributes of the {element} are for {found} elements, but there are {expected}; \
         give the table that many rows"
    )]
    AttributeLength {
        /// The elements, as in "vertices".
        element: &'static str,
        /// How many the table has values for.
        found: usize,
        /// How many there are.
        expected: usize,
    },

    /// A line or a point of a document to be written is at a vertex that does not exist.
    #[error("a line or point names {vertex}, but there are only {vertex_count} vertices")]
    NoSuchVertex {
        /// The first such vertex.
        vertex: VertexId,
        /// How many vertices there are.
        vertex_count: usize,
    },

    /// A tag of a subdivision surface makes no sense.
    #[error("tag {number}, `{name}`: {problem}")]
    Tag {
        /// Which of the tags, from 0.
        number: usize,
        /// What it is called.
        name: String,
        /// What is wrong with it.
        problem: String,
    },
}

impl From<dgp_mesh::Error> for Error {
    fn from(error: dgp_mesh::Error) -> Self {
        match error {
            dgp_mesh::Error::Cancelled(cancelled) => Error::Cancelled(cancelled),
            other => Error::Mesh(other),
        }
    }
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// A line of text, counted from 1.
    Line(usize),
    /// A byte, counted from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// What is wrong at a place in a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// There is nothing in the file.
    #[error("there is nothing in the file")]
    Empty,
    /// The file is of another kind.
    #[error("this is no {format} file: {expected} is missing")]
    WrongFormat {
        /// The format it was read as.
        format: Format,
        /// What the format begins with.
        expected: &'static str,
    },
    /// The text has two bytes a character.
    #[error("the text is in UTF-16; save it as UTF-8")]
    Utf16,
    /// A word that should be a number.
    #[error("`{text}` is not a number")]
    NotANumber {
        /// The word.
        text: String,
    },
    /// A word that should be a whole number.
    #[error("`{text}` is not a whole number")]
    NotAWholeNumber {
        /// The word.
        text: String,
    },
    /// A line ends too early.
    #[error("{found} numbers where {expected} belong")]
    TooFewNumbers {
        /// How many there are.
        found: usize,
        /// How many the format wants.
        expected: usize,
    },
    /// A name for an element that is not there.
    #[error("there is no {what} {index}: {}", Range { what, count: *count, first: *first })]
    IndexOutOfRange {
        /// What is named.
        what: &'static str,
        /// Its number as the file has it.
        index: i64,
        /// How many there are.
        count: usize,
        /// The number of the first one in this format.
        first: u8,
    },
    /// Index 0 in a format that counts from 1.
    #[error(
        "{what} 0 is named, but {format} counts from 1 (and -1 is the last one before this line); \
         where a program wrote indices from 0, add 1 to all of them"
    )]
    IndexZero {
        /// What is named.
        what: &'static str,
        /// The format.
        format: Format,
    },
    /// An index that counts backwards to before the first element.
    #[error(
        "{what} {index} is named, counted backwards from this line, but only {before} come before it"
    )]
    BeforeFirst {
        /// What is named.
        what: &'static str,
        /// Its number as the file has it.
        index: i64,
        /// How many of them come before.
        before: usize,
    },
    /// More elements than the file has bytes for.
    #[error(
        "the file claims {claimed} {what}, but the bytes that follow can hold {possible} at most; it is cut short or its header is wrong"
    )]
    TooMany {
        /// What is counted.
        what: String,
        /// How many the file claims to have.
        claimed: u64,
        /// How many there can be.
        possible: u64,
    },
    /// The file ends before everything was read.
    #[error("the file ends after {found} of {expected} {what}; it is cut short")]
    CutShort {
        /// What is counted.
        what: String,
        /// How many there are.
        found: usize,
        /// How many were announced.
        expected: usize,
    },
    /// The header makes no sense.
    #[error("{problem}")]
    Header {
        /// In which way.
        problem: String,
    },
    /// Something this crate does not read.
    #[error("{what} cannot be read")]
    Unsupported {
        /// What it is.
        what: String,
    },
}

/// What there is, for messages about what there is not.
struct Range<'a> {
    what: &'a str,
    count: usize,
    first: u8,
}

impl fmt::Display for Range<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Range { what, count, first } = *self;
        match count {
            0 => write!(f, "the file has no {what} at all"),
            _ => write!(f, "the file has {count} of them, counted from {first}"),
        }
    }
}

/// A cause with its place, before the line is counted.
#[derive(Debug)]
pub(crate) struct Fault {
    /// The byte it is at.
    pub(crate) at: usize,
    pub(crate) element: Option<(&'static str, Option<usize>)>,
    pub(crate) cause: Cause,
    /// Whether a message names the byte and not the line.
    pub(crate) binary: bool,
}

impl Fault {
    pub(crate) fn new(at: usize, cause: Cause) -> Self {
        Fault { at, element: None, cause, binary: false }
    }

    pub(crate) fn binary(at: usize, cause: Cause) -> Self {
        Fault { at, element: None, cause, binary: true }
    }

    pub(crate) fn header(at: usize, problem: impl Into<String>) -> Self {
        Fault::new(at, Cause::Header { problem: problem.into() })
    }

    /// The same fault, known to be in this kind of element.
    pub(crate) fn within(mut self, element: &'static str) -> Self {
        self.element.get_or_insert((element, None));
        self
    }

    /// The same fault, known to be in this element.
    pub(crate) fn within_number(mut self, element: &'static str, number: usize) -> Self {
        self.element.get_or_insert((element, Some(number)));
        self
    }
}

/// Why a reader stopped.
#[derive(Debug)]
pub(crate) enum Stop {
    Fault(Box<Fault>),
    Other(Error),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Stop::Fault(Box::new(fault))
    }
}

impl From<Cancelled> for Stop {
    fn from(cancelled: Cancelled) -> Self {
        Stop::Other(cancelled.into())
    }
}

impl From<dgp_mesh::Error> for Stop {
    fn from(error: dgp_mesh::Error) -> Self {
        Stop::Other(error.into())
    }
}

/// An error if there are more corners of faces than a list can count.
pub(crate) fn countable(kind: &'static str, count: usize) -> Result<(), dgp_mesh::Error> {
    let limit = FaceList::MAX_CORNERS;
    if count > limit { Err(dgp_mesh::Error::TooMany { kind, count, limit }) } else { Ok(()) }
}

/// "in face 7" for messages.
struct Named(Option<(&'static str, Option<usize>)>);

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            None => Ok(()),
            Some((element, None)) => write!(f, ", {element}"),
            Some((element, Some(number))) => write!(f, ", {element} {number}"),
        }
    }
}
