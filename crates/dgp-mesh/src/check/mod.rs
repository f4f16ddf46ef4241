//! What is wrong with faces.

pub(crate) mod union;
