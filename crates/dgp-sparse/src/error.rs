//! What can go wrong.

/// Why a function of this crate gave no result. Rows and columns are those of the caller's matrix.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller asked the computation to stop.
    #[error("cancelled")]
    Cancelled,

    /// More than 32-bit indices can count.
    #[error("{count} {kind} are more than the {limit} that fit; split the problem")]
    TooLarge {
        /// What is counted.
        kind: &'static str,
        /// How many there are.
        count: usize,
        /// How many there can be.
        limit: usize,
    },

    /// An entry lies outside the matrix.
    #[error("entry {entry} is in row {row}, column {column}, but the matrix is {rows} × {columns}")]
    OutOfRange {
        /// Which of the entries, counted from 0.
        entry: usize,
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// The rows of the matrix.
        rows: usize,
        /// The columns of the matrix.
        columns: usize,
    },

    /// Compressed columns do not follow the rules of [`SparseMatrix::from_columns`](crate::SparseMatrix::from_columns).
    #[error("column {column} is not sorted, or its start is before the one before it")]
    Unsorted {
        /// The first such column.
        column: usize,
    },

    /// An entry of a matrix is infinite or not a number.
    #[error("the entry in row {row}, column {column} is {value}; entries must be finite")]
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// What it is.
        value: f64,
    },

    /// An entry of a vector is infinite or not a number.
    #[error("entry {index} of {name} is {value}; it must be finite")]
    VectorNotFinite {
        /// Which vector.
        name: &'static str,
        /// Its entry.
        index: usize,
        /// What it is.
        value: f64,
    },

    /// Two things do not fit together.
    #[error("{name} has length {actual}, but must have {expected}")]
    Length {
        /// What has the wrong length.
        name: &'static str,
        /// The length it has.
        actual: usize,
        /// The length it must have.
        expected: usize,
    },

    /// A selection of rows or columns is no ascending list of such.
    #[error("{name} must be named in ascending order, each once, and be less than {count}")]
    Selection {
        /// What is selected.
        name: &'static str,
        /// How many there are.
        count: usize,
    },

    /// A square matrix is needed.
    #[error("the matrix is {rows} × {columns}, but must be square")]
    NotSquare {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
    },

    /// A symmetric matrix is needed.
    #[error(
        "the entry in row {row}, column {column} is {value}, its mirror image is {mirrored}, or one of \
         them is not stored; add the transpose and halve, if that is what is meant"
    )]
    NotSymmetric {
        /// The row of the first such entry.
        row: usize,
        /// Its column.
        column: usize,
        /// Its value.
        value: f64,
        /// The value in row `column`, column `row`.
        mirrored: f64,
    },

    /// A matrix to be refactored has entries elsewhere than the one that was analyzed.
    #[error("column {column} has entries in other rows than when it was analyzed; analyze anew")]
    OtherPattern {
        /// The first such column.
        column: usize,
    },

    /// The matrix has a negative eigenvalue.
    #[error(
        "the matrix is not positive definite: row {row} has pivot {pivot}, where {diagonal} is on \
         the diagonal; use LU, or check the sign of the weights"
    )]
    NotPositiveDefinite {
        /// The row.
        row: usize,
        /// What remained on the diagonal after the rows eliminated before.
        pivot: f64,
        /// What was on the diagonal.
        diagonal: f64,
    },

    /// Adding a constant to one component changes nothing, so that it has no unique solution.
    #[error(
        "the {size} rows connected to row {row} sum to zero: constants on them are in the null \
         space; fix one of these rows or add a mass"
    )]
    ConstantNullSpace {
        /// The first row of the component.
        row: usize,
        /// How many rows the component has.
        size: usize,
    },

    /// The matrix is singular to working precision.
    #[error(
        "row {row} depends on the {size} rows connected to it: of {diagonal} on the diagonal only \
         {pivot} remained; fix more rows or add a small multiple of the identity"
    )]
    Singular {
        /// The row that depends on others.
        row: usize,
        /// How many rows its component has.
        size: usize,
        /// What remained on the diagonal after the rows eliminated before.
        pivot: f64,
        /// What was on the diagonal.
        diagonal: f64,
    },

    /// A solution does not fulfil its equations.
    #[error(
        "the solution leaves a residual of {residual} relative to matrix, solution and right-hand \
         side; the matrix is too close to singular"
    )]
    Inaccurate {
        /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖) in the maximum norm.
        residual: f64,
    },

    /// A component has no fixed row, so that its solution is not unique.
    #[error(
        "none of the {size} rows connected to row {row} is fixed, and they sum to zero; fix one of \
         them"
    )]
    Unconstrained {
        /// The first row of the component.
        row: usize,
        /// How many rows the component has.
        size: usize,
    },

    /// A row is fixed twice.
    #[error("row {row} is fixed twice")]
    FixedTwice {
        /// The row.
        row: usize,
    },

    /// A linear constraint follows from those before it, or contradicts them.
    #[error("constraint {constraint} depends on those before it; remove it")]
    DependentConstraint {
        /// The constraint, counted from 0.
        constraint: usize,
    },

    /// An order is no permutation.
    #[error("the order names row {row} twice or never, or has the wrong length")]
    NotPermutation {
        /// The first row that is not named exactly once.
        row: usize,
    },

    /// A text is no Matrix Market file of numbers.
    #[error("line {line}: {problem}")]
    MatrixMarket {
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        problem: &'static str,
    },

    /// A row has no entry but zeros.
    #[error("row {row} has no entry but zeros; leave it out, or fix its unknown")]
    EmptyRow {
        /// The first such row.
        row: usize,
    },

    /// An unsymmetric matrix is singular to working precision.
    #[error(
        "the matrix is singular: a combination of rows, row {row} with the largest part, vanishes, and \
         one of columns, column {column} with the largest part; fix this unknown, or add an equation"
    )]
    SingularLu {
        /// The row with the largest part in a combination of rows that vanishes.
        row: usize,
        /// The column with the largest part in a combination of columns that vanishes.
        column: usize,
    },

    /// A column is a combination of others, so that the unknowns are not unique.
    #[error(
        "column {column} depends on others: a combination of {columns} columns vanishes; fix this \
         unknown, or add an equation for it"
    )]
    DependentColumn {
        /// The column with the largest part in the combination.
        column: usize,
        /// How many columns have a part in it, or are connected to it.
        columns: usize,
    },

    /// There are fewer equations than unknowns.
    #[error("{rows} equations do not determine {columns} unknowns; add equations")]
    Underdetermined {
        /// The equations.
        rows: usize,
        /// The unknowns.
        columns: usize,
    },

    /// An iteration has not reached the accuracy asked for.
    #[error(
        "after {iterations} iterations the residual is {residual} of the right-hand side; allow more \
         iterations, or factor the matrix"
    )]
    NotConverged {
        /// The iterations.
        iterations: usize,
        /// ‖b − A x‖ / ‖b‖.
        residual: f64,
    },

    /// More eigenpairs are asked for than there are.
    #[error("{count} eigenpairs are asked for, but a matrix of {rows} rows has only {rows}")]
    TooManyEigenpairs {
        /// How many are asked for.
        count: usize,
        /// The rows of the matrix.
        rows: usize,
    },

    /// A mass is not positive, so that an eigenvalue would be infinite or negative.
    #[error(
        "row {row} has mass {mass}; masses must be positive: leave out what has none (a vertex on no \
         face), or give it some"
    )]
    MassNotPositive {
        /// The first such row.
        row: usize,
        /// Its mass.
        mass: f64,
    },

    /// Eigenpairs are not as accurate as they should be.
    #[error(
        "after {solves} solves {converged} of {count} eigenpairs are accurate; the others have \
         residuals of up to {residual}; allow more solves or a larger tolerance"
    )]
    EigenNotConverged {
        /// How many are accurate.
        converged: usize,
        /// How many should be.
        count: usize,
        /// The largest residual of the others.
        residual: f64,
        /// How many systems were solved for them.
        solves: usize,
    },

    /// There are smaller eigenvalues than those that were found.
    #[error(
        "{found} eigenvalues below {bound} were found, but there are {counted}; try another seed or \
         shift"
    )]
    EigenvaluesMissed {
        /// How many were found.
        found: usize,
        /// How many there are by Sylvester's law of inertia.
        counted: usize,
        /// Below which eigenvalue.
        bound: f64,
    },

    /// An option has a value outside its range.
    #[error("option `{name}` is {value}, but must be {expected}")]
    InvalidOption {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
}

impl Error {
    /// The error for an option out of range.
    pub fn option(name: &'static str, value: f64, expected: &'static str) -> Self {
        Error::InvalidOption { name, value, expected }
    }

    /// The same error where row `i` of what was factored is row `rows[i]` of what the caller knows.
    pub(crate) fn renumbered(mut self, rows: &[u32]) -> Self {
        use Error::{ConstantNullSpace, NotPositiveDefinite, Singular};
        if let NotPositiveDefinite { row, .. }
        | ConstantNullSpace { row, .. }
        | Singular { row, .. } = &mut self
        {
            *row = rows[*row] as usize;
        }
        if let Error::NotFinite { row, column, .. } = &mut self {
            (*row, *column) = (rows[*row] as usize, rows[*column] as usize);
        }
        self
    }

    /// An error unless `actual` is `expected`.
    pub(crate) fn check_length(
        name: &'static str,
        actual: usize,
        expected: usize,
    ) -> Result<(), Error> {
        if actual == expected { Ok(()) } else { Err(Error::Length { name, actual, expected }) }
    }

    /// An error unless all of `values` are finite.
    pub(crate) fn check_finite(name: &'static str, values: &[f64]) -> Result<(), Error> {
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(index) => Err(Error::VectorNotFinite { name, index, value: values[index] }),
        }
    }
}
