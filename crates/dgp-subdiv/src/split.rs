//! How faces split: the connectivity of the next level by arithmetic on that of this one.
//!
//! Both splits number the new vertices: old vertices, then a point per edge, then (four-way split of
//! polygons) a point per face; and the new edges: number h for the half of half-edge h next to the vertex
//! it leaves, then 2E + c for the edge that cuts off corner c or starts at the middle of its side.
//!
//! ```text
//!        of polygons, a quadrilateral per corner      of triangles, 4f + k at corner k, 4f + 3 inside
//!
//!              ●───────○───────●                                    ●
//!              │       │       │                                   ╱ ╲
//!              │   c₃  │  c₂   │                                  ╱c₂ ╲
//!              ○───────◎───────○                                 ○─────○
//!              │   c₀  │  c₁   │                                ╱ ╲   ╱ ╲
//!              │       │       │                               ╱c₀ ╲ ╱c₁ ╲
//!              ●──────▸○───────●                              ●────▸○─────●
//!            child edge h(c₀): leaves the vertex of c₀, ends at the middle of h(c₀)
//! ```
//!
//! - Cost: O(corners), one pass over each array, in parallel.

use dgp_mesh::parallel;

use crate::topology::{NONE, Starts, Topology};

/// Parents per task.
const PARENTS: usize = 1024;

/// The children of polygons: a quadrilateral per corner c, with number c.
///
/// Its corners: the old vertex, the middle of the side that starts there, the face point, the middle of
/// the side before.
pub(crate) fn split_polygons(parent: &Topology) -> Topology {
    let halves = 2 * parent.edge_count() as u32;
    let mut corner_halfedge = vec![0; 4 * parent.corner_count()];
    parallel::for_each_chunk(&mut corner_halfedge, 4 * PARENTS, |first, chunk| {
        for (child, c) in chunk.as_chunks_mut::<4>().0.iter_mut().zip(first as u32 / 4..) {
            let before = parent.prev(c);
            *child = [
                2 * parent.corner_halfedge[c as usize],
                2 * (halves + c),
                2 * (halves + before) + 1,
                2 * (parent.corner_halfedge[before as usize] ^ 1) + 1,
            ];
        }
    });
    let inner = |c: u32| [4 * c + 1, 4 * parent.next(c) + 2];
    let outer = |corner: u32| 4 * corner;
    let arriving = |corner: u32| 4 * parent.next(corner) + 3;
    let halfedge_corner = child_corners(parent, outer, arriving, inner);
    let (vertices, edges) = (parent.vertex_count() as u32, parent.edge_count() as u32);
    let from = child_origins(parent, |c| {
        let edge = parent.corner_halfedge[c as usize] >> 1;
        [vertices + edge, vertices + edges + parent.face(c)]
    });
    let mut vertex_halfedge = first_halfedges(parent, parent.face_count());
    let tail = (vertices + edges) as usize;
    parallel::for_each_chunk(&mut vertex_halfedge[tail..], PARENTS, |first, chunk| {
        for (child, f) in chunk.iter_mut().zip(first as u32..) {
            *child = 2 * (halves + parent.corners(f).start) + 1;
        }
    });
    Topology { starts: Starts::Every(4), corner_halfedge, halfedge_corner, from, vertex_halfedge }
}

/// The children of triangles: 4f + k at corner k of triangle f, 4f + 3 between them.
pub(crate) fn split_triangles(parent: &Topology) -> Topology {
    let halves = 2 * parent.edge_count() as u32;
    let mut corner_halfedge = vec![0; 4 * parent.corner_count()];
    parallel::for_each_chunk(&mut corner_halfedge, 12 * PARENTS, |first, chunk| {
        for (child, f) in chunk.as_chunks_mut::<12>().0.iter_mut().zip(first as u32 / 12..) {
            for k in 0..3 {
                let (c, before, after) =
                    (3 * f + k as u32, 3 * f + (k as u32 + 2) % 3, 3 * f + (k as u32 + 1) % 3);
                child[3 * k] = 2 * parent.corner_halfedge[c as usize];
                child[3 * k + 1] = 2 * (halves + c);
                child[3 * k + 2] = 2 * (parent.corner_halfedge[before as usize] ^ 1) + 1;
                child[9 + k] = 2 * (halves + after) + 1;
            }
        }
    });
    let at = |corner: u32| 12 * (corner / 3) + 3 * (corner % 3);
    // The triangle in the middle starts its side k at the middle of side k and ends it at that of side
    // k + 1, so the edge that cuts off corner c is its side c − 1.
    let inner = |c: u32| [at(c) + 1, 12 * (c / 3) + 9 + (c + 2) % 3];
    let arriving = |corner: u32| at(parent.next(corner)) + 2;
    let halfedge_corner = child_corners(parent, at, arriving, inner);
    let vertices = parent.vertex_count() as u32;
    let from = child_origins(parent, |c| {
        let edge = |corner: u32| parent.corner_halfedge[corner as usize] >> 1;
        [vertices + edge(c), vertices + edge(parent.prev(c))]
    });
    let vertex_halfedge = first_halfedges(parent, 0);
    Topology { starts: Starts::Every(3), corner_halfedge, halfedge_corner, from, vertex_halfedge }
}

/// The corner of each child half-edge. `leaving` and `arriving` give the child corners at which the half
/// of a side begins that leaves, or that arrives at, its old vertex; `inner` those of the inner edge of a
/// corner.
fn child_corners(
    parent: &Topology,
    leaving: impl Fn(u32) -> u32 + Sync + Send,
    arriving: impl Fn(u32) -> u32 + Sync + Send,
    inner: impl Fn(u32) -> [u32; 2] + Sync + Send,
) -> Vec<u32> {
    let halves = parent.from.len();
    let mut corners = vec![0; 2 * (halves + parent.corner_count())];
    let (outer_part, inner_part) = corners.split_at_mut(2 * halves);
    let or_none = |corner: u32, child: &dyn Fn(u32) -> u32| match corner {
        NONE => NONE,
        corner => child(corner),
    };
    parallel::for_each_chunk(outer_part, 2 * PARENTS, |first, chunk| {
        for (pair, h) in chunk.as_chunks_mut::<2>().0.iter_mut().zip(first as u32 / 2..) {
            *pair = [or_none(parent.corner(h), &leaving), or_none(parent.corner(h ^ 1), &arriving)];
        }
    });
    parallel::for_each_chunk(inner_part, 2 * PARENTS, |first, chunk| {
        for (pair, c) in chunk.as_chunks_mut::<2>().0.iter_mut().zip(first as u32 / 2..) {
            *pair = inner(c);
        }
    });
    corners
}

/// The vertex each child half-edge leaves; `inner` gives the ends of the inner edge of a corner.
fn child_origins(parent: &Topology, inner: impl Fn(u32) -> [u32; 2] + Sync + Send) -> Vec<u32> {
    let halves = parent.from.len();
    let vertices = parent.vertex_count() as u32;
    let mut from = vec![0; 2 * (halves + parent.corner_count())];
    let (outer_part, inner_part) = from.split_at_mut(2 * halves);
    parallel::for_each_chunk(outer_part, 2 * PARENTS, |first, chunk| {
        for (pair, h) in chunk.as_chunks_mut::<2>().0.iter_mut().zip(first as u32 / 2..) {
            *pair = [parent.from[h as usize], vertices + (h >> 1)];
        }
    });
    parallel::for_each_chunk(inner_part, 2 * PARENTS, |first, chunk| {
        for (pair, c) in chunk.as_chunks_mut::<2>().0.iter_mut().zip(first as u32 / 2..) {
            *pair = inner(c);
        }
    });
    from
}

/// The first half-edge of old vertices and edge points, with room for `more`.
fn first_halfedges(parent: &Topology, more: usize) -> Vec<u32> {
    let (vertices, edges) = (parent.vertex_count(), parent.edge_count());
    let mut first = Vec::with_capacity(vertices + edges + more);
    first.extend(parent.vertex_halfedge.iter().map(|&h| if h == NONE { NONE } else { 2 * h }));
    first.extend((0..edges as u32).map(|e| {
        // Beside a hole the first one has it on its right: it runs against the half-edge of the hole.
        let hole = u32::from(parent.corner(2 * e + 1) == NONE);
        2 * (2 * e + hole) + 1
    }));
    first.resize(vertices + edges + more, NONE);
    first
}

#[cfg(test)]
mod tests {
    use dgp_mesh::{Connectivity, Mesh, VertexId, shapes};

    use super::*;

    /// All that arrays say of one another, and what half-edges joined from the faces say.
    fn check(topology: &Topology) {
        let mesh = Connectivity::from_faces(topology.vertex_count(), &topology.faces()).unwrap();
        assert_eq!(topology.edge_count(), mesh.edge_count());
        for c in 0..topology.corner_count() as u32 {
            let h = topology.corner_halfedge[c as usize];
            assert_eq!(topology.corner(h), c);
            assert_eq!(topology.to(h), topology.vertex(topology.next(c)));
            assert_eq!(topology.prev(topology.next(c)), c);
        }
        let mut spokes = Vec::new();
        for v in mesh.vertices() {
            let closed = topology.spokes(v.index(), &mut spokes);
            assert_eq!(closed, !mesh.is_boundary_vertex(v), "{v}");
            let around: Vec<usize> = mesh.vertex_neighbors(v).map(VertexId::index).collect();
            let mine: Vec<usize> = spokes.iter().map(|&h| topology.to(h) as usize).collect();
            assert!(spokes.iter().all(|&h| topology.from[h as usize] as usize == v.index()));
            if closed {
                let first = around.iter().position(|&w| w == mine[0]).unwrap();
                assert_eq!(mine, [&around[first..], &around[..first]].concat(), "{v}");
            } else {
                assert_eq!(mine, around, "{v}");
            }
        }
    }

    #[test]
    fn children_fit_together() {
        let triangles: [Mesh; 4] = [
            shapes::octahedron(),
            shapes::grid(3, 2).unwrap(),
            shapes::annulus(0.5, 1.0, 7, 2).unwrap(),
            shapes::grid(1, 1).unwrap(),
        ];
        for mesh in &triangles {
            let cage = Topology::new(mesh);
            check(&cage);
            let once = split_triangles(&cage);
            check(&once);
            check(&split_triangles(&once));
            check(&split_polygons(&split_triangles(&cage)));
        }
        let polygons: [Mesh; 4] = [
            shapes::truncated_icosahedron(),
            shapes::quad_grid(2, 3).unwrap(),
            shapes::dodecahedron(),
            shapes::capped_cylinder(1.0, 2.0, 5, 2).unwrap(),
        ];
        for mesh in &polygons {
            let cage = Topology::new(mesh);
            check(&cage);
            let once = split_polygons(&cage);
            check(&once);
            check(&split_polygons(&once));
        }
    }
}
