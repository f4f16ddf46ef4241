//! The commands, one a file.

mod check;
mod convert;
mod demo;
mod info;
mod render;
mod repair;
mod smooth;

use clap::Subcommand;

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Topology, geometry and quality of a mesh, valid or not
    Info(info::Info),
    /// List every defect with its elements; exit code 1 if there are any
    Check(check::Check),
    /// Read one format, write another, attributes kept
    Convert(convert::Convert),
    /// Mend a mesh and say what was changed, element by element
    Repair(repair::Repair),
    /// Remove noise
    Smooth(smooth::Smooth),
    /// Draw meshes into a PNG
    Render(render::Render),
    /// Run the whole chain on a built-in scan, or on a file, into a folder with pictures
    Demo(demo::Demo),
}
