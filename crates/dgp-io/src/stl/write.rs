//! Writing STL.

use std::ops::Range;

use dgp_mesh::{
    AttributeColumn, DVec3, FaceId, FaceList, IndexedFaceSet, Label, OBJECT, Progress,
    TriangulationMethod, VertexId, triangulate_polygon,
};

use super::{FACET, HEADER};
use crate::{
    ATTRIBUTE_BYTES, Document, Encoding, Error,
    binary::rounded,
    output::Output,
    print::{Printer, one_line, print_all},
    report::Losses,
};

/// Facets a thread writes at a time.
const BLOCK: usize = 1 << 12;

/// An STL file.
pub(crate) fn write(
    document: &Document,
    encoding: Encoding,
    output: &mut Output<'_>,
    losses: &mut Losses,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let set = &document.set;
    let facets = Facets::new(set);
    note_losses(document, encoding, &facets, losses);
    if encoding == Encoding::Text {
        return text(document, &facets, output, progress);
    }
    if facets.len() > u32::MAX as usize {
        let (kind, count, limit) = ("facets", facets.len(), u32::MAX as usize);
        return Err(dgp_mesh::Error::TooMany { kind, count, limit }.into());
    }
    let mut header = vec![0; HEADER];
    if let Some(title) = title(document) {
        header[..title.len()].copy_from_slice(title);
    }
    header[80..].copy_from_slice(&(facets.len() as u32).to_le_bytes());
    let attributes = set.face_attributes.get::<u16>(ATTRIBUTE_BYTES);
    output.put(&header)?;
    let records = |range: Range<usize>, bytes: &mut Vec<u8>| {
        for i in range {
            let (f, corners) = facets.get(set, i);
            let mut record = [0; FACET];
            let (numbers, rest) = record.as_chunks_mut::<4>();
            let vectors = [normal(corners), corners[0], corners[1], corners[2]];
            for (place, x) in numbers.iter_mut().zip(vectors.iter().flat_map(DVec3::to_array)) {
                *place = (x as f32).to_le_bytes();
            }
            if let Some(values) = attributes {
                rest.copy_from_slice(&values[f].to_le_bytes());
            }
            bytes.extend_from_slice(&record);
        }
    };
    output.blocks(facets.len(), BLOCK, records, progress)
}

/// The triangles of the faces.
enum Facets<'a> {
    /// The faces are triangles.
    Faces(&'a FaceList),
    /// The triangles that polygons were cut into, each with its face.
    Cut(Vec<(FaceId, [VertexId; 3])>),
}

impl<'a> Facets<'a> {
    fn new(set: &'a IndexedFaceSet) -> Self {
        if set.faces().is_triangles() {
            return Facets::Faces(set.faces());
        }
        let mut cut = Vec::new();
        for (f, face) in set.faces().iter() {
            if let &[a, b, c] = face {
                cut.push((f, [a, b, c]));
                continue;
            }
            let corners: Vec<DVec3> = face.iter().map(|&v| set.position(v)).collect();
            let triangles = triangulate_polygon(&corners, TriangulationMethod::Ears);
            cut.extend(triangles.into_iter().map(|triangle| (f, triangle.map(|k| face[k]))));
        }
        Facets::Cut(cut)
    }

    fn len(&self) -> usize {
        match self {
            Facets::Faces(faces) => faces.len(),
            Facets::Cut(triangles) => triangles.len(),
        }
    }

    #[inline]
    fn get(&self, set: &IndexedFaceSet, i: usize) -> (FaceId, [DVec3; 3]) {
        let (f, corners) = match self {
            Facets::Faces(faces) => {
                let face = faces.face(FaceId::new(i));
                (FaceId::new(i), [face[0], face[1], face[2]])
            }
            Facets::Cut(triangles) => triangles[i],
        };
        (f, corners.map(|v| set.position(v)))
    }
}

/// The unit normal, or zero where there is none.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    if normal.is_finite() { normal } else { DVec3::ZERO }
}

/// The text of the header of a binary file. It must not look like the beginning of a text file.
fn title(document: &Document) -> Option<&[u8]> {
    let title = document.comments.first()?.as_bytes();
    let fits = title.len() <= 80 && title.iter().all(|&byte| byte >= b' ');
    (fits && !title.starts_with(b"solid")).then_some(title)
}

fn note_losses(document: &Document, encoding: Encoding, facets: &Facets<'_>, losses: &mut Losses) {
    let set = &document.set;
    losses.add_columns(&set.vertex_attributes, &[]);
    losses.add_columns(&set.corner_attributes, &[]);
    let kept = if encoding == Encoding::Text { OBJECT } else { ATTRIBUTE_BYTES };
    losses.add_columns(&set.face_attributes, &[kept]);
    if let Facets::Cut(_) = facets {
        let polygons = set.faces().iter().filter(|(_, face)| face.len() > 3).count();
        losses.add("polygons cut into triangles", polygons);
        let small = set.faces().iter().filter(|(_, face)| face.len() < 3).count();
        losses.add("faces with fewer than 3 corners left out", small);
    }
    let mut used = vec![false; set.vertex_count()];
    set.faces().corners().iter().for_each(|v| used[v.index()] = true);
    losses.add("vertices of no face left out", used.iter().filter(|&&used| !used).count());
    let comments = document.comments.len();
    if encoding == Encoding::Text {
        losses.add("comments have no place in the format", comments);
    } else {
        let rounded = rounded(set.positions().values(), DVec3::to_array);
        losses.add("coordinates rounded to single precision", rounded);
        let kept = usize::from(title(document).is_some());
        losses.add("comments have no place in the format", comments - kept);
    }
    losses.add_extras(document);
}

fn text(
    document: &Document,
    facets: &Facets<'_>,
    output: &mut Output<'_>,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let set = &document.set;
    let labels = set.face_attributes.get::<Label>(OBJECT).map(AttributeColumn::values);
    let name = |i: usize| labels.map(|labels| &labels[facets.get(set, i).0.index()]);
    let line = |printer: &mut Printer, keyword: &str, label: Option<&Label>| {
        printer.text(keyword);
        if let Some(label) = label.filter(|label| !label.as_str().is_empty()) {
            printer.byte(b' ');
            printer.text(&one_line(label.as_str()));
        }
        printer.byte(b'\n');
    };
    let facet = |printer: &mut Printer, i: usize| {
        let (_, corners) = facets.get(set, i);
        if i == 0 {
            line(printer, "solid", name(0));
        } else if name(i) != name(i - 1) {
            line(printer, "endsolid", name(i - 1));
            line(printer, "solid", name(i));
        }
        printer.text("facet normal ");
        for (k, x) in normal(corners).to_array().into_iter().enumerate() {
            printer.text(if k == 0 { "" } else { " " });
            printer.f32(x as f32);
        }
        printer.text("\nouter loop\n");
        for corner in corners {
            printer.text("vertex ");
            printer.numbers(corner.to_array());
            printer.byte(b'\n');
        }
        printer.text("endloop\nendfacet\n");
        if i + 1 == facets.len() {
            line(printer, "endsolid", name(i));
        }
    };
    if facets.len() == 0 {
        return output.put(b"solid\nendsolid\n");
    }
    print_all(output, facets.len(), facet, progress)
}
