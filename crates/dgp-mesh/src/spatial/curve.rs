//! Order along a curve through space that keeps together what is near.
//!
//! The place on the curve of Z-order has the bits of the three coordinates one after the other.
//!
//! - Input: points around the middle of a frame.
//! - Cost: O(n): keys in parallel, then three passes of a radix sort.
//! - Reference: Morton, "A computer oriented geodetic data base and a new technique in file sequencing",
//!   IBM, 1966.

use crate::parallel;

/// Bits of each coordinate, and of a digit of the sort.
const BITS: u32 = 10;
const DIGIT: u32 = 10;

/// Where on the curve a point around the middle of the frame is; those outside count as at its border.
#[inline]
pub(super) fn key(local: [f64; 3]) -> u32 {
    // The box of a frame lies within −2..2 and fills half of it at least.
    let [x, y, z] = local.map(|x| {
        let cell = (x + 2.0) * f64::from(1 << (BITS - 2));
        spread((cell as u32).min((1 << BITS) - 1))
    });
    x | y << 1 | z << 2
}

/// The keys of `0..len` in order, and the number of each; equal ones in order of their numbers.
pub(super) fn sorted(len: usize, key: impl Fn(usize) -> u32 + Sync + Send) -> Vec<(u32, u32)> {
    let mut keys: Vec<(u32, u32)> =
        parallel::map(len, |i: crate::VertexId| (key(i.index()), i.index() as u32)).into_values();
    let mut sorted = keys.clone();
    for shift in (0..3 * BITS).step_by(DIGIT as usize) {
        let digit = |key: u32| (key >> shift & ((1 << DIGIT) - 1)) as usize;
        let mut starts = [0_u32; 1 << DIGIT];
        for &(key, _) in &keys {
            starts[digit(key)] += 1;
        }
        let mut start = 0;
        for count in &mut starts {
            start += std::mem::replace(count, start);
        }
        for &pair in &keys {
            let place = &mut starts[digit(pair.0)];
            sorted[*place as usize] = pair;
            *place += 1;
        }
        std::mem::swap(&mut keys, &mut sorted);
    }
    keys
}

/// The ten lowest bits of `x`, two zeros between them.
#[inline]
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}
