//! A tall dense matrix, and the products that a blocked Gram–Schmidt is made of.
//!
//! Rows are cut into panels of fixed height that do not depend on the number of threads; within a panel
//! columns stand one after the other, so that a panel of few columns stays in the cache while all others
//! stream by. The last panel is filled up with zeros.

use std::ops::Range;

use faer::{
    Accum, Mat, MatMut, MatRef, Par,
    linalg::matmul::{
        matmul,
        triangular::{self, BlockStructure},
    },
};

use crate::parallel;

/// Rows of a panel: eight columns of it are 64 kB.
const HEIGHT: usize = 1024;

/// M in the inner product Aᵀ M B.
#[derive(Clone, Copy)]
pub(super) enum Weight<'a> {
    Identity,
    Diagonal(&'a [f64]),
    /// M B itself.
    Product(&'a Tall),
}

/// A matrix of many rows and up to `capacity` columns, zero at first.
pub(super) struct Tall {
    rows: usize,
    height: usize,
    capacity: usize,
    panels: Vec<f64>,
}

impl Tall {
    pub(super) fn new(rows: usize, capacity: usize) -> Tall {
        let height = HEIGHT.min(rows.next_multiple_of(8)).max(1);
        let panels = vec![0.0; rows.div_ceil(height) * height * capacity];
        Tall { rows, height, capacity, panels }
    }

    pub(super) fn capacity(&self) -> usize {
        self.capacity
    }

    /// Values of a panel.
    fn size(&self) -> usize {
        self.height * self.capacity
    }

    /// Sets columns from `first` on to those that stand one after the other in `columns`.
    pub(super) fn set(&mut self, first: usize, columns: &[f64]) {
        let (rows, height, size) = (self.rows, self.height, self.size());
        parallel::map_chunks(&mut self.panels, size, |start, panel| {
            let row = start / size * height;
            let end = (row + height).min(rows);
            for (target, column) in
                panel[first * height..].chunks_exact_mut(height).zip(columns.chunks_exact(rows))
            {
                target[..end - row].copy_from_slice(&column[row..end]);
            }
        });
    }

    /// The columns of a range, one after the other.
    pub(super) fn columns(&self, range: Range<usize>) -> Vec<f64> {
        let mut columns = vec![0.0; self.rows * range.len()];
        parallel::map_chunks(&mut columns, self.rows, |start, column| {
            let j = range.start + start / self.rows;
            for (part, panel) in
                column.chunks_mut(self.height).zip(self.panels.chunks_exact(self.size()))
            {
                part.copy_from_slice(&panel[j * self.height..][..part.len()]);
            }
        });
        columns
    }

    /// Aᵀ M B for two ranges of columns A and B.
    pub(super) fn project(&self, a: Range<usize>, b: Range<usize>, weight: Weight<'_>) -> Mat<f64> {
        // Bᵀ M A: the left factor is what the kernel copies, and B is the small one.
        let transposed = self.sum_of_panels(b.len(), a.len(), |product, panel, index| {
            let weighted = self.weighted(panel, b.clone(), index, weight);
            let right = view(panel, self.height, a.clone());
            multiply(product, Accum::Replace, weighted.transpose(), right, 1.0);
        });
        transposed.transpose().to_owned()
    }

    /// The largest |Aᵀ M A − I| for all columns A.
    pub(super) fn distance_to_identity(&self, weight: Weight<'_>) -> f64 {
        let width = self.capacity;
        let gram = self.sum_of_panels(width, width, |product, panel, index| {
            let weighted = self.weighted(panel, 0..width, index, weight);
            triangular::matmul(
                product,
                BlockStructure::TriangularLower,
                Accum::Replace,
                view(panel, self.height, 0..width).transpose(),
                BlockStructure::Rectangular,
                weighted.as_ref(),
                BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
        });
        let distance = |i: usize, j: usize| (gram[(i, j)] - f64::from(u8::from(i == j))).abs();
        (0..width).flat_map(|j| (j..width).map(move |i| (i, j))).fold(0.0, |worst, (i, j)| {
            let distance = distance(i, j);
            // Not max(), which would drop NaN.
            if distance <= worst { worst } else { distance }
        })
    }

    /// Σ of what `f` makes of each panel, in their order.
    fn sum_of_panels(
        &self,
        rows: usize,
        columns: usize,
        f: impl Fn(MatMut<'_, f64>, &[f64], usize) + Sync + Send,
    ) -> Mat<f64> {
        let mut indices: Vec<usize> = (0..self.panels.len() / self.size().max(1)).collect();
        let parts = parallel::map_chunks(&mut indices, 1, |index, _| {
            let mut product = Mat::zeros(rows, columns);
            f(product.as_mut(), &self.panels[index * self.size()..][..self.size()], index);
            product
        });
        parts.into_iter().fold(Mat::zeros(rows, columns), |sum, part| sum + part)
    }

    /// A panel of M B.
    fn weighted(
        &self,
        panel: &[f64],
        columns: Range<usize>,
        index: usize,
        weight: Weight<'_>,
    ) -> Mat<f64> {
        let height = self.height;
        match weight {
            Weight::Identity => view(panel, height, columns).to_owned(),
            Weight::Diagonal(masses) => {
                let masses = &masses[index * height..];
                let columns = view(panel, height, columns);
                let mut weighted = Mat::zeros(height, columns.ncols());
                for j in 0..columns.ncols() {
                    let target = weighted.col_as_slice_mut(j);
                    let source = columns.col(j).try_as_col_major().expect("columns are dense");
                    for ((y, x), mass) in target.iter_mut().zip(source.as_slice()).zip(masses) {
                        *y = mass * x;
                    }
                }
                weighted
            }
            Weight::Product(product) => {
                let panel = &product.panels[index * product.size()..];
                view(panel, height, 0..columns.len()).to_owned()
            }
        }
    }

    /// B ← (B − A C) D for columns A and the `width` columns B of this matrix from `first` on.
    pub(super) fn subtract(
        &mut self,
        range: Range<usize>,
        c: MatRef<'_, f64>,
        first: usize,
        d: MatRef<'_, f64>,
    ) {
        let (height, size, width) = (self.height, self.size(), d.nrows());
        let mut cd = Mat::zeros(c.nrows(), width);
        multiply(cd.as_mut(), Accum::Replace, c, d, -1.0);
        parallel::map_chunks(&mut self.panels, size, |_, panel| {
            let (left, right) = panel.split_at_mut(first * height);
            let mut b = view_mut(right, height, width);
            let old = b.to_owned();
            multiply(b.as_mut(), Accum::Replace, old.as_ref(), d, 1.0);
            multiply(b, Accum::Add, view(left, height, range.clone()), cd.as_ref(), 1.0);
        });
    }

    /// The first columns of the range become A S, where A are all its columns.
    pub(super) fn transform(&mut self, range: Range<usize>, s: MatRef<'_, f64>) {
        let (height, size) = (self.height, self.size());
        parallel::map_chunks(&mut self.panels, size, |_, panel| {
            let mut product = Mat::zeros(height, s.ncols());
            multiply(product.as_mut(), Accum::Replace, view(panel, height, range.clone()), s, 1.0);
            view_mut(&mut panel[range.start * height..], height, s.ncols()).copy_from(product);
        });
    }

    /// Copies `count` columns from `from` to `to`.
    pub(super) fn copy_within(&mut self, from: usize, to: usize, count: usize) {
        let (height, size) = (self.height, self.size());
        parallel::map_chunks(&mut self.panels, size, |_, panel| {
            panel.copy_within(from * height..(from + count) * height, to * height);
        });
    }
}

/// C ← α A B, or C + α A B. One thread: parallel products have had wrong results.
pub(super) fn multiply(
    c: MatMut<'_, f64>,
    accum: Accum,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    alpha: f64,
) {
    matmul(c, accum, a, b, alpha, Par::Seq);
}

fn view(panel: &[f64], height: usize, range: Range<usize>) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(
        &panel[range.start * height..range.end * height],
        height,
        range.len(),
    )
}

fn view_mut(values: &mut [f64], height: usize, columns: usize) -> MatMut<'_, f64> {
    MatMut::from_column_major_slice_mut(&mut values[..columns * height], height, columns)
}
