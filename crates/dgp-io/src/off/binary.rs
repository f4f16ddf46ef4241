//! The body of a binary OFF file.

use dgp_mesh::{DVec2, DVec3, FaceList, MAX_ELEMENTS, Normal, Progress, VertexId};

use super::{
    Kind,
    parts::{Parts, RawColor},
};
use crate::{
    Contents, Encoding,
    binary::ByteReader,
    error::{Cause, Fault, Stop},
    pulse::Pulse,
    report::Oddities,
};

/// Reads what follows the header.
pub(super) fn read(
    bytes: &[u8],
    start: usize,
    kind: Kind,
    comments: Vec<String>,
    mut oddities: Oddities,
    progress: Progress<'_>,
) -> Result<Contents, Stop> {
    // The standard says big endian; where that makes no sense, little endian may.
    let tries = [true, false].map(|big| Counts::parse(ByteReader { bytes, at: start, big }, kind));
    let (counts, encoding) = match tries {
        [Ok(counts), _] => (counts, Encoding::BigEndian),
        [Err(_), Ok(counts)] => (counts, Encoding::LittleEndian),
        [Err(fault), Err(_)] => return Err(fault.into()),
    };
    if encoding == Encoding::LittleEndian {
        oddities.add("binary OFF in little endian; the standard says big endian", start);
    }
    let mut parts = Parts::default();
    // Binary colors are fractions.
    parts.color_scale.fractions = true;
    parts.face_color_scale.fractions = true;
    let mut reader = counts.reader;
    let pulse = Pulse::new(counts.vertices, progress.part(0.0, 0.4));
    for _ in (0..counts.vertices).take_while(|&v| pulse.beat(v)) {
        vertex(&mut reader, kind, &mut parts)?;
    }
    pulse.end()?;
    let colored = faces_end(reader, counts.faces, FaceColors::Counted) == Some(bytes.len());
    let plain = faces_end(reader, counts.faces, FaceColors::None) == Some(bytes.len());
    let colors = if plain && !colored { FaceColors::None } else { FaceColors::Counted };
    if colors == FaceColors::None && counts.faces > 0 {
        oddities.add("faces without the color count of the standard", reader.at);
    }
    let pulse = Pulse::new(counts.faces, progress.part(0.4, 1.0));
    for f in (0..counts.faces).take_while(|&f| pulse.beat(f)) {
        face(&mut reader, counts.vertices, colors, &mut parts)
            .map_err(|fault| fault.within_number("face", f))?;
    }
    pulse.end()?;
    if reader.remaining() > 0 {
        oddities
            .add(format!("{} bytes after the last face skipped", reader.remaining()), reader.at);
    }
    let mut document = parts.into_document(&mut oddities)?;
    document.comments = comments;
    Ok(Contents { document, oddities, encoding })
}

/// Whether faces are followed by the number of their color components.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FaceColors {
    Counted,
    None,
}

/// The numbers of vertices and faces, and what follows them.
struct Counts<'a> {
    vertices: usize,
    faces: usize,
    reader: ByteReader<'a>,
}

impl<'a> Counts<'a> {
    fn parse(mut reader: ByteReader<'a>, kind: Kind) -> Result<Self, Fault> {
        if kind.dimension {
            let at = reader.at;
            let dimension = reader.i32()?;
            if dimension != 3 {
                let what = format!("OFF with vertices of {dimension} dimensions");
                return Err(Fault::binary(at, Cause::Unsupported { what }));
            }
        }
        let at = reader.at;
        let (vertices, faces) = (reader.i32()?, reader.i32()?);
        reader.i32()?;
        let numbers = 3
            + usize::from(kind.weight)
            + 3 * usize::from(kind.normal)
            + 4 * usize::from(kind.color)
            + 2 * usize::from(kind.uv);
        let remaining = reader.remaining();
        let vertices = possible(at, "vertices", vertices, remaining / (4 * numbers))?;
        let left = remaining - 4 * numbers * vertices;
        let faces = possible(at + 4, "faces", faces, left / 4)?;
        Ok(Counts { vertices, faces, reader })
    }
}

fn possible(at: usize, what: &str, claimed: i32, possible: usize) -> Result<usize, Fault> {
    match usize::try_from(claimed) {
        Ok(count) if count <= possible.min(MAX_ELEMENTS) => Ok(count),
        Ok(count) => {
            let (claimed, possible) = (count as u64, possible as u64);
            Err(Fault::binary(at, Cause::TooMany { what: what.to_owned(), claimed, possible }))
        }
        Err(_) => {
            let problem = format!("there cannot be {claimed} {what}");
            Err(Fault::binary(at, Cause::Header { problem }))
        }
    }
}

fn vertex(reader: &mut ByteReader<'_>, kind: Kind, parts: &mut Parts) -> Result<(), Fault> {
    parts.positions.push(triple(reader)?);
    if kind.weight {
        parts.weights.push(reader.f32()?.into());
    }
    if kind.normal {
        parts.normals.push(Normal(triple(reader)?));
    }
    if kind.color {
        let channels = [reader.f32()?, reader.f32()?, reader.f32()?, reader.f32()?];
        parts.colors.push(RawColor { channels, count: 4 });
    }
    if kind.uv {
        parts.uvs.push(DVec2::new(reader.f32()?.into(), reader.f32()?.into()));
    }
    Ok(())
}

fn triple(reader: &mut ByteReader<'_>) -> Result<DVec3, Fault> {
    Ok(DVec3::new(reader.f32()?.into(), reader.f32()?.into(), reader.f32()?.into()))
}

/// Where the faces end if they are written like that, if they can be.
fn faces_end(mut reader: ByteReader<'_>, faces: usize, colors: FaceColors) -> Option<usize> {
    let skip = |reader: &mut ByteReader<'_>| {
        let count = usize::try_from(reader.i32().ok()?).ok()?;
        reader.at += (count <= reader.remaining() / 4).then_some(4 * count)?;
        Some(())
    };
    for _ in 0..faces {
        skip(&mut reader)?;
        if colors == FaceColors::Counted {
            skip(&mut reader)?;
        }
    }
    Some(reader.at)
}

fn face(
    reader: &mut ByteReader<'_>,
    vertex_count: usize,
    colors: FaceColors,
    parts: &mut Parts,
) -> Result<(), Fault> {
    let at = reader.at;
    let degree = reader.i32()?;
    let room = FaceList::MAX_CORNERS - parts.corners.len();
    let degree = possible(at, "corners", degree, (reader.remaining() / 4).min(room))?;
    parts.small_faces += usize::from(degree < 3);
    for _ in 0..degree {
        let at = reader.at;
        let index = reader.i32()?;
        match usize::try_from(index) {
            Ok(v) if v < vertex_count => parts.corners.push(VertexId::new(v)),
            _ => {
                let (what, index) = ("vertex", i64::from(index));
                let cause = Cause::IndexOutOfRange { what, index, count: vertex_count, first: 0 };
                return Err(Fault::binary(at, cause));
            }
        }
    }
    let face = parts.face_ends.len() as u32;
    parts.face_ends.push(parts.corners.len() as u32);
    if colors == FaceColors::None {
        return Ok(());
    }
    let at = reader.at;
    match reader.i32()? {
        0 => {}
        1 => parts.face_color_indices.push((face, reader.i32()?)),
        count @ (3 | 4) => {
            let mut color = RawColor { channels: [1.0; 4], count: count as usize };
            for channel in &mut color.channels[..count as usize] {
                *channel = reader.f32()?;
            }
            parts.face_colors.push((face, color));
        }
        count => {
            let problem = format!("a face color of {count} numbers");
            return Err(Fault::binary(at, Cause::Header { problem }));
        }
    }
    Ok(())
}
