//! A priority queue of elements whose priority can change.
//!
//! A heap in which each node has four children, beside a table of where each element is. Four keys
//! share a cache line, and a changed key moves its element instead of leaving a stale copy behind.
//! Reference: Johnson, "Priority queues with update and finding minimum spanning trees", Information
//! Processing Letters 4(3), 1975.

use std::marker::PhantomData;

use crate::Id;

/// Elements with keys; gives them back smallest key first, of equal keys the smallest id first.
///
/// ```
/// use dgp_mesh::{VertexId, graph::IndexedHeap};
///
/// let [a, b] = [0, 1].map(VertexId::new);
/// let mut queue = IndexedHeap::new();
/// queue.set(a, 2.0);
/// queue.set(b, 3.0);
/// queue.set(b, 1.0);
/// assert_eq!(queue.pop(), Some((b, 1.0)));
/// assert_eq!(queue.pop(), Some((a, 2.0)));
/// ```
#[derive(Clone, Debug)]
pub struct IndexedHeap<I> {
    nodes: Vec<Node>,
    /// For each element its place in `nodes`, or `OUTSIDE`.
    places: Vec<u32>,
    ids: PhantomData<fn(I)>,
}

/// Key and id as one number, in the order of keys and then of ids: which of two comes first is a guess
/// that processors get wrong, and numbers are compared and chosen without a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Node(u128);

impl Node {
    #[inline]
    fn new<I: Id>(id: I, key: f64) -> Self {
        let bits = key.to_bits();
        // As `f64::total_cmp` orders them.
        let ordered = if bits & SIGN == 0 { bits | SIGN } else { !bits };
        Node(u128::from(ordered) << 32 | id.index() as u128)
    }

    #[inline]
    fn key(self) -> f64 {
        let ordered = (self.0 >> 32) as u64;
        f64::from_bits(if ordered & SIGN == 0 { !ordered } else { ordered ^ SIGN })
    }

    #[inline]
    fn index(self) -> usize {
        self.0 as u32 as usize
    }

    #[inline]
    fn id<I: Id>(self) -> I {
        I::from_index(self.index())
    }
}

const SIGN: u64 = 1 << 63;
const OUTSIDE: u32 = u32::MAX;
const CHILDREN: usize = 4;

impl<I: Id> IndexedHeap<I> {
    /// No elements.
    pub fn new() -> Self {
        IndexedHeap { nodes: Vec::new(), places: Vec::new(), ids: PhantomData }
    }

    /// No elements, with room for ids below `len`.
    pub fn with_capacity(len: usize) -> Self {
        IndexedHeap { nodes: Vec::new(), places: vec![OUTSIDE; len], ids: PhantomData }
    }

    /// All of these elements, in linear time. Of an id that comes twice the last key counts.
    pub fn from_keys(keys: impl IntoIterator<Item = (I, f64)>) -> Self {
        let mut heap = IndexedHeap::new();
        for (id, key) in keys {
            if let Some(place) = heap.place(id) {
                heap.nodes[place] = Node::new(id, key);
            } else {
                heap.make_room(id);
                heap.places[id.index()] = heap.nodes.len() as u32;
                heap.nodes.push(Node::new(id, key));
            }
        }
        for place in (0..heap.nodes.len().div_ceil(CHILDREN)).rev() {
            heap.sink(place, heap.nodes[place]);
        }
        heap
    }

    /// How many elements are in.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether no element is in.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The key of `id`, if it is in.
    pub fn key(&self, id: I) -> Option<f64> {
        self.place(id).map(|place| self.nodes[place].key())
    }

    /// The element with the smallest key.
    pub fn first(&self) -> Option<(I, f64)> {
        self.nodes.first().map(|node| (node.id(), node.key()))
    }

    /// Puts `id` in with this key, or changes its key. What is no number comes last.
    #[inline]
    pub fn set(&mut self, id: I, key: f64) {
        let node = Node::new(id, key);
        let Some(place) = self.place(id) else {
            self.make_room(id);
            self.nodes.push(node);
            self.rise(self.nodes.len() - 1, node);
            return;
        };
        if node < self.nodes[place] {
            self.rise(place, node);
        } else {
            self.sink(place, node);
        }
    }

    /// Takes the element with the smallest key out.
    #[inline]
    pub fn pop(&mut self) -> Option<(I, f64)> {
        let first = *self.nodes.first()?;
        self.take(0);
        Some((first.id(), first.key()))
    }

    /// Takes `id` out; returns its key if it was in.
    pub fn remove(&mut self, id: I) -> Option<f64> {
        let place = self.place(id)?;
        let key = self.nodes[place].key();
        self.take(place);
        Some(key)
    }

    #[inline]
    fn place(&self, id: I) -> Option<usize> {
        match self.places.get(id.index()) {
            Some(&place) if place != OUTSIDE => Some(place as usize),
            _ => None,
        }
    }

    fn make_room(&mut self, id: I) {
        if id.index() >= self.places.len() {
            self.places.resize(id.index() + 1, OUTSIDE);
        }
    }

    /// Takes the node at `place` out and fills the gap with the last one.
    fn take(&mut self, place: usize) {
        self.places[self.nodes[place].index()] = OUTSIDE;
        let Some(last) = self.nodes.pop() else { return };
        if place == self.nodes.len() {
            return;
        }
        if place > 0 && last < self.nodes[(place - 1) / CHILDREN] {
            self.rise(place, last);
        } else {
            self.sink(place, last);
        }
    }

    /// Puts `node` at `place` or above.
    fn rise(&mut self, mut place: usize, node: Node) {
        while place > 0 {
            let parent = (place - 1) / CHILDREN;
            let above = self.nodes[parent];
            if node >= above {
                break;
            }
            self.put(place, above);
            place = parent;
        }
        self.put(place, node);
    }

    /// Puts `node` at `place` or below.
    fn sink(&mut self, mut place: usize, node: Node) {
        loop {
            let start = place * CHILDREN + 1;
            let children = self.nodes.get(start..).unwrap_or_default();
            let (least, child) = if let Some(&[a, b, c, d]) = children.first_chunk() {
                let (i, one) = if b < a { (1, b) } else { (0, a) };
                let (j, other) = if d < c { (3, d) } else { (2, c) };
                if other < one { (j, other) } else { (i, one) }
            } else {
                // A node with fewer children is the last to have any.
                let Some((i, &child)) = children.iter().enumerate().min_by_key(|(_, node)| **node)
                else {
                    break;
                };
                (i, child)
            };
            if child >= node {
                break;
            }
            self.put(place, child);
            place = start + least;
        }
        self.put(place, node);
    }

    #[inline]
    fn put(&mut self, place: usize, node: Node) {
        self.nodes[place] = node;
        self.places[node.index()] = place as u32;
    }
}

impl<I: Id> Default for IndexedHeap<I> {
    fn default() -> Self {
        IndexedHeap::new()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;
    use crate::VertexId;

    proptest! {
        #[test]
        fn it_does_what_a_sorted_map_does(
            steps in proptest::collection::vec((0_usize..40, 0_u8..12, 0_u8..4), 1..400),
        ) {
            let mut heap: IndexedHeap<VertexId> = IndexedHeap::new();
            let mut model: BTreeMap<usize, f64> = BTreeMap::new();
            let smallest = |model: &BTreeMap<usize, f64>| {
                model.iter().min_by(|a, b| a.1.total_cmp(b.1).then(a.0.cmp(b.0))).map(|(&i, &k)| (i, k))
            };
            for (i, key, what) in steps {
                let id = VertexId::new(i);
                match what {
                    0 => {
                        let expected = smallest(&model);
                        expected.map(|(i, _)| model.remove(&i));
                        prop_assert_eq!(heap.pop().map(|(v, k)| (v.index(), k)), expected);
                    }
                    1 => prop_assert_eq!(heap.remove(id), model.remove(&i)),
                    _ => {
                        heap.set(id, f64::from(key));
                        model.insert(i, f64::from(key));
                    }
                }
                prop_assert_eq!(heap.len(), model.len());
                prop_assert_eq!(heap.key(id), model.get(&i).copied());
                prop_assert_eq!(heap.first().map(|(v, k)| (v.index(), k)), smallest(&model));
            }
        }

        #[test]
        fn built_at_once_it_pops_in_order(keys in proptest::collection::vec(0_u8..9, 0..60)) {
            let keyed = keys.iter().enumerate().map(|(i, &k)| (VertexId::new(i), f64::from(k)));
            let mut heap = IndexedHeap::from_keys(keyed);
            let popped: Vec<_> = std::iter::from_fn(|| heap.pop()).collect();
            prop_assert_eq!(popped.len(), keys.len());
            prop_assert!(popped.windows(2).all(|w| (w[0].1, w[0].0) < (w[1].1, w[1].0)));
        }
    }
}
