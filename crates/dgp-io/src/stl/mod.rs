//! Stereolithography STL, text and binary.
//!
//! STL is a soup: corners with equal coordinates (−0 equals 0) become one vertex, numbered by first
//! appearance. The normals of facets follow from their corners: they are not kept but compared, and
//! computed when writing.
//!
//! - Input: any bytes.
//! - Cost: O(bytes), and one look-up in a table for each corner.
//! - Reference: "StereoLithography Interface Specification", 3D Systems, 1988.

mod binary;
mod text;
mod write;

use dgp_mesh::Progress;

use crate::{Contents, error::Stop};

pub(crate) use write::write;

/// The bytes before the facets of a binary file: 80 of free text and the number of facets.
const HEADER: usize = 84;
/// The bytes of a facet: normal, three corners, 16 bits of whatever the writer wanted.
const FACET: usize = 50;

/// Reads an STL file.
pub(crate) fn read(bytes: &[u8], progress: Progress<'_>) -> Result<Contents, Stop> {
    // Many binary files begin with the word "solid", so the size has the first word.
    let begins = bytes.trim_ascii_start().get(..5);
    let solid = begins.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if !is_binary(bytes) && (bytes.is_empty() || solid && is_text(bytes)) {
        text::read(bytes, progress)
    } else {
        binary::read(bytes, progress)
    }
}

/// Whether the size of the file is what a binary file of that many facets has.
pub(crate) fn is_binary(bytes: &[u8]) -> bool {
    facet_count(bytes)
        .is_some_and(|count| (HEADER + FACET * count as usize) as u64 == bytes.len() as u64)
}

/// The number of facets a binary file claims to have.
fn facet_count(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..).and_then(<[u8]>::first_chunk).map(|count| u32::from_le_bytes(*count))
}

/// Whether the beginning of the file has the bytes of text only.
fn is_text(bytes: &[u8]) -> bool {
    bytes.iter().take(512).all(|&byte| byte >= b' ' || byte.is_ascii_whitespace())
}
