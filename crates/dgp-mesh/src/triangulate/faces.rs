//! All faces of a face set cut into triangles.

use glam::DVec3;

use super::{TriangulationMethod, triangulate_polygon};
use crate::{
    CornerId, Error, FaceId, FaceList, FaceMap, IndexedFaceSet, Progress, VertexId, parallel,
};

/// How many faces are cut between two reports.
const FACES_PER_REPORT: usize = 1 << 18;

/// The triangles of `set`, and the face each comes from.
///
/// Triangles keep the order of the faces, vertices their numbers; data of corners and faces travel.
/// Faces of fewer than three corners vanish, and of the triangles of larger faces those that name a
/// vertex twice. Faces that are triangles already stay as they are.
///
/// Each face is cut for itself. A manifold may so come to have two faces with the same diagonal;
/// [`triangulate`](super::triangulate) avoids that.
pub fn triangulate_faces(
    set: &IndexedFaceSet,
    method: TriangulationMethod,
    progress: Progress<'_>,
) -> Result<(IndexedFaceSet, FaceMap<FaceId>), Error> {
    let faces = set.faces();
    let mut corners: Vec<CornerId> = Vec::with_capacity(3 * faces.len());
    let mut sources: Vec<FaceId> = Vec::with_capacity(faces.len());
    for start in (0..faces.len()).step_by(FACES_PER_REPORT) {
        progress.report(start as f64 / faces.len() as f64)?;
        let count = FACES_PER_REPORT.min(faces.len() - start);
        let parts = parallel::map_blocks(count, parallel::BLOCK, |range| {
            let mut part =
                (Vec::with_capacity(6 * range.len()), Vec::with_capacity(2 * range.len()));
            let mut polygon = Vec::new();
            for f in range.map(|i| FaceId::new(start + i)) {
                cut(set, f, method, &mut polygon, &mut part);
            }
            part
        });
        for (part_corners, part_sources) in parts {
            corners.extend(part_corners);
            sources.extend(part_sources);
        }
    }
    let vertices: Vec<VertexId> = corners.iter().map(|&c| faces.vertex(c)).collect();
    let list = FaceList::from_corners(vertices, 3);
    let mut new = IndexedFaceSet::new(set.positions().clone(), list)?;
    new.vertex_attributes = set.vertex_attributes.clone();
    new.corner_attributes =
        set.corner_attributes.gather(corners.len(), |c: CornerId| corners.get(c.index()).copied());
    new.face_attributes =
        set.face_attributes.gather(sources.len(), |f: FaceId| sources.get(f.index()).copied());
    Ok((new, sources.into()))
}

/// Adds the corners of the triangles of face `f`, and `f` for each.
fn cut(
    set: &IndexedFaceSet,
    f: FaceId,
    method: TriangulationMethod,
    polygon: &mut Vec<DVec3>,
    (corners, sources): &mut (Vec<CornerId>, Vec<FaceId>),
) {
    let vertices = set.faces().face(f);
    let first = set.faces().face_corners(f).next().map_or(0, CornerId::index);
    if vertices.len() == 3 {
        corners.extend(set.faces().face_corners(f));
        sources.push(f);
        return;
    }
    polygon.clear();
    polygon.extend(vertices.iter().map(|&v| set.position(v)));
    for triangle in triangulate_polygon(polygon, method) {
        let [a, b, c] = triangle.map(|k| vertices[k]);
        if a != b && b != c && c != a {
            corners.extend(triangle.map(|k| CornerId::new(first + k)));
            sources.push(f);
        }
    }
}
