//! The rows of a PLY file made a document.

use dgp_mesh::{AttributeTable, FaceList, IndexedFaceSet, Progress};

use super::{
    header::Header,
    rows::{Origin, Rows},
    table::Table,
};
use crate::{Document, Encoding, ExtraElement, RowId, error::Stop, report::Oddities};

/// The rows of all elements.
pub(super) struct Body<'a> {
    pub(super) tables: Vec<Table<'a>>,
    /// The byte at which each begins, or in a text the row.
    pub(super) starts: Vec<usize>,
    /// Whether it is a text of one line a row.
    pub(super) by_lines: bool,
}

pub(super) fn assemble(
    header: &Header,
    body: Body<'_>,
    bytes: &[u8],
    oddities: &mut Oddities,
    progress: Progress<'_>,
) -> Result<Document, Stop> {
    let text = header.encoding == Encoding::Text;
    let origin = Origin { bytes, body: header.body, text, by_lines: body.by_lines };
    let mut vertices = None;
    let mut faces = None;
    let mut strips = None;
    let mut extras = Vec::new();
    let total: usize = header.elements.iter().map(|element| element.count).sum();
    let mut done = 0;
    let rows = header.elements.iter().zip(body.tables).zip(body.starts);
    for ((element, table), start) in rows {
        let fraction = |rows: usize| rows as f64 / total.max(1) as f64;
        let progress = progress.part(fraction(done), fraction(done + element.count));
        done += element.count;
        let rows = Rows::new(element, table, start, origin, progress);
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
    let mut list = FaceList::new();
    if let Some(faces) = &mut faces {
        list = faces.faces(positions.len())?;
        if list.uniform_degree().is_none_or(|degree| degree < 3) {
            let small = list.iter().filter(|(_, face)| face.len() < 3).count();
            oddities.add_many("face with fewer than 3 corners kept".into(), small, 0);
        }
    }
    let mut unrolled_faces = 0;
    if let Some(strips) = &mut strips {
        let triangles = strips.triangles(positions.len())?;
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
        vertices.uvs(&mut set.vertex_attributes)?;
        vertices.attributes(&mut set.vertex_attributes)?;
    }
    if let Some(mut faces) = faces {
        faces.corner_uvs(set, oddities);
        if unrolled_faces == 0 {
            faces.attributes(&mut set.face_attributes)?;
        } else {
            oddities.add("attributes of faces skipped: there are triangle strips, too", 0);
        }
    }
    if strips.is_some_and(|strips| strips.has_unused()) {
        oddities.add("properties of triangle strips skipped", 0);
    }
    for mut rows in extras {
        let mut table = AttributeTable::<RowId>::new(rows.element.count);
        rows.attributes(&mut table)?;
        document.elements.push(ExtraElement { name: rows.element.name.clone(), rows: table });
    }
    Ok(document)
}
