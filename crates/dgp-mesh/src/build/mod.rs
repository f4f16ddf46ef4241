//! From faces to half-edges.

pub(crate) mod assemble;
mod strict;

pub use strict::strict_mesh;
