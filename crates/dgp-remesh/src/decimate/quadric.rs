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
    Cancelled, Connectivity, DVec3, EdgeId, Editor, FaceId, FaceMap, Mesh, Progress, VertexId,
    VertexMap, VertexSet, graph::IndexedHeap, measure::bounding_box, parallel,
};

use super::{
    edge::{Candidate, Ends, Through, fence},
    generic::{seam_edges, sharp_edges},
    report::{DecimationReport, Refusals, StopReason, Target},
    rings::{NONE, RIM, Rings, SHARP, Shared},
};
use crate::{
    Error,
    quadric::{Quadric, outer},
};

/// How [`decimate_quadric`] chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricOptions {
    /// Where the vertex of a collapsed edge goes.
    pub placement: Placement,
    /// Which planes count.
    pub memory: Memory,
    /// What happens to rims of holes.
    pub boundary: Boundary,
    /// How much planes through rims count against planes of triangles.
    pub boundary_weight: f64,
    /// Edges between faces that meet at a larger angle of their normals, in radians, are kept sharp; π for none.
    pub feature_angle: f64,
    /// How much planes through sharp edges count.
    pub feature_weight: f64,
    /// The largest angle a triangle may turn by in one collapse, in radians.
    pub largest_turn: f64,
    /// How strongly points are kept near the middle of the edge where planes leave them free.
    pub damping: f64,
    /// Whether vertices go where the volume stays the same.
    pub volume: Volume,
    /// How much the squared length of an edge counts, so that among collapses without error short edges come
    /// first.
    pub length_weight: f64,
}

impl Default for QuadricOptions {
    fn default() -> Self {
        QuadricOptions {
            placement: Placement::Optimal,
            memory: Memory::Memoryless,
            boundary: Boundary::Weighted,
            boundary_weight: 1.0,
            feature_angle: PI,
            feature_weight: 1.0,
            largest_turn: 75_f64.to_radians(),
            damping: 1e-4,
            length_weight: 1e-9,
            volume: Volume::Kept,
        }
    }
}

/// Where the vertex of a collapsed edge goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// Where the quadric is least.
    Optimal,
    /// To the better end: all vertices of the result are ones of the input.
    Ends,
}

/// Whether a collapse may change the volume inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Volume {
    /// The best point of those that leave the volume as it is: surfaces stay on both sides of the input.
    Kept,
    /// The best point: round surfaces grow a little.
    Free,
}

/// Which planes count in the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory {
    /// Those of the present triangles.
    Memoryless,
    /// Those of all triangles of the input that were merged.
    Kept,
    /// Those of the present triangles, and this much of the input's.
    Blend(f64),
}

/// What happens to rims of holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// They are kept in shape by planes.
    Weighted,
    /// Their vertices stay.
    Kept,
}

/// Decimates triangles toward `target`; vertices of `fixed` stay where they are.
///
/// Data travel: see [`Editor::collapse_at`]. A cancelled run leaves a valid mesh, decimated part of the way.
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
    held: u32,
    pub(crate) position: DVec3,
}

struct State {
    options: QuadricOptions,
    target: Target,
    rings: Rings,
    frame: Frame,
    /// The normal of each triangle times the root of its weight.
    normals: Vec<DVec3>,
    /// Twice the vector areas of triangles, and their sums around each vertex; empty if volumes are free.
    areas: Vec<DVec3>,
    around: Vec<DVec3>,
    /// The planes of the present triangles around each vertex.
    through: Vec<Through>,
    /// Planes of the input, relative to the vertex.
    remembered: Vec<Quadric>,
    is_stale: Vec<bool>,
    is_fixed: Vec<bool>,
    /// The vertex of the input whose position a vertex has, `NONE` if it is a new one.
    held: Vec<u32>,
    parent: Vec<u32>,
    queue: IndexedHeap<VertexId>,
    best: Vec<u32>,
    is_ranked: Vec<bool>,
    marks: Vec<u32>,
    now: u32,
    keeps_log: bool,
    log: Vec<Done>,
    collapses: usize,
    largest_error: f64,
    refusals: Refusals,
    start: [usize; 2],
    stop: StopReason,
    /// Shares of the present and the remembered planes.
    shares: [f64; 2],
    least_cosine: f64,
    error_limit: f64,
}

/// Coordinates about the center in units of a power of two, so that squares neither overflow nor vanish.
#[derive(Clone, Copy)]
struct Frame {
    center: DVec3,
    unit: f64,
}

impl Frame {
    fn new(mesh: &Mesh) -> Self {
        let Some(bounds) = bounding_box(mesh) else {
            return Frame { center: DVec3::ZERO, unit: 1.0 };
        };
        let center = 0.5 * bounds.min + 0.5 * bounds.max;
        let size = (0.5 * bounds.max - 0.5 * bounds.min).max_element();
        let unit = if size > 0.0 { 2_f64.powi(exponent(size)) } else { 1.0 };
        Frame { center, unit }
    }

    fn inside(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.unit
    }

    /// Where a vertex is that holds the position of `held`, or else is at `p` inside.
    fn position(&self, mesh: &Mesh, held: u32, p: DVec3) -> DVec3 {
        match held {
            NONE => p * self.unit + self.center,
            held => mesh.position(VertexId::new(held as usize)),
        }
    }
}

/// The exponent of 2 in `x`, kept where its reciprocal is a number too.
fn exponent(x: f64) -> i32 {
    (((x.to_bits() >> 52) & 0x7ff) as i32 - 1023).clamp(-1021, 1021)
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
            if turns % 4096 == 0 {
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

    /// Puts what is left into `mesh`.
    fn give_back(mut self, mesh: &mut Mesh) -> Result<DecimationReport, Error> {
        let n = self.parent.len();
        // Whom a vertex was merged into comes to where that one came in the end.
        let mut number = vec![NONE; n];
        let mut kept = Vec::with_capacity(self.rings.vertex_count);
        for v in 0..n as u32 {
            if self.parent[v as usize] == v {
                number[v as usize] = kept.len() as u32;
                kept.push(v);
            }
        }
        let final_position = |v: u32| {
            self.frame.position(mesh, self.held[v as usize], self.rings.positions[v as usize])
        };
        let positions: Vec<DVec3> = kept.iter().map(|&v| final_position(v)).collect();
        for v in 0..n as u32 {
            let mut root = v;
            while self.parent[root as usize] != root {
                root = self.parent[root as usize];
            }
            let mut walk = v;
            while self.parent[walk as usize] != root {
                walk = std::mem::replace(&mut self.parent[walk as usize], root);
            }
        }
        let root = |v: VertexId| number[self.parent[v.index()] as usize] as usize;
        let vertex_map = VertexMap::from_fn(n, |v| VertexId::new(root(v)));
        let mut face_map = FaceMap::filled(self.rings.faces.len(), None);
        for (new, (old, _)) in self.rings.left().enumerate() {
            face_map[old] = Some(FaceId::new(new));
        }
        let report = DecimationReport {
            vertices: [n, kept.len()],
            faces: [self.start[1], self.rings.face_count],
            collapses: self.collapses,
            largest_error: self.largest_error * self.frame.unit,
            stop: self.stop,
            refusals: self.refusals,
            vertex_map,
            face_map,
        };
        if self.keeps_log {
            self.replay(mesh);
            mesh.set_positions(positions.into());
        } else {
            let list = self.rings.face_list(|v| VertexId::new(number[v as usize] as usize));
            let connectivity = Connectivity::from_faces(kept.len(), &list)?;
            *mesh = Mesh::from_parts(connectivity, positions.into());
        }
        Ok(report)
    }

    /// Does the collapses again where data travel.
    fn replay(&self, mesh: &mut Mesh) {
        let mut editor = Editor::new(mesh);
        for done in &self.log {
            let [from, to] = [done.from, done.to].map(|v| VertexId::new(v as usize));
            let h =
                editor.mesh().halfedge_between(from, to).expect("the same edges as in the rings");
            let position = self.frame.position(editor.mesh(), NONE, done.position);
            editor.collapse_at(h, position).expect("the same conditions as in the rings");
        }
        let _ = editor.finish();
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
