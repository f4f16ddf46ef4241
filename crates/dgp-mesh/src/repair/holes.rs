//! Filling holes with triangles between the vertices of their rims.

use std::collections::BTreeSet;

use glam::DVec3;

use super::{RepairAction, draft::Draft, separate::face_normal, triangulate::triangulate};
use crate::{
    Elements, Error, FaceId, Groups, Progress, VertexId, VertexMap,
    check::{adjacency::Adjacency, following},
};

/// Fills the holes of up to `longest` edges, where that keeps the manifold.
pub(super) fn fill(draft: &mut Draft, longest: usize, progress: Progress<'_>) -> Result<(), Error> {
    let adjacency = draft.take_adjacency();
    let rims = rims(&adjacency, longest);
    let neighbors = rim_neighbors(&adjacency, &rims);
    let (mut filled, mut left) = (Groups::new(), Groups::new());
    let mut triangles = Vec::new();
    for (k, rim) in rims.iter().enumerate() {
        progress.report(k as f64 / rims.len() as f64)?;
        let found = patch(&adjacency, &draft.positions, rim, &neighbors);
        let vertices = rim.iter().map(|&side| draft.input_vertex(adjacency.to(side)));
        match found {
            Some(patch) => {
                filled.push(vertices);
                triangles.extend(patch.into_iter().map(|triangle| triangle.map(|i| rim[i])));
            }
            None => left.push(vertices),
        }
    }
    draft.record(RepairAction::FillHoles, Elements::Loops(filled));
    draft.record(RepairAction::LeaveHoles, Elements::Loops(left));
    if triangles.is_empty() {
        draft.put_adjacency(adjacency);
        return Ok(());
    }
    draft.filled_from = Some(draft.faces.len());
    for triangle in triangles {
        // Data come from the faces along the rim: corners from those that start there.
        draft.faces_mut().push(&triangle.map(|side| adjacency.to(side)));
        for side in triangle {
            draft.corner_sources.push(draft.corner_sources[adjacency.next(side)]);
        }
        let face = adjacency.face(triangle[0]);
        draft.face_sources.push(draft.face_sources[face.index()]);
    }
    Ok(())
}

/// The holes, each as the open sides around it; that at place k leads from vertex k + 1 of the hole,
/// seen from within, to vertex k.
fn rims(adjacency: &Adjacency, longest: usize) -> Vec<Vec<usize>> {
    let mut seen = vec![false; adjacency.side_count()];
    let mut rims = Vec::new();
    for start in 0..adjacency.side_count() {
        if !adjacency.is_open(start) || seen[start] {
            continue;
        }
        let mut rim = Vec::new();
        let mut side = start;
        while !seen[side] {
            seen[side] = true;
            rim.push(side);
            let next = following(adjacency, side, adjacency.from(side));
            side = next.expect("every rim of a manifold is closed");
        }
        let one_face = rim.iter().all(|&side| adjacency.face(side) == adjacency.face(start));
        if rim.len() <= longest && !one_face {
            rims.push(rim);
        }
    }
    rims
}

/// For each vertex on one of the rims the neighbors it has.
fn rim_neighbors(adjacency: &Adjacency, rims: &[Vec<usize>]) -> VertexMap<Vec<VertexId>> {
    let mut neighbors = VertexMap::filled(adjacency.vertex_count, Vec::new());
    let mut on_rim = VertexMap::filled(adjacency.vertex_count, false);
    for &side in rims.iter().flatten() {
        on_rim[adjacency.to(side)] = true;
    }
    for side in 0..adjacency.side_count() {
        let (a, b) = (adjacency.from(side), adjacency.to(side));
        if on_rim[a] && on_rim[b] {
            neighbors[a].push(b);
            neighbors[b].push(a);
        }
    }
    neighbors
}

/// Triangles between the vertices of a rim, by their places on it; `None` if there are none that use
/// no edge again.
fn patch(
    adjacency: &Adjacency,
    positions: &VertexMap<DVec3>,
    rim: &[usize],
    neighbors: &VertexMap<Vec<VertexId>>,
) -> Option<Vec<[usize; 3]>> {
    let vertices: Vec<VertexId> = rim.iter().map(|&side| adjacency.to(side)).collect();
    let mut places: Vec<(VertexId, usize)> =
        vertices.iter().enumerate().map(|(i, &v)| (v, i)).collect();
    places.sort_unstable();
    let mut joined = BTreeSet::new();
    for (i, &v) in vertices.iter().enumerate() {
        for &w in &neighbors[v] {
            if let Ok(found) = places.binary_search_by_key(&w, |place| place.0) {
                let j = places[found].1;
                joined.insert((i.min(j), i.max(j)));
            }
        }
    }
    // Of size one around the origin, so that products neither overflow nor vanish.
    let points: Vec<DVec3> = vertices.iter().map(|&v| positions[v]).collect();
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (min, max) = points.iter().fold(start, |(min, max), &p| (min.min(p), max.max(p)));
    let size = (max - min).max_element();
    let points: Vec<DVec3> = points.iter().map(|&p| (p - min) / size).collect();
    let outside = |&side: &usize| -> Option<DVec3> {
        let f: FaceId = adjacency.face(side);
        face_normal(adjacency, positions, f)
    };
    triangulate(&points, &rim.iter().map(outside).collect::<Vec<_>>(), &joined)
}
