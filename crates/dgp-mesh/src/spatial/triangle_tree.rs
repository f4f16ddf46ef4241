//! The hierarchy over the triangles of a surface.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use super::{
    build::{Item, build},
    frame::Frame,
    nodes::Nodes,
};
use crate::{
    Error, FaceId, Progress, TriangulationMethod, VertexId,
    measure::{BoundingBox, Surface},
    parallel, triangulate_polygon,
};

/// The triangles of a surface, ordered so that those near a place are found fast.
///
/// It holds a copy of the positions and does not follow changes of the surface. Polygons are cut into
/// triangles as [`triangulate_faces`](crate::triangulate_faces) cuts them; results name the face.
/// Triangles without area count with the points they have.
///
/// ```
/// use dgp_mesh::{DVec3, Progress, shapes::icosphere, spatial::TriangleTree};
///
/// let tree = TriangleTree::new(&icosphere(4)?, Progress::NONE)?;
/// let hit = tree.closest_point(DVec3::new(0.0, 0.0, 3.0)).expect("there are triangles");
/// assert!((hit.distance - 2.0).abs() < 0.01);
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct TriangleTree {
    pub(super) nodes: Nodes,
    /// Corners in the units of the frame, in order of the leaves; so are the others.
    pub(super) triangles: Vec<[DVec3; 3]>,
    pub(super) vertices: Vec<[VertexId; 3]>,
    pub(super) faces: Vec<FaceId>,
    pub(super) bounds: Option<BoundingBox>,
}

impl TriangleTree {
    /// The tree of all faces of `surface`, a mesh or a face set of any kind.
    ///
    /// Faces of fewer than three corners are left out. O(n log n) time, about 130 bytes a triangle.
    /// Errors: [`Error::NonFinite`] if a vertex of a face is not finite; cancelled before the build.
    pub fn new(surface: &impl Surface, progress: Progress<'_>) -> Result<Self, Error> {
        progress.report(0.0)?;
        let (list, sources) = triangles_of(surface);
        let positions = surface.vertex_positions().values();
        let bounds = bounds_of(positions, &list)?;
        let frame = Frame::of(bounds);
        progress.report(0.1)?;
        let mut items =
            gather(list.len(), |i| item(&frame, i, list[i as usize].map(|v| positions[v.index()])));
        progress.report(0.2)?;
        let nodes = build(&mut items);
        progress.report(0.8)?;
        let leaves = |i: u32| items[i as usize].id as usize;
        let vertices = gather(items.len(), |i| list[leaves(i)]);
        let triangles = gather(items.len(), |i| {
            vertices[i as usize].map(|v| frame.scaled(positions[v.index()]))
        });
        let faces = gather(items.len(), |i| match &sources {
            Some(sources) => sources[leaves(i)],
            None => FaceId::new(leaves(i)),
        });
        progress.report(1.0)?;
        Ok(TriangleTree { nodes: Nodes { nodes, frame }, triangles, vertices, faces, bounds })
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are no triangles: then nothing is found.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The box around all triangles; `None` if there are none.
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        self.bounds
    }
}

/// The values of `f` at `0..len`, in parallel.
fn gather<T: Send>(len: usize, f: impl Fn(u32) -> T + Sync + Send) -> Vec<T> {
    parallel::map(len, |v: VertexId| f(v.index() as u32)).into_values()
}

/// The box of a triangle around the middle of the frame.
#[inline]
fn item(frame: &Frame, id: u32, corners: [DVec3; 3]) -> Item {
    let [a, b, c] = corners.map(|p| frame.scaled(p));
    let (lo, _) = frame.rounded(a.min(b).min(c));
    let (_, hi) = frame.rounded(a.max(b).max(c));
    Item { lo: [lo[0], lo[1], lo[2], 0.0], hi: [hi[0], hi[1], hi[2], 0.0], id }
}

/// The triangles of all faces, and the face of each unless triangle i is face i.
fn triangles_of(surface: &impl Surface) -> (Vec<[VertexId; 3]>, Option<Vec<FaceId>>) {
    let has_polygons = AtomicBool::new(false);
    let list = gather(surface.number_of_faces(), |f| {
        surface.corners_of_triangle(FaceId::new(f as usize)).unwrap_or_else(|| {
            has_polygons.store(true, Ordering::Relaxed);
            [VertexId::new(0); 3]
        })
    });
    if !has_polygons.into_inner() {
        return (list, None);
    }
    let positions = surface.vertex_positions();
    let (mut list, mut sources) = (Vec::new(), Vec::new());
    let (mut polygon, mut points) = (Vec::new(), Vec::new());
    for f in (0..surface.number_of_faces()).map(FaceId::new) {
        polygon.clear();
        polygon.extend(surface.polygon(f));
        points.clear();
        points.extend(polygon.iter().map(|&v| positions[v]));
        for corners in triangulate_polygon(&points, TriangulationMethod::Ears) {
            list.push(corners.map(|k| polygon[k]));
            sources.push(f);
        }
    }
    (list, Some(sources))
}

/// The box of the corners of `list`, all of which must be finite.
fn bounds_of(positions: &[DVec3], list: &[[VertexId; 3]]) -> Result<Option<BoundingBox>, Error> {
    let blocks = parallel::map_blocks(list.len(), parallel::BLOCK, |range| {
        let corners = list[range].as_flattened();
        let mut bounds = BoundingBox::of_point(positions[corners[0].index()]);
        for &vertex in corners {
            let p = positions[vertex.index()];
            if !p.is_finite() {
                return Err(Error::NonFinite { vertex });
            }
            bounds = bounds.union(&BoundingBox::of_point(p));
        }
        Ok(bounds)
    });
    let mut all: Option<BoundingBox> = None;
    for block in blocks.into_iter().filter(|_| !list.is_empty()) {
        let block = block?;
        all = Some(all.map_or(block, |all| all.union(&block)));
    }
    Ok(all)
}
