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

/// Quadrics of the ends of an edge, each relative to its end.
pub(super) struct Ends<'a> {
    pub(super) a: DVec3,
    pub(super) b: DVec3,
    pub(super) quadrics: [&'a Quadric; 2],
}

impl Ends<'_> {
    /// The cost of having both ends at `a + x`.
    #[inline]
    fn cost(&self, x: DVec3, e: DVec3) -> f64 {
        (self.quadrics[0].at(x) + self.quadrics[1].at(x - e)).max(0.0)
    }

    /// A collapse to `position`.
    pub(super) fn fixed(&self, position: DVec3, slack: f64) -> Candidate {
        let e = self.b - self.a;
        self.candidate(position, self.cost(position - self.a, e), e, slack)
    }

    fn candidate(&self, position: DVec3, cost: f64, e: DVec3, slack: f64) -> Candidate {
        let weight = self.quadrics[0].weight() + self.quadrics[1].weight();
        Candidate { key: cost + slack * weight * e.length_squared(), cost, weight, position }
    }

    /// The better end.
    #[inline]
    pub(super) fn best_end(&self, slack: f64) -> Candidate {
        let e = self.b - self.a;
        let (at_a, at_b) = (self.cost(DVec3::ZERO, e), self.cost(e, e));
        if at_a <= at_b {
            self.candidate(self.a, at_a, e, slack)
        } else {
            self.candidate(self.b, at_b, e, slack)
        }
    }

    /// The best point; where the quadrics leave it free the best of ends and middle.
    #[inline]
    pub(super) fn best(&self, damping: f64, slack: f64) -> Candidate {
        let e = self.b - self.a;
        let end = self.best_end(slack);
        let [qa, qb] = self.quadrics;
        let mut a = qa.a;
        for (x, y) in a.iter_mut().zip(qb.a) {
            *x += y;
        }
        let middle = 0.5 * e;
        let damp = damping * (a[0] + a[3] + a[5]);
        for k in [0, 3, 5] {
            a[k] += damp;
        }
        // Gradient at the middle: A_a m + b_a + A_b (m − e) + b_b.
        let gradient = qa.times(middle) + qa.b - qb.times(middle) + qb.b;
        if let Some(step) = solve(a, -gradient) {
            let x = middle + step;
            let cost = self.cost(x, e);
            // Farther away than the edge is long nothing is known of the surface.
            if cost < end.cost && step.length_squared() <= 4.0 * e.length_squared() {
                return self.candidate(self.a + x, cost, e, slack);
            }
        }
        end
    }
}

/// weight · |s|² times the squared distance to the plane through side `s` of a triangle, perpendicular to it.
#[inline]
pub(super) fn fence(s: DVec3, unit_normal: DVec3, weight: f64) -> [f64; 6] {
    outer(s.cross(unit_normal), weight)
}
