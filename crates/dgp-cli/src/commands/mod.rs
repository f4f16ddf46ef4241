//! The commands, one a file.

mod before_after;
mod cage;
mod check;
mod compare;
mod completions;
mod compress;
mod convert;
mod correspond;
mod crease;
mod curvature;
mod decimate;
mod demo;
mod distance;
mod edit;
mod evaluate;
mod fill;
mod geodesic;
mod heat;
mod info;
mod laplacian;
mod manual;
mod param;
mod partition;
mod progressive;
mod remesh;
mod render;
mod repair;
mod sample;
mod scalars;
mod shape;
mod smooth;
mod solve;
mod spectrum;
mod stencils;
mod subdivide;
mod voronoi;

use std::path::Path;

use clap::Subcommand;

use crate::failure::Failure;

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
    /// Refine a coarse cage into a smooth surface, with creases
    Subdivide(subdivide::Subdivide),
    /// Points, tangents and normals of a subdivision surface at any parameters
    Evaluate(evaluate::Evaluate),
    /// Subdivision as a matrix: written, transposed, applied to poses
    Stencils(stencils::Stencils),
    /// Have fewer faces for the same shape
    Decimate(decimate::Decimate),
    /// Have triangles nearly equilateral, of one size or as fine as the shape needs
    Remesh(remesh::Remesh),
    /// Close holes: with few triangles, with small ones, or smoothly
    Fill(fill::Fill),
    /// Keep all levels of detail of a mesh in one file, or take one out
    Progressive(progressive::Progressive),
    /// Lay a surface out in the plane, and say what that distorts
    Param(param::Param),
    /// Spread vertices evenly over a surface: centroidal Voronoi remeshing
    Voronoi(voronoi::Voronoi),
    /// Points on a surface, at random, in strata, or at a distance from each other
    Sample(sample::Sample),
    /// Flip, split, collapse, add and remove single elements
    Edit(edit::Edit),
    /// Distances from vertices along edges, and the shortest path between two
    Geodesic(geodesic::Geodesic),
    /// Gaussian, mean and principal curvatures at the vertices
    Curvature(curvature::Curvature),
    /// The matrices of a Laplacian and its masses, checked and written
    Laplacian(laplacian::Laplacian),
    /// The lowest eigenvalues and eigenfunctions of a Laplacian
    Spectrum(spectrum::Spectrum),
    /// Cut a surface into parts where little holds them together
    Partition(partition::Partition),
    /// Keep the first waves of a shape; what that costs and loses
    Compress(compress::Compress),
    /// Heat that spreads from vertices, or the heat kernel signature of all
    Heat(heat::Heat),
    /// Which point of one shape is which of another
    Correspond(correspond::Correspond),
    /// How far two surfaces are apart: Hausdorff distance with sure bounds, mean, Chamfer
    Compare(compare::Compare),
    /// How far points are from a surface, and whether they are inside
    Distance(distance::Distance),
    /// Solve a sparse system, or find the smallest eigenvalues of a matrix
    Solve(solve::Solve),
    /// Make a shape: regular solids, Goldberg polyhedra, spheres, tori, …
    Shape(shape::Shape),
    /// Draw meshes into a PNG
    Render(render::Render),
    /// Run the whole chain on a built-in scan, or on a file, into a folder with pictures
    Demo(demo::Demo),
    /// Print what a shell needs to complete commands and options
    Completions(completions::Completions),
    /// Print the manual page, or write one for each command into a folder
    Manual(manual::Manual),
}

/// Creates a folder to write into, if it is not there.
fn create_folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path)
        .map_err(|source| Failure::Folder { path: path.to_owned(), source })
}
