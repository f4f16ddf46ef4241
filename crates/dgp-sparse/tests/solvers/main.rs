//! Orders, factorizations and eigenpairs, as their users see them.

mod cholesky;
mod common;
mod constraint;
mod eigen;
mod iterative;
mod lu;
mod order;
