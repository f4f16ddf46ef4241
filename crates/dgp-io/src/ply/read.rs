//! Reading PLY.

use std::ops::Range;

use dgp_mesh::Progress;

use super::{
    assemble::{Body, assemble},
    header::{Element, Header},
    number::Scalar,
    table::{Column, Table},
};
use crate::{
    Contents, Encoding, Format,
    error::{Cause, Fault, Stop},
    report::Oddities,
    text::{Cursor, RowCount, Text, map_blocks},
};

/// Reads a PLY file.
pub(crate) fn read(bytes: &[u8], progress: Progress<'_>) -> Result<Contents, Stop> {
    let header = Header::parse(bytes)?;
    check_counts(&header, bytes.len())?;
    let mut oddities = Oddities::default();
    let body = if header.encoding == Encoding::Text {
        text_body(bytes, &header, progress.part(0.0, 0.8))?
    } else {
        binary_body(bytes, &header, &mut oddities, progress.part(0.0, 0.5))?
    };
    let left = if header.encoding == Encoding::Text { 0.8 } else { 0.5 };
    let left = progress.part(left, 1.0);
    left.report(0.0)?;
    let mut document = assemble(&header, body, bytes, &mut oddities, left)?;
    document.comments = header.comments;
    document.notes = header.notes;
    Ok(Contents { document, oddities, encoding: header.encoding })
}

/// Refuses counts that the rest of the file has no room for, before anything is made for them.
fn check_counts(header: &Header, len: usize) -> Result<(), Fault> {
    // The last number of a text needs no blank behind it.
    let mut left = len - header.body + usize::from(header.encoding == Encoding::Text);
    for element in &header.elements {
        let size = element.smallest_row(header.encoding);
        if size > 0 && element.count > left / size {
            let (claimed, possible) = (element.count as u64, (left / size) as u64);
            let what = format!("rows of `{}`", element.name);
            return Err(Fault::new(element.at, Cause::TooMany { what, claimed, possible }));
        }
        left -= size * element.count;
    }
    Ok(())
}

fn binary_body<'a>(
    bytes: &'a [u8],
    header: &Header,
    oddities: &mut Oddities,
    progress: Progress<'_>,
) -> Result<Body<'a>, Stop> {
    let big = header.encoding == Encoding::BigEndian;
    let mut at = header.body;
    let mut tables = Vec::new();
    let mut starts = Vec::new();
    for element in &header.elements {
        starts.push(at);
        let part = |at: usize| at as f64 / bytes.len() as f64;
        let progress = progress.part(part(at), 1.0);
        let (table, end) = Table::from_bytes(bytes, at, element, big, progress)?;
        tables.push(table);
        at = end;
    }
    if at < bytes.len() {
        oddities.add(format!("{} bytes after the last row skipped", bytes.len() - at), header.body);
    }
    Ok(Body { tables, starts, by_lines: false })
}

fn text_body<'a>(
    bytes: &'a [u8],
    header: &Header,
    progress: Progress<'_>,
) -> Result<Body<'a>, Stop> {
    let mut first = 0;
    let starts: Vec<usize> = header
        .elements
        .iter()
        .map(|element| {
            first += element.count;
            first - element.count
        })
        .collect();
    if first == 0 {
        let tables = new_columns(header).into_iter().map(Table::Columns).collect();
        return Ok(Body { tables, starts, by_lines: true });
    }
    let text = Text::new(bytes, Format::Ply)?;
    for count in [RowCount::Lines, RowCount::Filled] {
        if let Some(columns) = by_lines(text, header, count, progress)? {
            let tables = columns.into_iter().map(Table::Columns).collect();
            return Ok(Body { tables, starts, by_lines: true });
        }
    }
    progress.report(0.5)?;
    let columns = by_words(text.cursor(header.body..bytes.len()), header)?;
    let tables = columns.into_iter().map(Table::Columns).collect();
    Ok(Body { tables, starts, by_lines: false })
}

/// Empty columns for each property of each element.
fn new_columns(header: &Header) -> Vec<Vec<Column>> {
    let columns = |element: &Element| {
        let properties = element.properties.iter();
        properties.map(|property| Column::new(property, property.text_scalar())).collect()
    };
    header.elements.iter().map(columns).collect()
}

/// The columns of a text in which each row is a line; `None` if it is not like that.
fn by_lines(
    text: Text<'_>,
    header: &Header,
    count: RowCount,
    progress: Progress<'_>,
) -> Result<Option<Vec<Vec<Column>>>, Stop> {
    let blocks = text.row_blocks(header.body, count);
    let ranges: Vec<Range<usize>> = blocks.iter().map(|(range, _)| range.clone()).collect();
    let parse = |b: usize, range: Range<usize>| {
        Ok(block_by_lines(text.cursor(range), blocks[b].1, header, count))
    };
    let parts = map_blocks(&ranges, parse, progress)?;
    let mut all = new_columns(header);
    let mut rows = 0;
    for part in parts {
        let Some((part, count)) = part else { return Ok(None) };
        rows += count;
        for (column, later) in all.iter_mut().flatten().zip(part.into_iter().flatten()) {
            column.append(later)?;
        }
    }
    let total: usize = header.elements.iter().map(|element| element.count).sum();
    Ok((rows == total).then_some(all))
}

/// The rows of a block, of which `row` is the first, and how many there are.
fn block_by_lines(
    mut cursor: Cursor<'_>,
    mut row: usize,
    header: &Header,
    count: RowCount,
) -> Option<(Vec<Vec<Column>>, usize)> {
    let first_row = row;
    let mut columns = new_columns(header);
    let mut end = 0;
    for (element, columns) in header.elements.iter().zip(&mut columns) {
        end += element.count;
        while row < end && !cursor.is_at_end() {
            if !cursor.ends_line() {
                for (column, property) in columns.iter_mut().zip(&element.properties) {
                    column.push_text(&mut cursor, property, number_here).ok()?;
                }
                if !cursor.ends_line() {
                    return None;
                }
                row += 1;
            } else if count == RowCount::Lines {
                return None;
            }
            cursor.skip_line();
        }
    }
    Some((columns, row - first_row))
}

#[inline]
fn number_here(cursor: &mut Cursor<'_>, scalar: Scalar) -> Result<f64, Fault> {
    if scalar.is_whole() {
        let start = cursor.at;
        if let Ok(number) = cursor.integer() {
            return Ok(number as f64);
        }
        cursor.at = start;
    }
    cursor.number()
}

/// The columns of a text, wherever lines end.
fn by_words(mut cursor: Cursor<'_>, header: &Header) -> Result<Vec<Vec<Column>>, Fault> {
    let number = |cursor: &mut Cursor<'_>, scalar: Scalar| {
        cursor.skip_to_word(|_| ());
        number_here(cursor, scalar)
    };
    let mut columns = new_columns(header);
    for (element, columns) in header.elements.iter().zip(&mut columns) {
        if element.properties.is_empty() {
            continue;
        }
        for row in 0..element.count {
            for (column, property) in columns.iter_mut().zip(&element.properties) {
                column.push_text(&mut cursor, property, number).map_err(|fault| {
                    let mut fault = fault;
                    if let Cause::TooFewNumbers { .. } = fault.cause {
                        let what = format!("rows of `{}`", element.name);
                        fault.cause = Cause::CutShort { what, found: row, expected: element.count };
                    }
                    fault.within_number(element.kind(), row)
                })?;
            }
        }
    }
    Ok(columns)
}
