//! The limit surface at vertices: where refining for ever takes them, and the tangents there.
//!
//! ```text
//! position   ℓ A = ℓ        left eigenvector of the matrix A that refines a vertex and what is around it
//! tangents   t A = μ t      those of the next eigenvalues
//! smooth     the masks in `loop_scheme` and `catmull_clark`
//! crease     ⅔ v + ⅙ (w + w′), along it w − w′, across it the eigenvector of that side
//! corner     v; tangents w − v and w′ − v of the first two edges that bound a face there
//! dart       one edge sharp for ever: ℓ and t by repeating A from the left
//! ```
//!
//! While sharpness wears off, A differs from level to level: ℓ A_m ⋯ A₂ A₁ with as many steps as it
//! takes, which is exact.
//!
//! - Input: any level of a plan of Loop's or Catmull and Clark's scheme.
//! - Cost: O(corners); vertices where sharpness ends cost up to 10, darts some hundred times a mask.
//! - Reference: Halstead, Kass and DeRose, "Efficient, fair interpolation using Catmull–Clark surfaces",
//!   SIGGRAPH 1993; Biermann, Levin and Zorin, "Piecewise smooth subdivision surfaces with normal control",
//!   SIGGRAPH 2000 (the analysis at creases).
//! - Departs from it: creases keep the plain rule at irregular vertices too, so their tangents are those
//!   of that rule and not of the one the paper changes. Where a crease bounds 4 or more quadrilaterals, or 6 or
//!   more triangles, that rule has no tangent plane: other waves across shrink no faster than the crease.

use std::f64::consts::{PI, TAU};

use crate::{
    catmull_clark::{catmull_clark_limit, tangent_factor},
    loop_scheme::loop_limit,
    masks::{Masks, Means, Stencil},
    primal::Kind,
    ring::{Mix, Rule, final_rule, mix},
    sharpness::{Creases, SHARP, decrement},
    topology::Topology,
};

/// What of the limit surface is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limit {
    Position,
    /// The first or the second tangent; their cross product points outward.
    Tangent(usize),
}

/// The masks of limit positions or tangents at the vertices of a level.
pub(crate) struct LimitMasks<'a> {
    pub(crate) topology: &'a Topology,
    pub(crate) creases: &'a Creases,
    pub(crate) kind: Kind,
    pub(crate) what: Limit,
}

impl Masks for LimitMasks<'_> {
    fn rows(&self) -> usize {
        self.topology.vertex_count()
    }

    fn topology(&self) -> &Topology {
        self.topology
    }

    fn means(&self) -> Means {
        match self.kind {
            Kind::Loop(_) => Means::Unused,
            Kind::CatmullClark | Kind::Bilinear => Means::Beside,
        }
    }

    fn row(&self, v: usize, stencil: &mut Stencil) {
        let mut spokes = std::mem::take(&mut stencil.spokes);
        let closed = self.topology.spokes(v, &mut spokes);
        let sharpness = spokes.iter().map(|h| self.creases.edge(self.topology, *h as usize / 2));
        let ring = Ring {
            kind: self.kind,
            closed,
            sharpness: sharpness.collect(),
            vertex: self.creases.vertex(v),
        };
        let weights = ring.limit(self.what);
        stencil.push(v as u32, weights.center);
        let neighbors = spokes.iter().zip(&weights.neighbors);
        stencil.entries.extend(neighbors.map(|(&h, &weight)| (self.topology.to(h), weight)));
        let vertices = self.topology.vertex_count() as u32;
        let faces = spokes.iter().zip(&weights.faces);
        let faces = faces
            .map(|(&h, &weight)| (vertices + self.topology.face(self.topology.corner(h)), weight));
        stencil.entries.extend(faces);
        stencil.spokes = spokes;
    }
}

/// A vertex and what is around it: spokes counterclockwise, a face after each but the last at a hole.
struct Ring {
    kind: Kind,
    closed: bool,
    sharpness: Vec<f64>,
    vertex: f64,
}

/// A number per member of a ring: the vertex, its neighbors, the means of its faces (none for triangles).
#[derive(Clone, Debug, PartialEq)]
struct Weights {
    center: f64,
    neighbors: Vec<f64>,
    faces: Vec<f64>,
}

impl Ring {
    /// The mask of a limit.
    fn limit(&self, what: Limit) -> Weights {
        // While sharpness wears off, each step has a matrix of its own.
        let mut steps = Vec::new();
        let mut ring = Ring { sharpness: self.sharpness.clone(), ..*self };
        while ring.wears_off() {
            let next = Ring {
                vertex: decrement(ring.vertex),
                sharpness: ring.sharpness.iter().map(|&s| decrement(s)).collect(),
                ..ring
            };
            steps.push(ring);
            ring = next;
        }
        let last = ring.stationary(what);
        steps.iter().rev().fold(last, |weights, step| step.before(&weights))
    }

    fn wears_off(&self) -> bool {
        self.sharpness.iter().chain([&self.vertex]).any(|&s| s > 0.0 && s < SHARP)
    }

    /// The mask where sharpness does not change from level to level.
    fn stationary(&self, what: Limit) -> Weights {
        if self.kind == Kind::Bilinear {
            return match what {
                Limit::Position => Weights { center: 1.0, ..self.zero() },
                Limit::Tangent(k) => self.corner_tangent(k),
            };
        }
        let rule = final_rule(self.vertex, &self.sharpness);
        let dart = self.sharpness.iter().position(|&s| s >= SHARP);
        match (rule, what) {
            (Rule::Corner, Limit::Position) => Weights { center: 1.0, ..self.zero() },
            (Rule::Corner, Limit::Tangent(k)) => self.corner_tangent(k),
            (Rule::Crease(ends), Limit::Position) => {
                let mut weights = Weights { center: 2.0 / 3.0, ..self.zero() };
                for end in ends {
                    weights.neighbors[end] = 1.0 / 6.0;
                }
                weights
            }
            (Rule::Crease(ends), Limit::Tangent(0)) => {
                let mut weights = self.zero();
                weights.neighbors[ends[0]] = 1.0;
                weights.neighbors[ends[1]] = -1.0;
                weights
            }
            (Rule::Crease(ends), Limit::Tangent(_)) => self.across(ends),
            (Rule::Smooth, _) => match dart {
                Some(spoke) => self.dart(spoke, what),
                None => self.smooth(what),
            },
        }
    }

    fn zero(&self) -> Weights {
        let faces = match self.kind {
            Kind::Loop(_) => 0,
            Kind::CatmullClark | Kind::Bilinear => self.face_count(),
        };
        Weights { center: 0.0, neighbors: vec![0.0; self.sharpness.len()], faces: vec![0.0; faces] }
    }

    fn face_count(&self) -> usize {
        self.sharpness.len() - usize::from(!self.closed)
    }

    fn smooth(&self, what: Limit) -> Weights {
        let d = self.sharpness.len();
        let mut weights = self.zero();
        match (what, self.kind) {
            (Limit::Position, Kind::Loop(rule)) => {
                let chi = loop_limit(rule, d);
                weights.center = 1.0 - d as f64 * chi;
                weights.neighbors.fill(chi);
            }
            (Limit::Position, _) => {
                let [center, neighbor, face] = catmull_clark_limit(d);
                weights.center = center;
                weights.neighbors.fill(neighbor);
                weights.faces.fill(face);
            }
            // Two quadrilaterals back to back: waves around them vanish, but what is across does not.
            (Limit::Tangent(0), Kind::CatmullClark) if d == 2 => {
                weights.neighbors = vec![1.0, -1.0];
            }
            (Limit::Tangent(_), Kind::CatmullClark) if d == 2 => weights.faces = vec![1.0, -1.0],
            (Limit::Tangent(k), kind) => {
                let wave = |i: usize| {
                    let angle = TAU * i as f64 / d as f64;
                    if k == 0 { angle.cos() } else { angle.sin() }
                };
                let factor =
                    if kind == Kind::CatmullClark { tangent_factor(TAU / d as f64) } else { 1.0 };
                for (i, weight) in weights.neighbors.iter_mut().enumerate() {
                    *weight = factor * wave(i);
                }
                for (i, weight) in weights.faces.iter_mut().enumerate() {
                    *weight = (factor + 4.0) * (wave(i) + wave(i + 1));
                }
            }
        }
        weights
    }

    /// Along the first or the last edge of the first sector between edges that stay sharp.
    fn corner_tangent(&self, k: usize) -> Weights {
        let sharp = |i: &usize| self.sharpness[*i] >= SHARP;
        let first = (0..self.sharpness.len()).find(sharp).unwrap_or(0);
        let next = (first + 1..self.sharpness.len()).find(sharp);
        // A sharp vertex among smooth edges: any two neighbors.
        let next = next.unwrap_or((first + 1) % self.sharpness.len());
        let mut weights = Weights { center: -1.0, ..self.zero() };
        weights.neighbors[[first, next][k]] = 1.0;
        weights
    }

    /// Into the surface on the left of a crease, from its first to its second spoke.
    ///
    /// With θ = π/faces the spokes between count sin iθ, times a factor; what the vertex and the ends of
    /// the crease count follows from t A = μ t, two linear equations.
    fn across(&self, [first, last]: [usize; 2]) -> Weights {
        let mut weights = self.zero();
        let faces = last - first;
        if faces == 1 {
            // The bend of the crease; no other functional shrinks as slowly.
            weights.center = -2.0;
            weights.neighbors[first] = 1.0;
            weights.neighbors[last] = 1.0;
            return weights;
        }
        let angle = PI / faces as f64;
        let wave = |i: usize| (i as f64 * angle).sin();
        let sum: f64 = (1..faces).map(wave).sum();
        // μ, and by how much the rest feeds an end of the crease and the vertex.
        let (factor, mu, to_end, to_vertex) = match self.kind {
            Kind::Loop(_) => {
                (1.0, 3.0 / 8.0 + angle.cos() / 4.0, angle.sin() / 8.0, 3.0 / 8.0 * sum)
            }
            Kind::CatmullClark | Kind::Bilinear => {
                let factor = tangent_factor(angle);
                let mu = (factor + 4.0) / 16.0;
                (factor, mu, mu * angle.sin(), (factor / 4.0 + 2.0 * mu) * sum)
            }
        };
        // (½ − μ) end − ⅛ center = to_end,  (¾ − μ) center − end = −to_vertex.
        let determinant = (mu - 1.0) * (mu - 0.25);
        let end = (to_end * (0.75 - mu) - to_vertex / 8.0) / determinant;
        weights.center = (to_end - (0.5 - mu) * to_vertex) / determinant;
        weights.neighbors[first] = -end;
        weights.neighbors[last] = -end;
        for i in 1..faces {
            weights.neighbors[first + i] = factor * wave(i);
        }
        if weights.faces.is_empty() {
            return weights;
        }
        // So far of the quadrilaterals of the next level, whose corners are worked out from this one.
        for i in 0..faces {
            weights.faces[first + i] = wave(i) + wave(i + 1);
        }
        self.before_quads(&weights)
    }

    /// At the end of a crease: repeats the step from the left until it changes nothing more.
    fn dart(&self, spoke: usize, what: Limit) -> Weights {
        // By then ratios of eigenvalues up to 0.99, those of vertices of some hundred edges, vanish.
        const STEPS: usize = 4096;
        let repeat = |start: Weights, step: &dyn Fn(&Weights) -> Weights| {
            let mut now = start;
            for _ in 0..STEPS {
                let next = step(&now);
                let mut change = next.clone();
                change.combine(1.0, &now, -1.0);
                now = next;
                if change.size() <= f64::EPSILON * now.size() {
                    break;
                }
            }
            now
        };
        let start = Weights { center: 1.0, ..self.zero() };
        let position = repeat(start, &|weights| self.before(weights));
        let Limit::Tangent(k) = what else {
            return position;
        };
        // Tangents are even or odd in the reflection that keeps the crease; so is every step.
        let d = self.sharpness.len();
        let sign = if k == 0 { 1.0 } else { -1.0 };
        let mut start = self.zero();
        let wave = |turns: f64| {
            let angle = TAU * turns / d as f64;
            if k == 0 { angle.cos() } else { angle.sin() }
        };
        let turns = |i: usize| ((i + d - spoke) % d) as f64;
        for (i, weight) in start.neighbors.iter_mut().enumerate() {
            *weight = wave(turns(i));
        }
        for (i, weight) in start.faces.iter_mut().enumerate() {
            *weight = wave(turns(i) + 0.5);
        }
        repeat(start, &|weights| {
            let mut next = self.before(weights);
            let mirrored = self.reflected(&next, spoke);
            next.combine(0.5, &mirrored, 0.5 * sign);
            // What is left of the position, whose eigenvalue is larger.
            let sum = next.sum();
            next.combine(1.0, &position, -sum);
            let size = next.size();
            next.scale(1.0 / size);
            next
        })
    }

    /// The weights of the mirror image that keeps `spoke`.
    fn reflected(&self, weights: &Weights, spoke: usize) -> Weights {
        let d = self.sharpness.len();
        let mirror = |i: usize| (2 * spoke + 2 * d - i) % d;
        Weights {
            center: weights.center,
            neighbors: (0..d).map(|i| weights.neighbors[mirror(i)]).collect(),
            // Face i lies between spokes i and i + 1.
            faces: (0..weights.faces.len()).map(|i| weights.faces[mirror(i + 1)]).collect(),
        }
    }

    /// w A: the weights at this level that equal `after` at the next.
    fn before(&self, after: &Weights) -> Weights {
        let mut quads = Weights { faces: vec![0.0; after.faces.len()], ..after.clone() };
        let d = after.neighbors.len();
        for (i, &weight) in after.faces.iter().enumerate() {
            // The faces around are quadrilaterals then: the vertex, two edge points, the face point.
            let share = weight / 4.0;
            quads.center += share;
            quads.neighbors[i] += share;
            quads.neighbors[(i + 1) % d] += share;
            quads.faces[i] += share;
        }
        self.before_quads(&quads)
    }

    /// As [`before`](Self::before), where the faces of `after` stand for the face points of this step:
    /// the corners across at the next level.
    fn before_quads(&self, after: &Weights) -> Weights {
        let mut weights = Weights { faces: after.faces.clone(), ..self.zero() };
        let d = after.neighbors.len();
        // Edge points.
        let [end, side] = self.kind.smooth_edge();
        for (i, &weight) in after.neighbors.iter().enumerate() {
            let sharp = self.sharpness[i].min(1.0);
            let end = (1.0 - sharp) * end + sharp * 0.5;
            let side = (1.0 - sharp) * side;
            weights.center += end * weight;
            weights.neighbors[i] += end * weight;
            // At a hole the outer spokes are sharp, so nothing beyond them counts.
            if side > 0.0 {
                let before = (i + d - 1) % d;
                match self.kind {
                    Kind::Loop(_) => {
                        weights.neighbors[before] += side * weight;
                        weights.neighbors[(i + 1) % d] += side * weight;
                    }
                    Kind::CatmullClark | Kind::Bilinear => {
                        weights.faces[before] += side * weight;
                        weights.faces[i] += side * weight;
                    }
                }
            }
        }
        // The vertex.
        let Mix { first, second, weight } = mix(self.vertex, &self.sharpness);
        for (rule, factor) in [(first, weight), (second, 1.0 - weight)] {
            let factor = factor * after.center;
            match rule {
                Rule::Corner => weights.center += factor,
                Rule::Crease(ends) => {
                    weights.center += 0.75 * factor;
                    for end in ends {
                        weights.neighbors[end] += 0.125 * factor;
                    }
                }
                Rule::Smooth => {
                    let [center, neighbor, face] = self.kind.smooth_vertex(d);
                    weights.center += center * factor;
                    weights.neighbors.iter_mut().for_each(|weight| *weight += neighbor * factor);
                    weights.faces.iter_mut().for_each(|weight| *weight += face * factor);
                }
            }
        }
        weights
    }
}

impl Weights {
    fn each(&mut self, other: &Weights, f: impl Fn(&mut f64, f64)) {
        f(&mut self.center, other.center);
        self.neighbors.iter_mut().zip(&other.neighbors).for_each(|(a, &b)| f(a, b));
        self.faces.iter_mut().zip(&other.faces).for_each(|(a, &b)| f(a, b));
    }

    /// a · self + b · other.
    fn combine(&mut self, a: f64, other: &Weights, b: f64) {
        self.each(other, |x, y| *x = a * *x + b * y);
    }

    fn scale(&mut self, factor: f64) {
        let neighbors = self.neighbors.iter_mut();
        neighbors.chain(&mut self.faces).chain([&mut self.center]).for_each(|x| *x *= factor);
    }

    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        [self.center].into_iter().chain(self.neighbors.iter().chain(&self.faces).copied())
    }

    fn sum(&self) -> f64 {
        self.values().sum()
    }

    fn size(&self) -> f64 {
        self.values().fold(0.0, |size, x| f64::max(size, x.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::LoopWeights;

    const KINDS: [Kind; 2] = [Kind::Loop(LoopWeights::Original), Kind::CatmullClark];

    fn ring(kind: Kind, closed: bool, sharpness: &[f64]) -> Ring {
        Ring { kind, closed, sharpness: sharpness.to_vec(), vertex: 0.0 }
    }

    /// Smooth, dart, crease inside and rims of several valences.
    fn rings(kind: Kind) -> Vec<Ring> {
        let mut rings = Vec::new();
        // Loop refuses vertices inside with two faces.
        for d in if kind == Kind::CatmullClark { 2..9 } else { 3..9 } {
            let mut sharpness = vec![0.0; d];
            rings.push(ring(kind, true, &sharpness));
            sharpness[1] = SHARP;
            rings.push(ring(kind, true, &sharpness));
            sharpness[2 % d] = SHARP;
            rings.push(ring(kind, true, &sharpness));
        }
        for d in 2..8 {
            let mut sharpness = vec![0.0; d];
            (sharpness[0], sharpness[d - 1]) = (SHARP, SHARP);
            rings.push(ring(kind, false, &sharpness));
        }
        rings
    }

    fn is_multiple(a: &Weights, b: &Weights, factor: f64) -> bool {
        let size = a.size().max(b.size());
        a.values().zip(b.values()).all(|(a, b)| (a - factor * b).abs() <= 1e-13 * size)
    }

    #[test]
    fn limits_do_not_change_under_refinement() {
        for ring in KINDS.into_iter().flat_map(rings) {
            let limit = ring.limit(Limit::Position);
            assert!((limit.sum() - 1.0).abs() < 1e-14);
            assert!(is_multiple(&ring.before(&limit), &limit, 1.0), "{:?}", ring.sharpness);
        }
    }

    #[test]
    fn tangents_only_shrink_under_refinement() {
        for ring in KINDS.into_iter().flat_map(rings) {
            for k in 0..2 {
                let tangent = ring.limit(Limit::Tangent(k));
                assert!(tangent.sum().abs() < 1e-13 * tangent.size(), "{:?} {k}", ring.sharpness);
                let shrunk = ring.before(&tangent);
                // By the largest component.
                let pairs = shrunk.values().zip(tangent.values());
                let largest = pairs.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap();
                let factor = largest.0 / largest.1;
                assert!((0.1..0.9).contains(&factor), "{factor} {:?} {k}", ring.sharpness);
                let (kind, sharpness) = (ring.kind, &ring.sharpness);
                let same = is_multiple(&shrunk, &tangent, factor);
                assert!(same, "{kind:?} {sharpness:?} {k}: {tangent:?} {shrunk:?}");
            }
        }
    }

    #[test]
    fn sharpness_that_wears_off_leads_to_the_same_limit_from_each_level() {
        for kind in KINDS {
            let mut now = ring(kind, true, &[2.3, 0.0, 0.7, 0.0, 1.5]);
            now.vertex = 0.4;
            let next = Ring {
                vertex: decrement(now.vertex),
                sharpness: now.sharpness.iter().map(|&s| decrement(s)).collect(),
                ..now
            };
            let limit = now.limit(Limit::Position);
            assert_eq!(limit, now.before(&next.limit(Limit::Position)));
            assert!((limit.sum() - 1.0).abs() < 1e-15);
            assert_ne!(limit, next.limit(Limit::Position));
        }
    }
}
