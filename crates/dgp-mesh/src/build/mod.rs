//! From faces to half-edges.

pub(crate) mod assemble;
mod corners;
pub(crate) mod paired;
pub(crate) mod sides;
mod strict;

pub use strict::strict_mesh;
