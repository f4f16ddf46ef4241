//! Half-edges from indexed faces, in linear time.
//!
//! Each corner of a face starts a directed side a → b. Sides are put into buckets by their smaller
//! vertex (a counting sort), each small bucket is sorted by the larger vertex, and then the two sides
//! of an edge are neighbors. No hashing, and memory is touched in order wherever faces that are close
//! in the list are close on the surface.

use crate::{
    Connectivity, FaceId, FaceList, FaceMap, HalfedgeId, HalfedgeMap, Id, NotManifold, VertexId,
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
    let sides = Sides::sorted(vertex_count, faces);
    let (mut connectivity, corner_halfedges) = sides.pair(vertex_count, faces)?;
    link_faces(&mut connectivity, faces, &corner_halfedges);
    link_holes(&mut connectivity)?;
    check_fans(&connectivity)?;
    Ok((connectivity, corner_halfedges))
}

/// Refuses faces of fewer than three corners and faces that visit a vertex twice.
fn check_degrees(faces: &FaceList) -> Result<(), NotManifold> {
    let mut sorted = Vec::new();
    for (face, vertices) in faces.iter() {
        let degenerate = match *vertices {
            [a, b, c] => a == b || b == c || c == a,
            [] | [_] | [_, _] => true,
            _ => {
                sorted.clear();
                sorted.extend_from_slice(vertices);
                sorted.sort_unstable();
                sorted.windows(2).any(|pair| pair[0] == pair[1])
            }
        };
        if degenerate {
            return Err(NotManifold::DegenerateFace { face });
        }
    }
    Ok(())
}

/// The sides of all faces in buckets by smaller vertex, each bucket sorted by larger vertex.
struct Sides {
    /// Larger vertex in the upper, corner in the lower half.
    sides: Vec<u64>,
    /// The bucket of vertex v is `[v]..[v + 1]`.
    starts: Vec<u32>,
}

impl Sides {
    fn sorted(vertex_count: usize, faces: &FaceList) -> Self {
        let mut starts = vec![0_u32; vertex_count + 2];
        for_each_side(faces, |_, a, b| starts[a.min(b).index() + 2] += 1);
        for v in 2..starts.len() {
            starts[v] += starts[v - 1];
        }
        // starts[v + 1] is now where bucket v begins, and moves to its end as it fills.
        let mut sides = vec![0_u64; faces.corners().len()];
        for_each_side(faces, |corner, a, b| {
            let place = &mut starts[a.min(b).index() + 1];
            sides[*place as usize] = (a.max(b).index() as u64) << 32 | corner as u64;
            *place += 1;
        });
        for v in 0..vertex_count {
            sort_small(&mut sides[starts[v] as usize..starts[v + 1] as usize]);
        }
        Sides { sides, starts }
    }

    /// Numbers the edges and tells which half-edge each corner starts.
    fn pair(
        &self,
        vertex_count: usize,
        faces: &FaceList,
    ) -> Result<(Connectivity, CornerHalfedges), NotManifold> {
        let corners = faces.corners();
        let mut corner_halfedges = vec![HalfedgeId::new(0); corners.len()];
        let mut to = Vec::with_capacity(corners.len() + corners.len() / 8);
        for v in 0..vertex_count {
            let smaller = VertexId::new(v);
            let bucket = &self.sides[self.starts[v] as usize..self.starts[v + 1] as usize];
            let mut rest = bucket;
            while let Some(&first) = rest.first() {
                let larger = VertexId::new((first >> 32) as usize);
                let count = rest.iter().take_while(|&side| side >> 32 == first >> 32).count();
                if count > 2 {
                    let vertices = [smaller, larger];
                    return Err(NotManifold::NonManifoldEdge { vertices, faces: count });
                }
                let halfedge = HalfedgeId::new(to.len());
                let mut forward_seen = None;
                for &side in &rest[..count] {
                    let corner = side as u32 as usize;
                    let forward = corners[corner] == smaller;
                    if forward_seen == Some(forward) {
                        let sharing = [rest[0], rest[1]].map(|s| face_of(faces, s as u32 as usize));
                        let vertices = [smaller, larger];
                        return Err(NotManifold::Misoriented { vertices, faces: sharing });
                    }
                    forward_seen = Some(forward);
                    corner_halfedges[corner] = if forward { halfedge } else { halfedge.twin() };
                }
                to.extend([larger, smaller]);
                rest = &rest[count..];
            }
        }
        let halfedges = to.len();
        let connectivity = Connectivity {
            next: HalfedgeMap::filled(halfedges, HalfedgeId::new(0)),
            prev: HalfedgeMap::filled(halfedges, HalfedgeId::new(0)),
            to: to.into(),
            face: HalfedgeMap::filled(halfedges, None),
            vertex_halfedge: VertexMap::filled(vertex_count, None),
            face_halfedge: FaceMap::filled(faces.len(), HalfedgeId::new(0)),
        };
        Ok((connectivity, corner_halfedges))
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
        for (k, &a) in face.iter().enumerate() {
            f(corner, a, face[(k + 1) % face.len()]);
            corner += 1;
        }
    }
}

/// Sorts a bucket: by insertion up to the valences of real meshes, beyond that in n log n.
fn sort_small(bucket: &mut [u64]) {
    const INSERTION_LIMIT: usize = 24;
    if bucket.len() > INSERTION_LIMIT {
        bucket.sort_unstable();
        return;
    }
    for i in 1..bucket.len() {
        let side = bucket[i];
        let mut j = i;
        while j > 0 && bucket[j - 1] > side {
            bucket[j] = bucket[j - 1];
            j -= 1;
        }
        bucket[j] = side;
    }
}

/// The face with this corner; linear, for messages only.
fn face_of(faces: &FaceList, corner: usize) -> FaceId {
    let mut end = 0;
    let found = faces.iter().find(|(_, face)| {
        end += face.len();
        corner < end
    });
    found.map_or(FaceId::new(0), |(f, _)| f)
}

/// Sets next, prev and face of the half-edges that have a face, and a half-edge for each face and
/// vertex.
fn link_faces(connectivity: &mut Connectivity, faces: &FaceList, corner_halfedges: &[HalfedgeId]) {
    let Connectivity { next, prev, face, vertex_halfedge, face_halfedge, .. } = connectivity;
    let mut rest = corner_halfedges;
    for (f, vertices) in faces.iter() {
        let (sides, others) = rest.split_at(vertices.len());
        rest = others;
        face_halfedge[f] = sides[0];
        let mut last = sides[sides.len() - 1];
        for (&h, &v) in sides.iter().zip(vertices) {
            next[last] = h;
            prev[h] = last;
            face[h] = Some(f);
            vertex_halfedge[v] = Some(h);
            last = h;
        }
    }
}

/// Chains the half-edges without a face around each hole, and lets boundary vertices start with them.
fn link_holes(connectivity: &mut Connectivity) -> Result<(), NotManifold> {
    let holes: Vec<HalfedgeId> =
        connectivity.face.iter().filter(|(_, face)| face.is_none()).map(|(h, _)| h).collect();
    let Connectivity { next, prev, to, face, vertex_halfedge, .. } = connectivity;
    for &h in &holes {
        let vertex = to[h.twin()];
        match vertex_halfedge[vertex] {
            Some(first) if face[first].is_none() => {
                return Err(NotManifold::NonManifoldVertex { vertex });
            }
            _ => vertex_halfedge[vertex] = Some(h),
        }
    }
    for &h in &holes {
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
    Err(NotManifold::NonManifoldVertex { vertex: vertex.unwrap_or(VertexId::from_index(0)) })
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
