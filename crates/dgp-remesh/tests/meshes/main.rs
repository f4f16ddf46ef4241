//! Decimation, progressive meshes and holes as callers meet them.

mod any_cost;
mod holes;
mod progressive;
mod quadrics;
mod remeshing;
