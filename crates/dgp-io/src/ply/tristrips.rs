//! Triangle strips.

use dgp_mesh::VertexId;

use super::{number::vertex, rows::Misnamed, table::Lists};

/// The triangles of strips in which −1 begins a new strip. Every other triangle of a strip is turned,
/// so that all have the same side outside; triangles with a repeated corner only join strips.
pub(super) fn unrolled(lists: &Lists, vertex_count: usize) -> Result<Vec<[VertexId; 3]>, Misnamed> {
    let mut triangles = Vec::with_capacity(lists.values.len());
    let mut start = 0;
    for (row, &end) in lists.ends.iter().enumerate() {
        let mut last = [None; 2];
        let mut turned = false;
        for i in start..end as usize {
            let number = lists.values.get(i);
            if number == -1.0 {
                last = [None; 2];
                turned = false;
                continue;
            }
            let Some(v) = vertex(number, vertex_count) else {
                return Err(Misnamed { row, byte: 0, index: number as i64 });
            };
            if let [Some(a), Some(b)] = last {
                if a != b && b != v && v != a {
                    triangles.push(if turned { [b, a, v] } else { [a, b, v] });
                }
                turned = !turned;
            }
            last = [last[1], Some(v)];
        }
        start = end as usize;
    }
    Ok(triangles)
}
