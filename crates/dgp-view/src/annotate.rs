//! Captions and color bars.

use crate::{
    Background, Image,
    color::{Encoder, Linear},
    font::Pen,
    ink::ScalarInk,
    layout::{Cell, Rect},
    ticks::Ticks,
};

/// Writes on a finished picture.
pub(crate) struct Writer<'i> {
    pub(crate) image: &'i mut Image,
    pub(crate) encoder: &'i Encoder,
    pub(crate) background: Background,
}

impl Writer<'_> {
    /// Writes `text` in the middle below the models of a cell.
    pub(crate) fn caption(&mut self, cell: &Cell, text: &str) {
        let text = fitting(text, f64::from(cell.whole.width) / cell.text);
        let pen = self.pen(cell.text);
        let x = f64::from(cell.whole.x) + 0.5 * (f64::from(cell.whole.width) - pen.width(&text));
        let y = f64::from(cell.whole.y + cell.whole.height) - 1.2 * cell.text;
        pen.write(self.image, self.encoder, &text, x.round(), y.round());
    }

    /// Writes `text` in the middle of a cell.
    pub(crate) fn note(&mut self, cell: &Cell, text: &str) {
        let pen = self.pen(1.5 * cell.text);
        let x = f64::from(cell.view.x) + 0.5 * (f64::from(cell.view.width) - pen.width(text));
        let y = f64::from(cell.view.y) + 0.5 * (f64::from(cell.view.height) + pen.height);
        pen.write(self.image, self.encoder, text, x.round(), y.round());
    }

    /// Draws a color bar with its ticks to the right of the models.
    pub(crate) fn color_bar(&mut self, cell: &Cell, ink: &ScalarInk<'_>) {
        let text = cell.text;
        let pen = self.pen(text);
        let bar = bar_rect(cell);
        for row in 0..bar.height {
            let t = 1.0 - (f64::from(row) + 0.5) / f64::from(bar.height);
            let color = if ink.range.is_some() { ink.bar_color(t) } else { [0.5; 3] };
            for column in 0..bar.width {
                self.blend(bar.x + column, bar.y + row, color);
            }
        }
        let label = fitting(&ink.scalars.label, 9.0);
        pen.write(
            self.image,
            self.encoder,
            &label,
            f64::from(bar.x),
            (f64::from(bar.y) - 1.2 * text).round(),
        );
        let Some((low, high)) = ink.range else { return };
        let ticks =
            Ticks::new(low, high, (f64::from(bar.height) / (5.0 * text)).clamp(1.0, 8.0) as usize);
        for (value, label) in ticks.values.iter().zip(&ticks.labels) {
            let t = crate::paint::fraction(*value, (low, high)).clamp(0.0, 1.0);
            let y = f64::from(bar.y) + (1.0 - t) * f64::from(bar.height);
            let row = (y as u32).clamp(bar.y, bar.y + bar.height - 1);
            let right = bar.x + bar.width;
            for column in 0..(0.5 * text) as u32 {
                self.blend(right + column, row, pen.color);
            }
            let (x, base) = (f64::from(right) + 0.9 * text, y + 0.5 * text);
            pen.write(self.image, self.encoder, label, x.round(), base.round());
        }
    }

    fn blend(&mut self, x: u32, y: u32, color: Linear) {
        self.image.blend(self.encoder, i64::from(x), i64::from(y), color, 1.0);
    }

    /// Dark on a light background, light on a dark one.
    fn pen(&self, height: f64) -> Pen {
        let is_dark = match self.background {
            Background::Plain(color) => crate::color::linear(color).iter().sum::<f32>() < 0.5,
            Background::Gradient | Background::Transparent => false,
        };
        Pen { color: if is_dark { [0.8; 3] } else { [0.015; 3] }, height }
    }
}

/// The colors of a color bar.
fn bar_rect(cell: &Cell) -> Rect {
    let text = cell.text;
    let height = (0.62 * f64::from(cell.view.height)) as u32;
    Rect {
        x: cell.view.x + cell.view.width + (0.5 * text) as u32,
        y: cell.view.y + (cell.view.height - height) / 2,
        width: (1.4 * text) as u32,
        height: height.max(1),
    }
}

/// As much of `text` as fits into `letters` times the height of a letter.
fn fitting(text: &str, letters: f64) -> String {
    let most = letters.max(2.0) as usize;
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most - 2).chain("..".chars()).collect()
}
