//! The elimination tree: which column of the factor first needs the result of which.
//!
//! ```text
//! parent(j) = the first row below the diagonal of column j of L
//! ```
//!
//! - Input: the graph of a symmetric matrix and an order of elimination.
//! - Cost: time nearly linear in the edges, not in the entries of the factor.
//! - Reference: Liu, "The role of elimination trees in sparse factorization", 1990; Gilbert, Ng and
//!   Peyton, "An efficient algorithm to compute row and column counts", 1994.

use super::Graph;

/// No vertex, no parent.
pub(crate) const NONE: u32 = u32::MAX;

/// The order, renumbered so that each subtree is contiguous, with its tree.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    /// The row that is eliminated as the k-th.
    pub(crate) order: Vec<u32>,
    /// At which place each row is eliminated.
    pub(crate) place: Vec<u32>,
    /// The parent of each place, or [`NONE`].
    pub(crate) parent: Vec<u32>,
    /// The entries of each column of the factor, its diagonal counted.
    pub(crate) counts: Vec<u32>,
}

impl Tree {
    /// The tree of `graph` eliminated in `order`, which is changed to an equivalent one.
    pub(crate) fn new(graph: &Graph, order: &[u32]) -> Tree {
        // What is eliminated one after the other lies one after the other from here on.
        let sorted = graph.permuted(order, &places(order));
        let mut tree = Tree {
            order: (0..order.len() as u32).collect(),
            place: Vec::new(),
            parent: parents(&sorted),
            counts: Vec::new(),
        };
        tree.renumber(|_| 0);
        tree.place = places(&tree.order);
        tree.counts = column_counts(&sorted, &tree);
        // Of several children the one with the longest column comes last, next to its parent: those
        // two are most likely to be merged into one block.
        let counts = std::mem::take(&mut tree.counts);
        let renumbering = tree.renumber(|k| counts[k]);
        tree.counts = renumbering.iter().map(|&old| counts[old as usize]).collect();
        tree.order.iter_mut().for_each(|row| *row = order[*row as usize]);
        tree.place = places(&tree.order);
        tree
    }

    /// Entries of the factor.
    pub(crate) fn entries(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).sum()
    }

    /// Multiplications and additions of the factorization.
    pub(crate) fn operations(&self) -> f64 {
        self.counts.iter().map(|&count| f64::from(count) * f64::from(count)).sum()
    }

    /// Renumbers depth first, of siblings the one with the smallest `key` first. Returns the old
    /// number of each.
    fn renumber(&mut self, key: impl Fn(usize) -> u32) -> Vec<u32> {
        let old_of_new = postorder(&self.parent, key);
        let new_of_old = places(&old_of_new);
        self.order = old_of_new.iter().map(|&old| self.order[old as usize]).collect();
        let parent = |&old: &u32| match self.parent[old as usize] {
            NONE => NONE,
            parent => new_of_old[parent as usize],
        };
        self.parent = old_of_new.iter().map(parent).collect();
        old_of_new
    }
}

/// The inverse of a permutation.
fn places(order: &[u32]) -> Vec<u32> {
    let mut place = vec![0; order.len()];
    for (k, &row) in order.iter().enumerate() {
        place[row as usize] = k as u32;
    }
    place
}

/// Liu's algorithm with path compression, for a graph that is eliminated as it is numbered.
fn parents(graph: &Graph) -> Vec<u32> {
    let n = graph.len();
    let mut parent = vec![NONE; n];
    let mut ancestor = vec![NONE; n];
    for k in 0..n as u32 {
        for &w in graph.neighbors(k as usize) {
            let mut i = w;
            while i < k {
                let next = ancestor[i as usize];
                if next == k {
                    break;
                }
                ancestor[i as usize] = k;
                if next == NONE {
                    parent[i as usize] = k;
                    break;
                }
                i = next;
            }
        }
    }
    parent
}

/// The nodes of a forest, children before parents, each subtree contiguous; siblings by `key`.
fn postorder(parent: &[u32], key: impl Fn(usize) -> u32) -> Vec<u32> {
    let n = parent.len();
    let (mut first_child, mut sibling) = (vec![NONE; n], vec![NONE; n]);
    for i in (0..n).rev() {
        if parent[i] != NONE {
            let head = &mut first_child[parent[i] as usize];
            sibling[i] = *head;
            *head = i as u32;
        }
    }
    let mut order = Vec::with_capacity(n);
    let (mut stack, mut children) = (Vec::new(), Vec::new());
    for root in (0..n).filter(|&i| parent[i] == NONE) {
        stack.push(root as u32);
        while let Some(&top) = stack.last() {
            let mut child = std::mem::replace(&mut first_child[top as usize], NONE);
            if child == NONE {
                order.push(top);
                stack.pop();
                continue;
            }
            children.clear();
            while child != NONE {
                children.push(child);
                child = sibling[child as usize];
            }
            children.sort_by_key(|&child| key(child as usize));
            stack.extend(children.iter().rev());
        }
    }
    order
}

/// How many entries each column of the factor has, for a tree that is numbered depth first.
///
/// Row i of the factor is the subtree spanned by the columns j < i adjacent to i. Its leaves add one
/// to the count at the leaf; where two of its branches meet, one is counted too often.
fn column_counts(graph: &Graph, tree: &Tree) -> Vec<u32> {
    let n = graph.len();
    let parent = &tree.parent;
    let mut first_descendant = vec![NONE; n];
    // Differences that become the counts when summed over subtrees; they wrap on the way.
    let mut counts = vec![0_u32; n];
    for k in 0..n {
        counts[k] = u32::from(first_descendant[k] == NONE);
        let mut j = k as u32;
        while j != NONE && first_descendant[j as usize] == NONE {
            first_descendant[j as usize] = k as u32;
            j = parent[j as usize];
        }
    }
    // Of each row: the largest first descendant seen, and the last leaf found.
    let (mut deepest, mut last_leaf) = (vec![NONE; n], vec![NONE; n]);
    let mut ancestor: Vec<u32> = (0..n as u32).collect();
    for j in 0..n {
        if parent[j] != NONE {
            counts[parent[j] as usize] = counts[parent[j] as usize].wrapping_sub(1);
        }
        for &w in graph.neighbors(tree.order[j] as usize) {
            let i = tree.place[w as usize] as usize;
            if i <= j {
                continue;
            }
            let first = first_descendant[j];
            if deepest[i] != NONE && first <= deepest[i] {
                continue;
            }
            deepest[i] = first;
            counts[j] = counts[j].wrapping_add(1);
            let previous = std::mem::replace(&mut last_leaf[i], j as u32);
            if previous != NONE {
                let meeting = find(&mut ancestor, previous) as usize;
                counts[meeting] = counts[meeting].wrapping_sub(1);
            }
        }
        if parent[j] != NONE {
            ancestor[j] = parent[j];
        }
    }
    for j in 0..n {
        if parent[j] != NONE {
            counts[parent[j] as usize] = counts[parent[j] as usize].wrapping_add(counts[j]);
        }
    }
    counts
}

/// The root of `i`, with the path to it compressed.
fn find(ancestor: &mut [u32], i: u32) -> u32 {
    let mut root = i;
    while ancestor[root as usize] != root {
        root = ancestor[root as usize];
    }
    let mut i = i;
    while i != root {
        i = std::mem::replace(&mut ancestor[i as usize], root);
    }
    root
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::SparseMatrix;

    /// The rows of each column of the factor, by elimination as in the textbook.
    fn factor_pattern(matrix: &SparseMatrix, order: &[u32]) -> Vec<Vec<usize>> {
        let n = order.len();
        let mut filled = vec![vec![false; n]; n];
        for (k, row) in filled.iter_mut().enumerate() {
            let (rows, _) = matrix.column(order[k] as usize);
            for (l, entry) in row.iter_mut().enumerate() {
                *entry = k == l || rows.contains(&order[l]);
            }
        }
        for k in 0..n {
            let below: Vec<usize> = (k + 1..n).filter(|&i| filled[i][k]).collect();
            for &i in &below {
                for &j in &below {
                    filled[i][j] = true;
                }
            }
        }
        (0..n).map(|k| (k..n).filter(|&i| filled[i][k]).collect()).collect()
    }

    proptest! {
        #[test]
        fn parents_and_counts_equal_those_of_the_filled_matrix(
            edges in prop::collection::vec((0..12_u32, 0..12_u32), 0..30),
            order in Just((0..12_u32).collect::<Vec<_>>()).prop_shuffle()
        ) {
            let edges: Vec<_> = edges.into_iter().map(|(i, j)| (i, j, 1.0)).collect();
            let matrix = SparseMatrix::from_edges(12, &edges).unwrap();
            let graph = Graph::of(&matrix);
            let tree = Tree::new(&graph, &order);
            let entries = |order: &[u32]| {
                factor_pattern(&matrix, order).iter().map(Vec::len).sum::<usize>()
            };
            prop_assert_eq!(entries(&order), entries(&tree.order), "an equivalent order");
            for (k, rows) in factor_pattern(&matrix, &tree.order).iter().enumerate() {
                prop_assert_eq!(tree.counts[k] as usize, rows.len());
                prop_assert_eq!(tree.parent[k], rows.get(1).map_or(NONE, |&i| i as u32));
                if let Some(&parent) = rows.get(1) {
                    // Depth first: between a node and its parent there are only descendants.
                    let inside = (k + 1..parent).all(|i| tree.parent[i] as usize <= parent);
                    prop_assert!(inside);
                }
            }
        }
    }
}
