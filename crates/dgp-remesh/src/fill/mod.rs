//! Fills holes: with few triangles, with triangles as small as those around, or with a smooth surface.
//!
//! | step | what it does | file |
//! |---|---|---|
//! | cover | the triangulation of the rim whose faces bend least | `minimal.rs`, long rims: `sparse.rs` |
//! | refine | new vertices until edges are as long as around the hole | `refine.rs` |
//! | fair | moves them to the smoothest surface that continues what is around | `fair.rs` |

mod fair;
mod minimal;
mod refine;
mod sparse;

use std::collections::BTreeMap;

use dgp_mesh::{
    DVec3, Editor, FaceSet, HalfedgeId, Mesh, Progress, VertexId,
    topology::{boundary_loops, path_length},
};

use crate::Error;
use minimal::{Rim, Triangulation};

/// What becomes of the rim that is longest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LongestRim {
    /// It is filled like the others.
    #[default]
    Fill,
    /// It is where the surface ends, as of a scan, and stays open.
    Keep,
}

/// How far holes are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Patch {
    /// With triangles between the vertices of the rim.
    Cover,
    /// With triangles about as small as those around the hole.
    Refined,
    /// The same, moved so that the surface is smooth across the rim.
    #[default]
    Fair,
}

/// How [`fill_holes`] works.
#[derive(Clone, Debug, PartialEq)]
pub struct FillOptions {
    /// Holes of more edges stay open.
    pub max_edges: usize,
    /// Whether the surface has an end that is no hole.
    pub longest: LongestRim,
    /// What fills the holes.
    pub patch: Patch,
    /// How much longer than those around the edges of a patch may be: Liepa's √2 by default. Smaller
    /// values make more triangles, larger ones fewer.
    pub density: f64,
}

impl Default for FillOptions {
    fn default() -> Self {
        FillOptions {
            max_edges: usize::MAX,
            longest: LongestRim::default(),
            patch: Patch::default(),
            density: std::f64::consts::SQRT_2,
        }
    }
}

/// What became of a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoleOutcome {
    /// It is filled.
    Filled,
    /// It has more edges than [`FillOptions::max_edges`].
    TooManyEdges,
    /// It is the longest, which stays.
    Kept,
    /// Every triangulation of the rim has an edge that is there already.
    NoTriangulation,
}

/// A hole, and what fills it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// A half-edge of its rim, in the mesh as it was.
    pub halfedge: HalfedgeId,
    /// Edges of the rim.
    pub edges: usize,
    /// The length of the rim, in the unit of the coordinates.
    pub length: f64,
    /// What became of it.
    pub outcome: HoleOutcome,
    /// The largest angle between neighbors of the cover, those outside the rim among them, in radians.
    pub largest_bend: f64,
    /// The area of the cover.
    pub area: f64,
    /// Faces and vertices that are new.
    pub faces: usize,
    /// See `faces`.
    pub vertices: usize,
}

/// What [`fill_holes`] did.
#[derive(Clone, Debug, Default, PartialEq)]
#[must_use]
pub struct FillReport {
    /// All holes there were, in the order of their half-edges.
    pub holes: Vec<Hole>,
    /// The faces that are new.
    pub faces: FaceSet,
}

impl FillReport {
    /// How many holes came to this end.
    pub fn count(&self, outcome: HoleOutcome) -> usize {
        self.holes.iter().filter(|hole| hole.outcome == outcome).count()
    }
}

/// Fills the holes of a mesh. Vertices, edges and faces that were there keep their ids.
///
/// New faces continue the data around them. What `progress` cancels leaves the holes filled so far.
///
/// Errors: [`Error::NotFinite`], [`Error::InvalidOption`], [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{Editor, FaceId, Progress, measure::volume, shapes, topology::boundary_loops};
/// use dgp_remesh::{FillOptions, Patch, fill_holes};
///
/// let mut mesh = shapes::cube();
/// let mut editor = Editor::new(&mut mesh);
/// editor.remove_face(FaceId::new(0))?;
/// let _ = editor.finish();
/// let options = FillOptions { patch: Patch::Cover, ..FillOptions::default() };
/// let report = fill_holes(&mut mesh, &options, Progress::NONE)?;
/// assert_eq!((report.holes.len(), report.holes[0].faces), (1, 2));
/// assert!(boundary_loops(&mesh).is_empty() && (volume(&mesh) - volume(&shapes::cube())).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Reference: Liepa, "Filling holes in meshes", 2003.
pub fn fill_holes(
    mesh: &mut Mesh,
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<FillReport, Error> {
    if !(options.density > 0.0) {
        let (name, value) = ("density", options.density);
        return Err(Error::InvalidOption { name, value, expected: "larger than zero" });
    }
    if let Some(vertex) = mesh.vertices().find(|&v| !mesh.position(v).is_finite()) {
        return Err(Error::NotFinite { vertex });
    }
    let rims = boundary_loops(mesh);
    let lengths: Vec<f64> = rims.iter().map(|rim| path_length(mesh, rim)).collect();
    let longest =
        (0..rims.len()).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j]).then(j.cmp(&i)));
    let total: usize = rims.iter().map(|rim| rim.len().pow(2)).sum();
    let mut done = 0;
    let mut report = FillReport::default();
    let mut editor = Editor::new(mesh);
    for (k, rim) in rims.iter().enumerate() {
        let mut hole = new_hole(rim, lengths[k]);
        let next = done + rim.len().pow(2);
        let part = progress.part(done as f64 / total as f64, next as f64 / total as f64);
        done = next;
        if options.longest == LongestRim::Keep && longest == Some(k) {
            hole.outcome = HoleOutcome::Kept;
        } else if rim.len() > options.max_edges {
            hole.outcome = HoleOutcome::TooManyEdges;
        } else {
            fill(&mut editor, rim, options, &mut hole, &mut report.faces, part)?;
        }
        report.holes.push(hole);
    }
    let _ = editor.finish();
    progress.report(1.0)?;
    Ok(report)
}

/// A hole of which nothing is known but its rim.
pub(crate) fn new_hole(rim: &[HalfedgeId], length: f64) -> Hole {
    Hole {
        halfedge: rim[0],
        edges: rim.len(),
        length,
        outcome: HoleOutcome::Filled,
        largest_bend: 0.0,
        area: 0.0,
        faces: 0,
        vertices: 0,
    }
}

/// Fills one hole.
pub(crate) fn fill(
    editor: &mut Editor<'_>,
    rim: &[HalfedgeId],
    options: &FillOptions,
    hole: &mut Hole,
    faces: &mut FaceSet,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let Some(cover) = cover(editor.mesh(), rim, progress.part(0.0, 0.8))? else {
        hole.outcome = HoleOutcome::NoTriangulation;
        return Ok(());
    };
    hole.largest_bend = cover.angle;
    hole.area = cover.area;
    let scales = refine::scales(editor.mesh(), rim);
    let mut patch = insert(editor, rim, &cover);
    let mut vertices = Vec::new();
    if options.patch != Patch::Cover {
        vertices =
            refine::refine(editor, &mut patch, scales, options.density, progress.part(0.8, 0.9))?;
    }
    if options.patch == Patch::Fair && !vertices.is_empty() {
        fair::fair(editor, &vertices, progress.part(0.9, 1.0))?;
    }
    hole.faces = patch.len();
    hole.vertices = vertices.len();
    faces.extend(patch.iter());
    Ok(())
}

/// The triangles to put into a hole.
fn cover(
    mesh: &Mesh,
    rim: &[HalfedgeId],
    progress: Progress<'_>,
) -> Result<Option<Triangulation>, Error> {
    let corners: Vec<VertexId> = rim.iter().map(|&h| mesh.from(h)).collect();
    let points: Vec<DVec3> = corners.iter().map(|&v| mesh.position(v)).collect();
    let normal = |h: &HalfedgeId| mesh.face(h.twin()).map_or(DVec3::ZERO, |f| mesh.face_normal(f));
    let normals: Vec<DVec3> = rim.iter().map(normal).collect();
    let mut places: Vec<(VertexId, u32)> =
        corners.iter().enumerate().map(|(i, &v)| (v, i as u32)).collect();
    places.sort_unstable();
    let joined: Vec<Vec<u32>> = corners
        .iter()
        .map(|&v| {
            let place = |w| places.binary_search_by_key(&w, |place| place.0).ok();
            let near = mesh.vertex_neighbors(v).filter_map(place).map(|k| places[k].1);
            let mut near: Vec<u32> = near.collect();
            near.sort_unstable();
            near
        })
        .collect();
    Rim { points: &points, normals: &normals, joined: &joined }.triangulate(progress)
}

/// Puts triangles into a hole: one face, which is cut along their sides.
fn insert(editor: &mut Editor<'_>, rim: &[HalfedgeId], cover: &Triangulation) -> FaceSet {
    let corners: Vec<VertexId> = rim.iter().map(|&h| editor.mesh().from(h)).collect();
    let mut patch = FaceSet::new();
    patch.insert(editor.add_face(&corners).expect("the sides of a hole are free"));
    // The corner opposite to each side, which runs counterclockwise.
    let opposite: BTreeMap<(u32, u32), u32> = cover
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [((a, b), c), ((b, c), a), ((c, a), b)])
        .collect();
    // Parts of the rim from a to c, each with the half-edge that closes it.
    let last = rim.len() - 1;
    let mut parts = vec![(0, last as u32, rim[last])];
    while let Some((a, c, close)) = parts.pop() {
        let b = opposite[&(c, a)];
        if b - a > 1 {
            parts.push((a, b, cut(editor, &mut patch, rim[a as usize], rim[b as usize])));
        }
        if c - b > 1 {
            parts.push((b, c, cut(editor, &mut patch, rim[b as usize], close)));
        }
    }
    patch
}

/// Cuts a face between the starts of two of its sides, and returns the new half-edge back to that of the
/// first.
fn cut(editor: &mut Editor<'_>, patch: &mut FaceSet, h: HalfedgeId, g: HalfedgeId) -> HalfedgeId {
    let chord = editor.split_face_by(h, g).expect("corners of the face that no edge joins");
    let mesh = editor.mesh();
    let sides = chord.halfedges();
    patch.extend(sides.into_iter().filter_map(|side| mesh.face(side)));
    if mesh.to(sides[0]) == mesh.from(h) { sides[0] } else { sides[1] }
}
