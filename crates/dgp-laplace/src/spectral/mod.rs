//! Spectra: the waves of a surface, and what they are good for.
//!
//! | question | function |
//! |---|---|
//! | which waves are there | [`Eigenbasis::new`] |
//! | where does a wave swing up, where down | [`nodal_domains`] |
//! | where is the neck | [`fiedler`] |
//! | which parts belong together | [`partition`] |
//! | how few numbers describe the shape | [`compress`], [`rate_distortion`] |
//! | which points correspond | [`functional_map`], [`zoomout`], [`point_map`] |
//! | how does heat spread | [`heat_kernel`], [`heat_kernel_diagonal`], [`signature_times`] |

mod basis;
mod cluster;
mod compression;
mod fiedler;
mod functional_map;
mod graph;
mod heat_kernel;
mod nodal;
#[cfg(test)]
mod oracle_tests;
mod partition;
#[cfg(test)]
mod tests;
mod zoomout;

pub use basis::Eigenbasis;
pub use compression::{Compressed, CompressionOptions, RatePoint, compress, rate_distortion};
pub use fiedler::{Fiedler, fiedler};
pub use functional_map::{
    FunctionalMap, FunctionalMapOptions, functional_map, map_of_points, point_map,
};
pub use heat_kernel::{heat_kernel, heat_kernel_diagonal, signature_times};
pub use nodal::{NodalDomains, nodal_domains};
pub use partition::{Partition, PartitionMethod, PartitionOptions, partition};
pub use zoomout::{ZoomOut, ZoomOutOptions, zoomout};
