//! Half-edges from indexed faces, in linear time.
//!
//! Each corner of a face starts a directed side a → b. Sides are put into buckets by their smaller
//! vertex (a counting sort), each small bucket is sorted by the larger vertex, and then the two sides
//! of an edge are neighbors. No hashing; arrays are written in order and read where faces that are
//! close in the list are close on the surface.

use std::ops::Range;

use crate::{
    Connectivity, CornerId, FaceId, FaceList, HalfedgeId, HalfedgeMap, NotManifold, VertexId,
    VertexMap, parallel,
};

/// The half-edge that starts at each corner, in the order of [`FaceList::corners`].
pub(crate) type CornerHalfedges = Vec<HalfedgeId>;

/// Joins faces whose vertices are all in range.
pub(crate) fn assemble(
    vertex_count: usize,
    faces: &FaceList,
) -> Result<(Connectivity, CornerHalfedges), NotManifold> {
    check_degrees(faces)?;
    let Edges { to, corner, corner_halfedges, vertex_halfedge, holes } =
        Edges::new(vertex_count, faces)?;
    let (next, prev, face) = link_faces(faces, &corner, &corner_halfedges);
    let face_halfedge =
        parallel::map(faces.len(), |f| corner_halfedges[faces.face_start(f).index()]);
    let mut connectivity = Connectivity { next, prev, to, face, vertex_halfedge, face_halfedge };
    link_holes(&mut connectivity, &holes)?;
    check_fans(&connectivity)?;
    Ok((connectivity, corner_halfedges))
}

/// Refuses faces of fewer than three corners and faces that visit a vertex twice.
fn check_degrees(faces: &FaceList) -> Result<(), NotManifold> {
    let worst = parallel::map_blocks(faces.len(), parallel::BLOCK, |block| {
        let mut sorted = Vec::new();
        block.map(FaceId::new).find(|&f| match *faces.face(f) {
            [a, b, c] => a == b || b == c || c == a,
            [] | [_] | [_, _] => true,
            ref vertices => {
                sorted.clear();
                sorted.extend_from_slice(vertices);
                sorted.sort_unstable();
                sorted.windows(2).any(|pair| pair[0] == pair[1])
            }
        })
    });
    worst
        .into_iter()
        .flatten()
        .next()
        .map_or(Ok(()), |face| Err(NotManifold::DegenerateFace { face }))
}

/// A side of a face in the bucket of its smaller vertex. From the top: 32 bits for the larger vertex,
/// one for the direction (0 if the side leads from the smaller to the larger), 31 for its corner.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side(u64);

impl Side {
    /// Comes after every side.
    const LAST: Side = Side(u64::MAX);

    #[inline]
    fn new(corner: usize, a: VertexId, b: VertexId) -> Self {
        let (smaller, larger) = (a.index().min(b.index()), a.index().max(b.index()));
        Side((larger as u64) << 32 | u64::from(a.index() != smaller) << 31 | corner as u64)
    }

    #[inline]
    pub(crate) fn larger(self) -> usize {
        (self.0 >> 32) as usize
    }

    #[inline]
    pub(crate) fn is_forward(self) -> bool {
        self.0 >> 31 & 1 == 0
    }

    #[inline]
    pub(crate) fn corner(self) -> usize {
        self.0 as usize & (FaceList::MAX_CORNERS - 1)
    }
}

/// The sides of all faces in sorted buckets by smaller vertex. That of v is `[v]..[v + 1]` of the
/// second list.
pub(crate) fn sorted_sides(vertex_count: usize, faces: &FaceList) -> (Vec<Side>, Vec<u32>) {
    let mut starts = vec![0_u32; vertex_count + 2];
    for_each_side(faces, |_, a, b| starts[a.index().min(b.index()) + 2] += 1);
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    // starts[v + 1] is now where bucket v begins, and moves to its end as it fills.
    let mut sides = vec![Side(0); faces.corners().len()];
    for_each_side(faces, |corner, a, b| {
        let place = &mut starts[a.index().min(b.index()) + 1];
        sides[*place as usize] = Side::new(corner, a, b);
        *place += 1;
    });
    sort_buckets(&mut sides, &starts, 0..vertex_count);
    (sides, starts)
}

/// Calls `f(corner, a, b)` for each side a → b of each face, in order.
#[inline]
fn for_each_side(faces: &FaceList, mut f: impl FnMut(usize, VertexId, VertexId)) {
    if faces.uniform_degree() == Some(3) {
        for (t, &[a, b, c]) in faces.corners().as_chunks::<3>().0.iter().enumerate() {
            f(3 * t, a, b);
            f(3 * t + 1, b, c);
            f(3 * t + 2, c, a);
        }
        return;
    }
    let mut corner = 0;
    for (_, face) in faces.iter() {
        let mut a = face[face.len() - 1];
        let last = corner + face.len() - 1;
        for (k, &b) in face.iter().enumerate() {
            f(if k == 0 { last } else { corner + k - 1 }, a, b);
            a = b;
        }
        corner += face.len();
    }
}

/// Sorts the buckets of these vertices, whose sides begin at `sides[0]`; halves in parallel.
fn sort_buckets(sides: &mut [Side], starts: &[u32], vertices: Range<usize>) {
    if vertices.len() > 4 * parallel::BLOCK {
        let middle = vertices.start.midpoint(vertices.end);
        let (low, high) = sides.split_at_mut((starts[middle] - starts[vertices.start]) as usize);
        parallel::join(
            || sort_buckets(low, starts, vertices.start..middle),
            || sort_buckets(high, starts, middle..vertices.end),
        );
        return;
    }
    let mut rest = sides;
    for v in vertices {
        let (bucket, others) = rest.split_at_mut((starts[v + 1] - starts[v]) as usize);
        sort_bucket(bucket);
        rest = others;
    }
}

/// Sorts a bucket. Most have about six sides in no order, where branches on comparisons are guesses;
/// up to eight go through a network of minima and maxima instead (Batcher 1968).
#[inline]
fn sort_bucket(bucket: &mut [Side]) {
    const NETWORK: [(usize, usize); 19] = [
        (0, 1),
        (2, 3),
        (4, 5),
        (6, 7),
        (0, 2),
        (1, 3),
        (4, 6),
        (5, 7),
        (1, 2),
        (5, 6),
        (0, 4),
        (1, 5),
        (2, 6),
        (3, 7),
        (2, 4),
        (3, 5),
        (1, 2),
        (3, 4),
        (5, 6),
    ];
    match bucket.len() {
        0 | 1 => {}
        2 => {
            let [a, b] = [bucket[0].min(bucket[1]), bucket[0].max(bucket[1])];
            bucket.copy_from_slice(&[a, b]);
        }
        3..=8 => {
            let mut sides = [Side::LAST; 8];
            sides[..bucket.len()].copy_from_slice(bucket);
            for (i, j) in NETWORK {
                (sides[i], sides[j]) = (sides[i].min(sides[j]), sides[i].max(sides[j]));
            }
            bucket.copy_from_slice(&sides[..bucket.len()]);
        }
        _ => bucket.sort_unstable(),
    }
}

/// The numbered edges, and what is known of them before the faces are linked.
struct Edges {
    to: HalfedgeMap<VertexId>,
    /// The corner each half-edge starts at; one past the last corner where it has no face.
    corner: HalfedgeMap<u32>,
    corner_halfedges: CornerHalfedges,
    vertex_halfedge: VertexMap<Option<HalfedgeId>>,
    /// The half-edges without a face.
    holes: Vec<HalfedgeId>,
}

impl Edges {
    fn new(vertex_count: usize, faces: &FaceList) -> Result<Self, NotManifold> {
        let (sides, starts) = sorted_sides(vertex_count, faces);
        let none = sides.len() as u32;
        let mut corner_halfedges = vec![HalfedgeId::new(0); sides.len()];
        let mut vertex_halfedge = VertexMap::filled(vertex_count, None);
        let mut holes = Vec::new();
        // Room for an eighth of the edges on the boundary; a patchwork grows.
        let room = sides.len() / 2 + sides.len() / 16;
        let mut to = Vec::with_capacity(room);
        let mut corner = Vec::with_capacity(room);
        for v in 0..vertex_count {
            let smaller = VertexId::new(v);
            let mut rest = &sides[starts[v] as usize..starts[v + 1] as usize];
            while let &[side, ref others @ ..] = rest {
                let halfedge = HalfedgeId::new(2 * to.len());
                let larger = VertexId::new(side.larger());
                let is_shared = others.first().is_some_and(|other| other.larger() == side.larger());
                if is_shared {
                    // Sorted, the forward side comes first.
                    let (other, others) = (others[0], &others[1..]);
                    let third = others.first().is_some_and(|s| s.larger() == side.larger());
                    if third || side.is_forward() == other.is_forward() {
                        return Err(obstacle([smaller, larger], rest, faces));
                    }
                    corner_halfedges[side.corner()] = halfedge;
                    corner_halfedges[other.corner()] = halfedge.twin();
                    corner.push([side.corner() as u32, other.corner() as u32]);
                    rest = others;
                } else {
                    let (inside, outside, corners) = if side.is_forward() {
                        (halfedge, halfedge.twin(), [side.corner() as u32, none])
                    } else {
                        (halfedge.twin(), halfedge, [none, side.corner() as u32])
                    };
                    corner_halfedges[side.corner()] = inside;
                    corner.push(corners);
                    holes.push(outside);
                    rest = others;
                }
                to.push([larger, smaller]);
                vertex_halfedge[smaller] = Some(halfedge);
                vertex_halfedge[larger] = Some(halfedge.twin());
            }
        }
        let (to, corner) = (to.into_flattened().into(), corner.into_flattened().into());
        Ok(Edges { to, corner, corner_halfedges, vertex_halfedge, holes })
    }
}

/// Why the first sides of this bucket cannot be the two half-edges of one edge.
fn obstacle(vertices: [VertexId; 2], bucket: &[Side], faces: &FaceList) -> NotManifold {
    match bucket.iter().take_while(|side| side.larger() == bucket[0].larger()).count() {
        2 => {
            let mut faces = [0, 1].map(|k| faces.corner_face(CornerId::new(bucket[k].corner())));
            faces.sort_unstable();
            NotManifold::Misoriented { vertices, faces }
        }
        count => NotManifold::NonManifoldEdge { vertices, faces: count },
    }
}

type Links = (HalfedgeMap<HalfedgeId>, HalfedgeMap<HalfedgeId>, HalfedgeMap<Option<FaceId>>);

/// Next, prev and face of the half-edges that have a face; itself, itself and none for the others.
fn link_faces(faces: &FaceList, corner: &HalfedgeMap<u32>, halfedges: &[HalfedgeId]) -> Links {
    // The face of a corner, its first corner, and the number of its corners.
    if faces.uniform_degree() == Some(3) {
        return link(corner, halfedges, |c| (FaceId::new(c / 3), c / 3 * 3, 3));
    }
    let mut corner_faces = Vec::with_capacity(halfedges.len());
    for (f, face) in faces.iter() {
        corner_faces.resize(corner_faces.len() + face.len(), f);
    }
    link(corner, halfedges, |c| {
        let f = corner_faces[c];
        (f, faces.face_start(f).index(), faces.degree(f))
    })
}

#[inline]
fn link(
    corner: &HalfedgeMap<u32>,
    halfedges: &[HalfedgeId],
    face: impl Fn(usize) -> (FaceId, usize, usize) + Sync + Send,
) -> Links {
    let none = halfedges.len();
    let next = parallel::map(corner.len(), |h: HalfedgeId| match corner[h] as usize {
        c if c == none => h,
        c => {
            let (_, start, degree) = face(c);
            halfedges[if c + 1 == start + degree { start } else { c + 1 }]
        }
    });
    let prev = parallel::map(corner.len(), |h: HalfedgeId| match corner[h] as usize {
        c if c == none => h,
        c => {
            let (_, start, degree) = face(c);
            halfedges[if c == start { start + degree - 1 } else { c - 1 }]
        }
    });
    let faces = parallel::map(corner.len(), |h: HalfedgeId| match corner[h] as usize {
        c if c == none => None,
        c => Some(face(c).0),
    });
    (next, prev, faces)
}

/// Chains the half-edges without a face around each hole, and lets boundary vertices start with them.
fn link_holes(connectivity: &mut Connectivity, holes: &[HalfedgeId]) -> Result<(), NotManifold> {
    let Connectivity { next, prev, to, face, vertex_halfedge, .. } = connectivity;
    for &h in holes {
        let vertex = to[h.twin()];
        match vertex_halfedge[vertex] {
            Some(first) if face[first].is_none() && first != h => {
                // A second gap.
                return Err(NotManifold::NonManifoldVertex { vertex });
            }
            _ => vertex_halfedge[vertex] = Some(h),
        }
    }
    for &h in holes {
        // Faces enter and leave a vertex equally often, so where a hole arrives one also leaves.
        if let Some(following) = vertex_halfedge[to[h]] {
            next[h] = following;
            prev[following] = h;
        }
    }
    Ok(())
}

/// Refuses vertices where the faces form several fans.
///
/// Every half-edge is in just one orbit around the vertex it leaves. Walking one orbit per vertex
/// meets all of them if and only if no vertex has a second orbit.
fn check_fans(connectivity: &Connectivity) -> Result<(), NotManifold> {
    let valence = |v: VertexId| connectivity.valence(v);
    let met = parallel::reduce(connectivity.vertex_count(), 0, valence, |a, b| a + b);
    if met == connectivity.halfedge_count() {
        return Ok(());
    }
    let mut leaving: VertexMap<usize> = VertexMap::filled(connectivity.vertex_count(), 0);
    for h in connectivity.halfedges() {
        leaving[connectivity.from(h)] += 1;
    }
    let vertex = leaving.iter().find(|&(v, &count)| count != valence(v)).map(|(v, _)| v);
    Err(NotManifold::NonManifoldVertex { vertex: vertex.expect("a vertex has a second fan") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    fn refusal<F: AsRef<[usize]>>(vertices: usize, faces: &[F]) -> NotManifold {
        match Connectivity::from_faces(vertices, &FaceList::from_indices(faces)) {
            Err(Error::NotManifold(reason)) => reason,
            other => panic!("expected a refusal, got {other:?}"),
        }
    }

    #[test]
    fn a_strip_of_two_triangles_has_one_hole_around_it() {
        let mesh = Connectivity::from_faces(4, &FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]));
        let mesh = mesh.unwrap();
        assert_eq!((mesh.edge_count(), mesh.halfedge_count()), (5, 10));
        let start = mesh.halfedges().find(|&h| mesh.face(h).is_none()).unwrap();
        assert_eq!(mesh.loop_halfedges(start).count(), 4);
        assert_eq!(mesh.to_faces(), FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]));
    }

    #[test]
    fn edges_are_numbered_by_their_vertices() {
        let mesh = Connectivity::from_faces(4, &FaceList::from_indices(&[[3, 1, 2], [2, 1, 0]]));
        let mesh = mesh.unwrap();
        let ends: Vec<_> = mesh
            .edges()
            .map(|e| (mesh.from(e.halfedge()).index(), mesh.to(e.halfedge()).index()))
            .collect();
        assert_eq!(ends, [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)]);
    }

    #[test]
    fn three_faces_at_an_edge_are_refused() {
        let reason = refusal(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert!(matches!(reason, NotManifold::NonManifoldEdge { faces: 3, .. }), "{reason}");
    }

    #[test]
    fn faces_that_run_the_same_way_along_an_edge_are_refused() {
        let reason = refusal(4, &[[0, 1, 2], [0, 1, 3]]);
        assert!(matches!(reason, NotManifold::Misoriented { .. }), "{reason}");
    }

    #[test]
    fn a_bow_tie_is_refused_open_and_closed() {
        let open = refusal(5, &[[0, 1, 2], [0, 3, 4]]);
        assert_eq!(open, NotManifold::NonManifoldVertex { vertex: VertexId::new(0) });
        let tetrahedron = |a: [usize; 4]| {
            [[a[0], a[2], a[1]], [a[0], a[1], a[3]], [a[1], a[2], a[3]], [a[2], a[0], a[3]]]
        };
        let closed = refusal(7, &[tetrahedron([0, 1, 2, 3]), tetrahedron([4, 5, 3, 6])].concat());
        assert_eq!(closed, NotManifold::NonManifoldVertex { vertex: VertexId::new(3) });
    }

    #[test]
    fn faces_that_are_no_polygons_are_refused() {
        for face in [&[0, 1][..], &[0, 1, 1], &[0, 1, 2, 1, 3], &[]] {
            let reason = refusal(4, &[face]);
            assert!(matches!(reason, NotManifold::DegenerateFace { .. }), "{face:?}: {reason}");
        }
    }
}
