//! Which mask a vertex has, given how sharp it and the edges around it are.
//!
//! ```text
//! a sharp vertex, or more than two sharp edges     corner    v stays
//! two sharp edges                                  crease    ¾ v + ⅛ (w + w′), ends of those edges
//! one, none                                        smooth    the mask of the scheme
//! ```
//!
//! Where the rule of the next level is another one, because sharpness wears off, the two masks are mixed:
//! the sharper counts as much as is left, the mean of the sharpnesses that end, at most 1.
//!
//! - Input: sharpness from 0 to 10 of a vertex and the edges around it.
//! - Cost: O(valence).
//! - Reference: DeRose, Kass and Truong, "Subdivision surfaces in character animation", SIGGRAPH 1998,
//!   section 3 and appendix B.
//! - Departs from it: the mean of all sharpnesses that end takes the place of that of two edges, so that
//!   corners wear off too; OpenSubdiv does so.

use crate::sharpness::{SHARP, decrement};

/// The mask of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    Smooth,
    /// The spokes that are sharp.
    Crease([usize; 2]),
    Corner,
}

/// A mask, or two mixed: the first counts `weight`, the second the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mix {
    pub(crate) first: Rule,
    pub(crate) second: Rule,
    pub(crate) weight: f64,
}

/// The rule for a vertex and its spokes, given their sharpness.
pub(crate) fn rule(vertex: f64, spokes: impl Iterator<Item = f64>) -> Rule {
    if vertex > 0.0 {
        return Rule::Corner;
    }
    let mut sharp = [0, 0];
    let mut count = 0;
    for (i, s) in spokes.enumerate() {
        if s > 0.0 {
            if count == 2 {
                return Rule::Corner;
            }
            sharp[count] = i;
            count += 1;
        }
    }
    if count == 2 { Rule::Crease(sharp) } else { Rule::Smooth }
}

/// The masks with which a vertex is refined, given the sharpness at this level.
pub(crate) fn mix(vertex: f64, spokes: &[f64]) -> Mix {
    let first = rule(vertex, spokes.iter().copied());
    let second = rule(decrement(vertex), spokes.iter().map(|&s| decrement(s)));
    if first == second {
        return Mix { first, second, weight: 1.0 };
    }
    let (mut sum, mut count) = (0.0, 0.0);
    for &s in spokes.iter().chain([&vertex]) {
        if s > 0.0 && decrement(s) == 0.0 {
            sum += s;
            count += 1.0;
        }
    }
    Mix { first, second, weight: f64::min(sum / count, 1.0) }
}

/// The rule that holds once everything that wears off has done so.
pub(crate) fn final_rule(vertex: f64, spokes: &[f64]) -> Rule {
    let forever = |s: f64| if s >= SHARP { SHARP } else { 0.0 };
    rule(forever(vertex), spokes.iter().map(|&s| forever(s)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_two_sharp_edges_make_a_corner() {
        assert_eq!(rule(0.0, [0.0, 1.0, 0.0].into_iter()), Rule::Smooth);
        assert_eq!(rule(0.0, [0.5, 0.0, 2.0].into_iter()), Rule::Crease([0, 2]));
        assert_eq!(rule(0.0, [1.0; 3].into_iter()), Rule::Corner);
        assert_eq!(rule(0.1, [0.0; 3].into_iter()), Rule::Corner);
    }

    #[test]
    fn rules_are_mixed_only_where_they_change() {
        // Two edges that end together, with a quarter and three quarters left.
        let both = mix(0.0, &[0.25, 0.0, 0.75]);
        assert_eq!(both, Mix { first: Rule::Crease([0, 2]), second: Rule::Smooth, weight: 0.5 });
        // One of three ends: corner to crease.
        let one = mix(0.0, &[SHARP, 0.3, 4.0, 0.0]);
        assert_eq!(one, Mix { first: Rule::Corner, second: Rule::Crease([0, 2]), weight: 0.3 });
        assert_eq!(mix(0.0, &[3.0, 0.0, 2.0]).weight, 1.0);
        assert_eq!(mix(0.5, &[0.0; 4]).weight, 0.5);
    }
}
