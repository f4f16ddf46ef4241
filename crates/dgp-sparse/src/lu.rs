//! LU factorization: solves unsymmetric square systems directly.
//!
//! ```text
//! P A Q = L U
//! ```
//!
//! Q orders the columns so that L and U stay sparse whatever rows P exchanges for the sake of
//! stability (column minimum degree). The kernels are faer's.
//!
//! - Input: a square matrix, as of mean value weights.
//! - Cost: for the matrix of a mesh several times that of a Cholesky factorization.
//! - Guarantees: a matrix that is singular to working precision is an error that names a column and a
//!   row; a solution is returned only if it fulfils its equations. Scaling by 2ᵏ scales exactly.
//! - Reference: Demmel, Eisenstat, Gilbert, Li and Liu, "A supernodal approach to sparse partial
//!   pivoting", 1999; Davis, Gilbert, Larimore and Ng, "A column approximate minimum degree ordering
//!   algorithm", 2004.

use faer::{
    Conj, MatMut, Par, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::lu::partial_pivoting::factor::PartialPivLuParams,
    prelude::default,
    sparse::{
        SparseColMatRef, SymbolicSparseColMatRef,
        linalg::{
            LuError,
            lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu},
        },
    },
};

use crate::{Error, MAX_ENTRIES, Progress, SparseMatrix, parallel};

/// The residual above which a solution is refined, and above which it is refused.
const REFINE: f64 = 1e-14;
const REFUSE: f64 = 1e-9;

/// ‖A‖ ‖x‖ / ‖A x‖ above which rounding decides what x is.
const SINGULAR: f64 = 1e14;

/// A factored square matrix.
///
/// ```
/// use dgp_sparse::{Lu, Progress, SparseMatrix};
///
/// let matrix = SparseMatrix::from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, 1.0), (1, 0, 4.0)])?;
/// assert_eq!(Lu::new(&matrix, Progress::NONE)?.solve(&[3.0, 4.0])?, [1.0, 1.0]);
/// # Ok::<(), dgp_sparse::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lu {
    matrix: SparseMatrix,
    factors: Factors,
}

/// L, U and the permutations.
#[derive(Clone, Debug)]
struct Factors {
    symbolic: SymbolicLu<u32>,
    numeric: NumericLu<u32, f64>,
}

impl Lu {
    /// Factors `matrix`.
    pub fn new(matrix: &SparseMatrix, progress: Progress<'_>) -> Result<Lu, Error> {
        progress.report(0.0)?;
        matrix.check_square()?;
        matrix.check_finite()?;
        check_no_empty_line(matrix)?;
        let n = matrix.rows();
        let Some(factors) = Factors::of(matrix)? else {
            return Err(dependence(matrix)?);
        };
        progress.report(0.9)?;
        let lu = Lu { matrix: matrix.clone(), factors };
        // A vector that the matrix makes small is evidence of a singular one.
        let rhs: Vec<f64> = (0..n).map(arbitrary).collect();
        let mut x = rhs.clone();
        lu.factors.solve(&mut x);
        let growth = matrix.row_norm() * largest(&x) / largest(&rhs);
        let regular = growth <= SINGULAR;
        if !regular && n > 0 {
            return Err(dependence(matrix)?);
        }
        progress.report(1.0)?;
        Ok(lu)
    }

    /// x with A x = `rhs`.
    ///
    /// The solution is refined once where that helps; an error if the residual remains above 10⁻⁹ of
    /// ‖A‖ ‖x‖ + ‖b‖.
    pub fn solve(&self, rhs: &[f64]) -> Result<Vec<f64>, Error> {
        Error::check_length("the right-hand side", rhs.len(), self.rows())?;
        self.solve_many(rhs)
    }

    /// X with A X = B, where the columns of B stand one after the other in `rhs`, and those of X
    /// likewise.
    pub fn solve_many(&self, rhs: &[f64]) -> Result<Vec<f64>, Error> {
        let n = self.rows();
        let columns = rhs.len().checked_div(n).unwrap_or(0);
        Error::check_length("the right-hand side", rhs.len(), columns * n)?;
        Error::check_finite("the right-hand side", rhs)?;
        let mut x = rhs.to_vec();
        let results = parallel::map_chunks(&mut x, n, |start, x| {
            self.solve_checked(&rhs[start..start + n], x)
        });
        results.into_iter().collect::<Result<(), Error>>()?;
        Ok(x)
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.matrix.rows()
    }

    fn solve_checked(&self, rhs: &[f64], x: &mut [f64]) -> Result<(), Error> {
        self.factors.solve(x);
        let (mut residual, mut error) = self.residual(x, rhs);
        let exact = error <= REFINE;
        if !exact {
            self.factors.solve(&mut residual);
            let refined: Vec<f64> = x.iter().zip(&residual).map(|(x, dx)| x + dx).collect();
            let (_, after) = self.residual(&refined, rhs);
            if after < error {
                x.copy_from_slice(&refined);
                error = after;
            }
        }
        if error <= REFUSE { Ok(()) } else { Err(Error::Inaccurate { residual: error }) }
    }

    /// b − A x, and its size relative to ‖A‖ ‖x‖ + ‖b‖.
    fn residual(&self, x: &[f64], rhs: &[f64]) -> (Vec<f64>, f64) {
        let mut residual = rhs.to_vec();
        self.matrix.add_product(-1.0, x, &mut residual);
        let size = self.matrix.row_norm() * largest(x) + largest(rhs);
        let error = if size == 0.0 { 0.0 } else { largest(&residual) / size };
        (residual, error)
    }
}

impl Factors {
    /// `None` if no pivot is left for some column.
    fn of(matrix: &SparseMatrix) -> Result<Option<Factors>, Error> {
        let too_large =
            |count| Error::TooLarge { kind: "entries of the factors", count, limit: MAX_ENTRIES };
        let n = matrix.rows();
        let pattern = SymbolicSparseColMatRef::new_unsorted_checked(
            n,
            n,
            matrix.starts(),
            None,
            matrix.indices(),
        );
        let symbolic = factorize_symbolic_lu(pattern, LuSymbolicParams::default())
            .map_err(|_| too_large(matrix.entries()))?;
        let mut numeric = NumericLu::new();
        let params: Spec<PartialPivLuParams, f64> = default();
        let size = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, params);
        let mut memory = MemBuffer::new(size);
        let values = SparseColMatRef::new(pattern, matrix.values());
        let stack = MemStack::new(&mut memory);
        let factored = symbolic
            .factorize_numeric_lu(&mut numeric, values, Par::Seq, stack, params)
            .map(|_| ());
        match factored {
            Ok(()) => Ok(Some(Factors { symbolic, numeric })),
            Err(LuError::SymbolicSingular { .. }) => Ok(None),
            Err(LuError::Generic(_)) => Err(too_large(matrix.entries())),
        }
    }

    /// x ← A⁻¹ x.
    fn solve(&self, x: &mut [f64]) {
        self.solve_with(x, |factors, x, stack| {
            factors.solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        });
    }

    /// x ← A⁻ᵀ x.
    fn solve_transposed(&self, x: &mut [f64]) {
        self.solve_with(x, |factors, x, stack| {
            factors.solve_transpose_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        });
    }

    fn solve_with(
        &self,
        x: &mut [f64],
        solve: impl Fn(LuRef<'_, u32, f64>, MatMut<'_, f64>, &mut MemStack),
    ) {
        let n = x.len();
        let size = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::new(size);
        let factors = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        let x = MatMut::from_column_major_slice_mut(x, n, 1);
        solve(factors, x, MemStack::new(&mut memory));
    }
}

/// An error if a column or a row has no entry but zeros.
fn check_no_empty_line(matrix: &SparseMatrix) -> Result<(), Error> {
    let mut row_sizes = vec![0.0; matrix.rows()];
    for (row, _, value) in matrix.triplets() {
        row_sizes[row] += value.abs();
    }
    if let Some(row) = row_sizes.iter().position(|&size| size == 0.0) {
        return Err(Error::EmptyRow { row });
    }
    let empty = |j: &usize| matrix.column(*j).1.iter().all(|&value| value == 0.0);
    match (0..matrix.columns()).find(empty) {
        Some(column) => Err(Error::DependentColumn { column, columns: 1 }),
        None => Ok(()),
    }
}

/// The error for a singular matrix: by inverse iteration on a matrix beside it, the combination of rows
/// and that of columns that vanish. Named are those with the largest part in them.
fn dependence(matrix: &SparseMatrix) -> Result<Error, Error> {
    let n = matrix.rows();
    let size = 1e-9 * matrix.row_norm();
    let beside: Vec<f64> = (0..n).map(|i| size * (1.5 + 0.5 * arbitrary(i))).collect();
    let Some(factors) = Factors::of(&matrix.plus_diagonal(&beside)?)? else {
        return Ok(Error::SingularLu { row: 0, column: 0 });
    };
    let vanishing = |solve: &dyn Fn(&mut [f64])| {
        let mut x: Vec<f64> = (0..n).map(arbitrary).collect();
        for _ in 0..3 {
            solve(&mut x);
            let size = largest(&x);
            for x in &mut x {
                *x /= size;
            }
        }
        x.iter().position(|x| x.abs() >= 1.0 - 1e-6).unwrap_or(0)
    };
    let column = vanishing(&|x| factors.solve(x));
    let row = vanishing(&|x| factors.solve_transposed(x));
    Ok(Error::SingularLu { row, column })
}

/// A number in [−1, 1) that depends on `i` alone and is no pattern of meshes.
pub(crate) fn arbitrary(i: usize) -> f64 {
    let mut x = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// max |x|, or NaN.
pub(crate) fn largest(x: &[f64]) -> f64 {
    x.iter().map(|x| x.abs()).fold(0.0, |a: f64, b| if b <= a { a } else { b })
}
