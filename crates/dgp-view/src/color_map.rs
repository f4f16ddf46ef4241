//! Color maps: from a number in 0..1 to a color.
//!
//! - Viridis: ten samples of the map of S. van der Walt and N. Smith (2015, public domain), joined by
//!   lines; perceptually uniform, readable in gray and by the color-blind. The default.
//! - Cool–warm: the nine samples given in Moreland, "Diverging color maps for scientific
//!   visualization", ISVC 2009; for values on both sides of a neutral one.
//! - Turbo: the polynomial published in Mikhailov, "Turbo, an improved rainbow colormap for
//!   visualization", 2019; shows most detail, but no order.
//! - Gray: from nearly black to nearly white.

use std::str::FromStr;

use dgp_mesh::Color;

use crate::{
    Error,
    color::{Linear, linear},
};

/// How numbers in 0..1 become colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// From dark blue over green to yellow, equally spaced to the eye.
    #[default]
    Viridis,
    /// From blue over light gray to red, for deviations from a middle.
    CoolWarm,
    /// A rainbow from dark blue over green to dark red.
    Turbo,
    /// From dark to light gray.
    Gray,
}

const VIRIDIS: [[u8; 3]; 10] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x28, 0x78],
    [0x3e, 0x4a, 0x89],
    [0x31, 0x68, 0x8e],
    [0x26, 0x82, 0x8e],
    [0x1f, 0x9e, 0x89],
    [0x35, 0xb7, 0x79],
    [0x6d, 0xcd, 0x59],
    [0xb4, 0xde, 0x2c],
    [0xfd, 0xe7, 0x25],
];

const COOL_WARM: [[u8; 3]; 9] = [
    [59, 76, 192],
    [98, 130, 234],
    [141, 176, 254],
    [184, 208, 249],
    [221, 221, 221],
    [245, 196, 173],
    [244, 154, 123],
    [222, 96, 77],
    [180, 4, 38],
];

const GRAY: [[u8; 3]; 2] = [[25; 3], [240; 3]];

/// Coefficients of red, green and blue by rising power.
const TURBO: [[f64; 6]; 3] = [
    [0.135_721_38, 4.615_392_60, -42.660_322_58, 132.131_082_34, -152.942_393_96, 59.286_379_43],
    [0.091_402_61, 2.194_188_39, 4.842_966_58, -14.185_033_33, 4.277_298_57, 2.829_566_04],
    [0.106_673_30, 12.641_946_08, -60.582_048_36, 110.362_767_71, -89.903_109_12, 27.348_249_73],
];

impl ColorMap {
    /// The color of `t`; what lies outside 0..1 has the color of the nearer end, no number the first.
    pub fn color(self, t: f64) -> Color {
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        match self {
            ColorMap::Viridis => between(&VIRIDIS, t),
            ColorMap::CoolWarm => between(&COOL_WARM, t),
            ColorMap::Gray => between(&GRAY, t),
            ColorMap::Turbo => {
                let [r, g, b] = TURBO.map(|channel| {
                    channel.iter().rev().fold(0.0, |sum, c| sum * t + c).clamp(0.0, 1.0) as f32
                });
                Color([r, g, b, 1.0])
            }
        }
    }

    /// The colors of equally spaced numbers, to look up instead of computing.
    pub(crate) fn table(self) -> ColorTable {
        let color = |i| linear(self.color(i as f64 / (ColorTable::LEN - 1) as f64));
        ColorTable((0..ColorTable::LEN).map(color).collect())
    }
}

impl FromStr for ColorMap {
    type Err = Error;

    /// `viridis`, `coolwarm`, `turbo` or `gray`.
    fn from_str(word: &str) -> Result<Self, Error> {
        match word.to_ascii_lowercase().as_str() {
            "viridis" => Ok(ColorMap::Viridis),
            "coolwarm" | "cool-warm" => Ok(ColorMap::CoolWarm),
            "turbo" => Ok(ColorMap::Turbo),
            "gray" | "grey" => Ok(ColorMap::Gray),
            _ => Err(Error::UnknownName {
                word: word.to_owned(),
                what: "color map",
                expected: "viridis, coolwarm, turbo or gray",
            }),
        }
    }
}

/// A color map in steps too small to see.
pub(crate) struct ColorTable(Vec<Linear>);

impl ColorTable {
    const LEN: usize = 1024;

    /// The color of `t` in 0..1.
    #[inline]
    pub(crate) fn color(&self, t: f64) -> Linear {
        self.0[(t.clamp(0.0, 1.0) * (Self::LEN - 1) as f64).round() as usize]
    }
}

/// The color at `t` on the polyline through equally spaced samples.
fn between(samples: &[[u8; 3]], t: f64) -> Color {
    let x = t * (samples.len() - 1) as f64;
    let i = (x as usize).min(samples.len() - 2);
    let s = x - i as f64;
    let channel = |k: usize| {
        let (a, b) = (f64::from(samples[i][k]), f64::from(samples[i + 1][k]));
        ((a + s * (b - a)) / 255.0) as f32
    };
    Color([channel(0), channel(1), channel(2), 1.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_run_from_their_first_to_their_last_color() {
        let ends = |map: ColorMap| [0.0, 1.0].map(|t| map.color(t).to_rgba8());
        assert_eq!(ends(ColorMap::Viridis), [[0x44, 1, 0x54, 255], [0xfd, 0xe7, 0x25, 255]]);
        assert_eq!(ends(ColorMap::CoolWarm), [[59, 76, 192, 255], [180, 4, 38, 255]]);
        assert_eq!(ends(ColorMap::Gray), [[25, 25, 25, 255], [240, 240, 240, 255]]);
        let strongest = |t: f64| {
            let color = ColorMap::Turbo.color(t).to_rgba8();
            (0..3).max_by_key(|&k| color[k])
        };
        assert_eq!([0.12, 0.45, 0.9].map(strongest), [Some(2), Some(1), Some(0)]);
    }

    #[test]
    fn the_middle_of_the_diverging_map_is_neutral() {
        assert_eq!(ColorMap::CoolWarm.color(0.5).to_rgba8(), [221, 221, 221, 255]);
    }

    #[test]
    fn numbers_out_of_range_take_the_nearer_end() {
        for map in [ColorMap::Viridis, ColorMap::CoolWarm, ColorMap::Turbo, ColorMap::Gray] {
            assert_eq!(map.color(-3.0), map.color(0.0));
            assert_eq!(map.color(f64::INFINITY), map.color(1.0));
            assert_eq!(map.color(f64::NAN), map.color(0.0));
        }
    }
}
