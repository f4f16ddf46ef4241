//! Stencils: refined values as sums of old ones, kept as a sparse matrix.
//!
//! ```text
//! x′(i) = Σ w(i, j) x(j)      Σ w(i, j) = 1 for points, 0 for tangents
//! ```
//!
//! Rows are compressed: 32-bit columns in ascending order, 64-bit weights.
//!
//! - Cost: O(entries) for all but composing, which sorts each row.
//! - Guarantees: the same bits for any number of threads.

use std::io;

use dgp_mesh::{AttributeTable, VertexId, parallel};

use crate::{
    Error,
    masks::{Masks, Stencil, Value, merge, spell_out},
};

/// A sparse matrix whose rows make new values from old ones.
///
/// ```
/// use dgp_mesh::{DVec3, Progress, shapes};
/// use dgp_subdiv::{RefinementOptions, RefinementPlan, Sharpness};
///
/// let cube = shapes::cube();
/// let options = RefinementOptions { levels: 2, ..RefinementOptions::default() };
/// let plan = RefinementPlan::new(&cube, &Sharpness::new(), &options, Progress::NONE)?;
/// let stencils = plan.stencils()?;
/// assert_eq!((stencils.rows(), stencils.columns()), (98, 8));
/// let refined: Vec<DVec3> = stencils.apply(cube.positions().values())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct StencilTable {
    columns: usize,
    /// Row i is at `[i]..[i + 1]`.
    starts: Vec<u32>,
    indices: Vec<u32>,
    weights: Vec<f64>,
}

impl StencilTable {
    /// The rows of a step, spelled out.
    pub(crate) fn from_masks(masks: &dyn Masks) -> Result<Self, Error> {
        let topology = masks.topology();
        StencilTable::from_rows(topology.vertex_count(), masks.rows(), |row, stencil| {
            masks.row(row, stencil);
            spell_out(topology, &mut stencil.entries);
        })
    }

    /// The table that changes nothing.
    pub(crate) fn identity(size: usize) -> Self {
        StencilTable {
            columns: size,
            starts: (0..=size as u32).collect(),
            indices: (0..size as u32).collect(),
            weights: vec![1.0; size],
        }
    }

    /// The table whose row i is what `write` writes, which must be sorted.
    pub(crate) fn from_rows(
        columns: usize,
        rows: usize,
        write: impl Fn(usize, &mut Stencil) + Sync + Send,
    ) -> Result<Self, Error> {
        let blocks = parallel::map_blocks(rows, parallel::BLOCK, |range| {
            let (mut lengths, mut indices, mut weights) = (Vec::new(), Vec::new(), Vec::new());
            let mut stencil = Stencil::default();
            for row in range {
                stencil.entries.clear();
                write(row, &mut stencil);
                lengths.push(stencil.entries.len() as u32);
                indices.extend(stencil.entries.iter().map(|entry| entry.0));
                weights.extend(stencil.entries.iter().map(|entry| entry.1));
            }
            (lengths, indices, weights)
        });
        let entries: usize = blocks.iter().map(|(_, indices, _)| indices.len()).sum();
        if entries > u32::MAX as usize {
            return Err(Error::TooManyEntries { entries: entries as u64 });
        }
        let mut table = StencilTable {
            columns,
            starts: Vec::with_capacity(rows + 1),
            indices: Vec::with_capacity(entries),
            weights: Vec::with_capacity(entries),
        };
        table.starts.push(0);
        let mut end = 0;
        for (lengths, indices, weights) in blocks {
            table.starts.extend(lengths.into_iter().map(|length| {
                end += length;
                end
            }));
            table.indices.extend(indices);
            table.weights.extend(weights);
        }
        Ok(table)
    }

    /// How many new values there are.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many old values are taken.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many weights are stored.
    pub fn entries(&self) -> usize {
        self.indices.len()
    }

    /// The columns of a row, in ascending order, and their weights.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        (&self.indices[range.clone()], &self.weights[range])
    }

    /// The new values, given one old value per column. Error: [`Error::WrongLength`].
    pub fn apply<T: Value>(&self, values: &[T]) -> Result<Vec<T>, Error> {
        let mut new = vec![T::default(); self.rows()];
        self.apply_into(values, &mut new)?;
        Ok(new)
    }

    /// As [`apply`](Self::apply), into room that is there. Error: [`Error::WrongLength`].
    pub fn apply_into<T: Value>(&self, values: &[T], new: &mut [T]) -> Result<(), Error> {
        check_length("column of the table", values.len(), self.columns)?;
        check_length("row of the table", new.len(), self.rows())?;
        parallel::for_each_chunk(new, parallel::BLOCK, |first, chunk| {
            for (row, value) in (first..).zip(chunk) {
                let (indices, weights) = self.row(row);
                let mut sum = T::default();
                for (&column, &weight) in indices.iter().zip(weights) {
                    sum = sum + values[column as usize] * weight;
                }
                *value = sum;
            }
        });
        Ok(())
    }

    /// The data of the new vertices, each mixed as its type has it. Error: [`Error::WrongLength`].
    pub fn apply_attributes(
        &self,
        table: &AttributeTable<VertexId>,
    ) -> Result<AttributeTable<VertexId>, Error> {
        check_length("column of the table", table.len(), self.columns)?;
        if table.is_empty() {
            return Ok(AttributeTable::new(self.rows()));
        }
        // New values behind the old ones, which all rows read.
        let mut both = table.clone();
        both.resize(self.columns + self.rows());
        let mut parts = Vec::new();
        for row in 0..self.rows() {
            let (indices, weights) = self.row(row);
            parts.clear();
            let ids = indices.iter().map(|&column| VertexId::new(column as usize));
            parts.extend(weights.iter().copied().zip(ids));
            both.mix(VertexId::new(self.columns + row), &parts);
        }
        Ok(both.gather(self.rows(), |v: VertexId| Some(VertexId::new(self.columns + v.index()))))
    }

    /// The table that does `first` and then this one. Errors: [`Error::WrongLength`],
    /// [`Error::TooManyEntries`].
    pub fn compose(&self, first: &StencilTable) -> Result<StencilTable, Error> {
        check_length("column of the outer table", first.rows(), self.columns)?;
        StencilTable::from_rows(first.columns, self.rows(), |row, stencil| {
            let (indices, weights) = self.row(row);
            for (&middle, &weight) in indices.iter().zip(weights) {
                let (indices, weights) = first.row(middle as usize);
                let parts = indices.iter().zip(weights);
                stencil.entries.extend(parts.map(|(&column, &w)| (column, weight * w)));
            }
            merge(&mut stencil.entries);
        })
    }

    /// The transposed matrix: what each old value adds to the new ones, as least squares and forces need.
    pub fn transposed(&self) -> StencilTable {
        let mut starts = vec![0_u32; self.columns + 1];
        for &column in &self.indices {
            starts[column as usize + 1] += 1;
        }
        for column in 0..self.columns {
            starts[column + 1] += starts[column];
        }
        let mut next = starts.clone();
        let mut indices = vec![0; self.entries()];
        let mut weights = vec![0.0; self.entries()];
        for row in 0..self.rows() {
            let (columns, row_weights) = self.row(row);
            for (&column, &weight) in columns.iter().zip(row_weights) {
                let place = next[column as usize] as usize;
                next[column as usize] += 1;
                indices[place] = row as u32;
                weights[place] = weight;
            }
        }
        StencilTable { columns: self.rows(), starts, indices, weights }
    }

    /// Writes the matrix as Matrix Market text, general and real; weights read back bit for bit.
    pub fn write_matrix_market(&self, mut to: impl io::Write) -> io::Result<()> {
        writeln!(to, "%%MatrixMarket matrix coordinate real general")?;
        writeln!(to, "{} {} {}", self.rows(), self.columns, self.entries())?;
        for row in 0..self.rows() {
            let (indices, weights) = self.row(row);
            for (&column, &weight) in indices.iter().zip(weights) {
                writeln!(to, "{} {} {weight:?}", row + 1, column + 1)?;
            }
        }
        to.flush()
    }
}

pub(crate) fn check_length(what: &'static str, given: usize, expected: usize) -> Result<(), Error> {
    if given == expected { Ok(()) } else { Err(Error::WrongLength { what, given, expected }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: usize, rows: &[&[(u32, f64)]]) -> StencilTable {
        StencilTable::from_rows(columns, rows.len(), |row, stencil| {
            stencil.entries.extend_from_slice(rows[row]);
        })
        .unwrap()
    }

    #[test]
    fn composed_tables_do_one_after_the_other() {
        let first = table(2, &[&[(0, 1.0)], &[(0, 0.5), (1, 0.5)], &[(1, 1.0)]]);
        let second = table(3, &[&[(0, 0.25), (1, 0.75)], &[(1, -1.0), (2, 2.0)]]);
        let both = second.compose(&first).unwrap();
        assert_eq!(both, table(2, &[&[(0, 0.625), (1, 0.375)], &[(0, -0.5), (1, 1.5)]]));
        assert!(matches!(second.compose(&second), Err(Error::WrongLength { given: 2, .. })));
    }

    #[test]
    fn transposing_twice_changes_nothing() {
        let matrix = table(4, &[&[(1, 0.25), (3, 0.75)], &[], &[(0, -1.0), (1, 2.0)]]);
        assert_eq!(matrix.transposed().row(1), (&[0, 2][..], &[0.25, 2.0][..]));
        assert_eq!(matrix.transposed().transposed(), matrix);
    }

    #[test]
    fn matrices_are_written_row_by_row() {
        let matrix = table(4, &[&[(1, 0.1), (3, 0.75)], &[(0, -1.0)]]);
        let mut text = Vec::new();
        matrix.write_matrix_market(&mut text).unwrap();
        let expected =
            "%%MatrixMarket matrix coordinate real general\n2 4 3\n1 2 0.1\n1 4 0.75\n2 1 -1.0\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn data_are_mixed_from_old_values_only() {
        let matrix = table(2, &[&[(1, 1.0)], &[(0, 0.5), (1, 0.5)]]);
        let mut data = AttributeTable::new(2);
        data.insert("x", vec![1.0, 3.0]);
        data.insert("kind", vec![7_u8, 9]);
        let new = matrix.apply_attributes(&data).unwrap();
        assert_eq!(new.get::<f64>("x").unwrap().values(), [3.0, 2.0]);
        assert_eq!(new.get::<u8>("kind").unwrap().values(), [9, 7]);
    }
}
