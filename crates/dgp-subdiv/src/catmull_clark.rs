//! Catmull–Clark subdivision: polygons into quadrilaterals, toward bicubic patches.
//!
//! ```text
//! face     F = mean of its corners
//! edge     (v + w + F + G)/4
//! vertex   Q/d + 2R/d + S(d − 3)/d = ((d − 2) v + mean w + mean F)/d
//!          Q, R: means of the F around and of the middles of the edges; S: v
//!
//! crease, rim of a hole:   ½ ──◦── ½    ⅛ ── ¾ ── ⅛    corner: stays
//!
//! limit    ((d − 1) v + 2 mean w + 4 mean F)/(d + 5)
//!          = (d² v + 4 Σ w + Σ q)/(d(d + 5)) among quadrilaterals, q the corners across
//! tangents Σ A cos(2πi/d) w_i + (A + 4)(cos(2πi/d) + cos(2π(i + 1)/d)) F_i, and the same with sines
//!          A = 1 + cos(2π/d) + cos(π/d) √(2(9 + cos(2π/d)))
//! ```
//!
//! - Input: any polygons.
//! - Cost: O(corners) per level.
//! - Guarantees: masks are convex but at vertices inside with two faces, where they are too; from the
//!   first level on all faces are quadrilaterals, and no new irregular vertices appear after it.
//! - Reference: Catmull and Clark, "Recursively generated B-spline surfaces on arbitrary topological
//!   meshes", 1978; Halstead, Kass and DeRose, "Efficient, fair interpolation using Catmull–Clark
//!   surfaces", SIGGRAPH 1993 (limits).
//! - Departs from it: the limit masks are written with the means of faces and so hold at polygons too;
//!   creases as in DeRose et al. 1998.

/// How much a smooth vertex of this valence, each of its neighbors and each face point count.
pub fn catmull_clark_vertex(valence: usize) -> [f64; 3] {
    let d = valence as f64;
    [(d - 2.0) / d, 1.0 / (d * d), 1.0 / (d * d)]
}

/// The same for its limit position.
pub fn catmull_clark_limit(valence: usize) -> [f64; 3] {
    let d = valence as f64;
    [(d - 1.0) / (d + 5.0), 2.0 / (d * (d + 5.0)), 4.0 / (d * (d + 5.0))]
}

/// A of the tangents for an angle of 2π/d per edge: what a neighbor counts where a corner across counts
/// the sum of two waves.
pub(crate) fn tangent_factor(angle: f64) -> f64 {
    let cos = angle.cos();
    1.0 + cos + (angle / 2.0).cos() * (2.0 * (9.0 + cos)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_vertices_have_the_masks_of_bicubic_splines() {
        // 9/16, 3/32 and 1/64 among quadrilaterals, where a face point is the mean of four corners.
        let [v, w, f] = catmull_clark_vertex(4);
        assert_eq!([v + f, w + f / 2.0, f / 4.0], [9.0 / 16.0, 3.0 / 32.0, 1.0 / 64.0]);
        let [v, w, f] = catmull_clark_limit(4);
        let masks = [v + f, w + f / 2.0, f / 4.0];
        for (mask, expected) in masks.iter().zip([4.0 / 9.0, 1.0 / 9.0, 1.0 / 36.0]) {
            assert!((mask - expected).abs() < 1e-16, "{masks:?}");
        }
        assert!((tangent_factor(std::f64::consts::FRAC_PI_2) - 4.0).abs() < 1e-15);
    }
}
