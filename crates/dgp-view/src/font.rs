//! Letters: the printable characters of ASCII as strokes between the points of a 5×9 raster.
//!
//! Glyphs are stored as bitmaps, of which the last two rows are for what hangs below the line. Points
//! that are neighbors in the bitmap are joined by strokes (diagonal ones only where no corner already
//! joins them), so that text is smooth at any size.

use crate::{
    Image,
    color::{Encoder, Linear},
};

/// The height of a capital letter, in raster units.
const CAPITAL: f64 = 6.0;
/// From one letter to the next.
const ADVANCE: f64 = 6.0;

/// How text is written: its color, and how high capital letters are, in pixels.
#[derive(Clone, Copy)]
pub(crate) struct Pen {
    pub(crate) color: Linear,
    pub(crate) height: f64,
}

impl Pen {
    /// How wide text is, in pixels.
    pub(crate) fn width(&self, text: &str) -> f64 {
        (text.chars().count() as f64 * ADVANCE - 2.0) * self.height / CAPITAL
    }

    /// Writes `text` with its lower left corner at `(x, y)`, counted from the upper left of the image.
    /// What is not ASCII becomes a question mark.
    pub(crate) fn write(&self, image: &mut Image, encoder: &Encoder, text: &str, x: f64, y: f64) {
        let unit = self.height / CAPITAL;
        for (i, character) in text.chars().enumerate() {
            let left = x + i as f64 * ADVANCE * unit;
            self.draw(image, encoder, glyph(character), left, y - CAPITAL * unit);
        }
    }

    /// Draws a glyph whose upper left point is at `(left, top)`.
    fn draw(&self, image: &mut Image, encoder: &Encoder, glyph: Glyph, left: f64, top: f64) {
        let unit = self.height / CAPITAL;
        let strokes = glyph.strokes();
        let half = (0.52 * unit).max(0.5);
        let (w, h) = ((4.0 * unit + half).ceil() as i64 + 1, (8.0 * unit + half).ceil() as i64 + 1);
        let margin = half.ceil() as i64 + 1;
        let (x0, y0) = (left.floor() as i64, top.floor() as i64);
        for y in y0 - margin..y0 + h + margin {
            for x in x0 - margin..x0 + w + margin {
                let (px, py) = ((x as f64 + 0.5 - left) / unit, (y as f64 + 0.5 - top) / unit);
                let distance = strokes.iter().map(|s| s.distance(px, py)).fold(f64::MAX, f64::min);
                let cover = (half - distance * unit + 0.5).clamp(0.0, 1.0);
                image.blend(encoder, x, y, self.color, cover as f32);
            }
        }
    }
}

/// A bitmap of nine rows of five points; the highest of the five bits is the left one.
#[derive(Clone, Copy)]
struct Glyph([u8; 9]);

/// A line between two points of the raster.
struct Stroke {
    from: [f64; 2],
    along: [f64; 2],
}

impl Stroke {
    fn distance(&self, x: f64, y: f64) -> f64 {
        let (px, py) = (x - self.from[0], y - self.from[1]);
        let [dx, dy] = self.along;
        let length = dx * dx + dy * dy;
        let t = if length > 0.0 { ((px * dx + py * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
        (px - t * dx).hypot(py - t * dy)
    }
}

impl Glyph {
    fn has(&self, x: i32, y: i32) -> bool {
        (0..5).contains(&x) && (0..9).contains(&y) && self.0[y as usize] >> (4 - x) & 1 == 1
    }

    fn strokes(&self) -> Vec<Stroke> {
        let mut strokes = Vec::new();
        for (x, y) in
            (0..9).flat_map(|y| (0..5).map(move |x| (x, y))).filter(|&(x, y)| self.has(x, y))
        {
            let mut add = |dx: i32, dy: i32| {
                let from = [f64::from(x), f64::from(y)];
                strokes.push(Stroke { from, along: [f64::from(dx), f64::from(dy)] });
            };
            add(0, 0);
            for (dx, dy) in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
                let cornered = dx != 0 && dy != 0 && (self.has(x + dx, y) || self.has(x, y + dy));
                if self.has(x + dx, y + dy) && !cornered {
                    add(dx, dy);
                }
            }
        }
        strokes
    }
}

fn glyph(character: char) -> Glyph {
    let index = (character as usize).wrapping_sub(' ' as usize);
    Glyph(*GLYPHS.get(index).unwrap_or(&GLYPHS['?' as usize - ' ' as usize]))
}

/// From the space to the tilde.
#[rustfmt::skip]
const GLYPHS: [[u8; 9]; 95] = [
    [0, 0, 0, 0, 0, 0, 0, 0, 0],
    [4, 4, 4, 4, 4, 0, 4, 0, 0],
    [10, 10, 10, 0, 0, 0, 0, 0, 0],
    [10, 10, 31, 10, 31, 10, 10, 0, 0],
    [4, 15, 20, 14, 5, 30, 4, 0, 0],
    [24, 25, 2, 4, 8, 19, 3, 0, 0],
    [12, 18, 20, 8, 21, 18, 13, 0, 0],
    [4, 4, 8, 0, 0, 0, 0, 0, 0],
    [2, 4, 8, 8, 8, 4, 2, 0, 0],
    [8, 4, 2, 2, 2, 4, 8, 0, 0],
    [0, 4, 21, 14, 21, 4, 0, 0, 0],
    [0, 4, 4, 31, 4, 4, 0, 0, 0],
    [0, 0, 0, 0, 0, 0, 4, 4, 8],
    [0, 0, 0, 31, 0, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 0, 4, 0, 0],
    [0, 1, 2, 4, 8, 16, 0, 0, 0],
    [14, 17, 17, 17, 17, 17, 14, 0, 0],
    [4, 12, 4, 4, 4, 4, 14, 0, 0],
    [14, 17, 1, 2, 4, 8, 31, 0, 0],
    [31, 2, 4, 2, 1, 17, 14, 0, 0],
    [2, 6, 10, 18, 31, 2, 2, 0, 0],
    [31, 16, 30, 1, 1, 17, 14, 0, 0],
    [6, 8, 16, 30, 17, 17, 14, 0, 0],
    [31, 1, 2, 4, 8, 8, 8, 0, 0],
    [14, 17, 17, 14, 17, 17, 14, 0, 0],
    [14, 17, 17, 15, 1, 2, 12, 0, 0],
    [0, 0, 4, 0, 0, 0, 4, 0, 0],
    [0, 0, 4, 0, 0, 0, 4, 4, 8],
    [1, 2, 4, 8, 4, 2, 1, 0, 0],
    [0, 0, 31, 0, 31, 0, 0, 0, 0],
    [16, 8, 4, 2, 4, 8, 16, 0, 0],
    [14, 17, 1, 2, 4, 0, 4, 0, 0],
    [14, 17, 23, 21, 23, 16, 14, 0, 0],
    [4, 10, 17, 17, 31, 17, 17, 0, 0],
    [30, 17, 17, 30, 17, 17, 30, 0, 0],
    [14, 17, 16, 16, 16, 17, 14, 0, 0],
    [28, 18, 17, 17, 17, 18, 28, 0, 0],
    [31, 16, 16, 30, 16, 16, 31, 0, 0],
    [31, 16, 16, 30, 16, 16, 16, 0, 0],
    [14, 17, 16, 19, 17, 17, 14, 0, 0],
    [17, 17, 17, 31, 17, 17, 17, 0, 0],
    [14, 4, 4, 4, 4, 4, 14, 0, 0],
    [7, 2, 2, 2, 2, 18, 12, 0, 0],
    [17, 18, 20, 24, 20, 18, 17, 0, 0],
    [16, 16, 16, 16, 16, 16, 31, 0, 0],
    [17, 27, 21, 17, 17, 17, 17, 0, 0],
    [17, 17, 25, 21, 19, 17, 17, 0, 0],
    [14, 17, 17, 17, 17, 17, 14, 0, 0],
    [30, 17, 17, 30, 16, 16, 16, 0, 0],
    [14, 17, 17, 17, 21, 18, 13, 0, 0],
    [30, 17, 17, 30, 20, 18, 17, 0, 0],
    [14, 17, 16, 14, 1, 17, 14, 0, 0],
    [31, 4, 4, 4, 4, 4, 4, 0, 0],
    [17, 17, 17, 17, 17, 17, 14, 0, 0],
    [17, 17, 17, 17, 17, 10, 4, 0, 0],
    [17, 17, 17, 17, 21, 27, 17, 0, 0],
    [17, 17, 10, 4, 10, 17, 17, 0, 0],
    [17, 17, 10, 4, 4, 4, 4, 0, 0],
    [31, 1, 2, 4, 8, 16, 31, 0, 0],
    [14, 8, 8, 8, 8, 8, 14, 0, 0],
    [0, 16, 8, 4, 2, 1, 0, 0, 0],
    [14, 2, 2, 2, 2, 2, 14, 0, 0],
    [4, 10, 17, 0, 0, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 0, 0, 31, 0],
    [8, 4, 2, 0, 0, 0, 0, 0, 0],
    [0, 0, 14, 1, 15, 17, 15, 0, 0],
    [16, 16, 30, 17, 17, 17, 30, 0, 0],
    [0, 0, 14, 17, 16, 17, 14, 0, 0],
    [1, 1, 15, 17, 17, 17, 15, 0, 0],
    [0, 0, 14, 17, 31, 16, 14, 0, 0],
    [3, 4, 14, 4, 4, 4, 4, 0, 0],
    [0, 0, 15, 17, 17, 17, 15, 1, 14],
    [16, 16, 30, 17, 17, 17, 17, 0, 0],
    [4, 0, 12, 4, 4, 4, 14, 0, 0],
    [2, 0, 6, 2, 2, 2, 2, 2, 12],
    [16, 16, 18, 20, 24, 20, 18, 0, 0],
    [12, 4, 4, 4, 4, 4, 14, 0, 0],
    [0, 0, 26, 21, 21, 21, 21, 0, 0],
    [0, 0, 30, 17, 17, 17, 17, 0, 0],
    [0, 0, 14, 17, 17, 17, 14, 0, 0],
    [0, 0, 30, 17, 17, 17, 30, 16, 16],
    [0, 0, 15, 17, 17, 17, 15, 1, 1],
    [0, 0, 22, 24, 16, 16, 16, 0, 0],
    [0, 0, 15, 16, 14, 1, 30, 0, 0],
    [8, 8, 28, 8, 8, 8, 6, 0, 0],
    [0, 0, 17, 17, 17, 17, 15, 0, 0],
    [0, 0, 17, 17, 17, 10, 4, 0, 0],
    [0, 0, 17, 17, 21, 21, 10, 0, 0],
    [0, 0, 17, 10, 4, 10, 17, 0, 0],
    [0, 0, 17, 17, 17, 17, 15, 1, 14],
    [0, 0, 31, 2, 4, 8, 31, 0, 0],
    [2, 4, 4, 8, 4, 4, 2, 0, 0],
    [4, 4, 4, 4, 4, 4, 4, 0, 0],
    [8, 4, 4, 2, 4, 4, 8, 0, 0],
    [0, 0, 8, 21, 2, 0, 0, 0, 0],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Encoder;

    #[test]
    fn every_character_but_the_space_leaves_ink() {
        for character in ' '..='~' {
            let inked = !glyph(character).strokes().is_empty();
            assert_eq!(inked, character != ' ', "{character:?}");
        }
    }

    #[test]
    fn text_stays_within_its_width_and_outside_the_picture_nothing_happens() {
        let encoder = Encoder::new();
        let pen = Pen { color: [0.0; 3], height: 12.0 };
        let mut image = Image::new(200, 40);
        pen.write(&mut image, &encoder, "Hg|é", 10.0, 30.0);
        pen.write(&mut image, &encoder, "far off", -1e6, 1e6);
        let columns = (0..200).filter(|&x| (0..40).any(|y| image.pixel(x, y)[3] > 0));
        let (first, last) = (columns.clone().min().unwrap(), columns.max().unwrap());
        let end = 10.0 + pen.width("Hg|é");
        assert!(first >= 8 && f64::from(last) <= end + 2.0, "{first}..{last}, {end}");
    }
}
