//! The vertices and faces of an OFF file, block by block and joined.

use std::mem;

use dgp_mesh::{
    COLOR, Color, DVec2, DVec3, FaceList, IndexedFaceSet, NORMAL, Normal, UV, VertexId, parallel,
};

use super::read::{Header, Layout, checked};
use crate::{
    COLOR_INDEX, Document, WEIGHT,
    error::{Cause, Fault, Stop, countable},
    report::Oddities,
    text::{Cursor, RowCount, decoded},
};

/// The vertices and faces of a part of the file.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) positions: Vec<DVec3>,
    pub(super) weights: Vec<f64>,
    pub(super) normals: Vec<Normal>,
    pub(super) colors: Vec<RawColor>,
    pub(super) color_scale: ColorScale,
    pub(super) uvs: Vec<DVec2>,
    pub(super) corners: Vec<VertexId>,
    pub(super) face_ends: Vec<u32>,
    /// The colors of faces that have one.
    pub(super) face_colors: Vec<(u32, RawColor)>,
    pub(super) face_color_scale: ColorScale,
    /// The color map indices of faces that have one.
    pub(super) face_color_indices: Vec<(u32, i32)>,
    pub(super) comments: Vec<String>,
    pub(super) small_faces: usize,
}

/// A color as it stands in the file.
#[derive(Clone, Copy)]
pub(super) struct RawColor {
    pub(super) channels: [f32; 4],
    /// 3, or 4 with alpha.
    pub(super) count: usize,
}

/// How the colors of a file are to be understood. Whole numbers are 0..255; but if all of them are 0
/// or 1, or any color is not whole, all are 0..1.
#[derive(Clone, Copy, Default)]
pub(super) struct ColorScale {
    pub(super) fractions: bool,
    pub(super) beyond_one: bool,
}

impl ColorScale {
    fn note(&mut self, color: RawColor, whole: bool) {
        self.fractions |= !whole;
        self.beyond_one |= color.channels[..color.count].iter().any(|&x| x > 1.0);
    }

    fn or(self, other: Self) -> Self {
        ColorScale {
            fractions: self.fractions || other.fractions,
            beyond_one: self.beyond_one || other.beyond_one,
        }
    }

    fn color(self, color: RawColor) -> Color {
        let mut channels = color.channels;
        if !self.fractions && self.beyond_one {
            channels[..color.count].iter_mut().for_each(|channel| *channel /= 255.0);
        }
        Color(channels)
    }
}

/// How numbers of an element are spread over lines.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Spread {
    OneLine,
    AnyLines,
}

impl Parts {
    /// The rows of a block, of which `row` is the first; `None` if a line is not what it should be.
    pub(super) fn by_lines(
        mut cursor: Cursor<'_>,
        mut row: usize,
        header: &Header,
        count: RowCount,
    ) -> Option<Self> {
        let mut parts = Parts::default();
        while !cursor.is_at_end() && row < header.vertices + header.faces {
            if cursor.ends_line() {
                if count == RowCount::Lines {
                    return None;
                }
            } else {
                if row < header.vertices {
                    parts.vertex(&mut cursor, header.layout, Spread::OneLine).ok()?;
                } else {
                    parts.face(&mut cursor, header.vertices, Spread::OneLine).ok()?;
                }
                if !cursor.ends_line() {
                    return None;
                }
                row += 1;
            }
            parts.end_line(&mut cursor);
        }
        while !cursor.is_at_end() && row >= header.vertices + header.faces {
            // Behind the last face there may be comments, and whatever else does not matter.
            cursor.ends_line();
            parts.end_line(&mut cursor);
        }
        Some(parts)
    }

    #[inline]
    fn end_line(&mut self, cursor: &mut Cursor<'_>) {
        if cursor.peek() == b'#' {
            cursor.at += 1;
            self.comments.push(decoded(cursor.rest_of_line()));
        }
        cursor.skip_line();
    }

    /// All vertices and faces, wherever lines end.
    pub(super) fn by_words(mut cursor: Cursor<'_>, header: &Header) -> Result<Self, Fault> {
        let mut parts = Parts::default();
        // Numbers without explanation can only be told by the ends of lines.
        let layout = Layout { extra: 0, ..header.layout };
        let numbered = |fault: Fault, element, number, expected| match fault.cause {
            Cause::TooFewNumbers { .. } => {
                let what = if element == "vertex" { "vertices" } else { "faces" }.to_owned();
                Fault { cause: Cause::CutShort { what, found: number, expected }, ..fault }
            }
            _ => fault.within_number(element, number),
        };
        for i in 0..header.vertices {
            parts
                .vertex(&mut cursor, layout, Spread::AnyLines)
                .map_err(|fault| numbered(fault, "vertex", i, header.vertices))?;
        }
        for i in 0..header.faces {
            parts
                .face(&mut cursor, header.vertices, Spread::AnyLines)
                .map_err(|fault| numbered(fault, "face", i, header.faces))?;
        }
        Ok(parts)
    }

    #[inline]
    fn vertex(
        &mut self,
        cursor: &mut Cursor<'_>,
        layout: Layout,
        spread: Spread,
    ) -> Result<(), Fault> {
        let position = self.triple(cursor, spread)?;
        let weight = if layout.weight { Some(self.number(cursor, spread)?) } else { None };
        let normal = if layout.normal { Some(self.triple(cursor, spread)?) } else { None };
        self.positions.push(position);
        self.weights.extend(weight);
        self.normals.extend(normal.map(Normal));
        if layout.color > 0 {
            let mut color = RawColor { channels: [1.0; 4], count: layout.color };
            let mut whole = true;
            for channel in &mut color.channels[..layout.color] {
                self.reach_word(cursor, spread);
                let (value, is_whole) = cursor.spelled_number()?;
                *channel = value as f32;
                whole &= is_whole;
            }
            self.color_scale.note(color, whole);
            self.colors.push(color);
        }
        if layout.uv {
            let uv = DVec2::new(self.number(cursor, spread)?, self.number(cursor, spread)?);
            self.uvs.push(uv);
        }
        for _ in 0..layout.extra {
            cursor.number()?;
        }
        Ok(())
    }

    #[inline]
    fn triple(&mut self, cursor: &mut Cursor<'_>, spread: Spread) -> Result<DVec3, Fault> {
        let x = self.number(cursor, spread)?;
        let y = self.number(cursor, spread)?;
        Ok(DVec3::new(x, y, self.number(cursor, spread)?))
    }

    #[inline]
    fn number(&mut self, cursor: &mut Cursor<'_>, spread: Spread) -> Result<f64, Fault> {
        self.reach_word(cursor, spread);
        cursor.number()
    }

    #[inline]
    fn reach_word(&mut self, cursor: &mut Cursor<'_>, spread: Spread) {
        if spread == Spread::AnyLines {
            cursor.skip_to_word(|comment| self.comments.push(decoded(comment)));
        }
    }

    #[inline]
    fn face(
        &mut self,
        cursor: &mut Cursor<'_>,
        vertex_count: usize,
        spread: Spread,
    ) -> Result<(), Fault> {
        self.reach_word(cursor, spread);
        let start = cursor.at;
        let degree = cursor.integer()?;
        // Each corner takes a digit and a blank.
        let degree = checked(degree, "corners", cursor.remaining() as u64 / 2, start)?;
        self.small_faces += usize::from(degree < 3);
        for _ in 0..degree {
            self.reach_word(cursor, spread);
            let at = cursor.at;
            let index = cursor.integer()?;
            match usize::try_from(index) {
                Ok(v) if v < vertex_count => self.corners.push(VertexId::new(v)),
                _ => {
                    let (what, count, first) = ("vertex", vertex_count, 0);
                    return Err(Fault::new(
                        at,
                        Cause::IndexOutOfRange { what, index, count, first },
                    ));
                }
            }
        }
        let face = self.face_ends.len() as u32;
        self.face_ends.push(self.corners.len() as u32);
        if !cursor.ends_line() {
            self.face_color(cursor, face)?;
        }
        Ok(())
    }

    /// One number is an index of a color map, three or four are a color.
    fn face_color(&mut self, cursor: &mut Cursor<'_>, face: u32) -> Result<(), Fault> {
        let mut color = RawColor { channels: [1.0; 4], count: 0 };
        let mut whole = true;
        while !cursor.ends_line() {
            let (value, is_whole) = cursor.spelled_number()?;
            if color.count < 4 {
                color.channels[color.count] = value as f32;
                color.count += 1;
                whole &= is_whole;
            }
        }
        if color.count < 3 {
            self.face_color_indices.push((face, color.channels[0] as i32));
        } else {
            self.face_color_scale.note(color, whole);
            self.face_colors.push((face, color));
        }
        Ok(())
    }

    /// The parts of a file in order as one.
    pub(super) fn joined(mut blocks: Vec<Parts>) -> Result<Self, dgp_mesh::Error> {
        countable("corners", blocks.iter().map(|block| block.corners.len()).sum())?;
        let positions: Vec<_> = blocks.iter_mut().map(|b| mem::take(&mut b.positions)).collect();
        let corners: Vec<_> = blocks.iter_mut().map(|b| mem::take(&mut b.corners)).collect();
        let lengths: Vec<usize> = corners.iter().map(Vec::len).collect();
        let (positions, corners) =
            parallel::join(move || positions.concat(), move || corners.concat());
        let mut whole = Parts { positions, corners, ..Parts::default() };
        whole.face_ends.reserve_exact(blocks.iter().map(|block| block.face_ends.len()).sum());
        let mut start = 0;
        for (block, len) in blocks.into_iter().zip(lengths) {
            whole.append(block, start);
            start += len as u32;
        }
        Ok(whole)
    }

    /// Adds what stands later in the file but for positions and corners, which begin at `corners`.
    fn append(&mut self, later: Parts, corners: u32) {
        let faces = self.face_ends.len() as u32;
        self.weights.extend(later.weights);
        self.normals.extend(later.normals);
        self.colors.extend(later.colors);
        self.color_scale = self.color_scale.or(later.color_scale);
        self.uvs.extend(later.uvs);
        self.face_ends.extend(later.face_ends.iter().map(|end| corners + end));
        self.face_colors.extend(later.face_colors.iter().map(|&(f, color)| (faces + f, color)));
        self.face_color_scale = self.face_color_scale.or(later.face_color_scale);
        let indices = later.face_color_indices.iter();
        self.face_color_indices.extend(indices.map(|&(f, index)| (faces + f, index)));
        self.comments.extend(later.comments);
        self.small_faces += later.small_faces;
    }

    /// The document, once all parts are together.
    pub(super) fn into_document(self, oddities: &mut Oddities) -> Result<Document, Stop> {
        oddities.add_many("face with fewer than 3 corners kept".into(), self.small_faces, 0);
        let faces = FaceList::from_ends(self.corners, &self.face_ends);
        let mut set = IndexedFaceSet::new(self.positions, faces)?;
        if !self.weights.is_empty() {
            set.vertex_attributes.insert(WEIGHT, self.weights);
        }
        if !self.normals.is_empty() {
            set.vertex_attributes.insert(NORMAL, self.normals);
        }
        if !self.colors.is_empty() {
            let scale = self.color_scale;
            let colors: Vec<Color> = self.colors.iter().map(|&raw| scale.color(raw)).collect();
            set.vertex_attributes.insert(COLOR, colors);
        }
        if !self.uvs.is_empty() {
            set.vertex_attributes.insert(UV, self.uvs);
        }
        if !self.face_colors.is_empty() {
            let mut colors = vec![Color::default(); set.face_count()];
            for &(f, raw) in &self.face_colors {
                colors[f as usize] = self.face_color_scale.color(raw);
            }
            set.face_attributes.insert(COLOR, colors);
        }
        if !self.face_color_indices.is_empty() {
            let mut indices = vec![-1; set.face_count()];
            for &(f, index) in &self.face_color_indices {
                indices[f as usize] = index;
            }
            set.face_attributes.insert(COLOR_INDEX, indices);
        }
        Ok(set.into())
    }
}
