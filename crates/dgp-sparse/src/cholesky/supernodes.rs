//! The tree of the blocks: whose update goes where.

use std::ops::Range;

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use crate::order::NONE;

/// Subtrees with less than the first and more than the second part of the entries of the factor are pieces for
/// a thread that solves.
const PIECE: [usize; 2] = [8, 256];

/// Factors with fewer entries are solved with by one thread: half a millisecond.
const SMALL: usize = 500_000;

/// The tree of the blocks, which are numbered depth first.
#[derive(Debug)]
pub(super) struct Supernodes {
    /// Where the children of each block start in the list, its end, and the list; the roots are the
    /// children of the last.
    starts: Vec<u32>,
    children: Vec<u32>,
    /// The first block of the subtree below each.
    first: Vec<u32>,
    /// Operations of the subtree of each.
    work: Vec<f64>,
    pieces: Vec<Range<usize>>,
    above: Vec<Range<usize>>,
}

impl Supernodes {
    pub(super) fn new(blocks: &SymbolicSupernodalCholesky<u32>) -> Supernodes {
        let count = blocks.n_supernodes();
        let (begin, end) = (blocks.supernode_begin(), blocks.supernode_end());
        let mut block_of = vec![0_u32; blocks.ncols()];
        for block in 0..count {
            block_of[begin[block] as usize..end[block] as usize].fill(block as u32);
        }
        let mut parent = vec![count as u32; count];
        let mut work = vec![0.0; count + 1];
        let mut first = vec![NONE; count + 1];
        let mut starts = vec![0_u32; count + 2];
        for block in 0..count {
            let rows = blocks.supernode(block).pattern();
            let (columns, height) = (f64::from(end[block] - begin[block]), rows.len() as f64);
            // The last term stands for what is not arithmetic.
            work[block] += columns * (columns + height).powi(2) + 2.0 * height * height + 500.0;
            first[block] = first[block].min(block as u32);
            if let Some(&row) = rows.first() {
                parent[block] = block_of[row as usize];
            }
            let above = parent[block] as usize;
            work[above] += work[block];
            first[above] = first[above].min(first[block]);
            starts[above + 1] += 1;
        }
        crate::matrix::accumulate(&mut starts);
        let mut next = starts.clone();
        let mut children = vec![0_u32; count];
        for (block, &parent) in parent.iter().enumerate() {
            children[next[parent as usize] as usize] = block as u32;
            next[parent as usize] += 1;
        }
        let (pieces, above) = (Vec::new(), Vec::new());
        let mut tree = Supernodes { starts, children, first, work, pieces, above };
        tree.divide(blocks);
        tree
    }

    /// Finds the pieces.
    fn divide(&mut self, blocks: &SymbolicSupernodalCholesky<u32>) {
        let ends = blocks.col_ptr_for_val();
        let all = blocks.len_val();
        let [most, least] = PIECE.map(|part| all / part);
        let entries = |blocks: &Range<usize>| (ends[blocks.end] - ends[blocks.start]) as usize;
        let mut subtrees = if all < SMALL { Vec::new() } else { self.roots().to_vec() };
        while let Some(root) = subtrees.pop() {
            let subtree = self.first_below(root as usize)..root as usize + 1;
            match entries(&subtree) {
                some if some > most => subtrees.extend(self.children(root as usize)),
                some if some >= least => self.pieces.push(subtree),
                _ => {}
            }
        }
        self.pieces.sort_by_key(|piece| piece.start);
        let mut begun = 0;
        for piece in &self.pieces {
            self.above.extend((begun < piece.start).then_some(begun..piece.start));
            begun = piece.end;
        }
        let count = blocks.n_supernodes();
        self.above.extend((begun < count).then_some(begun..count));
    }

    /// The blocks whose update goes to this one, ascending.
    pub(super) fn children(&self, block: usize) -> &[u32] {
        &self.children[self.starts[block] as usize..self.starts[block + 1] as usize]
    }

    /// The blocks without an update.
    pub(super) fn roots(&self) -> &[u32] {
        self.children(self.starts.len() - 2)
    }

    /// The first block of a subtree, which ends with its root.
    pub(super) fn first_below(&self, block: usize) -> usize {
        self.first[block] as usize
    }

    /// Subtrees that can be gone through side by side when solving, ascending.
    pub(super) fn pieces(&self) -> &[Range<usize>] {
        &self.pieces
    }

    /// The blocks that are in none of them, ascending.
    pub(super) fn above_pieces(&self) -> &[Range<usize>] {
        &self.above
    }

    /// The operations of a subtree.
    pub(super) fn work(&self, block: usize) -> f64 {
        self.work[block]
    }
}
