//! Sets of elements, one bit each.

use std::{fmt, marker::PhantomData};

use crate::{EdgeId, FaceId, HalfedgeId, Id, VertexId};

/// A set of elements of one kind: a selection, the fixed vertices, the feature edges.
///
/// Grows as ids are inserted; an id beyond its end is not in it.
///
/// ```
/// use dgp_mesh::{VertexId, VertexSet};
///
/// let fixed: VertexSet = [3, 70].map(VertexId::new).into_iter().collect();
/// assert!(fixed.contains(VertexId::new(70)) && !fixed.contains(VertexId::new(4)));
/// assert_eq!(fixed.iter().collect::<Vec<_>>(), [3, 70].map(VertexId::new));
/// ```
#[derive(Clone)]
pub struct IdSet<I> {
    words: Vec<u64>,
    len: usize,
    ids: PhantomData<fn(I)>,
}

/// A set of vertices.
pub type VertexSet = IdSet<VertexId>;
/// A set of half-edges.
pub type HalfedgeSet = IdSet<HalfedgeId>;
/// A set of edges.
pub type EdgeSet = IdSet<EdgeId>;
/// A set of faces.
pub type FaceSet = IdSet<FaceId>;

impl<I: Id> IdSet<I> {
    /// The empty set.
    pub const fn new() -> Self {
        IdSet { words: Vec::new(), len: 0, ids: PhantomData }
    }

    /// The first `count` elements.
    pub fn all(count: usize) -> Self {
        (0..count).map(I::from_index).collect()
    }

    /// How many elements are in the set.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no element is in the set.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether `id` is in the set.
    #[inline]
    pub fn contains(&self, id: I) -> bool {
        let i = id.index();
        self.words.get(i / 64).is_some_and(|word| word >> (i % 64) & 1 == 1)
    }

    /// Puts `id` in; returns whether it was missing.
    pub fn insert(&mut self, id: I) -> bool {
        let (word, bit) = (id.index() / 64, 1 << (id.index() % 64));
        if word >= self.words.len() {
            self.words.resize(word + 1, 0);
        }
        let is_new = self.words[word] & bit == 0;
        self.words[word] |= bit;
        self.len += usize::from(is_new);
        is_new
    }

    /// Takes `id` out; returns whether it was in.
    pub fn remove(&mut self, id: I) -> bool {
        let (word, bit) = (id.index() / 64, 1 << (id.index() % 64));
        let was_in = self.words.get(word).is_some_and(|w| w & bit != 0);
        if was_in {
            self.words[word] &= !bit;
            self.len -= 1;
        }
        was_in
    }

    /// Takes everything out, keeping the memory.
    pub fn clear(&mut self) {
        self.words.fill(0);
        self.len = 0;
    }

    /// The elements in order of their ids.
    pub fn iter(&self) -> impl Iterator<Item = I> + '_ {
        self.words.iter().enumerate().flat_map(|(w, &word)| {
            std::iter::successors((word != 0).then_some(word), |&rest| {
                let rest = rest & (rest - 1);
                (rest != 0).then_some(rest)
            })
            .map(move |rest| I::from_index(w * 64 + rest.trailing_zeros() as usize))
        })
    }
}

impl<I> Default for IdSet<I> {
    fn default() -> Self {
        IdSet { words: Vec::new(), len: 0, ids: PhantomData }
    }
}

impl<I: Id> PartialEq for IdSet<I> {
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len && self.words.iter().zip(&other.words).all(|(a, b)| a == b)
    }
}

impl<I: Id> Eq for IdSet<I> {}

impl<I: Id> FromIterator<I> for IdSet<I> {
    fn from_iter<T: IntoIterator<Item = I>>(ids: T) -> Self {
        let mut set = IdSet::new();
        set.extend(ids);
        set
    }
}

impl<I: Id> Extend<I> for IdSet<I> {
    fn extend<T: IntoIterator<Item = I>>(&mut self, ids: T) {
        for id in ids {
            self.insert(id);
        }
    }
}

impl<I: Id> fmt::Debug for IdSet<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_of_different_capacity_compare_by_content() {
        let mut long: VertexSet = [1, 200].map(VertexId::new).into_iter().collect();
        long.remove(VertexId::new(200));
        let short: VertexSet = [1].map(VertexId::new).into_iter().collect();
        assert_eq!(long, short);
        assert_eq!(long.len(), 1);
    }

    #[test]
    fn insert_and_remove_say_whether_they_changed_anything() {
        let mut set = VertexSet::new();
        let v = VertexId::new(64);
        assert!(!set.remove(v) && set.insert(v) && !set.insert(v) && set.remove(v));
        assert!(set.is_empty());
    }
}
