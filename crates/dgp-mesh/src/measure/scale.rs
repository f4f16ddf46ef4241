//! Exact scaling by powers of two, so that lengths near 1e±300 neither overflow nor vanish.
//!
//! Multiplying by a power of two changes no bit of the mantissa. Vectors are brought to about 1, the
//! formula runs there, and the result is brought back. So a mesh scaled by 2^k gives results scaled
//! by exactly 2^k, 2^2k or 2^3k.

use glam::DVec3;

/// The power of two next below a length, and its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// What brings numbers of that size to about 1.
    pub(crate) down: f64,
    /// What brings them back.
    pub(crate) up: f64,
}

impl Scale {
    /// The scale of numbers of which `size` is the largest; 1 for zero.
    #[inline]
    pub(crate) fn of(size: f64) -> Self {
        const BIAS: i64 = 1023;
        if size == 0.0 {
            return Scale { down: 1.0, up: 1.0 };
        }
        // Both 2^e and 2^-e are normal numbers for |e| ≤ 1022.
        let exponent = ((size.to_bits() >> 52 & 0x7ff) as i64 - BIAS).clamp(-1022, 1022);
        let power = |e: i64| f64::from_bits(((e + BIAS) as u64) << 52);
        Scale { down: power(-exponent), up: power(exponent) }
    }

    /// The scale of the larger of two vectors.
    #[inline]
    pub(crate) fn of_vectors(u: DVec3, v: DVec3) -> Self {
        Scale::of(u.abs().max(v.abs()).max_element())
    }
}

/// Half the vector from `a` to `b`: unlike the vector itself it cannot overflow.
#[inline]
pub(crate) fn half_side(a: DVec3, b: DVec3) -> DVec3 {
    0.5 * b - 0.5 * a
}

/// The distance between `a` and `b`; infinite only where it exceeds what an f64 holds.
#[inline]
pub(crate) fn distance(a: DVec3, b: DVec3) -> f64 {
    2.0 * length(half_side(a, b))
}

/// The length of `u`, not the square root of an overflown or vanished square.
#[inline]
pub(crate) fn length(u: DVec3) -> f64 {
    let scale = Scale::of(u.abs().max_element());
    (u * scale.down).length() * scale.up
}

/// The direction of `u`; zero if `u` is.
#[inline]
pub(crate) fn unit(u: DVec3) -> DVec3 {
    let u = u * Scale::of(u.abs().max_element()).down;
    let length = u.length();
    if length > 0.0 { u / length } else { DVec3::ZERO }
}

/// The vector area of the triangle a, b, c; infinite where it exceeds what an f64 holds.
#[inline]
pub(crate) fn vector_area(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let (u, v) = (half_side(a, b), half_side(a, c));
    let scale = Scale::of_vectors(u, v);
    (u * scale.down).cross(v * scale.down) * 2.0 * scale.up * scale.up
}

/// The angle between `u` and `v` in [0, π], accurate for small angles and near π too; 0 if one of
/// them is zero.
#[inline]
pub(crate) fn angle(u: DVec3, v: DVec3) -> f64 {
    let u = u * Scale::of(u.abs().max_element()).down;
    let v = v * Scale::of(v.abs().max_element()).down;
    u.cross(v).length().atan2(u.dot(v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_near_the_ends_of_the_range_are_right() {
        for size in [1e-300, 1e-200, 1.0, 1e200, 1e300] {
            let u = size * DVec3::new(3.0, 4.0, 12.0);
            assert!((length(u) / size - 13.0).abs() < 1e-12, "{size}");
            assert!((unit(u).length() - 1.0).abs() < 1e-15, "{size}");
            let right = angle(u, size * DVec3::new(4.0, -3.0, 0.0));
            assert!((right - std::f64::consts::FRAC_PI_2).abs() < 1e-15, "{size}");
        }
        assert_eq!((length(DVec3::ZERO), unit(DVec3::ZERO)), (0.0, DVec3::ZERO));
    }

    #[test]
    fn small_angles_keep_their_digits() {
        let tiny = angle(DVec3::X, DVec3::new(1.0, 1e-12, 0.0));
        assert!((tiny / 1e-12 - 1.0).abs() < 1e-12, "acos would give 0: {tiny}");
    }
}
