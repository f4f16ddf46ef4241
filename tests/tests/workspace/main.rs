//! What takes several crates, and what takes real files.

mod broken;
mod denoising;
mod every_algorithm;
mod laplacians;
mod mended;
mod random_files;
mod real_chain;
mod real_files;
mod real_meshes;
