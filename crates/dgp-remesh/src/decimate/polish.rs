//! The last step of decimation by quadrics: vertices move along their normals to where the points of the input are
//! nearest.
//!
//! ```text
//! min over τ  Σ over points q near v  ω (r_q − τ β_q n_v·n_f)²      r_q = n_f · (q − nearest point of its face f)
//! ```
//!
//! β is the weight of v in the nearest point. Vertices take turns; then nearest points are looked for again.
//!
//! - Input: what collapses have left, and where each vertex of the input went.
//! - Cost: some tens of triangles for each vertex of the input and round.
//! - Guarantees: rims, sharp edges, seams and fixed vertices stay; no triangle turns by more than `largest_turn`.
//!   The same bits for any number of threads.
//! - Reference: Hoppe, DeRose, Duchamp, McDonald, Stuetzle, "Mesh optimization", SIGGRAPH 1993 (the fit of
//!   positions for given triangles).
//! - Departs from it: vertices move along their normals only, one after the other; points far away count more,
//!   so that the largest distance shrinks as well as the mean one.

use dgp_mesh::{Cancelled, DVec3, Mesh, Progress, VertexId, parallel};

use super::{
    options::Placement,
    report::Target,
    rings::{NONE, SHARP},
    state::State,
    triangle::nearest_weights,
};

/// How often each vertex moves before nearest points are looked for again.
const SWEEPS: usize = 2;
/// How many rings a point may be looked for away from where it went.
const HOPS: usize = 8;
/// How much a vertex is held back, in points.
const INERTIA: f64 = 0.25;

/// A point of the input at the result.
#[derive(Clone, Copy)]
struct Near {
    face: u32,
    weights: [f64; 3],
    /// How far it is above the face.
    height: f64,
}

/// Points of the input, listed by the face they are nearest to.
struct Points {
    starts: Vec<u32>,
    near: Vec<Near>,
}

impl State {
    /// Moves vertices as often as the options say.
    pub(super) fn polish(&mut self, mesh: &Mesh, progress: Progress<'_>) -> Result<(), Cancelled> {
        let rounds = self.options.polish;
        let is_free = self.options.placement == Placement::Optimal;
        // An error that was asked for is one of collapses.
        if !is_free || self.collapses == 0 || matches!(self.target, Target::Error(_)) {
            return Ok(());
        }
        let roots = self.roots();
        let free: Vec<u32> = (0..roots.len() as u32).filter(|&v| self.is_free(v)).collect();
        for round in 0..rounds {
            progress.report(round as f64 / rounds as f64)?;
            let mut points = self.points(mesh, &roots);
            for _ in 0..SWEEPS {
                for &v in &free {
                    self.fit(v, &mut points);
                }
            }
        }
        Ok(())
    }

    /// Where each vertex of the input went.
    fn roots(&self) -> Vec<u32> {
        let mut roots = self.parent.clone();
        for v in 0..roots.len() as u32 {
            let mut root = v;
            while roots[root as usize] != root {
                root = roots[root as usize];
            }
            let mut walk = v;
            while roots[walk as usize] != root {
                walk = std::mem::replace(&mut roots[walk as usize], root);
            }
        }
        roots
    }

    fn is_free(&self, v: u32) -> bool {
        let rings = &self.rings;
        let is_sharp = |&f: &u32| {
            let k = rings.corner(f, v);
            [k, (k + 2) % 3].iter().any(|&side| rings.sides[f as usize] & (SHARP << side) != 0)
        };
        self.parent[v as usize] == v
            && rings.ring_len(v) > 0
            && !self.is_fixed[v as usize]
            && !rings.on_rim[v as usize]
            && !rings.ring(v).iter().any(is_sharp)
    }

    fn points(&self, mesh: &Mesh, roots: &[u32]) -> Points {
        let of = |v: VertexId| {
            let root = roots[v.index()];
            (self.rings.ring_len(root) > 0)
                .then(|| self.nearest(self.frame.inside(mesh.position(v)), root))
        };
        let found = parallel::map(roots.len(), of).into_values();
        // Counting sort by face.
        let mut starts = vec![0_u32; self.rings.faces.len() + 1];
        for near in found.iter().flatten() {
            starts[near.face as usize + 1] += 1;
        }
        for f in 1..starts.len() {
            starts[f] += starts[f - 1];
        }
        let nothing = Near { face: NONE, weights: [0.0; 3], height: 0.0 };
        let mut near = vec![nothing; starts[starts.len() - 1] as usize];
        let mut next = starts.clone();
        for point in found.iter().flatten() {
            near[next[point.face as usize] as usize] = *point;
            next[point.face as usize] += 1;
        }
        Points { starts, near }
    }

    /// Where `p` is nearest, going from ring to ring.
    fn nearest(&self, p: DVec3, root: u32) -> Near {
        let mut best = (f64::INFINITY, NONE, [0.0; 3], DVec3::ZERO);
        let mut center = root;
        for _ in 0..HOPS {
            for &f in self.rings.ring(center) {
                let corners = self.rings.faces[f as usize];
                let [a, b, c] = corners.map(|v| self.rings.positions[v as usize]);
                let weights = nearest_weights(p, [a, b, c]);
                let away = p - (a * weights[0] + b * weights[1] + c * weights[2]);
                let square = away.length_squared();
                if square < best.0 {
                    best = (square, f, weights, away);
                }
            }
            if best.1 == NONE {
                break;
            }
            // On to the corner that is nearest.
            let k = (0..3).max_by(|&i, &j| best.2[i].total_cmp(&best.2[j])).unwrap_or(0);
            let next = self.rings.faces[best.1 as usize][k];
            if next == center {
                break;
            }
            center = next;
        }
        let face = if best.1 == NONE { self.rings.ring(root)[0] } else { best.1 };
        let normal = self.normals[face as usize].normalize_or_zero();
        let height = best.3.dot(normal);
        Near { face, weights: best.2, height }
    }

    /// Moves `v` to where the points around it are nearest.
    fn fit(&mut self, v: u32, points: &mut Points) {
        let rings = &self.rings;
        let normal: DVec3 = rings.ring(v).iter().map(|&f| self.area(f)).sum();
        let normal = normal.normalize_or_zero();
        let mut largest = 0.0_f64;
        for &f in rings.ring(v) {
            for near in &points.near[points.range(f)] {
                largest = largest.max(near.height.abs());
            }
        }
        if !(largest > 0.0) {
            return;
        }
        let (mut pull, mut stiffness) = (0.0, INERTIA);
        for &f in rings.ring(v) {
            let slope = normal.dot(self.normals[f as usize].normalize_or_zero());
            let k = rings.corner(f, v);
            for near in &points.near[points.range(f)] {
                let share = near.height / largest;
                let weight = 0.1 + share * share;
                let lever = near.weights[k] * slope;
                pull += weight * lever * near.height;
                stiffness += weight * lever * lever;
            }
        }
        let step = pull / stiffness;
        let position = rings.positions[v as usize] + normal * step;
        if !position.is_finite() || step == 0.0 || self.turns_over(v, NONE, position) {
            return;
        }
        for &f in rings.ring(v) {
            let slope = normal.dot(self.normals[f as usize].normalize_or_zero());
            let k = rings.corner(f, v);
            let range = points.range(f);
            for near in &mut points.near[range] {
                near.height -= step * near.weights[k] * slope;
            }
        }
        self.rings.positions[v as usize] = position;
        self.held[v as usize] = NONE;
        self.measure_around(v);
    }
}

impl Points {
    fn range(&self, f: u32) -> std::ops::Range<usize> {
        self.starts[f as usize] as usize..self.starts[f as usize + 1] as usize
    }
}
