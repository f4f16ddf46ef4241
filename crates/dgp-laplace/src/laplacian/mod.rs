//! Laplacians of meshes and point clouds as matrices, and the masses that belong to them.
//!
//! | matrix | function | weights of an edge |
//! |---|---|---|
//! | of the graph | [`uniform_laplacian`] | 1 |
//! | of linear finite elements | [`cotangent_laplacian`] | (cot α + cot β)/2, can be negative |
//! | positive, not symmetric | [`mean_value_laplacian`] | (tan γ/2 + tan δ/2)/(2 length) |
//! | each row divided by its diagonal | [`random_walk_laplacian`] | sum to 1 |
//! | symmetric, of the same eigenvalues as M⁻¹ L | [`normalized_laplacian`] | |
//! | mass, lumped or of finite elements | [`vertex_masses`], [`mass_matrix`] | |
//! | what a matrix is like | [`laplacian_report`] | |
//!
//! All are positive semidefinite where no weight is negative: `(L x)ᵢ = Σ w (xᵢ − xⱼ)`, so the diagonal
//! is the sum of the weights, the rest their negatives, and constants are mapped to zero. With the mass
//! M the Laplace–Beltrami operator −Δ is M⁻¹ L. Row and column i are those of vertex i.

mod assemble;
mod cotangent;
mod mass;
mod mean_value;
mod report;
mod rows;
mod uniform;

pub use cotangent::cotangent_laplacian;
pub use mass::{MassKind, mass_matrix, vertex_masses};
pub use mean_value::mean_value_laplacian;
pub use report::{LaplacianReport, laplacian_report};
pub use rows::{normalized_laplacian, random_walk_laplacian};
pub use uniform::uniform_laplacian;

#[cfg(test)]
mod tests;
