//! From faces to half-edges.

pub(crate) mod assemble;
