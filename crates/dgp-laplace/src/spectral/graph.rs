//! The graph that a Laplacian is of.

use dgp_sparse::SparseMatrix;

use crate::Error;

/// The parts of the graph among these rows: for each of them the number of its part, and how many there
/// are. Rows are joined by entries that are not zero.
pub(super) fn parts(laplacian: &SparseMatrix, rows: &[u32]) -> (Vec<u32>, usize) {
    const OUTSIDE: u32 = u32::MAX;
    let mut local = vec![OUTSIDE; laplacian.rows()];
    for (i, &row) in rows.iter().enumerate() {
        local[row as usize] = i as u32;
    }
    let mut labels = vec![OUTSIDE; rows.len()];
    let (mut count, mut stack) = (0, Vec::new());
    for start in 0..rows.len() {
        if labels[start] != OUTSIDE {
            continue;
        }
        labels[start] = count;
        stack.push(start);
        while let Some(i) = stack.pop() {
            let (neighbors, weights) = laplacian.column(rows[i] as usize);
            for (&j, &weight) in neighbors.iter().zip(weights) {
                let j = local[j as usize];
                if weight != 0.0 && j != OUTSIDE && labels[j as usize] == OUTSIDE {
                    labels[j as usize] = count;
                    stack.push(j as usize);
                }
            }
        }
        count += 1;
    }
    (labels, count as usize)
}

/// The Laplacian of the graph that these rows span: weights to other rows are left out of the diagonal too.
pub(super) fn induced(laplacian: &SparseMatrix, rows: &[u32]) -> Result<SparseMatrix, Error> {
    let mut sub = laplacian.submatrix(rows, rows)?;
    for j in 0..sub.columns() {
        let (below, weights) = sub.column(j);
        let (mut diagonal, mut sum) = (None, 0.0);
        for (k, (&i, &weight)) in below.iter().zip(weights).enumerate() {
            if i as usize == j { diagonal = Some(k) } else { sum -= weight }
        }
        if let Some(k) = diagonal {
            let place = sub.starts()[j] as usize + k;
            sub.values_mut()[place] = sum;
        }
    }
    Ok(sub)
}

/// Weights below zero by no more than this part of the largest row are so by rounding.
const ROUNDING: f64 = 1e-12;

/// Refuses negative weights, which no graph that is to be cut may have.
pub(super) fn check_weights(laplacian: &SparseMatrix) -> Result<(), Error> {
    let rounding = ROUNDING * laplacian.row_norm();
    for (row, column, entry) in laplacian.triplets() {
        if row != column && entry > rounding {
            return Err(Error::NegativeWeight { row, column, weight: -entry });
        }
    }
    Ok(())
}
