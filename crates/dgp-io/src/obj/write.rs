//! A document as an OBJ file.

use dgp_mesh::{
    AttributeColumn, COLOR, Cancelled, Color, CornerId, DVec2, FaceId, GROUP, Label, MATERIAL,
    NORMAL, Normal, OBJECT, Progress, SMOOTHING, UV, VertexId,
};

use crate::{
    Document, Error, WEIGHT,
    output::Output,
    print::{Printer, one_line, print_all},
    report::Losses,
    weld::weld,
};

/// The text of an OBJ file. Texture coordinates and normals are written once each.
pub(crate) fn write(
    document: &Document,
    output: &mut Output<'_>,
    losses: &mut Losses,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let set = &document.set;
    let uv_bits = |uv: DVec2| [uv.x.to_bits(), uv.y.to_bits(), 0];
    let normal_bits = |normal: Normal| normal.0.to_array().map(f64::to_bits);
    let uvs = Shared::new(document, UV, losses, uv_bits, progress.part(0.0, 0.1))?;
    let normals = Shared::new(document, NORMAL, losses, normal_bits, progress.part(0.1, 0.2))?;
    note_losses(document, losses);

    output.put(&head(document))?;
    let color = set.vertex_attributes.get::<Color>(COLOR);
    let opaque = color.is_none_or(|color| color.values().iter().all(|color| color.0[3] == 1.0));
    let weight = set.vertex_attributes.get::<f64>(WEIGHT).filter(|_| color.is_none());
    let vertex = |printer: &mut Printer, i: usize| {
        let v = VertexId::new(i);
        printer.text("v ");
        printer.numbers(set.position(v).to_array());
        if let Some(color) = color {
            for &channel in &color[v].0[..if opaque { 3 } else { 4 }] {
                printer.byte(b' ');
                printer.f32(channel);
            }
        }
        if let Some(weight) = weight {
            printer.byte(b' ');
            printer.f64(weight[v]);
        }
        printer.byte(b'\n');
    };
    print_all(output, set.vertex_count(), vertex, progress.part(0.2, 0.4))?;
    if let Some(uvs) = &uvs {
        let print = |printer: &mut Printer, i: usize| {
            printer.text("vt ");
            printer.numbers(uvs.value(i).to_array());
            printer.byte(b'\n');
        };
        print_all(output, uvs.firsts.len(), print, progress.part(0.4, 0.5))?;
    }
    if let Some(normals) = &normals {
        let print = |printer: &mut Printer, i: usize| {
            printer.text("vn ");
            printer.numbers(normals.value(i).0.to_array());
            printer.byte(b'\n');
        };
        print_all(output, normals.firsts.len(), print, progress.part(0.5, 0.6))?;
    }
    let labels = Labels::new(document);
    let face = |printer: &mut Printer, i: usize| {
        let f = FaceId::new(i);
        labels.print_changes(printer, f);
        printer.byte(b'f');
        for (c, v) in set.faces().face_corners(f).zip(set.faces().face(f)) {
            printer.byte(b' ');
            printer.integer(v.index() as i64 + 1);
            let uv = uvs.as_ref().and_then(|uvs| uvs.number(c, *v));
            let normal = normals.as_ref().and_then(|normals| normals.number(c, *v));
            if uv.is_some() || normal.is_some() {
                printer.byte(b'/');
            }
            if let Some(uv) = uv {
                printer.integer(uv);
            }
            if let Some(normal) = normal {
                printer.byte(b'/');
                printer.integer(normal);
            }
        }
        printer.byte(b'\n');
    };
    print_all(output, set.face_count(), face, progress.part(0.6, 1.0))?;
    output.put(&tail(document))
}

/// What comes before the vertices.
fn head(document: &Document) -> Vec<u8> {
    let mut printer = Printer::new();
    for comment in &document.comments {
        for line in comment.split(['\n', '\r']) {
            printer.text("# ");
            printer.text(line);
            printer.byte(b'\n');
        }
    }
    for library in &document.material_libraries {
        printer.text("mtllib ");
        printer.text(&one_line(library));
        printer.byte(b'\n');
    }
    printer.bytes
}

/// What comes after the faces.
fn tail(document: &Document) -> Vec<u8> {
    let mut printer = Printer::new();
    for line in &document.polylines {
        printer.byte(b'l');
        vertices(&mut printer, line);
    }
    if !document.points.is_empty() {
        printer.byte(b'p');
        vertices(&mut printer, &document.points);
    }
    for tag in &document.tags {
        printer.text("t ");
        printer.text(&one_word(&tag.name));
        for (i, count) in
            [tag.integers.len(), tag.floats.len(), tag.strings.len()].into_iter().enumerate()
        {
            printer.byte(if i == 0 { b' ' } else { b'/' });
            printer.integer(count as i64);
        }
        for &integer in &tag.integers {
            printer.byte(b' ');
            printer.integer(integer);
        }
        for &float in &tag.floats {
            printer.byte(b' ');
            printer.f64(float);
        }
        for string in &tag.strings {
            printer.byte(b' ');
            printer.text(&one_word(string));
        }
        printer.byte(b'\n');
    }
    printer.bytes
}

/// A name without what would end a word.
fn one_word(name: &str) -> String {
    let name: String = name.chars().map(|c| if c <= ' ' { '_' } else { c }).collect();
    if name.is_empty() { "_".to_owned() } else { name }
}

fn vertices(printer: &mut Printer, vertices: &[VertexId]) {
    for v in vertices {
        printer.byte(b' ');
        printer.integer(v.index() as i64 + 1);
    }
    printer.byte(b'\n');
}

/// What does not get into the file.
fn note_losses(document: &Document, losses: &mut Losses) {
    let set = &document.set;
    let colors = set.vertex_attributes.get::<Color>(COLOR).is_some();
    let mut vertex = vec![UV, NORMAL];
    if colors {
        vertex.push(COLOR);
    } else if set.vertex_attributes.get::<f64>(WEIGHT).is_some() {
        vertex.push(WEIGHT);
    }
    losses.add_columns(&set.vertex_attributes, &vertex);
    losses.add_columns(&set.corner_attributes, &[UV, NORMAL]);
    let labels = [OBJECT, GROUP, MATERIAL, SMOOTHING];
    losses.add_columns(&set.face_attributes, &labels);
    for name in labels {
        if set.face_attributes.contains(name) && set.face_attributes.get::<Label>(name).is_none() {
            losses.add(format!("face attribute `{name}` is no label"), set.face_count());
        }
    }
    losses.add_elements(document);
}

/// The values of an attribute, each once, and which of them a corner has.
struct Shared<'a, T> {
    values: &'a [T],
    /// By corner or by vertex, from 1; 0 is none.
    numbers: Vec<u32>,
    /// Where in `values` each of them is.
    firsts: Vec<u32>,
    by_corner: bool,
}

impl<'a, T: dgp_mesh::AttributeValue + Copy> Shared<'a, T> {
    fn new(
        document: &'a Document,
        name: &str,
        losses: &mut Losses,
        bits: impl Fn(T) -> [u64; 3],
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let set = &document.set;
        let on_corners = set.corner_attributes.get::<T>(name).map(AttributeColumn::values);
        let on_vertices = set.vertex_attributes.get::<T>(name).map(AttributeColumn::values);
        if on_corners.is_none() && set.corner_attributes.contains(name) {
            losses.add(format!("corner attribute `{name}` is of another type"), 1);
        }
        if on_vertices.is_none() && set.vertex_attributes.contains(name) {
            losses.add(format!("vertex attribute `{name}` is of another type"), 1);
        }
        let by_corner = on_corners.is_some();
        let Some(values) = on_corners.or(on_vertices) else { return Ok(None) };
        if by_corner && on_vertices.is_some() {
            losses.add(format!("vertex attribute `{name}`: corners have their own"), 1);
        }
        if set.faces().is_empty() && !by_corner {
            // Without faces the position in the file tells the vertex.
            let numbers: Vec<u32> = (0..values.len() as u32).collect();
            return Ok(Some(Shared { values, firsts: numbers.clone(), numbers, by_corner }));
        }
        if !by_corner {
            note_unused(document, name, values, losses);
        }
        let welded = weld(values.len(), |i| bits(values[i]), progress)?;
        let mut shared =
            Shared { values, numbers: welded.numbers, firsts: welded.firsts, by_corner };
        for number in &mut shared.numbers {
            *number += 1;
        }
        Ok(Some(shared))
    }

    fn value(&self, i: usize) -> T {
        self.values[self.firsts[i] as usize]
    }

    fn number(&self, c: CornerId, v: VertexId) -> Option<i64> {
        let number = self.numbers[if self.by_corner { c.index() } else { v.index() }];
        (number > 0).then_some(i64::from(number))
    }
}

/// Notes values of vertices without a face, which OBJ cannot name.
fn note_unused<T: dgp_mesh::AttributeValue>(
    document: &Document,
    name: &str,
    values: &[T],
    losses: &mut Losses,
) {
    let mut used = vec![false; values.len()];
    for v in document.set.faces().corners() {
        used[v.index()] = true;
    }
    let zero = T::default();
    let lost = used.iter().zip(values).filter(|&(&used, value)| !used && *value != zero).count();
    losses.add(format!("vertex attribute `{name}` of vertices without a face"), lost);
}

/// The labels of faces, written where they change.
struct Labels<'a>(Vec<(&'static str, AttributeColumn<'a, FaceId, Label>)>);

impl<'a> Labels<'a> {
    fn new(document: &'a Document) -> Self {
        let columns = [("o", OBJECT), ("g", GROUP), ("usemtl", MATERIAL), ("s", SMOOTHING)];
        let column =
            |(keyword, name)| Some((keyword, document.set.face_attributes.get::<Label>(name)?));
        Labels(columns.into_iter().filter_map(column).collect())
    }

    fn print_changes(&self, printer: &mut Printer, f: FaceId) {
        for (keyword, column) in &self.0 {
            let label = &column[f];
            let unchanged = match f.index() {
                0 => label.as_str().is_empty(),
                i => *label == column[FaceId::new(i - 1)],
            };
            if !unchanged {
                printer.text(keyword);
                let off = *keyword == "s" && label.as_str().is_empty();
                if off || !label.as_str().is_empty() {
                    printer.byte(b' ');
                    printer.text(&one_line(if off { "off" } else { label.as_str() }));
                }
                printer.byte(b'\n');
            }
        }
    }
}
