//! How many eigenvalues of a symmetric matrix are negative, by Sylvester's law of inertia.

use faer::{
    Par, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::cholesky::ldlt::factor::{LdltParams, LdltRegularization},
    prelude::default,
    sparse::{
        SparseColMatRef, SymbolicSparseColMatRef,
        linalg::cholesky::supernodal::{
            factorize_supernodal_numeric_ldlt, factorize_supernodal_numeric_ldlt_scratch,
        },
    },
};

use super::SymbolicCholesky;
use crate::SparseMatrix;

/// How often the largest entry of the matrix a pivot may be. Rounding errors grow as pivots do; beyond
/// this their signs are not to be trusted.
const GROWTH: f64 = 1e8;

impl SymbolicCholesky {
    /// The number of negative pivots of L D Lᵀ = `matrix`, which is that of its negative eigenvalues.
    ///
    /// Pivots are not exchanged. `None` where one is zero, or others have grown so that their signs are
    /// not certain: the matrix is then nearly singular, or one of its leading blocks is.
    pub(crate) fn negative_eigenvalues(&self, matrix: &SparseMatrix) -> Option<usize> {
        let n = self.rows();
        if n == 0 {
            return Some(0);
        }
        self.check_pattern(matrix).ok()?;
        let lower = self.lower_values(matrix, 1.0);
        let (starts, rows) = self.lower_pattern();
        let pattern = SymbolicSparseColMatRef::new_unsorted_checked(n, n, starts, None, rows);
        let blocks = self.blocks();
        let params: Spec<LdltParams, f64> = default();
        let size = factorize_supernodal_numeric_ldlt_scratch::<u32, f64>(blocks, Par::Seq, params);
        let mut memory = MemBuffer::new(size);
        let mut factor = vec![0.0; blocks.len_val()];
        factorize_supernodal_numeric_ldlt(
            &mut factor,
            SparseColMatRef::new(pattern, &lower),
            LdltRegularization::default(),
            blocks,
            Par::Seq,
            MemStack::new(&mut memory),
            params,
        )
        .ok()?;
        let largest = lower.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let mut negative = 0;
        for block in 0..blocks.n_supernodes() {
            let (_, columns, rows, values) = self.block(&factor, block);
            for j in 0..columns {
                let pivot = values[j * (rows + 1)];
                let certain = pivot.abs() <= GROWTH * largest && pivot != 0.0;
                if !certain {
                    return None;
                }
                negative += usize::from(pivot < 0.0);
            }
        }
        Some(negative)
    }
}
