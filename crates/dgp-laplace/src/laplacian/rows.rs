//! Laplacians divided by their diagonals or by masses.

use dgp_sparse::SparseMatrix;

use crate::Error;

/// D⁻¹ L with the diagonal D of `laplacian`: rows 1, −w/Σw, so that (L x)ᵢ is xᵢ less the mean of its
/// neighbors. Rows without weights stay zero.
///
/// Errors: [`Error::NonPositiveDiagonal`] if the weights of a vertex do not sum to something positive.
pub fn random_walk_laplacian(laplacian: &SparseMatrix) -> Result<SparseMatrix, Error> {
    let mut factors = positive_diagonal(laplacian)?;
    factors.iter_mut().filter(|d| **d > 0.0).for_each(|d| *d = 1.0 / *d);
    let ones = vec![1.0; factors.len()];
    let mut walk = laplacian.clone().scaled_by(&factors, &ones)?;
    set_diagonal_to_one(&mut walk);
    Ok(walk)
}

/// M⁻½ L M⁻½ for diagonal masses M, symmetric and with the eigenvalues of L φ = λ M φ; an eigenvector ψ
/// of it is M½ φ. With the diagonal of L for M this is the normalized Laplacian of graphs, whose
/// eigenvalues are at most 2.
///
/// Errors: [`Error::NoMass`] where a mass is not positive and finite, [`Error::Sparse`] if there is not
/// one per row.
pub fn normalized_laplacian(
    laplacian: &SparseMatrix,
    masses: &[f64],
) -> Result<SparseMatrix, Error> {
    if let Some(row) = masses.iter().position(|m| !(*m > 0.0 && m.is_finite())) {
        return Err(Error::NoMass { row, mass: masses[row] });
    }
    let factors: Vec<f64> = masses.iter().map(|m| 1.0 / m.sqrt()).collect();
    Ok(laplacian.clone().scaled_by(&factors, &factors)?)
}

/// The diagonal of `laplacian`; rows without weights may have 0.
pub(crate) fn positive_diagonal(laplacian: &SparseMatrix) -> Result<Vec<f64>, Error> {
    laplacian.check_square()?;
    let diagonal = laplacian.diagonal();
    let mut is_used = vec![false; diagonal.len()];
    for (i, _, value) in laplacian.triplets() {
        is_used[i] |= value != 0.0;
    }
    let is_wrong = |&(row, &d): &(usize, &f64)| !(d > 0.0 || d == 0.0 && !is_used[row]);
    match diagonal.iter().enumerate().find(is_wrong) {
        Some((row, &diagonal)) => Err(Error::NonPositiveDiagonal { row, diagonal }),
        None => Ok(diagonal),
    }
}

/// Exactly, not but for rounding.
fn set_diagonal_to_one(matrix: &mut SparseMatrix) {
    for j in 0..matrix.columns() {
        let start = matrix.starts()[j] as usize;
        if let Ok(place) = matrix.column(j).0.binary_search(&(j as u32)) {
            let value = &mut matrix.values_mut()[start + place];
            if *value != 0.0 {
                *value = 1.0;
            }
        }
    }
}
