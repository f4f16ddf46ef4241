//! The header of a PLY file.

use dgp_mesh::MAX_ELEMENTS;

use super::number::Scalar;
use crate::{
    Encoding, Format,
    error::{Cause, Fault},
    text::{decoded, shown},
};

/// What the header says.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    pub(super) comments: Vec<String>,
    pub(super) notes: Vec<String>,
    /// Where the header ends.
    pub(super) body: usize,
}

/// A kind of rows.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
    /// Where its line begins.
    pub(super) at: usize,
}

/// A number of each row, or a list of them.
pub(super) struct Property {
    pub(super) name: String,
    /// The type in the file.
    pub(super) scalar: Scalar,
    /// The type of the length of a list.
    pub(super) list: Option<Scalar>,
}

impl Property {
    /// The type in which numbers that stand as text are kept: in full where they are geometry.
    pub(super) fn text_scalar(&self) -> Scalar {
        const GEOMETRY: [&str; 13] = [
            "x",
            "y",
            "z",
            "nx",
            "ny",
            "nz",
            "s",
            "t",
            "u",
            "v",
            "texture_u",
            "texture_v",
            "texcoord",
        ];
        let wide = self.scalar == Scalar::F32 && GEOMETRY.contains(&self.name.as_str());
        if wide { Scalar::F64 } else { self.scalar }
    }
}

impl Element {
    /// What messages call a row of it.
    pub(super) fn kind(&self) -> &'static str {
        match self.name.as_str() {
            "vertex" => "vertex",
            "face" => "face",
            _ => "row",
        }
    }

    /// The fewest bytes a row takes.
    pub(super) fn smallest_row(&self, encoding: Encoding) -> usize {
        match encoding {
            // A digit and a blank each; a row without properties is a line of its own.
            Encoding::Text => (2 * self.properties.len()).max(1),
            _ => self.properties.iter().map(|p| p.list.unwrap_or(p.scalar).size()).sum(),
        }
    }
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        if bytes.is_empty() {
            return Err(Fault::new(0, Cause::Empty));
        }
        let mut lines = Lines::new(bytes);
        if lines.next().map(|(_, line)| line) != Some(b"ply") {
            let cause = Cause::WrongFormat { format: Format::Ply, expected: "the word `ply`" };
            return Err(Fault::new(0, cause));
        }
        let mut encoding = None;
        let mut header = Header {
            encoding: Encoding::Text,
            elements: Vec::new(),
            comments: Vec::new(),
            notes: Vec::new(),
            body: 0,
        };
        while let Some((at, line)) = lines.next() {
            let (word, rest) = split(line);
            match word {
                b"comment" => header.comments.push(decoded(rest)),
                b"obj_info" => header.notes.push(decoded(rest)),
                b"format" => encoding = Some(parse_format(rest, at)?),
                b"element" => header.add_element(rest, at)?,
                b"property" => header.add_property(rest, at)?,
                b"end_header" => {
                    header.body = lines.at;
                    let missing = || Fault::header(at, "the header has no line `format`");
                    header.encoding = encoding.ok_or_else(missing)?;
                    return Ok(header);
                }
                b"" => {}
                _ => {
                    let problem = format!("`{}` means nothing in a header", shown(word));
                    return Err(Fault::header(at, problem));
                }
            }
        }
        Err(Fault::header(bytes.len(), "the header has no line `end_header`; it is cut short"))
    }

    fn add_element(&mut self, rest: &[u8], at: usize) -> Result<(), Fault> {
        let (name, count) = split(rest);
        let name = decoded(name);
        let number = str::from_utf8(count).ok().and_then(|count| count.parse::<u64>().ok());
        let Some(count) = number else {
            return Err(Fault::new(at, Cause::NotAWholeNumber { text: shown(count) }));
        };
        if count > MAX_ELEMENTS as u64 {
            let possible = MAX_ELEMENTS as u64;
            return Err(Fault::new(at, Cause::TooMany { what: name, claimed: count, possible }));
        }
        if self.elements.iter().any(|element| element.name == name) {
            return Err(Fault::header(at, format!("element `{name}` is declared twice")));
        }
        let count = count as usize;
        self.elements.push(Element { name, count, properties: Vec::new(), at });
        Ok(())
    }

    fn add_property(&mut self, rest: &[u8], at: usize) -> Result<(), Fault> {
        let Some(element) = self.elements.last_mut() else {
            return Err(Fault::header(at, "a property before the first element"));
        };
        let scalar = |word: &[u8]| {
            let problem = || Fault::header(at, format!("there is no type `{}`", shown(word)));
            Scalar::from_name(word).ok_or_else(problem)
        };
        let (first, rest) = split(rest);
        let (list, kind, name) = if first == b"list" {
            let (count, rest) = split(rest);
            let (kind, name) = split(rest);
            let count = scalar(count)?;
            if !count.is_whole() {
                return Err(Fault::header(at, "the length of a list must be a whole number"));
            }
            (Some(count), kind, name)
        } else {
            (None, first, rest)
        };
        let (scalar, name) = (scalar(kind)?, decoded(name));
        if name.is_empty() {
            return Err(Fault::header(at, "a property without a name"));
        }
        if element.properties.iter().any(|property| property.name == name) {
            let problem = format!("property `{name}` of `{}` is declared twice", element.name);
            return Err(Fault::header(at, problem));
        }
        element.properties.push(Property { name, scalar, list });
        Ok(())
    }
}

fn parse_format(rest: &[u8], at: usize) -> Result<Encoding, Fault> {
    match split(rest) {
        (b"ascii", _) => Ok(Encoding::Text),
        (b"binary_little_endian", _) => Ok(Encoding::LittleEndian),
        (b"binary_big_endian", _) => Ok(Encoding::BigEndian),
        (other, _) => Err(Fault::header(at, format!("there is no format `{}`", shown(other)))),
    }
}

/// The first word and what follows it.
fn split(line: &[u8]) -> (&[u8], &[u8]) {
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii())
}

/// The lines of the header, without blanks around them.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    eol: u8,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        // The first line tells how lines end: a body of bytes may have any.
        let end = memchr::memchr2(b'\n', b'\r', bytes);
        let old = end.is_some_and(|end| bytes[end] == b'\r' && bytes.get(end + 1) != Some(&b'\n'));
        Lines { bytes, at: 0, eol: if old { b'\r' } else { b'\n' } }
    }

    /// The next line and where it begins.
    fn next(&mut self) -> Option<(usize, &'a [u8])> {
        let start = self.at;
        let rest = self.bytes.get(start..).filter(|rest| !rest.is_empty())?;
        let end = memchr::memchr(self.eol, rest).unwrap_or(rest.len());
        self.at = (start + end + 1).min(self.bytes.len());
        Some((start, rest[..end].trim_ascii()))
    }
}
