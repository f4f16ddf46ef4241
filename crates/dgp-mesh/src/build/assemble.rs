//! Half-edges from indexed faces, in linear time.
//!
//! Each corner of a face starts a directed side a → b. Sides are put into buckets by their smaller
//! vertex (a counting sort), those that lead to the larger vertex first. Both parts of each small bucket
//! are sorted by the larger vertex, and side by side they give the two sides of each edge. No hashing;
//! arrays are written in order and read where faces that are close in the list are close on the surface.
//! Each thread has the sides of its own vertices, which it picks from all faces.

use std::ops::Range;

use super::{
    corners::{Corners, Every, Mixed},
    sides::{Side, fill, for_each_side, middles, sort, starts},
};
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
    let mut vertex_halfedge = VertexMap::filled(vertex_count, None);
    let (corner, holes) = number_edges(faces, &mut vertex_halfedge, parallel::halvings())?;
    let (mut connectivity, corner_halfedges) = link_faces(faces, corner);
    connectivity.vertex_halfedge = vertex_halfedge;
    link_holes(&mut connectivity, &holes)?;
    check_fans(&connectivity)?;
    Ok((connectivity, corner_halfedges))
}

/// Refuses faces of fewer than three corners and faces that visit a vertex twice.
pub(super) fn check_degrees(faces: &FaceList) -> Result<(), NotManifold> {
    if faces.uniform_degree() == Some(3) {
        let mut triangles = faces.corners().as_chunks::<3>().0.iter();
        let bad = triangles.position(|&[a, b, c]| a == b || b == c || c == a);
        return bad.map_or(Ok(()), |f| Err(NotManifold::DegenerateFace { face: FaceId::new(f) }));
    }
    let worst = parallel::map_blocks(faces.len(), parallel::BLOCK, |block| {
        let mut sorted = Vec::new();
        block.map(FaceId::new).find(|&f| match *faces.face(f) {
            [a, b, c] => a == b || b == c || c == a,
            [a, b, c, d] => a == b || a == c || a == d || b == c || b == d || c == d,
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

/// Numbers the edges by their smaller vertex, then by their larger one. Returns the corners where the two
/// half-edges of each edge start, and the half-edges without a face, whose corner is one past the last.
/// Each vertex that has faces gets a half-edge that leaves it.
fn number_edges(
    faces: &FaceList,
    vertex_halfedge: &mut VertexMap<Option<HalfedgeId>>,
    halvings: u32,
) -> Result<(Vec<u32>, Vec<HalfedgeId>), NotManifold> {
    // All that is large is made here: what a thread frees stays with that thread.
    let starts = starts(vertex_halfedge.len(), faces);
    let mut middles = middles(&starts);
    let mut sides = vec![[0; 2]; faces.corners().len()];
    let part = Part {
        vertices: 0..vertex_halfedge.len(),
        middles: &mut middles,
        halfedges: vertex_halfedge.values_mut(),
        sides: &mut sides,
    };
    match part.number(faces, &starts, halvings) {
        Ok(Edges { count, holes, peaks }) => {
            for (v, h) in peaks {
                vertex_halfedge[v] = Some(h);
            }
            sides.truncate(count);
            sides.shrink_to_fit();
            Ok((sides.into_flattened(), holes))
        }
        Err([smaller, larger]) => {
            check_degrees(faces)?;
            Err(obstacle(smaller, larger, faces))
        }
    }
}

/// Vertices and what is known of them.
struct Part<'a> {
    vertices: Range<usize>,
    /// Where the buckets begin and end.
    middles: &'a mut [[u32; 2]],
    /// A half-edge that leaves each, to be found.
    halfedges: &'a mut [Option<HalfedgeId>],
    /// Room for the sides to larger vertices. In the end, the corners where the half-edges of each edge start.
    sides: &'a mut [[u32; 2]],
}

/// The edges of some vertices to larger ones, numbered from 0.
struct Edges {
    count: usize,
    /// The half-edges without a face.
    holes: Vec<HalfedgeId>,
    /// Vertices that have edges only to smaller ones, and a half-edge that leaves them; the last counts.
    peaks: Vec<(VertexId, HalfedgeId)>,
}

impl Part<'_> {
    /// Numbers the edges. If sides cannot be those of one edge, the error is the first such edge; both ends
    /// are the same where a triangle names a vertex twice.
    fn number(
        mut self,
        faces: &FaceList,
        starts: &[u32],
        halvings: u32,
    ) -> Result<Edges, [VertexId; 2]> {
        if halvings > 0 && self.sides.len() > parallel::BLOCK {
            let (low, high) = self.halves(starts);
            let (middle, vertex) = (low.sides.len(), low.halfedges.len());
            let (edges, later) = parallel::join(
                || low.number(faces, starts, halvings - 1),
                || high.number(faces, starts, halvings - 1),
            );
            let (edges, later) = (edges?, later?);
            self.sides.copy_within(middle..middle + later.count, edges.count);
            return Ok(edges.followed_by(later, &mut self.halfedges[vertex..]));
        }
        let Part { vertices, middles, halfedges, sides } = self;
        fill(faces, starts, middles, vertices.clone(), sides);
        let first = starts[vertices.start];
        let mut numbering = Numbering {
            starts,
            none: faces.corners().len() as u32,
            corners: sides,
            edges: Edges { count: 0, holes: Vec::new(), peaks: Vec::new() },
        };
        let mut bucket = Vec::with_capacity(64);
        for ((v, h), middle) in vertices.zip(halfedges).zip(middles) {
            let range = (starts[v] - first) as usize..(starts[v + 1] - first) as usize;
            if range.is_empty() {
                continue;
            }
            bucket.clear();
            bucket.extend(numbering.corners[range].iter().map(|&side| Side(side)));
            let (forward, backward) = bucket.split_at_mut((middle[0] - starts[v]) as usize);
            sort(forward);
            sort(backward);
            numbering.add(VertexId::new(v), forward, backward)?;
            // The last one; each vertex that has a bucket starts with an edge of its own.
            *h = Some(HalfedgeId::new(2 * (numbering.edges.count - 1)));
        }
        Ok(numbering.edges)
    }

    /// Two parts with about as many sides.
    fn halves(&mut self, starts: &[u32]) -> (Part<'_>, Part<'_>) {
        let Part { vertices, middles, halfedges, sides } = self;
        let first = starts[vertices.start];
        let half = first + sides.len() as u32 / 2;
        let count = starts[vertices.clone()].partition_point(|&start| start < half);
        let middle = vertices.start + count;
        let (middles, other_middles) = middles.split_at_mut(count);
        let (halfedges, other_halfedges) = halfedges.split_at_mut(count);
        let (sides, other_sides) = sides.split_at_mut((starts[middle] - first) as usize);
        (
            Part { vertices: vertices.start..middle, middles, halfedges, sides },
            Part {
                vertices: middle..vertices.end,
                middles: other_middles,
                halfedges: other_halfedges,
                sides: other_sides,
            },
        )
    }
}

impl Edges {
    /// Appends the edges of the next vertices, to which these half-edges belong.
    fn followed_by(mut self, later: Edges, halfedges: &mut [Option<HalfedgeId>]) -> Self {
        let count = 2 * self.count;
        let moved = |h: HalfedgeId| HalfedgeId::new(h.index() + count);
        self.count += later.count;
        self.holes.extend(later.holes.into_iter().map(moved));
        self.peaks.extend(later.peaks.into_iter().map(|(v, h)| (v, moved(h))));
        for h in halfedges.iter_mut().flatten() {
            *h = moved(*h);
        }
        self
    }
}

/// Edges while they are numbered.
struct Numbering<'a> {
    starts: &'a [u32],
    none: u32,
    /// The corners of the edges numbered so far, and the sides of those to come: there are at least as many
    /// sides as edges, so what is read makes room for what is written.
    corners: &'a mut [[u32; 2]],
    edges: Edges,
}

impl Numbering<'_> {
    /// Numbers the edges of a vertex to larger ones, given their sorted sides.
    #[inline]
    fn add(
        &mut self,
        smaller: VertexId,
        mut forward: &[Side],
        mut backward: &[Side],
    ) -> Result<(), [VertexId; 2]> {
        let mut previous = None;
        loop {
            let (one, other) = (forward.first(), backward.first());
            let larger = match (one, other) {
                (None, None) => return Ok(()),
                (Some(side), None) | (None, Some(side)) => side.larger(),
                (Some(one), Some(other)) => one.larger().min(other.larger()),
            };
            if previous == Some(larger) || larger == smaller.index() {
                return Err([smaller, VertexId::new(larger)]);
            }
            previous = Some(larger);
            let one = one.filter(|side| side.larger() == larger);
            let other = other.filter(|side| side.larger() == larger);
            forward = &forward[usize::from(one.is_some())..];
            backward = &backward[usize::from(other.is_some())..];
            self.push(larger, [one, other]);
        }
    }

    /// Numbers the edge with these sides, of which there is at least one.
    #[inline]
    fn push(&mut self, larger: usize, sides: [Option<&Side>; 2]) {
        let halfedge = HalfedgeId::new(2 * self.edges.count);
        let mut corner = |h: HalfedgeId, side: Option<&Side>| {
            if let Some(side) = side {
                return side.corner() as u32;
            }
            self.edges.holes.push(h);
            self.none
        };
        let corners = [corner(halfedge, sides[0]), corner(halfedge.twin(), sides[1])];
        if self.starts[larger] == self.starts[larger + 1] {
            self.edges.peaks.push((VertexId::new(larger), halfedge.twin()));
        }
        self.corners[self.edges.count] = corners;
        self.edges.count += 1;
    }
}

/// Why the sides between these vertices cannot be the two half-edges of one edge.
fn obstacle(smaller: VertexId, larger: VertexId, faces: &FaceList) -> NotManifold {
    let mut sides = Vec::new();
    for_each_side(faces, |corner, a, b| {
        if (a.min(b), a.max(b)) == (smaller, larger) {
            sides.push(CornerId::new(corner));
        }
    });
    let vertices = [smaller, larger];
    match sides[..] {
        [one, other] => {
            let mut faces = [one, other].map(|corner| faces.corner_face(corner));
            faces.sort_unstable();
            NotManifold::Misoriented { vertices, faces }
        }
        _ => NotManifold::NonManifoldEdge { vertices, faces: sides.len() },
    }
}

/// Links the half-edges that start at these corners, and says which starts at each corner. Those without a
/// face precede themselves for now.
fn link_faces(faces: &FaceList, corner: Vec<u32>) -> (Connectivity, CornerHalfedges) {
    match faces.uniform_degree() {
        Some(3) => link(faces, corner, &Every::<3>),
        Some(4) => link(faces, corner, &Every::<4>),
        _ => link(faces, corner, &Mixed::new(faces)),
    }
}

#[inline]
fn link(
    faces: &FaceList,
    corner: Vec<u32>,
    corners: &impl Corners,
) -> (Connectivity, CornerHalfedges) {
    let vertices = faces.corners();
    let none = vertices.len() as u32;
    let room = Room::new(corner.len(), faces.len());
    let to = Vec::with_capacity(corner.len());
    let mut halfedges = vec![0; vertices.len()];
    let ((), to) = parallel::join(
        || {
            for (h, &c) in corner.iter().enumerate() {
                if c != none {
                    halfedges[c as usize] = h as u32;
                }
            }
        },
        || heads(to, vertices, &corner, corners),
    );
    (room.link(faces, corner, &halfedges, to, corners), halfedges)
}

/// The vertex that each half-edge leads to, given the corners where they start.
#[inline]
pub(super) fn heads(
    room: Vec<VertexId>,
    vertices: &[VertexId],
    corner: &[u32],
    corners: &impl Corners,
) -> HalfedgeMap<VertexId> {
    let none = vertices.len() as u32;
    parallel::map_in(room, corner.len(), |h: HalfedgeId| match corner[h.index()] {
        // Where the other side starts.
        c if c == none => vertices[corner[h.twin().index()] as usize],
        c => vertices[corners.following(c) as usize],
    })
}

/// Memory for what stays, made before what is freed, which is then given back.
pub(super) struct Room {
    prev: Vec<HalfedgeId>,
    face_halfedge: Vec<HalfedgeId>,
}

impl Room {
    pub(super) fn new(halfedges: usize, faces: usize) -> Self {
        let (prev, face_halfedge) = (Vec::with_capacity(halfedges), Vec::with_capacity(faces));
        Room { prev, face_halfedge }
    }

    /// All but what starts at each vertex. `corner` says where half-edges start, one past the last corner if
    /// nowhere, and `halfedges` which starts at each corner. Each array is written once, in order: pages that
    /// are new cost more than what is written on them.
    #[inline]
    pub(super) fn link(
        self,
        faces: &FaceList,
        corner: Vec<u32>,
        halfedges: &[u32],
        to: HalfedgeMap<VertexId>,
        corners: &impl Corners,
    ) -> Connectivity {
        let none = halfedges.len() as u32;
        let halfedge = |c: u32| HalfedgeId::new(halfedges[c as usize] as usize);
        let prev =
            parallel::map_in(self.prev, corner.len(), |h: HalfedgeId| match corner[h.index()] {
                c if c == none => h,
                c => halfedge(corners.preceding(c)),
            });
        let face_halfedge = parallel::map_in(self.face_halfedge, faces.len(), |f: FaceId| {
            halfedge(faces.face_start(f).index() as u32)
        });
        // Takes the place of the corners.
        let face: Vec<_> =
            corner.into_iter().map(|c| (c != none).then(|| corners.face(c))).collect();
        Connectivity { prev, to, face: face.into(), face_halfedge, ..Connectivity::default() }
    }
}

/// Chains the half-edges without a face around each hole, and lets boundary vertices start with them.
pub(super) fn link_holes(
    connectivity: &mut Connectivity,
    holes: &[HalfedgeId],
) -> Result<(), NotManifold> {
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
pub(super) fn check_fans(connectivity: &Connectivity) -> Result<(), NotManifold> {
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
    fn edges_are_the_same_in_one_part_and_in_many() {
        let sphere = crate::shapes::icosphere(4).unwrap().to_indexed();
        let holed = crate::shapes::with_holes(&crate::shapes::icosphere(4).unwrap(), 5, 2, 1);
        let holed = holed.unwrap().to_indexed();
        let three = FaceList::from_indices(&vec![[0, 1, 2]; 3 * parallel::BLOCK]);
        for set in [&sphere, &holed, &crate::shapes::shuffled(&holed, 2)] {
            let numbered = |halvings| {
                let mut leaving = VertexMap::filled(set.vertex_count(), None);
                let edges = number_edges(set.faces(), &mut leaving, halvings).unwrap();
                (edges, leaving)
            };
            let whole = numbered(0);
            for halvings in 1..5 {
                assert!(numbered(halvings) == whole, "{halvings}");
            }
        }
        let refused =
            |halvings| number_edges(&three, &mut VertexMap::filled(3, None), halvings).unwrap_err();
        assert_eq!(refused(0), refused(2));
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
