//! Intrinsic Delaunay triangulation: flips edges until no weight is negative.
//!
//! An edge is Delaunay if the angles opposite it sum to π at most, that is cot α + cot β ≥ 0. Flipping one
//! that is not makes the triangulation better in a way that can only be repeated finitely often. The new
//! length is that of the other diagonal when both triangles are laid out in the plane.
//!
//! - Input: triangles by their lengths, with area.
//! - Cost: on surfaces of well shaped triangles a few flips; each is O(1).
//! - Guarantees: in the end weights of edges with two triangles are above −10⁻⁹ or so. An edge at a rim cannot
//!   be flipped: its weight is negative where the angle opposite is obtuse. The sum of the areas stays.
//! - Reference: Bobenko and Springborn, "A discrete Laplace–Beltrami operator for simplicial surfaces",
//!   Discrete & Computational Geometry 38, 2007; Fisher, Springborn, Schröder and Bobenko, "An algorithm
//!   for the construction of intrinsic Delaunay triangulations", Computing 81, 2007.

use dgp_mesh::Progress;

use super::triangulation::{IntrinsicTriangulation, corner, cotangents, next, prev};
use crate::Error;

/// A sum of cotangents above this is rounding and no reason to flip.
const ROUNDING: f64 = -1e-11;

impl IntrinsicTriangulation {
    /// Whether side `s` has triangles on both sides whose angles opposite it exceed π together.
    fn wants_flip(&self, s: usize) -> bool {
        let Some(t) = self.across(s) else { return false };
        // Both sides of one triangle: there is no other diagonal.
        if s / 3 == t / 3 {
            return false;
        }
        let opposite = |s: usize| {
            let sides = [s, next(s), prev(s)].map(|s| self.lengths()[s]);
            cotangents(sides)[0]
        };
        let (a, b) = (opposite(s), opposite(t));
        a + b < ROUNDING * (1.0 + a.abs() + b.abs())
    }

    /// Flips edges until all are Delaunay; returns how many flips that took.
    ///
    /// Errors: [`Error::EndlessFlips`], [`Error::Cancelled`], which leaves a valid triangulation.
    pub fn flip_to_delaunay(&mut self, progress: Progress<'_>) -> Result<usize, Error> {
        // Far beyond what surfaces need; only rounding in triangles of nearly no area can reach it.
        let limit = 100_000 + 200 * self.lengths().len();
        // An edge is queued by the smaller of its sides. Sides that a flip moves are queued by their new
        // names, so that no edge gets lost.
        let name = |this: &Self, s: usize| s.min(this.across(s).unwrap_or(s));
        let mut is_queued: Vec<bool> =
            (0..self.lengths().len()).map(|s| name(self, s) == s).collect();
        let mut queue: Vec<u32> =
            (0..is_queued.len() as u32).rev().filter(|&s| is_queued[s as usize]).collect();
        let mut flips = 0;
        let start = queue.len().max(1) as f64;
        let (mut steps, mut done) = (0_usize, 0.0);
        while let Some(s) = queue.pop() {
            if steps.is_multiple_of(1 << 16) {
                // The queue grows at times; what is reported does not fall.
                done = (1.0 - queue.len() as f64 / start).max(done);
                progress.report(done)?;
            }
            steps += 1;
            let s = s as usize;
            is_queued[s] = false;
            let Some(t) = self.across(s) else { continue };
            if !self.wants_flip(s) {
                continue;
            }
            let Some(length) = self.other_diagonal(s, t) else { continue };
            if flips == limit {
                return Err(Error::EndlessFlips { flips });
            }
            flips += 1;
            self.flip(s, length);
            for side in [next(s), prev(s), next(t), prev(t)] {
                let side = name(self, side);
                if !is_queued[side] {
                    is_queued[side] = true;
                    queue.push(side as u32);
                }
            }
        }
        Ok(flips)
    }

    /// The distance between the corners opposite side `s` and side `t` across it, laid out in the plane.
    fn other_diagonal(&self, s: usize, t: usize) -> Option<f64> {
        let lengths = |s: usize| [s, next(s), prev(s)].map(|s| self.lengths()[s]);
        let ([along, up], [from_end, down]) = (corner(lengths(s)), corner(lengths(t)));
        let length = (along - (self.lengths()[s] - from_end)).hypot(up + down);
        (length > 0.0 && length.is_finite()).then_some(length)
    }
}
