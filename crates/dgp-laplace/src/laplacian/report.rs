//! What a Laplacian is like: facts checked on the matrix itself.

use dgp_sparse::SparseMatrix;

/// What [`laplacian_report`] finds.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct LaplacianReport {
    /// The number of rows.
    pub rows: usize,
    /// How many pairs of rows have a weight, those of 0 included.
    pub edges: usize,
    /// How many entries off the diagonal are positive: weights below zero. Of a symmetric matrix both
    /// triangles count.
    pub negative_weights: usize,
    /// The least weight, in units of the matrix; `None` without edges.
    pub least_weight: Option<f64>,
    /// The largest weight.
    pub largest_weight: Option<f64>,
    /// The largest |row sum| beside the sum of |entries| of its row: rounding alone, unless something
    /// is added to the diagonal.
    pub row_sum_error: f64,
    /// The largest difference between an entry and its mirror image beside the largest entry: 0 of what
    /// is symmetric.
    pub asymmetry: f64,
}

/// Counts and checks on a square matrix with the signs of this crate: −weights off the diagonal.
///
/// # Panics
/// If the matrix is not square.
pub fn laplacian_report(laplacian: &SparseMatrix) -> LaplacianReport {
    let n = laplacian.rows();
    assert_eq!(n, laplacian.columns(), "a square matrix");
    let (mut sums, mut sizes) = (vec![0.0; n], vec![0.0; n]);
    let mut report = LaplacianReport {
        rows: n,
        edges: 0,
        negative_weights: 0,
        least_weight: None,
        largest_weight: None,
        row_sum_error: 0.0,
        asymmetry: 0.0,
    };
    let mut largest: f64 = 0.0;
    for (i, j, value) in laplacian.triplets() {
        sums[i] += value;
        sizes[i] += value.abs();
        largest = largest.max(value.abs());
        if i == j {
            continue;
        }
        let weight = 0.0 - value;
        report.edges += 1;
        report.negative_weights += usize::from(weight < 0.0);
        report.least_weight = Some(report.least_weight.map_or(weight, |least| least.min(weight)));
        report.largest_weight = Some(report.largest_weight.map_or(weight, |most| most.max(weight)));
    }
    let mirrored = laplacian.transpose();
    let difference = SparseMatrix::combine(1.0, laplacian, -1.0, &mirrored);
    if let Ok(difference) = difference
        && largest > 0.0
    {
        let most = difference.values().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        report.asymmetry = most / largest;
        // Pairs of rows: each once, whether one or both of its entries are stored.
        report.edges = difference.triplets().filter(|(i, j, _)| i < j).count();
    }
    let errors = sums.iter().zip(&sizes).filter(|(_, size)| **size > 0.0);
    report.row_sum_error = errors.map(|(sum, size)| (sum / size).abs()).fold(0.0, f64::max);
    report
}
