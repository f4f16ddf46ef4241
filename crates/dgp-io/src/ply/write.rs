//! Writing PLY.

use std::{mem, ops::Range};

use dgp_mesh::{
    AttributeColumn, AttributeTable, AttributeValue, COLOR, Color, DVec2, DVec3, FaceList, Id,
    Label, NORMAL, Normal, Progress, UV, VertexId,
};

use super::{
    number::Scalar,
    property::{Property, Value, float_type, length_type, list_type},
    rows::PREFIX,
    strided::Strided,
};
use crate::{
    Document, Encoding, Error, NumberList,
    binary::ByteWriter,
    output::Output,
    print::{Printer, print_all},
    report::Losses,
};

/// Rows a thread writes at a time: with what they are made of they fit the second-level cache.
const BLOCK: usize = 1 << 12;

/// A PLY file. Positions, normals and texture coordinates are `float` where that is exact, colors
/// `uchar` where that is.
pub(crate) fn write(
    document: &Document,
    encoding: Encoding,
    output: &mut Output<'_>,
    losses: &mut Losses,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let set = &document.set;
    let mut vertex = Rows::new("vertex", set.vertex_count());
    vertex.triple(["x", "y", "z"], set.positions().values(), |p| *p);
    vertex.mesh_attributes(&set.vertex_attributes, losses);
    let mut face = Rows::new("face", set.face_count());
    face.corners(set.faces());
    if let Some(uvs) = set.corner_attributes.get::<DVec2>(UV) {
        face.corner_uvs(set.faces(), uvs.values());
        losses.add_columns(&set.corner_attributes, &[UV]);
    } else {
        losses.add_columns(&set.corner_attributes, &[]);
    }
    face.mesh_attributes(&set.face_attributes, losses);
    let mut elements = vec![vertex];
    // A cloud of points has no element for faces.
    if set.face_count() > 0 {
        elements.push(face);
    }
    for extra in &document.elements {
        let taken = elements.iter().any(|rows| rows.name == extra.name);
        let name_fits = !extra.name.is_empty() && !extra.name.contains(char::is_whitespace);
        if taken || !name_fits || extra.name == "face" {
            losses.add(
                format!("element `{}`: the name cannot be used", extra.name),
                extra.rows.len(),
            );
            continue;
        }
        let mut rows = Rows::new(&extra.name, extra.rows.len());
        rows.attributes(&extra.rows, &[], losses);
        elements.push(rows);
    }
    losses.add_without_elements(document);

    output.put(&header(document, encoding, &elements))?;
    let total: usize = elements.iter().map(|rows| rows.count).sum();
    let mut done = 0;
    for rows in &elements {
        let fraction = |count: usize| count as f64 / total.max(1) as f64;
        let progress = progress.part(fraction(done), fraction(done + rows.count));
        done += rows.count;
        rows.write(encoding, output, progress)?;
    }
    Ok(())
}

fn header(document: &Document, encoding: Encoding, elements: &[Rows<'_>]) -> Vec<u8> {
    let mut head = Printer::new();
    head.text("ply\nformat ");
    head.text(match encoding {
        Encoding::Text => "ascii",
        Encoding::LittleEndian => "binary_little_endian",
        Encoding::BigEndian => "binary_big_endian",
    });
    head.text(" 1.0\n");
    let texts = [("comment", &document.comments), ("obj_info", &document.notes)];
    for (keyword, texts) in texts {
        for line in texts.iter().flat_map(|text| text.split(['\n', '\r'])) {
            head.text(keyword);
            head.byte(b' ');
            head.text(line);
            head.byte(b'\n');
        }
    }
    for rows in elements {
        head.text(&format!("element {} {}\n", rows.name, rows.count));
        for property in &rows.properties {
            head.text("property ");
            if let Some(kind) = property.list() {
                head.text(&format!("list {kind} "));
            }
            head.text(&format!("{} {}\n", property.scalar, property.name));
        }
    }
    head.text("end_header\n");
    head.bytes
}

/// The rows of an element.
struct Rows<'a> {
    name: &'a str,
    count: usize,
    properties: Vec<Property<'a>>,
}

impl<'a> Rows<'a> {
    fn new(name: &'a str, count: usize) -> Self {
        Rows { name, count, properties: Vec::new() }
    }

    fn number(
        &mut self,
        name: impl Into<String>,
        scalar: Scalar,
        value: impl Fn(usize) -> f64 + Copy + Send + Sync + 'a,
    ) {
        // A loop of its own for each property: a call per number takes longer than the number.
        let fill =
            move |rows: &mut Strided<'_>, range: Range<usize>| rows.fill(scalar, range.map(value));
        let value = Value::Number(Box::new(value), Box::new(fill));
        self.properties.push(Property { name: name.into(), scalar, wide: false, value });
    }

    /// Three numbers of geometry.
    fn triple<T: Sync>(
        &mut self,
        names: [&str; 3],
        values: &'a [T],
        vector: impl Fn(&T) -> DVec3 + Copy + Send + Sync + 'a,
    ) {
        let scalar = float_type(values, |value| vector(value).to_array());
        for (k, name) in names.into_iter().enumerate() {
            self.number(name, scalar, move |i| vector(&values[i])[k]);
            self.widen();
        }
    }

    fn widen(&mut self) {
        if let Some(last) = self.properties.last_mut() {
            last.wide = true;
        }
    }

    fn corners(&mut self, faces: &'a FaceList) {
        let longest = faces.iter().map(|(_, face)| face.len()).max().unwrap_or(0);
        let value = Value::Corners(length_type(longest), faces);
        let (name, scalar) = ("vertex_indices".to_owned(), Scalar::I32);
        self.properties.push(Property { name, scalar, wide: false, value });
    }

    fn corner_uvs(&mut self, faces: &'a FaceList, uvs: &'a [DVec2]) {
        let longest = faces.iter().map(|(_, face)| 2 * face.len()).max().unwrap_or(0);
        let scalar = float_type(uvs, DVec2::to_array);
        let value = Value::Uvs(length_type(longest), faces, uvs);
        self.properties.push(Property { name: "texcoord".to_owned(), scalar, wide: true, value });
    }

    /// The attributes of vertices or faces.
    fn mesh_attributes<I: Id>(&mut self, table: &'a AttributeTable<I>, losses: &mut Losses) {
        let mut known = Vec::new();
        if let Some(normals) = table.get::<Normal>(NORMAL).map(AttributeColumn::values) {
            self.triple(["nx", "ny", "nz"], normals, |normal| normal.0);
            known.push(NORMAL);
        }
        if let Some(colors) = table.get::<Color>(COLOR).map(AttributeColumn::values) {
            self.colors(colors);
            known.push(COLOR);
        }
        let uvs = table.get::<DVec2>(UV).map(AttributeColumn::values);
        if let Some(uvs) = uvs.filter(|_| I::KIND == VertexId::KIND) {
            let scalar = float_type(uvs, DVec2::to_array);
            for (k, name) in ["s", "t"].into_iter().enumerate() {
                self.number(name, scalar, move |i| uvs[i][k]);
                self.widen();
            }
            known.push(UV);
        }
        self.attributes(table, &known, losses);
    }

    fn colors(&mut self, colors: &'a [Color]) {
        let exact = |color: &Color| Color::from_rgba8(color.to_rgba8()) == *color;
        let bytes = colors.iter().all(exact);
        let opaque = colors.iter().all(|color| color.0[3] == 1.0);
        let names = ["red", "green", "blue", "alpha"];
        for (k, name) in names.into_iter().take(if opaque { 3 } else { 4 }).enumerate() {
            if bytes {
                self.number(name, Scalar::U8, move |i| f64::from(colors[i].to_rgba8()[k]));
            } else {
                self.number(name, Scalar::F32, move |i| f64::from(colors[i].0[k]));
            }
        }
    }

    /// The attributes of a table by their names and types, but not those in `known`.
    fn attributes<I: Id>(
        &mut self,
        table: &'a AttributeTable<I>,
        known: &[&str],
        losses: &mut Losses,
    ) {
        for attribute in table.names().filter(|name| !known.contains(name)) {
            let plain = attribute.strip_prefix(PREFIX).unwrap_or(attribute);
            let name: String = plain
                .chars()
                .map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c })
                .collect();
            let taken = |name: &str| self.properties.iter().any(|property| property.name == name);
            if name.is_empty()
                || ["", "_x", "_y", "_z"].iter().any(|end| taken(&format!("{name}{end}")))
            {
                losses.add(
                    format!("{} attribute `{attribute}`: the name is taken", I::KIND),
                    table.len(),
                );
            } else if !self.attribute(table, attribute, &name) {
                let label = table.get::<Label>(attribute).is_some();
                let what = if label { "names" } else { "values of its type" };
                let what = format!("{} attribute `{attribute}`: PLY has no {what}", I::KIND);
                losses.add(what, table.len());
            } else if name != plain {
                losses.add(format!("{} attribute `{attribute}` is called `{name}`", I::KIND), 1);
            }
        }
    }

    /// Adds an attribute under a name; false if PLY has no such type.
    fn attribute<I: Id>(
        &mut self,
        table: &'a AttributeTable<I>,
        attribute: &str,
        name: &str,
    ) -> bool {
        macro_rules! numbers {
            ($($type:ident $scalar:ident),*) => {
                $(if let Some(values) = column::<I, $type>(table, attribute) {
                    self.number(name, Scalar::$scalar, move |i| f64::from(values[i]));
                    return true;
                })*
            };
        }
        numbers!(f64 F64, f32 F32, i8 I8, u8 U8, i16 I16, u16 U16, i32 I32, u32 U32, bool U8);
        if let Some(values) = column::<I, i64>(table, attribute) {
            let exact = values.iter().all(|&x| x as f64 as i64 == x);
            let small = values.iter().all(|&x| i32::try_from(x).is_ok());
            let scalar = if small { Scalar::I32 } else { Scalar::F64 };
            self.number(name, scalar, move |i| values[i] as f64);
            return exact || self.drop_last();
        }
        if let Some(values) = column::<I, u64>(table, attribute) {
            let exact = values.iter().all(|&x| x as f64 as u64 == x);
            let small = values.iter().all(|&x| u32::try_from(x).is_ok());
            let scalar = if small { Scalar::U32 } else { Scalar::F64 };
            self.number(name, scalar, move |i| values[i] as f64);
            return exact || self.drop_last();
        }
        if let Some(values) = column::<I, DVec2>(table, attribute) {
            for (k, axis) in ["x", "y"].into_iter().enumerate() {
                self.number(format!("{name}_{axis}"), Scalar::F64, move |i| values[i][k]);
            }
            return true;
        }
        let axes = ["x", "y", "z"].into_iter().enumerate();
        if let Some(values) = column::<I, DVec3>(table, attribute) {
            for (k, axis) in axes {
                self.number(format!("{name}_{axis}"), Scalar::F64, move |i| values[i][k]);
            }
            return true;
        }
        if let Some(values) = column::<I, Normal>(table, attribute) {
            for (k, axis) in axes {
                self.number(format!("{name}_{axis}"), Scalar::F64, move |i| values[i].0[k]);
            }
            return true;
        }
        if let Some(lists) = column::<I, NumberList>(table, attribute) {
            let longest = lists.iter().map(|list| list.0.len()).max().unwrap_or(0);
            let scalar = list_type(lists);
            let value = Value::List(length_type(longest), Box::new(move |i| &lists[i].0));
            self.properties.push(Property { name: name.to_owned(), scalar, wide: false, value });
            return true;
        }
        false
    }

    fn drop_last(&mut self) -> bool {
        self.properties.pop();
        false
    }

    fn write(
        &self,
        encoding: Encoding,
        output: &mut Output<'_>,
        progress: Progress<'_>,
    ) -> Result<(), Error> {
        if encoding == Encoding::Text {
            let row = |printer: &mut Printer, i: usize| {
                for (k, property) in self.properties.iter().enumerate() {
                    printer.text(if k == 0 { "" } else { " " });
                    property.print(printer, i);
                }
                printer.byte(b'\n');
            };
            return print_all(output, self.count, row, progress);
        }
        if self.properties.is_empty() {
            return Ok(());
        }
        let size = self.row_size();
        let rows = |range: Range<usize>, room: &mut Vec<u8>| {
            if let Some(size) = size {
                room.resize(range.len() * size, 0);
                self.fill_rows(room, range, size, encoding == Encoding::BigEndian);
                return;
            }
            let mut writer = ByteWriter::onto(mem::take(room), encoding);
            for i in range {
                for property in &self.properties {
                    property.put(&mut writer, i);
                }
            }
            *room = writer.bytes;
        };
        output.blocks(self.count, BLOCK, rows, progress)
    }
}

impl Rows<'_> {
    /// How many bytes a row takes, if all take the same: there are no lists, or only those of the
    /// corners of faces with equally many.
    fn row_size(&self) -> Option<usize> {
        self.properties.iter().map(Property::size).sum()
    }

    /// Fills rows of `size` bytes each, property by property.
    fn fill_rows(&self, bytes: &mut [u8], range: Range<usize>, size: usize, big: bool) {
        let mut at = 0;
        for property in &self.properties {
            property.fill(&mut Strided { bytes, at, size, big }, range.clone());
            at += property.size().expect("all properties have a size");
        }
    }
}

fn column<'a, I: Id, T: AttributeValue>(
    table: &'a AttributeTable<I>,
    name: &str,
) -> Option<&'a [T]> {
    table.get::<T>(name).map(AttributeColumn::values)
}
