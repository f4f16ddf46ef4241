//! Matrices to try things on.

pub(crate) mod elements;
pub(crate) mod surfaces;

use dgp_sparse::SparseMatrix;

/// The Laplacian of a grid of `width` × `height` vertices.
pub(crate) fn grid(width: usize, height: usize) -> SparseMatrix {
    let index = |x: usize, y: usize| (x + y * width) as u32;
    let mut edges = Vec::new();
    for y in 0..height {
        for x in 0..width {
            if x + 1 < width {
                edges.push((index(x, y), index(x + 1, y), 1.0));
            }
            if y + 1 < height {
                edges.push((index(x, y), index(x, y + 1), 1.0));
            }
        }
    }
    SparseMatrix::from_edges(width * height, &edges).unwrap()
}

/// Numbers in [0, 1), the same for the same seed.
pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = state;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// By elimination with pivots, as in the textbook.
pub(crate) fn dense_solve(mut rows: Vec<Vec<f64>>, rhs: &[f64]) -> Vec<f64> {
    let n = rhs.len();
    rows.iter_mut().zip(rhs).for_each(|(row, &rhs)| row.push(rhs));
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).unwrap();
        rows.swap(k, pivot);
        let top = rows[k].clone();
        for row in &mut rows[k + 1..] {
            let factor = row[k] / top[k];
            row.iter_mut().zip(&top).for_each(|(x, top)| *x -= factor * top);
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * rows[j][n]).sum();
        rows[k][n] = (rows[k][n] - known) / rows[k][k];
    }
    rows.iter().map(|row| row[n]).collect()
}
