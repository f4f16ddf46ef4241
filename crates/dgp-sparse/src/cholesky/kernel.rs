//! Loops over small dense blocks, compiled for what the processor can do.
//!
//! Products are added one after the other whatever the width of the registers: same bits.

#![allow(clippy::inline_always, reason = "only what is inlined is compiled for wide registers")]

use faer::traits::ComplexField;

/// Runs `f`, into which everything is inlined, with the widest registers there are.
#[inline(always)]
pub(super) fn widest<R>(f: impl FnOnce() -> R) -> R {
    <f64 as ComplexField>::Arch::default().dispatch(f)
}

/// L₁₁ and L₂₁ in the place of a panel of `columns` columns, each of `rows` rows; the first column whose
/// pivot is not positive.
pub(super) fn eliminate(panel: &mut [f64], columns: usize, rows: usize) -> Result<(), usize> {
    widest(
        #[inline(always)]
        || eliminate_here(panel, columns, rows),
    )
}

#[inline(always)]
fn eliminate_here(panel: &mut [f64], columns: usize, rows: usize) -> Result<(), usize> {
    for j in 0..columns {
        let (before, after) = panel.split_at_mut(j * rows);
        let column = &mut after[j..rows];
        let mut k = 0;
        while k + 4 <= j {
            let part = |k: usize| &before[k * rows + j..(k + 1) * rows];
            subtract_four(column, [part(k), part(k + 1), part(k + 2), part(k + 3)]);
            k += 4;
        }
        while k < j {
            subtract_one(column, &before[k * rows + j..(k + 1) * rows]);
            k += 1;
        }
        let pivot = column[0];
        if !(pivot > 0.0) {
            return Err(j);
        }
        let root = pivot.sqrt();
        column[0] = root;
        let inverse = 1.0 / root;
        for x in &mut column[1..] {
            *x *= inverse;
        }
    }
    Ok(())
}

/// x ← x − Σ columns · their first entries.
#[inline(always)]
fn subtract_four(x: &mut [f64], [a, b, c, d]: [&[f64]; 4]) {
    let factors = [a[0], b[0], c[0], d[0]];
    for ((((x, a), b), c), d) in x.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *x -= (factors[0] * a + factors[1] * b) + (factors[2] * c + factors[3] * d);
    }
}

#[inline(always)]
fn subtract_one(x: &mut [f64], a: &[f64]) {
    let factor = a[0];
    for (x, a) in x.iter_mut().zip(a) {
        *x -= factor * a;
    }
}

/// The lower triangle of −L₂₁ L₂₁ᵀ for the rows of a panel below its square.
pub(super) fn negative_square(panel: &[f64], columns: usize, rows: usize, update: &mut [f64]) {
    widest(
        #[inline(always)]
        || {
            let height = rows - columns;
            for j in 0..height {
                let target = &mut update[j * height + j..(j + 1) * height];
                target.fill(0.0);
                let part = |k: usize| &panel[k * rows + columns + j..(k + 1) * rows];
                let mut k = 0;
                while k + 4 <= columns {
                    subtract_four(target, [part(k), part(k + 1), part(k + 2), part(k + 3)]);
                    k += 4;
                }
                while k < columns {
                    subtract_one(target, part(k));
                    k += 1;
                }
            }
        },
    );
}

/// Adds each of the values at its place.
pub(super) fn scatter(target: &mut [f64], places: &[u32], values: &[f64]) {
    for (&place, &value) in places.iter().zip(values) {
        target[place as usize] += value;
    }
}

/// The same where places are counted from `first`.
pub(super) fn scatter_below(target: &mut [f64], places: &[u32], values: &[f64], first: u32) {
    for (&place, &value) in places.iter().zip(values) {
        target[(place - first) as usize] += value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panel_times_its_transpose_is_the_front_again() {
        // L with known entries, seven rows and five columns; its front is L Lᵀ.
        let (rows, columns) = (7, 5);
        let entry = |i: usize, j: usize| match i.cmp(&j) {
            std::cmp::Ordering::Less => 0.0,
            std::cmp::Ordering::Equal => 2.0 + j as f64,
            std::cmp::Ordering::Greater => (1 + i + 2 * j) as f64 / 4.0,
        };
        let product =
            |i: usize, j: usize| (0..columns).map(|k| entry(i, k) * entry(j, k)).sum::<f64>();
        let mut panel: Vec<f64> =
            (0..rows * columns).map(|at| product(at % rows, at / rows)).collect();
        assert_eq!(eliminate(&mut panel, columns, rows), Ok(()));
        for j in 0..columns {
            for i in j..rows {
                assert!((panel[j * rows + i] - entry(i, j)).abs() < 1e-13, "{i} {j}");
            }
        }
        let mut update = vec![f64::NAN; 4];
        negative_square(&panel, columns, rows, &mut update);
        for (at, i, j) in [(0, 5, 5), (1, 6, 5), (3, 6, 6)] {
            assert!((update[at] + product(i, j)).abs() < 1e-12, "{i} {j}");
        }
    }

    #[test]
    fn the_first_pivot_that_is_not_positive_is_named_and_kept() {
        let mut panel = vec![4.0, 2.0, 2.0, 1.0];
        assert_eq!(eliminate(&mut panel, 2, 2), Err(1));
        assert_eq!(panel[3], 0.0);
    }
}
