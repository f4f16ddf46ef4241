//! The blocks of an OBJ file joined to a document.

use std::{mem, ops::Range};

use dgp_mesh::{
    AttributeValue, COLOR, Color, DVec2, FaceList, GROUP, IndexedFaceSet, Label, MATERIAL, NORMAL,
    Normal, OBJECT, Progress, SMOOTHING, UV, VertexId,
};

use super::block::{Block, LabelKind, References, corner};
use crate::{
    Contents, Document, Encoding, Format, WEIGHT,
    error::{Cause, Fault, Stop, countable},
    report::Oddities,
    text::{Text, map_blocks},
};

/// Reads an OBJ file.
pub(crate) fn read(bytes: &[u8], progress: Progress<'_>) -> Result<Contents, Stop> {
    let text = Text::new(bytes, Format::Obj)?;
    let ranges = text.blocks(text.start().at);
    let parse = |_: usize, range: Range<usize>| Ok(Block::parse(text, range)?);
    let blocks = map_blocks(&ranges, parse, progress.part(0.0, 0.8))?;
    progress.report(0.8)?;
    join(text, &ranges, blocks)
}

fn join(text: Text<'_>, ranges: &[Range<usize>], mut blocks: Vec<Block>) -> Result<Contents, Stop> {
    let mut oddities = Oddities::default();
    countable("corners", blocks.iter().map(|block| block.corners.numbers.len()).sum())?;
    let corners = resolve(text, ranges, &blocks, 0, &mut oddities)?;
    let corner_uvs = resolve(text, ranges, &blocks, 1, &mut oddities)?;
    let corner_normals = resolve(text, ranges, &blocks, 2, &mut oddities)?;
    let corners: Vec<VertexId> =
        corners.into_iter().map(|number| VertexId::new(number as usize - 1)).collect();

    let mut document = Document::default();
    (document.polylines, document.points) = lines_and_points(text, ranges, &blocks)?;
    let colors = padded(&mut blocks, |block| &mut block.colors, [1.0; 4]);
    let weights = padded(&mut blocks, |block| &mut block.weights, 1.0);
    let positions = joined(&mut blocks, |block| &mut block.positions);
    let faces = face_list(corners, &blocks);
    document.set = IndexedFaceSet::new(positions, faces)?;
    if !colors.is_empty() {
        let colors = unit_colors(&colors, &mut oddities);
        document.set.vertex_attributes.insert(COLOR, colors);
    }
    if !weights.is_empty() {
        document.set.vertex_attributes.insert(WEIGHT, weights);
    }
    let uvs = joined(&mut blocks, |block| &mut block.uvs);
    let normals = joined(&mut blocks, |block| &mut block.normals);
    let normals: Vec<Normal> = normals.into_iter().map(Normal).collect();
    let uv_bits = |uv: &DVec2| [uv.x.to_bits(), uv.y.to_bits(), 0];
    let normal_bits = |normal: &Normal| normal.0.to_array().map(f64::to_bits);
    place(&mut document.set, UV, &uvs, &corner_uvs, uv_bits, &mut oddities);
    place(&mut document.set, NORMAL, &normals, &corner_normals, normal_bits, &mut oddities);
    label_faces(&mut document.set, &blocks);
    for block in blocks {
        document.comments.extend(block.comments);
        document.material_libraries.extend(block.material_libraries);
        document.tags.extend(block.tags);
        oddities.append(block.oddities);
    }
    Ok(Contents { document, oddities, encoding: Encoding::Text })
}

/// The vectors of all blocks as one.
fn joined<T>(blocks: &mut [Block], part: impl Fn(&mut Block) -> &mut Vec<T>) -> Vec<T> {
    if let [only] = blocks {
        return mem::take(part(only));
    }
    let len = blocks.iter_mut().map(|block| part(block).len()).sum();
    let mut all = Vec::with_capacity(len);
    for block in blocks {
        all.append(&mut mem::take(part(block)));
    }
    all
}

/// A column that a block has for all its vertices or for none; empty if no block has it.
fn padded<T: Clone>(
    blocks: &mut [Block],
    part: impl Fn(&mut Block) -> &mut Vec<T>,
    default: T,
) -> Vec<T> {
    let mut all = Vec::new();
    let mut end = 0;
    for block in blocks {
        let start = end;
        end += block.positions.len();
        let column = mem::take(part(block));
        if !column.is_empty() {
            all.resize(start, default.clone());
            all.extend(column);
        }
    }
    if !all.is_empty() {
        all.resize(end, default);
    }
    all
}

/// Of each block, where its elements of a kind begin and how many of them the file has.
fn starts(blocks: &[Block], count: impl Fn(&Block) -> usize) -> (Vec<usize>, usize) {
    let mut end = 0;
    let starts = blocks.iter().map(|block| {
        end += count(block);
        end - count(block)
    });
    (starts.collect(), end)
}

/// The numbers of the elements that all corners name, from 1 over the whole file and 0 for none:
/// vertices (field 0), texture coordinates (1) or normals (2). Empty if no corner names any.
fn resolve(
    text: Text<'_>,
    ranges: &[Range<usize>],
    blocks: &[Block],
    field: usize,
    oddities: &mut Oddities,
) -> Result<Vec<u32>, Stop> {
    let references = |block: &'_ Block| -> usize {
        [&block.corners, &block.corner_uvs, &block.corner_normals][field].numbers.len()
    };
    if blocks.iter().all(|block| references(block) == 0) {
        return Ok(Vec::new());
    }
    let count =
        |block: &Block| [block.positions.len(), block.uvs.len(), block.normals.len()][field];
    let (starts, total) = starts(blocks, count);
    let mut all = Vec::with_capacity(blocks.iter().map(|block| block.corners.numbers.len()).sum());
    for ((block, &start), range) in blocks.iter().zip(&starts).zip(ranges) {
        let first = all.len();
        let part = [&block.corners, &block.corner_uvs, &block.corner_normals][field];
        let (count, bad) = append(part, start, total, &mut all);
        if let Some(bad) = bad {
            let face = block.face_ends.partition_point(|&end| end as usize <= bad);
            let at = range.start + block.face_bytes[face] as usize;
            if field == 0 {
                let nth = bad - if face == 0 { 0 } else { block.face_ends[face - 1] as usize };
                let statement = Statement { at, end: range.end, element: "face" };
                let fault = statement.misnaming(text, nth, part.local(bad), start, total);
                return Err(fault.into());
            }
            // The geometry is whole without it.
            let what = ["", "texture coordinate", "normal"][field];
            let what = format!("corner names a {what} that is not there");
            oddities.add_many(what.into(), count, at);
        }
        // The block says nothing about corners that name none.
        all.resize(first + block.corners.numbers.len(), 0);
    }
    Ok(all)
}

/// Adds numbers over the whole file, 0 for those out of range: how many these are, and the position
/// of the first of them.
fn append(
    part: &References,
    start: usize,
    total: usize,
    all: &mut Vec<u32>,
) -> (usize, Option<usize>) {
    let first = all.len();
    all.extend_from_slice(&part.numbers);
    let (mut count, mut bad) = (0, None);
    let mut note = |slot: usize| {
        count += 1;
        bad = Some(bad.map_or(slot, |bad: usize| bad.min(slot)));
    };
    for (slot, number) in all[first..].iter_mut().enumerate() {
        if *number as usize > total {
            note(slot);
            *number = 0;
        }
    }
    for &(slot, local) in &part.relative {
        let number = local.saturating_add(start as i64);
        if number < 1 || number > total as i64 {
            note(slot as usize);
        } else {
            all[first + slot as usize] = number as u32;
        }
    }
    (count, bad)
}

/// A statement that names vertices.
struct Statement {
    at: usize,
    end: usize,
    /// What it makes.
    element: &'static str,
}

impl Statement {
    /// The fault of the `nth` vertex named, which is not among `total`; `local` is its number in a
    /// block whose first vertex is number `start`, if it counts backwards.
    fn misnaming(
        &self,
        text: Text<'_>,
        nth: usize,
        local: Option<i64>,
        start: usize,
        total: usize,
    ) -> Fault {
        let mut cursor = text.cursor(self.at..self.end);
        cursor.word();
        let mut index = 0;
        for _ in 0..=nth {
            cursor.skip_blanks();
            index = corner(&mut cursor).map_or(0, |numbers| numbers[0]);
        }
        let what = "vertex";
        let cause = match local {
            // As many come before as the number and its distance from the first make.
            Some(local) => {
                let before = (start as i64).saturating_add(local).saturating_sub(index) - 1;
                Cause::BeforeFirst { what, index, before: usize::try_from(before).unwrap_or(0) }
            }
            None => Cause::IndexOutOfRange { what, index, count: total, first: 1 },
        };
        Fault::new(self.at, cause).within(self.element)
    }
}

fn lines_and_points(
    text: Text<'_>,
    ranges: &[Range<usize>],
    blocks: &[Block],
) -> Result<(Vec<Vec<VertexId>>, Vec<VertexId>), Stop> {
    let (starts, total) = starts(blocks, |block| block.positions.len());
    let (mut lines, mut points) = (Vec::new(), Vec::new());
    for ((block, &start), range) in blocks.iter().zip(&starts).zip(ranges) {
        let vertices = |part: &References, bytes: &[u32], element| {
            let mut numbers = Vec::new();
            if let (_, Some(bad)) = append(part, start, total, &mut numbers) {
                let at = range.start + bytes[bad] as usize;
                let nth = bytes[..bad].iter().rev().take_while(|&&byte| byte == bytes[bad]).count();
                let statement = Statement { at, end: range.end, element };
                return Err(statement.misnaming(text, nth, part.local(bad), start, total));
            }
            Ok(numbers.into_iter().map(|n| VertexId::new(n as usize - 1)).collect())
        };
        let line_vertices: Vec<VertexId> =
            vertices(&block.line_vertices, &block.line_bytes, "line")?;
        let mut first = 0;
        for &end in &block.line_ends {
            lines.push(line_vertices[first..end as usize].to_vec());
            first = end as usize;
        }
        points.append(&mut vertices(&block.points, &block.point_bytes, "point")?);
    }
    Ok((lines, points))
}

fn face_list(corners: Vec<VertexId>, blocks: &[Block]) -> FaceList {
    let mut ends = Vec::with_capacity(blocks.iter().map(|block| block.face_ends.len()).sum());
    let mut start = 0;
    for block in blocks {
        ends.extend(block.face_ends.iter().map(|end| start + end));
        start += block.corners.numbers.len() as u32;
    }
    FaceList::from_ends(corners, &ends)
}

/// The colors of the file in 0..1. Some programs write 0..255.
fn unit_colors(colors: &[[f64; 4]], oddities: &mut Oddities) -> Vec<Color> {
    let bytes = colors.iter().any(|color| color[..3].iter().any(|&x| x > 1.0));
    if bytes {
        oddities.add("vertex colors beyond 1 taken for 0..255", 0);
    }
    let scale = if bytes { 255.0 } else { 1.0 };
    let color = |[r, g, b, a]: &[f64; 4]| {
        Color([(r / scale) as f32, (g / scale) as f32, (b / scale) as f32, *a as f32])
    };
    colors.iter().map(color).collect()
}

/// The number of a value that is not known yet.
const UNSET: u32 = u32::MAX;

/// Makes an attribute of `values` and the numbers of those that corners name.
fn place<T: AttributeValue>(
    set: &mut IndexedFaceSet,
    name: &str,
    values: &[T],
    corners: &[u32],
    bits: impl Fn(&T) -> [u64; 3],
    oddities: &mut Oddities,
) {
    if corners.is_empty() {
        // A point cloud has a normal for each vertex and no face to say so.
        if !values.is_empty() && values.len() == set.vertex_count() && set.faces().is_empty() {
            set.vertex_attributes.insert(name, values.to_vec());
        } else if !values.is_empty() {
            oddities.add(format!("{} `{name}` values that no face names skipped", values.len()), 0);
        }
        return;
    }
    if values.is_empty() {
        return;
    }
    let missing = corners.iter().filter(|&&number| number == 0).count();
    oddities.add_many(format!("corner without `{name}` gets zeros").into(), missing, 0);
    let zero = T::default();
    let value = |number: u32| if number == 0 { &zero } else { &values[number as usize - 1] };

    let mut vertex_numbers = vec![UNSET; set.vertex_count()];
    let agree = corners.iter().zip(set.faces().corners()).all(|(&number, v)| {
        let known = &mut vertex_numbers[v.index()];
        if *known == UNSET {
            *known = number;
        }
        *known == number || bits(value(*known)) == bits(value(number))
    });
    if agree {
        let number = |&number: &u32| if number == UNSET { 0 } else { number };
        let column: Vec<T> = vertex_numbers.iter().map(|n| value(number(n)).clone()).collect();
        set.vertex_attributes.insert(name, column);
    } else {
        let column: Vec<T> = corners.iter().map(|&number| value(number).clone()).collect();
        set.corner_attributes.insert(name, column);
    }
}

/// The labels of faces, as columns where the file has any.
fn label_faces(set: &mut IndexedFaceSet, blocks: &[Block]) {
    let kinds = [
        (LabelKind::Object, OBJECT),
        (LabelKind::Group, GROUP),
        (LabelKind::Material, MATERIAL),
        (LabelKind::Smoothing, SMOOTHING),
    ];
    let (starts, face_count) = starts(blocks, |block| block.face_ends.len());
    for (kind, name) in kinds {
        // Most files have none, and a column of nothing takes as long to make as any other.
        let changes = |block: &'_ Block| {
            block.labels.iter().any(|change| change.kind == kind && !change.text.is_empty())
        };
        if !blocks.iter().any(changes) {
            continue;
        }
        let mut column: Vec<Label> = Vec::new();
        let mut current = Label::default();
        for (block, start) in blocks.iter().zip(&starts) {
            for change in block.labels.iter().filter(|change| change.kind == kind) {
                column.resize(start + change.face, current);
                current = Label::new(&change.text);
            }
        }
        column.resize(face_count, current);
        if column.iter().any(|label| !label.as_str().is_empty()) {
            set.face_attributes.insert(name, column);
        }
    }
}
