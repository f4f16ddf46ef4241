//! Reading STL as text.

use std::ops::Range;

use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Label, OBJECT, Progress, weld_exact};

use crate::{
    Contents, Document, Encoding, Format,
    error::{Cause, Fault, Stop, countable},
    report::Oddities,
    text::{Cursor, Text, decoded, map_blocks, shown},
};

/// Reads a text file.
pub(super) fn read(bytes: &[u8], progress: Progress<'_>) -> Result<Contents, Stop> {
    let text = Text::new(bytes, Format::Stl)?;
    let ranges = facet_blocks(bytes, text.blocks(text.start().at));
    let parse = |_: usize, range: Range<usize>| Ok(Block::parse(text.cursor(range))?);
    let blocks = map_blocks(&ranges, parse, progress.part(0.0, 0.7))?;

    let mut points: Vec<DVec3> = Vec::new();
    let mut ends: Vec<u32> = Vec::new();
    let mut names: Vec<(usize, String)> = Vec::new();
    let mut oddities = Oddities::default();
    countable("corners", blocks.iter().map(|block| block.points.len()).sum())?;
    for block in blocks {
        let (corner, facet) = (points.len() as u32, ends.len());
        points.extend(block.points);
        ends.extend(block.ends.iter().map(|end| corner + end));
        names.extend(block.names.into_iter().map(|(f, name)| (facet + f, name)));
        oddities.append(block.oddities);
    }
    let welding = weld_exact(&points);
    progress.report(0.9)?;
    let positions: Vec<DVec3> =
        welding.originals.values().iter().map(|&v| points[v.index()]).collect();
    let faces = FaceList::from_ends(welding.vertices.into_values(), &ends);
    let set = IndexedFaceSet::new(positions, faces)?;
    let mut document = Document::from(set);
    if names.iter().any(|(_, name)| !name.is_empty()) {
        let mut labels: Vec<Label> = Vec::new();
        let mut current = Label::default();
        for (facet, name) in names {
            labels.resize(facet, current);
            current = Label::new(&name);
        }
        labels.resize(ends.len(), current);
        if labels.iter().any(|label| !label.as_str().is_empty()) {
            document.set.face_attributes.insert(OBJECT, labels);
        }
    }
    Ok(Contents { document, oddities, encoding: Encoding::Text })
}

/// The blocks, moved on so that none begins inside of a facet.
fn facet_blocks(bytes: &[u8], blocks: Vec<Range<usize>>) -> Vec<Range<usize>> {
    let mut moved: Vec<Range<usize>> = Vec::with_capacity(blocks.len());
    for block in blocks {
        let begin = moved.last().map_or(block.start, |last| last.end);
        if begin >= block.end {
            continue;
        }
        let end = match memchr::memmem::find(&bytes[block.end..], b"endfacet") {
            Some(found) => block.end + found + "endfacet".len(),
            None => bytes.len(),
        };
        moved.push(begin..end);
    }
    moved
}

/// The facets of a block.
#[derive(Default)]
struct Block {
    points: Vec<DVec3>,
    /// Where the corners of each facet end.
    ends: Vec<u32>,
    /// From which facet on a solid of which name.
    names: Vec<(usize, String)>,
    oddities: Oddities,
}

impl Block {
    fn parse(mut cursor: Cursor<'_>) -> Result<Self, Fault> {
        let mut block = Block::default();
        let (mut normal, mut facet) = (DVec3::ZERO, cursor.at);
        loop {
            cursor.skip_blank_lines();
            if cursor.is_at_end() {
                break;
            }
            let at = cursor.at;
            let word = cursor.word();
            match word.to_ascii_lowercase().as_slice() {
                b"vertex" => {
                    let position = triple(&mut cursor).map_err(|fault| fault.within("vertex"))?;
                    block.points.push(position);
                }
                b"facet" => {
                    facet = at;
                    cursor.word();
                    normal = triple(&mut cursor).map_err(|fault| fault.within("facet"))?;
                }
                b"endfacet" => block.end_facet(normal, facet)?,
                b"outer" | b"loop" | b"endloop" => {}
                b"solid" => {
                    let name = decoded(cursor.rest_of_line());
                    block.names.push((block.ends.len(), name));
                }
                b"endsolid" => {
                    cursor.rest_of_line();
                    block.names.push((block.ends.len(), String::new()));
                }
                _ => {
                    block.oddities.add(format!("statement `{}` skipped", shown(word)), at);
                    cursor.rest_of_line();
                }
            }
        }
        let open = block.points.len() - block.ends.last().map_or(0, |&end| end as usize);
        if open > 0 {
            let (what, found) = ("facets".to_owned(), block.ends.len());
            let cause = Cause::CutShort { what, found, expected: found + 1 };
            return Err(Fault::new(cursor.at, cause).within("facet"));
        }
        Ok(block)
    }

    fn end_facet(&mut self, normal: DVec3, at: usize) -> Result<(), Fault> {
        let first = self.ends.last().map_or(0, |&end| end as usize);
        let corners = &self.points[first..];
        if corners.len() < 3 {
            let cause = Cause::TooFewNumbers { found: 3 * corners.len(), expected: 9 };
            return Err(Fault::new(at, cause).within("facet"));
        }
        let [a, b, c] = [corners[0], corners[1], corners[2]];
        if (b - a).cross(c - a).dot(normal) < 0.0 {
            let what = "facet whose normal points against the order of its corners";
            self.oddities.add(what, at);
        }
        self.ends.push(self.points.len() as u32);
        Ok(())
    }
}

fn triple(cursor: &mut Cursor<'_>) -> Result<DVec3, Fault> {
    let mut next = || {
        cursor.skip_blank_lines();
        // `nan` and `-nan` are the same, or they would be different vertices.
        cursor.number().map(|x| if x.is_nan() { f64::NAN } else { x })
    };
    Ok(DVec3::new(next()?, next()?, next()?))
}
