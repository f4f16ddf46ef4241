//! Line plots as SVG: spectra, rate–distortion curves, convergence.

use std::fmt::Write;

use crate::ticks::Ticks;

/// A plot of curves over a common axis.
///
/// ```
/// use dgp_view::{Axis, Curve, Plot};
///
/// let squares = (0..10).map(f64::from).map(|x| [x, x * x]).collect();
/// let plot = Plot { curves: vec![Curve::new("x²", squares)], ..Plot::new("Squares", "x", "y") };
/// assert!(plot.to_svg().starts_with("<svg"));
/// let plot = Plot { y_axis: Axis::Logarithmic, ..plot };
/// assert!(plot.to_svg().contains("polyline"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What is written above.
    pub title: String,
    /// What is written below the horizontal axis.
    pub x_label: String,
    /// What is written beside the vertical axis.
    pub y_label: String,
    /// How the horizontal axis is divided.
    pub x_axis: Axis,
    /// How the vertical axis is divided.
    pub y_axis: Axis,
    /// The curves, drawn in order.
    pub curves: Vec<Curve>,
}

/// How an axis is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// Equal steps are equal differences.
    #[default]
    Linear,
    /// Equal steps are equal ratios; what is not positive is left out.
    Logarithmic,
}

/// A curve of a [`Plot`].
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What the legend says.
    pub name: String,
    /// Points (x, y); those that are no numbers are left out.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub marker: Marker,
}

/// How the points of a [`Curve`] are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marker {
    /// Joined by a line.
    #[default]
    Line,
    /// As dots.
    Dots,
}

/// The size of the picture and of the part inside the axes, in pixels.
const SIZE: [f64; 2] = [800.0, 500.0];
const LEFT: f64 = 90.0;
const RIGHT: f64 = 780.0;
const TOP: f64 = 50.0;
const BOTTOM: f64 = 430.0;

/// Numbers larger than this are left out, since differences of two of them may not be numbers.
const LARGEST: f64 = 1e300;

/// Colors that the color-blind tell apart (Okabe and Ito 2008).
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

impl Plot {
    /// A plot without curves.
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        Plot {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            x_axis: Axis::Linear,
            y_axis: Axis::Linear,
            curves: Vec::new(),
        }
    }

    /// The plot as an SVG document.
    pub fn to_svg(&self) -> String {
        let all = || self.curves.iter().flat_map(|curve| self.drawn(curve));
        let x = Scale::new(self.x_axis, all().map(|p| p[0]), [LEFT, RIGHT]);
        let y = Scale::new(self.y_axis, all().map(|p| p[1]), [BOTTOM, TOP]);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" \
             font-family=\"sans-serif\" font-size=\"14\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
            SIZE[0], SIZE[1]
        );
        self.draw_axes(&mut svg, &x, &y);
        for (curve, color) in self.curves.iter().zip(COLORS.iter().cycle()) {
            let points = self.drawn(curve).map(|[a, b]| [x.place(a), y.place(b)]);
            draw_curve(&mut svg, points, curve.marker, color);
        }
        self.draw_legend(&mut svg);
        svg.push_str("</svg>\n");
        svg
    }

    /// The points of a curve that have a place.
    fn drawn<'a>(&self, curve: &'a Curve) -> impl Iterator<Item = [f64; 2]> + 'a {
        let (x_axis, y_axis) = (self.x_axis, self.y_axis);
        let points = curve.points.iter().copied();
        points.filter(move |p| x_axis.has_place(p[0]) && y_axis.has_place(p[1]))
    }

    fn draw_axes(&self, svg: &mut String, x: &Scale, y: &Scale) {
        for (value, label) in x.marks() {
            let at = x.place(value);
            line(svg, [at, TOP], [at, BOTTOM], "#dddddd");
            text(svg, [at, BOTTOM + 20.0], "middle", &label);
        }
        for (value, label) in y.marks() {
            let at = y.place(value);
            line(svg, [LEFT, at], [RIGHT, at], "#dddddd");
            text(svg, [LEFT - 8.0, at + 5.0], "end", &label);
        }
        line(svg, [LEFT, BOTTOM], [RIGHT, BOTTOM], "#333333");
        line(svg, [LEFT, TOP], [LEFT, BOTTOM], "#333333");
        let middle = [0.5 * (LEFT + RIGHT), 0.5 * (TOP + BOTTOM)];
        text(svg, [middle[0], BOTTOM + 48.0], "middle", &self.x_label);
        text(svg, [middle[0], TOP - 20.0], "middle", &self.title);
        push(
            svg,
            format_args!(
                "<text x=\"0\" y=\"0\" transform=\"translate(22 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                middle[1],
                escaped(&self.y_label)
            ),
        );
    }

    /// The names of curves, if there are several.
    fn draw_legend(&self, svg: &mut String) {
        if self.curves.len() < 2 {
            return;
        }
        for (i, (curve, color)) in self.curves.iter().zip(COLORS.iter().cycle()).enumerate() {
            let at = TOP + 18.0 + 20.0 * i as f64;
            push(
                svg,
                format_args!(
                    "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"14\" height=\"4\" fill=\"{color}\"/>\n",
                    RIGHT - 170.0,
                    at - 6.0
                ),
            );
            text(svg, [RIGHT - 148.0, at], "start", &curve.name);
        }
    }
}

impl Curve {
    /// A line through these points.
    pub fn new(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Curve { name: name.into(), points, marker: Marker::Line }
    }
}

impl Axis {
    fn has_place(self, value: f64) -> bool {
        value.abs() <= LARGEST && (self == Axis::Linear || value > 0.0)
    }

    /// What grows evenly along the axis.
    fn even(self, value: f64) -> f64 {
        if self == Axis::Linear { value } else { value.log10() }
    }
}

/// Where values are on an axis.
struct Scale {
    axis: Axis,
    /// The even values at both ends.
    range: [f64; 2],
    pixels: [f64; 2],
}

impl Scale {
    fn new(axis: Axis, values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for value in values.map(|value| axis.even(value)) {
            range = [range[0].min(value), range[1].max(value)];
        }
        if range[0] > range[1] {
            range = [0.0, 1.0];
        } else if range[0] == range[1] {
            let half = if range[0] == 0.0 { 1.0 } else { 0.5 * range[0].abs() };
            range = [range[0] - half, range[0] + half];
        }
        Scale { axis, range, pixels }
    }

    fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        // Halves, since the difference may leave the range of f64.
        let part = (0.5 * self.axis.even(value) - 0.5 * low) / (0.5 * high - 0.5 * low);
        self.pixels[0] + part * (self.pixels[1] - self.pixels[0])
    }

    /// Round values and how to write them.
    fn marks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.range;
        if self.axis == Axis::Linear {
            let ticks = Ticks::new(low, high, 6);
            return ticks.values.into_iter().zip(ticks.labels).collect();
        }
        // Powers of ten, or their ticks where there are too few.
        let (first, last) = (low.ceil() as i32, high.floor() as i32);
        if last - first >= 1 {
            let every = ((last - first) / 8 + 1) as usize;
            let powers = (first..=last).step_by(every);
            return powers.map(|p| (10_f64.powi(p), format!("1e{p}"))).collect();
        }
        let ticks = Ticks::new(10_f64.powf(low), 10_f64.powf(high), 5);
        ticks.values.into_iter().zip(ticks.labels).filter(|(value, _)| *value > 0.0).collect()
    }
}

fn draw_curve(
    svg: &mut String,
    points: impl Iterator<Item = [f64; 2]>,
    marker: Marker,
    color: &str,
) {
    if marker == Marker::Dots {
        for [x, y] in points {
            push(
                svg,
                format_args!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"3\" fill=\"{color}\"/>\n"),
            );
        }
        return;
    }
    svg.push_str("<polyline fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\" points=\"");
    for [x, y] in points {
        push(svg, format_args!("{x:.2},{y:.2} "));
    }
    push(svg, format_args!("\" stroke=\"{color}\"/>\n"));
}

fn line(svg: &mut String, from: [f64; 2], to: [f64; 2], color: &str) {
    push(
        svg,
        format_args!(
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{color}\"/>\n",
            from[0], from[1], to[0], to[1]
        ),
    );
}

fn text(svg: &mut String, at: [f64; 2], anchor: &str, words: &str) {
    push(
        svg,
        format_args!(
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>\n",
            at[0],
            at[1],
            escaped(words)
        ),
    );
}

fn push(svg: &mut String, arguments: std::fmt::Arguments<'_>) {
    svg.write_fmt(arguments).expect("a string takes everything");
}

/// Text in which nothing is markup.
fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<[f64; 2]>) -> Plot {
        Plot { curves: vec![Curve::new("a < b", points)], ..Plot::new("T & U", "x", "y") }
    }

    #[test]
    fn ends_of_a_curve_are_at_the_ends_of_the_axes() {
        let svg = plot(vec![[0.0, 1.0], [2.0, 5.0]]).to_svg();
        assert!(svg.contains("points=\"90.00,430.00 780.00,50.00 \""), "{svg}");
        assert!(svg.contains("T &amp; U"));
    }

    #[test]
    fn logarithms_leave_out_what_has_none() {
        let points = vec![[0.0, 0.0], [1.0, 0.01], [2.0, f64::NAN], [3.0, 1.0]];
        let svg = Plot { y_axis: Axis::Logarithmic, ..plot(points) }.to_svg();
        assert!(svg.contains("points=\"90.00,430.00 780.00,50.00 \""), "{svg}");
        assert!(svg.contains(">1e-2<") && svg.contains(">1e-1<"));
    }

    #[test]
    fn any_numbers_give_a_plot_without_any_that_are_none() {
        for points in [
            vec![],
            vec![[1.0, 1.0]],
            vec![[0.0, 0.0]],
            vec![[f64::MIN, -1e-300], [f64::MAX, 1e-300]],
            vec![[f64::INFINITY, 0.0]],
        ] {
            for axis in [Axis::Linear, Axis::Logarithmic] {
                let svg = Plot { x_axis: axis, y_axis: axis, ..plot(points.clone()) }.to_svg();
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{points:?}: {svg}");
            }
        }
    }
}
