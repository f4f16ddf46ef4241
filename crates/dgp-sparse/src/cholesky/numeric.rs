//! The numbers of the factor, block by block up the elimination tree (multifrontal).
//!
//! ```text
//! ⎛ F₁₁  ·  ⎞   F = entries of A in the columns of the block + updates of its children
//! ⎝ F₂₁ F₂₂ ⎠   F₁₁ = L₁₁ L₁₁ᵀ,  L₂₁ = F₂₁ L₁₁⁻ᵀ,  update = F₂₂ − L₂₁ L₂₁ᵀ
//! ```
//!
//! Subtrees know nothing of each other. Large ones are shared among threads; small ones are gone through
//! depth first, with their updates on a stack. What is added to what, and in which order, is the same
//! either way.
//!
//! - Input: a symmetric matrix and the blocks of its factor, with the tree they form.
//! - Cost: O(Σ n³ + n² m) for blocks of n columns with m rows below them; beside the factor, the updates on
//!   the way up one path of the tree.
//! - Reference: Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear
//!   equations", 1983; Liu, "The multifrontal method for sparse matrix solution: theory and practice",
//!   1992.

use std::{
    ops::Range,
    sync::{Mutex, MutexGuard, PoisonError},
};

use faer::{
    Accum, MatMut, MatRef, Par, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt::factor::{
            LltError, LltParams, LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
        },
        triangular_solve::solve_lower_triangular_in_place,
    },
    prelude::default,
};

use super::{kernel, large, symbolic::SymbolicCholesky};
use crate::parallel;

/// Subtrees with fewer operations are one task: some milliseconds.
const TASK: f64 = 2e7;

/// Blocks of more columns are factored by faer, whose kernels lose on small ones.
const NARROW: usize = 8;

/// Updates of more operations are multiplied by faer.
const SMALL: usize = 6000;

/// Blocks of more operations are shared among threads.
const LARGE: usize = 100_000_000;

impl SymbolicCholesky {
    /// Sets `factor`, whatever it holds, from the values of the lower triangle. An error is the place of
    /// the first pivot that is not positive.
    pub(super) fn factor_numbers(&self, lower: &[f64], factor: &mut [f64]) -> Result<(), usize> {
        let room = Room::default();
        let numeric = Numeric { symbolic: self, lower, room: &room };
        numeric.forest(self.supernodes().roots(), factor, 0).map(|_| ())
    }
}

/// A factorization on its way.
#[derive(Clone, Copy)]
struct Numeric<'a> {
    symbolic: &'a SymbolicCholesky,
    lower: &'a [f64],
    room: &'a Room,
}

/// Memory that nobody needs any more: new memory costs the system as much as what is computed in it.
#[derive(Default)]
struct Room {
    updates: Mutex<Vec<Vec<f64>>>,
    stacks: Mutex<Vec<Vec<f64>>>,
}

impl Room {
    /// At least `len` numbers, whatever they are.
    fn update(&self, len: usize) -> Vec<f64> {
        let mut free = locked(&self.updates);
        let fits = (0..free.len()).filter(|&i| free[i].len() >= len);
        if let Some(best) = fits.min_by_key(|&i| free[i].len()) {
            return free.swap_remove(best);
        }
        drop(free);
        vec![0.0; len]
    }

    fn stack(&self) -> Vec<f64> {
        locked(&self.stacks).pop().unwrap_or_default()
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What threads keep from block to block.
struct Workspace {
    /// Updates that no parent has taken yet, one on the other; what lies above `top` is of no use.
    stack: Vec<f64>,
    top: usize,
    /// The row of the parent's front for each row of a child's update.
    rows: Vec<u32>,
    memory: MemBuffer,
}

impl Numeric<'_> {
    /// Factors subtrees that stand one after the other, of which `factor` starts at entry `offset` of the
    /// whole; the updates that they leave, each at the start of memory that may be longer.
    fn forest(
        self,
        roots: &[u32],
        factor: &mut [f64],
        offset: usize,
    ) -> Result<Vec<Vec<f64>>, usize> {
        let nodes = self.symbolic.supernodes();
        let work: f64 = roots.iter().map(|&root| nodes.work(root as usize)).sum();
        if work <= TASK {
            return self.small_forest(roots, factor);
        }
        if let &[root] = roots {
            return Ok(vec![self.large_tree(root as usize, factor, offset)?]);
        }
        // About half of the work on each side, and at least one tree.
        let mut half = 0.0;
        let mut count = 0;
        while count + 1 < roots.len() && (count == 0 || half < 0.5 * work) {
            half += nodes.work(roots[count] as usize);
            count += 1;
        }
        let (left, right) = roots.split_at(count);
        let middle = self.end_of(left[count - 1] as usize) - offset;
        let (first, second) = factor.split_at_mut(middle);
        let (first, second) = parallel::join(
            || self.forest(left, first, offset),
            || self.forest(right, second, offset + middle),
        );
        let mut updates = first?;
        updates.extend(second?);
        Ok(updates)
    }

    /// Where the values of a block end.
    fn end_of(self, block: usize) -> usize {
        self.symbolic.blocks().col_ptr_for_val()[block + 1] as usize
    }

    /// A subtree whose children may be shared among threads.
    fn large_tree(self, root: usize, factor: &mut [f64], offset: usize) -> Result<Vec<f64>, usize> {
        let nodes = self.symbolic.supernodes();
        let children = nodes.children(root);
        let front = self.symbolic.blocks().col_ptr_for_val()[root] as usize - offset;
        let (below, panel) = factor.split_at_mut(front);
        let updates = self.forest(children, below, offset)?;
        let rows = self.symbolic.block_rows(root).len();
        let mut update = self.room.update(rows * rows);
        let mut workspace = self.workspace(root..root + 1);
        let below = children.iter().zip(&updates).map(|(&child, update)| (child, &update[..]));
        self.front(root, panel, below, &mut update[..rows * rows], &mut workspace)?;
        locked(&self.room.updates).extend(updates);
        Ok(update)
    }

    /// Subtrees that one thread goes through.
    fn small_forest(self, roots: &[u32], factor: &mut [f64]) -> Result<Vec<Vec<f64>>, usize> {
        let nodes = self.symbolic.supernodes();
        let Some((&first, &last)) = roots.first().zip(roots.last()) else { return Ok(Vec::new()) };
        let range = nodes.first_below(first as usize)..last as usize + 1;
        let mut workspace = self.workspace(range.clone());
        workspace.stack = self.room.stack();
        let mut rest = factor;
        for block in range {
            let (panel, after) = rest.split_at_mut(self.end_of(block) - self.start_of(block));
            rest = after;
            self.stacked(block, panel, &mut workspace)?;
        }
        // The updates of the roots are what is left on the stack.
        let mut updates = Vec::with_capacity(roots.len());
        let mut start = 0;
        for &root in roots {
            let rows = self.symbolic.block_rows(root as usize).len();
            let mut update = self.room.update(rows * rows);
            update[..rows * rows].copy_from_slice(&workspace.stack[start..start + rows * rows]);
            updates.push(update);
            start += rows * rows;
        }
        locked(&self.room.stacks).push(workspace.stack);
        Ok(updates)
    }

    fn start_of(self, block: usize) -> usize {
        self.symbolic.blocks().col_ptr_for_val()[block] as usize
    }

    fn workspace(self, range: Range<usize>) -> Workspace {
        let widest = range.map(|block| self.symbolic.block_columns(block)).max().unwrap_or(0);
        let params: Spec<LltParams, f64> = default();
        let size = cholesky_in_place_scratch::<f64>(widest, Par::Seq, params);
        Workspace { stack: Vec::new(), top: 0, rows: Vec::new(), memory: MemBuffer::new(size) }
    }

    /// A block whose children's updates are the topmost of the stack, and are replaced by its own.
    fn stacked(
        self,
        block: usize,
        panel: &mut [f64],
        workspace: &mut Workspace,
    ) -> Result<(), usize> {
        let size = |block: usize| self.symbolic.block_rows(block).len().pow(2);
        let children = self.symbolic.supernodes().children(block);
        let taken: usize = children.iter().map(|&child| size(child as usize)).sum();
        let (top, own) = (workspace.top, size(block));
        let bottom = top - taken;
        let mut stack = std::mem::take(&mut workspace.stack);
        if stack.len() < top + own {
            stack.resize((top + own).max(2 * stack.len()), 0.0);
        }
        let (below, update) = stack.split_at_mut(top);
        let update = &mut update[..own];
        let mut rest = &below[bottom..];
        let updates = children.iter().map(|&child| {
            let (update, after) = rest.split_at(size(child as usize));
            rest = after;
            (child, update)
        });
        let result = self.front(block, panel, updates, update, workspace);
        if taken > 0 {
            stack.copy_within(top..top + own, bottom);
        }
        workspace.stack = stack;
        workspace.top = bottom + own;
        result
    }

    /// Adds up the front of a block and eliminates its columns. `panel` becomes the block of the factor; of
    /// `update`, a square that may hold anything, the lower triangle is set.
    fn front<'u>(
        self,
        block: usize,
        panel: &mut [f64],
        updates: impl Iterator<Item = (u32, &'u [f64])>,
        update: &mut [f64],
        workspace: &mut Workspace,
    ) -> Result<(), usize> {
        let columns = self.symbolic.block_columns(block);
        let below = self.symbolic.block_rows(block);
        let rows = columns + below.len();
        // A write first: reading pages that are new gives each of them twice, and stops the other threads.
        panel.fill(0.0);
        self.add_entries(block, panel);
        // The children's parts of F₂₂ are added after −L₂₁ L₂₁ᵀ, which need not be added to zeros then.
        let mut waiting: Vec<(&[f64], Range<usize>)> = Vec::new();
        workspace.rows.clear();
        for (child, values) in updates {
            let start = workspace.rows.len();
            self.place_rows(block, child as usize, &mut workspace.rows);
            let places = &workspace.rows[start..];
            let inside = places.partition_point(|&place| (place as usize) < columns);
            let count = places.len();
            for (j, &column) in places[..inside].iter().enumerate() {
                let target = &mut panel[column as usize * rows..][..rows];
                kernel::scatter(target, &places[j..], &values[j * count + j..(j + 1) * count]);
            }
            if inside < count {
                waiting.push((values, start..start + count));
            }
        }
        let first = self.symbolic.blocks().supernode_begin()[block] as usize;
        eliminate(panel, columns, rows, &mut workspace.memory).map_err(|place| first + place)?;
        let height = below.len();
        if height == 0 {
            return Ok(());
        }
        if columns * height * height < SMALL {
            kernel::negative_square(panel, columns, rows, update);
        } else {
            let (_, left) = view(panel, rows, columns).split_at_row(columns);
            let update = MatMut::from_column_major_slice_mut(update, height, height);
            large::subtract_square(update, left, Accum::Replace);
        }
        for (values, range) in waiting {
            let places = &workspace.rows[range];
            let count = places.len();
            let inside = places.partition_point(|&place| (place as usize) < columns);
            for j in inside..count {
                let column = places[j] as usize - columns;
                let target = &mut update[column * height..][..height];
                kernel::scatter_below(
                    target,
                    &places[j..],
                    &values[j * count + j..(j + 1) * count],
                    columns as u32,
                );
            }
        }
        Ok(())
    }

    /// The entries of A in the columns of a block.
    fn add_entries(self, block: usize, panel: &mut [f64]) {
        let columns = self.symbolic.block_columns(block);
        let below = self.symbolic.block_rows(block);
        let first = self.symbolic.blocks().supernode_begin()[block] as usize;
        let (starts, rows) = self.symbolic.lower_pattern();
        for (j, column) in panel.chunks_exact_mut(columns + below.len()).enumerate() {
            let range = starts[first + j] as usize..starts[first + j + 1] as usize;
            for (&row, &value) in rows[range.clone()].iter().zip(&self.lower[range]) {
                let inside = row as usize - first;
                let place = if inside < columns {
                    inside
                } else {
                    columns + below.partition_point(|&other| other < row)
                };
                column[place] += value;
            }
        }
    }

    /// Appends the rows of the front of `block` that the rows of a child's update are.
    fn place_rows(self, block: usize, child: usize, places: &mut Vec<u32>) {
        let columns = self.symbolic.block_columns(block) as u32;
        let below = self.symbolic.block_rows(block);
        let first = self.symbolic.blocks().supernode_begin()[block];
        let mut next = 0;
        places.extend(self.symbolic.block_rows(child).iter().map(|&row| {
            if row < first + columns {
                return row - first;
            }
            while below[next] < row {
                next += 1;
            }
            columns + next as u32
        }));
    }
}

/// L₁₁ and L₂₁ from F₁₁ and F₂₁.
fn eliminate(
    panel: &mut [f64],
    columns: usize,
    rows: usize,
    memory: &mut MemBuffer,
) -> Result<(), usize> {
    if columns <= NARROW {
        return kernel::eliminate(panel, columns, rows);
    }
    let panel = MatMut::from_column_major_slice_mut(panel, rows, columns);
    if columns * rows * rows > LARGE {
        return large::eliminate(panel, memory);
    }
    let (mut square, below) = panel.split_at_row_mut(columns);
    let params: Spec<LltParams, f64> = default();
    let (regularization, stack) = (LltRegularization::default(), MemStack::new(memory));
    let done = cholesky_in_place(square.as_mut(), regularization, Par::Seq, stack, params);
    if let Err(LltError::NonPositivePivot { index }) = done {
        return Err(index);
    }
    solve_lower_triangular_in_place(square.as_ref(), below.transpose_mut(), Par::Seq);
    Ok(())
}

fn view(panel: &[f64], rows: usize, columns: usize) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(panel, rows, columns)
}
