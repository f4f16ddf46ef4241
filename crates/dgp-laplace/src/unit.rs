//! A power of two near the size of the input, so that nothing overflows or vanishes on the way and a scaled
//! input gives exactly scaled results.

use dgp_mesh::DVec3;

/// The power of two that brings the largest coordinate of `points` to between 1 and 2; 1 if all are zero.
pub(crate) fn unit_of(points: &[DVec3]) -> f64 {
    let largest = points.iter().fold(DVec3::ZERO, |largest, p| largest.max(p.abs()));
    power_of_two_below(largest.max_element())
}

/// The power of two that brings `size` to between 1 and 2; 1 for zero.
pub(crate) fn power_of_two_below(size: f64) -> f64 {
    if size == 0.0 {
        return 1.0;
    }
    // Beyond these the inverse would not be a normal number.
    let exponent = ((size.to_bits() >> 52 & 0x7ff) as i32 - 1023).clamp(-1000, 1000);
    f64::from_bits(((1023 - exponent) as u64) << 52)
}
