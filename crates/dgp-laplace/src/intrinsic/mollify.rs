//! Intrinsic mollification: gives triangles area by making all edges a little longer.
//!
//! ```text
//! ε = max (0, max over all corners of δ + |opposite side| − |the two sides|)        |e| ← |e| + ε
//! ```
//!
//! - Input: lengths that may break the triangle inequality by a little.
//! - Cost: O(V).
//! - Guarantees: in each triangle two sides are longer than the third by δ. Nothing changes where they are.
//! - Reference: Sharp and Crane, "A Laplacian for nonmanifold triangle meshes", SGP 2020, section 4.5.

use super::IntrinsicTriangulation;
use crate::Error;

impl IntrinsicTriangulation {
    /// Adds one length to all edges so that in each triangle two sides are longer than the third by at
    /// least `relative` mean lengths; returns it.
    ///
    /// Errors: [`Error::InvalidOption`] if `relative` is negative or above 1.
    pub fn mollify(&mut self, relative: f64) -> Result<f64, Error> {
        if !(0.0..=1.0).contains(&relative) {
            return Err(Error::option("mollify", relative, "from 0 to 1"));
        }
        let count = self.lengths().len();
        if relative == 0.0 || count == 0 {
            return Ok(0.0);
        }
        let mean = self.lengths().iter().map(|length| length / count as f64).sum::<f64>();
        // All in one point: any length is as good as another, but none is not.
        let delta = if mean > 0.0 { relative * mean } else { relative };
        let missing = |t: usize| {
            let (_, [a, b, c]) = self.triangle(t);
            let short = |a: f64, b: f64, c: f64| delta + (a - b) - c;
            short(a, b, c).max(short(b, c, a)).max(short(c, a, b))
        };
        let added = (0..self.triangle_count()).map(missing).fold(0.0, f64::max);
        self.lengths_mut().iter_mut().for_each(|length| *length += added);
        Ok(added)
    }
}
