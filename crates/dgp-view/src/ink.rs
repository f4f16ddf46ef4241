//! Paint made ready: colors as light, numbers with their range.

use dgp_mesh::{DVec2, FaceId, FaceSet};

use crate::{
    Checker, Error, Field, Marked, Model, NOT_A_NUMBER, Paint, PointSize, Scalars, Shape,
    color::{Linear, linear, mix, scale},
    color_map::ColorTable,
    paint::fraction,
    ticks::Ticks,
};

/// Paint made ready.
pub(crate) enum Ink<'a> {
    Uniform(Linear),
    Colors(&'a Field<dgp_mesh::Color>, Vec<Linear>),
    Scalars(ScalarInk<'a>),
    Checker(&'a Checker, [Linear; 2]),
}

/// Numbers, their range and their colors.
pub(crate) struct ScalarInk<'a> {
    pub(crate) scalars: &'a Scalars,
    /// `None` if no value is a number.
    pub(crate) range: Option<(f64, f64)>,
    table: ColorTable,
    nothing: Linear,
    /// The values of isolines, rising.
    isolines: Vec<f64>,
}

/// A point of a triangle, for what is painted there.
pub(crate) struct Spot {
    pub(crate) face: usize,
    pub(crate) vertices: [u32; 3],
    /// Looked up only where something is given at corners.
    pub(crate) corners: [usize; 3],
    /// Barycentric coordinates, and how they change with a sample to the right and one below.
    pub(crate) at: [f64; 3],
    pub(crate) slopes: [[f64; 3]; 2],
}

/// Half the width of an isoline in pixels.
const ISOLINE: f64 = 0.6;

impl<'a> Ink<'a> {
    /// The ink of a model; an error if there is not one value for each element.
    pub(crate) fn new(model: &'a Model<'a>, place: Place) -> Result<Self, Error> {
        Ok(match &model.style.paint {
            Paint::Uniform(color) => Ink::Uniform(linear(*color)),
            Paint::Colors(field) => {
                place.check(model, field, "colors")?;
                Ink::Colors(field, field.values().iter().map(|&c| linear(c)).collect())
            }
            Paint::Checker(checker) => {
                place.check(model, &checker.uv, "texture coordinates")?;
                if !(checker.squares.is_finite() && checker.squares > 0.0) {
                    return Err(Error::option("squares", checker.squares, "positive"));
                }
                Ink::Checker(checker, checker.colors.map(linear))
            }
            Paint::Scalars(scalars) => {
                place.check(model, &scalars.field, "numbers")?;
                Ink::Scalars(ScalarInk::new(scalars)?)
            }
        })
    }

    /// Whether the ink is smooth enough that one sample a pixel shows it.
    pub(crate) fn is_smooth(&self) -> bool {
        match self {
            Ink::Uniform(_) | Ink::Colors(..) => true,
            Ink::Scalars(ink) => ink.isolines.is_empty(),
            Ink::Checker(..) => false,
        }
    }

    /// Whether it needs [`Spot::corners`].
    pub(crate) fn is_at_corners(&self) -> bool {
        match self {
            Ink::Uniform(_) => false,
            Ink::Colors(field, _) => matches!(field, Field::Corners(_)),
            Ink::Scalars(ink) => matches!(ink.scalars.field, Field::Corners(_)),
            Ink::Checker(checker, _) => matches!(checker.uv, Field::Corners(_)),
        }
    }

    /// The color of a point of a triangle; `pixel` is the number of samples along a pixel.
    pub(crate) fn at(&self, spot: &Spot, pixel: f64) -> Linear {
        match self {
            Ink::Uniform(color) => *color,
            Ink::Colors(field, colors) => match corner_values(field, colors, spot) {
                Ok(colors) => {
                    let w = spot.at.map(|x| x as f32);
                    let sum = |k| w[0] * colors[0][k] + w[1] * colors[1][k] + w[2] * colors[2][k];
                    std::array::from_fn(sum)
                }
                Err(color) => color,
            },
            Ink::Scalars(ink) => ink.at(spot, pixel),
            Ink::Checker(checker, colors) => checkerboard(checker, *colors, spot),
        }
    }

    /// The color of a vertex that is drawn as a point.
    pub(crate) fn at_vertex(&self, v: usize) -> Linear {
        match self {
            Ink::Uniform(color) => *color,
            Ink::Colors(Field::Vertices(_), colors) => colors[v],
            Ink::Scalars(ink) => match &ink.scalars.field {
                Field::Vertices(values) => ink.color(values.values()[v]),
                Field::Corners(_) | Field::Faces(_) => [0.2; 3],
            },
            Ink::Colors(..) | Ink::Checker(..) => [0.2; 3],
        }
    }
}

impl<'a> ScalarInk<'a> {
    fn new(scalars: &'a Scalars) -> Result<Self, Error> {
        let range = scalars.range.of(scalars.field.values());
        if let Some((low, high)) = range
            && !(low.is_finite() && high.is_finite() && low <= high)
        {
            let wrong = if low.is_finite() { high } else { low };
            return Err(Error::option("range", wrong, "two finite numbers, the smaller first"));
        }
        let isolines = match (range, scalars.isolines) {
            (None, _) | (_, 0) => Vec::new(),
            (Some((low, high)), count) => Ticks::new(low, high, count as usize).values,
        };
        let nothing = linear(NOT_A_NUMBER);
        Ok(ScalarInk { scalars, range, table: scalars.map.table(), nothing, isolines })
    }

    fn color(&self, x: f64) -> Linear {
        match self.range {
            Some(range) if !x.is_nan() => self.table.color(fraction(x, range)),
            _ => self.nothing,
        }
    }

    /// The colors along the bar, from 0 (low) to 1 (high).
    pub(crate) fn bar_color(&self, t: f64) -> Linear {
        self.table.color(t)
    }

    fn at(&self, spot: &Spot, pixel: f64) -> Linear {
        let field = &self.scalars.field;
        let values = match corner_values(field, field.values(), spot) {
            Ok(values) => values,
            Err(value) => return self.color(value),
        };
        let at = |w: &[f64; 3]| w[0] * values[0] + w[1] * values[1] + w[2] * values[2];
        let value = at(&spot.at);
        let color = self.color(value);
        if self.isolines.is_empty() {
            return color;
        }
        let slope = at(&spot.slopes[0]).hypot(at(&spot.slopes[1]));
        let next = self.isolines.partition_point(|&line| line < value);
        let around = [next.wrapping_sub(1), next].map(|i| self.isolines.get(i));
        let nearest = around.into_iter().flatten().map(|line| (line - value).abs());
        let distance = nearest.fold(f64::INFINITY, f64::min) / slope;
        if distance.is_nan() {
            return color;
        }
        scale(color, 1.0 - 0.8 * (ISOLINE * pixel + 0.5 - distance).clamp(0.0, 1.0) as f32)
    }
}

/// The values at the corners of a triangle, or the one of its face.
fn corner_values<T: Copy, U>(field: &Field<U>, values: &[T], spot: &Spot) -> Result<[T; 3], T> {
    match field {
        Field::Vertices(_) => Ok(spot.vertices.map(|v| values[v as usize])),
        Field::Corners(_) => Ok(spot.corners.map(|c| values[c])),
        Field::Faces(_) => Err(values[spot.face]),
    }
}

/// A checkerboard that fades to its mean color where squares are smaller than samples.
fn checkerboard(checker: &Checker, colors: [Linear; 2], spot: &Spot) -> Linear {
    let (place, slopes) = match corner_values(&checker.uv, checker.uv.values(), spot) {
        Ok([a, b, c]) => {
            let at = |w: &[f64; 3]| checker.squares * (w[0] * a + w[1] * b + w[2] * c);
            (at(&spot.at), spot.slopes.map(|w| at(&w)))
        }
        Err(uv) => (checker.squares * uv, [DVec2::ZERO; 2]),
    };
    if !place.is_finite() {
        return linear(NOT_A_NUMBER);
    }
    let square = (place.x.floor() + place.y.floor()).rem_euclid(2.0) as usize;
    let squares_per_sample = slopes[0].abs().max(slopes[1].abs()).max_element();
    let fade = ((squares_per_sample - 0.25) / 0.5).clamp(0.0, 1.0);
    mix(colors[square.min(1)], mix(colors[0], colors[1], 0.5), fade as f32)
}

/// Faces painted in a color of their own, later ones over earlier ones.
pub(crate) fn marked_faces<'a>(model: &'a Model<'a>) -> Vec<(&'a FaceSet, Linear)> {
    let faces = |mark: &'a crate::Mark| match &mark.elements {
        Marked::Faces(faces) => Some((faces, linear(mark.color))),
        Marked::Vertices(_) | Marked::Edges(_) | Marked::Segments(_) => None,
    };
    model.style.marks.iter().rev().filter_map(faces).collect()
}

/// The color of the first set with this face.
pub(crate) fn marked(sets: &[(&FaceSet, Linear)], face: usize) -> Option<Linear> {
    sets.iter().find(|(set, _)| set.contains(FaceId::new(face))).map(|&(_, color)| color)
}

/// Which model of which panel, for messages.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) panel: usize,
    pub(crate) model: usize,
}

impl Place {
    /// An error unless there is a value for each element.
    fn check<T>(
        self,
        model: &Model<'_>,
        field: &Field<T>,
        what: &'static str,
    ) -> Result<(), Error> {
        let expected = match field {
            Field::Vertices(_) => model.shape.vertex_count(),
            Field::Corners(_) => model.shape.corner_count(),
            Field::Faces(_) => model.shape.face_count(),
        };
        self.check_count(what, field.element(), field.values().len(), expected)
    }

    /// An error unless both counts are the same.
    pub(crate) fn check_count(
        self,
        what: &'static str,
        element: &'static str,
        count: usize,
        expected: usize,
    ) -> Result<(), Error> {
        let Place { panel, model } = self;
        if count == expected {
            return Ok(());
        }
        Err(Error::CountMismatch { panel, model, what, element, count, expected })
    }

    /// An error if a marked element is not there.
    pub(crate) fn check_index(
        self,
        element: &'static str,
        index: usize,
        count: usize,
    ) -> Result<(), Error> {
        let Place { panel, model } = self;
        if index < count {
            return Ok(());
        }
        Err(Error::ElementOutOfRange { panel, model, element, index, count })
    }
}

/// The widest lines and points, in pixels: wider ones are mistakes, and take long to draw.
const WIDEST: f64 = 1000.0;

/// An error if a width is out of range.
fn check_width(name: &'static str, width: f64) -> Result<(), Error> {
    let fits = (0.0..=WIDEST).contains(&width);
    if fits { Ok(()) } else { Err(Error::option(name, width, "from 0 to 1000 pixels")) }
}

/// An error if a style has a width out of range, or names elements its shape does not have.
pub(crate) fn check_style(model: &Model<'_>, place: Place) -> Result<(), Error> {
    let (shape, style) = (&model.shape, &model.style);
    check_width("wireframe.width", style.wireframe.width)?;
    check_width("boundary.width", style.boundary.width)?;
    if let PointSize::Pixels(size) = style.points.size {
        check_width("points.size", size)?;
    }
    for mark in &style.marks {
        check_width("marks.width", mark.width)?;
        match (&mark.elements, shape) {
            (Marked::Vertices(set), _) => {
                for v in set.iter() {
                    place.check_index("vertex", v.index(), shape.vertex_count())?;
                }
            }
            (Marked::Faces(set), _) => {
                for f in set.iter() {
                    place.check_index("face", f.index(), shape.face_count())?;
                }
            }
            (Marked::Edges(set), Shape::Mesh(mesh)) => {
                for e in set.iter() {
                    place.check_index("edge", e.index(), mesh.edge_count())?;
                }
            }
            (Marked::Edges(_), _) => {
                return Err(Error::NoEdges { panel: place.panel, model: place.model });
            }
            (Marked::Segments(segments), _) => {
                for v in segments.as_flattened() {
                    place.check_index("vertex", v.index(), shape.vertex_count())?;
                }
            }
        }
    }
    Ok(())
}
