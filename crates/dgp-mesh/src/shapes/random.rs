//! SplitMix64: random numbers that are the same on every machine.
//!
//! ```text
//! state ← state + 0x9e3779b97f4a7c15          2⁶⁴ / golden ratio, odd: visits every state
//! output = mix(state)                          two rounds of xor-shift and multiply
//! ```
//!
//! - Input: any seed.
//! - Cost: O(1) for a number.
//! - Guarantees: period 2⁶⁴; each seed gives its own sequence, close seeds unrelated ones.
//! - Reference: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014;
//!   constants of Stafford's variant 13. Not for cryptography.

use std::f64::consts::TAU;

use glam::DVec3;

/// A source of random numbers, set up by a seed.
///
/// ```
/// use dgp_mesh::shapes::Random;
///
/// let (mut a, mut b) = (Random::new(7), Random::new(7));
/// assert_eq!(a.uniform(), b.uniform());
/// assert!(a.below(6) < 6);
/// ```
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The source of this seed.
    pub const fn new(seed: u64) -> Self {
        Random { state: seed }
    }

    /// 64 random bits.
    pub const fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in 0..1, 1 excluded, all multiples of 2⁻⁵³ equally likely.
    pub const fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `bound`; 0 if `bound` is 0.
    ///
    /// Takes the upper part of a product (Lemire 2019); off from equal odds by bound / 2⁶⁴ at most.
    pub const fn below(&mut self, bound: usize) -> usize {
        ((self.bits() as u128 * bound as u128) >> 64) as usize
    }

    /// A number of the normal distribution of mean 0 and variance 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }

    /// A unit vector, all directions equally likely.
    pub fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.uniform() - 1.0;
        let (sin, cos) = (TAU * self.uniform()).sin_cos();
        let radius = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    }

    /// Puts `values` into random order, all orders equally likely (Fisher and Yates).
    pub fn shuffle<T>(&mut self, values: &mut [T]) {
        for i in (1..values.len()).rev() {
            values.swap(i, self.below(i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_that_of_the_paper() {
        // First outputs of the reference implementation for seed 1234567.
        let mut random = Random::new(1_234_567);
        let first: Vec<u64> = (0..3).map(|_| random.bits()).collect();
        let expected =
            [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!(first, expected);
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let mut random = Random::new(1);
        let count = 100_000;
        let (mut mean, mut square, mut center) = (0.0, 0.0, DVec3::ZERO);
        for _ in 0..count {
            let x = random.normal();
            mean += x / f64::from(count);
            square += x * x / f64::from(count);
            center += random.direction() / f64::from(count);
        }
        assert!(mean.abs() < 0.02 && (square - 1.0).abs() < 0.03, "{mean} {square}");
        assert!(center.length() < 0.02, "{center}");
    }

    #[test]
    fn shuffling_keeps_the_values() {
        let mut values: Vec<usize> = (0..100).collect();
        Random::new(3).shuffle(&mut values);
        assert_ne!(values, (0..100).collect::<Vec<_>>());
        values.sort_unstable();
        assert_eq!(values, (0..100).collect::<Vec<_>>());
    }
}
