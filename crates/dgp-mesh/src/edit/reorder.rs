//! Reordering: numbers what is close on the surface closely, so that walking stays in the cache.
//!
//! Vertices are numbered along a Hilbert curve through the bounding box; edges and faces in the order
//! in which a walk around one vertex after the other meets them.
//!
//! - Input: any mesh.
//! - Cost: O(n log n).
//! - Reference: Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707, 2004.

use glam::DVec3;

use super::compact::gather;
use crate::{
    EdgeId, EdgeMap, FaceId, FaceMap, HalfedgeId, Id, IdMap, Mesh, VertexId, VertexMap, parallel,
};

/// Where the elements of a mesh went when it was reordered: the new id for each old one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Renumbering {
    /// The new ids of vertices.
    pub vertices: VertexMap<VertexId>,
    /// The new ids of edges. Each keeps its directions: see [`halfedge`](Renumbering::halfedge).
    pub edges: EdgeMap<EdgeId>,
    /// The new ids of faces.
    pub faces: FaceMap<FaceId>,
}

impl Renumbering {
    /// The new id of half-edge `h`.
    #[inline]
    pub fn halfedge(&self, h: HalfedgeId) -> HalfedgeId {
        self.edges[h.edge()].halfedges()[h.index() & 1]
    }
}

/// Numbers vertices, edges and faces of `mesh` anew such that neighbors are close in memory, and
/// tells the new ids.
///
/// The surface stays what it is: each face keeps its first corner, data travel. On large meshes in
/// the random order some files have, this makes every walk several times faster.
pub fn reorder(mesh: &mut Mesh) -> Renumbering {
    let order = along_curve(mesh);
    let (edges, faces) = as_met(mesh, &order);
    let renumbering =
        Renumbering { vertices: inverse(&order), edges: inverse(&edges), faces: inverse(&faces) };
    apply(mesh, &order, &edges, &faces, &renumbering);
    renumbering
}

/// The vertices in the order of their places on the curve.
fn along_curve(mesh: &Mesh) -> Vec<VertexId> {
    let positions = mesh.positions().values();
    let min = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let max = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    // Halves, for the whole may be beyond the largest number.
    let size = (0.5 * max - 0.5 * min).max_element();
    let cells = f64::from(1_u32 << CURVE_BITS);
    let place = |v: VertexId| {
        let p = (0.5 * mesh.position(v) - 0.5 * min) / size * cells;
        // In a single point there is no order; casts take what is no number to zero.
        let cell = p.to_array().map(|x| (x as u32).min((1 << CURVE_BITS) - 1));
        (hilbert_index(cell), v)
    };
    let mut places = parallel::map(mesh.vertex_count(), place).into_values();
    places.sort_unstable();
    places.into_iter().map(|(_, v)| v).collect()
}

/// Bits per coordinate of a place on the curve: as many as fit three times into an index.
const CURVE_BITS: u32 = 21;

/// The index of a cell along the Hilbert curve through 2²¹ cells a side.
fn hilbert_index(mut cell: [u32; 3]) -> u64 {
    // Undoes the rotations and reflections of the curve, from the largest cells to the smallest.
    for bit in (1..CURVE_BITS).rev().map(|k| 1_u32 << k) {
        let lower = bit - 1;
        for axis in 0..3 {
            if cell[axis] & bit != 0 {
                cell[0] ^= lower;
            } else {
                let exchange = (cell[0] ^ cell[axis]) & lower;
                cell[0] ^= exchange;
                cell[axis] ^= exchange;
            }
        }
    }
    // Gray code.
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let mut flips = 0;
    for bit in (1..CURVE_BITS).rev().map(|k| 1_u32 << k) {
        if cell[2] & bit != 0 {
            flips ^= bit - 1;
        }
    }
    let [x, y, z] = cell.map(|c| c ^ flips);
    (0..CURVE_BITS).rev().fold(0, |index, k| {
        index << 3 | u64::from((x >> k & 1) << 2 | (y >> k & 1) << 1 | (z >> k & 1))
    })
}

/// Edges and faces in the order in which walks around the vertices meet them first.
fn as_met(mesh: &Mesh, order: &[VertexId]) -> (Vec<EdgeId>, Vec<FaceId>) {
    let mut edges = Vec::with_capacity(mesh.edge_count());
    let mut faces = Vec::with_capacity(mesh.face_count());
    let mut edge_met = EdgeMap::filled(mesh.edge_count(), false);
    let mut face_met = FaceMap::filled(mesh.face_count(), false);
    for &v in order {
        for h in mesh.vertex_halfedges(v) {
            if !std::mem::replace(&mut edge_met[h.edge()], true) {
                edges.push(h.edge());
            }
            if let Some(f) = mesh.face(h)
                && !std::mem::replace(&mut face_met[f], true)
            {
                faces.push(f);
            }
        }
    }
    (edges, faces)
}

/// The new id of each old one, given the old one of each new.
fn inverse<I: Id>(order: &[I]) -> IdMap<I, I> {
    let mut new = vec![I::from_index(0); order.len()];
    for (i, &old) in order.iter().enumerate() {
        new[old.index()] = I::from_index(i);
    }
    new.into()
}

/// Moves everything to its new place; `vertices`, `edges` and `faces` are the old ids in new order.
fn apply(
    mesh: &mut Mesh,
    vertices: &[VertexId],
    edges: &[EdgeId],
    faces: &[FaceId],
    new: &Renumbering,
) {
    let old_halfedge = |h: HalfedgeId| edges[h.edge().index()].halfedges()[h.index() & 1];
    let halfedges = mesh.halfedge_count();
    let old = std::mem::take(&mut mesh.connectivity);
    let connectivity = &mut mesh.connectivity;
    connectivity.prev = parallel::map(halfedges, |h| new.halfedge(old.prev[old_halfedge(h)]));
    connectivity.to = parallel::map(halfedges, |h| new.vertices[old.to[old_halfedge(h)]]);
    connectivity.face =
        parallel::map(halfedges, |h| old.face[old_halfedge(h)].map(|f| new.faces[f]));
    connectivity.vertex_halfedge = parallel::map(vertices.len(), |v: VertexId| {
        old.vertex_halfedge[vertices[v.index()]].map(|h| new.halfedge(h))
    });
    connectivity.face_halfedge =
        parallel::map(faces.len(), |f: FaceId| new.halfedge(old.face_halfedge[faces[f.index()]]));
    let positions = &mesh.positions;
    mesh.positions = parallel::map(vertices.len(), |v: VertexId| positions[vertices[v.index()]]);
    let attributes = &mut mesh.attributes;
    gather(&mut attributes.vertex, vertices.len(), |v| vertices[v.index()]);
    gather(&mut attributes.edge, edges.len(), |e| edges[e.index()]);
    gather(&mut attributes.face, faces.len(), |f| faces[f.index()]);
    gather(&mut attributes.corner, halfedges, old_halfedge);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_neighboring_cells() {
        // The first 512 places are the lowest eight cells a side.
        let mut places: Vec<(u64, [u32; 3])> = (0..8)
            .flat_map(|x| (0..8).flat_map(move |y| (0..8).map(move |z| [x, y, z])))
            .map(|cell| (hilbert_index(cell), cell))
            .collect();
        places.sort_unstable();
        for (i, pair) in places.windows(2).enumerate() {
            assert_eq!(pair[0].0, i as u64);
            let steps: u32 = (0..3).map(|k| pair[0].1[k].abs_diff(pair[1].1[k])).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
    }
}
