//! Decimation, progressive meshes and holes as callers meet them.

mod any_cost;
mod data;
mod holes;
mod progressive;
mod quadrics;
mod quick;
mod remeshing;
mod repairing;
mod sampling;
mod voronoi;
