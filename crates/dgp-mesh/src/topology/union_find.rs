//! Which elements belong together, as pairs that do become known.

/// Disjoint sets of 0..len; the representative of each is its smallest element.
///
/// Linking to the smaller root with path halving costs O(log n) amortized (Tarjan and van Leeuwen
/// 1984), and makes the outcome independent of the order of the pairs.
#[derive(Clone, Debug)]
pub(crate) struct UnionFind {
    parents: Vec<u32>,
}

impl UnionFind {
    pub(crate) fn new(len: usize) -> Self {
        UnionFind { parents: (0..len as u32).collect() }
    }

    /// The smallest element of the set of `i`.
    pub(crate) fn find(&mut self, i: usize) -> usize {
        let mut i = i as u32;
        loop {
            let parent = self.parents[i as usize];
            if parent == i {
                return i as usize;
            }
            let grandparent = self.parents[parent as usize];
            self.parents[i as usize] = grandparent;
            i = grandparent;
        }
    }

    /// Puts the sets of `i` and `j` together.
    pub(crate) fn join(&mut self, i: usize, j: usize) {
        let (a, b) = (self.find(i), self.find(j));
        self.parents[a.max(b)] = a.min(b) as u32;
    }
}
