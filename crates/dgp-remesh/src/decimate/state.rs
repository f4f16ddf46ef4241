//! What decimation by quadrics knows while it runs: triangles, planes around vertices, what was done.

use std::f64::consts::PI;

use dgp_mesh::{
    Cancelled, DVec3, EdgeId, FaceId, Mesh, Progress, VertexId, VertexSet, measure::bounding_box,
    parallel,
};

use super::{
    channels::Channels,
    edge::{Candidate, Ends, Through, fence},
    frame::Frame,
    generic::{seam_edges, sharp_edges},
    options::{Boundary, Memory, Order, Placement, QuadricOptions, Volume},
    quadric::Done,
    report::{Refusals, StopReason, Target},
    rings::{NONE, RIM, Rings, SHARP, Shared},
};
use crate::{
    Error,
    quadric::{Quadric, outer},
};

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
    /// Data that count as dimensions.
    pub(super) channels: Option<Channels>,
    pub(super) is_stale: Vec<bool>,
    pub(super) is_fixed: Vec<bool>,
    /// The vertex of the input whose position a vertex has, `NONE` if it is a new one.
    pub(super) held: Vec<u32>,
    pub(super) parent: Vec<u32>,
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
    pub(super) fn new(
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
            channels: None,
            is_stale: vec![false; n],
            is_fixed,
            held: (0..n as u32).collect(),
            parent: (0..n as u32).collect(),
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
        state.sum_up(mesh);
        progress.report(1.0)?;
        Ok(state)
    }

    /// Planes, areas and data around all vertices of the input.
    fn sum_up(&mut self, mesh: &Mesh) {
        let (n, f_count) = (mesh.vertex_count(), mesh.face_count());
        self.normals =
            parallel::map(f_count, |f: FaceId| self.normal(f.index() as u32)).into_values();
        if self.options.volume == Volume::Kept {
            self.areas =
                parallel::map(f_count, |f: FaceId| self.area(f.index() as u32)).into_values();
            self.around =
                parallel::map(n, |v: VertexId| self.around(v.index() as u32)).into_values();
        }
        let own: Vec<Through> =
            parallel::map(n, |v: VertexId| self.present(v.index() as u32)).into_values();
        let [present, share] = self.shares;
        if share > 0.0 {
            let of = |a: &Through| Quadric { a: a.map(|x| x * share), ..Quadric::ZERO };
            self.remembered = own.iter().map(of).collect();
        }
        self.through = own;
        if present == 0.0 {
            self.through.fill([0.0; 6]);
        }
        if self.options.attribute_weight > 0.0 {
            let size = bounding_box(mesh).map_or(0.0, |bounds| bounds.diagonal() / self.frame.unit);
            let scale = self.options.attribute_weight * size;
            self.channels = Channels::new(mesh, &self.rings, scale);
        }
        if let Some(channels) = &mut self.channels {
            for v in 0..n as u32 {
                channels.refresh(&self.rings, &self.normals, v);
            }
        }
    }

    /// Collapses edges until the target is reached or nothing is left.
    pub(super) fn run(&mut self, progress: Progress<'_>) -> Result<(), Cancelled> {
        match self.options.order {
            Order::Best => self.run_best_first(progress),
            Order::Passes => self.run_passes(progress),
        }
    }

    /// Twice the vector area of `f`.
    #[inline]
    pub(super) fn area(&self, f: u32) -> DVec3 {
        let [p, q, r] = self.rings.faces[f as usize].map(|v| self.rings.positions[v as usize]);
        (q - p).cross(r - p)
    }

    /// The normal of `f` times the root of its weight.
    #[inline]
    pub(super) fn normal(&self, f: u32) -> DVec3 {
        let area = self.area(f);
        let square = area.length_squared();
        // |N|^(3/4): between the area (Hoppe) and its square (Lindstrom and Turk).
        if square > 0.0 { area / square.sqrt().sqrt().sqrt() } else { DVec3::ZERO }
    }

    /// Twice the vector area of the triangles around `v`.
    #[inline]
    pub(super) fn around(&self, v: u32) -> DVec3 {
        self.rings.ring(v).iter().map(|&f| self.areas[f as usize]).sum()
    }

    /// The planes of the present triangles around `v`.
    #[inline]
    pub(super) fn present(&self, v: u32) -> Through {
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

    /// Whether what is known of a vertex depends on the present triangles around it.
    pub(super) fn is_memoryless(&self) -> bool {
        self.shares[0] > 0.0 || self.channels.is_some()
    }

    #[inline]
    pub(super) fn refresh(&mut self, v: u32) {
        if self.is_stale[v as usize] {
            self.is_stale[v as usize] = false;
            if !self.around.is_empty() {
                self.around[v as usize] = self.around(v);
            }
            if self.shares[0] > 0.0 {
                self.through[v as usize] = self.present(v);
            }
            if let Some(channels) = &mut self.channels {
                channels.refresh(&self.rings, &self.normals, v);
            }
        }
    }

    /// The collapse of the edge between `v` and `w`.
    #[inline]
    pub(super) fn candidate(&self, v: u32, w: u32) -> Candidate {
        let positions = &self.rings.positions;
        let (i, j) = (v as usize, w as usize);
        let ends = Ends {
            a: positions[i],
            b: positions[j],
            through: [&self.through[i], &self.through[j]],
            remembered: (!self.remembered.is_empty())
                .then(|| [&self.remembered[i], &self.remembered[j]]),
            data: self.channels.as_ref().map(|channels| {
                channels.quadric(&self.rings, &self.normals, [v, w], positions[j] - positions[i])
            }),
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

    pub(super) fn error(candidate: &Candidate) -> f64 {
        if candidate.cost > 0.0 { (candidate.cost / candidate.weight).sqrt() } else { 0.0 }
    }

    /// Whether the collapse is one to think of at all.
    #[inline]
    pub(super) fn is_allowed(&self, v: u32, w: u32) -> bool {
        w > v && !(self.is_fixed[v as usize] && self.is_fixed[w as usize])
    }

    /// The best edge from `v` to a vertex of a larger number. Quadrics are fresh.
    pub(super) fn rank(&self, v: u32) -> (u32, Candidate) {
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

    pub(super) fn refresh_around(&mut self, v: u32) {
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

    /// The triangles that vanish, if the collapse may be done.
    pub(super) fn check(&mut self, v: u32, w: u32, found: &Candidate) -> Option<Shared> {
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
    pub(super) fn turns_over(&self, v: u32, other: u32, p: DVec3) -> bool {
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

    /// Does the collapse; returns the vertex that goes and the one that stays.
    pub(super) fn collapse(
        &mut self,
        v: u32,
        w: u32,
        shared: &Shared,
        found: &Candidate,
    ) -> (u32, u32) {
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
        if let Some(channels) = &mut self.channels {
            channels.merge(&self.rings, &self.normals, [v, w], position - ends[0]);
        }
        self.rings.collapse(from, to, shared);
        self.rings.positions[to as usize] = position;
        self.measure_around(to);
        self.held[to as usize] = held;
        self.parent[from as usize] = to;
        self.collapses += 1;
        self.largest_error = self.largest_error.max(State::error(found));
        if self.keeps_log {
            self.log.push(Done { from, to, held, position });
        }
        (from, to)
    }

    /// Measures the triangles around `v` anew.
    pub(super) fn measure_around(&mut self, v: u32) {
        for k in 0..self.rings.ring_len(v) {
            let f = self.rings.ring(v)[k];
            self.normals[f as usize] = self.normal(f);
            if !self.areas.is_empty() {
                self.areas[f as usize] = self.area(f);
            }
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
