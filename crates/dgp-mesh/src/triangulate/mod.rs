//! Cuts polygon faces into triangles along diagonals: no new vertices, n − 2 triangles for n corners.
//!
//! A polygon in space is looked at along its Newell normal (twice its vector area), from the side from
//! which it turns counterclockwise. That view drops the coordinate in which the normal is largest, so
//! that the corners keep their exact coordinates and the signs of areas are exact (Shewchuk 1997).
//! A triangle is *inverted* if it turns clockwise in that view.
//!
//! | method | triangles | cost for n corners |
//! |---|---|---|
//! | [`Ears`](TriangulationMethod::Ears) | none inverted in a simple polygon | a fan, O(n), if it is convex; else some n log n, see `ears.rs` |
//! | [`MaxMinAngle`](TriangulationMethod::MaxMinAngle) | none inverted in a simple polygon, the smallest angle as large as can be | O(n³) up to [`OPTIMAL_LIMIT`] corners, then as `Ears` |
//! | [`MinArea`](TriangulationMethod::MinArea) | the least area in space | the same |
//! | [`Fan`](TriangulationMethod::Fan) | all from the first corner | O(n) |
//!
//! - Guarantees: a polygon that is not simple, or that has no area, still gives n − 2 triangles of
//!   three different corners each. Same result for any number of threads; scaling changes nothing.

mod ears;
mod faces;
mod mesh;
mod optimal;
mod plane;

use glam::DVec3;

pub use faces::triangulate_faces;
pub use mesh::triangulate;
pub use optimal::OPTIMAL_LIMIT;

use plane::View;

/// How to cut a polygon into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TriangulationMethod {
    /// Quads along the diagonal that leaves the larger smallest angle, other convex polygons as a
    /// fan, the rest by cutting off ears (Meisters 1975).
    #[default]
    Ears,
    /// The triangulation whose smallest angle is largest (Klincsek 1980).
    MaxMinAngle,
    /// The triangulation of least area (Barequet and Sharir 1995), for polygons that are not flat.
    MinArea,
    /// All diagonals from the first corner: right for convex polygons.
    Fan,
}

/// Cuts one polygon in space into triangles, given as numbers of its corners.
///
/// Triangles turn as the polygon does. Fewer than three corners give none; otherwise there are
/// n − 2. Coordinates that are not finite give some triangles too.
///
/// ```
/// use dgp_mesh::{DVec3, TriangulationMethod, triangulate_polygon};
///
/// // An arrowhead, whose second corner points inward:   3
/// //                                                  0   1   2   from above: 0, 1, 2, 3
/// let arrow = [[0.0, 0.0], [2.0, 1.0], [4.0, 0.0], [2.0, 4.0]];
/// let arrow = arrow.map(|[x, y]| DVec3::new(x, y, 0.0));
/// let triangles = triangulate_polygon(&arrow, TriangulationMethod::Ears);
/// assert_eq!(triangles, [[0, 1, 3], [1, 2, 3]]);
/// ```
pub fn triangulate_polygon(corners: &[DVec3], method: TriangulationMethod) -> Vec<[usize; 3]> {
    let mut triangles = Vec::with_capacity(corners.len().saturating_sub(2));
    triangulate_avoiding(corners, method, &|_, _| false, &mut triangles);
    triangles
}

/// Adds the triangles of a polygon without the diagonals for which `is_taken` holds; whether that
/// could be done.
fn triangulate_avoiding(
    corners: &[DVec3],
    method: TriangulationMethod,
    is_taken: &dyn Fn(usize, usize) -> bool,
    triangles: &mut Vec<[usize; 3]>,
) -> bool {
    use TriangulationMethod::{Ears, Fan, MaxMinAngle, MinArea};
    let n = corners.len();
    let first = triangles.len();
    if n <= 3 {
        triangles.extend((n == 3).then_some([0, 1, 2]));
        return true;
    }
    let is_optimal = n <= OPTIMAL_LIMIT && matches!(method, MaxMinAngle | MinArea);
    if is_optimal || (n == 4 && method != Fan) {
        let view = View::new(corners);
        return optimal::triangulate(corners, &view, method, is_taken, triangles);
    }
    let fan = (1..n - 1).map(|k| [0, k, k + 1]);
    let fan_is_free = (2..n - 1).all(|k| !is_taken(0, k));
    if method == Fan && fan_is_free {
        triangles.extend(fan);
        return true;
    }
    let view = View::new(corners);
    if fan_is_free && method == Ears && view.is_fan() {
        triangles.extend(fan);
        return true;
    }
    ears::triangulate(&view, is_taken, triangles);
    if diagonals(&triangles[first..], n).any(|[a, b]| is_taken(a, b)) {
        // Ears are cut greedily; what they miss the search over all triangulations finds.
        triangles.truncate(first);
        return n <= OPTIMAL_LIMIT
            && optimal::triangulate(corners, &view, MaxMinAngle, is_taken, triangles);
    }
    true
}

/// The sides of the triangles that are no sides of the polygon of `n` corners, each twice.
fn diagonals(triangles: &[[usize; 3]], n: usize) -> impl Iterator<Item = [usize; 2]> + '_ {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    sides.filter(move |&[a, b]| (a + 1) % n != b && (b + 1) % n != a)
}

#[cfg(test)]
mod tests;
