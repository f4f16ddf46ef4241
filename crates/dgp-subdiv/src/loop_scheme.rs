//! Loop subdivision: triangles into four, toward a surface that bends without creases.
//!
//! ```text
//!            ⅛                          β     β
//!           ╱ ╲                          ╲   ╱
//!       ⅜ ●──◦──● ⅜  edge            β ──1−dβ── β   vertex of d edges
//!           ╲ ╱                          ╱   ╲
//!            ⅛                          β     β
//!
//! crease, rim of a hole:   ½ ──◦── ½    ⅛ ── ¾ ── ⅛    corner: stays
//!
//! original   β = (5/8 − (3/8 + ¼ cos 2π/d)²) / d
//! Warren     β = 3/(8d), 3/16 for d = 3
//! simple     β = 3/(d(d + 2))
//!
//! limit      (1 − dχ) v + χ Σ w     χ = 1/(3/(8β) + d)
//! tangents   Σ cos(2πi/d) w_i,  Σ sin(2πi/d) w_i
//! ```
//!
//! - Input: triangles; no vertex inside with only two faces.
//! - Cost: O(F) per level.
//! - Guarantees: masks are convex; curvature is continuous but at vertices of d ≠ 6 and at creases, where
//!   the tangent plane is.
//! - Reference: Loop, "Smooth subdivision surfaces based on triangles", master's thesis, Utah 1987;
//!   Warren, "Subdivision methods for geometric design", 1995; Hoppe et al., "Piecewise smooth surface
//!   reconstruction", SIGGRAPH 1994 (creases).
//! - Departs from it: creases as in DeRose et al. 1998 (see [`SHARP`](crate::SHARP)), one mask for all
//!   crease vertices, regular or not, as OpenSubdiv has it.

use std::f64::consts::TAU;

use crate::options::LoopWeights;

/// β, the weight of each of `valence` neighbors of a smooth vertex.
pub fn loop_beta(weights: LoopWeights, valence: usize) -> f64 {
    let d = valence as f64;
    match weights {
        LoopWeights::Original => {
            let inner = 3.0 / 8.0 + (TAU / d).cos() / 4.0;
            (5.0 / 8.0 - inner * inner) / d
        }
        LoopWeights::Warren if valence == 3 => 3.0 / 16.0,
        LoopWeights::Warren => 3.0 / (8.0 * d),
        LoopWeights::Simple => 3.0 / (d * (d + 2.0)),
    }
}

/// χ, the weight of each of `valence` neighbors of a smooth vertex in its limit position.
pub fn loop_limit(weights: LoopWeights, valence: usize) -> f64 {
    1.0 / (3.0 / (8.0 * loop_beta(weights, valence)) + valence as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_vertices_have_a_sixteenth_in_all_rules() {
        for weights in [LoopWeights::Original, LoopWeights::Warren, LoopWeights::Simple] {
            assert!((loop_beta(weights, 6) - 1.0 / 16.0).abs() < 1e-16, "{weights:?}");
        }
        assert!((loop_beta(LoopWeights::Original, 3) - 3.0 / 16.0).abs() < 1e-16);
        assert_eq!(loop_beta(LoopWeights::Warren, 3), 3.0 / 16.0);
        assert_eq!(loop_beta(LoopWeights::Simple, 3), 0.2);
    }

    #[test]
    fn masks_stay_convex() {
        for weights in [LoopWeights::Original, LoopWeights::Warren, LoopWeights::Simple] {
            for d in 2..200 {
                let beta = loop_beta(weights, d);
                assert!(beta > 0.0 && d as f64 * beta < 1.0, "{weights:?} {d}");
            }
        }
    }
}
