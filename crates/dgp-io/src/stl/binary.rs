//! Reading binary STL.

use dgp_mesh::{DVec3, FaceId, FaceList, IndexedFaceSet, Progress, VertexId, parallel, weld_exact};

use super::{FACET, HEADER, facet_count};
use crate::{
    ATTRIBUTE_BYTES, Contents, Document, Encoding,
    error::{Cause, Fault, Stop},
    report::Oddities,
    text::decoded,
};

/// Reads a binary file.
pub(super) fn read(bytes: &[u8], progress: Progress<'_>) -> Result<Contents, Stop> {
    let Some(claimed) = facet_count(bytes) else {
        let (what, found) = ("bytes of the header".to_owned(), bytes.len());
        return Err(Fault::binary(0, Cause::CutShort { what, found, expected: HEADER }).into());
    };
    let mut oddities = Oddities::default();
    let body = &bytes[HEADER..];
    let possible = (body.len() / FACET) as u64;
    if u64::from(claimed) > possible {
        let (what, claimed) = ("facets".to_owned(), u64::from(claimed));
        return Err(Fault::binary(80, Cause::TooMany { what, claimed, possible }).into());
    }
    let (facets, rest) = body.split_at(claimed as usize * FACET);
    if !rest.is_empty() {
        let what = format!("{} bytes after the last facet skipped", rest.len());
        oddities.add(what, HEADER + facets.len());
    }
    let (facets, _) = facets.as_chunks::<FACET>();
    let points = corners(facets);
    progress.report(0.3)?;
    let welding = weld_exact(&points);
    progress.report(0.9)?;
    let positions =
        parallel::map(welding.originals.len(), |v: VertexId| points[welding.originals[v].index()]);
    let corners = FaceList::from_corners(welding.vertices.into_values(), 3);
    let set = IndexedFaceSet::new(positions, corners)?;
    let mut document = Document::from(set);
    compare_normals(facets, &mut oddities);

    let extra = facets.iter().any(|facet| facet[48..] != [0, 0]);
    if extra {
        let value = |facet: &[u8; FACET]| u16::from_le_bytes([facet[48], facet[49]]);
        let values: Vec<u16> = facets.iter().map(value).collect();
        document.set.face_attributes.insert(ATTRIBUTE_BYTES, values);
    }
    let title = bytes[..80].split(|&byte| byte == 0).next().unwrap_or_default().trim_ascii();
    if !title.is_empty() && title.iter().all(|&byte| byte >= b' ') {
        document.comments.push(decoded(title));
    }
    Ok(Contents { document, oddities, encoding: Encoding::LittleEndian })
}

/// The three corners of each facet.
fn corners(facets: &[[u8; FACET]]) -> Vec<DVec3> {
    let triples: Vec<[DVec3; 3]> = parallel::map::<FaceId, _>(facets.len(), |f| {
        let facet = &facets[f.index()];
        [12, 24, 36].map(|at| DVec3::from_array(triple(facet, at).map(f64::from)))
    })
    .into_values();
    triples.into_flattened()
}

#[inline]
fn triple(facet: &[u8; FACET], at: usize) -> [f32; 3] {
    [at, at + 4, at + 8]
        .map(|at| f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]))
}

/// Notes facets whose normals point against the order of their corners.
fn compare_normals(facets: &[[u8; FACET]], oddities: &mut Oddities) {
    let blocks = parallel::map_blocks(facets.len(), parallel::BLOCK, |range| {
        let against = |facet: &[u8; FACET]| {
            let vector = |at| DVec3::from_array(triple(facet, at).map(f64::from));
            let [a, b, c] = [vector(12), vector(24), vector(36)];
            (b - a).cross(c - a).dot(vector(0)) < 0.0
        };
        let bad = range.clone().filter(|&f| against(&facets[f]));
        bad.fold((0, None), |(count, first), f| (count + 1, first.or(Some(f))))
    });
    for (count, first) in blocks {
        if let Some(first) = first {
            let what = "facet whose normal points against the order of its corners";
            oddities.add_many(what.into(), count, HEADER + first * FACET);
        }
    }
}
