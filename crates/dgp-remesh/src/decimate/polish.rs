//! The last step of decimation by quadrics: vertices move along their normals to where the input is nearest.
//!
//! ```text
//! min over τ  Σ over centers q of input faces near v  ω A_q (r_q − τ β_q n_v·n_f)²  +  ω_v (r_v − τ)²
//! r_q = n_f · (q − nearest point of its face f)      r_v = n_v · (nearest point of the input − v)
//! ω   = 1 + (|r| / 5σ − 1)₊²                         ω_v = 2 (|r_v| / 5σ − 1)₊² Σ A_q
//! ```
//!
//! β is the weight of v in the nearest point, σ the root mean square of all r_q. Centers and not vertices of
//! the input are what the surface is fitted to, for where it bends its vertices lie on one side of it. What is
//! farther than 5σ counts more, so that the largest distance shrinks as well. Vertices take turns; then nearest
//! points are looked for again.
//!
//! - Input: what collapses have left, and where each vertex of the input went.
//! - Cost: some tens of triangles for each face of the input and round.
//! - Guarantees: rims, sharp edges, seams and fixed vertices stay; no triangle turns by more than `largest_turn`.
//!   The same bits for any number of threads.
//! - Reference: Hoppe, DeRose, Duchamp, McDonald, Stuetzle, "Mesh optimization", SIGGRAPH 1993 (the fit of
//!   positions for given triangles).
//! - Departs from it: vertices move along their normals only, so that triangles and data stay where they are; nearest
//!   points are looked for around where a face went instead of everywhere.

use dgp_mesh::{Cancelled, DVec3, FaceId, Mesh, Progress, VertexId, parallel};

use super::{
    options::Placement,
    report::Target,
    rings::{NONE, SHARP},
    state::State,
    triangle::{nearest_point, nearest_weights},
};

/// How often each vertex moves before nearest points are looked for again.
const SWEEPS: usize = 2;
/// How many rings a point may be looked for away from where it went.
const HOPS: usize = 8;
/// How much a vertex is held back, in centers of usual area.
const INERTIA: f64 = 0.25;
/// The most a vertex moves at a time, of the largest distance around it: more overshoots where few centers are near.
const STRIDE: f64 = 0.5;
/// What is farther than so many σ counts more. With 3 the mean distance of parts with fillets grew by 7%.
const FAR: f64 = 5.0;
/// How much the distance from a vertex to the input counts against all around it, where it is far.
const BACK: f64 = 2.0;

/// The center of a face of the input at the result.
#[derive(Clone, Copy)]
struct Near {
    face: u32,
    weights: [f64; 3],
    /// How far it is above the face.
    height: f64,
    /// Twice the area it stands for.
    area: f64,
}

/// Centers of the faces of the input, listed by the face of the result they are nearest to.
struct Samples {
    starts: Vec<u32>,
    near: Vec<Near>,
    /// How far the input is above each vertex.
    back: Vec<f64>,
    /// From where on a distance is far.
    limit: f64,
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
            let mut samples = self.samples(mesh, &roots);
            for _ in 0..SWEEPS {
                for &v in &free {
                    self.fit(v, &mut samples);
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

    fn samples(&self, mesh: &Mesh, roots: &[u32]) -> Samples {
        let found = parallel::map(mesh.face_count(), |f: FaceId| {
            let corners = mesh.triangle(f)?;
            let [a, b, c] = corners.map(|v| self.frame.inside(mesh.position(v)));
            let root = roots[corners[0].index()];
            let area = (b - a).cross(c - a).length();
            (area > 0.0).then(|| Near { area, ..self.nearest((a + b + c) / 3.0, root) })
        });
        let found = found.into_values();
        // Counting sort by face.
        let mut starts = vec![0_u32; self.rings.faces.len() + 1];
        for near in found.iter().flatten() {
            starts[near.face as usize + 1] += 1;
        }
        for f in 1..starts.len() {
            starts[f] += starts[f - 1];
        }
        let nothing = Near { face: NONE, weights: [0.0; 3], height: 0.0, area: 0.0 };
        let mut near = vec![nothing; starts[starts.len() - 1] as usize];
        let mut next = starts.clone();
        for sample in found.iter().flatten() {
            near[next[sample.face as usize] as usize] = *sample;
            next[sample.face as usize] += 1;
        }
        let squares: f64 = near.iter().map(|near| near.area * near.height * near.height).sum();
        let mass: f64 = near.iter().map(|near| near.area).sum();
        let limit = FAR * (squares / mass).sqrt();
        Samples { starts, near, back: self.back(mesh, roots), limit }
    }

    /// How far the input is above each vertex, along its normal.
    fn back(&self, mesh: &Mesh, roots: &[u32]) -> Vec<f64> {
        let n = roots.len();
        let mut best: Vec<(f64, u32)> = vec![(f64::INFINITY, NONE); n];
        for v in mesh.vertices() {
            let root = roots[v.index()];
            let p = self.rings.positions[root as usize];
            let square = p.distance_squared(self.frame.inside(mesh.position(v)));
            let slot = &mut best[root as usize];
            if square < slot.0 {
                *slot = (square, v.index() as u32);
            }
        }
        let of = |v: VertexId| {
            let (mut square, near) = best[v.index()];
            if near == NONE || self.rings.ring_len(v.index() as u32) == 0 {
                return 0.0;
            }
            let p = self.rings.positions[v.index()];
            let near = VertexId::new(near as usize);
            let mut away = self.frame.inside(mesh.position(near)) - p;
            for f in mesh.vertex_faces(near) {
                let Some(corners) = mesh.triangle(f) else { continue };
                let corners = corners.map(|v| self.frame.inside(mesh.position(v)));
                let to = nearest_point(p, corners) - p;
                if to.length_squared() < square {
                    square = to.length_squared();
                    away = to;
                }
            }
            away.dot(self.normal_at(v.index() as u32))
        };
        parallel::map(n, of).into_values()
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
        // A vertex that is left has faces, for what had none was merged into nothing.
        let face = if best.1 == NONE { self.rings.ring(root)[0] } else { best.1 };
        let normal = self.normals[face as usize].normalize_or_zero();
        let height = best.3.dot(normal);
        Near { face, weights: best.2, height, area: 0.0 }
    }

    /// Moves `v` to where what is around it is nearest.
    fn fit(&mut self, v: u32, samples: &mut Samples) {
        let rings = &self.rings;
        let normal = self.normal_at(v);
        let outlier = |r: f64| (r.abs() / samples.limit - 1.0).max(0.0).powi(2);
        let back = samples.back[v as usize];
        let (mut largest, mut mass, mut count) = (back.abs(), 0.0, 0);
        let (mut pull, mut stiffness) = (0.0, 0.0);
        for &f in rings.ring(v) {
            let slope = normal.dot(self.normals[f as usize].normalize_or_zero());
            let k = rings.corner(f, v);
            for near in &samples.near[samples.range(f)] {
                let weight = near.area * (1.0 + outlier(near.height));
                let lever = near.weights[k] * slope;
                pull += weight * lever * near.height;
                stiffness += weight * lever * lever;
                largest = largest.max(near.height.abs());
                mass += near.area;
                count += 1;
            }
        }
        if count == 0 || !(largest > 0.0) {
            return;
        }
        let own = BACK * mass * outlier(back);
        pull += own * back;
        stiffness += own + INERTIA * mass / f64::from(count);
        let step = (pull / stiffness).clamp(-STRIDE * largest, STRIDE * largest);
        let position = rings.positions[v as usize] + normal * step;
        if !position.is_finite() || step == 0.0 || self.turns_over(v, NONE, position) {
            return;
        }
        for &f in rings.ring(v) {
            let slope = normal.dot(self.normals[f as usize].normalize_or_zero());
            let k = rings.corner(f, v);
            let range = samples.range(f);
            for near in &mut samples.near[range] {
                near.height -= step * near.weights[k] * slope;
            }
        }
        samples.back[v as usize] -= step;
        self.rings.positions[v as usize] = position;
        self.held[v as usize] = NONE;
        self.measure_around(v);
    }

    fn normal_at(&self, v: u32) -> DVec3 {
        self.rings.ring(v).iter().map(|&f| self.area(f)).sum::<DVec3>().normalize_or_zero()
    }
}

impl Samples {
    fn range(&self, f: u32) -> std::ops::Range<usize> {
        self.starts[f as usize] as usize..self.starts[f as usize + 1] as usize
    }
}
