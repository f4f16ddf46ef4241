//! Where the boundary of a picture crosses itself.
//!
//! A map of a disk that turns no face over is one to one unless its boundary crosses itself, so this is what is left
//! to check.
//!
//! - Input: a loop of points in the plane.
//! - Cost: O(n log n) for loops as they occur; O(n²) where all edges overlap in u.
//! - Guarantees: exact signs.
//! - Reference: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates",
//!   1997.

use dgp_mesh::DVec2;
use robust::{Coord, orient2d};

/// The pairs of edges of a closed polygon that have a point in common, apart from an end that neighbors share.
/// Edge k leads from point k to the next. Points must be finite; edges of length 0 count as points.
pub fn boundary_crossings(points: &[DVec2]) -> Vec<[usize; 2]> {
    let n = points.len();
    let edge = |k: usize| [points[k], points[(k + 1) % n]];
    let mut order: Vec<usize> = (0..n).collect();
    let left = |k: usize| edge(k)[0].x.min(edge(k)[1].x);
    order.sort_by(|&a, &b| left(a).total_cmp(&left(b)));
    let mut open: Vec<usize> = Vec::new();
    let mut crossings = Vec::new();
    for &k in &order {
        open.retain(|&other| edge(other)[0].x.max(edge(other)[1].x) >= left(k));
        for &other in &open {
            let [first, second] = [k.min(other), k.max(other)];
            let adjacent = second == first + 1 || (first == 0 && second == n - 1);
            let meets = if adjacent && n > 2 {
                let [a, b] = if second == first + 1 { [first, second] } else { [second, first] };
                folds_back(edge(a), edge(b))
            } else {
                meet(edge(first), edge(second))
            };
            if meets {
                crossings.push([first, second]);
            }
        }
        open.push(k);
    }
    crossings.sort_unstable();
    crossings
}

fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether an edge and the next, which starts where it ends, run along each other.
fn folds_back([a, b]: [DVec2; 2], [_, c]: [DVec2; 2]) -> bool {
    a != b && b != c && orientation(a, b, c) == 0.0 && (a - b).dot(c - b) > 0.0
}

/// Whether two segments have a point in common.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let apart = a.max(b).cmplt(c.min(d)) | c.max(d).cmplt(a.min(b));
    if apart.any() {
        return false;
    }
    let sides = [orientation(a, b, c), orientation(a, b, d)];
    let others = [orientation(c, d, a), orientation(c, d, b)];
    let separated = |s: [f64; 2]| (s[0] > 0.0 && s[1] > 0.0) || (s[0] < 0.0 && s[1] < 0.0);
    !separated(sides) && !separated(others)
}
