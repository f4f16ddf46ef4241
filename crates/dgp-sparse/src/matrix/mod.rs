//! Sparse matrices: columns of (row, value), sorted, one after the other.

mod assemble;
mod combine;
mod convert;
mod product;

use std::fmt;

pub(crate) use assemble::accumulate;

use crate::Error;

/// The most rows, columns or stored entries of a matrix: 2³¹ − 1.
pub const MAX_ENTRIES: usize = i32::MAX as usize;

/// A matrix that stores only some of its entries, by columns.
///
/// Within a column rows ascend and none occurs twice. A stored entry may be zero; it belongs to the
/// pattern, so that matrices with other values can reuse what was found out about it.
///
/// ```
/// use dgp_sparse::SparseMatrix;
///
/// let a = SparseMatrix::from_triplets(2, 3, &[(0, 2, 5.0), (1, 0, 1.0), (0, 2, 2.0)])?;
/// assert_eq!(a.get(0, 2), 7.0);
/// assert_eq!(a.product(&[1.0, 1.0, 1.0]), [7.0, 1.0]);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct SparseMatrix {
    rows: usize,
    /// Where each column starts in `indices` and `values`, and one end.
    starts: Vec<u32>,
    /// The row of each entry.
    indices: Vec<u32>,
    values: Vec<f64>,
}

/// Size and entries.
impl SparseMatrix {
    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The number of columns.
    pub fn columns(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of stored entries.
    pub fn entries(&self) -> usize {
        self.indices.len()
    }

    /// Rows and values of the stored entries of column `j`, in ascending order of rows.
    pub fn column(&self, j: usize) -> (&[u32], &[f64]) {
        let range = self.starts[j] as usize..self.starts[j + 1] as usize;
        (&self.indices[range.clone()], &self.values[range])
    }

    /// The entry in row `i`, column `j`: 0 where none is stored.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        assert!(i < self.rows, "row {i} of {}", self.rows);
        let (rows, values) = self.column(j);
        rows.binary_search(&(i as u32)).map_or(0.0, |place| values[place])
    }

    /// Row, column and value of each stored entry, column by column.
    pub fn triplets(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.columns()).flat_map(|j| {
            let (rows, values) = self.column(j);
            rows.iter().zip(values).map(move |(&i, &value)| (i as usize, j, value))
        })
    }

    /// The diagonal, as long as the shorter side.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.rows.min(self.columns())).map(|i| self.get(i, i)).collect()
    }

    /// Where each column starts in [`indices`](Self::indices) and [`values`](Self::values), and one end.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The rows of all entries, column by column.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// The values of all entries, column by column.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values of all entries, to be changed in place.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Whether `other` stores entries in the same places.
    pub fn has_pattern_of(&self, other: &SparseMatrix) -> bool {
        self.rows == other.rows && self.starts == other.starts && self.indices == other.indices
    }

    /// Σ |entry| of the row where it is largest.
    pub fn row_norm(&self) -> f64 {
        let mut sums = vec![0.0; self.rows];
        for (&i, value) in self.indices.iter().zip(&self.values) {
            sums[i as usize] += value.abs();
        }
        sums.into_iter().fold(0.0, f64::max)
    }
}

/// Checks.
impl SparseMatrix {
    /// An error unless there are as many rows as columns.
    pub fn check_square(&self) -> Result<(), Error> {
        let (rows, columns) = (self.rows, self.columns());
        if rows == columns { Ok(()) } else { Err(Error::NotSquare { rows, columns }) }
    }

    /// An error that names the first entry that is infinite or not a number, if there is one.
    pub fn check_finite(&self) -> Result<(), Error> {
        // Summing zeros is faster than a test of each entry: 0·∞ and 0·NaN are NaN.
        if self.values.iter().map(|value| 0.0 * value).sum::<f64>() == 0.0 {
            return Ok(());
        }
        let place = self.values.iter().position(|value| !value.is_finite());
        let place = place.expect("else the sum were zero");
        let column = self.starts.partition_point(|&start| start as usize <= place) - 1;
        let row = self.indices[place] as usize;
        Err(Error::NotFinite { row, column, value: self.values[place] })
    }

    /// An error that names an entry that differs from its mirror image by more than rounding: by
    /// 10⁻¹² of the geometric mean of their diagonal entries, or of the larger of the two where that
    /// is more. Where an entry is stored its mirror image must be, too.
    pub fn check_symmetric(&self) -> Result<(), Error> {
        self.check_square()?;
        // Columns are read in order; so the mirror images of what is above the diagonal, which stand in
        // column i below it, come in the order in which they stand there.
        let below = |j: usize| {
            let (rows, _) = self.column(j);
            self.starts[j] + rows.partition_point(|&i| i as usize <= j) as u32
        };
        let mut next: Vec<u32> = (0..self.columns()).map(below).collect();
        for j in 0..self.columns() {
            let (rows, values) = self.column(j);
            for (&i, &value) in rows.iter().zip(values).take_while(|&(&i, _)| (i as usize) < j) {
                let place = next[i as usize] as usize;
                let expected = place < self.starts[i as usize + 1] as usize
                    && self.indices[place] as usize == j;
                if !expected {
                    return Err(self.asymmetry(i as usize, j));
                }
                if value != self.values[place] {
                    self.check_mirrored(i as usize, j, value, self.values[place])?;
                }
                next[i as usize] += 1;
            }
        }
        let lonely = (0..self.columns()).find(|&j| next[j] < self.starts[j + 1]);
        lonely.map_or(Ok(()), |j| Err(self.asymmetry(self.indices[next[j] as usize] as usize, j)))
    }

    fn check_mirrored(&self, i: usize, j: usize, value: f64, mirrored: f64) -> Result<(), Error> {
        let size = value.abs().max(mirrored.abs());
        let scale = (self.get(i, i).abs().sqrt() * self.get(j, j).abs().sqrt()).max(size);
        if (value - mirrored).abs() <= 1e-12 * scale { Ok(()) } else { Err(self.asymmetry(i, j)) }
    }

    fn asymmetry(&self, row: usize, column: usize) -> Error {
        let (value, mirrored) = (self.get(row, column), self.get(column, row));
        if !value.is_finite() {
            return Error::NotFinite { row, column, value };
        }
        if !mirrored.is_finite() {
            return Error::NotFinite { row: column, column: row, value: mirrored };
        }
        Error::NotSymmetric { row, column, value, mirrored }
    }
}

impl fmt::Debug for SparseMatrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} × {}, {} entries", self.rows, self.columns(), self.entries())?;
        if self.entries() <= 100 {
            f.write_str(": ")?;
            f.debug_list().entries(self.triplets()).finish()?;
        }
        Ok(())
    }
}
