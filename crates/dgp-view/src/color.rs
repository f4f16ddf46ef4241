//! Colors as light: sums and averages are right only in linear intensities, so everything between
//! reading a color and writing a pixel happens there.
//!
//! Reference: IEC 61966-2-1 (sRGB).

use dgp_mesh::Color;

/// Red, green and blue intensities in 0..1.
pub(crate) type Linear = [f32; 3];

/// The intensities of a color; what is no number becomes 0.
pub(crate) fn linear(color: Color) -> Linear {
    let [r, g, b, _] = color.0;
    [r, g, b].map(|x| decode(if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }))
}

/// a + t (b − a)
pub(crate) fn mix(a: Linear, b: Linear, t: f32) -> Linear {
    std::array::from_fn(|k| a[k] + t * (b[k] - a[k]))
}

/// s a
pub(crate) fn scale(a: Linear, s: f32) -> Linear {
    a.map(|x| x * s)
}

fn decode(x: f32) -> f32 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Turns intensities into bytes, each rounded exactly.
pub(crate) struct Encoder {
    /// `[c]` is the smallest intensity whose byte is c.
    thresholds: [f32; 256],
    /// A byte that is not too large for the intensities from i / CELLS on.
    guesses: Vec<u8>,
}

/// So fine that a guess is at most a few steps off even where the curve is steepest.
const CELLS: usize = 4096;

impl Encoder {
    pub(crate) fn new() -> Self {
        let thresholds = std::array::from_fn(|c| match c {
            0 => f32::NEG_INFINITY,
            _ => decode((c as f32 - 0.5) / 255.0),
        });
        let guess = |i: usize| thresholds.partition_point(|&t| t <= i as f32 / CELLS as f32) - 1;
        Encoder { thresholds, guesses: (0..=CELLS).map(|i| guess(i) as u8).collect() }
    }

    /// The byte for an intensity; those out of range are clamped.
    #[inline]
    pub(crate) fn byte(&self, intensity: f32) -> u8 {
        let x = intensity.clamp(0.0, 1.0);
        let mut byte = self.guesses[(x * CELLS as f32) as usize];
        while byte < 255 && self.thresholds[byte as usize + 1] <= x {
            byte += 1;
        }
        byte
    }

    /// A pixel from intensities already multiplied by `alpha`.
    #[inline]
    pub(crate) fn pixel(&self, color: Linear, alpha: f32) -> [u8; 4] {
        if alpha <= 0.0 {
            return [0; 4];
        }
        let [r, g, b] = color.map(|x| self.byte(x / alpha));
        [r, g, b, (alpha.min(1.0) * 255.0).round() as u8]
    }
}

/// The intensities of a pixel and its alpha in 0..1.
pub(crate) fn decode_pixel(pixel: [u8; 4]) -> (Linear, f32) {
    let [r, g, b, a] = pixel.map(|x| f32::from(x) / 255.0);
    ([r, g, b].map(decode), a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_the_way_to_light_and_back() {
        let encoder = Encoder::new();
        for x in 0..=255_u8 {
            let [r, ..] = linear(Color::from_rgb8([x; 3]));
            assert_eq!(encoder.byte(r), x);
        }
        assert_eq!((encoder.byte(-1.0), encoder.byte(7.0)), (0, 255));
    }

    #[test]
    fn black_and_white_average_to_the_gray_of_half_the_light() {
        assert_eq!(Encoder::new().byte(0.5), 188);
    }
}
