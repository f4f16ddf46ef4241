//! Lines: what is sharp in the input and the rims of its holes, cut at corners.
//!
//! A line is a chain of edges of the input, or a loop of them. A vertex on it is known by the length along the
//! line from its start, so that it can be moved without leaving the line.

use dgp_mesh::{DVec3, EdgeId, EdgeSet, HalfedgeId, Mesh, VertexId, VertexSet};

use super::surface::{Freedom, NONE, Surface, next};

/// A chain of edges of the input.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    points: Vec<DVec3>,
    /// The length from the start to each point.
    at: Vec<f64>,
    /// The vertex it starts from, `NONE` of loops that have no corner.
    start: u32,
    /// Whether its end is its start.
    pub(super) is_loop: bool,
    /// Whether its edges stay as they are.
    pub(super) is_kept: bool,
}

impl Line {
    fn new(points: Vec<DVec3>, start: u32, is_loop: bool, is_kept: bool) -> Self {
        let mut length = 0.0;
        let mut at = Vec::with_capacity(points.len());
        for (i, p) in points.iter().enumerate() {
            length += if i > 0 { p.distance(points[i - 1]) } else { 0.0 };
            at.push(length);
        }
        Line { points, at, start, is_loop, is_kept }
    }

    pub(super) fn length(&self) -> f64 {
        self.at.last().copied().unwrap_or(0.0)
    }

    /// Where the point of this length from the start is.
    pub(super) fn point(&self, along: f64) -> DVec3 {
        let length = self.length();
        let along = if self.is_loop && length > 0.0 {
            along.rem_euclid(length)
        } else {
            along.clamp(0.0, length)
        };
        let i = self.at.partition_point(|&at| at <= along).clamp(1, self.at.len() - 1);
        let (from, to) = (self.at[i - 1], self.at[i]);
        let t = if to > from { (along - from) / (to - from) } else { 0.0 };
        self.points[i - 1].lerp(self.points[i], t)
    }

    /// How far it is along the line from `a` to `b`; on a loop the shorter way.
    pub(super) fn way(&self, a: f64, b: f64) -> f64 {
        let way = b - a;
        let length = self.length();
        if !self.is_loop || !(length > 0.0) {
            return way;
        }
        let way = way.rem_euclid(length);
        if way > 0.5 * length { way - length } else { way }
    }
}

/// Where vertex `v`, which is on `line`, is along it.
pub(super) fn along(surface: &Surface, line: &Line, v: u32) -> f64 {
    let vertex = surface.vertex(v);
    match vertex.freedom {
        Freedom::Line => vertex.along,
        _ if line.is_loop || line.start == v => 0.0,
        _ => line.length(),
    }
}

/// What lines and corners are made of.
pub(super) struct Sharp<'a> {
    pub(super) features: &'a EdgeSet,
    pub(super) fixed: &'a VertexSet,
    pub(super) keeps_rims: bool,
    /// Lines that turn by more than this have a corner there, in radians.
    pub(super) corner_angle: f64,
    /// The distance on either side over which they must turn.
    pub(super) reach: f64,
}

impl Sharp<'_> {
    fn is_line(&self, mesh: &Mesh, e: EdgeId) -> bool {
        self.features.contains(e) || mesh.is_boundary_edge(e)
    }
}

/// Finds the lines, marks their edges in `surface`, and tells its vertices how they may move.
pub(super) fn find(mesh: &Mesh, surface: &mut Surface, sharp: &Sharp<'_>) -> Vec<Line> {
    let count = |v: VertexId| mesh.vertex_edges(v).filter(|&e| sharp.is_line(mesh, e)).count();
    let mut is_corner: VertexSet = sharp.fixed.iter().collect();
    let mut on_line = Vec::new();
    for v in mesh.vertices() {
        let lines = count(v);
        if lines > 0 {
            on_line.push(v);
        }
        if !matches!(lines, 0 | 2) || (sharp.keeps_rims && mesh.is_boundary_vertex(v)) {
            is_corner.insert(v);
        }
    }
    // Chains between those, then loops without any, are searched for turns; these cut them once more.
    for chain in chains(mesh, sharp, &is_corner, &on_line) {
        turns(&chain, surface, sharp, &mut is_corner);
    }
    let mut lines = Vec::new();
    for chain in chains(mesh, sharp, &is_corner, &on_line) {
        let number = lines.len() as u32;
        let points = chain.iter().map(|&(v, _)| surface.positions[v.index()]).collect();
        let (first, last) = (chain[0].0, chain[chain.len() - 1].0);
        let is_rim = chain[0].1.is_some_and(|h| mesh.is_boundary_edge(h.edge()));
        let start = if is_corner.contains(first) { first.index() as u32 } else { NONE };
        let line = Line::new(points, start, first == last, is_rim && sharp.keeps_rims);
        for (i, &(v, _)) in chain.iter().enumerate() {
            if !is_corner.contains(v) && (i > 0 || start == NONE) && i + 1 < chain.len() {
                let vertex = &mut surface.vertices[v.index()];
                vertex.freedom = Freedom::Line;
                vertex.line = number;
                vertex.along = line.at[i];
            }
        }
        for h in chain.iter().filter_map(|&(_, h)| h) {
            mark(mesh, surface, h, number);
        }
        lines.push(line);
    }
    for v in is_corner.iter().filter(|v| v.index() < mesh.vertex_count()) {
        surface.vertices[v.index()].freedom = Freedom::Fixed;
        if mesh.is_isolated_vertex(v) {
            continue;
        }
        surface.vertices[v.index()].wanted = wanted_at_corner(surface, v.index() as u32);
    }
    lines
}

/// A vertex of a chain, and the half-edge to the next one.
type Step = (VertexId, Option<HalfedgeId>);

/// All chains of lines between corners, then the loops without a corner, whose last vertex is their first.
fn chains(
    mesh: &Mesh,
    sharp: &Sharp<'_>,
    is_corner: &VertexSet,
    on_line: &[VertexId],
) -> Vec<Vec<Step>> {
    let mut is_done = EdgeSet::new();
    let mut chains = Vec::new();
    for wants_corner in [true, false] {
        for &start in on_line.iter().filter(|&&v| is_corner.contains(v) == wants_corner) {
            for first in mesh.vertex_halfedges(start) {
                if !sharp.is_line(mesh, first.edge()) || !is_done.insert(first.edge()) {
                    continue;
                }
                let mut chain = vec![(start, Some(first))];
                let mut at = mesh.to(first);
                while at != start && !is_corner.contains(at) {
                    let is_next = |h: &HalfedgeId| {
                        sharp.is_line(mesh, h.edge()) && !is_done.contains(h.edge())
                    };
                    let Some(h) = mesh.vertex_halfedges(at).find(is_next) else { break };
                    is_done.insert(h.edge());
                    chain.push((at, Some(h)));
                    at = mesh.to(h);
                }
                chain.push((at, None));
                chains.push(chain);
            }
        }
    }
    chains
}

/// Puts the vertices into `corners` at which a chain turns by too much, both from edge to edge and over some distance.
fn turns(chain: &[Step], surface: &Surface, sharp: &Sharp<'_>, corners: &mut VertexSet) {
    let at = |i: usize| surface.positions[chain[i].0.index()];
    let last = chain.len() - 1;
    let is_loop = chain[0].0 == chain[last].0;
    let limit = sharp.corner_angle.cos();
    let turns = |a: DVec3, b: DVec3, c: DVec3| {
        let (u, v) = ((b - a).normalize_or_zero(), (c - b).normalize_or_zero());
        u.dot(v) < limit
    };
    // The point that is `reach` away, or the end.
    let reached = |i: usize, forward: bool| {
        let (mut left, mut k) = (sharp.reach, i);
        loop {
            let to = match (forward, is_loop) {
                (true, true) => (k + 1) % last,
                (false, true) => (k + last - 1) % last,
                (true, false) if k < last => k + 1,
                (false, false) if k > 0 => k - 1,
                _ => return at(k),
            };
            let step = at(k).distance(at(to));
            if step >= left || to == i {
                return at(k).lerp(at(to), if step > 0.0 { (left / step).min(1.0) } else { 1.0 });
            }
            left -= step;
            k = to;
        }
    };
    let range = if is_loop { 0..last } else { 1..last };
    for i in range {
        let [before, after] =
            if is_loop { [(i + last - 1) % last, (i + 1) % last] } else { [i - 1, i + 1] };
        if turns(at(before), at(i), at(after)) && turns(reached(i, false), at(i), reached(i, true))
        {
            corners.insert(chain[i].0);
        }
    }
}

/// Notes that `line` runs along `h`.
fn mark(mesh: &Mesh, surface: &mut Surface, h: HalfedgeId, line: u32) {
    for side in [h, h.twin()] {
        if let Some(f) = mesh.face(side) {
            let v = mesh.from(side).index() as u32;
            let k = surface.triangles[f.index()].from.iter().position(|&w| w == v).unwrap_or(0);
            surface.set_line((4 * f.index() + k) as u32, line);
        }
    }
}

/// How many edges a corner should have: so many that the angles between them are about 60° between lines.
fn wanted_at_corner(surface: &Surface, v: u32) -> u32 {
    let p = surface.position(v);
    let starts_inside = !surface.vertex(v).on_rim && surface.line(surface.vertex(v).spoke) == NONE;
    let (mut angle, mut whole, mut first) = (0.0, 0.0, None);
    for (i, h) in surface.spokes(v).enumerate() {
        if surface.line(h) != NONE && i > 0 {
            // What comes before the first line joins what comes after the last.
            if starts_inside && first.is_none() {
                first = Some(whole);
            } else {
                angle += count(whole);
            }
            whole = 0.0;
        }
        let (q, r) = (surface.position(surface.to(h)), surface.position(surface.to(next(h))));
        whole += (q - p).angle_between(r - p);
    }
    angle += count(whole + first.unwrap_or(0.0));
    angle as u32 + u32::from(surface.vertex(v).on_rim)
}

fn count(angle: f64) -> f64 {
    let parts = angle / std::f64::consts::FRAC_PI_3;
    if parts.is_finite() { parts.round().max(1.0) } else { 1.0 }
}
