//! Arrays indexed by ids.

use std::{
    fmt,
    marker::PhantomData,
    ops::{Index, IndexMut},
};

use crate::{CornerId, EdgeId, FaceId, HalfedgeId, Id, VertexId};

/// A value for every element of one kind, indexed by id.
///
/// ```
/// use dgp_mesh::{VertexId, VertexMap};
///
/// let height: VertexMap<f64> = vec![0.0, 1.5].into();
/// assert_eq!(height[VertexId::new(1)], 1.5);
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct IdMap<I, T> {
    values: Vec<T>,
    ids: PhantomData<fn(I)>,
}

/// A value for every vertex.
pub type VertexMap<T> = IdMap<VertexId, T>;
/// A value for every half-edge.
pub type HalfedgeMap<T> = IdMap<HalfedgeId, T>;
/// A value for every edge.
pub type EdgeMap<T> = IdMap<EdgeId, T>;
/// A value for every face.
pub type FaceMap<T> = IdMap<FaceId, T>;
/// A value for every corner of an indexed face set.
pub type CornerMap<T> = IdMap<CornerId, T>;

impl<I: Id, T> IdMap<I, T> {
    /// A map of no elements.
    pub const fn new() -> Self {
        IdMap { values: Vec::new(), ids: PhantomData }
    }

    /// The same value for each of `len` elements.
    pub fn filled(len: usize, value: T) -> Self
    where
        T: Clone,
    {
        vec![value; len].into()
    }

    /// The value `f(id)` for each of `len` elements, in order of their ids.
    pub fn from_fn(len: usize, f: impl FnMut(I) -> T) -> Self {
        (0..len).map(I::from_index).map(f).collect::<Vec<T>>().into()
    }

    /// How many elements there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are no elements.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The values in order of their ids.
    #[inline]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The values in order of their ids, to be changed.
    #[inline]
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The values as a plain vector.
    pub fn into_values(self) -> Vec<T> {
        self.values
    }

    /// The value of `id`, or `None` if the map is too short.
    pub fn get(&self, id: I) -> Option<&T> {
        self.values.get(id.index())
    }

    /// Adds an element and returns its id.
    pub fn push(&mut self, value: T) -> I {
        self.values.push(value);
        I::from_index(self.values.len() - 1)
    }

    /// Adds default values or drops the last ones until `len` elements are left.
    pub fn resize(&mut self, len: usize)
    where
        T: Default,
    {
        self.values.resize_with(len, T::default);
    }

    /// Drops the values of the last elements until at most `len` are left.
    pub fn truncate(&mut self, len: usize) {
        self.values.truncate(len);
    }

    /// All ids.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = I> + ExactSizeIterator + use<I, T> {
        (0..self.values.len()).map(I::from_index)
    }

    /// Ids with their values.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (I, &T)> + ExactSizeIterator {
        self.values.iter().enumerate().map(|(i, value)| (I::from_index(i), value))
    }

    /// Ids with their values, to be changed.
    pub fn iter_mut(&mut self) -> impl DoubleEndedIterator<Item = (I, &mut T)> + ExactSizeIterator {
        self.values.iter_mut().enumerate().map(|(i, value)| (I::from_index(i), value))
    }

    /// The map of `f(value)`.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> IdMap<I, U> {
        self.values.iter().map(f).collect::<Vec<U>>().into()
    }
}

impl<I, T> From<Vec<T>> for IdMap<I, T> {
    fn from(values: Vec<T>) -> Self {
        IdMap { values, ids: PhantomData }
    }
}

impl<I, T> Default for IdMap<I, T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<I: Id, T> Index<I> for IdMap<I, T> {
    type Output = T;

    #[inline]
    fn index(&self, id: I) -> &T {
        &self.values[id.index()]
    }
}

impl<I: Id, T> IndexMut<I> for IdMap<I, T> {
    #[inline]
    fn index_mut(&mut self, id: I) -> &mut T {
        &mut self.values[id.index()]
    }
}

impl<I: Id, T: fmt::Debug> fmt::Debug for IdMap<I, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}
