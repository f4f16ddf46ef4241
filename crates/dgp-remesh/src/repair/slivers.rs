//! Needles and caps: triangles that are nearly a line.
//!
//! ```text
//!      needle                            cap
//!   b                                         c
//!   │╲_______________                     ╱‾‾   ‾‾╲          c goes to the face across:
//!   a‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾c                  a ─────────── b       the long edge a b is flipped
//!                                        ╲         ╱
//!   a and b become one                        d
//! ```
//!
//! A needle goes by the collapse of its shortest edge into the end that is nearer to the planes of the faces
//! around the other, so that corners and creases stay. A cap goes by the flip of its longest edge, at a rim by its removal.
//!
//! - Input: a mesh of any polygons; only triangles are looked at.
//! - Cost: O(F) for each pass; a pass that changes nothing is the last.
//! - Guarantees: no face is turned over, no vertex moves farther than asked for, the topology stays.
//! - Reference: Botsch and Kobbelt, "A robust procedure to eliminate degenerate faces from triangle
//!   meshes", VMV 2001.
//! - Departs from it: what is moved is bounded, so slivers that are broad in the end stay and are told.

use dgp_mesh::{DVec3, Editor, FaceId, HalfedgeId, Mesh, Progress, VertexId};

use super::{geometry, track::Track};
use crate::Error;

/// Passes after which slivers in long chains are left.
const PASSES: usize = 32;

/// Which triangles [`remove_slivers`] takes for slivers, and how far it may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliverOptions {
    /// A needle's longest edge is at least so many times as long as its shortest. At least 1.
    pub needle_ratio: f64,
    /// A cap has an angle of at least so much, in radians; from π/2 to π.
    pub cap_angle: f64,
    /// How far the surface may move, as a fraction of the diagonal of the bounding box.
    pub max_move: f64,
}

impl Default for SliverOptions {
    /// Only what is a line for all purposes: long thin triangles of machine parts stay.
    fn default() -> Self {
        SliverOptions { needle_ratio: 1e4, cap_angle: 179.9_f64.to_radians(), max_move: 1e-4 }
    }
}

/// What [`remove_slivers`] did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[must_use]
pub struct SliverReport {
    /// Edges that were collapsed.
    pub collapsed: usize,
    /// Edges that were flipped.
    pub flipped: usize,
    /// Caps that were removed at a rim.
    pub removed: usize,
    /// Slivers that stay, in order: mending them would move the surface too far or turn faces over.
    pub left: Vec<FaceId>,
}

/// The needles of a mesh: triangles whose longest edge is at least `ratio` times as long as the shortest,
/// or which have an edge of no length.
pub fn needle_faces(mesh: &Mesh, ratio: f64) -> Vec<FaceId> {
    let is_needle = |&f: &FaceId| corners(mesh, f).is_some_and(|t| needle(&t, ratio).is_some());
    mesh.faces().filter(is_needle).collect()
}

/// The caps of a mesh: triangles of which an angle is at least `angle`, in radians, π/2 or more.
pub fn cap_faces(mesh: &Mesh, angle: f64) -> Vec<FaceId> {
    let is_cap = |&f: &FaceId| corners(mesh, f).is_some_and(|t| cap(&t, angle).is_some());
    mesh.faces().filter(is_cap).collect()
}

/// Removes needles and caps as far as that moves the surface little.
///
/// Errors: [`Error::InvalidOption`], [`Error::NotFinite`], [`Error::Cancelled`], which leaves the mesh as
/// far as it got.
///
/// ```
/// use dgp_mesh::{DVec3, Editor, Progress, shapes};
/// use dgp_remesh::{SliverOptions, remove_slivers};
///
/// let mut mesh = shapes::icosphere(2)?;
/// let mut editor = Editor::new(&mut mesh);
/// let edge = editor.edges().next().expect("an edge");
/// let [a, b] = editor.mesh().edge_vertices(edge).map(|v| editor.mesh().position(v));
/// // Beside the start of the edge: two needles, and two caps of what is left.
/// editor.split_edge_triangles(edge, a + 1e-6 * (b - a))?;
/// let _ = editor.finish();
/// let report = remove_slivers(&mut mesh, &SliverOptions::default(), Progress::NONE)?;
/// assert_eq!((report.collapsed, mesh.face_count()), (1, 320));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn remove_slivers(
    mesh: &mut Mesh,
    options: &SliverOptions,
    progress: Progress<'_>,
) -> Result<SliverReport, Error> {
    let mut track = Track::of(mesh);
    remove(mesh, options, &mut track, progress)
}

pub(super) fn remove(
    mesh: &mut Mesh,
    options: &SliverOptions,
    track: &mut Track,
    progress: Progress<'_>,
) -> Result<SliverReport, Error> {
    check(options)?;
    geometry::need_finite(mesh)?;
    let limit = options.max_move * geometry::diagonal(mesh);
    let mut report = SliverReport::default();
    let mut slivers: Vec<FaceId> = mesh.faces().filter(|&f| is_sliver(mesh, f, options)).collect();
    progress.report(0.1)?;
    if slivers.is_empty() {
        return Ok(report);
    }
    let mut work = Work { editor: Editor::new(mesh), options, limit, merged: Vec::new() };
    for pass in 0..PASSES {
        let mut changed = false;
        for (k, &f) in slivers.iter().enumerate() {
            if k % 1024 == 0 {
                progress.report(0.1 + 0.9 * pass as f64 / PASSES as f64)?;
            }
            changed |= work.mend(f, &mut report);
        }
        let left = work.editor.faces().filter(|&f| is_sliver(work.editor.mesh(), f, options));
        slivers = left.collect();
        if !changed || slivers.is_empty() {
            break;
        }
    }
    let Work { editor, merged, .. } = work;
    let compaction = editor.finish();
    report.left = slivers.iter().filter_map(|&f| compaction.faces[f]).collect();
    track.compacted(&compaction, &merged);
    progress.report(1.0)?;
    Ok(report)
}

fn check(options: &SliverOptions) -> Result<(), Error> {
    let invalid = |name, value, expected| Err(Error::InvalidOption { name, value, expected });
    let SliverOptions { needle_ratio, cap_angle, max_move } = *options;
    if !(needle_ratio >= 1.0) {
        return invalid("needle_ratio", needle_ratio, "at least 1");
    }
    if !(std::f64::consts::FRAC_PI_2..=std::f64::consts::PI).contains(&cap_angle) {
        return invalid("cap_angle", cap_angle, "an angle from π/2 to π");
    }
    if !(0.0..f64::INFINITY).contains(&max_move) {
        return invalid("max_move", max_move, "a number that is not negative");
    }
    Ok(())
}

/// The corners of a triangle relative to the first, about one in size; `None` for other faces.
fn corners(mesh: &Mesh, f: FaceId) -> Option<[DVec3; 3]> {
    let [a, b, c] = mesh.triangle(f)?.map(|v| mesh.position(v));
    Some(geometry::normalized([a, b, c]))
}

fn is_sliver(mesh: &Mesh, f: FaceId, options: &SliverOptions) -> bool {
    corners(mesh, f).is_some_and(|t| {
        needle(&t, options.needle_ratio).is_some() || cap(&t, options.cap_angle).is_some()
    })
}

/// The shortest side of a needle: side k leads from corner k to the next.
fn needle(t: &[DVec3; 3], ratio: f64) -> Option<usize> {
    let squares = squares(t);
    let shortest = (0..3).min_by(|&i, &j| squares[i].total_cmp(&squares[j]))?;
    let longest = squares.iter().copied().fold(0.0, f64::max);
    let least = squares[shortest];
    (least == 0.0 || longest >= ratio * ratio * least).then_some(shortest)
}

/// The corner of a cap with the large angle.
fn cap(t: &[DVec3; 3], angle: f64) -> Option<usize> {
    let squares = squares(t);
    if squares.contains(&0.0) {
        return None;
    }
    let cosine = angle.cos();
    (0..3).find(|&k| {
        let (next, prev) = (t[(k + 1) % 3] - t[k], t[(k + 2) % 3] - t[k]);
        let product = next.dot(prev);
        product <= 0.0 && product * product >= cosine * cosine * squares[k] * squares[(k + 2) % 3]
    })
}

fn squares(t: &[DVec3; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| t[k].distance_squared(t[(k + 1) % 3]))
}

struct Work<'a, 'b> {
    editor: Editor<'a>,
    options: &'b SliverOptions,
    limit: f64,
    /// Vertices with those that they went into.
    merged: Vec<[VertexId; 2]>,
}

impl Work<'_, '_> {
    /// Mends `f` if it is still there and a sliver; whether something changed.
    fn mend(&mut self, f: FaceId, report: &mut SliverReport) -> bool {
        if !self.editor.has_face(f) {
            return false;
        }
        let mesh = self.editor.mesh();
        let Some(t) = corners(mesh, f) else { return false };
        let sides = self.sides(f);
        if let Some(k) = needle(&t, self.options.needle_ratio)
            && self.try_collapse(sides[k])
        {
            report.collapsed += 1;
            return true;
        }
        let Some(k) = cap(&t, self.options.cap_angle) else { return false };
        let across = sides[(k + 1) % 3];
        if self.editor.mesh().is_boundary_edge(across.edge()) {
            if self.try_remove(f, across) {
                report.removed += 1;
                return true;
            }
        } else if self.try_flip(f, across) {
            report.flipped += 1;
            return true;
        }
        let squares = squares(&t);
        let shorter = if squares[k] <= squares[(k + 2) % 3] { k } else { (k + 2) % 3 };
        if self.try_collapse(sides[shorter]) {
            report.collapsed += 1;
            return true;
        }
        false
    }

    /// The sides of a triangle, from each of its corners in the order of `Mesh::triangle`.
    fn sides(&self, f: FaceId) -> [HalfedgeId; 3] {
        let mesh = self.editor.mesh();
        let first = mesh.face_halfedge(f);
        [first, mesh.next(first), mesh.prev(first)]
    }

    /// Collapses an edge into the end where that changes the surface less.
    fn try_collapse(&mut self, side: HalfedgeId) -> bool {
        let mesh = self.editor.mesh();
        let length =
            geometry::distance(mesh.position(mesh.from(side)), mesh.position(mesh.to(side)));
        if length > self.limit {
            return false;
        }
        let (forward, back) = (side, side.twin());
        let is_back = self.cost(back) < self.cost(forward);
        let order = if is_back { [back, forward] } else { [forward, back] };
        for h in order {
            let mesh = self.editor.mesh();
            let (from, to) = (mesh.from(h), mesh.to(h));
            if mesh.is_boundary_vertex(from) && !mesh.is_boundary_vertex(to) {
                continue;
            }
            if self.editor.can_collapse(h).is_ok()
                && !self.turns_over(h)
                && self.editor.collapse(h).is_ok()
            {
                self.merged.push([from, to]);
                return true;
            }
        }
        false
    }

    /// How far the surface is from where it was when the start of `h` moves to its end: the largest
    /// distance of the end from the planes of the faces at the start, and from its rim.
    fn cost(&self, h: HalfedgeId) -> f64 {
        /// Below this the normal of a triangle is rounding.
        const FLAT: f64 = 1e-9;
        let mesh = self.editor.mesh();
        let (from, to) = (mesh.from(h), mesh.to(h));
        let (start, end) = (mesh.position(from), mesh.position(to));
        let mut cost: f64 = 0.0;
        for f in mesh.vertex_faces(from) {
            let thin = mesh.triangle(f).is_some_and(|corners| {
                geometry::breadth(&corners.map(|v| mesh.position(v))) < FLAT
            });
            if !thin {
                cost = cost.max(mesh.face_normal(f).dot(end - start).abs());
            }
        }
        if mesh.is_boundary_vertex(from) {
            for g in mesh.vertex_halfedges(from).filter(|g| mesh.is_boundary_edge(g.edge())) {
                let other = mesh.position(mesh.to(g));
                if mesh.to(g) != to {
                    cost = cost.max(geometry::height(start, other, end));
                }
            }
        }
        cost
    }

    /// Whether a face would be turned over, or lose its area, when the start of `h` moves to its end.
    fn turns_over(&self, h: HalfedgeId) -> bool {
        let mesh = self.editor.mesh();
        let (from, target) = (mesh.from(h), mesh.position(mesh.to(h)));
        let goes = [mesh.face(h), mesh.face(h.twin())];
        let turned = |f: FaceId| {
            let Some(corners) = mesh.triangle(f) else { return false };
            let old = corners.map(|v| mesh.position(v));
            let new = corners.map(|v| if v == from { target } else { mesh.position(v) });
            let (before, after) = (geometry::normal(&old), geometry::normal(&new));
            if is_sliver(mesh, f, self.options) {
                return before != DVec3::ZERO && after == DVec3::ZERO;
            }
            before.dot(after) <= 0.0
        };
        mesh.vertex_faces(from).any(|f| !goes.contains(&Some(f)) && turned(f))
    }

    /// Flips the longest side of the cap `f`, where that betters the worse of both faces.
    fn try_flip(&mut self, f: FaceId, side: HalfedgeId) -> bool {
        let mesh = self.editor.mesh();
        let Some(beyond) = mesh.face(side.twin()) else { return false };
        let (Some(_), Some(_)) = (mesh.triangle(f), mesh.triangle(beyond)) else { return false };
        let (v_a, v_b) = (mesh.from(side), mesh.to(side));
        let (v_c, v_d) = (mesh.to(mesh.next(side)), mesh.to(mesh.next(side.twin())));
        let [a, b, c, d] = [v_a, v_b, v_c, v_d].map(|v| mesh.position(v));
        if geometry::height(a, b, c) > self.limit {
            return false;
        }
        let normal = geometry::normal(&[b, a, d]);
        let news = [[a, d, c], [d, b, c]];
        if normal == DVec3::ZERO || news.iter().any(|t| geometry::normal(t).dot(normal) <= 0.0) {
            return false;
        }
        let worse = |s: [DVec3; 3], t: [DVec3; 3]| geometry::breadth(&s).min(geometry::breadth(&t));
        let is_better = worse(news[0], news[1]) > worse([a, b, c], [b, a, d]) * (1.0 + 1e-9);
        is_better && self.editor.flip(side.edge()).is_ok()
    }

    /// Removes a cap whose longest side is a rim.
    fn try_remove(&mut self, f: FaceId, side: HalfedgeId) -> bool {
        let mesh = self.editor.mesh();
        let corners = [mesh.from(side), mesh.to(side), mesh.to(mesh.next(side))];
        let [a, b, c] = corners.map(|v| mesh.position(v));
        if geometry::height(a, b, c) > self.limit || self.editor.remove_face(f).is_err() {
            return false;
        }
        for v in corners {
            if self.editor.mesh().is_isolated_vertex(v) {
                let removed = self.editor.remove_vertex(v);
                debug_assert!(removed.is_ok(), "the vertex is there");
            }
        }
        true
    }
}
