//! The best of all triangulations of a polygon, by dynamic programming.
//!
//! ```text
//! best(i, k) = min over j between i and k of  best(i, j) + best(j, k) + cost of triangle i j k
//! ```
//!
//! Costs are compared in this order: diagonals that may not be used; triangles that are flat or, but for
//! least area, inverted; the cotangent of the smallest angle, but for least area; the sum of areas.
//!
//! - Input: a polygon in the plane.
//! - Cost: O(n³) time, O(n²) memory.
//! - Guarantees: a simple polygon has a triangulation without inverted triangles, so none is chosen.
//! - Reference: Klincsek, "Minimal triangulations of polygonal domains", Annals of Discrete
//!   Mathematics 9, 1980; Barequet and Sharir, "Filling gaps in the boundary of a polyhedron",
//!   Computer Aided Geometric Design 12, 1995.

use std::cmp::Ordering;

use glam::DVec3;

use super::{TriangulationMethod, plane::View};

/// The most corners for which all triangulations are searched; it takes some milliseconds.
pub const OPTIMAL_LIMIT: usize = 128;

/// What a triangulation costs, worst part first.
#[derive(Clone, Copy, PartialEq)]
struct Cost {
    taken: u32,
    /// Triangles without area or, but for least area, inverted.
    flat: u32,
    /// The largest cotangent of an angle.
    sharpness: f64,
    area: f64,
}

impl Cost {
    const NONE: Cost = Cost { taken: 0, flat: 0, sharpness: f64::NEG_INFINITY, area: 0.0 };

    fn and(self, other: Cost) -> Cost {
        Cost {
            taken: self.taken + other.taken,
            flat: self.flat + other.flat,
            sharpness: self.sharpness.max(other.sharpness),
            area: self.area + other.area,
        }
    }

    fn is_below(&self, other: &Cost) -> bool {
        let order = self.taken.cmp(&other.taken).then(self.flat.cmp(&other.flat));
        let order = order.then(self.sharpness.total_cmp(&other.sharpness));
        order.then(self.area.total_cmp(&other.area)) == Ordering::Less
    }
}

/// Adds the best triangles of the polygon; whether that could be done without taken diagonals.
pub(super) fn triangulate(
    corners: &[DVec3],
    view: &View,
    method: TriangulationMethod,
    is_taken: &dyn Fn(usize, usize) -> bool,
    triangles: &mut Vec<[usize; 3]>,
) -> bool {
    let n = corners.len();
    let triangle_cost = |a, b, c| cost(corners, view, method, [a, b, c]);
    let diagonal_cost = |a, b| Cost { taken: u32::from(is_taken(a, b)), ..Cost::NONE };
    if n == 4 {
        let [one, other] = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
        let sum = |pair: [[usize; 3]; 2], [p, q]: [usize; 2]| {
            let [first, second] = pair.map(|[a, b, c]| triangle_cost(a, b, c));
            first.and(second).and(diagonal_cost(p, q))
        };
        let (cost_one, cost_other) = (sum(one, [0, 2]), sum(other, [1, 3]));
        let other_is_better = cost_other.is_below(&cost_one);
        triangles.extend(if other_is_better { other } else { one });
        return cost_one.taken == 0 || cost_other.taken == 0;
    }
    // The best cost of the part from corner i to corner k, and the corner of the triangle on i k.
    let mut best = vec![(Cost::NONE, 0_usize); n * n];
    for span in 2..n {
        for i in 0..n - span {
            let k = i + span;
            let mut choice: Option<(Cost, usize)> = None;
            for j in i + 1..k {
                let parts = best[i * n + j].0.and(best[j * n + k].0);
                if choice.is_some_and(|(least, _)| least.is_below(&parts)) {
                    continue;
                }
                let cost = parts.and(triangle_cost(i, j, k));
                if choice.is_none_or(|(least, _)| cost.is_below(&least)) {
                    choice = Some((cost, j));
                }
            }
            let (cost, j) = choice.expect("there is a corner between i and k");
            let is_side = span == n - 1;
            let diagonal = if is_side { Cost::NONE } else { diagonal_cost(i, k) };
            best[i * n + k] = (cost.and(diagonal), j);
        }
    }
    let mut parts = vec![(0, n - 1)];
    while let Some((i, k)) = parts.pop() {
        if k > i + 1 {
            let j = best[i * n + k].1;
            triangles.push([i, j, k]);
            parts.extend([(j, k), (i, j)]);
        }
    }
    best[n - 1].0.taken == 0
}

fn cost(
    corners: &[DVec3],
    view: &View,
    method: TriangulationMethod,
    [a, b, c]: [usize; 3],
) -> Cost {
    let [p, q, r] = [a, b, c].map(|corner| corners[corner] * view.unit);
    let area = (q - p).cross(r - p).length();
    if method == TriangulationMethod::MinArea {
        return Cost { flat: u32::from(!is_positive(area)), area, ..Cost::NONE };
    }
    let flat = u32::from(!is_positive(view.turn(a, b, c)));
    // cot = cos / sin = dot product / cross product; the largest belongs to the smallest angle.
    let dots = [(q - p).dot(r - p), (r - q).dot(p - q), (p - r).dot(q - r)];
    let largest = dots[0].max(dots[1]).max(dots[2]);
    let sharpness = if area > 0.0 { largest / area } else { f64::INFINITY };
    Cost { taken: 0, flat, sharpness, area }
}

/// Whether `x` is above zero; what is no number is not.
fn is_positive(x: f64) -> bool {
    x > 0.0
}
