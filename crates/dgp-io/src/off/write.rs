//! Writing OFF.

use std::{mem, ops::Range};

use dgp_mesh::{
    AttributeColumn, COLOR, Color, DVec2, DVec3, FaceId, NORMAL, Normal, Progress, UV, VertexId,
};

use crate::{
    COLOR_INDEX, Document, Encoding, Error, WEIGHT,
    binary::{ByteWriter, rounded},
    output::Output,
    print::{Printer, print_all},
    report::Losses,
};

/// An OFF file.
pub(crate) fn write(
    document: &Document,
    encoding: Encoding,
    output: &mut Output<'_>,
    losses: &mut Losses,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let columns = Columns::new(document);
    columns.note_losses(document, losses);
    if encoding == Encoding::Text {
        text(document, &columns, output, progress)
    } else {
        binary(document, &columns, encoding, output, losses, progress)
    }
}

/// The attributes that OFF holds.
struct Columns<'a> {
    weights: Option<&'a [f64]>,
    normals: Option<&'a [Normal]>,
    colors: Option<&'a [Color]>,
    uvs: Option<&'a [DVec2]>,
    face_colors: Option<&'a [Color]>,
    face_color_indices: Option<&'a [i32]>,
}

impl<'a> Columns<'a> {
    fn new(document: &'a Document) -> Self {
        let set = &document.set;
        let vertex = &set.vertex_attributes;
        Columns {
            weights: vertex.get(WEIGHT).map(AttributeColumn::values),
            normals: vertex.get(NORMAL).map(AttributeColumn::values),
            colors: vertex.get(COLOR).map(AttributeColumn::values),
            uvs: vertex.get(UV).map(AttributeColumn::values),
            face_colors: set.face_attributes.get(COLOR).map(AttributeColumn::values),
            face_color_indices: set.face_attributes.get(COLOR_INDEX).map(AttributeColumn::values),
        }
    }

    fn keyword(&self) -> String {
        let letters = [
            (self.uvs.is_some(), "ST"),
            (self.colors.is_some(), "C"),
            (self.normals.is_some(), "N"),
            (self.weights.is_some(), "4"),
        ];
        let letters = letters.iter().filter(|(there, _)| *there).map(|(_, letters)| *letters);
        letters.chain(["OFF"]).collect()
    }

    /// How many numbers single precision does not hold.
    fn rounded(&self, document: &Document) -> usize {
        rounded(document.set.positions().values(), DVec3::to_array)
            + rounded(self.weights.unwrap_or_default(), |&weight| [weight])
            + rounded(self.normals.unwrap_or_default(), |normal| normal.0.to_array())
            + rounded(self.uvs.unwrap_or_default(), DVec2::to_array)
    }

    fn note_losses(&self, document: &Document, losses: &mut Losses) {
        let set = &document.set;
        let kept = [
            (self.weights.is_some(), WEIGHT),
            (self.normals.is_some(), NORMAL),
            (self.colors.is_some(), COLOR),
            (self.uvs.is_some(), UV),
        ];
        let kept: Vec<&str> = kept.iter().filter(|(there, _)| *there).map(|kept| kept.1).collect();
        losses.add_columns(&set.vertex_attributes, &kept);
        losses.add_columns(&set.corner_attributes, &[]);
        match (self.face_colors, self.face_color_indices) {
            (Some(_), _) => losses.add_columns(&set.face_attributes, &[COLOR]),
            (None, Some(_)) => losses.add_columns(&set.face_attributes, &[COLOR_INDEX]),
            (None, None) => losses.add_columns(&set.face_attributes, &[]),
        }
        losses.add_extras(document);
    }
}

fn text(
    document: &Document,
    columns: &Columns<'_>,
    output: &mut Output<'_>,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let set = &document.set;
    let mut head = Printer::new();
    head.text(&columns.keyword());
    head.byte(b'\n');
    for comment in &document.comments {
        for line in comment.split(['\n', '\r']) {
            head.text("# ");
            head.text(line);
            head.byte(b'\n');
        }
    }
    for (i, count) in [set.vertex_count(), set.face_count(), 0].into_iter().enumerate() {
        head.text(if i == 0 { "" } else { " " });
        head.integer(count as i64);
    }
    head.byte(b'\n');
    output.put(&head.bytes)?;

    let style = columns.colors.map(ColorStyle::of);
    let vertex = |printer: &mut Printer, i: usize| {
        printer.numbers(set.position(VertexId::new(i)).to_array());
        if let Some(weights) = columns.weights {
            printer.byte(b' ');
            printer.f64(weights[i]);
        }
        if let Some(normals) = columns.normals {
            printer.byte(b' ');
            printer.numbers(normals[i].0.to_array());
        }
        if let (Some(colors), Some(style)) = (columns.colors, style) {
            style.print(printer, colors[i]);
        }
        if let Some(uvs) = columns.uvs {
            printer.byte(b' ');
            printer.numbers(uvs[i].to_array());
        }
        printer.byte(b'\n');
    };
    print_all(output, set.vertex_count(), vertex, progress.part(0.0, 0.5))?;

    let style = columns.face_colors.map(ColorStyle::of);
    let face = |printer: &mut Printer, i: usize| {
        let face = set.faces().face(FaceId::new(i));
        printer.integer(face.len() as i64);
        for v in face {
            printer.byte(b' ');
            printer.integer(v.index() as i64);
        }
        if let (Some(colors), Some(style)) = (columns.face_colors, style) {
            style.print(printer, colors[i]);
        } else if let Some(indices) = columns.face_color_indices
            && indices[i] >= 0
        {
            printer.byte(b' ');
            printer.integer(i64::from(indices[i]));
        }
        printer.byte(b'\n');
    };
    print_all(output, set.face_count(), face, progress.part(0.5, 1.0))
}

/// How the colors of a column are written.
#[derive(Clone, Copy)]
struct ColorStyle {
    /// As 0..255 instead of 0..1.
    bytes: bool,
    alpha: bool,
}

impl ColorStyle {
    fn of(colors: &[Color]) -> Self {
        let exact = |color: &Color| Color::from_rgba8(color.to_rgba8()) == *color;
        // Whole numbers that are all 0 or 1 would be taken for 0..1.
        let beyond_one = colors.iter().any(|color| color.to_rgba8()[..3].iter().any(|&x| x > 1));
        let alpha = colors.iter().any(|color| color.0[3] != 1.0);
        ColorStyle { bytes: beyond_one && colors.iter().all(exact), alpha }
    }

    fn print(self, printer: &mut Printer, color: Color) {
        let count = if self.alpha { 4 } else { 3 };
        if self.bytes {
            for channel in &color.to_rgba8()[..count] {
                printer.byte(b' ');
                printer.integer(i64::from(*channel));
            }
        } else {
            for &channel in &color.0[..count] {
                printer.byte(b' ');
                printer.f32_with_point(channel);
            }
        }
    }
}

fn binary(
    document: &Document,
    columns: &Columns<'_>,
    encoding: Encoding,
    output: &mut Output<'_>,
    losses: &mut Losses,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let set = &document.set;
    let mut head = ByteWriter::new(encoding);
    head.bytes.extend_from_slice(columns.keyword().as_bytes());
    head.bytes.extend_from_slice(b" BINARY\n");
    for count in [set.vertex_count(), set.face_count(), 0] {
        head.u32(count as u32);
    }
    output.put(&head.bytes)?;
    let vertex = |writer: &mut ByteWriter, i: usize| {
        let position = set.position(VertexId::new(i)).to_array();
        let weight = columns.weights.map(|weights| weights[i]);
        let normal = columns.normals.map(|normals| normals[i].0.to_array());
        let numbers = position.into_iter().chain(weight);
        numbers.chain(normal.into_iter().flatten()).for_each(|x| writer.f32(x as f32));
        if let Some(colors) = columns.colors {
            colors[i].0.iter().for_each(|&x| writer.f32(x));
        }
        if let Some(uvs) = columns.uvs {
            uvs[i].to_array().into_iter().for_each(|x| writer.f32(x as f32));
        }
    };
    binary_rows(output, set.vertex_count(), encoding, vertex, progress.part(0.0, 0.5))?;
    let face = |writer: &mut ByteWriter, i: usize| {
        let face = set.faces().face(FaceId::new(i));
        writer.u32(face.len() as u32);
        for v in face {
            writer.u32(v.index() as u32);
        }
        if let Some(colors) = columns.face_colors {
            writer.u32(4);
            colors[i].0.iter().for_each(|&x| writer.f32(x));
        } else if let Some(indices) = columns.face_color_indices
            && indices[i] >= 0
        {
            writer.u32(1);
            writer.i32(indices[i]);
        } else {
            writer.u32(0);
        }
    };
    binary_rows(output, set.face_count(), encoding, face, progress.part(0.5, 1.0))?;
    losses.add("numbers rounded to single precision", columns.rounded(document));
    losses.add("comments have no place in the format", document.comments.len());
    Ok(())
}

/// Vertices or faces a thread writes at a time.
const BLOCK: usize = 1 << 13;

fn binary_rows(
    output: &mut Output<'_>,
    len: usize,
    encoding: Encoding,
    row: impl Fn(&mut ByteWriter, usize) + Sync + Send,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let rows = |range: Range<usize>, room: &mut Vec<u8>| {
        let mut writer = ByteWriter::onto(mem::take(room), encoding);
        range.for_each(|i| row(&mut writer, i));
        *room = writer.bytes;
    };
    output.blocks(len, BLOCK, rows, progress)
}
