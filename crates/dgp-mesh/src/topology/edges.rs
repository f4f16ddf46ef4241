//! The edges of faces that may be no manifold, each with how its faces use it.
//!
//! The sides of all faces are put into buckets by their smaller vertex and each bucket is sorted by
//! the larger one, in linear time for bounded valences.

use crate::{CornerId, FaceList, VertexId};

/// An edge and the faces along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeUse {
    /// Its ends, the smaller first.
    pub vertices: [VertexId; 2],
    /// How many sides of faces lead from the smaller to the larger.
    pub forward: usize,
    /// How many lead back.
    pub backward: usize,
}

impl EdgeUse {
    /// How many sides of faces lie here.
    pub fn sides(&self) -> usize {
        self.forward + self.backward
    }

    /// Whether only one side lies here.
    pub fn is_boundary(&self) -> bool {
        self.sides() == 1
    }

    /// Whether more than two sides lie here.
    pub fn is_non_manifold(&self) -> bool {
        self.sides() > 2
    }

    /// Whether two sides lie here and lead the same way.
    pub fn is_flipped(&self) -> bool {
        self.sides() == 2 && self.forward != 1
    }
}

/// All pairs of different vertices that a side of a face joins, by smaller, then by larger vertex.
///
/// # Panics
/// If a face names a vertex beyond `vertex_count`.
pub fn edge_uses(vertex_count: usize, faces: &FaceList) -> Vec<EdgeUse> {
    let mut edges = Vec::with_capacity(faces.corners().len() / 2 + 1);
    for_each_edge(vertex_count, faces, |edge, _| edges.push(edge));
    edges
}

/// A side of a face: from the vertex of corner `from` to that of corner `to`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Side {
    pub(crate) from: CornerId,
    pub(crate) to: CornerId,
}

/// Calls `visit` with each edge and its sides, the edges in the order of [`edge_uses`].
///
/// A side that leads from a vertex to the same vertex is no edge.
pub(crate) fn for_each_edge(
    vertex_count: usize,
    faces: &FaceList,
    mut visit: impl FnMut(EdgeUse, &[Side]),
) {
    let corners = faces.corners();
    let mut starts = vec![0_u32; vertex_count + 2];
    for_each_side(faces, |side| {
        let [a, b] = [side.from, side.to].map(|c| corners[c.index()]);
        starts[a.min(b).index() + 2] += u32::from(a != b);
    });
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    // starts[v + 1] is now where bucket v begins, and moves to its end as it fills.
    let mut keys = vec![0_u64; starts[vertex_count + 1] as usize];
    for_each_side(faces, |side| {
        let [a, b] = [side.from, side.to].map(|c| corners[c.index()]);
        if a != b {
            let place = &mut starts[a.min(b).index() + 1];
            keys[*place as usize] = (a.max(b).index() as u64) << 32 | side.from.index() as u64;
            *place += 1;
        }
    });
    let mut after = vec![CornerId::new(0); corners.len()];
    for_each_side(faces, |side| after[side.from.index()] = side.to);
    let mut sides = Vec::new();
    for v in 0..vertex_count {
        let smaller = VertexId::new(v);
        let bucket = &mut keys[starts[v] as usize..starts[v + 1] as usize];
        bucket.sort_unstable();
        for run in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
            sides.clear();
            let from = run.iter().map(|&key| CornerId::new(key as u32 as usize));
            sides.extend(from.map(|from| Side { from, to: after[from.index()] }));
            let forward = sides.iter().filter(|s| corners[s.from.index()] == smaller).count();
            let larger = VertexId::new((run[0] >> 32) as usize);
            let backward = sides.len() - forward;
            visit(EdgeUse { vertices: [smaller, larger], forward, backward }, &sides);
        }
    }
}

/// Calls `visit` with each side of each face, in order.
fn for_each_side(faces: &FaceList, mut visit: impl FnMut(Side)) {
    let mut start = 0;
    for (_, face) in faces.iter() {
        for k in 0..face.len() {
            let after = if k + 1 == face.len() { 0 } else { k + 1 };
            visit(Side { from: CornerId::new(start + k), to: CornerId::new(start + after) });
        }
        start += face.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_of_an_edge_are_counted_by_direction() {
        let faces =
            FaceList::from_indices::<&[usize]>(&[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4], &[3, 3]]);
        let edges = edge_uses(5, &faces);
        assert_eq!((edges[0].forward, edges[0].backward), (2, 1));
        assert!(edges[0].is_non_manifold() && edges[1..].iter().all(EdgeUse::is_boundary));
        let ends: Vec<_> = edges.iter().map(|e| e.vertices.map(VertexId::index)).collect();
        assert_eq!(ends, [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [1, 3], [1, 4]]);
    }
}
