//! Block Lanczos for the largest eigenvalues θ = 1/(λ + σ) of A = (L + σ M)⁻¹ M, which is symmetric in
//! the inner product of M.
//!
//! ```text
//! A V = V T + Q C        V, Q orthonormal; T symmetric; T s = θ s  ⇒  φ = V s, ‖A φ − θ φ‖ = ‖C s‖
//! ```
//!
//! A step multiplies the last block by A, takes from it what lies along the blocks before, and appends
//! what remains. In exact arithmetic that is only the last two blocks; the second pass goes over all of
//! them, so that V stays orthonormal to rounding. When V is full, the best φ take its place (thick
//! restart).

use std::ops::Range;

use faer::{Accum, Mat};

use super::{
    dense::{product, symmetric_eigen, triangular_root},
    pencil::{OwnMass, Pencil, dot, norm},
    tall::{Tall, Weight, multiply},
};
use crate::{Cholesky, Error, Progress};

/// The Krylov space of one connected problem.
pub(super) struct Lanczos<'a> {
    pencil: &'a Pencil,
    cholesky: &'a Cholesky,
    /// Columns: eigenvectors known before, V, the next block Q.
    basis: Tall,
    /// M times one block, where M is no diagonal.
    weighted: Tall,
    block: usize,
    known: usize,
    /// Where Q starts.
    end: usize,
    /// The first column that the next product can have a part along, but for rounding.
    coupled: usize,
    /// T and C; rows and columns are those of the basis.
    projected: Mat<f64>,
    random: Random,
    /// Solves with one right-hand side.
    pub(super) solves: usize,
    pub(super) restarts: usize,
}

/// Eigenvectors found by Lanczos.
pub(super) struct Found {
    /// Column after column.
    pub(super) vectors: Vec<f64>,
    /// About the next eigenvalue that was not asked for; infinite if there is none.
    pub(super) next: f64,
}

/// Approximations of eigenpairs from the present space, best first.
struct Ritz {
    /// θ, descending.
    values: Vec<f64>,
    /// s, in the same order.
    vectors: Mat<f64>,
    /// ‖L φ − λ M φ‖.
    residuals: Vec<f64>,
}

impl<'a> Lanczos<'a> {
    /// Starts from random vectors orthogonal to the `known` eigenvectors.
    pub(super) fn new(
        pencil: &'a Pencil,
        cholesky: &'a Cholesky,
        known: &[f64],
        wanted: usize,
        seed: u64,
    ) -> Lanczos<'a> {
        let n = pencil.rows();
        let count = known.len() / n;
        let room = n - count;
        let block = block_size(wanted).min(room.div_ceil(8));
        let largest = room - block;
        let space = (2 * wanted + 12 * block).min(largest);
        let capacity = count + space + block;
        let mut basis = Tall::new(n, capacity);
        basis.set(0, known);
        let mut lanczos = Lanczos {
            pencil,
            cholesky,
            basis,
            weighted: Tall::new(
                n,
                if matches!(pencil.mass, OwnMass::Matrix(_)) { block } else { 0 },
            ),
            block,
            known: count,
            end: count,
            coupled: count,
            projected: Mat::zeros(capacity, capacity),
            random: Random(seed),
            solves: 0,
            restarts: 0,
        };
        let start = (0..block).flat_map(|_| lanczos.random.vector(n)).collect();
        let start = lanczos.applied(start);
        lanczos.basis.set(count, &start);
        lanczos.orthonormalize(0..count, 0.0);
        lanczos.orthonormalize(0..count, 1.0);
        lanczos.orthonormalize(0..count, 1.0);
        lanczos
    }

    /// The `wanted` largest θ.
    pub(super) fn run(
        &mut self,
        wanted: usize,
        tolerance: f64,
        maximum: usize,
        progress: Progress<'_>,
    ) -> Result<Found, Error> {
        let enough = wanted + wanted / 2 + 2 * self.block;
        let often = (wanted / 5).max(2 * self.block);
        let mut next_look = enough;
        let expected = 2 * wanted + 4 * self.block;
        loop {
            progress.report((self.solves as f64 / expected as f64).min(0.95))?;
            self.expand();
            let active = self.end - self.known;
            let full = self.end + 2 * self.block > self.basis.capacity();
            if active < next_look && !full {
                continue;
            }
            next_look = active + often;
            let ritz = self.ritz()?;
            // The residual is relative to the mass of a vector of length one.
            let converged = ritz.residuals.iter().take_while(|&&r| r <= tolerance).count();
            if converged >= wanted {
                return Ok(self.found(&ritz, wanted));
            }
            if self.solves >= maximum {
                let residual =
                    ritz.residuals[..wanted.min(active)].iter().copied().fold(0.0, f64::max);
                let solves = self.solves;
                return Err(Error::EigenNotConverged {
                    converged,
                    count: wanted,
                    residual,
                    solves,
                });
            }
            if full {
                // Besides those wanted, as many as leave half of the rest for new directions.
                let kept = wanted.max(converged).midpoint(active);
                self.restart(&ritz, kept.min(active - self.block));
                next_look = 0;
            }
        }
    }

    /// A X.
    fn applied(&mut self, mut columns: Vec<f64>) -> Vec<f64> {
        self.solves += columns.len() / self.pencil.rows();
        self.pencil.weigh(&mut columns);
        self.cholesky.substitute(&mut columns).expect("whole columns");
        columns
    }

    /// Appends Q to V, and makes the next Q.
    fn expand(&mut self) {
        let (start, block) = (self.end, self.block);
        let applied = self.basis.columns(start..start + block);
        let applied = self.applied(applied);
        self.end += block;
        self.basis.set(self.end, &applied);
        // A Q = V H + W, W = Q₁ R₁; Q₁ = V G + Q₂ R₂; so A Q = V (H + G R₁) + Q₂ R₂ R₁.
        let near = self.coupled..self.end;
        let mut columns = Mat::zeros(self.end, block);
        // No θ is larger than 1/σ.
        let (along, mut root) = self.orthonormalize(near.clone(), 1.0 / self.pencil.shift);
        columns.as_mut().subrows_mut(near.start, near.len()).copy_from(&along);
        for _ in 0..PASSES {
            let (along, next) = self.orthonormalize(0..self.end, 1.0);
            multiply(columns.as_mut(), Accum::Add, along.as_ref(), root.as_ref(), 1.0);
            root = product(next.as_ref(), root.as_ref());
            // Twice is enough, unless little was left after the first time.
            if largest(&along) < 1e-7 {
                break;
            }
        }
        for j in 0..block {
            let column = start + j;
            for row in near.start..self.end {
                // Of what is computed twice, inside the diagonal block, the mean.
                let value = columns[(row, j)];
                let value = if row < start {
                    value
                } else {
                    value.midpoint(columns[(column, row - start)])
                };
                self.projected[(row, column)] = value;
                self.projected[(column, row)] = value;
            }
            for i in 0..block {
                self.projected[(self.end + i, column)] = root[(i, j)];
                self.projected[(column, self.end + i)] = root[(i, j)];
            }
        }
        self.coupled = start;
    }

    /// The columns of Q.
    fn next(&self) -> Range<usize> {
        self.end..self.end + self.block
    }

    /// Aᵀ M Q for columns A of the basis.
    fn project(&mut self, range: Range<usize>) -> Mat<f64> {
        let next = self.next();
        let weight = match &self.pencil.mass {
            OwnMass::Identity => Weight::Identity,
            OwnMass::Diagonal(masses) => Weight::Diagonal(masses),
            OwnMass::Matrix(mass) => {
                let columns = self.basis.columns(next.clone());
                self.weighted.set(0, &mass.transpose_product_many(&columns));
                Weight::Product(&self.weighted)
            }
        };
        self.basis.project(range, next, weight)
    }

    /// Takes from Q what lies along the basis from `along.start` to its end, and makes the rest
    /// orthonormal. Returns H and R with Q before = A H + Q after · R. What is 10⁻¹³ of `size` is rounding.
    ///
    /// R is the Cholesky factor of what QᵀMQ becomes. Where that is nearly singular, so is Q: then column
    /// by column.
    fn orthonormalize(&mut self, along: Range<usize>, size: f64) -> (Mat<f64>, Mat<f64>) {
        let all = self.project(along.start..self.next().end);
        let amounts = all.subrows(0, along.len()).to_owned();
        let before = all.subrows(along.len(), self.block);
        let mut gram = before.to_owned();
        multiply(gram.as_mut(), Accum::Add, amounts.transpose(), amounts.as_ref(), -1.0);
        let clear = (0..self.block).all(|j| gram[(j, j)] > 1e-10 * before[(j, j)]);
        let root = if clear { triangular_root(gram.as_ref(), WELL_CONDITIONED) } else { None };
        if let Some((root, inverse)) = root {
            self.basis.subtract(along, amounts.as_ref(), self.end, inverse.transpose());
            return (amounts, root.transpose().to_owned());
        }
        let identity = Mat::identity(self.block, self.block);
        self.basis.subtract(along, amounts.as_ref(), self.end, identity.as_ref());
        let gram = self.project(self.next());
        let root = match triangular_root(gram.as_ref(), WELL_CONDITIONED) {
            Some((root, inverse)) => {
                self.basis.transform(self.next(), inverse.transpose());
                root.transpose().to_owned()
            }
            None => self.orthonormalize_columns(size),
        };
        (amounts, root)
    }

    /// The same column by column. A column that vanishes is replaced by a random one: the space it
    /// stands for is exhausted.
    fn orthonormalize_columns(&mut self, size: f64) -> Mat<f64> {
        let n = self.pencil.rows();
        let mut root = Mat::zeros(self.block, self.block);
        let mut done: Vec<Vec<f64>> = Vec::new();
        for (j, column) in self.basis.columns(self.next()).chunks_exact(n).enumerate() {
            let mut column = column.to_vec();
            for (i, other) in done.iter().chain(&done).enumerate() {
                root[(i % j, j)] += self.take_from(&mut column, other);
            }
            let left = self.length(&column);
            let remains = left > 1e-13 * size;
            if remains {
                root[(j, j)] = left;
            } else {
                column = self.random.vector(n);
                let before = self.basis.columns(0..self.end);
                for _ in 0..3 {
                    for other in before.chunks_exact(n).chain(done.iter().map(Vec::as_slice)) {
                        self.take_from(&mut column, other);
                    }
                }
            }
            let factor = 1.0 / if remains { left } else { self.length(&column) };
            for x in &mut column {
                *x *= factor;
            }
            done.push(column);
        }
        self.basis.set(self.end, &done.concat());
        root
    }

    /// The norm of M.
    fn length(&self, column: &[f64]) -> f64 {
        let mut weighted = column.to_vec();
        self.pencil.weigh(&mut weighted);
        dot(column, &weighted).max(0.0).sqrt()
    }

    /// Takes from `column` what lies along `other`, and returns how much that was.
    fn take_from(&self, column: &mut [f64], other: &[f64]) -> f64 {
        let mut weighted = column.to_vec();
        self.pencil.weigh(&mut weighted);
        let along = dot(other, &weighted);
        column.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
        along
    }

    /// The eigenpairs of T, and the residuals of what they stand for.
    fn ritz(&self) -> Result<Ritz, Error> {
        let active = self.end - self.known;
        let of_space = self.projected.submatrix(self.known, self.known, active, active);
        let (ascending, vectors) = symmetric_eigen(of_space).ok_or(Error::EigenNotConverged {
            converged: 0,
            count: active,
            residual: f64::INFINITY,
            solves: self.solves,
        })?;
        let vectors = Mat::from_fn(active, active, |i, j| vectors[(i, active - 1 - j)]);
        let values: Vec<f64> = ascending.into_iter().rev().collect();
        // A φ − θ φ = Q C s, so that L φ − λ M φ = −(L + σ M) Q C s / θ, where θ = 1/(λ + σ).
        let couplings = self.projected.submatrix(self.end, self.known, self.block, active);
        let couplings = product(couplings, vectors.as_ref());
        let gram = self.image_of_next();
        let residuals = (0..active)
            .map(|j| {
                let column = couplings.col(j);
                let square: f64 = (0..self.block)
                    .map(|i| {
                        let row: f64 =
                            (0..self.block).map(|k| gram[i * self.block + k] * column[k]).sum();
                        column[i] * row
                    })
                    .sum();
                square.max(0.0).sqrt()
            })
            .collect();
        Ok(Ritz { values, vectors, residuals })
    }

    /// ZᵀZ for Z = (L + σ M) Q, relative to the length of M times a constant of length one.
    fn image_of_next(&self) -> Vec<f64> {
        let n = self.pencil.rows();
        let next = self.basis.columns(self.next());
        let mut weighted = next.clone();
        self.pencil.weigh(&mut weighted);
        let mut image = self.pencil.laplacian.transpose_product_many(&next);
        for (image, weighted) in image.iter_mut().zip(&weighted) {
            *image += self.pencil.shift * weighted;
        }
        let mut ones = vec![1.0; n];
        let length = self.length(&ones);
        self.pencil.weigh(&mut ones);
        let unit = (norm(&ones) / length).powi(2);
        let columns: Vec<&[f64]> = image.chunks_exact(n).collect();
        columns.iter().flat_map(|a| columns.iter().map(|b| dot(a, b) / unit)).collect()
    }

    /// V ← the `kept` best φ.
    fn restart(&mut self, ritz: &Ritz, kept: usize) {
        let active = self.end - self.known;
        let chosen = ritz.vectors.subcols(0, kept);
        self.basis.transform(self.known..self.end, chosen);
        let couplings = self.projected.submatrix(self.end, self.known, self.block, active);
        let couplings = product(couplings, chosen);
        let end = self.known + kept;
        self.basis.copy_within(self.end, end, self.block);
        self.projected.fill(0.0);
        for (i, &value) in ritz.values[..kept].iter().enumerate() {
            self.projected[(self.known + i, self.known + i)] = value;
            for k in 0..self.block {
                self.projected[(end + k, self.known + i)] = couplings[(k, i)];
                self.projected[(self.known + i, end + k)] = couplings[(k, i)];
            }
        }
        self.end = end;
        self.coupled = self.known;
        self.restarts += 1;
    }

    fn found(&mut self, ritz: &Ritz, wanted: usize) -> Found {
        self.basis.transform(self.known..self.end, ritz.vectors.subcols(0, wanted));
        let vectors = self.basis.columns(self.known..self.known + wanted);
        let next = ritz.values.get(wanted).map_or(f64::INFINITY, |value| {
            if *value > 0.0 { 1.0 / value - self.pencil.shift } else { f64::INFINITY }
        });
        Found { vectors, next }
    }
}

/// The most passes over the whole basis.
const PASSES: usize = 4;

/// Pivots of a Gram matrix relative to its diagonal above which its root loses no more than half of the
/// digits, which the second pass restores.
const WELL_CONDITIONED: f64 = 1e-10;

/// How many vectors are multiplied at once. Wide blocks find what comes several times, and make good
/// use of the cache; narrow ones need fewer products.
fn block_size(wanted: usize) -> usize {
    match wanted {
        0..=20 => 4,
        21..=200 => 8,
        _ => 16,
    }
}

fn largest(matrix: &Mat<f64>) -> f64 {
    let entries = (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| (i, j)));
    entries.map(|place| matrix[place].abs()).fold(0.0, f64::max)
}

/// `SplitMix64` (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    /// Numbers in [−1, 1).
    fn vector(&mut self, length: usize) -> Vec<f64> {
        let number = |_| {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut x = self.0;
            x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        (0..length).map(number).collect()
    }
}
