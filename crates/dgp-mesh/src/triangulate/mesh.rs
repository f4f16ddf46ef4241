//! All faces of a mesh cut into triangles.

use std::collections::HashSet;

use glam::DVec3;

use super::{TriangulationMethod, diagonals, triangulate_avoiding};
use crate::{Error, FaceId, FaceMap, HalfedgeId, MAX_ELEMENTS, Mesh, Progress, VertexId, parallel};

/// How many faces are cut between two reports.
const FACES_PER_REPORT: usize = 1 << 18;

/// Cuts all faces of `mesh` into triangles and tells which face each comes from.
///
/// Vertices, half-edges, edges keep their numbers, and faces that of their first triangle; new edges
/// and faces follow at the end. Data of corners and faces travel; new edges have default values. Where
/// a diagonal joins two vertices that have an edge already, another one is taken: the result is a
/// manifold as before.
///
/// Errors: [`Error::NoTriangulation`] if all ways to cut a face use such diagonals; [`Error::TooMany`];
/// [`Error::Cancelled`]. The mesh is then as it was.
pub fn triangulate(
    mesh: &mut Mesh,
    method: TriangulationMethod,
    progress: Progress<'_>,
) -> Result<FaceMap<FaceId>, Error> {
    let mut cuts = cut_faces(mesh, method, progress.part(0.0, 0.7))?;
    avoid_double_edges(mesh, method, &mut cuts, progress.part(0.7, 0.8))?;
    check_size(mesh, &cuts)?;
    progress.report(0.8)?;
    Ok(apply(mesh, &cuts))
}

/// A face and its triangles, as numbers of its corners, counted from its first half-edge.
struct Cut {
    face: FaceId,
    triangles: Vec<[usize; 3]>,
}

/// The triangles of each face that is not one, as if it were alone.
fn cut_faces(
    mesh: &Mesh,
    method: TriangulationMethod,
    progress: Progress<'_>,
) -> Result<Vec<Cut>, Error> {
    let polygons: Vec<FaceId> = mesh.faces().filter(|&f| mesh.triangle(f).is_none()).collect();
    let mut cuts = Vec::with_capacity(polygons.len());
    for batch in polygons.chunks(FACES_PER_REPORT) {
        progress.report(cuts.len() as f64 / polygons.len() as f64)?;
        let parts = parallel::map_blocks(batch.len(), parallel::BLOCK, |range| {
            let faces = batch[range].iter();
            let cut =
                |&face| Cut { face, triangles: cut_face(mesh, face, method, &|_, _| false).1 };
            faces.map(cut).collect::<Vec<_>>()
        });
        cuts.extend(parts.into_iter().flatten());
    }
    Ok(cuts)
}

/// The triangles of a face without the diagonals that are taken, and whether that could be done.
fn cut_face(
    mesh: &Mesh,
    face: FaceId,
    method: TriangulationMethod,
    is_taken: &dyn Fn(usize, usize) -> bool,
) -> (bool, Vec<[usize; 3]>) {
    let corners: Vec<DVec3> = mesh.face_vertices(face).map(|v| mesh.position(v)).collect();
    let mut triangles = Vec::with_capacity(corners.len() - 2);
    let is_done = triangulate_avoiding(&corners, method, is_taken, &mut triangles);
    (is_done, triangles)
}

/// Cuts faces another way whose diagonals join vertices that other edges or diagonals join.
fn avoid_double_edges(
    mesh: &Mesh,
    method: TriangulationMethod,
    cuts: &mut [Cut],
    progress: Progress<'_>,
) -> Result<(), Error> {
    if !has_double_edges(mesh, cuts) {
        return Ok(());
    }
    // Asked only whether it contains a pair, so its order cannot matter.
    let mut taken: HashSet<[VertexId; 2]> = HashSet::new();
    let count = cuts.len();
    for (i, cut) in cuts.iter_mut().enumerate() {
        if i % FACES_PER_REPORT == 0 {
            progress.report(i as f64 / count as f64)?;
        }
        let vertices: Vec<VertexId> = mesh.face_vertices(cut.face).collect();
        let n = vertices.len();
        let is_taken = |a: usize, b: usize| {
            let (v, w) = (vertices[a], vertices[b]);
            mesh.halfedge_between(v, w).is_some() || taken.contains(&key(v, w))
        };
        if diagonals(&cut.triangles, n).any(|[a, b]| is_taken(a, b)) {
            let (is_done, triangles) = cut_face(mesh, cut.face, method, &is_taken);
            if !is_done {
                return Err(Error::NoTriangulation { face: cut.face });
            }
            cut.triangles = triangles;
        }
        taken.extend(diagonals(&cut.triangles, n).map(|[a, b]| key(vertices[a], vertices[b])));
    }
    Ok(())
}

/// The same for both directions.
fn key(v: VertexId, w: VertexId) -> [VertexId; 2] {
    [v.min(w), v.max(w)]
}

/// Whether two diagonals, or a diagonal and an edge, join the same vertices.
fn has_double_edges(mesh: &Mesh, cuts: &[Cut]) -> bool {
    let blocks = parallel::map_blocks(cuts.len(), parallel::BLOCK, |range| {
        let mut keys = Vec::with_capacity(range.len());
        let mut meets_edge = false;
        let mut vertices: Vec<VertexId> = Vec::new();
        for cut in &cuts[range] {
            vertices.clear();
            vertices.extend(mesh.face_vertices(cut.face));
            // Each diagonal once: its second triangle names it the other way around.
            let once = diagonals(&cut.triangles, vertices.len()).filter(|[a, b]| a < b);
            for [a, b] in once {
                let (v, w) = (vertices[a], vertices[b]);
                meets_edge |= mesh.halfedge_between(v, w).is_some();
                keys.push(key(v, w));
            }
        }
        (keys, meets_edge)
    });
    if blocks.iter().any(|&(_, meets_edge)| meets_edge) {
        return true;
    }
    let mut keys: Vec<_> = blocks.into_iter().flat_map(|(keys, _)| keys).collect();
    keys.sort_unstable();
    keys.windows(2).any(|pair| pair[0] == pair[1])
}

fn check_size(mesh: &Mesh, cuts: &[Cut]) -> Result<(), Error> {
    let new: usize = cuts.iter().map(|cut| cut.triangles.len() - 1).sum();
    let count = mesh.halfedge_count() + 2 * new;
    if count > MAX_ELEMENTS {
        return Err(Error::TooMany { kind: "half-edges", count, limit: MAX_ELEMENTS });
    }
    Ok(())
}

/// Puts the diagonals and triangles into the mesh.
fn apply(mesh: &mut Mesh, cuts: &[Cut]) -> FaceMap<FaceId> {
    let new: usize = cuts.iter().map(|cut| cut.triangles.len() - 1).sum();
    let (faces, halfedges) = (mesh.face_count(), mesh.halfedge_count());
    let mut sources: FaceMap<FaceId> = FaceMap::from_fn(faces, |f| f);
    // The half-edge whose corner a new half-edge shares.
    let mut corner_of: Vec<HalfedgeId> = Vec::with_capacity(2 * new);
    let mut sides: Vec<HalfedgeId> = Vec::new();
    let mut open: Vec<([usize; 2], HalfedgeId)> = Vec::new();
    let connectivity = &mut mesh.connectivity;
    for cut in cuts {
        sides.clear();
        sides.extend(connectivity.face_halfedges(cut.face));
        open.clear();
        let n = sides.len();
        for (t, &[a, b, c]) in cut.triangles.iter().enumerate() {
            let face = if t == 0 { cut.face } else { sources.push(cut.face) };
            let triangle = [[a, b], [b, c], [c, a]].map(|[p, q]| {
                if (p + 1) % n == q {
                    return sides[p];
                }
                // The second triangle at a diagonal takes the twin of what the first one made.
                if let Some(at) = open.iter().position(|&(ends, _)| ends == [p, q]) {
                    return open.swap_remove(at).1;
                }
                let h = HalfedgeId::new(connectivity.to.len());
                let ends = [p, q].map(|corner| sides[corner]);
                let [from, to] = ends.map(|h| connectivity.to[h.twin()]);
                for vertex in [to, from] {
                    // Links and face follow with the triangles on either side.
                    connectivity.to.push(vertex);
                    connectivity.prev.push(h);
                    connectivity.face.push(None);
                }
                corner_of.extend(ends);
                open.push(([q, p], h.twin()));
                h
            });
            for k in 0..3 {
                let (h, following) = (triangle[k], triangle[(k + 1) % 3]);
                connectivity.prev[following] = h;
                connectivity.face[h] = Some(face);
            }
            if t == 0 {
                connectivity.face_halfedge[face] = triangle[0];
            } else {
                connectivity.face_halfedge.push(triangle[0]);
            }
        }
    }
    let attributes = &mut mesh.attributes;
    attributes.edge.resize(halfedges / 2 + new);
    let source = |h: HalfedgeId| match h.index().checked_sub(halfedges) {
        None => Some(h),
        Some(i) => Some(corner_of[i]),
    };
    attributes.corner = attributes.corner.gather(halfedges + 2 * new, source);
    attributes.face = attributes.face.gather(sources.len(), |f: FaceId| Some(sources[f]));
    sources
}
