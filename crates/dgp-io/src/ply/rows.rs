//! The rows of an element and what is made of their properties.

use std::sync::atomic::{AtomicUsize, Ordering};

use dgp_mesh::{
    AttributeTable, COLOR, Cancelled, Color, DVec2, DVec3, FaceList, GROUP, Id, IndexedFaceSet,
    MATERIAL, NORMAL, Normal, OBJECT, Progress, SMOOTHING, UV, VertexId, parallel,
};

use super::{
    header::Element,
    number::{Number, Scalar, Values, with_type, with_values},
    table::{Fixed, Lists, Table},
    tristrips::unrolled,
};
use crate::{
    NumberList, RowId,
    error::{Cause, Fault, Stop},
    pulse::Pulse,
    report::Oddities,
    text,
};

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

/// Where rows come from, for messages.
#[derive(Clone, Copy)]
pub(super) struct Origin<'a> {
    pub(super) bytes: &'a [u8],
    /// Where the header ends.
    pub(super) body: usize,
    pub(super) text: bool,
    /// Whether it is a text of one line a row.
    pub(super) by_lines: bool,
}

/// A row that names a vertex that is not there.
pub(super) struct Misnamed {
    pub(super) row: usize,
    /// The byte of the name, or of the first row where the name is not known that well.
    pub(super) byte: usize,
    pub(super) index: i64,
}

/// The rows of an element, and which of their properties are still to be had.
pub(super) struct Rows<'a> {
    pub(super) element: &'a Element,
    table: Table<'a>,
    /// The byte at which they begin, or in a text the row.
    start: usize,
    origin: Origin<'a>,
    /// The type in which each property is kept.
    stored: Vec<Scalar>,
    used: Vec<bool>,
    progress: Progress<'a>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(
        element: &'a Element,
        table: Table<'a>,
        start: usize,
        origin: Origin<'a>,
        progress: Progress<'a>,
    ) -> Self {
        let properties = element.properties.iter();
        let stored = properties.map(|p| if origin.text { p.text_scalar() } else { p.scalar });
        let (stored, used) = (stored.collect(), vec![false; element.properties.len()]);
        Rows { element, table, start, origin, stored, used, progress }
    }

    /// Whether some properties were made nothing of.
    pub(super) fn has_unused(&self) -> bool {
        self.used.contains(&false)
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

    /// Marks properties as used: what reports of the work on them.
    fn take<const N: usize>(&mut self, properties: [usize; N]) -> Progress<'a> {
        let fraction = |used: &[bool]| {
            used.iter().filter(|&&used| used).count() as f64 / used.len().max(1) as f64
        };
        let before = fraction(&self.used);
        for p in properties {
            self.used[p] = true;
        }
        self.progress.part(before, fraction(&self.used))
    }

    /// The list of vertices.
    pub(super) fn indices(&self) -> Option<usize> {
        self.find("vertex_indices", true).or_else(|| self.find("vertex_index", true))
    }

    fn take_indices(&mut self) -> (usize, Progress<'a>) {
        let p = self.indices().expect("elements without such a list are extra elements");
        (p, self.take([p]))
    }

    fn triples(&mut self, p: [usize; 3]) -> Result<Vec<DVec3>, Cancelled> {
        let progress = self.take(p);
        self.table.triples(p, p.map(|p| self.stored[p]), progress)
    }

    fn numbers(&mut self, p: usize) -> Result<Values, Cancelled> {
        let progress = self.take([p]);
        self.table.take_scalars(p, self.stored[p], progress)
    }

    pub(super) fn positions(&mut self) -> Result<Vec<DVec3>, Stop> {
        for name in ["x", "y", "z"] {
            if self.find(name, false).is_none() {
                let problem = format!("vertices have no property `{name}`");
                return Err(Fault::header(self.element.at, problem).into());
            }
        }
        let found = self.find_all(["x", "y", "z"]);
        Ok(found.map_or_else(|| Ok(Vec::new()), |p| self.triples(p))?)
    }

    /// The faces as they are listed.
    pub(super) fn faces(&mut self, vertex_count: usize) -> Result<FaceList, Stop> {
        let (p, progress) = self.take_indices();
        if let Table::Fixed(fixed) = &self.table
            && let (_, Some(degree)) = fixed.places[p]
            && degree > 0
        {
            let pulse = Pulse::new(fixed.count, progress);
            let corners = match degree {
                3 => polygons::<3>(fixed, p, self.stored[p], vertex_count, &pulse),
                4 => polygons::<4>(fixed, p, self.stored[p], vertex_count, &pulse),
                _ => any_polygons(fixed, p, self.stored[p], vertex_count, &pulse),
            };
            pulse.end()?;
            let corners = corners.map_err(|fault| self.misnamed(&fault, vertex_count))?;
            return Ok(FaceList::from_corners(corners, degree));
        }
        let Lists { ends, values } = self.table.take_lists(p, self.stored[p]);
        let mut corners = Vec::with_capacity(values.len());
        with_values!(&values, numbers => for (c, &number) in numbers.iter().enumerate() {
            let Some(v) = number.vertex(vertex_count) else {
                let row = ends.partition_point(|&end| end as usize <= c);
                let (byte, index) = (self.start, number.to_f64() as i64);
                return Err(self.misnamed(&Misnamed { row, byte, index }, vertex_count).into());
            };
            corners.push(v);
        });
        Ok(FaceList::from_ends(corners, &ends))
    }

    /// The triangles of strips.
    pub(super) fn triangles(&mut self, vertex_count: usize) -> Result<Vec<[VertexId; 3]>, Stop> {
        let (p, _) = self.take_indices();
        let lists = self.table.take_lists(p, self.stored[p]);
        Ok(unrolled(&lists, vertex_count).map_err(|fault| {
            self.misnamed(&Misnamed { byte: self.start, ..fault }, vertex_count)
        })?)
    }

    fn misnamed(&self, fault: &Misnamed, vertex_count: usize) -> Fault {
        let &Misnamed { row, byte, index } = fault;
        let Origin { bytes, body, text, by_lines } = self.origin;
        let cause = Cause::IndexOutOfRange { what: "vertex", index, count: vertex_count, first: 0 };
        let fault = match () {
            () if !text => Fault::binary(byte, cause),
            () if by_lines => Fault::new(text::row_byte(bytes, body, self.start + row), cause),
            () => Fault::new(body, cause),
        };
        fault.within_number(self.element.kind(), row)
    }

    /// Texture coordinates at vertices.
    pub(super) fn uvs(
        &mut self,
        attributes: &mut AttributeTable<VertexId>,
    ) -> Result<(), Cancelled> {
        let Some([u, v]) = UVS.into_iter().find_map(|names| self.find_all(names)) else {
            return Ok(());
        };
        let (u, v) = (self.numbers(u)?, self.numbers(v)?);
        if self.element.count > 0 {
            let uv = |i: usize| DVec2::new(u.get(i), v.get(i));
            attributes.insert(UV, (0..u.len()).map(uv).collect::<Vec<DVec2>>());
        }
        Ok(())
    }

    /// Texture coordinates at corners, two numbers each.
    pub(super) fn corner_uvs(&mut self, set: &mut IndexedFaceSet, oddities: &mut Oddities) {
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
    pub(super) fn attributes<I: Id>(
        &mut self,
        attributes: &mut AttributeTable<I>,
    ) -> Result<(), Cancelled> {
        let mesh_element = I::KIND != RowId::KIND;
        if mesh_element && self.element.count == 0 {
            return Ok(());
        }
        if mesh_element && let Some(p) = NORMALS.into_iter().find_map(|names| self.find_all(names))
        {
            let normals: Vec<Normal> = self.triples(p)?.into_iter().map(Normal).collect();
            attributes.insert(NORMAL, normals);
        }
        if mesh_element {
            self.colors(attributes)?;
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
                self.take([p]);
                let Lists { ends, values } = self.table.take_lists(p, self.stored[p]);
                let mut start = 0;
                let lists = ends.iter().map(|&end| {
                    let list = (start..end as usize).map(|i| values.get(i)).collect();
                    start = end as usize;
                    NumberList(list)
                });
                attributes.insert(&name, lists.collect::<Vec<NumberList>>());
            } else {
                let values = self.numbers(p)?;
                with_values!(values, vector => attributes.insert(&name, vector));
            }
        }
        Ok(())
    }

    fn colors<I: Id>(&mut self, attributes: &mut AttributeTable<I>) -> Result<(), Cancelled> {
        let found = COLORS
            .into_iter()
            .find_map(|[r, g, b, a]| Some((self.find_all([r, g, b])?, self.find(a, false))));
        let Some(([r, g, b], a)) = found else { return Ok(()) };
        let mut channel = |p: usize| -> Result<(Values, f32), Cancelled> {
            Ok((self.numbers(p)?, self.stored[p].unit() as f32))
        };
        let rgb = [channel(r)?, channel(g)?, channel(b)?];
        let alpha = a.map(channel).transpose()?;
        let value = |(values, unit): &(Values, f32), i: usize| values.get(i) as f32 / unit;
        let color = |id: I| {
            let i = id.index();
            let alpha = alpha.as_ref().map_or(1.0, |alpha| value(alpha, i));
            Color([value(&rgb[0], i), value(&rgb[1], i), value(&rgb[2], i), alpha])
        };
        attributes.insert(COLOR, parallel::map(self.element.count, color));
        Ok(())
    }
}

/// The corners of faces of `N` corners each.
fn polygons<const N: usize>(
    fixed: &Fixed<'_>,
    p: usize,
    scalar: Scalar,
    vertex_count: usize,
    pulse: &Pulse<'_>,
) -> Result<Vec<VertexId>, Misnamed> {
    let first_bad = AtomicUsize::new(usize::MAX);
    let at = fixed.places[p].0;
    let blank = [VertexId::new(0); N];
    let faces = with_type!(scalar, T => fixed.map(blank, pulse, |f, row| {
        let mut face = blank;
        let numbers = row[at..at + N * T::SIZE].chunks_exact(T::SIZE);
        for (k, (corner, number)) in face.iter_mut().zip(numbers).enumerate() {
            match T::read(number, fixed.big).vertex(vertex_count) {
                Some(v) => *corner = v,
                None => {
                    first_bad.fetch_min(f * N + k, Ordering::Relaxed);
                }
            }
        }
        face
    }));
    match first_bad.into_inner() {
        usize::MAX => Ok(faces.into_flattened()),
        bad => Err(fixed.misnamed(p, scalar, bad / N, bad % N)),
    }
}

/// The corners of faces of any degree.
fn any_polygons(
    fixed: &Fixed<'_>,
    p: usize,
    scalar: Scalar,
    vertex_count: usize,
    pulse: &Pulse<'_>,
) -> Result<Vec<VertexId>, Misnamed> {
    let (at, degree) = (fixed.places[p].0, fixed.places[p].1.unwrap_or(1));
    let mut corners = Vec::with_capacity(fixed.count * degree);
    with_type!(scalar, T => for f in (0..fixed.count).take_while(|&f| pulse.beat(f)) {
        let numbers = fixed.row(f)[at..at + degree * T::SIZE].chunks_exact(T::SIZE);
        for (k, number) in numbers.enumerate() {
            match T::read(number, fixed.big).vertex(vertex_count) {
                Some(v) => corners.push(v),
                None => return Err(fixed.misnamed(p, scalar, f, k)),
            }
        }
    });
    Ok(corners)
}
