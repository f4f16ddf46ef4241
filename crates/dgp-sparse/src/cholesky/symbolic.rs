//! What a factorization needs to know of the pattern: order, elimination tree, blocks of columns.

use std::fmt;

use faer::{
    dyn_stack::{MemBuffer, MemStack},
    sparse::{
        SymbolicSparseColMatRef,
        linalg::{
            SymbolicSupernodalParams,
            cholesky::{
                simplicial::{
                    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
                },
                supernodal::{
                    SymbolicSupernodalCholesky, factorize_supernodal_symbolic_cholesky,
                    factorize_supernodal_symbolic_cholesky_scratch,
                },
            },
        },
    },
};

use super::{CholeskyOptions, supernodes::Supernodes};
use crate::{
    Error, MAX_ENTRIES, Progress, SparseMatrix,
    order::{Graph, NONE, Tree, order},
    parallel,
};

/// The order of elimination and the pattern of the factor, for all matrices with one pattern.
pub struct SymbolicCholesky {
    /// The pattern that was analyzed.
    starts: Vec<u32>,
    indices: Vec<u32>,
    tree: Tree,
    /// The lower triangle in the order of elimination, by columns: where each starts, the row of each
    /// entry, and where its value stands in the matrix. The diagonal comes first.
    lower_starts: Vec<u32>,
    lower_rows: Vec<u32>,
    sources: Vec<u32>,
    blocks: SymbolicSupernodalCholesky<u32>,
    supernodes: Supernodes,
    /// The largest number of rows below the diagonal of a block.
    tallest: usize,
}

impl SymbolicCholesky {
    /// Analyzes the pattern of a symmetric matrix.
    pub fn new(
        matrix: &SparseMatrix,
        options: &CholeskyOptions,
        progress: Progress<'_>,
    ) -> Result<SymbolicCholesky, Error> {
        matrix.check_square()?;
        let check = || {
            matrix.check_symmetric()?;
            // A diagonal entry that is not stored is a zero that cannot be positive.
            let stored = |i: usize| matrix.column(i).0.binary_search(&(i as u32)).is_ok();
            match (0..matrix.rows()).find(|&i| !stored(i)) {
                Some(row) => Err(Error::NotPositiveDefinite { row, pivot: 0.0, diagonal: 0.0 }),
                None => Ok(()),
            }
        };
        let (checked, graph) = parallel::join(check, || Graph::of(matrix));
        checked?;
        let order = order(&graph, &options.ordering, progress.part(0.0, 0.8))?;
        progress.report(0.8)?;
        let tree = Tree::new(&graph, &order);
        let entries = tree.entries();
        if entries > MAX_ENTRIES {
            let kind = "entries of the factor";
            return Err(Error::TooLarge { kind, count: entries, limit: MAX_ENTRIES });
        }
        let ((lower_starts, lower_rows, sources), blocks) =
            parallel::join(|| lower_triangle(matrix, &tree), || blocks(&graph, &tree));
        let blocks = blocks?;
        let tallest = blocks.nnz_per_super().iter().map(|&rows| rows as usize).max().unwrap_or(0);
        let supernodes = Supernodes::new(&blocks);
        progress.report(1.0)?;
        Ok(SymbolicCholesky {
            starts: matrix.starts().to_vec(),
            indices: matrix.indices().to_vec(),
            tree,
            lower_starts,
            lower_rows,
            sources,
            blocks,
            supernodes,
            tallest,
        })
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.tree.order.len()
    }

    /// The row that is eliminated as the `k`-th, for each `k`.
    pub fn order(&self) -> &[u32] {
        &self.tree.order
    }

    /// The entries of the factor, without the zeros that blocks of columns store beside them.
    pub fn factor_entries(&self) -> usize {
        self.tree.entries()
    }

    /// The entries that are stored.
    pub fn stored_entries(&self) -> usize {
        self.blocks.len_val()
    }

    /// Multiplications and additions of one factorization.
    pub fn operations(&self) -> f64 {
        self.tree.operations()
    }

    pub(super) fn blocks(&self) -> &SymbolicSupernodalCholesky<u32> {
        &self.blocks
    }

    pub(super) fn tallest(&self) -> usize {
        self.tallest
    }

    /// The tree of the blocks.
    pub(super) fn supernodes(&self) -> &Supernodes {
        &self.supernodes
    }

    /// The number of columns of a block.
    pub(super) fn block_columns(&self, block: usize) -> usize {
        (self.blocks.supernode_end()[block] - self.blocks.supernode_begin()[block]) as usize
    }

    /// The rows of a block below its square.
    pub(super) fn block_rows(&self, block: usize) -> &[u32] {
        let start = self.blocks.col_ptr_for_row_idx()[block] as usize;
        &self.blocks.row_idx()[start..start + self.blocks.nnz_per_super()[block] as usize]
    }

    /// Starts and rows of the lower triangle in the order of elimination.
    pub(super) fn lower_pattern(&self) -> (&[u32], &[u32]) {
        (&self.lower_starts, &self.lower_rows)
    }

    /// The values of the lower triangle times `factor`.
    pub(super) fn lower_values(&self, matrix: &SparseMatrix, factor: f64) -> Vec<f64> {
        let values = matrix.values();
        self.sources.iter().map(|&source| values[source as usize] * factor).collect()
    }

    /// An error unless `matrix` has the pattern that was analyzed.
    pub(super) fn check_pattern(&self, matrix: &SparseMatrix) -> Result<(), Error> {
        if self.starts == matrix.starts()
            && self.indices == matrix.indices()
            && self.rows() == matrix.rows()
        {
            return Ok(());
        }
        Error::check_length("the matrix (rows)", matrix.rows(), self.rows())?;
        Error::check_length("the matrix (columns)", matrix.columns(), self.rows())?;
        let analyzed =
            |j: usize| &self.indices[self.starts[j] as usize..self.starts[j + 1] as usize];
        let column = (0..self.rows()).find(|&j| analyzed(j) != matrix.column(j).0);
        Err(Error::OtherPattern { column: column.unwrap_or(0) })
    }
}

impl fmt::Debug for SymbolicCholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} rows, {} entries of the factor", self.rows(), self.factor_entries())
    }
}

/// Starts, rows and places in `matrix` of the entries on and below the diagonal, in the order of
/// elimination.
fn lower_triangle(matrix: &SparseMatrix, tree: &Tree) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let count = matrix.entries().midpoint(matrix.rows());
    let mut starts = Vec::with_capacity(matrix.rows() + 1);
    let (mut rows, mut sources) = (Vec::with_capacity(count), Vec::with_capacity(count));
    starts.push(0);
    for (k, &j) in tree.order.iter().enumerate() {
        let first = matrix.starts()[j as usize];
        let start = rows.len();
        for (source, &i) in (first..).zip(matrix.column(j as usize).0) {
            let row = tree.place[i as usize];
            if row as usize >= k {
                rows.push(row);
                sources.push(source);
                if row as usize == k {
                    let last = rows.len() - 1;
                    rows.swap(start, last);
                    sources.swap(start, last);
                }
            }
        }
        starts.push(rows.len() as u32);
    }
    (starts, rows, sources)
}

/// The blocks of columns with nearly equal pattern.
fn blocks(graph: &Graph, tree: &Tree) -> Result<SymbolicSupernodalCholesky<u32>, Error> {
    let n = graph.len();
    let (starts, rows) = upper_triangle(graph, tree);
    let upper = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &starts, None, &rows);
    // faer makes trees only by itself, in time proportional to the entries of the factor of what it is
    // given. The graph that has just the edges of our tree has the same tree and no other entries.
    let (tree_starts, tree_rows) = edges_to_parents(&tree.parent);
    let edges = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &tree_starts, None, &tree_rows);
    let size = prefactorize_symbolic_cholesky_scratch::<u32>(n, tree_rows.len())
        .or(factorize_supernodal_symbolic_cholesky_scratch::<u32>(n));
    let mut memory = MemBuffer::new(size);
    let stack = MemStack::new(&mut memory);
    let (mut parents, mut unused) = (vec![0_i32; n], vec![0_u32; n]);
    let parents = prefactorize_symbolic_cholesky(&mut parents, &mut unused, edges, stack);
    factorize_supernodal_symbolic_cholesky(
        upper,
        parents,
        &tree.counts,
        stack,
        SymbolicSupernodalParams::default(),
    )
    .map_err(|_| {
        let kind = "stored entries of the factor";
        Error::TooLarge { kind, count: tree.entries(), limit: MAX_ENTRIES }
    })
}

/// Starts and rows above the diagonal, by columns in the order of elimination.
fn upper_triangle(graph: &Graph, tree: &Tree) -> (Vec<u32>, Vec<u32>) {
    let mut starts = Vec::with_capacity(graph.len() + 1);
    let mut rows = Vec::with_capacity(graph.neighbors_of_all().len() / 2);
    starts.push(0);
    for (k, &v) in tree.order.iter().enumerate() {
        let places = graph.neighbors(v as usize).iter().map(|&w| tree.place[w as usize]);
        rows.extend(places.filter(|&row| (row as usize) < k));
        starts.push(rows.len() as u32);
    }
    (starts, rows)
}

/// Starts and rows of the matrix that has an entry above the diagonal for each edge of the tree.
fn edges_to_parents(parent: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let n = parent.len();
    let mut starts = vec![0_u32; n + 1];
    for &parent in parent.iter().filter(|&&parent| parent != NONE) {
        starts[parent as usize + 1] += 1;
    }
    crate::matrix::accumulate(&mut starts);
    let mut next = starts.clone();
    let mut rows = vec![0_u32; starts[n] as usize];
    for (i, &parent) in parent.iter().enumerate().filter(|&(_, &parent)| parent != NONE) {
        rows[next[parent as usize] as usize] = i as u32;
        next[parent as usize] += 1;
    }
    (starts, rows)
}
