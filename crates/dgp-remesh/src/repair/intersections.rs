//! Cutting out where a surface passes through itself, and closing the holes.
//!
//! ```text
//! repeat, with one ring of faces more around what still meets each time:
//!   1. the faces that meet, and the rings around them, go
//!   2. of what falls apart, crumbs go, and what lies within the solid
//!   3. the holes are filled
//! until nothing meets, or the limits are reached
//! ```
//!
//! - Input: a mesh of any polygons, open or closed.
//! - Cost: a tree and its self-intersections for each round; filling as `fill_holes`.
//! - Guarantees: the result is a manifold. Rims that were there stay. What still meets is told.
//! - Reference: Attene, "A lightweight approach to repairing digitized polygon meshes", The Visual Computer
//!   26, 2010; Jacobson, Kavan and Sorkine-Hornung, "Robust inside-outside segmentation using generalized
//!   winding numbers", 2013, for what lies within.
//! - Departs from it: all components stay but what lies within others, not the largest only; the number of
//!   faces that may go is bounded.

use dgp_mesh::{
    Editor, FaceId, FaceSet, HalfedgeId, HalfedgeSet, Mesh, Progress, VertexSet,
    spatial::TriangleTree, topology::boundary_loops,
};

use super::{geometry, track::Track};
use crate::{
    Error, FillOptions, Hole, HoleOutcome, Patch,
    fill::{fill, new_hole},
};

/// So many faces of a piece are asked whether it lies within the solid.
const ASKED: usize = 5;

/// How [`remove_self_intersections`] works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntersectionOptions {
    /// After so many rounds what still meets is left.
    pub max_rounds: usize,
    /// No more than this fraction of the faces there were at the start goes in all.
    pub max_removed: f64,
    /// What fills the holes.
    pub patch: Patch,
}

impl Default for IntersectionOptions {
    fn default() -> Self {
        IntersectionOptions { max_rounds: 10, max_removed: 0.3, patch: Patch::Cover }
    }
}

/// What [`remove_self_intersections`] did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[must_use]
pub struct IntersectionReport {
    /// The pairs of faces that met at the start, by their ids then.
    pub found: Vec<[FaceId; 2]>,
    /// Rounds of cutting and filling.
    pub rounds: usize,
    /// Faces that went, and those of patches that went again.
    pub removed: usize,
    /// Faces that fill holes.
    pub added: usize,
    /// Holes that were filled.
    pub filled: usize,
    /// Pieces that were dropped as crumbs or as within the solid.
    pub pieces: usize,
    /// Cuts that stay open: at a rim that was there, or with no triangulation.
    pub open: usize,
    /// The pairs that still meet, by their ids now.
    pub left: Vec<[FaceId; 2]>,
}

/// Removes faces that pass through each other, and fills the holes.
///
/// Errors: [`Error::InvalidOption`], [`Error::NotFinite`], [`Error::Cancelled`], which leaves the mesh as
/// it was.
///
/// ```
/// use dgp_mesh::{DVec3, Progress, VertexId, shapes, topology::boundary_loops};
/// use dgp_remesh::{IntersectionOptions, remove_self_intersections};
///
/// // A vertex of a sphere pulled out through the other side.
/// let mut mesh = shapes::icosphere(3)?;
/// let v = VertexId::new(0);
/// mesh.set_position(v, -1.5 * mesh.position(v));
/// let options = IntersectionOptions::default();
/// let report = remove_self_intersections(&mut mesh, &options, Progress::NONE)?;
/// assert!(!report.found.is_empty() && report.left.is_empty());
/// assert!(boundary_loops(&mesh).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn remove_self_intersections(
    mesh: &mut Mesh,
    options: &IntersectionOptions,
    progress: Progress<'_>,
) -> Result<IntersectionReport, Error> {
    let mut track = Track::of(mesh);
    remove(mesh, options, &mut track, progress)
}

pub(super) fn remove(
    mesh: &mut Mesh,
    options: &IntersectionOptions,
    track: &mut Track,
    progress: Progress<'_>,
) -> Result<IntersectionReport, Error> {
    let (name, value) = ("max_removed", options.max_removed);
    if !(0.0..=1.0).contains(&value) {
        return Err(Error::InvalidOption { name, value, expected: "a fraction from 0 to 1" });
    }
    geometry::need_finite(mesh)?;
    let most = (options.max_removed * mesh.face_count() as f64) as usize;
    let mut report = IntersectionReport::default();
    let mut changed: Option<(Mesh, Track)> = None;
    let mut unfilled: Vec<HalfedgeId> = Vec::new();
    loop {
        // Half of what is left: most are done after a round or two.
        let start = 1.0 - 0.5_f64.powi(report.rounds as i32);
        let part = progress.part(start, 0.5 * (1.0 + start));
        let now = changed.as_ref().map_or(&*mesh, |(mesh, _)| mesh);
        let tree = TriangleTree::new(now, part.part(0.0, 0.2))?;
        let pairs = tree.self_intersections(part.part(0.2, 0.4))?;
        if report.rounds == 0 {
            report.found.clone_from(&pairs);
        }
        let is_done = pairs.is_empty() && unfilled.is_empty();
        let cut = if is_done || report.rounds == options.max_rounds {
            None
        } else {
            let cut = Cut::new(now, &tree, &pairs, &unfilled, report.rounds);
            Some(cut).filter(|cut| report.removed + cut.faces.len() <= most)
        };
        let Some(cut) = cut else {
            report.left = pairs;
            report.open += unfilled.len();
            break;
        };
        let (mut mesh, mut track) = changed.take().unwrap_or_else(|| (mesh.clone(), track.clone()));
        unfilled =
            cut.carry_out(&mut mesh, &mut track, options, &mut report, part.part(0.4, 1.0))?;
        report.rounds += 1;
        changed = Some((mesh, track));
    }
    if let Some((new, maps)) = changed {
        (*mesh, *track) = (new, maps);
    }
    progress.report(1.0)?;
    Ok(report)
}

/// The faces that go in one round.
struct Cut {
    faces: FaceSet,
    pieces: usize,
}

impl Cut {
    fn new(
        mesh: &Mesh,
        tree: &TriangleTree,
        pairs: &[[FaceId; 2]],
        unfilled: &[HalfedgeId],
        rings: usize,
    ) -> Self {
        let mut faces: FaceSet = pairs.iter().flatten().copied().collect();
        grow(mesh, &mut faces, rings);
        // A hole without a triangulation has another one when it is larger.
        let rims = unfilled.iter().flat_map(|&h| mesh.loop_halfedges(h));
        let at_rims: FaceSet = rims.flat_map(|h| mesh.vertex_faces(mesh.from(h))).collect();
        faces.extend(at_rims.iter());
        let mut cut = Cut { faces, pieces: 0 };
        cut.add_pieces(mesh, tree);
        cut
    }

    /// Adds the pieces, of what falls apart without the faces, that are not worth keeping.
    fn add_pieces(&mut self, mesh: &Mesh, tree: &TriangleTree) {
        let is_closed = mesh.edges().all(|e| !mesh.is_boundary_edge(e));
        let mut seen = self.faces.clone();
        let mut dropped = Vec::new();
        // Pieces are walked from the faces around the cut only.
        let around: Vec<FaceId> = self.faces.iter().flat_map(|f| neighbors(mesh, f)).collect();
        let mut pieces: Vec<Vec<FaceId>> = Vec::new();
        for f in around {
            if seen.insert(f) {
                pieces.push(connected(mesh, f, &mut seen));
            }
        }
        let largest = pieces.iter().map(Vec::len).max().unwrap_or(0);
        for piece in pieces {
            let is_within = is_closed && piece.len() < largest && lies_within(mesh, tree, &piece);
            if is_within || (piece.len() < largest && self.is_crumb(mesh, &piece)) {
                self.pieces += 1;
                dropped.extend(piece);
            }
        }
        self.faces.extend(dropped);
    }

    /// Whether more faces go around a piece than it has.
    fn is_crumb(&self, mesh: &Mesh, piece: &[FaceId]) -> bool {
        let around: FaceSet = piece
            .iter()
            .flat_map(|&f| neighbors(mesh, f))
            .filter(|&g| self.faces.contains(g))
            .collect();
        piece.len() < around.len()
    }

    /// Removes the faces and fills the holes; returns those that have no triangulation, by a half-edge.
    fn carry_out(
        &self,
        mesh: &mut Mesh,
        track: &mut Track,
        options: &IntersectionOptions,
        report: &mut IntersectionReport,
        progress: Progress<'_>,
    ) -> Result<Vec<HalfedgeId>, Error> {
        progress.report(0.0)?;
        let old: HalfedgeSet = mesh.halfedges().filter(|&h| mesh.face(h).is_none()).collect();
        let sides: Vec<HalfedgeId> =
            self.faces.iter().flat_map(|f| mesh.face_halfedges(f).collect::<Vec<_>>()).collect();
        let mut editor = Editor::new(mesh);
        let removal = editor.remove_faces(&self.faces).map_err(Error::Edit)?;
        for v in removal.isolated {
            let _ = editor.remove_vertex(v).map_err(Error::Edit)?;
        }
        let compaction = editor.finish();
        track.compacted(&compaction, &[]);
        let fresh: HalfedgeSet = sides.into_iter().filter_map(|h| compaction.halfedge(h)).collect();
        let old: HalfedgeSet = old.iter().filter_map(|h| compaction.halfedge(h)).collect();
        report.removed += self.faces.len();
        report.pieces += self.pieces;

        // What was no rim, or one that could not be filled, is to be closed.
        let is_new = |rim: &Vec<HalfedgeId>| {
            rim.iter().any(|&h| fresh.contains(h)) && !rim.iter().any(|&h| old.contains(h))
        };
        let all = boundary_loops(mesh);
        let touched = |rim: &&Vec<HalfedgeId>| rim.iter().any(|&h| fresh.contains(h));
        let rims: Vec<Vec<HalfedgeId>> = all.iter().filter(|rim| is_new(rim)).cloned().collect();
        report.open += all.iter().filter(touched).count() - rims.len();
        close(mesh, track, &rims, options, report, progress)
    }
}

/// Fills these holes; returns those that have no triangulation.
fn close(
    mesh: &mut Mesh,
    track: &mut Track,
    rims: &[Vec<HalfedgeId>],
    options: &IntersectionOptions,
    report: &mut IntersectionReport,
    progress: Progress<'_>,
) -> Result<Vec<HalfedgeId>, Error> {
    let fill_options = FillOptions { patch: options.patch, ..FillOptions::default() };
    let mut editor = Editor::new(mesh);
    let mut unfilled = Vec::new();
    for (k, rim) in rims.iter().enumerate() {
        let part = |k: usize| k as f64 / rims.len() as f64;
        let mut hole: Hole = new_hole(rim, 0.0);
        let mut faces = FaceSet::new();
        let progress = progress.part(part(k), part(k + 1));
        fill(&mut editor, rim, &fill_options, &mut hole, &mut faces, progress)?;
        if hole.outcome == HoleOutcome::Filled {
            report.filled += 1;
            report.added += hole.faces;
        } else {
            unfilled.push(rim[0]);
        }
    }
    track.compacted(&editor.finish(), &[]);
    Ok(unfilled)
}

/// The faces that share a vertex with `f`.
fn neighbors(mesh: &Mesh, f: FaceId) -> Vec<FaceId> {
    mesh.face_vertices(f).flat_map(|v| mesh.vertex_faces(v)).collect()
}

/// Adds so many rings of faces that share vertices.
fn grow(mesh: &Mesh, faces: &mut FaceSet, rings: usize) {
    let mut front: Vec<FaceId> = faces.iter().collect();
    let mut met = VertexSet::new();
    for _ in 0..rings {
        let mut next = Vec::new();
        for f in front {
            for v in mesh.face_vertices(f) {
                if met.insert(v) {
                    next.extend(mesh.vertex_faces(v).filter(|&g| faces.insert(g)));
                }
            }
        }
        front = next;
    }
}

/// The faces that hang together with `f` by edges and are not `seen`, in order.
fn connected(mesh: &Mesh, f: FaceId, seen: &mut FaceSet) -> Vec<FaceId> {
    let mut piece = vec![f];
    let mut next = 0;
    while let Some(&f) = piece.get(next) {
        next += 1;
        piece.extend(mesh.face_neighbors(f).filter(|&g| seen.insert(g)));
    }
    piece.sort_unstable();
    piece
}

/// Whether the outer side of a piece lies within the solid, or its inner side outside of it: on a face the
/// winding number is the mean of both sides, one half where a face bounds the solid.
fn lies_within(mesh: &Mesh, tree: &TriangleTree, piece: &[FaceId]) -> bool {
    let step = piece.len().div_ceil(ASKED);
    let asked: Vec<bool> = piece
        .iter()
        .step_by(step)
        .map(|&f| {
            let winding = tree.winding_number(mesh.face_center(f));
            !(-0.25..1.25).contains(&winding)
        })
        .collect();
    2 * asked.iter().filter(|&&within| within).count() > asked.len()
}
