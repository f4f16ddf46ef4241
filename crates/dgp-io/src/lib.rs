//! Reads and writes mesh files: OBJ, PLY, STL, OFF, XYZ, PWN.
//!
//! | to | call |
//! |---|---|
//! | read a file | [`read`], [`read_with`] for the report |
//! | read bytes from elsewhere | [`read_bytes`], [`read_bytes_with`] |
//! | write a file | [`write()`] |
//! | write to memory | [`write_bytes`] |
//! | write to a pipe | [`write_to`] |
//! | write a picture or a report | [`write_whole`] |
//!
//! - Everything a file holds is in the [`Document`]; what was skipped is in [`ReadReport::warnings`].
//! - What a format cannot hold is in [`WriteReport::losses`]. All else reads back bit for bit.
//! - A file is written whole or not at all.
//! - A bad file is an [`Error`] with the line or byte, the element and the cause; no file panics,
//!   hangs, or takes more memory than a few times its size.
//!
//! ```
//! use dgp_io::{Format, WriteOptions, read_bytes, write_bytes};
//! use dgp_mesh::Progress;
//!
//! let quad = read_bytes(b"OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", Format::Off)?;
//! let options = WriteOptions::default();
//! let (bytes, report) = write_bytes(&quad, Format::Obj, &options, Progress::NONE)?;
//! assert_eq!(report.losses, []);
//! assert_eq!(read_bytes(&bytes, Format::Obj)?, quad);
//! # Ok::<(), dgp_io::Error>(())
//! ```

mod binary;
mod document;
mod error;
mod file;
mod format;
mod obj;
mod off;
mod output;
mod ply;
mod print;
mod pulse;
mod report;
mod stl;
mod subdivision;
mod text;
mod weld;
mod xyz;

use std::{io, path::Path};

use dgp_mesh::Progress;

pub use document::{
    ATTRIBUTE_BYTES, COLOR_INDEX, Document, ExtraElement, NumberList, RowId, SubdivisionTag, WEIGHT,
};
pub use error::{Cause, Error, Place};
pub use format::{Encoding, Format};
pub use report::{Loss, ReadOptions, ReadReport, Warning, WriteOptions, WriteReport};
pub use subdivision::SubdivisionRules;

use error::{Fault, Stop};
use output::Output;
use report::{Losses, Oddities};

/// The contents of the file at `path`, whose extension tells its format.
pub fn read(path: impl AsRef<Path>) -> Result<Document, Error> {
    Ok(read_with(path, &ReadOptions::default(), Progress::NONE)?.0)
}

/// The contents of the file at `path` and what was odd about it.
pub fn read_with(
    path: impl AsRef<Path>,
    options: &ReadOptions,
    progress: Progress<'_>,
) -> Result<(Document, ReadReport), Error> {
    let path = path.as_ref();
    let format = match options.format {
        Some(format) => format,
        None => Format::from_path(path)?,
    };
    let bytes = file::load(path, progress.part(0.0, 0.2))?;
    let result = read_bytes_with(&bytes, format, progress.part(0.2, 1.0));
    result.map_err(|error| in_file(path, error))
}

/// The contents of a file of this format.
pub fn read_bytes(bytes: &[u8], format: Format) -> Result<Document, Error> {
    Ok(read_bytes_with(bytes, format, Progress::NONE)?.0)
}

/// The contents of a file of this format and what was odd about it.
pub fn read_bytes_with(
    bytes: &[u8],
    format: Format,
    progress: Progress<'_>,
) -> Result<(Document, ReadReport), Error> {
    let result = match format {
        Format::Obj => obj::read(bytes, progress),
        Format::Off => off::read(bytes, progress),
        Format::Ply => ply::read(bytes, progress),
        Format::Stl => stl::read(bytes, progress),
        Format::Xyz | Format::Pwn => xyz::read(bytes, format, progress),
    };
    let place = |text: bool, at: usize| {
        if text { Place::Line(text::line(bytes, at)) } else { Place::Byte(at) }
    };
    match result {
        Ok(Contents { document, oddities, encoding }) => {
            let is_text = encoding == Encoding::Text;
            let warnings = oddities.into_warnings(|at| place(is_text, at));
            Ok((document, ReadReport { format, encoding, bytes: bytes.len(), warnings }))
        }
        Err(Stop::Other(error)) => Err(error),
        Err(Stop::Fault(fault)) => {
            let Fault { at, element, cause, binary } = *fault;
            Err(Error::Malformed { format, place: place(!binary, at), element, cause })
        }
    }
}

/// Writes `document` to the file at `path`, whose extension tells its format.
///
/// The file appears, or takes the place of an older one, when all of it is on the disk. If that
/// fails or is cancelled nothing changes.
pub fn write(
    path: impl AsRef<Path>,
    document: &Document,
    options: &WriteOptions,
    progress: Progress<'_>,
) -> Result<WriteReport, Error> {
    let path = path.as_ref();
    let format = match options.format {
        Some(format) => format,
        None => Format::from_path(path)?,
    };
    // Before there is a file.
    let checked = check(document, format, options);
    let written = checked.and_then(|_| {
        file::store(path, |file| write_to(file, document, format, options, progress))
    });
    written.map_err(|error| in_file(path, error))
}

/// Writes `bytes` to the file at `path`, such as a picture or a report, whole or not at all.
pub fn write_whole(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), Error> {
    file::store(path.as_ref(), |file| Output::new(file).put(bytes))
}

/// The bytes of a file that holds `document`.
pub fn write_bytes(
    document: &Document,
    format: Format,
    options: &WriteOptions,
    progress: Progress<'_>,
) -> Result<(Vec<u8>, WriteReport), Error> {
    let mut bytes = Vec::new();
    let report = write_to(&mut bytes, document, format, options, progress)?;
    Ok((bytes, report))
}

/// Writes a file that holds `document` to a pipe, a socket, an archive.
///
/// It is made piece by piece: a few megabytes of it are in memory at a time. When this fails or is
/// cancelled the writer has got the beginning of it.
pub fn write_to(
    writer: &mut (dyn io::Write + Send),
    document: &Document,
    format: Format,
    options: &WriteOptions,
    progress: Progress<'_>,
) -> Result<WriteReport, Error> {
    let encoding = check(document, format, options)?;
    let mut losses = Losses::default();
    let mut output = Output::new(writer);
    match format {
        Format::Obj => obj::write(document, &mut output, &mut losses, progress),
        Format::Off => off::write(document, encoding, &mut output, &mut losses, progress),
        Format::Ply => ply::write(document, encoding, &mut output, &mut losses, progress),
        Format::Stl => stl::write(document, encoding, &mut output, &mut losses, progress),
        Format::Xyz | Format::Pwn => {
            xyz::write(document, format, &mut output, &mut losses, progress)
        }
    }?;
    if output.bytes() == 0 {
        // A file of 0 bytes is a failed copy; nothing in good order is an empty line.
        output.put(b"\n")?;
    }
    let bytes = output.bytes();
    writer.flush().map_err(|source| Error::Sink { source })?;
    Ok(WriteReport { format, encoding, bytes, losses: losses.0 })
}

/// The encoding to write in, if the document and the options are in order.
fn check(document: &Document, format: Format, options: &WriteOptions) -> Result<Encoding, Error> {
    let encoding = options.encoding.unwrap_or(format.default_encoding());
    if !format.has_encoding(encoding) {
        return Err(Error::UnsupportedEncoding { format, encoding });
    }
    document.validate()?;
    Ok(encoding)
}

/// The error with the path of its file, unless it has it or needs none.
fn in_file(path: &Path, error: Error) -> Error {
    match error {
        Error::Malformed { .. } | Error::Mesh(_) | Error::AttributeLength { .. } => {
            Error::InFile { path: path.to_owned(), source: Box::new(error) }
        }
        other => other,
    }
}

/// What a reader found.
struct Contents {
    document: Document,
    oddities: Oddities,
    encoding: Encoding,
}
