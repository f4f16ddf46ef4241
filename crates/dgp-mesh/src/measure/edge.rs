//! Lengths of edges.

use glam::DVec3;

use super::scale;
use crate::{EdgeId, EdgeMap, HalfedgeId, IndexedFaceSet, Mesh, topology};

/// Measures at an edge.
impl Mesh {
    /// The vector from the start of `h` to its end.
    #[inline]
    pub fn halfedge_vector(&self, h: HalfedgeId) -> DVec3 {
        self.position(self.to(h)) - self.position(self.from(h))
    }

    /// The length of `e`.
    #[inline]
    pub fn edge_length(&self, e: EdgeId) -> f64 {
        let [a, b] = self.edge_vertices(e);
        scale::distance(self.position(a), self.position(b))
    }

    /// The point in the middle of `e`.
    #[inline]
    pub fn edge_midpoint(&self, e: EdgeId) -> DVec3 {
        let [a, b] = self.edge_vertices(e);
        0.5 * self.position(a) + 0.5 * self.position(b)
    }
}

/// The length of each edge.
pub fn edge_lengths(mesh: &Mesh) -> EdgeMap<f64> {
    mesh.map_edges(|e| mesh.edge_length(e))
}

/// The smallest, the mean and the largest of some values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest value.
    pub min: f64,
    /// The sum of the values over their number.
    pub mean: f64,
    /// The largest value.
    pub max: f64,
}

impl Range {
    /// The range of `values`; `None` if there are none. Values that are not finite do not count.
    pub fn of(values: &[f64]) -> Option<Self> {
        let max = values.iter().copied().filter(|x| x.is_finite()).reduce(f64::max)?;
        let min = values.iter().copied().filter(|x| x.is_finite()).fold(max, f64::min);
        // Summed relative to the largest, so that huge values do not overflow.
        let scale = scale::Scale::of(max.abs().max(min.abs()));
        let (sum, count) = values
            .iter()
            .filter(|x| x.is_finite())
            .fold((0.0, 0.0), |(sum, count), x| (sum + x * scale.down, count + 1.0));
        Some(Range { min, mean: sum / count * scale.up, max })
    }
}

/// Shortest, mean and longest edge; `None` without edges.
pub fn edge_length_range(mesh: &Mesh) -> Option<Range> {
    Range::of(edge_lengths(mesh).values())
}

/// Shortest, mean and longest edge of any face set, each pair of vertices counted once.
///
/// Edges that end at a coordinate that is not finite do not count. `None` without edges.
pub fn face_set_edge_length_range(set: &IndexedFaceSet) -> Option<Range> {
    let edges = topology::edge_uses(set.vertex_count(), set.faces());
    let length = |e: &topology::EdgeUse| {
        scale::distance(set.position(e.vertices[0]), set.position(e.vertices[1]))
    };
    Range::of(&edges.iter().map(length).collect::<Vec<f64>>())
}
