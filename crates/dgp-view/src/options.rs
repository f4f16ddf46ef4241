//! How a scene becomes a picture.

use std::str::FromStr;

use dgp_mesh::{Color, DVec3};

use crate::Error;

/// How a scene becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
    /// Samples per pixel and direction, 1 to 8: with 2 each pixel is the mean of 2×2 samples.
    pub samples: u32,
    /// Where the camera looks from.
    pub view: View,
    /// Which direction points up in the picture.
    pub up: Up,
    /// Whether distant things look smaller.
    pub projection: Projection,
    /// Whether all panels share one camera.
    pub framing: Framing,
    /// How many panels there are in a row.
    pub columns: Columns,
    /// What is seen behind the models.
    pub background: Background,
    /// How much of a picture's side is left free around the models, 0 to 0.45.
    pub margin: f64,
    /// How dark hollows become, 0 (not at all) to 1.
    pub occlusion: f64,
    /// How dark the shadow on the ground below is, 0 (none) to 1.
    pub shadow: f64,
    /// Whether scalars come with a color bar.
    pub color_bars: ColorBars,
}

/// Where the camera looks from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum View {
    /// From the front, a little from the right and from above.
    #[default]
    ThreeQuarter,
    /// From the front: +z, or −y where z points up.
    Front,
    /// From behind.
    Back,
    /// From −x.
    Left,
    /// From +x.
    Right,
    /// From above.
    Top,
    /// From below.
    Bottom,
    /// From this direction as seen from the models, at the distance where they fill the picture.
    From(DVec3),
    /// From a point toward another, with a perspective camera that is not moved to fit.
    Eye {
        /// Where the camera is.
        eye: DVec3,
        /// A point in the middle of the picture.
        target: DVec3,
    },
}

/// Which direction points up in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// +y, as in most scans.
    #[default]
    Y,
    /// +z, as in engineering and geography.
    Z,
}

/// Whether distant things look smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Yes.
    Perspective {
        /// The angle in radians that the shorter side of a panel spans, 0.001 to 3.
        field_of_view: f64,
    },
    /// No: parallel lines stay parallel.
    Orthographic,
}

/// Whether all panels share one camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Framing {
    /// Each panel is filled by its own models.
    #[default]
    Each,
    /// All panels show the same part of space, so that sizes and places can be compared.
    Shared,
}

/// How many panels there are in a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Columns {
    /// As many as show them largest.
    #[default]
    Auto,
    /// That many.
    Count(u32),
}

/// What is seen behind the models.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// A light gray that grows darker toward the bottom.
    #[default]
    Gradient,
    /// One color.
    Plain(Color),
    /// Nothing: its pixels have alpha 0.
    Transparent,
}

/// Whether scalars come with a color bar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBars {
    /// One to the right of each panel with scalars.
    #[default]
    Shown,
    /// None.
    Hidden,
}

impl Default for RenderOptions {
    fn default() -> Self {
        RenderOptions {
            width: 1200,
            height: 900,
            samples: 2,
            view: View::default(),
            up: Up::default(),
            projection: Projection::default(),
            framing: Framing::default(),
            columns: Columns::default(),
            background: Background::default(),
            margin: 0.05,
            occlusion: 0.5,
            shadow: 0.35,
            color_bars: ColorBars::default(),
        }
    }
}

impl Default for Projection {
    /// A long lens: little distortion, and still depth.
    fn default() -> Self {
        Projection::Perspective { field_of_view: 0.5 }
    }
}

/// The most samples of a picture: eight bytes are kept for each, a gibibyte in all.
pub(crate) const MAX_SAMPLES: u64 = 1 << 27;

/// The most samples in a row or column: places are counted in 1/256 of a sample, in 32 bits.
const MAX_SIDE: u64 = 1 << 20;

impl RenderOptions {
    /// An error naming the first option out of range.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let &RenderOptions { width, height, samples, margin, occlusion, shadow, .. } = self;
        if !(1..=8).contains(&samples) {
            return Err(Error::option("samples", f64::from(samples), "from 1 to 8"));
        }
        for (name, side) in [("width", width), ("height", height)] {
            if u64::from(side) * u64::from(samples) > MAX_SIDE {
                let expected = "at most 2²⁰ divided by `samples`";
                return Err(Error::option(name, f64::from(side), expected));
            }
        }
        let total = u128::from(width) * u128::from(height) * u128::from(samples * samples);
        if total == 0 || total > u128::from(MAX_SAMPLES) {
            let total = u64::try_from(total).unwrap_or(u64::MAX);
            return Err(Error::ImageSize { width, height, samples, total, limit: MAX_SAMPLES });
        }
        if !(0.0..=0.45).contains(&margin) {
            return Err(Error::option("margin", margin, "from 0 to 0.45"));
        }
        if !(0.0..=1.0).contains(&occlusion) {
            return Err(Error::option("occlusion", occlusion, "from 0 to 1"));
        }
        if !(0.0..=1.0).contains(&shadow) {
            return Err(Error::option("shadow", shadow, "from 0 to 1"));
        }
        if let Columns::Count(0) = self.columns {
            return Err(Error::option("columns", 0.0, "at least 1"));
        }
        if let Projection::Perspective { field_of_view } = self.projection
            && !(0.001..=3.0).contains(&field_of_view)
        {
            return Err(Error::option("field_of_view", field_of_view, "from 0.001 to 3 radians"));
        }
        match self.view {
            View::From(direction) if !is_direction(direction) => {
                Err(Error::option("view", direction.length(), "a direction of positive length"))
            }
            View::Eye { eye, target } if !is_direction(eye - target) => {
                let distance = (eye - target).length();
                Err(Error::option("view", distance, "an eye at a positive distance of its target"))
            }
            _ => Ok(()),
        }
    }
}

/// Whether a vector says in which direction to look.
fn is_direction(v: DVec3) -> bool {
    v.is_finite() && v != DVec3::ZERO
}

impl FromStr for View {
    type Err = Error;

    /// `front`, `back`, `left`, `right`, `top`, `bottom`, `three-quarter`, or a direction `x,y,z`.
    fn from_str(word: &str) -> Result<Self, Error> {
        let unknown = || Error::UnknownName {
            word: word.to_owned(),
            what: "view",
            expected: "front, back, left, right, top, bottom, three-quarter or a direction x,y,z",
        };
        Ok(match word.to_ascii_lowercase().as_str() {
            "three-quarter" => View::ThreeQuarter,
            "front" => View::Front,
            "back" => View::Back,
            "left" => View::Left,
            "right" => View::Right,
            "top" => View::Top,
            "bottom" => View::Bottom,
            other => {
                let numbers: Result<Vec<f64>, _> =
                    other.split(',').map(|number| number.trim().parse()).collect();
                match numbers.as_deref() {
                    Ok(&[x, y, z]) if is_direction(DVec3::new(x, y, z)) => {
                        View::From(DVec3::new(x, y, z))
                    }
                    _ => return Err(unknown()),
                }
            }
        })
    }
}

impl FromStr for Up {
    type Err = Error;

    /// `y` or `z`.
    fn from_str(word: &str) -> Result<Self, Error> {
        match word {
            "y" | "Y" => Ok(Up::Y),
            "z" | "Z" => Ok(Up::Z),
            _ => {
                Err(Error::UnknownName { word: word.to_owned(), what: "axis", expected: "y or z" })
            }
        }
    }
}

impl FromStr for Background {
    type Err = Error;

    /// `gradient`, `white`, `black`, `transparent`, or a color `#rrggbb`.
    fn from_str(word: &str) -> Result<Self, Error> {
        let plain = |rgb| Background::Plain(Color::from_rgb8(rgb));
        let digits = word.strip_prefix('#').filter(|d| d.len() == 6 && !d.starts_with('+'));
        match word.to_ascii_lowercase().as_str() {
            "gradient" => Ok(Background::Gradient),
            "white" => Ok(plain([255; 3])),
            "black" => Ok(plain([0; 3])),
            "transparent" | "none" => Ok(Background::Transparent),
            _ => match digits.map(|digits| u32::from_str_radix(digits, 16)) {
                Some(Ok(rgb)) => Ok(plain([(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8])),
                _ => Err(Error::UnknownName {
                    word: word.to_owned(),
                    what: "background",
                    expected: "gradient, white, black, transparent or #rrggbb",
                }),
            },
        }
    }
}
