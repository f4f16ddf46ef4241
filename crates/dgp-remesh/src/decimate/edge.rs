//! What the collapse of an edge costs, and where its vertex goes, for the quadrics of both ends.

use dgp_mesh::DVec3;

use crate::quadric::{Quadric, outer, solve};

/// A collapse that could be done.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// What orders collapses.
    pub(super) key: f64,
    /// The squared error times the weight, and that weight.
    pub(super) cost: f64,
    pub(super) weight: f64,
    pub(super) position: DVec3,
}

/// Planes through a vertex as squared distances from it: A of pᵀ A p.
pub(super) type Through = [f64; 6];

#[inline]
fn times(a: &Through, [x, y, z]: [f64; 3]) -> DVec3 {
    let [xx, xy, xz, yy, yz, zz] = *a;
    DVec3::new(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z)
}

#[inline]
fn trace(a: &Through) -> f64 {
    a[0] + a[3] + a[5]
}

/// An edge with the planes through its ends, and perhaps others that its ends remember.
pub(super) struct Ends<'a> {
    pub(super) a: DVec3,
    pub(super) b: DVec3,
    pub(super) through: [&'a Through; 2],
    pub(super) remembered: Option<[&'a Quadric; 2]>,
    /// What data cost, relative to `a`.
    pub(super) data: Option<Quadric>,
    /// How much the squared length of the edge counts.
    pub(super) slack: f64,
    /// Twice the vector area of the triangles around each end, those at the edge only with the first.
    pub(super) areas: Option<[DVec3; 2]>,
}

impl Ends<'_> {
    /// The cost of having both ends at `a + x`.
    #[inline]
    fn cost(&self, x: DVec3, e: DVec3) -> f64 {
        let y = x - e;
        let [a, b] = self.through;
        let mut cost = times(a, x.to_array()).dot(x) + times(b, y.to_array()).dot(y);
        if let Some([p, q]) = self.remembered {
            cost += p.at(x) + q.at(y);
        }
        if let Some(data) = &self.data {
            cost += data.at(x);
        }
        cost.max(0.0)
    }

    /// A collapse to `position`.
    pub(super) fn fixed(&self, position: DVec3) -> Candidate {
        let e = self.b - self.a;
        self.candidate(position, self.cost(position - self.a, e), e)
    }

    #[inline]
    fn candidate(&self, position: DVec3, cost: f64, e: DVec3) -> Candidate {
        let mut weight = trace(self.through[0]) + trace(self.through[1]);
        if let Some([p, q]) = self.remembered {
            weight += p.weight() + q.weight();
        }
        Candidate { key: cost + self.slack * weight * e.length_squared(), cost, weight, position }
    }

    /// The better end.
    #[inline]
    pub(super) fn best_end(&self) -> Candidate {
        let e = self.b - self.a;
        let (at_a, at_b) = (self.cost(DVec3::ZERO, e), self.cost(e, e));
        if at_a <= at_b { self.candidate(self.a, at_a, e) } else { self.candidate(self.b, at_b, e) }
    }

    /// The best point, sought near the middle; the better end where no point is better.
    #[inline]
    pub(super) fn best(&self, damping: f64) -> Candidate {
        let e = self.b - self.a;
        let [qa, qb] = self.through;
        let mut a = *qa;
        for (x, y) in a.iter_mut().zip(qb) {
            *x += y;
        }
        let (ea, eb) = (times(qa, e.to_array()), times(qb, e.to_array()));
        let (mut at_a, mut at_b) = (eb.dot(e), ea.dot(e));
        // Minus half of the gradient at the middle.
        let mut pull = 0.5 * (eb - ea);
        if let Some([p, q]) = self.remembered {
            for (k, x) in a.iter_mut().enumerate() {
                *x += p.a[k] + q.a[k];
            }
            at_a += p.c + q.at(-e);
            at_b += p.at(e) + q.c;
            pull -= p.times(0.5 * e) + p.b - q.times(0.5 * e) + q.b;
        }
        if let Some(data) = &self.data {
            for (x, more) in a.iter_mut().zip(data.a) {
                *x += more;
            }
            at_a += data.c;
            at_b += data.at(e);
            pull -= data.times(0.5 * e) + data.b;
        }
        let damp = damping * trace(&a);
        for k in [0, 3, 5] {
            a[k] += damp;
        }
        let (end, at_end) = if at_a <= at_b { (self.a, at_a) } else { (self.b, at_b) };
        if let Some(mut step) = solve(a, pull) {
            if let Some([ga, gb]) = self.areas
                && let Some(r) = solve(a, ga + gb)
            {
                // Six times the volume that is swept: G_a·x + G_b·(x − e), x = e/2 + step.
                let g = ga + gb;
                let swept = g.dot(0.5 * e + step) - gb.dot(e);
                let along = g.dot(r);
                if along > 0.0 {
                    step -= r * (swept / along);
                }
            }
            let x = 0.5 * e + step;
            let cost = self.cost(x, e);
            // Farther away than the edge is long nothing is known of the surface.
            if cost < at_end && step.length_squared() <= 4.0 * e.length_squared() {
                return self.candidate(self.a + x, cost, e);
            }
        }
        self.candidate(end, at_end.max(0.0), e)
    }
}

/// weight · |s|³ times the squared distance to the plane through side `s` of a triangle, perpendicular to it:
/// as much as a triangle of the size of the side counts.
#[inline]
pub(super) fn fence(s: DVec3, unit_normal: DVec3, weight: f64) -> [f64; 6] {
    outer(s.cross(unit_normal), weight * s.length())
}
