//! What the tests of the workspace share: where real data are, and the bodies of the fuzzers.

pub mod data;
pub mod fuzz;
pub mod random;
