//! The rows of a PLY file made a document.

use std::sync::atomic::{AtomicUsize, Ordering};

use dgp_mesh::{
    AttributeTable, COLOR, Color, DVec2, DVec3, FaceList, GROUP, Id, IndexedFaceSet, MATERIAL,
    NORMAL, Normal, OBJECT, SMOOTHING, UV, VertexId, parallel,
};

use super::{
    header::{Element, Header},
    number::{Number, Scalar, Values, with_type, with_values},
    table::{Lists, Table},
    tristrips::unrolled,
};
use crate::{
    Document, Encoding, ExtraElement, NumberList, RowId,
    error::{Cause, Fault, Stop},
    report::Oddities,
    text,
};

/// The rows of all elements.
pub(super) struct Body<'a> {
    pub(super) tables: Vec<Table<'a>>,
    /// The byte at which each begins, or in a text the row.
    pub(super) starts: Vec<usize>,
    /// Whether it is a text of one line a row.
    pub(super) by_lines: bool,
}

/// An attribute of one of these names is not what a file means by it.
const RESERVED: [&str; 7] = [NORMAL, COLOR, UV, GROUP, OBJECT, MATERIAL, SMOOTHING];
/// What sets the property apart.
pub(super) const PREFIX: &str = "ply:";

const NORMALS: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];
const COLORS: [[&str; 4]; 3] = [
    ["red", "green", "blue", "alpha"],
    ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
    ["r", "g", "b", "a"],
];
const UVS: [[&str; 2]; 4] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

pub(super) fn assemble(
    header: &Header,
    body: Body<'_>,
    bytes: &[u8],
    oddities: &mut Oddities,
) -> Result<Document, Stop> {
    let text = header.encoding == Encoding::Text;
    let by_lines = body.by_lines;
    let mut vertices = None;
    let mut faces = None;
    let mut strips = None;
    let mut extras = Vec::new();
    let rows = header.elements.iter().zip(body.tables).zip(body.starts);
    for ((element, table), start) in rows {
        let rows = Rows::new(element, table, start, text);
        let has_faces = rows.indices().is_some();
        match element.name.as_str() {
            "vertex" => vertices = Some(rows),
            "face" if has_faces => faces = Some(rows),
            "tristrips" if has_faces => strips = Some(rows),
            _ => extras.push(rows),
        }
    }
    let mut document = Document::default();
    let mut positions = Vec::new();
    if let Some(vertices) = &mut vertices {
        if vertices.element.count > 0 {
            positions = vertices.positions()?;
        }
    } else {
        oddities.add("no element `vertex`", 0);
    }
    let locate = |rows: &Rows<'_>, fault: Misnamed| {
        let Misnamed { row, byte, index } = fault;
        let cause =
            Cause::IndexOutOfRange { what: "vertex", index, count: positions.len(), first: 0 };
        let fault = match () {
            () if !text => Fault::binary(byte, cause),
            () if by_lines => {
                Fault::new(text::row_byte(bytes, header.body, rows.start + row), cause)
            }
            () => Fault::new(header.body, cause),
        };
        fault.within_number(rows.element.kind(), row)
    };
    let mut list = FaceList::new();
    if let Some(faces) = &mut faces {
        list = faces.faces(positions.len()).map_err(|fault| locate(faces, fault))?;
        let small = list.iter().filter(|(_, face)| face.len() < 3);
        if list.uniform_degree().is_none_or(|degree| degree < 3) {
            oddities.add_many("face with fewer than 3 corners kept".into(), small.count(), 0);
        }
    }
    let mut unrolled_faces = 0;
    if let Some(strips) = &mut strips {
        let p = strips.take_indices();
        let lists = strips.table.lists(p, strips.stored[p]);
        let triangles = unrolled(&lists, positions.len()).map_err(|fault| locate(strips, fault))?;
        unrolled_faces = triangles.len();
        if list.is_empty() {
            list = FaceList::from_triangles(triangles);
        } else {
            for triangle in &triangles {
                list.push(triangle);
            }
        }
    }
    document.set = IndexedFaceSet::new(positions, list)?;
    let set = &mut document.set;
    if let Some(mut vertices) = vertices {
        vertices.uvs(&mut set.vertex_attributes);
        vertices.attributes(&mut set.vertex_attributes);
    }
    if let Some(mut faces) = faces {
        faces.corner_uvs(set, oddities);
        if unrolled_faces == 0 {
            faces.attributes(&mut set.face_attributes);
        } else {
            oddities.add("attributes of faces skipped: there are triangle strips, too", 0);
        }
    }
    if strips.is_some_and(|strips| strips.used.contains(&false)) {
        oddities.add("properties of triangle strips skipped", 0);
    }
    for mut rows in extras {
        let mut table = AttributeTable::<RowId>::new(rows.element.count);
        rows.attributes(&mut table);
        document.elements.push(ExtraElement { name: rows.element.name.clone(), rows: table });
    }
    Ok(document)
}

/// A row that names a vertex that is not there.
pub(super) struct Misnamed {
    pub(super) row: usize,
    pub(super) byte: usize,
    pub(super) index: i64,
}

/// The rows of an element, and which of their properties are still to be had.
struct Rows<'a> {
    element: &'a Element,
    table: Table<'a>,
    start: usize,
    /// The type in which each property is kept.
    stored: Vec<Scalar>,
    used: Vec<bool>,
}

impl<'a> Rows<'a> {
    fn new(element: &'a Element, table: Table<'a>, start: usize, text: bool) -> Self {
        let properties = element.properties.iter();
        let stored = properties.map(|p| if text { p.text_scalar() } else { p.scalar }).collect();
        Rows { element, table, start, stored, used: vec![false; element.properties.len()] }
    }

    /// The property of this name, unless it is used, and unless it is a list where none is wanted.
    fn find(&self, name: &str, list: bool) -> Option<usize> {
        let mut properties = self.element.properties.iter();
        let p = properties.position(|p| p.name == name && p.list.is_some() == list)?;
        (!self.used[p]).then_some(p)
    }

    fn find_all<const N: usize>(&self, names: [&str; N]) -> Option<[usize; N]> {
        let mut found = [0; N];
        for (p, name) in found.iter_mut().zip(names) {
            *p = self.find(name, false)?;
        }
        Some(found)
    }

    /// The list of vertices.
    fn indices(&self) -> Option<usize> {
        self.find("vertex_indices", true).or_else(|| self.find("vertex_index", true))
    }

    fn take_indices(&mut self) -> usize {
        let p = self.indices().expect("elements without such a list are extra elements");
        self.used[p] = true;
        p
    }

    fn triples(&mut self, p: [usize; 3]) -> Vec<DVec3> {
        for p in p {
            self.used[p] = true;
        }
        self.table.triples(p, p.map(|p| self.stored[p]))
    }

    fn numbers(&mut self, p: usize) -> Values {
        self.used[p] = true;
        self.table.scalars(p, self.stored[p])
    }

    fn positions(&mut self) -> Result<Vec<DVec3>, Fault> {
        for name in ["x", "y", "z"] {
            if self.find(name, false).is_none() {
                let problem = format!("vertices have no property `{name}`");
                return Err(Fault::header(self.element.at, problem));
            }
        }
        Ok(self.find_all(["x", "y", "z"]).map_or_else(Vec::new, |p| self.triples(p)))
    }

    /// The faces as they are listed.
    fn faces(&mut self, vertex_count: usize) -> Result<FaceList, Misnamed> {
        let p = self.take_indices();
        if let Table::Fixed(fixed) = &self.table
            && let (at, Some(degree)) = fixed.places[p]
            && degree > 0
        {
            let scalar = self.stored[p];
            let offset = |row: usize, k: usize| row * fixed.stride + at + k * scalar.size();
            let first_bad = AtomicUsize::new(usize::MAX);
            let mut corners = vec![VertexId::new(0); fixed.count * degree];
            with_type!(scalar, T => {
                let fill = |first: usize, chunk: &mut [VertexId]| {
                    let rows = chunk.chunks_exact_mut(degree).zip(first / degree..);
                    for (face, row) in rows {
                        for (k, corner) in face.iter_mut().enumerate() {
                            let number = T::read(&fixed.rows[offset(row, k)..], fixed.big);
                            match vertex(number.to_f64(), vertex_count) {
                                Some(v) => *corner = v,
                                None => {
                                    first_bad.fetch_min(row * degree + k, Ordering::Relaxed);
                                }
                            }
                        }
                    }
                };
                parallel::for_each_chunk(&mut corners, parallel::BLOCK * degree, fill);
                let bad = first_bad.into_inner();
                if bad < usize::MAX {
                    let (row, k) = (bad / degree, bad % degree);
                    let at = offset(row, k);
                    let index = T::read(&fixed.rows[at..], fixed.big).to_f64() as i64;
                    return Err(Misnamed { row, byte: self.start + at, index });
                }
            });
            return Ok(FaceList::from_corners(corners, degree));
        }
        let Lists { ends, values } = self.table.lists(p, self.stored[p]);
        let mut corners = Vec::with_capacity(values.len());
        with_values!(&values, numbers => for (c, &number) in numbers.iter().enumerate() {
            let Some(v) = vertex(number.to_f64(), vertex_count) else {
                let row = ends.partition_point(|&end| end as usize <= c);
                let index = number.to_f64() as i64;
                return Err(Misnamed { row, byte: self.start, index });
            };
            corners.push(v);
        });
        Ok(FaceList::from_ends(corners, &ends))
    }

    /// Texture coordinates at vertices.
    fn uvs(&mut self, attributes: &mut AttributeTable<VertexId>) {
        let Some([u, v]) = UVS.into_iter().find_map(|names| self.find_all(names)) else { return };
        let (u, v) = (self.numbers(u), self.numbers(v));
        if self.element.count == 0 {
            return;
        }
        let uv = |i: usize| DVec2::new(u.get(i), v.get(i));
        attributes.insert(UV, (0..u.len()).map(uv).collect::<Vec<DVec2>>());
    }

    /// Texture coordinates at corners, two numbers each.
    fn corner_uvs(&mut self, set: &mut IndexedFaceSet, oddities: &mut Oddities) {
        let Some(p) = self.find("texcoord", true) else { return };
        let Lists { ends, values } = self.table.lists(p, self.stored[p]);
        let mut uvs = Vec::with_capacity(set.faces().corners().len());
        let mut missing = 0;
        for (i, (_, face)) in set.faces().iter().take(ends.len()).enumerate() {
            let first = if i == 0 { 0 } else { ends[i - 1] as usize };
            match ends[i] as usize - first {
                0 if !face.is_empty() => {
                    missing += 1;
                    uvs.resize(uvs.len() + face.len(), DVec2::ZERO);
                }
                len if len == 2 * face.len() => {
                    let uv = |k: usize| {
                        DVec2::new(values.get(first + 2 * k), values.get(first + 2 * k + 1))
                    };
                    uvs.extend((0..face.len()).map(uv));
                }
                // Not two numbers a corner: the lists stay as they are.
                _ => return,
            }
        }
        if missing == ends.len() {
            return;
        }
        self.used[p] = true;
        oddities.add_many("face without `uv` gets zeros".into(), missing, 0);
        uvs.resize(set.faces().corners().len(), DVec2::ZERO);
        set.corner_attributes.insert(UV, uvs);
    }

    /// All properties not used yet: normals and colors as such, others by their names.
    fn attributes<I: Id>(&mut self, attributes: &mut AttributeTable<I>) {
        let mesh_element = I::KIND != RowId::KIND;
        if mesh_element && self.element.count == 0 {
            return;
        }
        if mesh_element && let Some(p) = NORMALS.into_iter().find_map(|names| self.find_all(names))
        {
            let normals: Vec<Normal> = self.triples(p).into_iter().map(Normal).collect();
            attributes.insert(NORMAL, normals);
        }
        let colored = COLORS
            .into_iter()
            .find_map(|[r, g, b, a]| Some((self.find_all([r, g, b])?, self.find(a, false))));
        if mesh_element && let Some((rgb, alpha)) = colored {
            let channel =
                |rows: &mut Self, p: usize| (rows.numbers(p), rows.stored[p].unit() as f32);
            let rgb = rgb.map(|p| channel(self, p));
            let alpha = alpha.map(|p| channel(self, p));
            let value = |(values, unit): &(Values, f32), i: usize| values.get(i) as f32 / unit;
            let color = |id: I| {
                let i = id.index();
                let alpha = alpha.as_ref().map_or(1.0, |alpha| value(alpha, i));
                Color([value(&rgb[0], i), value(&rgb[1], i), value(&rgb[2], i), alpha])
            };
            attributes.insert(COLOR, parallel::map(self.element.count, color));
        }
        for (p, property) in self.element.properties.iter().enumerate() {
            if self.used[p] {
                continue;
            }
            let mut name = property.name.clone();
            if RESERVED.contains(&name.as_str()) || name.starts_with(PREFIX) {
                name.insert_str(0, PREFIX);
            }
            if property.list.is_some() {
                let Lists { ends, values } = self.table.lists(p, self.stored[p]);
                let mut start = 0;
                let lists = ends.iter().map(|&end| {
                    let list = (start..end as usize).map(|i| values.get(i)).collect();
                    start = end as usize;
                    NumberList(list)
                });
                attributes.insert(&name, lists.collect::<Vec<NumberList>>());
            } else {
                let values = self.table.scalars(p, self.stored[p]);
                with_values!(values, vector => attributes.insert(&name, vector));
            }
        }
    }
}

/// The vertex of this number, if there is one.
#[inline]
pub(super) fn vertex(number: f64, vertex_count: usize) -> Option<VertexId> {
    (number >= 0.0 && number < vertex_count as f64 && number.fract() == 0.0)
        .then(|| VertexId::new(number as usize))
}
