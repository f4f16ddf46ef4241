//! Half-edges from indexed faces, in linear time.
//!
//! Each corner of a face starts a directed side a → b. Sides are put into buckets by their smaller
//! vertex (a counting sort), those that lead to the larger vertex first. Both parts of each small bucket
//! are sorted by the larger vertex, and side by side they give the two sides of each edge. No hashing; arrays are written in order and read where faces that are
//! close in the list are close on the surface.

use std::{cmp::Ordering, ops::Range};

use crate::{
    Connectivity, CornerId, FaceId, FaceList, HalfedgeId, HalfedgeMap, NotManifold, VertexId,
    VertexMap, parallel,
};

/// The number of the half-edge that starts at each corner, in the order of [`FaceList::corners`].
pub(crate) type CornerHalfedges = Vec<u32>;

/// Joins faces whose vertices are all in range.
pub(crate) fn assemble(
    vertex_count: usize,
    faces: &FaceList,
) -> Result<(Connectivity, CornerHalfedges), NotManifold> {
    if faces.uniform_degree() != Some(3) {
        check_degrees(faces)?;
    }
    let Edges { to, corner, corner_halfedges, vertex_halfedge, holes } =
        Edges::new(vertex_count, faces)?;
    let mut connectivity = link_faces(faces, corner, &corner_halfedges);
    connectivity.to = to;
    connectivity.vertex_halfedge = vertex_halfedge;
    link_holes(&mut connectivity, &holes)?;
    check_fans(&connectivity)?;
    Ok((connectivity, corner_halfedges))
}

/// Refuses faces of fewer than three corners and faces that visit a vertex twice.
fn check_degrees(faces: &FaceList) -> Result<(), NotManifold> {
    if faces.uniform_degree() == Some(3) {
        let mut triangles = faces.corners().as_chunks::<3>().0.iter();
        let bad = triangles.position(|&[a, b, c]| a == b || b == c || c == a);
        return bad.map_or(Ok(()), |f| Err(NotManifold::DegenerateFace { face: FaceId::new(f) }));
    }
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

/// A side of a face in the bucket of its smaller vertex: its corner, with the direction in the highest
/// bit (0 if the side leads from the smaller to the larger), and the larger vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Side([u32; 2]);

impl Side {
    #[inline]
    fn new(corner: usize, a: VertexId, b: VertexId) -> Self {
        let (smaller, larger) = (a.index().min(b.index()), a.index().max(b.index()));
        Side([u32::from(a.index() != smaller) << 31 | corner as u32, larger as u32])
    }

    /// By the larger vertex, then by direction.
    #[inline]
    fn key(self) -> u64 {
        u64::from(self.0[1]) << 32 | u64::from(self.0[0])
    }

    #[inline]
    pub(crate) fn larger(self) -> usize {
        self.0[1] as usize
    }

    #[inline]
    pub(crate) fn is_forward(self) -> bool {
        self.0[0] >> 31 == 0
    }

    #[inline]
    pub(crate) fn corner(self) -> usize {
        self.0[0] as usize & (FaceList::MAX_CORNERS - 1)
    }
}

impl Ord for Side {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl PartialOrd for Side {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The sides of all faces in sorted buckets by smaller vertex. That of v is `[v]..[v + 1]` of the
/// second list.
pub(crate) fn sorted_sides(vertex_count: usize, faces: &FaceList) -> (Vec<Side>, Vec<u32>) {
    let buckets = Buckets::new(vertex_count, faces);
    let (mut sides, starts, _) = buckets.fill(faces);
    sort_buckets(&mut sides, &starts, 0..vertex_count);
    (sides, starts)
}

/// Where the sides of each vertex to larger ones have their place.
struct Buckets {
    /// The bucket of v is at `[v]..[v + 1]`.
    starts: Vec<u32>,
}

impl Buckets {
    fn new(vertex_count: usize, faces: &FaceList) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        for_each_side(faces, |_, a, b| starts[a.min(b).index() + 1] += 1);
        for v in 1..starts.len() {
            starts[v] += starts[v - 1];
        }
        Buckets { starts }
    }

    /// The sides in their buckets, where these begin, and where the forward sides of each end and the
    /// others begin.
    fn fill(self, faces: &FaceList) -> (Vec<Side>, Vec<u32>, Vec<[u32; 2]>) {
        let Buckets { starts } = self;
        // Each bucket fills from both ends.
        let mut middles: Vec<_> = starts.windows(2).map(|ends| [ends[0], ends[1]]).collect();
        let mut sides = vec![[0_u32; 2]; faces.corners().len()];
        for_each_side(faces, |corner, a, b| {
            let backward = usize::from(a > b);
            let end = &mut middles[a.min(b).index()][backward];
            let place = *end - backward as u32;
            *end = place + 1 - backward as u32;
            sides[place as usize] = Side::new(corner, a, b).0;
        });
        // Zeros come from the system for nothing, sides would be written twice. This stays in place.
        (sides.into_iter().map(Side).collect(), starts, middles)
    }
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
        sort(bucket);
        rest = others;
    }
}

/// Sorts a few sides. Most parts of buckets have up to six, in no order, where branches on comparisons
/// are guesses; these go through networks of minima and maxima instead (Knuth, The Art of Computer
/// Programming 3, section 5.3.4).
#[inline]
fn sort(sides: &mut [Side]) {
    /// Puts the pairs in order, one after the other.
    macro_rules! order {
        ($($a:ident $b:ident),+) => {
            { $((*$a, *$b) = ((*$a).min(*$b), (*$a).max(*$b));)+ }
        };
    }
    match sides {
        [] | [_] => {}
        [a, b] => order!(a b),
        [a, b, c] => order!(a b, b c, a b),
        [a, b, c, d] => order!(a b, c d, a c, b d, b c),
        [a, b, c, d, e] => order!(a d, b e, a c, b d, a b, c e, b c, d e, c d),
        [a, b, c, d, e, f] => {
            order!(a f, b d, c e, b c, d e, a d, c f, a b, c d, e f, b c, d e);
        }
        _ => sides.sort_unstable(),
    }
}

/// The numbered edges, and what is known of them before the faces are linked.
struct Edges {
    to: HalfedgeMap<VertexId>,
    /// The corner each half-edge starts at; one past the last corner where it has no face.
    corner: Vec<u32>,
    corner_halfedges: CornerHalfedges,
    vertex_halfedge: VertexMap<Option<HalfedgeId>>,
    /// The half-edges without a face.
    holes: Vec<HalfedgeId>,
}

impl Edges {
    fn new(vertex_count: usize, faces: &FaceList) -> Result<Self, NotManifold> {
        let buckets = Buckets::new(vertex_count, faces);
        let count = faces.corners().len();
        // The sides come last: what they leave is where the allocator can use it again.
        let mut numbering = Numbering {
            corner_halfedges: vec![0; count],
            none: count as u32,
            // Room for an eighth of the edges on the boundary; a patchwork grows.
            to: Vec::with_capacity(count / 2 + count / 16),
            vertex_halfedge: VertexMap::filled(vertex_count, None),
            holes: Vec::new(),
        };
        let mut bucket = Vec::with_capacity(64);
        let (mut sides, starts, middles) = buckets.fill(faces);
        for (v, (ends, middle)) in starts.windows(2).zip(&middles).enumerate() {
            bucket.clear();
            bucket.extend_from_slice(&sides[ends[0] as usize..ends[1] as usize]);
            let (forward, backward) = bucket.split_at_mut((middle[0] - ends[0]) as usize);
            sort(forward);
            sort(backward);
            let smaller = VertexId::new(v);
            // There are at least as many sides as edges: what is read makes room for what is written.
            if let Err(larger) = numbering.add(smaller, forward, backward, &mut sides) {
                check_degrees(faces)?;
                bucket.sort_unstable();
                let first = bucket.partition_point(|side| side.larger() < larger);
                return Err(obstacle(smaller, &bucket[first..], faces));
            }
        }
        let Numbering { to, corner_halfedges, vertex_halfedge, holes, .. } = numbering;
        sides.truncate(to.len());
        sides.shrink_to_fit();
        let corner: Vec<[u32; 2]> = sides.into_iter().map(|pair| pair.0).collect();
        let (to, corner) = (to.into_flattened().into(), corner.into_flattened());
        Ok(Edges { to, corner, corner_halfedges, vertex_halfedge, holes })
    }
}

/// The edges numbered so far.
struct Numbering {
    none: u32,
    to: Vec<[VertexId; 2]>,
    corner_halfedges: CornerHalfedges,
    vertex_halfedge: VertexMap<Option<HalfedgeId>>,
    holes: Vec<HalfedgeId>,
}

impl Numbering {
    /// Numbers the edges of a vertex to larger ones, given their sorted sides, and writes the corners of
    /// edge e to `corners[e]`. If sides cannot be those of one edge, the error is its larger vertex; that is
    /// the smaller one too where a triangle names a vertex twice.
    #[inline]
    fn add(
        &mut self,
        smaller: VertexId,
        mut forward: &[Side],
        mut backward: &[Side],
        corners: &mut [Side],
    ) -> Result<(), usize> {
        if forward.is_empty() && backward.is_empty() {
            return Ok(());
        }
        let mut previous = None;
        loop {
            let (one, other) = (forward.first(), backward.first());
            let larger = match (one, other) {
                (None, None) => break,
                (Some(side), None) | (None, Some(side)) => side.larger(),
                (Some(one), Some(other)) => one.larger().min(other.larger()),
            };
            if previous == Some(larger) || larger == smaller.index() {
                return Err(larger);
            }
            previous = Some(larger);
            let one = one.filter(|side| side.larger() == larger);
            let other = other.filter(|side| side.larger() == larger);
            forward = &forward[usize::from(one.is_some())..];
            backward = &backward[usize::from(other.is_some())..];
            let ends = [smaller, VertexId::new(larger)];
            let edge = self.to.len();
            corners[edge] = Side(self.push(ends, one.copied(), other.copied()));
        }
        // The last one; each vertex that has a bucket starts with an edge of its own.
        self.vertex_halfedge[smaller] = Some(HalfedgeId::new(2 * (self.to.len() - 1)));
        Ok(())
    }

    /// Numbers the edge with these sides, of which there is at least one, and returns their corners.
    #[inline]
    fn push(
        &mut self,
        [smaller, larger]: [VertexId; 2],
        one: Option<Side>,
        other: Option<Side>,
    ) -> [u32; 2] {
        let halfedge = HalfedgeId::new(2 * self.to.len());
        let mut corner = |h: HalfedgeId, side: Option<Side>| {
            if let Some(side) = side {
                self.corner_halfedges[side.corner()] = h.index() as u32;
                return side.corner() as u32;
            }
            self.holes.push(h);
            self.none
        };
        let corners = [corner(halfedge, one), corner(halfedge.twin(), other)];
        self.to.push([larger, smaller]);
        // Holds only if the bucket of the larger vertex, which comes later, is empty.
        self.vertex_halfedge[larger] = Some(halfedge.twin());
        corners
    }
}

/// Why the first sides of this bucket cannot be the two half-edges of one edge.
fn obstacle(smaller: VertexId, bucket: &[Side], faces: &FaceList) -> NotManifold {
    let vertices = [smaller, VertexId::new(bucket[0].larger())];
    match bucket.iter().take_while(|side| side.larger() == bucket[0].larger()).count() {
        2 => {
            let mut faces = [0, 1].map(|k| faces.corner_face(CornerId::new(bucket[k].corner())));
            faces.sort_unstable();
            NotManifold::Misoriented { vertices, faces }
        }
        count => NotManifold::NonManifoldEdge { vertices, faces: count },
    }
}

/// Prev and face of the half-edges that have a face; itself and none for the others. And a half-edge of
/// each face.
fn link_faces(faces: &FaceList, corner: Vec<u32>, halfedges: &[u32]) -> Connectivity {
    if faces.uniform_degree() == Some(3) {
        return link(
            corner,
            halfedges,
            |c| (c / 3) as usize,
            |c| if c % 3 == 0 { c + 2 } else { c - 1 },
            || halfedges.iter().step_by(3).map(|&h| HalfedgeId::new(h as usize)).collect(),
        );
    }
    let mut corner_faces = Vec::with_capacity(halfedges.len());
    for (f, face) in faces.iter() {
        corner_faces.resize(corner_faces.len() + face.len(), f);
    }
    let start = |f: FaceId| faces.face_start(f).index();
    let face = |c: u32| corner_faces[c as usize];
    link(
        corner,
        halfedges,
        |c| face(c).index(),
        |c| {
            let f = face(c);
            let start = start(f);
            if c as usize == start { (start + faces.degree(f) - 1) as u32 } else { c - 1 }
        },
        || faces.iter().map(|(f, _)| HalfedgeId::new(halfedges[start(f)] as usize)).collect(),
    )
}

/// Each array is written once, in order: pages that are new cost more than what is written on them.
#[inline]
fn link(
    corner: Vec<u32>,
    halfedges: &[u32],
    face: impl Fn(u32) -> usize + Sync,
    preceding: impl Fn(u32) -> u32 + Sync + Send,
    first: impl FnOnce() -> Vec<HalfedgeId>,
) -> Connectivity {
    let none = halfedges.len() as u32;
    let halfedge = |c: u32| HalfedgeId::new(halfedges[c as usize] as usize);
    let prev = parallel::map(corner.len(), |h: HalfedgeId| match corner[h.index()] {
        c if c == none => h,
        c => halfedge(preceding(c)),
    });
    let first = first();
    // Takes the place of the corners.
    let faces: Vec<_> =
        corner.into_iter().map(|c| (c != none).then(|| FaceId::new(face(c)))).collect();
    Connectivity {
        prev,
        face: faces.into(),
        face_halfedge: first.into(),
        ..Connectivity::default()
    }
}

/// Chains the half-edges without a face around each hole, and lets boundary vertices start with them.
fn link_holes(connectivity: &mut Connectivity, holes: &[HalfedgeId]) -> Result<(), NotManifold> {
    let Connectivity { prev, to, face, vertex_halfedge, .. } = connectivity;
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
    let met = parallel::map_blocks(connectivity.vertex_count(), parallel::BLOCK, |block| {
        let starts = connectivity.vertex_halfedge.values()[block].iter().flatten();
        starts.map(|&h| orbit_length(connectivity, h)).sum::<usize>()
    });
    if met.into_iter().sum::<usize>() == connectivity.halfedge_count() {
        return Ok(());
    }
    let mut leaving: VertexMap<usize> = VertexMap::filled(connectivity.vertex_count(), 0);
    for h in connectivity.halfedges() {
        leaving[connectivity.from(h)] += 1;
    }
    let vertex = leaving.iter().find(|&(v, &count)| count != valence(v)).map(|(v, _)| v);
    Err(NotManifold::NonManifoldVertex { vertex: vertex.expect("a vertex has a second fan") })
}

/// How many half-edges leave the vertex that `h` leaves, in the fan of `h`.
#[inline]
fn orbit_length(connectivity: &Connectivity, h: HalfedgeId) -> usize {
    let (mut length, mut g) = (1, connectivity.ccw(h));
    while g != h {
        (length, g) = (length + 1, connectivity.ccw(g));
    }
    length
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
    fn few_sides_are_sorted_in_whichever_order_they_come() {
        // Networks sort everything if they sort all lists of zeros and ones.
        for len in 0..8 {
            for bits in 0..1_u64 << len {
                let mut sides: Vec<Side> =
                    (0..len).map(|i| Side([0, (bits >> i & 1) as u32])).collect();
                sort(&mut sides);
                assert!(sides.is_sorted(), "{len} {bits:b}");
                assert_eq!(
                    sides.iter().map(|side| side.larger()).sum::<usize>(),
                    bits.count_ones() as usize
                );
            }
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
