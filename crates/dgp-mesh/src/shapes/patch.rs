//! Rows and columns of quads, whole or cut into triangles, with any identification of vertices.

use super::Tiling;
use crate::{FaceList, VertexId};

/// The cells (i, j) of `columns` × `rows`, with the corners i..=i + 1 and j..=j + 1.
///
/// Cells turn from i to j. Where two neighboring corners of a cell are the same vertex, as at the
/// pole of a sphere, the cell becomes a triangle.
pub(super) fn cells(
    [columns, rows]: [usize; 2],
    tiling: Tiling,
    vertex: impl Fn(usize, usize) -> VertexId,
) -> FaceList {
    let mut quads = FaceList::new();
    let mut triangles = Vec::new();
    match tiling {
        Tiling::Quads => quads.reserve(columns * rows, 4 * columns * rows),
        Tiling::Triangles => triangles.reserve(2 * columns * rows),
    }
    for j in 0..rows {
        for i in 0..columns {
            let corners = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            let [a, b, c, d] = corners;
            match tiling {
                Tiling::Triangles => {
                    let halves = [[a, b, c], [a, c, d]];
                    triangles
                        .extend(halves.into_iter().filter(|&[a, b, c]| a != b && b != c && c != a));
                }
                Tiling::Quads if a == b => _ = quads.push(&[b, c, d]),
                Tiling::Quads if c == d => _ = quads.push(&[a, b, c]),
                Tiling::Quads => _ = quads.push(&corners),
            }
        }
    }
    match tiling {
        Tiling::Quads => quads,
        Tiling::Triangles => FaceList::from_triangles(triangles),
    }
}
