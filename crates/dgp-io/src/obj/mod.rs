//! Wavefront OBJ.
//!
//! Texture coordinates and normals belong to corners. Where all corners of each vertex agree they
//! become vertex attributes, else corner attributes; corners without any get zeros.
//!
//! - Input: any bytes.
//! - Cost: O(bytes), in parallel.
//! - Reference: "Object Files (.obj)", Alias|Wavefront, Advanced Visualizer Manual, appendix B1.
//! - Departs from it: vertices may have colors (`v x y z r g b`), as most programs write them; curves
//!   and free-form surfaces are skipped with a warning.

mod block;
mod read;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;
