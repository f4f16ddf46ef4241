//! Data that travels: named values per vertex, corner, edge or face that follow every edit.
//!
//! A table holds one column per name. Editing code does not know the types in it; it asks each column
//! to [mix](AttributeValue::mix) old values into the value of a new element. Values that are computed
//! and soon forgotten are plain [maps](crate::IdMap) instead.
//!
//! | name | type | on | meaning |
//! |---|---|---|---|
//! | [`NORMAL`] | [`Normal`] | vertex, corner, face | unit normal as a file gave it |
//! | [`COLOR`] | [`Color`] | vertex, corner, edge, face | red, green, blue, alpha in 0..1 |
//! | [`UV`] | `DVec2` | vertex, corner | texture coordinates |
//! | [`GROUP`], [`OBJECT`], [`MATERIAL`], [`SMOOTHING`] | [`Label`] | face | what a face belongs to |
//! | any other | `f64`, `f32`, integers, or the user's | any | as in the file |

use std::{any::Any, fmt, marker::PhantomData, ops::Index, sync::Arc};

use glam::{DVec2, DVec3};

use crate::{Id, IdMap};

/// The name of normals.
pub const NORMAL: &str = "normal";
/// The name of colors.
pub const COLOR: &str = "color";
/// The name of texture coordinates.
pub const UV: &str = "uv";
/// The name of the group a face belongs to.
pub const GROUP: &str = "group";
/// The name of the object a face belongs to.
pub const OBJECT: &str = "object";
/// The name of the material of a face.
pub const MATERIAL: &str = "material";
/// The name of the smoothing group of a face.
pub const SMOOTHING: &str = "smoothing";

/// A value that can travel: user types implement this with an empty body, or mix as suits them.
pub trait AttributeValue: Clone + PartialEq + Default + fmt::Debug + Send + Sync + 'static {
    /// The value between others, whose weights are not negative and sum to 1: the heaviest part,
    /// the first of equals, unless the type says otherwise. `parts` is never empty.
    fn mix(parts: &[(f64, &Self)]) -> Self {
        let mut heaviest = parts[0];
        for &part in parts {
            if part.0 > heaviest.0 {
                heaviest = part;
            }
        }
        heaviest.1.clone()
    }
}

macro_rules! linear {
    ($($type:ty, $zero:expr, $scale:expr);* $(;)?) => {
        $(impl AttributeValue for $type {
            fn mix(parts: &[(f64, &Self)]) -> Self {
                let scale: fn(f64, &Self) -> Self = $scale;
                // Equal values mix to themselves, bit for bit.
                if parts.iter().all(|part| part.1 == parts[0].1) {
                    return *parts[0].1;
                }
                parts.iter().fold($zero, |sum, &(weight, value)| sum + scale(weight, value))
            }
        })*
    };
}

linear! {
    f64, 0.0, |w, x| w * x;
    f32, 0.0, |w, x| (w * f64::from(*x)) as f32;
    DVec2, DVec2::ZERO, |w, x| w * *x;
    DVec3, DVec3::ZERO, |w, x| w * *x;
}

macro_rules! categorical {
    ($($type:ty),*) => { $(impl AttributeValue for $type {})* };
}

categorical!(bool, i8, u8, i16, u16, i32, u32, i64, u64, Label);

/// A unit normal, or zero where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Normal(pub DVec3);

impl AttributeValue for Normal {
    /// The mean direction; zero if the parts cancel.
    fn mix(parts: &[(f64, &Self)]) -> Self {
        if parts.iter().all(|part| part.1 == parts[0].1) {
            return *parts[0].1;
        }
        Normal(parts.iter().map(|&(weight, n)| weight * n.0).sum::<DVec3>().normalize_or_zero())
    }
}

/// A color: red, green, blue, alpha in 0..1. Holds the 8-bit colors of files exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color(pub [f32; 4]);

impl Default for Color {
    fn default() -> Self {
        Color([1.0; 4])
    }
}

impl Color {
    /// An opaque color from 8-bit red, green and blue.
    pub fn from_rgb8([r, g, b]: [u8; 3]) -> Self {
        Color::from_rgba8([r, g, b, 255])
    }

    /// A color from 8-bit red, green, blue and alpha.
    pub fn from_rgba8(rgba: [u8; 4]) -> Self {
        Color(rgba.map(|x| f32::from(x) / 255.0))
    }

    /// The nearest 8-bit color; what is no number becomes 0.
    pub fn to_rgba8(self) -> [u8; 4] {
        self.0.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8)
    }
}

impl AttributeValue for Color {
    fn mix(parts: &[(f64, &Self)]) -> Self {
        if parts.iter().all(|part| part.1 == parts[0].1) {
            return *parts[0].1;
        }
        let channel =
            |k: usize| parts.iter().map(|&(w, c)| w * f64::from(c.0[k])).sum::<f64>() as f32;
        Color([channel(0), channel(1), channel(2), channel(3)])
    }
}

/// A name shared by many elements, such as the group of a face; empty by default.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Label(Arc<str>);

impl Label {
    /// The label of this name.
    pub fn new(name: &str) -> Self {
        Label(name.into())
    }

    /// Its name.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Default for Label {
    fn default() -> Self {
        Label::new("")
    }
}

/// Named columns of values for the elements of one kind.
///
/// ```
/// use dgp_mesh::{AttributeTable, VertexId, VertexMap};
///
/// let mut table = AttributeTable::<VertexId>::new(2);
/// table.insert("height", VertexMap::from(vec![1.0, 3.0]));
/// let middle = table.push_mixed(&[(0.5, VertexId::new(0)), (0.5, VertexId::new(1))]);
/// assert_eq!(table.get::<f64>("height").unwrap()[middle], 2.0);
/// ```
#[derive(Clone)]
pub struct AttributeTable<I> {
    len: usize,
    columns: Vec<(String, Box<dyn Column>)>,
    ids: PhantomData<fn(I)>,
}

/// One column of an [`AttributeTable`], indexed by id.
#[derive(Debug)]
pub struct AttributeColumn<'a, I, T> {
    values: &'a [T],
    ids: PhantomData<fn(I)>,
}

impl<I: Id> AttributeTable<I> {
    /// A table without columns for `len` elements.
    pub const fn new(len: usize) -> Self {
        AttributeTable { len, columns: Vec::new(), ids: PhantomData }
    }

    /// How many elements each column has a value for.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no columns.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The names of the columns, in the order in which they came.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(name, _)| name.as_str())
    }

    /// Adds a column, in place of one with the same name.
    ///
    /// # Panics
    /// If `values` has not one value per element.
    pub fn insert<T: AttributeValue>(&mut self, name: &str, values: impl Into<IdMap<I, T>>) {
        let values = values.into();
        assert_eq!(values.len(), self.len, "attribute {name:?} needs one value per {}", I::KIND);
        let column: Box<dyn Column> = Box::new(values.into_values());
        match self.columns.iter_mut().find(|(other, _)| other == name) {
            Some((_, old)) => *old = column,
            None => self.columns.push((name.to_owned(), column)),
        }
    }

    /// The column `name`, if there is one and it is of type `T`.
    pub fn get<T: AttributeValue>(&self, name: &str) -> Option<AttributeColumn<'_, I, T>> {
        let (_, column) = self.columns.iter().find(|(other, _)| other == name)?;
        let values = column.as_any().downcast_ref::<Vec<T>>()?;
        Some(AttributeColumn { values, ids: PhantomData })
    }

    /// The values of column `name` in order of their ids, to be changed, if there is one and it is
    /// of type `T`.
    pub fn get_mut<T: AttributeValue>(&mut self, name: &str) -> Option<&mut [T]> {
        let (_, column) = self.columns.iter_mut().find(|(other, _)| other == name)?;
        column.as_any_mut().downcast_mut::<Vec<T>>().map(Vec::as_mut_slice)
    }

    /// Whether there is a column `name`, of whatever type.
    pub fn contains(&self, name: &str) -> bool {
        self.names().any(|other| other == name)
    }

    /// The name of the Rust type of the values in column `name`, for messages.
    pub fn type_name(&self, name: &str) -> Option<&'static str> {
        let (_, column) = self.columns.iter().find(|(other, _)| other == name)?;
        Some(column.type_name())
    }

    /// Drops the column `name`; returns whether there was one.
    pub fn remove(&mut self, name: &str) -> bool {
        let before = self.columns.len();
        self.columns.retain(|(other, _)| other != name);
        self.columns.len() < before
    }

    /// Adds elements with default values, or drops the last ones.
    pub fn resize(&mut self, len: usize) {
        self.len = len;
        for (_, column) in &mut self.columns {
            column.resize(len);
        }
    }

    /// Adds an element whose values are mixed from those of others, and returns its id. Without
    /// parts it gets default values.
    pub fn push_mixed(&mut self, parts: &[(f64, I)]) -> I {
        let id = I::from_index(self.len);
        self.resize(self.len + 1);
        self.mix(id, parts);
        id
    }

    /// Sets the values of `to` to a mix of those of others, `to` perhaps among them; weights are not
    /// negative and sum to 1. Parts without weight do not count; without parts nothing changes.
    pub fn mix(&mut self, to: I, parts: &[(f64, I)]) {
        if self.columns.is_empty() {
            return;
        }
        let parts = parts.iter().filter(|(weight, _)| *weight != 0.0);
        let parts: Vec<_> = parts.map(|&(weight, id)| (weight, id.index())).collect();
        if parts.is_empty() {
            return;
        }
        for (_, column) in &mut self.columns {
            column.mix(to.index(), &parts);
        }
    }

    /// Sets the values of `to` to those of `from`.
    pub fn copy(&mut self, from: I, to: I) {
        for (_, column) in &mut self.columns {
            column.copy(from.index(), to.index());
        }
    }

    /// The columns whose values differ within one of the `pairs` of elements.
    pub fn differing(&self, pairs: impl Iterator<Item = [I; 2]>) -> Vec<String> {
        if self.columns.is_empty() {
            return Vec::new();
        }
        let pairs: Vec<_> = pairs.map(|pair| pair.map(I::index)).collect();
        let columns = self.columns.iter().filter(|(_, column)| column.differs(&pairs));
        columns.map(|(name, _)| name.clone()).collect()
    }

    /// Takes over the columns of `other` whose name is `wanted`, in place of those with the same name.
    ///
    /// # Panics
    /// If the tables are not of the same length.
    pub fn append(&mut self, other: AttributeTable<I>, wanted: impl Fn(&str) -> bool) {
        assert_eq!(other.len, self.len, "tables of the same length");
        for (name, column) in other.columns.into_iter().filter(|(name, _)| wanted(name)) {
            self.remove(&name);
            self.columns.push((name, column));
        }
    }

    /// Sets the values of `id` to their defaults.
    pub fn reset(&mut self, id: I) {
        for (_, column) in &mut self.columns {
            column.reset(id.index());
        }
    }

    /// Whether two elements have the same values in every column.
    pub fn equal(&self, a: I, b: I) -> bool {
        self.columns.iter().all(|(_, column)| column.equal(a.index(), b.index()))
    }

    /// The table of `len` elements whose element `j` has the values of `source(j)`, or default
    /// values where that is `None`. The new elements may be of another kind.
    pub fn gather<J: Id>(
        &self,
        len: usize,
        source: impl Fn(J) -> Option<I> + Sync,
    ) -> AttributeTable<J> {
        let source = |j: usize| source(J::from_index(j)).map(I::index);
        let columns = self.columns.iter();
        let columns = columns.map(|(name, column)| (name.clone(), column.gather(len, &source)));
        AttributeTable { len, columns: columns.collect(), ids: PhantomData }
    }
}

impl<I: Id> Default for AttributeTable<I> {
    fn default() -> Self {
        AttributeTable::new(0)
    }
}

impl<I: Id> PartialEq for AttributeTable<I> {
    /// Whether both have the same columns with the same values, in whatever order.
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len
            && self.columns.len() == other.columns.len()
            && self.columns.iter().all(|(name, column)| {
                let twin = other.columns.iter().find(|(other, _)| other == name);
                twin.is_some_and(|(_, twin)| column.equals(twin.as_ref()))
            })
    }
}

impl<I: Id> fmt::Debug for AttributeTable<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let types = self.columns.iter().map(|(name, column)| (name, column.type_name()));
        f.debug_map().entries(types).finish()
    }
}

impl<'a, I: Id, T> AttributeColumn<'a, I, T> {
    /// The values in order of their ids.
    pub fn values(self) -> &'a [T] {
        self.values
    }

    /// The values as a map of their own.
    pub fn to_map(self) -> IdMap<I, T>
    where
        T: Clone,
    {
        self.values.to_vec().into()
    }
}

impl<I, T> Clone for AttributeColumn<'_, I, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<I, T> Copy for AttributeColumn<'_, I, T> {}

impl<I: Id, T> Index<I> for AttributeColumn<'_, I, T> {
    type Output = T;

    fn index(&self, id: I) -> &T {
        &self.values[id.index()]
    }
}

/// What a table asks of a column whose type it does not know.
trait Column: Send + Sync {
    fn resize(&mut self, len: usize);
    fn copy(&mut self, from: usize, to: usize);
    fn mix(&mut self, to: usize, parts: &[(f64, usize)]);
    fn reset(&mut self, at: usize);
    fn equal(&self, a: usize, b: usize) -> bool;
    fn gather(
        &self,
        len: usize,
        source: &(dyn Fn(usize) -> Option<usize> + Sync),
    ) -> Box<dyn Column>;
    fn equals(&self, other: &dyn Column) -> bool;
    fn differs(&self, pairs: &[[usize; 2]]) -> bool;
    fn boxed_clone(&self) -> Box<dyn Column>;
    fn type_name(&self) -> &'static str;
    fn as_any(&self) -> &dyn Any;
    fn as_any_mut(&mut self) -> &mut dyn Any;
}

impl<T: AttributeValue> Column for Vec<T> {
    fn resize(&mut self, len: usize) {
        self.resize_with(len, T::default);
    }

    fn copy(&mut self, from: usize, to: usize) {
        self[to] = self[from].clone();
    }

    fn mix(&mut self, to: usize, parts: &[(f64, usize)]) {
        let parts: Vec<_> = parts.iter().map(|&(weight, from)| (weight, &self[from])).collect();
        self[to] = T::mix(&parts);
    }

    fn reset(&mut self, at: usize) {
        self[at] = T::default();
    }

    fn equal(&self, a: usize, b: usize) -> bool {
        self[a] == self[b]
    }

    fn gather(
        &self,
        len: usize,
        source: &(dyn Fn(usize) -> Option<usize> + Sync),
    ) -> Box<dyn Column> {
        let values = (0..len).map(|j| source(j).map_or_else(T::default, |i| self[i].clone()));
        Box::new(values.collect::<Vec<T>>())
    }

    fn equals(&self, other: &dyn Column) -> bool {
        other.as_any().downcast_ref::<Vec<T>>() == Some(self)
    }

    fn differs(&self, pairs: &[[usize; 2]]) -> bool {
        pairs.iter().any(|&[i, j]| self[i] != self[j])
    }

    fn boxed_clone(&self) -> Box<dyn Column> {
        Box::new(self.clone())
    }

    fn type_name(&self) -> &'static str {
        std::any::type_name::<T>()
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }
}

impl Clone for Box<dyn Column> {
    fn clone(&self) -> Self {
        self.boxed_clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VertexId;

    #[test]
    fn equal_parts_mix_to_themselves_bit_for_bit() {
        let third = 0.1_f64;
        assert_eq!(
            f64::mix(&[(1.0 / 3.0, &third), (1.0 / 3.0, &third), (1.0 / 3.0, &third)]),
            third
        );
    }

    #[test]
    fn labels_take_the_heaviest_part() {
        let (a, b) = (Label::new("a"), Label::new("b"));
        assert_eq!(Label::mix(&[(0.4, &a), (0.6, &b)]), b);
        assert_eq!(Label::mix(&[(0.5, &a), (0.5, &b)]), a);
    }

    #[test]
    fn eight_bit_colors_survive() {
        for x in 0..=255 {
            assert_eq!(Color::from_rgba8([x; 4]).to_rgba8(), [x; 4]);
        }
        assert_eq!(Color([f32::NAN; 4]).to_rgba8(), [0; 4]);
    }

    #[test]
    fn tables_compare_by_name_and_value() {
        let table = |names: [&str; 2]| {
            let mut table = AttributeTable::<VertexId>::new(1);
            for name in names {
                table.insert(name, vec![name.len() as u32]);
            }
            table
        };
        assert_eq!(table(["a", "bc"]), table(["bc", "a"]));
        assert_ne!(table(["a", "bc"]), table(["a", "bd"]));
    }
}
