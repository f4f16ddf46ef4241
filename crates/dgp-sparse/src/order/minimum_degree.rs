//! Approximate minimum degree: eliminates the vertex with the fewest neighbors, again and again.
//!
//! Eliminating a vertex joins its neighbors to each other. Instead of those edges the vertex stays as
//! an *element*, which stands for a clique of its neighbors, and absorbs the elements next to it: the
//! graph never grows. Vertices that have become indistinguishable are merged, and the number of
//! neighbors is replaced by a bound that is cheap to keep,
//!
//! ```text
//! d(i) ≤ |A(i)| + |L(me) \ i| + Σ |L(e) \ L(me)| over the other elements e of i
//! ```
//!
//! - Input: a graph, of whose vertices some (the *halo*) are eliminated later by others: they count as
//!   neighbors, but are not ordered here.
//! - Cost: in practice O(edges) memory and time a little above linear.
//! - Reference: Amestoy, Davis and Duff, "An approximate minimum degree ordering algorithm", 1996;
//!   Pellegrini, Roman and Amestoy, "Hybridizing nested dissection and halo approximate minimum
//!   degree", 2000.
//! - Departs from it: lists of new elements are appended, and memory is compacted when it has doubled.

use super::{Graph, NONE};

/// Marks in [`MinimumDegree::elements`] a vertex that has become an element.
const ELEMENT: u32 = u32::MAX;

/// The graph while it is eliminated; kept, so that many small graphs share the memory.
#[derive(Debug, Default)]
pub(crate) struct MinimumDegree {
    /// How many of the vertices are to be ordered; the halo comes after them.
    inner: usize,
    /// The lists of all vertices: elements first, then vertices.
    lists: Vec<u32>,
    /// Where each list starts, and its length.
    start: Vec<u32>,
    length: Vec<u32>,
    /// How many elements the list of a vertex starts with, or [`ELEMENT`].
    elements: Vec<u32>,
    /// How many vertices this one stands for: 0 once merged or eliminated, negative while it is in
    /// the list of the current element.
    size: Vec<i32>,
    /// The bound of the degree; of an element the size of its list.
    degree: Vec<u32>,
    /// Of an element 0 once absorbed, else a scratch value below `stamp` between pivots.
    mark: Vec<u32>,
    stamp: u32,
    /// Vertices by degree: the first of each degree, and doubly linked lists. `next` also links
    /// vertices with equal hash.
    head: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    smallest: usize,
    /// Vertices by hash of their lists.
    buckets: Vec<u32>,
    hash: Vec<u32>,
    /// The vertices that each stands for: a list from itself on, with its last.
    merged: Vec<u32>,
    last_merged: Vec<u32>,
    /// The largest list of an element so far.
    largest: u32,
    /// Vertices that are eliminated.
    eliminated: u32,
}

/// An order for the whole of `graph`. Vertices with very many neighbors come last.
pub(crate) fn minimum_degree(graph: &Graph) -> Vec<u32> {
    let n = graph.len();
    let (sparse, dense): (Vec<u32>, Vec<u32>) =
        (0..n as u32).partition(|&v| graph.neighbors(v as usize).len() <= dense_limit(n));
    let mut local = vec![NONE; n];
    for (i, &v) in sparse.iter().chain(&dense).enumerate() {
        local[v as usize] = i as u32;
    }
    let mut engine = MinimumDegree::default();
    engine.clear(sparse.len());
    for &v in &sparse {
        engine.push(graph.neighbors(v as usize).iter().map(|&w| local[w as usize]));
    }
    for &v in &dense {
        let neighbors = graph.neighbors(v as usize).iter().map(|&w| local[w as usize]);
        engine.push(neighbors.filter(|&i| (i as usize) < sparse.len()));
    }
    let mut order = Vec::with_capacity(n);
    engine.run(|i| order.push(sparse[i as usize]));
    order.extend(dense);
    order
}

/// The most neighbors that a vertex may have and still take part: the factor 10 is that of the paper's
/// authors' program.
pub(crate) fn dense_limit(n: usize) -> usize {
    16.max((10.0 * (n as f64).sqrt()) as usize)
}

impl MinimumDegree {
    /// Forgets the graph. The first `inner` of the vertices pushed from now on are to be ordered.
    pub(crate) fn clear(&mut self, inner: usize) {
        self.inner = inner;
        self.lists.clear();
        self.start.clear();
        self.length.clear();
    }

    /// Adds a vertex with its neighbors. Those of the halo list inner vertices only.
    pub(crate) fn push(&mut self, neighbors: impl Iterator<Item = u32>) {
        let start = self.lists.len();
        self.lists.extend(neighbors);
        self.start.push(start as u32);
        self.length.push((self.lists.len() - start) as u32);
    }

    /// Calls `emit` with the inner vertices in the order of elimination.
    pub(crate) fn run(&mut self, mut emit: impl FnMut(u32)) {
        self.prepare(&mut emit);
        let mut limit = 2 * self.lists.len() + 8 * self.start.len();
        while (self.eliminated as usize) < self.inner {
            if self.lists.len() > limit {
                self.compact();
                limit = 2 * self.lists.len() + 8 * self.start.len();
            }
            let pivot = self.take_smallest();
            self.make_element(pivot);
            self.measure_elements(pivot);
            self.update_degrees(pivot);
            self.merge_equal(pivot);
            self.finish_element(pivot);
            let mut i = pivot;
            while i != NONE {
                emit(i);
                i = self.merged[i as usize];
            }
        }
    }

    fn prepare(&mut self, emit: &mut impl FnMut(u32)) {
        let n = self.start.len();
        let refill = |values: &mut Vec<u32>, value: u32| {
            values.clear();
            values.resize(n, value);
        };
        refill(&mut self.elements, 0);
        refill(&mut self.mark, 1);
        refill(&mut self.next, NONE);
        refill(&mut self.previous, NONE);
        refill(&mut self.buckets, NONE);
        refill(&mut self.hash, 0);
        refill(&mut self.merged, NONE);
        refill(&mut self.head, NONE);
        self.head.push(NONE);
        self.size.clear();
        self.size.resize(n, 1);
        self.degree.clone_from(&self.length);
        self.last_merged.clear();
        self.last_merged.extend(0..n as u32);
        self.stamp = n as u32 + 2;
        self.largest = 0;
        self.eliminated = 0;
        self.smallest = n;
        for i in 0..self.inner {
            if self.degree[i] == 0 {
                emit(i as u32);
                self.size[i] = 0;
                self.mark[i] = 0;
                self.eliminated += 1;
            }
        }
        // Of equal degrees the last comes first, as in the authors' program: on meshes that are numbered
        // along rows this fills in up to a quarter less than the other way round.
        for i in 0..self.inner {
            if self.length[i] > 0 {
                self.insert(i);
            }
        }
    }

    /// Drops lists that are no longer in use.
    fn compact(&mut self) {
        let mut lists = Vec::with_capacity(self.lists.len());
        for i in 0..self.start.len() {
            let alive =
                if self.elements[i] == ELEMENT { self.mark[i] != 0 } else { self.size[i] > 0 };
            if alive {
                let start = self.start[i] as usize;
                self.start[i] = lists.len() as u32;
                lists.extend_from_slice(&self.lists[start..start + self.length[i] as usize]);
            }
        }
        self.lists = lists;
    }

    fn insert(&mut self, i: usize) {
        let degree = self.degree[i] as usize;
        let first = self.head[degree];
        self.next[i] = first;
        self.previous[i] = NONE;
        if first != NONE {
            self.previous[first as usize] = i as u32;
        }
        self.head[degree] = i as u32;
        self.smallest = self.smallest.min(degree);
    }

    fn remove(&mut self, i: usize) {
        let (previous, next) = (self.previous[i], self.next[i]);
        if next != NONE {
            self.previous[next as usize] = previous;
        }
        if previous == NONE {
            self.head[self.degree[i] as usize] = next;
        } else {
            self.next[previous as usize] = next;
        }
    }

    fn take_smallest(&mut self) -> u32 {
        while self.head[self.smallest] == NONE {
            self.smallest += 1;
        }
        let pivot = self.head[self.smallest];
        self.remove(pivot as usize);
        pivot
    }

    /// Joins the neighbors of `pivot` and of its elements, which it absorbs, in one list.
    fn make_element(&mut self, pivot: u32) {
        let me = pivot as usize;
        let size = self.size[me];
        self.eliminated += size as u32;
        self.size[me] = -size;
        let new_start = self.lists.len();
        let mut degree = 0;
        let (start, count) = (self.start[me] as usize, self.elements[me] as usize);
        for k in 0..=count {
            let (from, to) = if k < count {
                let element = self.lists[start + k] as usize;
                self.mark[element] = 0;
                (self.start[element] as usize, self.length[element] as usize)
            } else {
                (start + count, self.length[me] as usize - count)
            };
            for place in from..from + to {
                let i = self.lists[place] as usize;
                if self.size[i] > 0 {
                    degree += self.size[i] as u32;
                    self.size[i] = -self.size[i];
                    self.lists.push(i as u32);
                    if i < self.inner {
                        self.remove(i);
                    }
                }
            }
        }
        self.start[me] = new_start as u32;
        self.length[me] = (self.lists.len() - new_start) as u32;
        self.elements[me] = ELEMENT;
        self.degree[me] = degree;
        self.mark[me] = 1;
    }

    /// Leaves `stamp` + |L(e) \ L(me)| in the mark of each element e next to the list of `pivot`.
    fn measure_elements(&mut self, pivot: u32) {
        let me = pivot as usize;
        let start = self.start[me] as usize;
        for place in start..start + self.length[me] as usize {
            let i = self.lists[place] as usize;
            let size = -self.size[i] as u32;
            let first = self.start[i] as usize;
            for &e in &self.lists[first..first + self.elements[i] as usize] {
                let mark = &mut self.mark[e as usize];
                if *mark >= self.stamp {
                    *mark -= size;
                } else if *mark != 0 {
                    *mark = self.degree[e as usize] + self.stamp - size;
                }
            }
        }
    }

    /// New lists and degrees of the vertices of the element; those with no other neighbors are
    /// eliminated with it.
    fn update_degrees(&mut self, pivot: u32) {
        let me = pivot as usize;
        let start = self.start[me] as usize;
        for place in start..start + self.length[me] as usize {
            let i = self.lists[place] as usize;
            let first = self.start[i] as usize;
            let variables = first + self.elements[i] as usize;
            let (mut end, mut degree, mut hash) = (first, 0, pivot);
            for p in first..variables {
                let e = self.lists[p];
                let mark = self.mark[e as usize];
                if mark > self.stamp {
                    degree += mark - self.stamp;
                    self.lists[end] = e;
                    end += 1;
                    hash = hash.wrapping_add(e);
                } else {
                    // All of its vertices are in the new element, which absorbs it.
                    self.mark[e as usize] = 0;
                }
            }
            let kept = end;
            for p in variables..first + self.length[i] as usize {
                let j = self.lists[p];
                if self.size[j as usize] > 0 {
                    degree += self.size[j as usize] as u32;
                    self.lists[end] = j;
                    end += 1;
                    hash = hash.wrapping_add(j);
                }
            }
            if end == first && i < self.inner {
                let size = -self.size[i];
                self.degree[me] -= size as u32;
                self.size[me] -= size;
                self.size[i] = 0;
                self.eliminated += size as u32;
                self.append_merged(me, i);
                continue;
            }
            self.degree[i] = self.degree[i].min(degree);
            // Makes room for the new element in front: at least one entry has been dropped, the pivot
            // or an element that it absorbed.
            self.lists[end] = self.lists[kept];
            self.lists[kept] = self.lists[first];
            self.lists[first] = pivot;
            self.elements[i] = (kept - first + 1) as u32;
            self.length[i] = (end - first + 1) as u32;
            let bucket = hash as usize % self.buckets.len();
            self.hash[i] = bucket as u32;
            self.next[i] = std::mem::replace(&mut self.buckets[bucket], i as u32);
        }
        self.largest = self.largest.max(self.degree[me]);
        self.advance_stamp();
    }

    /// Makes all marks so far smaller than the stamp.
    fn advance_stamp(&mut self) {
        let n = self.start.len() as u32;
        self.stamp += self.largest.max(1);
        if self.stamp > u32::MAX - 2 * n - 2 {
            self.mark.iter_mut().for_each(|mark| *mark = (*mark).min(1));
            self.stamp = n + 2;
        }
    }

    /// Merges vertices of the element whose lists are equal.
    fn merge_equal(&mut self, pivot: u32) {
        let me = pivot as usize;
        let start = self.start[me] as usize;
        for place in start..start + self.length[me] as usize {
            let vertex = self.lists[place] as usize;
            if self.size[vertex] >= 0 {
                continue;
            }
            let bucket = self.hash[vertex] as usize;
            let mut i = std::mem::replace(&mut self.buckets[bucket], NONE);
            while i != NONE && self.next[i as usize] != NONE {
                self.merge_into(i as usize);
                i = self.next[i as usize];
            }
        }
    }

    /// Merges those that follow `i` in its bucket and have the same list into `i`.
    fn merge_into(&mut self, i: usize) {
        // The first entry is the current element for all.
        let list = |of: usize| of + 1;
        let (first, length) = (self.start[i] as usize, self.length[i] as usize);
        for &entry in &self.lists[list(first)..first + length] {
            self.mark[entry as usize] = self.stamp;
        }
        let mut before = i;
        let mut j = self.next[i];
        while j != NONE {
            let k = j as usize;
            let from = self.start[k] as usize;
            let same = self.length[k] as usize == length
                && self.elements[k] == self.elements[i]
                && (k < self.inner) == (i < self.inner)
                && self.lists[list(from)..from + length]
                    .iter()
                    .all(|&entry| self.mark[entry as usize] == self.stamp);
            j = self.next[k];
            if same {
                self.size[i] += self.size[k];
                self.size[k] = 0;
                self.append_merged(i, k);
                self.next[before] = j;
            } else {
                before = k;
            }
        }
        self.stamp += 1;
    }

    fn append_merged(&mut self, to: usize, from: usize) {
        let last = self.last_merged[to];
        self.last_merged[to] = self.last_merged[from];
        self.merged[last as usize] = from as u32;
    }

    /// Puts the vertices that are left in the element back into the lists by degree.
    fn finish_element(&mut self, pivot: u32) {
        let me = pivot as usize;
        let start = self.start[me] as usize;
        let mut end = start;
        let total = self.start.len() as u32;
        for place in start..start + self.length[me] as usize {
            let i = self.lists[place] as usize;
            let size = -self.size[i];
            if size <= 0 {
                continue;
            }
            self.size[i] = size;
            let size = size as u32;
            let degree = self.degree[i] + self.degree[me] - size;
            self.degree[i] = degree.min(total - self.eliminated - size);
            if i < self.inner {
                self.insert(i);
            }
            self.lists[end] = i as u32;
            end += 1;
        }
        self.size[me] = 0;
        self.length[me] = (end - start) as u32;
        self.lists.truncate(end);
        if end == start {
            self.mark[me] = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        SparseMatrix,
        order::{Tree, faer_minimum_degree, inverse},
    };

    fn graph_of(n: usize, edges: &[(u32, u32)]) -> Graph {
        let edges: Vec<_> = edges.iter().map(|&(i, j)| (i, j, 1.0)).collect();
        Graph::of(&SparseMatrix::from_edges(n, &edges).unwrap())
    }

    fn grid(n: u32) -> Graph {
        let mut edges = Vec::new();
        for i in 0..n * n {
            edges.extend((i % n + 1 < n).then_some((i, i + 1)));
            edges.extend((i + n < n * n).then_some((i, i + n)));
        }
        graph_of((n * n) as usize, &edges)
    }

    proptest! {
        #[test]
        fn any_graph_gets_a_permutation(
            edges in prop::collection::vec((0..40_u32, 0..40_u32), 0..200)
        ) {
            let graph = graph_of(40, &edges);
            prop_assert!(inverse(&minimum_degree(&graph), 40).is_ok());
        }
    }

    #[test]
    fn fill_is_no_worse_than_that_of_another_implementation() {
        for n in [10, 40, 100] {
            let graph = grid(n);
            let ours = Tree::new(&graph, &minimum_degree(&graph)).entries() as f64;
            let theirs = Tree::new(&graph, &faer_minimum_degree(&graph)).entries() as f64;
            assert!(ours < 1.05 * theirs, "{n}: {ours} {theirs}");
        }
    }

    #[test]
    fn a_tree_is_eliminated_without_fill_from_its_leaves() {
        let edges: Vec<(u32, u32)> = (1..1000).map(|i| (i, (i - 1) / 3)).collect();
        let graph = graph_of(1000, &edges);
        assert_eq!(Tree::new(&graph, &minimum_degree(&graph)).entries(), 1999);
    }

    #[test]
    fn the_hub_of_a_star_comes_last() {
        let edges: Vec<(u32, u32)> = (1..5000).map(|i| (0, i)).collect();
        assert_eq!(minimum_degree(&graph_of(5000, &edges)).last(), Some(&0));
    }

    #[test]
    fn the_halo_counts_but_is_not_ordered() {
        // A path 0–1–2, where the ends have three neighbors each that come later: the middle has the
        // smallest degree.
        let mut engine = MinimumDegree::default();
        engine.clear(3);
        let lists: [&[u32]; 9] =
            [&[1, 3, 4, 5], &[0, 2], &[1, 6, 7, 8], &[0], &[0], &[0], &[2], &[2], &[2]];
        for list in lists {
            engine.push(list.iter().copied());
        }
        let mut order = Vec::new();
        engine.run(|i| order.push(i));
        assert_eq!(order[0], 1);
        assert_eq!(order.len(), 3);
    }
}
