//! Decimation with any cost and any set of constraints.
//!
//! - Input: polygons of any degree, with data.
//! - Cost: O(n log n) prices.
//! - Guarantees: a valid mesh of the same topology; data travel as [`Editor::collapse_at`] has it.
//! - Reference: Kobbelt, Campagna, Seidel, "A general framework for mesh decimation", Graphics Interface 1998.

use std::f64::consts::PI;

use dgp_mesh::{
    Cancelled, DVec3, EdgeId, EdgeSet, Editor, HalfedgeId, Mesh, Progress, VertexId, VertexMap,
    VertexSet, graph::IndexedHeap,
};

use super::{
    Boundary,
    cost::CollapseCost,
    nearness::Nearness,
    report::{DecimationReport, Refusals, StopReason, Target},
};
use crate::Error;

/// What [`decimate()`] keeps from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecimationOptions {
    /// What happens to rims of holes.
    pub boundary: Boundary,
    /// The largest angle a face may turn by in one collapse, in radians; π for any.
    pub largest_turn: f64,
    /// The least shape of a new triangle: 4√3 area / (sum of squared sides), 1 for equilateral ones. A
    /// collapse that makes the worst one no worse is done all the same.
    pub least_shape: f64,
    /// How far a vertex of the input may come to be from the result, in the unit of the coordinates.
    pub max_distance: f64,
}

impl Default for DecimationOptions {
    fn default() -> Self {
        DecimationOptions {
            boundary: Boundary::Weighted,
            largest_turn: 75_f64.to_radians(),
            least_shape: 0.0,
            max_distance: f64::INFINITY,
        }
    }
}

/// The edges at which the normals of faces differ by more than `angle`, in radians.
pub fn sharp_edges(mesh: &Mesh, angle: f64) -> EdgeSet {
    let is_sharp = |e: &EdgeId| mesh.dihedral_angle(*e).is_some_and(|turn| turn.abs() > angle);
    mesh.edges().filter(is_sharp).collect()
}

/// The edges along which data of corners differ on both sides, such as seams of texture coordinates.
pub fn seam_edges(mesh: &Mesh) -> EdgeSet {
    let corner = &mesh.attributes().corner;
    let is_seam = |e: &EdgeId| {
        let [h, t] = e.halfedges();
        let both = mesh.face(h).is_some() && mesh.face(t).is_some();
        both && !(corner.equal(h, mesh.next(t)) && corner.equal(mesh.next(h), t))
    };
    if corner.is_empty() { EdgeSet::new() } else { mesh.edges().filter(is_seam).collect() }
}

/// Decimates toward `target` in the order of `cost`.
///
/// Vertices of `fixed` stay. Edges of `features` stay as lines: their vertices move along them only, and where
/// not two of them meet not at all; so do rims. Data travel. A cancelled run leaves a valid mesh, decimated
/// part of the way.
///
/// ```
/// use dgp_mesh::{EdgeSet, HalfedgeId, Mesh, Progress, VertexSet, shapes};
/// use dgp_remesh::{DecimationOptions, Target, decimate};
///
/// // Far from the ground first, short edges before long ones.
/// let mut cost = |mesh: &Mesh, h: HalfedgeId| {
///     let height = mesh.edge_midpoint(h.edge()).z + 1.0;
///     mesh.edge_length(h.edge()) / (0.1 + height)
/// };
/// let mut mesh = shapes::icosphere(3)?;
/// let options = DecimationOptions::default();
/// let none = (VertexSet::new(), EdgeSet::new());
/// let report =
///     decimate(&mut mesh, Target::Faces(300), &mut cost, (&none.0, &none.1), &options, Progress::NONE)?;
/// assert_eq!(report.faces, [1280, 300]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Errors: [`Error::NotFinite`], [`Error::InvalidOption`], [`Error::Cancelled`].
pub fn decimate(
    mesh: &mut Mesh,
    target: Target,
    cost: &mut impl CollapseCost,
    (fixed, features): (&VertexSet, &EdgeSet),
    options: &DecimationOptions,
    progress: Progress<'_>,
) -> Result<DecimationReport, Error> {
    target.check()?;
    for (name, value) in
        [("max_distance", options.max_distance), ("least_shape", options.least_shape)]
    {
        if !(value >= 0.0) {
            return Err(Error::InvalidOption { name, value, expected: "zero or more" });
        }
    }
    if let Some((vertex, _)) = mesh.positions().iter().find(|(_, p)| !p.is_finite()) {
        return Err(Error::NotFinite { vertex });
    }
    if target.is_reached(mesh.vertex_count(), mesh.face_count()) {
        return Ok(DecimationReport::unchanged(mesh));
    }
    let start = [mesh.vertex_count(), mesh.face_count()];
    let nearness = (options.max_distance < f64::INFINITY).then(|| Nearness::new(mesh));
    let mut run = Run {
        fixed,
        lines: lines(mesh, features),
        corners: VertexSet::new(),
        queue: IndexedHeap::new(),
        choice: vec![None; mesh.edge_count()],
        parent: VertexMap::from_fn(start[0], |v| v),
        editor: Editor::new(mesh),
        cost,
        options: *options,
        target,
        nearness,
        refusals: Refusals::default(),
        collapses: 0,
        largest_error: 0.0,
        start,
    };
    run.find_corners();
    let stop = run.go(progress)?;
    let Run { editor, parent, refusals, collapses, largest_error, .. } = run;
    let counts = [editor.vertex_count(), editor.face_count()];
    let compaction = editor.finish();
    let root = |mut v: VertexId| {
        while parent[v] != v {
            v = parent[v];
        }
        compaction.vertices[v].expect("what nothing was merged into is left")
    };
    Ok(DecimationReport {
        vertices: [start[0], counts[0]],
        faces: [start[1], counts[1]],
        collapses,
        largest_error,
        stop,
        refusals,
        vertex_map: VertexMap::from_fn(start[0], root),
        face_map: compaction.faces,
    })
}

/// Features and rims.
fn lines(mesh: &Mesh, features: &EdgeSet) -> EdgeSet {
    let all = mesh.edges().filter(|&e| features.contains(e) || mesh.is_boundary_edge(e));
    all.collect()
}

struct Run<'a, C> {
    editor: Editor<'a>,
    cost: &'a mut C,
    fixed: &'a VertexSet,
    lines: EdgeSet,
    /// Where lines end, meet, or turn sharply is found once.
    corners: VertexSet,
    options: DecimationOptions,
    target: Target,
    queue: IndexedHeap<EdgeId>,
    /// In which direction an edge collapses and where to.
    choice: Vec<Option<Choice>>,
    parent: VertexMap<VertexId>,
    nearness: Option<Nearness>,
    refusals: Refusals,
    collapses: usize,
    largest_error: f64,
    start: [usize; 2],
}

#[derive(Clone, Copy)]
struct Choice {
    halfedge: HalfedgeId,
    position: DVec3,
    key: f64,
    error: f64,
}

impl<C: CollapseCost> Run<'_, C> {
    fn find_corners(&mut self) {
        let mesh = self.editor.mesh();
        let at = |v: VertexId| mesh.vertex_edges(v).filter(|&e| self.lines.contains(e)).count();
        let ends = mesh.vertices().filter(|&v| !matches!(at(v), 0 | 2));
        let mut corners: VertexSet = ends.collect();
        if self.options.boundary == Boundary::Kept {
            corners.extend(mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)));
        }
        corners.extend(self.fixed.iter().filter(|v| v.index() < mesh.vertex_count()));
        self.corners = corners;
    }

    fn is_on_line(&self, v: VertexId) -> bool {
        self.editor.mesh().vertex_edges(v).any(|e| self.lines.contains(e))
    }

    /// Whether `from(h)` may go, and whether `to(h)` may move then.
    fn freedom(&self, h: HalfedgeId) -> Option<bool> {
        let mesh = self.editor.mesh();
        let (a, b) = (mesh.from(h), mesh.to(h));
        if self.corners.contains(a) {
            return None;
        }
        if self.is_on_line(a) {
            // Along the line only, onto a vertex that is there: lines keep their shape.
            return self.lines.contains(h.edge()).then_some(false);
        }
        Some(!self.corners.contains(b) && !self.is_on_line(b))
    }

    /// The cheaper direction of `e`.
    fn rank(&mut self, e: EdgeId) {
        let mut best: Option<Choice> = None;
        let mut is_protected = true;
        for halfedge in e.halfedges() {
            let Some(is_free) = self.freedom(halfedge) else { continue };
            is_protected = false;
            let mesh = self.editor.mesh();
            let position = if is_free {
                self.cost.place(mesh, halfedge)
            } else {
                mesh.position(mesh.to(halfedge))
            };
            let price = self.cost.price(mesh, halfedge, position);
            let (key, error) = (price.key, price.error);
            if !(key < f64::INFINITY)
                || !position.is_finite()
                || !(error <= self.target.error_limit())
            {
                self.refusals.error += 1;
                continue;
            }
            if best.is_none_or(|old| key < old.key) {
                best = Some(Choice { halfedge, position, key, error });
            }
        }
        self.refusals.protected += usize::from(is_protected);
        self.choice[e.index()] = best;
        match best {
            Some(choice) => self.queue.set(e, choice.key),
            None => drop(self.queue.remove(e)),
        }
    }

    fn go(&mut self, progress: Progress<'_>) -> Result<StopReason, Cancelled> {
        for e in (0..self.editor.mesh().edge_count()).map(EdgeId::new) {
            if e.index().is_multiple_of(4096) {
                progress.report(0.2 * e.index() as f64 / self.editor.mesh().edge_count() as f64)?;
            }
            self.rank(e);
        }
        let progress = progress.part(0.2, 1.0);
        let mut turns = 0_usize;
        while let Some((e, _)) = self.queue.pop() {
            if turns.is_multiple_of(1024) {
                let now = [self.editor.vertex_count(), self.editor.face_count()];
                progress.report(self.target.progress(self.start, now))?;
            }
            turns += 1;
            let Some(choice) = self.choice[e.index()] else { continue };
            if !self.may(&choice) {
                continue;
            }
            self.collapse(&choice);
            if self.target.is_reached(self.editor.vertex_count(), self.editor.face_count()) {
                progress.report(1.0)?;
                return Ok(StopReason::TargetReached);
            }
        }
        progress.report(1.0)?;
        Ok(StopReason::NothingLeft)
    }

    fn may(&mut self, choice: &Choice) -> bool {
        let h = choice.halfedge;
        if self.editor.can_collapse(h).is_err() {
            self.refusals.topology += 1;
            return false;
        }
        let mesh = self.editor.mesh();
        let ends = [mesh.from(h), mesh.to(h)];
        let (turns, shape) = surroundings(mesh, ends, choice.position, self.options.largest_turn);
        if turns {
            self.refusals.flipped += 1;
            return false;
        }
        if shape[1] < self.options.least_shape && shape[1] < shape[0] {
            self.refusals.shape += 1;
            return false;
        }
        let limit = self.options.max_distance;
        if let Some(nearness) = &mut self.nearness
            && !nearness.try_collapse(mesh, h, choice.position, limit)
        {
            self.refusals.distance += 1;
            return false;
        }
        true
    }

    fn collapse(&mut self, choice: &Choice) {
        let h = choice.halfedge;
        let mesh = self.editor.mesh();
        let (a, b) = (mesh.from(h), mesh.to(h));
        self.cost.merge(mesh, h, choice.position);
        // Of two sides that become one that of b stays, and is a line if either was.
        for side in [h, h.twin()] {
            let (after, before) = (mesh.next(side), mesh.prev(side));
            let is_triangle = mesh.face(side).is_some() && mesh.next(after) == before;
            if is_triangle {
                let pair = [after.edge(), before.edge()];
                if pair.iter().any(|&e| self.lines.contains(e)) {
                    self.lines.extend(pair);
                }
            }
        }
        self.parent[a] = b;
        let result = self.editor.collapse_at(h, choice.position);
        debug_assert_eq!(result, Ok(b), "it was asked before");
        self.queue.remove(h.edge());
        self.collapses += 1;
        self.largest_error = self.largest_error.max(choice.error);
        let mesh = self.editor.mesh();
        let mut edges: Vec<EdgeId> = mesh.vertex_edges(b).collect();
        if self.cost.reaches_ring() {
            edges.extend(mesh.vertex_neighbors(b).flat_map(|v| mesh.vertex_edges(v)));
            edges.sort_unstable();
            edges.dedup();
        } else {
            // What was refused for its surroundings may do now.
            let around = mesh.vertex_halfedges(b).map(|g| mesh.next(g).edge());
            let waiting = around.filter(|&e| self.queue.key(e).is_none());
            edges.extend(waiting.collect::<Vec<_>>());
        }
        for e in edges {
            self.rank(e);
        }
    }
}

/// Whether a face at the `ends` turns too far when both move to `p`, and the worst shape before and after.
fn surroundings(mesh: &Mesh, ends: [VertexId; 2], p: DVec3, largest: f64) -> (bool, [f64; 2]) {
    let limit = largest.cos();
    let mut shape = [1.0_f64; 2];
    for (v, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
        for f in mesh.vertex_faces(v) {
            let is_at_edge = mesh.face_vertices(f).any(|w| w == other);
            if let Some(corners) = mesh.triangle(f) {
                let now = corners.map(|w| mesh.position(w));
                shape[0] = shape[0].min(roundness(now));
                if !is_at_edge {
                    shape[1] = shape[1]
                        .min(roundness(corners.map(|w| if w == v { p } else { mesh.position(w) })));
                }
            }
            if largest >= PI || (is_at_edge && mesh.degree(f) == 3) {
                continue;
            }
            let before = vector_area(mesh, f, |w| mesh.position(w));
            let after =
                vector_area(mesh, f, |w| if ends.contains(&w) { p } else { mesh.position(w) });
            let (was, is) = (before.length(), after.length());
            if was > 0.0 && !(before.dot(after) > 0.0_f64.max(limit * was * is)) {
                return (true, shape);
            }
        }
    }
    (false, shape)
}

fn vector_area(mesh: &Mesh, f: dgp_mesh::FaceId, at: impl Fn(VertexId) -> DVec3) -> DVec3 {
    let origin = mesh.position(mesh.from(mesh.face_halfedge(f)));
    let sides = mesh.face_halfedges(f);
    sides.map(|h| (at(mesh.from(h)) - origin).cross(at(mesh.to(h)) - origin)).sum()
}

/// 4√3 area / Σ side².
fn roundness([p, q, r]: [DVec3; 3]) -> f64 {
    let squares = (q - p).length_squared() + (r - q).length_squared() + (p - r).length_squared();
    if squares > 0.0 { 2.0 * 3_f64.sqrt() * (q - p).cross(r - p).length() / squares } else { 0.0 }
}
