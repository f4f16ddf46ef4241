//! Matrices from matrices: transposed, scaled, added, multiplied, permuted, cut out.

use super::{MAX_ENTRIES, SparseMatrix, accumulate};
use crate::Error;

impl SparseMatrix {
    /// Aᵀ.
    pub fn transpose(&self) -> SparseMatrix {
        let mut starts = vec![0_u32; self.rows + 1];
        for &i in &self.indices {
            starts[i as usize + 1] += 1;
        }
        accumulate(&mut starts);
        let mut next = starts[..self.rows].to_vec();
        let mut indices = vec![0_u32; self.entries()];
        let mut values = vec![0.0; self.entries()];
        for j in 0..self.columns() {
            let (rows, of_column) = self.column(j);
            for (&i, &value) in rows.iter().zip(of_column) {
                let place = &mut next[i as usize];
                indices[*place as usize] = j as u32;
                values[*place as usize] = value;
                *place += 1;
            }
        }
        SparseMatrix { rows: self.columns(), starts, indices, values }
    }

    /// factor · A.
    pub fn scaled(mut self, factor: f64) -> SparseMatrix {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    /// a A + b B. The pattern is that of both together, also where entries cancel.
    pub fn combine(
        a: f64,
        first: &SparseMatrix,
        b: f64,
        second: &SparseMatrix,
    ) -> Result<SparseMatrix, Error> {
        Error::check_length("the second matrix (rows)", second.rows, first.rows)?;
        Error::check_length("the second matrix (columns)", second.columns(), first.columns())?;
        let count = first.entries() + second.entries();
        let mut starts = Vec::with_capacity(first.starts.len());
        let mut indices = Vec::with_capacity(count.min(MAX_ENTRIES));
        let mut values = Vec::with_capacity(count.min(MAX_ENTRIES));
        starts.push(0);
        for j in 0..first.columns() {
            let (rows, of_first) = first.column(j);
            let (other_rows, of_second) = second.column(j);
            let (mut p, mut q) = (0, 0);
            while p < rows.len() || q < other_rows.len() {
                let row = rows.get(p).copied().unwrap_or(u32::MAX);
                let other = other_rows.get(q).copied().unwrap_or(u32::MAX);
                let mut value = 0.0;
                if row <= other {
                    value += a * of_first[p];
                    p += 1;
                }
                if other <= row {
                    value += b * of_second[q];
                    q += 1;
                }
                indices.push(row.min(other));
                values.push(value);
            }
            starts.push(indices.len() as u32);
        }
        if indices.len() > MAX_ENTRIES {
            let count = indices.len();
            return Err(Error::TooLarge { kind: "entries", count, limit: MAX_ENTRIES });
        }
        Ok(SparseMatrix { rows: first.rows, starts, indices, values })
    }

    /// A + diag(`diagonal`).
    pub fn plus_diagonal(&self, diagonal: &[f64]) -> Result<SparseMatrix, Error> {
        self.check_square()?;
        Error::check_length("the diagonal", diagonal.len(), self.rows)?;
        SparseMatrix::combine(1.0, self, 1.0, &SparseMatrix::from_diagonal(diagonal))
    }

    /// A B. Entries are summed in the order of the columns of A.
    pub fn times(&self, other: &SparseMatrix) -> Result<SparseMatrix, Error> {
        Error::check_length("the second matrix (rows)", other.rows, self.columns())?;
        let mut starts = vec![0_u32];
        let (mut indices, mut values) = (Vec::new(), Vec::new());
        let mut sums = vec![0.0; self.rows];
        let mut last_seen = vec![u32::MAX; self.rows];
        for j in 0..other.columns() {
            let start = indices.len();
            let (middle, factors) = other.column(j);
            for (&k, &factor) in middle.iter().zip(factors) {
                let (rows, of_column) = self.column(k as usize);
                for (&i, &value) in rows.iter().zip(of_column) {
                    if last_seen[i as usize] != j as u32 {
                        last_seen[i as usize] = j as u32;
                        sums[i as usize] = 0.0;
                        indices.push(i);
                    }
                    sums[i as usize] += value * factor;
                }
            }
            if indices.len() > MAX_ENTRIES {
                let count = indices.len();
                return Err(Error::TooLarge { kind: "entries", count, limit: MAX_ENTRIES });
            }
            indices[start..].sort_unstable();
            values.extend(indices[start..].iter().map(|&i| sums[i as usize]));
            starts.push(indices.len() as u32);
        }
        Ok(SparseMatrix { rows: self.rows, starts, indices, values })
    }

    /// Aᵀ diag(`weights`) A, the matrix of weighted normal equations.
    pub fn gram(&self, weights: &[f64]) -> Result<SparseMatrix, Error> {
        Error::check_length("the weights", weights.len(), self.rows)?;
        let mut weighted = self.clone();
        for (value, &row) in weighted.values.iter_mut().zip(&self.indices) {
            *value *= weights[row as usize];
        }
        self.transpose().times(&weighted)
    }

    /// diag(`left`) A diag(`right`).
    pub fn scaled_by(mut self, left: &[f64], right: &[f64]) -> Result<SparseMatrix, Error> {
        Error::check_length("the left factors", left.len(), self.rows)?;
        Error::check_length("the right factors", right.len(), self.columns())?;
        for (j, factor) in right.iter().enumerate() {
            for place in self.starts[j] as usize..self.starts[j + 1] as usize {
                self.values[place] *= left[self.indices[place] as usize] * factor;
            }
        }
        Ok(self)
    }

    /// The entries in `rows` and `columns`, which are named in ascending order and renumbered in it.
    pub fn submatrix(&self, rows: &[u32], columns: &[u32]) -> Result<SparseMatrix, Error> {
        check_selection("the rows", rows, self.rows)?;
        check_selection("the columns", columns, self.columns())?;
        let mut new_row = vec![u32::MAX; self.rows];
        for (new, &old) in rows.iter().enumerate() {
            new_row[old as usize] = new as u32;
        }
        let mut starts = vec![0_u32];
        let (mut indices, mut values) = (Vec::new(), Vec::new());
        for &j in columns {
            let (old_rows, of_column) = self.column(j as usize);
            for (&i, &value) in old_rows.iter().zip(of_column) {
                if new_row[i as usize] != u32::MAX {
                    indices.push(new_row[i as usize]);
                    values.push(value);
                }
            }
            starts.push(indices.len() as u32);
        }
        Ok(SparseMatrix { rows: rows.len(), starts, indices, values })
    }

    /// The matrix with row and column `order[k]` of this one as its row and column `k`.
    pub fn permuted(&self, order: &[u32]) -> Result<SparseMatrix, Error> {
        self.check_square()?;
        let new = crate::order::inverse(order, self.rows)?;
        let triplets: Vec<(u32, u32, f64)> =
            self.triplets().map(|(i, j, value)| (new[i], new[j], value)).collect();
        SparseMatrix::from_triplets(self.rows, self.rows, &triplets)
    }
}

fn check_selection(name: &'static str, selected: &[u32], count: usize) -> Result<(), Error> {
    let ascending = selected.is_sorted_by(|a, b| a < b);
    let inside = selected.last().is_none_or(|&last| (last as usize) < count);
    if ascending && inside { Ok(()) } else { Err(Error::Selection { name, count }) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Up to 8 × 8 with small whole values, so that sums are exact in any order.
    fn small(rows: usize, columns: usize) -> impl Strategy<Value = SparseMatrix> {
        let entry = (0..rows as u32, 0..columns as u32, -4_i8..=4);
        prop::collection::vec(entry, 0..20).prop_map(move |entries| {
            let triplets: Vec<_> =
                entries.into_iter().map(|(i, j, value)| (i, j, f64::from(value))).collect();
            SparseMatrix::from_triplets(rows, columns, &triplets).unwrap()
        })
    }

    fn dense(a: &SparseMatrix) -> Vec<Vec<f64>> {
        (0..a.rows()).map(|i| (0..a.columns()).map(|j| a.get(i, j)).collect()).collect()
    }

    fn is_sound(a: &SparseMatrix) -> bool {
        let parts = (a.starts.clone(), a.indices.clone(), a.values.clone());
        SparseMatrix::from_columns(a.rows, parts.0, parts.1, parts.2).is_ok()
    }

    proptest! {
        #[test]
        fn sums_and_products_equal_the_dense_ones(
            a in small(5, 7), b in small(5, 7), c in small(7, 4), w in prop::collection::vec(0_i8..5, 5)
        ) {
            let sum = SparseMatrix::combine(2.0, &a, -3.0, &b).unwrap();
            let product = a.times(&c).unwrap();
            let weights: Vec<f64> = w.into_iter().map(f64::from).collect();
            let gram = a.gram(&weights).unwrap();
            prop_assert!(is_sound(&sum) && is_sound(&product) && is_sound(&gram));
            let (x, y) = (dense(&a), dense(&b));
            for i in 0..5 {
                for j in 0..7 {
                    prop_assert_eq!(sum.get(i, j), 2.0 * x[i][j] - 3.0 * y[i][j]);
                }
                for j in 0..4 {
                    let expected: f64 = (0..7).map(|k| x[i][k] * c.get(k, j)).sum();
                    prop_assert_eq!(product.get(i, j), expected);
                }
            }
            for i in 0..7 {
                for j in 0..7 {
                    let expected: f64 = (0..5).map(|k| x[k][i] * weights[k] * x[k][j]).sum();
                    prop_assert_eq!(gram.get(i, j), expected);
                }
            }
        }

        #[test]
        fn transposing_twice_is_the_identity(a in small(6, 3)) {
            let transposed = a.transpose();
            prop_assert!(is_sound(&transposed));
            prop_assert!(a.triplets().all(|(i, j, value)| transposed.get(j, i) == value));
            prop_assert_eq!(transposed.transpose(), a);
        }

        #[test]
        fn permuting_moves_rows_and_columns(
            a in small(6, 6), order in Just((0..6_u32).collect::<Vec<_>>()).prop_shuffle()
        ) {
            let permuted = a.permuted(&order).unwrap();
            for i in 0..6 {
                for j in 0..6 {
                    let expected = a.get(order[i] as usize, order[j] as usize);
                    prop_assert_eq!(permuted.get(i, j), expected);
                }
            }
        }
    }

    #[test]
    fn a_submatrix_keeps_what_is_named() {
        let triplets = [(0, 0, 1.0), (1, 2, 2.0), (2, 2, 3.0), (2, 0, 4.0)];
        let a = SparseMatrix::from_triplets(3, 3, &triplets).unwrap();
        let part = a.submatrix(&[1, 2], &[0, 2]).unwrap();
        assert_eq!(dense(&part), [[0.0, 2.0], [4.0, 3.0]]);
        assert!(matches!(a.submatrix(&[2, 1], &[0]), Err(Error::Selection { .. })));
        assert!(matches!(a.submatrix(&[1], &[3]), Err(Error::Selection { count: 3, .. })));
    }

    #[test]
    fn asymmetry_is_named() {
        let symmetric = SparseMatrix::from_edges(3, &[(0, 1, 1.0), (1, 2, 0.1)]).unwrap();
        assert_eq!(symmetric.check_symmetric(), Ok(()));
        let a =
            SparseMatrix::from_triplets(3, 3, &[(0, 1, 1.0), (2, 1, 1.0), (1, 2, 1.0)]).unwrap();
        let error = a.check_symmetric().unwrap_err();
        assert!(matches!(error, Error::NotSymmetric { row: 0, column: 1, .. }), "{error}");
        let a = SparseMatrix::from_triplets(3, 3, &[(0, 0, 1.0), (2, 0, 1.0)]).unwrap();
        let error = a.check_symmetric().unwrap_err();
        assert!(matches!(error, Error::NotSymmetric { row: 2, column: 0, .. }), "{error}");
        let wide = SparseMatrix::zeros(2, 3);
        assert_eq!(wide.check_symmetric(), Err(Error::NotSquare { rows: 2, columns: 3 }));
    }

    #[test]
    fn what_is_not_finite_is_named() {
        let a = SparseMatrix::from_triplets(3, 3, &[(0, 0, 1.0), (2, 1, f64::NAN)]).unwrap();
        let error = a.check_finite().unwrap_err();
        assert!(matches!(error, Error::NotFinite { row: 2, column: 1, .. }));
        let a = SparseMatrix::from_diagonal(&[1.0, f64::INFINITY]);
        assert!(matches!(a.check_finite(), Err(Error::NotFinite { row: 1, column: 1, .. })));
    }
}
