//! Assembly: from entries in any order to sorted columns, in linear time.
//!
//! Entries are distributed by row and then by column, each time keeping their order (counting sort).
//! After that each column is sorted, and entries of one place stand side by side in the order in
//! which they were given, in which they are summed: the same bits each time.
//!
//! - Input: triplets (row, column, value), or edges (i, j, weight).
//! - Cost: O(rows + columns + entries) time and memory.
//! - Reference: Gustavson, "Two fast algorithms for sparse matrices", 1978.

use super::{MAX_ENTRIES, SparseMatrix};
use crate::Error;

impl SparseMatrix {
    /// The matrix with `triplets` (row, column, value); what stands in one place is summed in the
    /// order in which it is given.
    pub fn from_triplets(
        rows: usize,
        columns: usize,
        triplets: &[(u32, u32, f64)],
    ) -> Result<SparseMatrix, Error> {
        check_size(rows, columns, triplets.len())?;
        for (entry, &(row, column, _)) in triplets.iter().enumerate() {
            let (row, column) = (row as usize, column as usize);
            if row >= rows || column >= columns {
                return Err(Error::OutOfRange { entry, row, column, rows, columns });
            }
        }
        // By rows: columns and values of each row, in the order given.
        let mut row_starts = vec![0_u32; rows + 1];
        for &(row, ..) in triplets {
            row_starts[row as usize + 1] += 1;
        }
        accumulate(&mut row_starts);
        let mut by_row = vec![(0_u32, 0.0); triplets.len()];
        let mut next = row_starts.clone();
        for &(row, column, value) in triplets {
            let place = &mut next[row as usize];
            by_row[*place as usize] = (column, value);
            *place += 1;
        }
        Ok(columns_of(rows, columns, &row_starts, &by_row))
    }

    /// The Laplacian of a graph with `n` vertices and weighted `edges` (i, j, w).
    ///
    /// ```text
    /// (L x)ᵢ = Σ w (xᵢ − xⱼ) over the edges at i
    /// ```
    ///
    /// Symmetric, its rows sum to zero, and positive semidefinite where no weight is negative.
    /// Weights of an edge given twice are added; an edge from a vertex to itself counts nothing.
    /// Each diagonal entry is stored, also that of a vertex without edges.
    pub fn from_edges(n: usize, edges: &[(u32, u32, f64)]) -> Result<SparseMatrix, Error> {
        let entries = n.saturating_add(edges.len().saturating_mul(2));
        check_size(n, n, entries)?;
        let mut starts = vec![1_u32; n + 1];
        starts[0] = 0;
        for (entry, &(i, j, _)) in edges.iter().enumerate() {
            let (row, column) = (i as usize, j as usize);
            if row >= n || column >= n {
                return Err(Error::OutOfRange { entry, row, column, rows: n, columns: n });
            }
            starts[row + 1] += 1;
            starts[column + 1] += 1;
        }
        accumulate(&mut starts);
        // Each row starts with its diagonal, which gathers the weights.
        let mut by_row = vec![(0_u32, 0.0); entries];
        let mut next = starts[..n].to_vec();
        for (i, place) in next.iter_mut().enumerate() {
            by_row[*place as usize] = (i as u32, 0.0);
            *place += 1;
        }
        for &(i, j, weight) in edges {
            let weight = if i == j { 0.0 } else { weight };
            for (i, j) in [(i, j), (j, i)] {
                let place = &mut next[i as usize];
                by_row[*place as usize] = (j, -weight);
                by_row[starts[i as usize] as usize].1 += weight;
                *place += 1;
            }
        }
        Ok(columns_of(n, n, &starts, &by_row))
    }

    /// The matrix with these compressed columns: column `j` has the rows
    /// `indices[starts[j]..starts[j + 1]]`, ascending and each once, and the values in the same places.
    pub fn from_columns(
        rows: usize,
        starts: Vec<u32>,
        indices: Vec<u32>,
        values: Vec<f64>,
    ) -> Result<SparseMatrix, Error> {
        let columns = starts.len().saturating_sub(1);
        check_size(rows, columns, indices.len())?;
        Error::check_length("values", values.len(), indices.len())?;
        let end = starts.last().map_or(0, |&end| end as usize);
        Error::check_length("indices", indices.len(), end)?;
        if starts.first() != Some(&0) {
            return Err(Error::Unsorted { column: 0 });
        }
        for column in 0..columns {
            let (start, end) = (starts[column] as usize, starts[column + 1] as usize);
            let Some(of_column) = indices.get(start..end) else {
                return Err(Error::Unsorted { column });
            };
            if !of_column.is_sorted_by(|a, b| a < b) {
                return Err(Error::Unsorted { column });
            }
            if let Some(&row) = of_column.last().filter(|&&row| row as usize >= rows) {
                let row = row as usize;
                return Err(Error::OutOfRange { entry: end - 1, row, column, rows, columns });
            }
        }
        Ok(SparseMatrix { rows, starts, indices, values })
    }

    /// The matrix with `values` on its diagonal.
    pub fn from_diagonal(values: &[f64]) -> SparseMatrix {
        let n = values.len();
        assert!(n <= MAX_ENTRIES, "{n} entries are more than {MAX_ENTRIES}");
        let starts = (0..=n as u32).collect();
        let indices = (0..n as u32).collect();
        SparseMatrix { rows: n, starts, indices, values: values.to_vec() }
    }

    /// The identity.
    pub fn identity(n: usize) -> SparseMatrix {
        SparseMatrix::from_diagonal(&vec![1.0; n])
    }

    /// The matrix without entries.
    pub fn zeros(rows: usize, columns: usize) -> SparseMatrix {
        let starts = vec![0; columns + 1];
        SparseMatrix { rows, starts, indices: Vec::new(), values: Vec::new() }
    }
}

/// An error unless all can be counted.
pub(super) fn check_size(rows: usize, columns: usize, entries: usize) -> Result<(), Error> {
    for (kind, count) in [("rows", rows), ("columns", columns), ("entries", entries)] {
        if count > MAX_ENTRIES {
            return Err(Error::TooLarge { kind, count, limit: MAX_ENTRIES });
        }
    }
    Ok(())
}

/// From how many each has to where each starts.
pub(crate) fn accumulate(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
    }
}

/// Second pass of the sort: rows of (column, value) to columns, what stands in one place summed.
fn columns_of(
    rows: usize,
    columns: usize,
    row_starts: &[u32],
    by_row: &[(u32, f64)],
) -> SparseMatrix {
    let mut starts = vec![0_u32; columns + 1];
    for &(column, _) in by_row {
        starts[column as usize + 1] += 1;
    }
    accumulate(&mut starts);
    let mut next = starts[..columns].to_vec();
    let mut indices = vec![0_u32; by_row.len()];
    let mut values = vec![0.0; by_row.len()];
    for row in 0..rows {
        for &(column, value) in &by_row[row_starts[row] as usize..row_starts[row + 1] as usize] {
            let column = column as usize;
            let end = next[column] as usize;
            // Rows come in ascending order, so an entry of the same place is the one before.
            if end > starts[column] as usize && indices[end - 1] == row as u32 {
                values[end - 1] += value;
            } else {
                indices[end] = row as u32;
                values[end] = value;
                next[column] += 1;
            }
        }
    }
    close_gaps(&mut starts, &next, &mut indices, &mut values);
    SparseMatrix { rows, starts, indices, values }
}

/// Moves columns that end before the next one starts together.
fn close_gaps(starts: &mut [u32], ends: &[u32], indices: &mut Vec<u32>, values: &mut Vec<f64>) {
    let mut end = 0;
    for (column, &column_end) in ends.iter().enumerate() {
        let range = starts[column] as usize..column_end as usize;
        starts[column] = end as u32;
        let length = range.len();
        if range.start != end {
            indices.copy_within(range.clone(), end);
            values.copy_within(range, end);
        }
        end += length;
    }
    if let Some(last) = starts.last_mut() {
        *last = end as u32;
    }
    indices.truncate(end);
    values.truncate(end);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_one_place_are_summed_in_the_order_given() {
        let a = SparseMatrix::from_triplets(
            3,
            2,
            &[(2, 1, 1e16), (0, 0, 1.0), (2, 1, 1.0), (2, 1, -1e16), (1, 1, 4.0)],
        )
        .unwrap();
        let places: Vec<_> = a.triplets().collect();
        assert_eq!(places, [(0, 0, 1.0), (1, 1, 4.0), (2, 1, 1e16 + 1.0 - 1e16)]);
    }

    #[test]
    fn the_laplacian_of_a_triangle_with_a_doubled_edge_and_a_loop() {
        let edges = [(0, 1, 1.0), (1, 2, 2.0), (2, 0, 3.0), (1, 0, 4.0), (1, 1, 100.0)];
        let l = SparseMatrix::from_edges(4, &edges).unwrap();
        let dense: Vec<Vec<f64>> = (0..4).map(|i| (0..4).map(|j| l.get(i, j)).collect()).collect();
        assert_eq!(
            dense,
            [[8.0, -5.0, -3.0, 0.0], [-5.0, 7.0, -2.0, 0.0], [-3.0, -2.0, 5.0, 0.0], [0.0; 4]]
        );
        assert_eq!(l.column(3), (&[3][..], &[0.0][..]), "the diagonal is stored");
    }

    #[test]
    fn what_lies_outside_is_named() {
        let error = SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 2, 1.0)]).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { entry: 1, row: 1, column: 2, .. }));
        let error = SparseMatrix::from_edges(2, &[(0, 7, 1.0)]).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { entry: 0, row: 0, column: 7, .. }));
    }

    #[test]
    fn columns_must_be_sorted() {
        let build = |starts: &[u32], indices: &[u32]| {
            let values = vec![1.0; indices.len()];
            SparseMatrix::from_columns(3, starts.to_vec(), indices.to_vec(), values)
        };
        assert!(build(&[0, 2, 3], &[0, 2, 1]).is_ok());
        assert_eq!(build(&[0, 2, 3], &[2, 0, 1]), Err(Error::Unsorted { column: 0 }));
        assert_eq!(build(&[0, 1, 3], &[0, 1, 1]), Err(Error::Unsorted { column: 1 }));
        assert_eq!(build(&[0, 3, 2, 3], &[0, 1, 2]), Err(Error::Unsorted { column: 1 }));
        assert!(matches!(build(&[0, 1], &[3]), Err(Error::OutOfRange { row: 3, .. })));
        assert_eq!(build(&[], &[]), Err(Error::Unsorted { column: 0 }));
    }

    #[test]
    fn matrices_without_rows_or_entries_are_matrices() {
        let none = SparseMatrix::from_triplets(0, 0, &[]).unwrap();
        assert_eq!((none.rows(), none.columns(), none.entries()), (0, 0, 0));
        assert_eq!(SparseMatrix::from_edges(0, &[]).unwrap(), none);
        assert_eq!(SparseMatrix::zeros(2, 3).product(&[1.0; 3]), [0.0; 2]);
    }
}
