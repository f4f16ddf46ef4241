//! Products with vectors and with several vectors at once.

use super::SparseMatrix;
use crate::parallel;

/// The fewest columns that are worth a task of their own.
const BLOCK: usize = 8192;

impl SparseMatrix {
    /// A x, where `x` has an entry per column.
    ///
    /// For a symmetric matrix [`transpose_product`](Self::transpose_product) is the same and uses
    /// threads.
    pub fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.rows];
        self.add_product(1.0, x, &mut y);
        y
    }

    /// y ← y + factor · A x.
    pub fn add_product(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        assert_eq!(x.len(), self.columns(), "an entry of x for each column");
        assert_eq!(y.len(), self.rows, "an entry of y for each row");
        for (j, &x) in x.iter().enumerate() {
            let (rows, values) = self.column(j);
            let x = factor * x;
            for (&i, &value) in rows.iter().zip(values) {
                y[i as usize] += value * x;
            }
        }
    }

    /// Aᵀ x, where `x` has an entry per row.
    pub fn transpose_product(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.columns()];
        self.transpose_product_into(x, &mut y);
        y
    }

    /// y ← Aᵀ x.
    pub fn transpose_product_into(&self, x: &[f64], y: &mut [f64]) {
        assert_eq!(x.len(), self.rows, "an entry of x for each row");
        assert_eq!(y.len(), self.columns(), "an entry of y for each column");
        parallel::map_chunks(y, BLOCK, |first, y| {
            for (j, y) in (first..).zip(y) {
                let (rows, values) = self.column(j);
                *y = rows.iter().zip(values).map(|(&i, &value)| value * x[i as usize]).sum();
            }
        });
    }

    /// A X, where the columns of X stand one after the other in `x`, and those of the result likewise.
    pub fn product_many(&self, x: &[f64]) -> Vec<f64> {
        many(x, self.columns(), self.rows, |x, y| self.add_product(1.0, x, y))
    }

    /// Aᵀ X, where the columns of X stand one after the other in `x`, and those of the result likewise.
    pub fn transpose_product_many(&self, x: &[f64]) -> Vec<f64> {
        many(x, self.rows, self.columns(), |x, y| self.transpose_product_into(x, y))
    }

    /// xᵀ A y.
    pub fn bilinear(&self, x: &[f64], y: &[f64]) -> f64 {
        assert_eq!(x.len(), self.rows, "an entry of x for each row");
        assert_eq!(y.len(), self.columns(), "an entry of y for each column");
        parallel::sum(self.columns(), |columns| {
            let of_column = |j: usize| {
                let (rows, values) = self.column(j);
                let sum = rows.iter().zip(values).map(|(&i, &value)| value * x[i as usize]);
                y[j] * sum.sum::<f64>()
            };
            columns.map(of_column).sum()
        })
    }
}

/// `multiply` on each of the columns of `length` that stand one after the other in `x`.
fn many(
    x: &[f64],
    length: usize,
    result: usize,
    multiply: impl Fn(&[f64], &mut [f64]) + Sync + Send,
) -> Vec<f64> {
    let count = x.len().checked_div(length).unwrap_or(0);
    assert_eq!(x.len(), count * length, "whole columns");
    let mut y = vec![0.0; count * result];
    parallel::map_chunks(&mut y, result, |first, y| {
        let column = first / result.max(1);
        multiply(&x[column * length..(column + 1) * length], y);
    });
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> SparseMatrix {
        let triplets = [(0, 0, 1.0), (1, 0, 2.0), (1, 2, 3.0), (0, 1, -4.0)];
        SparseMatrix::from_triplets(2, 3, &triplets).unwrap()
    }

    #[test]
    fn products_equal_those_by_hand() {
        let a = example();
        assert_eq!(a.product(&[1.0, 10.0, 100.0]), [-39.0, 302.0]);
        assert_eq!(a.transpose_product(&[1.0, 10.0]), [21.0, -4.0, 30.0]);
        assert_eq!(a.product_many(&[1.0, 10.0, 100.0, 0.0, 0.0, 1.0]), [-39.0, 302.0, 0.0, 3.0]);
        assert_eq!(
            a.transpose_product_many(&[1.0, 10.0, 0.0, 1.0]),
            [21.0, -4.0, 30.0, 2.0, 0.0, 3.0]
        );
        assert_eq!(a.bilinear(&[1.0, 10.0], &[1.0, 10.0, 100.0]), -39.0 + 3020.0);
    }

    #[test]
    fn products_have_the_same_bits_for_any_number_of_threads() {
        let n = 100_000;
        let edges: Vec<_> = (1..n).map(|i| (i - 1, i, 1.0 / f64::from(i))).collect();
        let l = SparseMatrix::from_edges(n as usize, &edges).unwrap();
        let x: Vec<f64> = (0..n).map(|i| f64::from(i).sin()).collect();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| (l.transpose_product(&x), l.bilinear(&x, &x)))
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(8));
        let symmetric = l.product(&x);
        assert!(one.0.iter().zip(&symmetric).all(|(a, b)| (a - b).abs() < 1e-15));
    }
}
