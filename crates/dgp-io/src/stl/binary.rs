//! Reading binary STL.

use dgp_mesh::{DVec3, FaceId, FaceList, IndexedFaceSet, Progress, VertexId, parallel};

use super::{FACET, HEADER, facet_count};
use crate::{
    ATTRIBUTE_BYTES, Contents, Document, Encoding,
    error::{Cause, Fault, Stop},
    report::Oddities,
    text::decoded,
    weld::{Welded, weld},
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
    // Adding 0 turns −0 into 0 and leaves all else. What is no number is the same whatever its bits,
    // since text does not keep them.
    let bits = |x: f32| if x.is_nan() { f32::NAN.to_bits() } else { (x + 0.0).to_bits() };
    let key = |c: usize| corner(facets, c).map(bits);
    let Welded { numbers, firsts, .. } = weld(3 * facets.len(), key, progress.part(0.0, 0.7))?;
    let position =
        |v: VertexId| DVec3::from_array(corner(facets, firsts[v.index()] as usize).map(f64::from));
    let positions = parallel::map(firsts.len(), position);
    let corners = numbers.into_iter().map(|v| VertexId::new(v as usize)).collect();
    progress.report(0.8)?;
    let set = IndexedFaceSet::new(positions, FaceList::from_corners(corners, 3))?;
    let mut document = Document::from(set);
    let extras = look_over(facets, &mut oddities);
    progress.report(0.9)?;
    if extras {
        let value = |f: FaceId| {
            let [.., low, high] = facets[f.index()];
            u16::from_le_bytes([low, high])
        };
        document.set.face_attributes.insert(ATTRIBUTE_BYTES, parallel::map(facets.len(), value));
    }
    let title = bytes[..80].split(|&byte| byte == 0).next().unwrap_or_default().trim_ascii();
    if !title.is_empty() && title.iter().all(|&byte| byte >= b' ') {
        document.comments.push(decoded(title));
    }
    Ok(Contents { document, oddities, encoding: Encoding::LittleEndian })
}

/// Corner `c` of all facets.
#[inline]
fn corner(facets: &[[u8; FACET]], c: usize) -> [f32; 3] {
    triple(&facets[c / 3], 12 + 12 * (c % 3))
}

#[inline]
fn triple(facet: &[u8; FACET], at: usize) -> [f32; 3] {
    let (numbers, _) = facet[at..at + 12].as_chunks::<4>();
    [0, 1, 2].map(|k| f32::from_le_bytes(numbers[k]))
}

/// Notes facets whose normals point against the order of their corners; whether any facet has more
/// than zeros in its last 16 bits.
fn look_over(facets: &[[u8; FACET]], oddities: &mut Oddities) -> bool {
    let blocks = parallel::map_blocks(facets.len(), parallel::BLOCK, |range| {
        let (mut count, mut first, mut extras) = (0, None, false);
        for (facet, f) in facets[range.clone()].iter().zip(range) {
            let vector = |at| DVec3::from_array(triple(facet, at).map(f64::from));
            let [a, b, c] = [vector(12), vector(24), vector(36)];
            if (b - a).cross(c - a).dot(vector(0)) < 0.0 {
                count += 1;
                first = first.or(Some(f));
            }
            extras |= facet[48..] != [0, 0];
        }
        (count, first, extras)
    });
    for &(count, first, _) in &blocks {
        if let Some(first) = first {
            let what = "facet whose normal points against the order of its corners";
            oddities.add_many(what.into(), count, HEADER + first * FACET);
        }
    }
    blocks.iter().any(|&(.., extras)| extras)
}
