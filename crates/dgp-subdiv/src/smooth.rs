//! Values of the next level where nothing but rims is sharp: the rules of [`primal`](crate::primal) without
//! rows being written down.
//!
//! - Input: a level without creases.
//! - Cost: O(corners), in parallel.
//! - Guarantees: the same bits for any number of threads.

use dgp_mesh::parallel;

use crate::{
    masks::{Value, face_means},
    primal::{COMMON, Kind},
    topology::{NONE, Topology},
};

/// The new values: old vertices, edges, faces (where the scheme splits polygons).
pub(crate) fn refined<T: Value>(topology: &Topology, kind: Kind, old: &[T]) -> Vec<T> {
    let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
    let faces = if kind.splits_polygons() { topology.face_count() } else { 0 };
    let mut new = vec![T::default(); vertices + edges + faces];
    let (points, means) = new.split_at_mut(vertices + edges);
    let (moved, middles) = points.split_at_mut(vertices);
    if faces > 0 {
        face_means(topology, old, means);
    }
    let means = &*means;
    let mut common = [[0.0; 3]; COMMON];
    for (valence, mask) in common.iter_mut().enumerate().skip(1) {
        *mask = kind.smooth_vertex(valence);
    }
    if kind == Kind::Bilinear {
        moved.copy_from_slice(old);
    } else {
        parallel::for_each_chunk(moved, parallel::BLOCK, |first, chunk| {
            for (v, value) in (first..).zip(chunk) {
                *value = vertex(topology, kind, &common, old, means, v);
            }
        });
    }
    parallel::for_each_chunk(middles, parallel::BLOCK, |first, chunk| {
        for (e, value) in (first as u32..).zip(chunk) {
            *value = edge(topology, kind, old, means, e);
        }
    });
    new
}

#[inline]
fn vertex<T: Value>(
    topology: &Topology,
    kind: Kind,
    common: &[[f64; 3]; COMMON],
    old: &[T],
    means: &[T],
    v: usize,
) -> T {
    let first = topology.vertex_halfedge[v];
    let (mut spoke, mut valence) = (first, 0);
    let (mut neighbors, mut faces) = (T::default(), T::default());
    loop {
        let corner = topology.corner(spoke);
        if corner == NONE {
            // The last one beside a hole, which the first begins beside.
            let ends = old[topology.to(first) as usize] + old[topology.to(spoke) as usize];
            return old[v] * 0.75 + ends * 0.125;
        }
        neighbors = neighbors + old[topology.to(spoke) as usize];
        valence += 1;
        if !means.is_empty() {
            faces = faces + means[topology.face(corner) as usize];
        }
        spoke = topology.corner_halfedge[topology.prev(corner) as usize] ^ 1;
        if spoke == first {
            break;
        }
    }
    let mask = common.get(valence).copied().unwrap_or_else(|| kind.smooth_vertex(valence));
    let sum = old[v] * mask[0] + neighbors * mask[1];
    if means.is_empty() { sum } else { sum + faces * mask[2] }
}

#[inline]
fn edge<T: Value>(topology: &Topology, kind: Kind, old: &[T], means: &[T], e: u32) -> T {
    let halfedges = [2 * e, 2 * e + 1];
    let [a, b] = halfedges.map(|h| old[topology.from(h) as usize]);
    let corners = halfedges.map(|h| topology.corner(h));
    if kind == Kind::Bilinear || corners.contains(&NONE) {
        return (a + b) * 0.5;
    }
    let [end, side] = kind.smooth_edge();
    let [c, d] = corners.map(|corner| {
        if means.is_empty() {
            old[topology.vertex(topology.prev(corner)) as usize]
        } else {
            means[topology.face(corner) as usize]
        }
    });
    (a + b) * end + (c + d) * side
}
