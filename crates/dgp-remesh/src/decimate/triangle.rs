//! The nearest point of a triangle.
//!
//! - Input: a point and three corners, which may coincide.
//! - Cost: O(1).
//! - Reference: Ericson, "Real-time collision detection", 2005, section 5.1.5.

use dgp_mesh::DVec3;

/// The point of a triangle nearest to `p`.
pub(super) fn nearest_point(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let [_, s, t] = nearest_weights(p, corners);
    a + (b - a) * s + (c - a) * t
}

/// How much each corner counts in the nearest point; they sum to 1.
pub(super) fn nearest_weights(p: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let from_a = p - a;
    let (a1, a2) = (ab.dot(from_a), ac.dot(from_a));
    if a1 <= 0.0 && a2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let from_b = p - b;
    let (b1, b2) = (ab.dot(from_b), ac.dot(from_b));
    if b1 >= 0.0 && b2 <= b1 {
        return [0.0, 1.0, 0.0];
    }
    let at_c = a1 * b2 - b1 * a2;
    if at_c <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
        let s = a1 / (a1 - b1);
        return [1.0 - s, s, 0.0];
    }
    let from_c = p - c;
    let (c1, c2) = (ab.dot(from_c), ac.dot(from_c));
    if c2 >= 0.0 && c1 <= c2 {
        return [0.0, 0.0, 1.0];
    }
    let at_b = c1 * a2 - a1 * c2;
    if at_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        let t = a2 / (a2 - c2);
        return [1.0 - t, 0.0, t];
    }
    let at_a = b1 * c2 - c1 * b2;
    let (along, rest) = (b2 - b1, c1 - c2);
    if at_a <= 0.0 && along >= 0.0 && rest >= 0.0 {
        let t = along / (along + rest);
        return [0.0, 1.0 - t, t];
    }
    let whole = at_a + at_b + at_c;
    let (s, t) = (at_b / whole, at_c / whole);
    [1.0 - s - t, s, t]
}
