//! Points as lines of text: XYZ (`x y z`, or more) and PWN (`x y z nx ny nz`).
//!
//! The numbers of the first line tell the columns: 3 are a position, 6 a position and a normal, in
//! XYZ files 6 whole numbers behind which are a color, 9 a position, a normal and a color from 0 to
//! 255. Other columns are kept as attributes `column4`, `column5` and so on. A first line of one whole
//! number is the number of points. Commas separate as blanks do.

use std::ops::Range;

use dgp_mesh::{COLOR, Color, DVec3, FaceList, IndexedFaceSet, NORMAL, Normal, Progress, VertexId};

use crate::{
    Contents, Document, Encoding, Error, Format,
    error::{Cause, Fault, Stop},
    output::Output,
    print::{Printer, print_all},
    report::{Losses, Oddities},
    text::{Cursor, Text, decoded, map_blocks},
};

/// More columns than any file has on purpose: a limit to what a line can make us keep.
const MOST_COLUMNS: usize = 64;

/// Reads a file of points.
pub(crate) fn read(bytes: &[u8], format: Format, progress: Progress<'_>) -> Result<Contents, Stop> {
    let text = Text::new(bytes, format)?;
    let mut cursor = text.start();
    let mut oddities = Oddities::default();
    let mut comments = Vec::new();
    cursor.skip_to_word(|comment| comments.push(decoded(comment)));
    let claimed = count_line(&mut cursor)?;
    cursor.skip_to_word(|comment| comments.push(decoded(comment)));
    let columns = width(cursor)?;

    let ranges = text.blocks(cursor.at);
    let parse = |_: usize, range: Range<usize>| Ok(Block::parse(text.cursor(range), columns)?);
    let blocks = map_blocks(&ranges, parse, progress)?;
    let mut numbers: Vec<f64> = Vec::new();
    for block in blocks {
        numbers.extend(block.numbers);
        comments.extend(block.comments);
    }
    let rows = numbers.len() / columns.max(1);
    if let Some(claimed) = claimed
        && claimed != rows
    {
        let what = format!("the first line claims {claimed} points, but there are {rows}");
        oddities.add(what, 0);
    }
    let row = |v: usize| &numbers[v * columns..(v + 1) * columns];
    let triple = |at: usize| move |v: usize| DVec3::new(row(v)[at], row(v)[at + 1], row(v)[at + 2]);
    let positions: Vec<DVec3> = (0..rows).map(triple(0)).collect();
    let mut set = IndexedFaceSet::new(positions, FaceList::new())?;
    if rows > 0 {
        let bytes_at = |at: usize| {
            let byte = |x: &f64| x.fract() == 0.0 && (0.0..=255.0).contains(x);
            (0..rows).all(|v| row(v)[at..at + 3].iter().all(byte))
        };
        let color = |at: usize| {
            let color = |p: DVec3| Color::from_rgb8([p.x as u8, p.y as u8, p.z as u8]);
            (0..rows).map(triple(at)).map(color).collect::<Vec<Color>>()
        };
        let normals = |at| (0..rows).map(triple(at)).map(Normal).collect::<Vec<Normal>>();
        let mut next = 3;
        let beyond_one = || (0..rows).any(|v| row(v)[3..6].iter().any(|&x| x > 1.0));
        if columns == 6 && format == Format::Xyz && bytes_at(3) && beyond_one() {
            set.vertex_attributes.insert(COLOR, color(3));
            next = 6;
        } else if columns == 6 || columns == 9 {
            set.vertex_attributes.insert(NORMAL, normals(3));
            next = 6;
        }
        if columns == 9 && bytes_at(6) {
            set.vertex_attributes.insert(COLOR, color(6));
            next = 9;
        }
        for k in next..columns {
            let column: Vec<f64> = (0..rows).map(|v| row(v)[k]).collect();
            set.vertex_attributes.insert(&format!("column{}", k + 1), column);
        }
    }
    let mut document = Document::from(set);
    document.comments = comments;
    Ok(Contents { document, oddities, encoding: Encoding::Text })
}

/// The number of points, if the line has one whole number and nothing else.
fn count_line(cursor: &mut Cursor<'_>) -> Result<Option<usize>, Fault> {
    let mut line = *cursor;
    let Ok(count) = line.integer() else { return Ok(None) };
    if !line.ends_line() {
        return Ok(None);
    }
    let at = cursor.at;
    *cursor = line;
    // A point takes three digits and three blanks at least.
    let possible = cursor.remaining() as u64 / 6 + 1;
    match usize::try_from(count) {
        Ok(count) if count as u64 <= possible => Ok(Some(count)),
        _ => {
            let (what, claimed) = ("points".to_owned(), count.unsigned_abs());
            Err(Fault::new(at, Cause::TooMany { what, claimed, possible }))
        }
    }
}

/// How many numbers the line at the cursor has; 3 where there is none.
fn width(mut cursor: Cursor<'_>) -> Result<usize, Fault> {
    let start = cursor.at;
    if cursor.is_at_end() {
        return Ok(3);
    }
    let mut width = 0;
    while !ends_row(&mut cursor) && width < MOST_COLUMNS {
        cursor.separated_number()?;
        width += 1;
    }
    if width < 3 {
        return Err(Fault::new(start, Cause::TooFewNumbers { found: width, expected: 3 }));
    }
    Ok(width)
}

/// The numbers of a block, row after row.
#[derive(Default)]
struct Block {
    numbers: Vec<f64>,
    comments: Vec<String>,
}

impl Block {
    fn parse(mut cursor: Cursor<'_>, columns: usize) -> Result<Self, Fault> {
        let mut block = Block::default();
        loop {
            cursor.skip_to_word(|comment| block.comments.push(decoded(comment)));
            if cursor.is_at_end() {
                return Ok(block);
            }
            let start = cursor.at;
            for found in 0..columns {
                if ends_row(&mut cursor) {
                    let cause = Cause::TooFewNumbers { found, expected: columns };
                    return Err(Fault::new(start, cause).within("point"));
                }
                let number = cursor.separated_number().map_err(|fault| fault.within("point"))?;
                block.numbers.push(number);
            }
            if !ends_row(&mut cursor) {
                let problem = format!("more than the {columns} numbers of the first point");
                return Err(Fault::new(cursor.at, Cause::Header { problem }).within("point"));
            }
        }
    }
}

/// Whether the line has no more words, separators left aside.
fn ends_row(cursor: &mut Cursor<'_>) -> bool {
    while !cursor.ends_line() {
        if cursor.peek() != b',' {
            return false;
        }
        cursor.at += 1;
    }
    true
}

/// A file of points, one a line.
pub(crate) fn write(
    document: &Document,
    format: Format,
    output: &mut Output<'_>,
    losses: &mut Losses,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let set = &document.set;
    let normals = set.vertex_attributes.get::<Normal>(NORMAL);
    let exact = |color: &Color| Color::from_rgba8(color.to_rgba8()) == *color && color.0[3] == 1.0;
    let colors = set.vertex_attributes.get::<Color>(COLOR);
    let colors = colors.filter(|colors| {
        let beyond_one =
            || colors.values().iter().any(|color| color.to_rgba8()[..3].iter().any(|&x| x > 1));
        let told = normals.is_some() || (format == Format::Xyz && beyond_one());
        told && colors.values().iter().all(exact)
    });
    let mut kept = Vec::new();
    kept.extend(normals.map(|_| NORMAL));
    kept.extend(colors.map(|_| COLOR));
    losses.add_columns(&set.vertex_attributes, &kept);
    losses.add("faces have no place in the format", set.face_count());
    losses.add_extras(document);

    let mut head = Printer::new();
    for comment in &document.comments {
        for line in comment.split(['\n', '\r']) {
            head.text("# ");
            head.text(line);
            head.byte(b'\n');
        }
    }
    let point = |printer: &mut Printer, i: usize| {
        let v = VertexId::new(i);
        printer.numbers(set.position(v).to_array());
        if let Some(normals) = normals {
            printer.byte(b' ');
            printer.numbers(normals[v].0.to_array());
        }
        if let Some(colors) = colors {
            for &channel in &colors[v].to_rgba8()[..3] {
                printer.byte(b' ');
                printer.integer(i64::from(channel));
            }
        }
        printer.byte(b'\n');
    };
    output.put(&head.bytes)?;
    print_all(output, set.vertex_count(), point, progress)
}
