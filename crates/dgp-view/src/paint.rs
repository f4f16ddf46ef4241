//! What color a surface has, before light falls on it.

use dgp_mesh::{
    AttributeTable, AttributeValue, Color, DVec2, DVec3, FaceMap, Id, Label, Normal, VertexMap,
};

use crate::{ColorMap, Error, Shape};

/// What color a surface has.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// The same everywhere.
    Uniform(Color),
    /// Given colors, interpolated over faces if given at vertices or corners.
    Colors(Field<Color>),
    /// Numbers shown through a color map.
    Scalars(Scalars),
    /// A checkerboard in texture coordinates, which shows how a map to the plane distorts.
    Checker(Checker),
}

/// A value at each element of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Field<T> {
    /// At the vertices.
    Vertices(VertexMap<T>),
    /// At the corners: indexed by half-edge for a mesh, by corner for a face set.
    Corners(Vec<T>),
    /// At the faces.
    Faces(FaceMap<T>),
}

/// Numbers shown through a color map.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalars {
    /// The numbers; what is no number is drawn in [`NOT_A_NUMBER`].
    pub field: Field<f64>,
    /// How they become colors.
    pub map: ColorMap,
    /// Which numbers have the first and the last color.
    pub range: Range,
    /// About how many lines of equal value are drawn, at round numbers; 0 for none.
    pub isolines: u32,
    /// What is written above the color bar, in ASCII.
    pub label: String,
}

/// A checkerboard in texture coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    /// Texture coordinates.
    pub uv: Field<DVec2>,
    /// How many squares there are along a unit of texture coordinates.
    pub squares: f64,
    /// The colors of the squares.
    pub colors: [Color; 2],
}

/// Which numbers have the first and the last color of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Range {
    /// All but the lowest and the highest 2 %, which may be outliers.
    #[default]
    Robust,
    /// From the least to the greatest.
    Full,
    /// From −x to x, where 98 % of the numbers are not further from 0 than x: for diverging maps.
    Symmetric,
    /// From the first to the second.
    Between(f64, f64),
}

/// The color of values that are no numbers.
pub const NOT_A_NUMBER: Color = Color([0.80, 0.20, 0.75, 1.0]);

impl Default for Paint {
    /// A light gray blue.
    fn default() -> Self {
        Paint::Uniform(Color([0.70, 0.76, 0.84, 1.0]))
    }
}

impl Scalars {
    /// Numbers through the default map over their robust range.
    pub fn new(field: Field<f64>) -> Self {
        let (map, range) = (ColorMap::default(), Range::default());
        Scalars { field, map, range, isolines: 0, label: String::new() }
    }
}

impl Checker {
    /// A board of 16 squares along a unit of texture coordinates.
    pub fn new(uv: Field<DVec2>) -> Self {
        let colors = [Color([0.93, 0.93, 0.91, 1.0]), Color([0.26, 0.45, 0.66, 1.0])];
        Checker { uv, squares: 16.0, colors }
    }
}

impl<T> Field<T> {
    /// The values in order.
    pub fn values(&self) -> &[T] {
        match self {
            Field::Vertices(values) => values.values(),
            Field::Corners(values) => values,
            Field::Faces(values) => values.values(),
        }
    }

    /// What kind of element the values belong to.
    pub(crate) fn element(&self) -> &'static str {
        match self {
            Field::Vertices(_) => "vertex",
            Field::Corners(_) => "corner",
            Field::Faces(_) => "face",
        }
    }
}

/// Where a field gets its kind from.
type MakeField<T> = fn(Vec<T>) -> Field<T>;

/// How to show the attribute `name` of `shape` as colors.
///
/// Colors are shown as they are, numbers and truth values through the default color map, directions
/// as their coordinates, texture coordinates as a checkerboard, labels as one color each. Looks at
/// vertices, then corners, then faces. Errors: [`Error::NoSuchAttribute`] with the names there are.
pub fn attribute_paint(shape: Shape<'_>, name: &str) -> Result<Paint, Error> {
    let mut names = Vec::new();
    let found = match shape {
        Shape::Points(_) => None,
        Shape::Mesh(mesh) => {
            let tables = mesh.attributes();
            in_tables(&tables.vertex, &tables.corner, &tables.face, name, &mut names)
        }
        Shape::Faces(set) => in_tables(
            &set.vertex_attributes,
            &set.corner_attributes,
            &set.face_attributes,
            name,
            &mut names,
        ),
    };
    found.ok_or_else(|| {
        names.dedup();
        let available = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        Error::NoSuchAttribute { name: name.to_owned(), available }
    })
}

/// The paint of a column of the first table that has one; all names into `names`.
fn in_tables<'a, V: Id, C: Id, F: Id>(
    vertex: &'a AttributeTable<V>,
    corner: &'a AttributeTable<C>,
    face: &'a AttributeTable<F>,
    name: &str,
    names: &mut Vec<&'a str>,
) -> Option<Paint> {
    names.extend(vertex.names().chain(corner.names()).chain(face.names()));
    macro_rules! field {
        ($kind:ident) => {
            Kinds {
                color: |x| Field::$kind(x.into()),
                scalar: |x| Field::$kind(x.into()),
                uv: |x| Field::$kind(x.into()),
            }
        };
    }
    in_table(vertex, name, &field!(Vertices))
        .or_else(|| in_table(corner, name, &field!(Corners)))
        .or_else(|| in_table(face, name, &field!(Faces)))
}

/// Makes fields of one kind of element.
struct Kinds {
    color: MakeField<Color>,
    scalar: MakeField<f64>,
    uv: MakeField<DVec2>,
}

fn in_table<I: Id>(table: &AttributeTable<I>, name: &str, kinds: &Kinds) -> Option<Paint> {
    if let Some(colors) = column::<I, Color, _>(table, name, |&c| c) {
        return Some(Paint::Colors((kinds.color)(colors)));
    }
    if let Some(uv) = column::<I, DVec2, _>(table, name, |&x| x) {
        return Some(Paint::Checker(Checker::new((kinds.uv)(uv))));
    }
    let colors = column::<I, Normal, _>(table, name, |n| direction_color(n.0))
        .or_else(|| column::<I, DVec3, _>(table, name, |&v| direction_color(v)))
        .or_else(|| table.get::<Label>(name).map(|labels| label_colors(labels.values())));
    if let Some(colors) = colors {
        return Some(Paint::Colors((kinds.color)(colors)));
    }
    let scalars = column::<I, f64, _>(table, name, |&x| x)
        .or_else(|| column::<I, f32, _>(table, name, |&x| f64::from(x)))
        .or_else(|| column::<I, bool, _>(table, name, |&x| f64::from(u8::from(x))))
        .or_else(|| column::<I, i8, _>(table, name, |&x| f64::from(x)))
        .or_else(|| column::<I, u8, _>(table, name, |&x| f64::from(x)))
        .or_else(|| column::<I, i16, _>(table, name, |&x| f64::from(x)))
        .or_else(|| column::<I, u16, _>(table, name, |&x| f64::from(x)))
        .or_else(|| column::<I, i32, _>(table, name, |&x| f64::from(x)))
        .or_else(|| column::<I, u32, _>(table, name, |&x| f64::from(x)))
        .or_else(|| column::<I, i64, _>(table, name, |&x| x as f64))
        .or_else(|| column::<I, u64, _>(table, name, |&x| x as f64))?;
    let scalars = Scalars::new((kinds.scalar)(scalars));
    Some(Paint::Scalars(Scalars { label: name.to_owned(), ..scalars }))
}

/// The values of a column if it has type `T`.
fn column<I: Id, T: AttributeValue, U>(
    table: &AttributeTable<I>,
    name: &str,
    convert: impl Fn(&T) -> U,
) -> Option<Vec<U>> {
    Some(table.get::<T>(name)?.values().iter().map(convert).collect())
}

/// The color whose red, green and blue are the coordinates of a direction.
fn direction_color(direction: DVec3) -> Color {
    let [r, g, b] = direction.normalize_or_zero().to_array().map(|x| (0.5 + 0.5 * x) as f32);
    Color([r, g, b, 1.0])
}

/// A color for each label, in the order in which labels first occur.
fn label_colors(labels: &[Label]) -> Vec<Color> {
    let mut sorted: Vec<(&Label, usize)> = labels.iter().zip(0..).collect();
    sorted.sort_unstable();
    sorted.dedup_by(|later, first| later.0 == first.0);
    let mut by_place: Vec<usize> = sorted.iter().map(|&(_, first)| first).collect();
    by_place.sort_unstable();
    labels
        .iter()
        .map(|label| {
            let found = sorted.binary_search_by(|&(other, _)| other.cmp(label));
            let first = found.map_or(0, |i| sorted[i].1);
            distinct_color(by_place.binary_search(&first).unwrap_or(0))
        })
        .collect()
}

/// The `i`-th of a sequence of colors that stay apart: hues a golden section of the circle away from
/// each other, in three brightnesses.
pub(crate) fn distinct_color(i: usize) -> Color {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let hue = (0.58 + GOLDEN * i as f64).fract();
    let value = [0.82, 0.66, 0.93][i % 3];
    let channel = |shift: f64| {
        let wave = (((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        (value * (1.0 - 0.52 * (1.0 - wave))) as f32
    };
    Color([channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0), 1.0])
}

impl Range {
    /// The least and the greatest number of the range; `None` if no value is a number.
    pub(crate) fn of(self, values: &[f64]) -> Option<(f64, f64)> {
        if let Range::Between(low, high) = self {
            return Some((low, high));
        }
        let mut finite: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        if finite.is_empty() {
            return None;
        }
        let mut quantile = |q: f64| {
            let rank = (q * (finite.len() - 1) as f64).round() as usize;
            *finite.select_nth_unstable_by(rank, f64::total_cmp).1
        };
        Some(match self {
            Range::Robust => {
                let (low, high) = (quantile(0.02), quantile(0.98));
                // A few values apart from one that all others share would be left out.
                if low < high { (low, high) } else { (quantile(0.0), quantile(1.0)) }
            }
            Range::Full => (quantile(0.0), quantile(1.0)),
            Range::Symmetric => {
                for x in &mut finite {
                    *x = x.abs();
                }
                let rank = (0.98 * (finite.len() - 1) as f64).round() as usize;
                let x = *finite.select_nth_unstable_by(rank, f64::total_cmp).1;
                (-x, x)
            }
            Range::Between(low, high) => (low, high),
        })
    }
}

/// Where `x` lies between `low` (0) and `high` (1), without overflow; 0.5 if the range is a point.
#[inline]
pub(crate) fn fraction(x: f64, (low, high): (f64, f64)) -> f64 {
    let length = 0.5 * high - 0.5 * low;
    if length > 0.0 { (0.5 * x - 0.5 * low) / length } else { 0.5 }
}

#[cfg(test)]
mod tests {
    use dgp_mesh::{FaceList, IndexedFaceSet};

    use super::*;

    #[test]
    fn robust_ranges_leave_outliers_out() {
        let mut values: Vec<f64> = (0..100).map(f64::from).collect();
        values.extend([1e30, f64::NAN, f64::INFINITY]);
        assert_eq!(Range::Robust.of(&values), Some((2.0, 98.0)));
        assert_eq!(Range::Full.of(&values), Some((0.0, 1e30)));
        assert_eq!(Range::Full.of(&[f64::NAN]), None);
        assert_eq!(Range::Symmetric.of(&[-3.0, 1.0]), Some((-3.0, 3.0)));
    }

    #[test]
    fn ranges_as_wide_as_numbers_reach_do_not_overflow() {
        let range = (f64::MIN, f64::MAX);
        assert_eq!([f64::MIN, 0.0, f64::MAX].map(|x| fraction(x, range)), [0.0, 0.5, 1.0]);
        assert_eq!(fraction(7.0, (7.0, 7.0)), 0.5);
    }

    #[test]
    fn attributes_of_every_kind_become_paint() {
        let faces = FaceList::from_indices(&[[0, 1, 2]]);
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut set = IndexedFaceSet::new(points, faces).unwrap();
        set.vertex_attributes.insert("height", vec![1_u16, 2, 3]);
        set.vertex_attributes.insert("ink", vec![Color([0.5; 4]); 3]);
        set.corner_attributes.insert("uv", vec![DVec2::ZERO; 3]);
        set.face_attributes.insert("part", vec![Label::new("head")]);
        let paint = |name| attribute_paint(Shape::Faces(&set), name);
        let Ok(Paint::Scalars(height)) = paint("height") else { panic!("numbers are scalars") };
        assert_eq!(height.field, Field::Vertices(vec![1.0, 2.0, 3.0].into()));
        assert!(matches!(paint("ink"), Ok(Paint::Colors(Field::Vertices(_)))));
        assert!(matches!(paint("uv"), Ok(Paint::Checker(Checker { uv: Field::Corners(_), .. }))));
        assert!(matches!(paint("part"), Ok(Paint::Colors(Field::Faces(_)))));
        let message = paint("mass").unwrap_err().to_string();
        assert!(message.contains("height, ink, uv, part"), "{message}");
    }

    #[test]
    fn labels_are_numbered_as_they_occur() {
        let [b, a] = ["b", "a"].map(Label::new);
        let colors = label_colors(&[b.clone(), a, b]);
        assert_eq!(colors, [0, 1, 0].map(distinct_color));
    }
}
