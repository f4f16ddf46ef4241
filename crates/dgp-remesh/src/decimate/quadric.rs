//! Decimation of triangles by quadrics: collapses edges in the order of the squared distance to planes.
//!
//! - Input: triangles, with holes perhaps.
//! ```text
//! E(p) = Σ over a, b  Σ over triangles around it  w (n·(p − a))²,   w = A^(3/2)
//! p    = argmin E(p)  with  Σ A n·(p − a) = 0: the volume stays the same
//! ```
//!
//! - Cost: O(n log n).
//! - Guarantees: a manifold of the same topology; no triangle turned by more than `largest_turn`.
//! - Reference: Garland and Heckbert 1997; Lindstrom and Turk, "Fast and memory efficient polygonal
//!   simplification", Visualization 1998 (quadrics of the present triangles).
//! - Departs from it: weights are powers 3/2 of areas, between Hoppe's areas and Lindstrom and Turk's squares,
//!   which measured best in both mean and largest distance; rims and sharp edges are kept by planes through
//!   them; what planes leave free is drawn to the middle of the edge; the best edge of a vertex is looked for again only when its turn comes.

use std::f64::consts::PI;

use dgp_mesh::{
    Cancelled, DVec3, EdgeId, FaceId, Mesh, Progress, VertexId, VertexSet, graph::IndexedHeap,
    parallel,
};

use super::{
    edge::{Candidate, Ends, Through, fence},
    frame::Frame,
    generic::{seam_edges, sharp_edges},
    options::{Boundary, Memory, Placement, QuadricOptions, Volume},
    report::{DecimationReport, Refusals, StopReason, Target},
    rings::{NONE, RIM, Rings, SHARP, Shared},
};
use crate::{
    Error,
    quadric::{Quadric, outer},
};

/// Decimates triangles toward `target`; vertices of `fixed` stay where they are.
///
/// Data travel: see [`Editor::collapse_at`](dgp_mesh::Editor::collapse_at). A cancelled run leaves a valid mesh, decimated part of the way.
///
/// Errors: [`Error::NotTriangle`], [`Error::NotFinite`], [`Error::InvalidOption`], [`Error::Cancelled`].
pub fn decimate_quadric(
    mesh: &mut Mesh,
    target: Target,
    fixed: &VertexSet,
    options: &QuadricOptions,
    progress: Progress<'_>,
) -> Result<DecimationReport, Error> {
    target.check()?;
    if target.is_reached(mesh.vertex_count(), mesh.face_count()) {
        return Ok(DecimationReport::unchanged(mesh));
    }
    let mut state = State::new(mesh, target, fixed, options, progress.part(0.0, 0.1))?;
    let stopped = state.run(progress.part(0.1, 0.95));
    let report = state.give_back(mesh)?;
    stopped?;
    progress.report(1.0)?;
    Ok(report)
}

/// The collapses that [`decimate_quadric`] would do, in order. The mesh stays as it is.
pub(crate) fn collapses(
    mesh: &Mesh,
    target: Target,
    fixed: &VertexSet,
    options: &QuadricOptions,
    progress: Progress<'_>,
) -> Result<Vec<Done>, Error> {
    target.check()?;
    let mut state = State::new(mesh, target, fixed, options, progress.part(0.0, 0.1))?;
    state.keeps_log = true;
    if !target.is_reached(mesh.vertex_count(), mesh.face_count()) {
        state.run(progress.part(0.1, 1.0))?;
    }
    let frame = state.frame;
    for done in &mut state.log {
        done.position = frame.position(mesh, done.held, done.position);
    }
    Ok(state.log)
}

/// A collapse that was done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Done {
    pub(crate) from: u32,
    pub(crate) to: u32,
    /// The vertex of the input whose position it is, `NONE` if it is a new one.
    pub(super) held: u32,
    pub(crate) position: DVec3,
}

pub(super) struct State {
    pub(super) options: QuadricOptions,
    pub(super) target: Target,
    pub(super) rings: Rings,
    pub(super) frame: Frame,
    /// The normal of each triangle times the root of its weight.
    pub(super) normals: Vec<DVec3>,
    /// Twice the vector areas of triangles, and their sums around each vertex; empty if volumes are free.
    pub(super) areas: Vec<DVec3>,
    pub(super) around: Vec<DVec3>,
    /// The planes of the present triangles around each vertex.
    pub(super) through: Vec<Through>,
    /// Planes of the input, relative to the vertex.
    pub(super) remembered: Vec<Quadric>,
    pub(super) is_stale: Vec<bool>,
    pub(super) is_fixed: Vec<bool>,
    /// The vertex of the input whose position a vertex has, `NONE` if it is a new one.
    pub(super) held: Vec<u32>,
    pub(super) parent: Vec<u32>,
    pub(super) queue: IndexedHeap<VertexId>,
    pub(super) best: Vec<u32>,
    pub(super) is_ranked: Vec<bool>,
    pub(super) marks: Vec<u32>,
    pub(super) now: u32,
    pub(super) keeps_log: bool,
    pub(super) log: Vec<Done>,
    pub(super) collapses: usize,
    pub(super) largest_error: f64,
    pub(super) refusals: Refusals,
    pub(super) start: [usize; 2],
    pub(super) stop: StopReason,
    /// Shares of the present and the remembered planes.
    pub(super) shares: [f64; 2],
    pub(super) least_cosine: f64,
    pub(super) error_limit: f64,
}

impl State {
    fn new(
        mesh: &Mesh,
        target: Target,
        fixed: &VertexSet,
        options: &QuadricOptions,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        progress.report(0.0)?;
        if let Some((vertex, _)) = mesh.positions().iter().find(|(_, p)| !p.is_finite()) {
            return Err(Error::NotFinite { vertex });
        }
        let frame = Frame::new(mesh);
        let positions = mesh.positions().values().iter().map(|&p| frame.inside(p)).collect();
        let mut rings = Rings::new(mesh, positions)?;
        mark_sharp(&mut rings, mesh, options.feature_angle);
        let n = mesh.vertex_count();
        let is_fixed: Vec<bool> = mesh
            .vertices()
            .map(|v| {
                let kept = options.boundary == Boundary::Kept && rings.on_rim[v.index()];
                kept || fixed.contains(v)
            })
            .collect();
        let is_protected = |&e: &EdgeId| mesh.edge_vertices(e).iter().all(|v| is_fixed[v.index()]);
        let protected = mesh.edges().filter(is_protected).count();
        let shares = match options.memory {
            Memory::Memoryless => [1.0, 0.0],
            Memory::Kept => [0.0, 1.0],
            Memory::Blend(share) => [1.0, share],
        };
        let mut state = State {
            options: *options,
            target,
            frame,
            normals: Vec::new(),
            areas: Vec::new(),
            around: Vec::new(),
            through: Vec::new(),
            remembered: Vec::new(),
            is_stale: vec![false; n],
            is_fixed,
            held: (0..n as u32).collect(),
            parent: (0..n as u32).collect(),
            queue: IndexedHeap::new(),
            best: Vec::new(),
            is_ranked: vec![true; n],
            marks: vec![0; n],
            now: 0,
            keeps_log: has_data(mesh),
            log: Vec::new(),
            collapses: 0,
            largest_error: 0.0,
            refusals: Refusals { protected, ..Refusals::default() },
            start: [n, mesh.face_count()],
            stop: StopReason::TargetReached,
            shares,
            least_cosine: options.largest_turn.cos(),
            error_limit: target.error_limit() / frame.unit,
            rings,
        };
        let f_count = mesh.face_count();
        state.normals =
            parallel::map(f_count, |f: FaceId| state.normal(f.index() as u32)).into_values();
        if options.volume == Volume::Kept {
            state.areas =
                parallel::map(f_count, |f: FaceId| state.area(f.index() as u32)).into_values();
            state.around =
                parallel::map(n, |v: VertexId| state.around(v.index() as u32)).into_values();
        }
        let own: Vec<Through> =
            parallel::map(n, |v: VertexId| state.present(v.index() as u32)).into_values();
        let [present, share] = shares;
        if share > 0.0 {
            let of = |a: &Through| Quadric { a: a.map(|x| x * share), ..Quadric::ZERO };
            state.remembered = own.iter().map(of).collect();
        }
        state.through = own;
        if present == 0.0 {
            state.through.fill([0.0; 6]);
        }
        progress.report(0.5)?;
        let ranked = parallel::map(n, |v: VertexId| state.rank(v.index() as u32)).into_values();
        state.best = ranked.iter().map(|&(w, _)| w).collect();
        let keys = ranked.iter().enumerate().filter(|(_, (w, _))| *w != NONE);
        state.queue =
            IndexedHeap::from_keys(keys.map(|(v, (_, found))| (VertexId::new(v), found.key)));
        progress.report(1.0)?;
        Ok(state)
    }

    /// Twice the vector area of `f`.
    #[inline]
    fn area(&self, f: u32) -> DVec3 {
        let [p, q, r] = self.rings.faces[f as usize].map(|v| self.rings.positions[v as usize]);
        (q - p).cross(r - p)
    }

    /// The normal of `f` times the root of its weight.
    #[inline]
    fn normal(&self, f: u32) -> DVec3 {
        let area = self.area(f);
        let square = area.length_squared();
        // |N|^(3/4): between the area (Hoppe) and its square (Lindstrom and Turk).
        if square > 0.0 { area / square.sqrt().sqrt().sqrt() } else { DVec3::ZERO }
    }

    /// Twice the vector area of the triangles around `v`.
    #[inline]
    fn around(&self, v: u32) -> DVec3 {
        self.rings.ring(v).iter().map(|&f| self.areas[f as usize]).sum()
    }

    /// The planes of the present triangles around `v`.
    #[inline]
    fn present(&self, v: u32) -> Through {
        let rings = &self.rings;
        let mut sum = [0.0; 6];
        let add = |sum: &mut Through, terms: Through| {
            for (x, y) in sum.iter_mut().zip(terms) {
                *x += y;
            }
        };
        for &f in rings.ring(v) {
            let normal = self.normals[f as usize];
            add(&mut sum, outer(normal, 1.0));
            let bits = rings.sides[f as usize];
            if bits != 0 {
                let p = rings.positions[v as usize];
                let [x, y] = rings.others(f, v).map(|w| rings.positions[w as usize] - p);
                let k = rings.corner(f, v);
                let normal = normal.normalize_or_zero();
                for (side, s) in [(k, x), ((k + 2) % 3, y)] {
                    if bits & (RIM << side) != 0 {
                        add(&mut sum, fence(s, normal, self.options.boundary_weight));
                    } else if bits & (SHARP << side) != 0 {
                        add(&mut sum, fence(s, normal, self.options.feature_weight));
                    }
                }
            }
        }
        sum
    }

    #[inline]
    fn refresh(&mut self, v: u32) {
        if self.is_stale[v as usize] {
            self.is_stale[v as usize] = false;
            if !self.around.is_empty() {
                self.around[v as usize] = self.around(v);
            }
            if self.shares[0] > 0.0 {
                self.through[v as usize] = self.present(v);
            }
        }
    }

    /// The collapse of the edge between `v` and `w`.
    #[inline]
    fn candidate(&self, v: u32, w: u32) -> Candidate {
        let positions = &self.rings.positions;
        let (i, j) = (v as usize, w as usize);
        let ends = Ends {
            a: positions[i],
            b: positions[j],
            through: [&self.through[i], &self.through[j]],
            remembered: (!self.remembered.is_empty())
                .then(|| [&self.remembered[i], &self.remembered[j]]),
            slack: self.options.length_weight,
            areas: (!self.around.is_empty()).then(|| {
                let rings = &self.rings;
                let at_edge = rings.ring(v).iter().filter(|&&f| rings.others(f, v).contains(&w));
                let shared: DVec3 = at_edge.map(|&f| self.areas[f as usize]).sum();
                [self.around[i], self.around[j] - shared]
            }),
        };
        match (self.is_fixed[i], self.is_fixed[j], self.options.placement) {
            (true, _, _) => ends.fixed(ends.a),
            (_, true, _) => ends.fixed(ends.b),
            (_, _, Placement::Ends) => ends.best_end(),
            (_, _, Placement::Optimal) => ends.best(self.options.damping),
        }
    }

    fn error(candidate: &Candidate) -> f64 {
        if candidate.cost > 0.0 { (candidate.cost / candidate.weight).sqrt() } else { 0.0 }
    }

    /// Whether the collapse is one to think of at all.
    #[inline]
    fn is_allowed(&self, v: u32, w: u32) -> bool {
        w > v && !(self.is_fixed[v as usize] && self.is_fixed[w as usize])
    }

    /// The best edge from `v` to a vertex of a larger number. Quadrics are fresh.
    fn rank(&self, v: u32) -> (u32, Candidate) {
        let nothing =
            Candidate { key: f64::INFINITY, cost: 0.0, weight: 0.0, position: DVec3::ZERO };
        let mut best = (NONE, nothing);
        self.rings.each_neighbor(v, |w| {
            if self.is_allowed(v, w) {
                let found = self.candidate(v, w);
                if found.key < best.1.key || (found.key == best.1.key && w < best.0) {
                    best = (w, found);
                }
            }
        });
        best
    }

    fn refresh_around(&mut self, v: u32) {
        self.refresh(v);
        for k in 0..self.rings.ring_len(v) {
            let f = self.rings.ring(v)[k];
            let [next, prev] = self.rings.others(f, v);
            if next > v {
                self.refresh(next);
            }
            // The last one of a fan is next of no triangle.
            if self.rings.on_rim[v as usize] && prev > v {
                self.refresh(prev);
            }
        }
    }

    fn run(&mut self, progress: Progress<'_>) -> Result<(), Cancelled> {
        let mut turns = 0_usize;
        while let Some((id, key)) = self.queue.pop() {
            turns += 1;
            if turns.is_multiple_of(4096) {
                let now = [self.rings.vertex_count, self.rings.face_count];
                progress.report(self.target.progress(self.start, now))?;
            }
            let v = id.index() as u32;
            let best = self.best[v as usize];
            if !self.is_ranked[v as usize] || best == NONE || self.is_stale[best as usize] {
                self.is_ranked[v as usize] = true;
                self.refresh_around(v);
                let (w, found) = self.rank(v);
                self.best[v as usize] = w;
                if w == NONE {
                    continue;
                }
                if self.queue.first().is_some_and(|(_, next)| found.key > next) {
                    self.queue.set(id, found.key);
                    continue;
                }
            }
            let w = self.best[v as usize];
            let found = self.candidate(v, w);
            if let Some(shared) = self.check(v, w, &found) {
                self.collapse(v, w, &shared, &found, key);
                if self.target.is_reached(self.rings.vertex_count, self.rings.face_count) {
                    return Ok(());
                }
            } else {
                self.rank_checked(v);
            }
        }
        self.stop = StopReason::NothingLeft;
        Ok(())
    }

    /// Looks for the best edge of `v` that may be collapsed.
    fn rank_checked(&mut self, v: u32) {
        let mut found: Vec<(f64, u32)> = Vec::new();
        self.rings.each_neighbor(v, |w| {
            if self.is_allowed(v, w) {
                found.push((self.candidate(v, w).key, w));
            }
        });
        found.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        for (key, w) in found {
            let candidate = self.candidate(v, w);
            if w != self.best[v as usize] && self.check(v, w, &candidate).is_some() {
                self.best[v as usize] = w;
                self.queue.set(VertexId::new(v as usize), key);
                return;
            }
        }
    }

    /// The triangles that vanish, if the collapse may be done.
    fn check(&mut self, v: u32, w: u32, found: &Candidate) -> Option<Shared> {
        if State::error(found) > self.error_limit {
            self.refusals.error += 1;
            return None;
        }
        let shared = self.rings.shared(v, w);
        self.now += 1;
        if !self.rings.may_collapse(v, w, &shared, &mut self.marks, self.now) {
            self.refusals.topology += 1;
            return None;
        }
        if self.turns_over(v, w, found.position) || self.turns_over(w, v, found.position) {
            self.refusals.flipped += 1;
            return None;
        }
        Some(shared)
    }

    /// Whether a triangle at `v` but not at `other` turns too far when `v` moves to `p`.
    fn turns_over(&self, v: u32, other: u32, p: DVec3) -> bool {
        let positions = &self.rings.positions;
        let limit = self.least_cosine;
        self.rings.ring(v).iter().any(|&f| {
            let [x, y] = self.rings.others(f, v);
            if x == other || y == other {
                return false;
            }
            let (x, y) = (positions[x as usize], positions[y as usize]);
            let before = self.normals[f as usize];
            let after = (x - p).cross(y - p);
            let (was, is) = (before.length_squared(), after.length_squared());
            let cosine = before.dot(after);
            // What had no area may turn as it likes.
            was > 0.0 && (cosine <= 0.0 || cosine * cosine < limit * limit * was * is)
        })
    }

    fn collapse(&mut self, v: u32, w: u32, shared: &Shared, found: &Candidate, key: f64) {
        // The longer ring stays where it is, and what is fixed stays.
        let w_stays = match (self.is_fixed[v as usize], self.is_fixed[w as usize]) {
            (true, _) => false,
            (_, true) => true,
            _ => self.rings.ring_len(w) >= self.rings.ring_len(v),
        };
        let (from, to) = if w_stays { (v, w) } else { (w, v) };
        let position = found.position;
        let ends = [v, w].map(|x| self.rings.positions[x as usize]);
        let held = match ends.iter().position(|&p| p == position) {
            Some(k) => self.held[[v, w][k] as usize],
            None => NONE,
        };
        if self.shares[1] > 0.0 {
            let sum = [v, w].map(|x| {
                self.remembered[x as usize].moved(position - self.rings.positions[x as usize])
            });
            self.remembered[to as usize] = sum[0] + sum[1];
        }
        self.rings.collapse(from, to, shared);
        self.rings.positions[to as usize] = position;
        for k in 0..self.rings.ring_len(to) {
            let f = self.rings.ring(to)[k];
            self.normals[f as usize] = self.normal(f);
            if !self.areas.is_empty() {
                self.areas[f as usize] = self.area(f);
            }
        }
        self.held[to as usize] = held;
        self.parent[from as usize] = to;
        self.collapses += 1;
        self.largest_error = self.largest_error.max(State::error(found));
        if self.keeps_log {
            self.log.push(Done { from, to, held, position });
        }
        self.queue.remove(VertexId::new(from as usize));
        self.touch(to, key);
    }

    /// Has the surroundings of `v` ranked anew.
    fn touch(&mut self, v: u32, key: f64) {
        self.is_stale[v as usize] = true;
        let is_memoryless = self.shares[0] > 0.0;
        for k in 0..self.rings.ring_len(v) {
            let f = self.rings.ring(v)[k];
            for w in self.rings.others(f, v) {
                if !self.is_ranked[w as usize] && self.is_stale[w as usize] == is_memoryless {
                    continue;
                }
                self.is_stale[w as usize] |= is_memoryless;
                self.is_ranked[w as usize] = false;
                let id = VertexId::new(w as usize);
                if self.queue.key(id).is_none() {
                    self.queue.set(id, key);
                }
            }
        }
        self.refresh_around(v);
        let (w, found) = self.rank(v);
        self.is_ranked[v as usize] = true;
        self.best[v as usize] = w;
        let id = VertexId::new(v as usize);
        if w == NONE {
            self.queue.remove(id);
        } else {
            self.queue.set(id, found.key);
        }
    }
}

fn has_data(mesh: &Mesh) -> bool {
    let data = mesh.attributes();
    !(data.vertex.is_empty()
        && data.corner.is_empty()
        && data.edge.is_empty()
        && data.face.is_empty())
}

/// Marks the sides where normals differ by more than `angle`, and seams of data of corners.
fn mark_sharp(rings: &mut Rings, mesh: &Mesh, angle: f64) {
    let mut marked = seam_edges(mesh);
    if angle < PI {
        marked.extend(sharp_edges(mesh, angle).iter());
    }
    for h in marked.iter().flat_map(EdgeId::halfedges) {
        let Some(f) = mesh.face(h) else { continue };
        let (f, v) = (f.index() as u32, mesh.from(h).index() as u32);
        let k = rings.corner(f, v);
        rings.sides[f as usize] |= SHARP << k;
    }
}
