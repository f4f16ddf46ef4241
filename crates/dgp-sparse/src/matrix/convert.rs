//! Conversions from and to the matrices of faer and, behind the feature `sprs`, of sprs.

use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};

use super::SparseMatrix;
use crate::Error;

impl SparseMatrix {
    /// A view of this matrix for faer.
    pub fn as_faer(&self) -> SparseColMatRef<'_, u32, f64> {
        let (rows, columns) = (self.rows, self.columns());
        let pattern =
            SymbolicSparseColMatRef::new_checked(rows, columns, &self.starts, None, &self.indices);
        SparseColMatRef::new(pattern, &self.values)
    }
}

impl From<SparseMatrix> for SparseColMat<u32, f64> {
    fn from(matrix: SparseMatrix) -> Self {
        let (rows, columns) = (matrix.rows, matrix.columns());
        let pattern =
            SymbolicSparseColMat::new_checked(rows, columns, matrix.starts, None, matrix.indices);
        SparseColMat::new(pattern, matrix.values)
    }
}

impl TryFrom<SparseColMatRef<'_, u32, f64>> for SparseMatrix {
    type Error = Error;

    /// The matrix that faer holds, whose rows must ascend within each column.
    fn try_from(matrix: SparseColMatRef<'_, u32, f64>) -> Result<Self, Error> {
        let mut starts = vec![0_u32];
        let (mut indices, mut values) = (Vec::new(), Vec::new());
        for j in 0..matrix.ncols() {
            let range = matrix.symbolic().col_range(j);
            indices.extend_from_slice(&matrix.symbolic().row_idx()[range.clone()]);
            values.extend_from_slice(&matrix.val()[range]);
            starts.push(indices.len() as u32);
        }
        SparseMatrix::from_columns(matrix.nrows(), starts, indices, values)
    }
}

#[cfg(feature = "sprs")]
impl From<SparseMatrix> for sprs::CsMatI<f64, u32> {
    fn from(matrix: SparseMatrix) -> Self {
        let shape = (matrix.rows, matrix.columns());
        sprs::CsMatI::new_csc(shape, matrix.starts, matrix.indices, matrix.values)
    }
}

#[cfg(feature = "sprs")]
impl TryFrom<sprs::CsMatI<f64, u32>> for SparseMatrix {
    type Error = Error;

    fn try_from(matrix: sprs::CsMatI<f64, u32>) -> Result<Self, Error> {
        let rows = matrix.rows();
        let (starts, indices, values) = matrix.into_csc().into_raw_storage();
        SparseMatrix::from_columns(rows, starts, indices, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faer_gives_back_what_it_got() {
        let triplets = [(0, 0, 1.0), (2, 1, 2.0), (1, 1, 3.0)];
        let matrix = SparseMatrix::from_triplets(3, 2, &triplets).unwrap();
        assert_eq!(SparseMatrix::try_from(matrix.as_faer()), Ok(matrix.clone()));
        let owned = SparseColMat::from(matrix.clone());
        assert_eq!(SparseMatrix::try_from(owned.as_ref()), Ok(matrix));
    }

    #[cfg(feature = "sprs")]
    #[test]
    fn sprs_gives_back_what_it_got() {
        let triplets = [(0, 0, 1.0), (2, 1, 2.0), (1, 1, 3.0)];
        let matrix = SparseMatrix::from_triplets(3, 2, &triplets).unwrap();
        let theirs = sprs::CsMatI::from(matrix.clone());
        assert_eq!(theirs.get(2, 1), Some(&2.0));
        assert_eq!(SparseMatrix::try_from(theirs.to_other_storage()), Ok(matrix));
    }
}
