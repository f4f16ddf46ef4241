//! Reading OFF.

use std::ops::Range;

use dgp_mesh::{MAX_ELEMENTS, Progress};

use super::{Kind, binary, keyword, parts::Parts};
use crate::{
    Contents, Encoding, Format,
    error::{Cause, Fault, Stop},
    report::Oddities,
    text::{Cursor, RowCount, Text, decoded, map_blocks},
};

/// Reads an OFF file.
pub(crate) fn read(bytes: &[u8], progress: Progress<'_>) -> Result<Contents, Stop> {
    let text = Text::new(bytes, Format::Off)?;
    let mut cursor = text.start();
    let mut parts;
    let mut comments = Vec::new();
    let mut oddities = Oddities::default();
    cursor.skip_to_word(|comment| comments.push(decoded(comment)));
    let start = cursor.at;
    let kind = if let Some((kind, len)) = keyword(cursor.word()) {
        cursor.at = start + len;
        kind
    } else {
        cursor.at = start;
        if cursor.number().is_err() {
            let expected = "the keyword OFF";
            let cause = Cause::WrongFormat { format: Format::Off, expected };
            return Err(Fault::new(start, cause).into());
        }
        cursor.at = start;
        oddities.add("no keyword OFF at the beginning", start);
        Kind::default()
    };
    let mut after = cursor;
    if after.word() == b"BINARY" {
        after.skip_line();
        return binary::read(bytes, after.at, kind, comments, oddities, progress);
    }
    if kind.dimension {
        let dimension = next_integer(&mut cursor, &mut comments)?;
        if dimension != 3 {
            let what = format!("OFF with vertices of {dimension} dimensions");
            return Err(Fault::new(start, Cause::Unsupported { what }).into());
        }
    }
    let header = Header::parse(&mut cursor, kind, &mut comments)?;
    cursor.skip_to_word(|comment| comments.push(decoded(comment)));

    let blocks = [RowCount::Lines, RowCount::Filled]
        .into_iter()
        .find_map(|count| by_lines(text, cursor.at, &header, count, progress).transpose());
    if let Some(blocks) = blocks {
        parts = Parts::joined(blocks?)?;
        if header.layout.extra > 0 {
            let what = format!("{} unknown numbers after each vertex skipped", header.layout.extra);
            oddities.add(what, cursor.at);
        }
    } else {
        progress.report(0.5)?;
        parts = Parts::by_words(cursor, &header)?;
    }
    comments.append(&mut parts.comments);
    let mut document = parts.into_document(&mut oddities)?;
    document.comments = comments;
    Ok(Contents { document, oddities, encoding: Encoding::Text })
}

/// The counts, and what stands on the line of a vertex.
pub(super) struct Header {
    pub(super) vertices: usize,
    pub(super) faces: usize,
    pub(super) layout: Layout,
}

/// How many numbers of which kind make a vertex, in this order after the position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) weight: bool,
    pub(super) normal: bool,
    /// 0, 3 or 4.
    pub(super) color: usize,
    pub(super) uv: bool,
    /// Numbers that the keyword does not explain.
    pub(super) extra: usize,
}

impl Header {
    fn parse(
        cursor: &mut Cursor<'_>,
        kind: Kind,
        comments: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        cursor.skip_to_word(|comment| comments.push(decoded(comment)));
        let start = cursor.at;
        let vertices = next_integer(cursor, comments)?;
        let faces = next_integer(cursor, comments)?;
        let mut next = *cursor;
        if cursor.ends_line() {
            // The number of edges may stand on a line of its own, or be missing.
            next.skip_to_word(|_| ());
            if next.integer().is_ok() && next.ends_line() {
                *cursor = next;
            }
        } else {
            cursor.integer()?;
        }
        // A vertex takes three digits and three blanks at least, a face a digit and a blank.
        let left = cursor.remaining() as u64 + 1;
        let vertices = checked(vertices, "vertices", left / 6, start)?;
        let faces = checked(faces, "faces", left / 2, start)?;

        let mut first = *cursor;
        first.skip_to_word(|_| ());
        let mut count = 0;
        while !first.ends_line() {
            first.word();
            count += 1;
        }
        let known =
            3 + usize::from(kind.weight) + 3 * usize::from(kind.normal) + 2 * usize::from(kind.uv);
        let rest = if vertices == 0 { 0 } else { count - known.min(count) };
        let color = match rest {
            _ if !kind.color => 0,
            3 => 3,
            _ => 4,
        };
        let Kind { weight, normal, uv, .. } = kind;
        let extra = rest.saturating_sub(color);
        Ok(Header { vertices, faces, layout: Layout { weight, normal, color, uv, extra } })
    }
}

fn next_integer(cursor: &mut Cursor<'_>, comments: &mut Vec<String>) -> Result<i64, Fault> {
    cursor.skip_to_word(|comment| comments.push(decoded(comment)));
    cursor.integer().map_err(|fault| fault.within("header"))
}

pub(super) fn checked(count: i64, what: &str, possible: u64, at: usize) -> Result<usize, Fault> {
    match usize::try_from(count) {
        Ok(count) if count as u64 <= possible && count <= MAX_ELEMENTS => Ok(count),
        Err(_) => Err(Fault::header(at, format!("there cannot be {count} {what}"))),
        Ok(count) => {
            let what = what.to_owned();
            Err(Fault::new(at, Cause::TooMany { what, claimed: count as u64, possible }))
        }
    }
}

/// The file as rows of one vertex or face each, in blocks; `None` if it is not like that.
fn by_lines(
    text: Text<'_>,
    start: usize,
    header: &Header,
    count: RowCount,
    progress: Progress<'_>,
) -> Result<Option<Vec<Parts>>, Stop> {
    let blocks = text.row_blocks(start, count);
    let ranges: Vec<Range<usize>> = blocks.iter().map(|(range, _)| range.clone()).collect();
    let parse = |b: usize, range: Range<usize>| {
        Ok(Parts::by_lines(text.cursor(range), blocks[b].1, header, count))
    };
    let parts = map_blocks(&ranges, parse, progress)?;
    let parts: Option<Vec<Parts>> = parts.into_iter().collect();
    Ok(parts.filter(|parts| {
        parts.iter().map(|part| part.face_ends.len()).sum::<usize>() == header.faces
            && parts.iter().map(|part| part.positions.len()).sum::<usize>() == header.vertices
    }))
}
