//! Geomview OFF, text and binary.
//!
//! - Input: any bytes.
//! - Cost: O(bytes), text in parallel.
//! - Reference: "OFF files", Geomview manual, section 4.2.5.
//! - Departs from it: counts may share the line of the keyword or lack the edges, as in many real
//!   files; binary files may be little endian and lack the color counts of faces, which is found by
//!   trying what fits the size of the file. `nOFF` other than three-dimensional is refused.

mod binary;
mod parts;
mod read;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;

/// What the keyword of an OFF file says about its vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a letter of the keyword")]
struct Kind {
    uv: bool,
    color: bool,
    normal: bool,
    weight: bool,
    dimension: bool,
}

/// The keyword at the beginning of a word, and how long it is.
fn keyword(word: &[u8]) -> Option<(Kind, usize)> {
    let mut kind = Kind::default();
    let mut rest = word;
    let mut take = |prefix: &[u8]| match rest.strip_prefix(prefix) {
        Some(after) => {
            rest = after;
            true
        }
        None => false,
    };
    kind.uv = take(b"ST");
    kind.color = take(b"C");
    kind.normal = take(b"N");
    kind.weight = take(b"4");
    kind.dimension = take(b"n");
    take(b"OFF").then_some((kind, word.len() - rest.len()))
}

/// Whether a word begins like an OFF file.
pub(crate) fn is_keyword(word: &[u8]) -> bool {
    keyword(word).is_some()
}
