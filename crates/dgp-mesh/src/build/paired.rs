//! Half-edges from faces whose sides are paired already, as those of a refined mesh are: nothing is matched.
//!
//! - Input: faces, and for each corner the half-edge that starts there; those of edge e are 2e and 2e + 1.
//! - Cost: O(corners), most of it in parallel.
//! - Guarantees: what is not a manifold or not paired is refused.

use super::{
    assemble::{Room, check_degrees, check_fans, heads, link_holes},
    corners::{Corners, Every, Mixed},
};
use crate::{
    Connectivity, CornerId, Error, FaceList, HalfedgeId, NotManifold, VertexId, VertexMap, parallel,
};

/// Joins faces whose vertices are all in range.
pub(crate) fn paired(
    vertex_count: usize,
    faces: &FaceList,
    halfedges: &[u32],
) -> Result<Connectivity, Error> {
    check_degrees(faces)?;
    match faces.uniform_degree() {
        Some(3) => link(vertex_count, faces, halfedges, &Every::<3>),
        Some(4) => link(vertex_count, faces, halfedges, &Every::<4>),
        _ => link(vertex_count, faces, halfedges, &Mixed::new(faces)),
    }
}

#[inline]
fn link(
    vertex_count: usize,
    faces: &FaceList,
    halfedges: &[u32],
    corners: &impl Corners,
) -> Result<Connectivity, Error> {
    let vertices = faces.corners();
    // In place of a corner, of half-edges without a face.
    let none = vertices.len() as u32;
    let unpaired = |corner: usize| Error::Unpaired { corner: CornerId::new(corner) };
    if halfedges.len() != vertices.len() {
        return Err(unpaired(halfedges.len().min(vertices.len())));
    }
    // Each edge has a corner, so there are at most twice as many half-edges.
    let count = halfedges.iter().max().map_or(0, |&last| (last as usize | 1) + 1);
    if count > 2 * halfedges.len() {
        let is_last = |&h: &u32| h as usize | 1 == count - 1;
        return Err(unpaired(halfedges.iter().position(is_last).unwrap_or(0)));
    }
    let mut corner = vec![none; count];
    let mut vertex_halfedge = VertexMap::filled(vertex_count, None);
    for ((&h, &v), c) in halfedges.iter().zip(vertices).zip(0..) {
        if std::mem::replace(&mut corner[h as usize], c) != none {
            return Err(unpaired(c as usize));
        }
        vertex_halfedge[v] = Some(HalfedgeId::new(h as usize));
    }
    if let Some(edge) = corner.as_chunks::<2>().0.iter().position(|pair| *pair == [none; 2]) {
        // Another edge has a number it should not have.
        let is_later = |&h: &u32| h as usize / 2 > edge;
        return Err(unpaired(halfedges.iter().position(is_later).unwrap_or(0)));
    }
    let to = heads(Vec::new(), vertices, &corner, corners);
    let wrong = parallel::map_blocks(count, parallel::BLOCK, |block| {
        block.map(HalfedgeId::new).find(|&h| {
            let other = corner[h.twin().index()];
            other != none && to[h] != vertices[other as usize]
        })
    });
    if let Some(h) = wrong.into_iter().flatten().next() {
        return Err(unpaired(corner[h.twin().index()] as usize));
    }
    let holes: Vec<HalfedgeId> =
        (0..count).filter(|&h| corner[h] == none).map(HalfedgeId::new).collect();
    let mut connectivity =
        Room::new(count, faces.len()).link(faces, corner, halfedges, to, corners);
    connectivity.vertex_halfedge = vertex_halfedge;
    link_holes(&mut connectivity, &holes)?;
    check_fans(&connectivity)?;
    check_neighbors(&connectivity)?;
    Ok(connectivity)
}

/// Refuses two edges between the same vertices.
fn check_neighbors(connectivity: &Connectivity) -> Result<(), NotManifold> {
    let doubled = parallel::map_blocks(connectivity.vertex_count(), parallel::BLOCK, |block| {
        let mut neighbors = Vec::new();
        block.map(VertexId::new).find_map(|v| {
            neighbors.clear();
            neighbors.extend(connectivity.vertex_neighbors(v));
            neighbors.sort_unstable();
            let pair = neighbors.windows(2).find(|pair| pair[0] == pair[1])?;
            let vertices = [v.min(pair[0]), v.max(pair[0])];
            let faces = 2 * neighbors.iter().filter(|&&w| w == pair[0]).count();
            Some(NotManifold::NonManifoldEdge { vertices, faces })
        })
    });
    doubled.into_iter().flatten().next().map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{build::assemble::assemble, shapes};

    #[test]
    fn pairs_that_matching_finds_give_the_same_half_edges() {
        for mesh in [
            shapes::icosahedron(),
            shapes::cube(),
            shapes::quad_grid(3, 2).unwrap(),
            shapes::truncated_icosahedron(),
            shapes::annulus(0.5, 1.0, 7, 2).unwrap(),
        ] {
            let faces = mesh.to_faces();
            let (matched, halfedges) = assemble(mesh.vertex_count(), &faces).unwrap();
            let joined = paired(mesh.vertex_count(), &faces, &halfedges).unwrap();
            // Vertices inside may start anywhere.
            for v in matched.vertices() {
                let (a, b) = (matched.vertex_halfedge(v), joined.vertex_halfedge(v));
                assert!(a == b || !matched.is_boundary_vertex(v), "{v}");
                assert_eq!(b.map(|h| joined.from(h)), Some(v));
            }
            let vertex_halfedge = matched.vertex_halfedge.clone();
            assert_eq!(Connectivity { vertex_halfedge, ..joined }, matched);
        }
    }

    #[test]
    fn pairs_that_do_not_fit_are_refused() {
        let faces = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
        let (_, halfedges) = assemble(4, &faces).unwrap();
        let with = |changes: &[(usize, u32)]| {
            let mut changed = halfedges.clone();
            for &(c, h) in changes {
                changed[c] = h;
            }
            paired(4, &faces, &changed)
        };
        assert!(with(&[]).is_ok());
        // Taken, out of range, an edge left out, sides of other edges.
        for changes in [
            &[(0, halfedges[1])][..],
            &[(0, u32::MAX)],
            &[(0, 11)],
            &[(0, halfedges[1]), (1, halfedges[0])],
        ] {
            let error = with(changes).unwrap_err();
            assert!(matches!(error, Error::Unpaired { .. }), "{changes:?}: {error}");
        }
        assert!(matches!(paired(4, &faces, &halfedges[1..]), Err(Error::Unpaired { .. })));
        // Two triangles back to back whose edges are said to be six.
        let pillow = FaceList::from_indices(&[[0, 1, 2], [2, 1, 0]]);
        assert!(paired(3, &pillow, &[0, 2, 4, 6, 8, 10]).is_err());
    }
}
