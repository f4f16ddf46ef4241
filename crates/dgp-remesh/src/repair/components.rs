//! Dropping components that are too small to be meant: by faces, area or volume.
//!
//! - Input: a mesh of any polygons.
//! - Cost: O(F).
//! - Guarantees: the component with most faces stays. Data and order of what stays are kept.
//! - Reference: none.

use dgp_mesh::{DVec3, Editor, FaceId, FaceSet, Mesh, Progress, topology::components};

use super::{geometry, track::Track};
use crate::Error;

/// What a component must have to stay. Zero asks for nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeastComponent {
    /// At least so many faces.
    pub faces: usize,
    /// At least this fraction of the area of all.
    pub area: f64,
    /// If it is closed, at least this fraction of the volume of the largest, whichever way it is turned.
    pub volume: f64,
}

/// Drops the components of `mesh` that are smaller than `least`, and returns their faces, in order of the
/// components.
///
/// Errors: [`Error::InvalidOption`], [`Error::NotFinite`], [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Mesh, Progress};
/// use dgp_remesh::{LeastComponent, drop_small_components};
///
/// let points = [[0, 0], [4, 0], [0, 4], [9, 9], [10, 9], [9, 10]];
/// let points = points.map(|[x, y]| DVec3::new(f64::from(x), f64::from(y), 0.0)).to_vec();
/// let faces = FaceList::from_indices(&[[3, 4, 5], [0, 1, 2]]);
/// let mut mesh = Mesh::new(&IndexedFaceSet::new(points, faces)?)?;
/// let least = LeastComponent { area: 0.1, ..LeastComponent::default() };
/// let dropped = drop_small_components(&mut mesh, &least, Progress::NONE)?;
/// assert_eq!((dropped.len(), mesh.vertex_count()), (1, 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drop_small_components(
    mesh: &mut Mesh,
    least: &LeastComponent,
    progress: Progress<'_>,
) -> Result<Vec<Vec<FaceId>>, Error> {
    let mut track = Track::of(mesh);
    drop_small(mesh, least, &mut track, progress)
}

pub(super) fn drop_small(
    mesh: &mut Mesh,
    least: &LeastComponent,
    track: &mut Track,
    progress: Progress<'_>,
) -> Result<Vec<Vec<FaceId>>, Error> {
    for (name, value) in [("area", least.area), ("volume", least.volume)] {
        if !(0.0..=1.0).contains(&value) {
            return Err(Error::InvalidOption { name, value, expected: "a fraction from 0 to 1" });
        }
    }
    geometry::need_finite(mesh)?;
    progress.report(0.0)?;
    if *least == LeastComponent::default() {
        return Ok(Vec::new());
    }
    let scale = geometry::diagonal(mesh);
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let parts = components(mesh).faces();
    let sizes: Vec<Size> = parts.iter().map(|part| Size::of(mesh, part, scale)).collect();
    progress.report(0.7)?;
    let total: f64 = sizes.iter().map(|size| size.area).sum();
    let largest = sizes.iter().filter_map(|size| size.volume).fold(0.0, f64::max);
    let kept = (0..parts.len()).max_by_key(|&k| (parts[k].len(), std::cmp::Reverse(k)));
    let is_small = |k: usize| {
        parts[k].len() < least.faces
            || sizes[k].area < least.area * total
            || sizes[k].volume.is_some_and(|volume| volume < least.volume * largest)
    };
    let small: Vec<usize> = (0..parts.len()).filter(|&k| Some(k) != kept && is_small(k)).collect();
    let small: Vec<Vec<FaceId>> = small.into_iter().map(|k| parts[k].clone()).collect();
    take_out(mesh, &small, track)?;
    progress.report(1.0)?;
    Ok(small)
}

/// Drops the components of which no face has an area; how many those are.
pub(super) fn drop_flat(mesh: &mut Mesh, track: &mut Track) -> Result<usize, Error> {
    let is_flat = |&f: &FaceId| {
        mesh.triangle(f).is_some_and(|t| geometry::breadth(&t.map(|v| mesh.position(v))) == 0.0)
    };
    if !mesh.faces().any(|f| is_flat(&f)) {
        return Ok(0);
    }
    let mut flat = components(mesh).faces();
    flat.retain(|part| part.iter().all(is_flat));
    take_out(mesh, &flat, track)?;
    Ok(flat.len())
}

fn take_out(mesh: &mut Mesh, parts: &[Vec<FaceId>], track: &mut Track) -> Result<(), Error> {
    let faces: FaceSet = parts.iter().flatten().copied().collect();
    if faces.is_empty() {
        return Ok(());
    }
    let mut editor = Editor::new(mesh);
    let removal = editor.remove_faces(&faces).map_err(Error::Edit)?;
    for v in removal.isolated {
        let _ = editor.remove_vertex(v).map_err(Error::Edit)?;
    }
    track.compacted(&editor.finish(), &[]);
    Ok(())
}

/// How large a component is, relative to the diagonal of all.
struct Size {
    area: f64,
    /// Without sign; `None` if it is open.
    volume: Option<f64>,
}

impl Size {
    fn of(mesh: &Mesh, part: &[FaceId], scale: f64) -> Self {
        let (mut area, mut volume, mut is_closed) = (0.0, 0.0, true);
        let center = part.first().map_or(DVec3::ZERO, |&f| mesh.face_center(f));
        for &f in part {
            let first = mesh.position(mesh.from(mesh.face_halfedge(f)));
            let mut sum = DVec3::ZERO;
            for h in mesh.face_halfedges(f) {
                is_closed &= mesh.face(h.twin()).is_some();
                let (a, b) = (mesh.position(mesh.from(h)), mesh.position(mesh.to(h)));
                sum += ((a - first) / scale).cross((b - first) / scale);
            }
            area += 0.5 * sum.length();
            volume += sum.dot((first - center) / scale) / 6.0;
        }
        Size { area, volume: is_closed.then_some(volume.abs()) }
    }
}
