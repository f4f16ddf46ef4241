//! Systems whose solution is partly given: unknowns that are fixed, equations that hold approximately
//! or exactly.
//!
//! | what is known | type |
//! |---|---|
//! | some unknowns | [`FixedSystem`]: they are eliminated |
//! | linear equations, about | [`SoftSystem`]: they are added with weights |
//! | linear equations, exactly | [`EqualitySystem`]: by Lagrange multipliers |
//!
//! Each factors once and solves for many values.

mod equality;
mod fixed;
mod soft;

pub use equality::EqualitySystem;
pub use fixed::FixedSystem;
pub use soft::SoftSystem;

use crate::{
    SparseMatrix,
    cholesky::{component, sums_to_zero},
};

/// The connected components of a symmetric matrix whose rows sum to zero within rounding: constants on
/// them are in its null space.
fn constant_components(matrix: &SparseMatrix) -> Vec<Vec<u32>> {
    let mut seen = vec![false; matrix.rows()];
    let mut found = Vec::new();
    for row in 0..matrix.rows() {
        if seen[row] {
            continue;
        }
        let component = component(matrix, row, &mut seen);
        if sums_to_zero(matrix, &component) {
            found.push(component);
        }
    }
    found
}
