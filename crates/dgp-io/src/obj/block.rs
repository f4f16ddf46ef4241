//! A block of lines of an OBJ file, whose numbers count from the block's beginning.

use std::ops::Range;

use dgp_mesh::{DVec2, DVec3, MAX_ELEMENTS};

use crate::{
    Format, SubdivisionTag,
    error::{Cause, Fault},
    report::Oddities,
    text::{Cursor, Text, decoded, shown},
};

/// What stands in a block.
#[derive(Default)]
pub(super) struct Block {
    pub(super) positions: Vec<DVec3>,
    /// Empty or one per position.
    pub(super) colors: Vec<[f64; 4]>,
    /// Empty or one per position.
    pub(super) weights: Vec<f64>,
    pub(super) uvs: Vec<DVec2>,
    pub(super) normals: Vec<DVec3>,
    /// The vertices of the faces.
    pub(super) corners: References,
    /// Empty or one per corner.
    pub(super) corner_uvs: References,
    /// Empty or one per corner.
    pub(super) corner_normals: References,
    /// Where the corners of each face end.
    pub(super) face_ends: Vec<u32>,
    /// The byte of each face, counted from the beginning of the block.
    pub(super) face_bytes: Vec<u32>,
    pub(super) labels: Vec<LabelChange>,
    /// The vertices of lines, the byte of the statement of each, and where each line ends in them.
    pub(super) line_vertices: References,
    pub(super) line_bytes: Vec<u32>,
    pub(super) line_ends: Vec<u32>,
    /// Points, and the byte of the statement of each.
    pub(super) points: References,
    pub(super) point_bytes: Vec<u32>,
    pub(super) comments: Vec<String>,
    pub(super) material_libraries: Vec<String>,
    pub(super) tags: Vec<SubdivisionTag>,
    pub(super) oddities: Oddities,
}

/// Numbers of elements as they stand in the file, from 1; 0 is none.
#[derive(Default)]
pub(super) struct References {
    pub(super) numbers: Vec<u32>,
    /// Which of them count backwards, and what they are when the elements of this block are counted
    /// from 1: those of blocks before come to 0 and less.
    pub(super) relative: Vec<(u32, i64)>,
}

/// From face `face` of the block on, faces are labeled `text`.
pub(super) struct LabelChange {
    pub(super) face: usize,
    pub(super) kind: LabelKind,
    pub(super) text: String,
}

/// What a label tells.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LabelKind {
    Object,
    Group,
    Material,
    Smoothing,
}

impl References {
    /// Adds the number `index` of one of the elements of which there are `count` so far.
    #[inline]
    fn push(&mut self, index: i64, count: usize) {
        self.numbers.push(match index {
            // More than any mesh has is out of range, whatever it is.
            1.. => index.min(MAX_ELEMENTS as i64 + 1) as u32,
            0 => 0,
            _ => {
                let local = (count as i64 + 1).saturating_add(index);
                self.relative.push((self.numbers.len() as u32, local));
                0
            }
        });
    }

    /// What number `slot` is if it counts backwards: see `relative`.
    pub(super) fn local(&self, slot: usize) -> Option<i64> {
        let found = self.relative.binary_search_by_key(&(slot as u32), |&(slot, _)| slot);
        found.ok().map(|i| self.relative[i].1)
    }

    fn pad(&mut self, len: usize) {
        self.numbers.resize(len, 0);
    }
}

impl Block {
    /// Parses the statements in `range`.
    pub(super) fn parse(text: Text<'_>, range: Range<usize>) -> Result<Self, Fault> {
        let mut block = Block::default();
        let mut cursor = text.cursor(range.clone());
        while !cursor.is_at_end() {
            block.statement(&mut cursor, range.start)?;
        }
        if !block.colors.is_empty() {
            block.colors.resize(block.positions.len(), [1.0; 4]);
        }
        if !block.weights.is_empty() {
            block.weights.resize(block.positions.len(), 1.0);
        }
        let corners = block.corners.numbers.len();
        for references in [&mut block.corner_uvs, &mut block.corner_normals] {
            if !references.numbers.is_empty() {
                references.pad(corners);
            }
        }
        Ok(block)
    }

    #[inline]
    fn statement(&mut self, cursor: &mut Cursor<'_>, start: usize) -> Result<(), Fault> {
        cursor.skip_blanks();
        let at = cursor.at;
        if cursor.ends_line() {
            if cursor.peek() == b'#' {
                cursor.at += 1;
                self.comments.push(decoded(cursor.rest_of_line()));
            }
            cursor.skip_line();
            return Ok(());
        }
        match cursor.word() {
            b"v" => self.vertex(cursor).map_err(|fault| fault.within("vertex"))?,
            b"f" => {
                self.face_bytes.push((at - start) as u32);
                self.face(cursor, at).map_err(|fault| fault.within("face"))?;
            }
            b"vt" => self.uv(cursor).map_err(|fault| fault.within("texture coordinate"))?,
            b"vn" => self.normal(cursor).map_err(|fault| fault.within("normal"))?,
            word => {
                self.rare_statement(word, cursor, at, start)?;
                return Ok(());
            }
        }
        cursor.skip_line();
        Ok(())
    }

    #[inline]
    fn vertex(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        let position = DVec3::from_array(cursor.numbers()?);
        let index = self.positions.len();
        self.positions.push(position);
        if cursor.ends_line() {
            return Ok(());
        }
        let (mut rest, mut len) = ([0.0; 4], 0);
        while !cursor.ends_line() {
            if len == rest.len() {
                self.oddities
                    .add("vertex with more than 7 numbers: the last are skipped", cursor.at);
                break;
            }
            rest[len] = cursor.number()?;
            len += 1;
        }
        match len {
            1 => {
                self.weights.resize(index, 1.0);
                self.weights.push(rest[0]);
            }
            3 | 4 => {
                self.colors.resize(index, [1.0; 4]);
                let alpha = if len == 4 { rest[3] } else { 1.0 };
                self.colors.push([rest[0], rest[1], rest[2], alpha]);
            }
            _ => self.oddities.add("vertex with 5 numbers: the last two are skipped", cursor.at),
        }
        Ok(())
    }

    fn uv(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        let u = cursor.number()?;
        let v = if cursor.ends_line() { 0.0 } else { cursor.number()? };
        self.uvs.push(DVec2::new(u, v));
        while !cursor.ends_line() {
            if cursor.number()? != 0.0 {
                self.oddities.add("third texture coordinate skipped", cursor.at);
            }
        }
        Ok(())
    }

    fn normal(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        self.normals.push(DVec3::from_array(cursor.numbers()?));
        if !cursor.ends_line() {
            self.oddities.add("normal with more than 3 numbers: the last are skipped", cursor.at);
        }
        Ok(())
    }

    #[inline]
    fn face(&mut self, cursor: &mut Cursor<'_>, at: usize) -> Result<(), Fault> {
        let first = self.corners.numbers.len();
        while !cursor.ends_line() {
            let [v, uv, normal] = corner(cursor)?;
            let index = self.corners.numbers.len();
            self.corners.push(v, self.positions.len());
            if uv != 0 {
                self.corner_uvs.pad(index);
                self.corner_uvs.push(uv, self.uvs.len());
            }
            if normal != 0 {
                self.corner_normals.pad(index);
                self.corner_normals.push(normal, self.normals.len());
            }
        }
        let end = self.corners.numbers.len();
        if end < first + 3 {
            self.oddities.add("face with fewer than 3 corners kept", at);
        }
        self.face_ends.push(end as u32);
        Ok(())
    }

    fn rare_statement(
        &mut self,
        word: &[u8],
        cursor: &mut Cursor<'_>,
        at: usize,
        start: usize,
    ) -> Result<(), Fault> {
        let kind = match word {
            b"o" => Some(LabelKind::Object),
            b"g" => Some(LabelKind::Group),
            b"usemtl" => Some(LabelKind::Material),
            b"s" => Some(LabelKind::Smoothing),
            _ => None,
        };
        if let Some(kind) = kind {
            let name = cursor.rest_of_line();
            // To be in no smoothing group is what holds before the first statement, too.
            let off = kind == LabelKind::Smoothing && matches!(name, b"off" | b"0");
            let text = if off { String::new() } else { decoded(name) };
            self.labels.push(LabelChange { face: self.face_ends.len(), kind, text });
            cursor.skip_line();
            return Ok(());
        }
        match word {
            b"mtllib" => self.material_libraries.push(decoded(cursor.rest_of_line())),
            b"l" => {
                while !cursor.ends_line() {
                    let [v, uv, _] = corner(cursor).map_err(|fault| fault.within("line"))?;
                    self.line_vertices.push(v, self.positions.len());
                    self.line_bytes.push((at - start) as u32);
                    if uv != 0 {
                        self.oddities.add("texture coordinates of a line skipped", at);
                    }
                }
                self.line_ends.push(self.line_vertices.numbers.len() as u32);
            }
            b"p" => {
                while !cursor.ends_line() {
                    let [v, ..] = corner(cursor).map_err(|fault| fault.within("point"))?;
                    self.points.push(v, self.positions.len());
                    self.point_bytes.push((at - start) as u32);
                }
            }
            b"t" => match tag(cursor) {
                Ok(tag) => self.tags.push(tag),
                Err(fault) => return Err(fault.within("tag")),
            },
            _ => {
                self.oddities.add(format!("statement `{}` skipped", shown(word)), at);
                cursor.skip_statement();
                return Ok(());
            }
        }
        cursor.skip_line();
        Ok(())
    }
}

/// The number of an element that no file has: a texture coordinate or normal 0 is noted as any other
/// that is not there, and the geometry is whole without it.
const NOT_THERE: i64 = i64::MAX;

/// The vertex, texture coordinate and normal of a corner, 0 where there is none.
#[inline]
pub(super) fn corner(cursor: &mut Cursor<'_>) -> Result<[i64; 3], Fault> {
    let start = cursor.at;
    let mut numbers = [0; 3];
    let mut given = cursor.integer_prefix();
    let vertex = given;
    numbers[0] = given.unwrap_or(0);
    let mut field = 1;
    while cursor.peek() == b'/' && field < 3 {
        cursor.at += 1;
        given = cursor.integer_prefix();
        numbers[field] = match given {
            Some(0) => NOT_THERE,
            given => given.unwrap_or(0),
        };
        field += 1;
    }
    let ends = cursor.is_at_end() || cursor.peek() <= b' ' || cursor.peek() == b'\\';
    if vertex.is_none() || !(ends || cursor.peek() == b'#') {
        cursor.at = start;
        let text = shown(cursor.word());
        return Err(Fault::new(start, Cause::NotAWholeNumber { text }));
    }
    if vertex == Some(0) {
        let cause = Cause::IndexZero { what: "vertex", format: Format::Obj };
        return Err(Fault::new(start, cause));
    }
    Ok(numbers)
}

/// `t name integers/floats/strings …`
fn tag(cursor: &mut Cursor<'_>) -> Result<SubdivisionTag, Fault> {
    let mut tag = SubdivisionTag { name: decoded(cursor.word()), ..SubdivisionTag::default() };
    cursor.skip_blanks();
    let start = cursor.at;
    let mut counts = [0; 3];
    for (i, count) in counts.iter_mut().enumerate() {
        if i > 0 && cursor.peek() == b'/' {
            cursor.at += 1;
        }
        let given = cursor.integer_prefix().and_then(|count| usize::try_from(count).ok());
        // Each value takes a blank and a character at least.
        let most = cursor.remaining() / 2;
        match given {
            Some(given) if given <= most => *count = given,
            Some(given) => {
                let problem = format!("a tag of {given} values, more than the file has left");
                return Err(Fault::header(start, problem));
            }
            None => {
                cursor.at = start;
                let text = shown(cursor.word());
                return Err(Fault::new(start, Cause::NotAWholeNumber { text }));
            }
        }
    }
    for _ in 0..counts[0] {
        tag.integers.push(cursor.integer()?);
    }
    for _ in 0..counts[1] {
        tag.floats.push(cursor.number()?);
    }
    for found in 0..counts[2] {
        let word = cursor.word();
        if word.is_empty() {
            let problem = format!("{found} words where the tag announces {}", counts[2]);
            return Err(Fault::header(cursor.at, problem));
        }
        tag.strings.push(decoded(word));
    }
    Ok(tag)
}
