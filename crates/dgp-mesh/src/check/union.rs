//! Disjoint sets that are joined: union–find with path halving (Tarjan & van Leeuwen 1984).

/// A partition of `0..len`; each set is known by its smallest element.
pub(crate) struct Union {
    parents: Vec<u32>,
}

impl Union {
    /// Every element on its own.
    pub(crate) fn new(len: usize) -> Self {
        Union { parents: (0..len as u32).collect() }
    }

    /// The smallest element of the set of `i`.
    pub(crate) fn find(&mut self, i: usize) -> usize {
        let mut i = i as u32;
        loop {
            let parent = self.parents[i as usize];
            let grandparent = self.parents[parent as usize];
            if parent == grandparent {
                return parent as usize;
            }
            self.parents[i as usize] = grandparent;
            i = grandparent;
        }
    }

    /// Makes one set of those of `i` and `j`; returns whether they were two.
    pub(crate) fn join(&mut self, i: usize, j: usize) -> bool {
        let (i, j) = (self.find(i), self.find(j));
        self.parents[i.max(j)] = i.min(j) as u32;
        i != j
    }
}
