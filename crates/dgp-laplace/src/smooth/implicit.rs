//! Implicit smoothing: a step of any size at once, by solving for where it leads.
//!
//! ```text
//! (S + λ L) x' = S x
//!
//! Uniform      S = valence                  L uniform: neighbors count the same
//! Cotangent    S = mass / (mean edge)²      L cotangent: heat flow for the time λ (mean edge)²
//! ```
//!
//! A wave of frequency k is divided by 1 + λk: strongly smoothed, never amplified, however large λ is. Matrix and
//! factor are those of the mesh at the start and serve all iterations.
//!
//! - Input: any mesh for uniform weights, triangles for cotangents.
//! - Cost: one factorization, then a solve for the three coordinates per iteration.
//! - Guarantees: stable for every λ. What is flat stays flat, with cotangent weights vertex by vertex.
//! - Reference: Desbrun, Meyer, Schröder and Barr, "Implicit fairing of irregular meshes using diffusion and
//!   curvature flow", SIGGRAPH 1999.
//! - Departs from it: vertices on the rims of holes stay, or are smoothed like others. Weights are not
//!   made anew between iterations; [`mean_curvature_flow`](crate::flow::mean_curvature_flow) does that.

use dgp_mesh::{
    Mesh, Progress, VertexId, VertexSet,
    measure::{edge_length_range, require_triangles},
};

use super::{
    Boundary, SmoothReport, Volume,
    run::{Task, run},
};
use crate::{
    Error,
    laplacian::{cotangent_laplacian, uniform_laplacian, vertex_masses},
    solve::{FreeSystem, columns, points},
};

/// What neighbors count for in [`implicit`] smoothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ImplicitWeight {
    /// All the same; evens out the spacing too.
    Uniform,
    /// Cotangents: along the normal, spacing stays.
    #[default]
    Cotangent,
}

/// How strongly [`implicit`] smooths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitOptions {
    /// How often to smooth.
    pub iterations: usize,
    /// λ, above 0: with cotangent weights the time in squares of the mean edge length. Bumps up to about
    /// 2π√λ edges wide fade.
    pub lambda: f64,
    /// What neighbors count for.
    pub weight: ImplicitWeight,
    /// What vertices at the rim of a hole do: `Fixed` or `Free`; `Curve` is refused.
    pub boundary: Boundary,
    /// What becomes of the enclosed volume.
    pub volume: Volume,
}

impl Default for ImplicitOptions {
    fn default() -> Self {
        ImplicitOptions {
            iterations: 1,
            lambda: 10.0,
            weight: ImplicitWeight::default(),
            boundary: Boundary::default(),
            volume: Volume::default(),
        }
    }
}

/// Smooths `mesh`, but for the vertices of `fixed`, by implicit steps.
///
/// If cancelled, the iterations done so far remain, and the volume is what they made of it. Errors:
/// [`Error::InvalidOption`], [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`], [`Error::Sparse`], and
/// those of the other methods.
pub fn implicit(
    mesh: &mut Mesh,
    fixed: &VertexSet,
    options: &ImplicitOptions,
    progress: Progress<'_>,
) -> Result<SmoothReport, Error> {
    let ImplicitOptions { iterations, lambda, weight, boundary, volume } = *options;
    if !(lambda > 0.0 && lambda.is_finite()) {
        return Err(Error::option("lambda", lambda, "positive and finite"));
    }
    if boundary == Boundary::Curve {
        return Err(Error::option(
            "boundary",
            1.0,
            "fixed or free: an implicit step has no curves",
        ));
    }
    if weight == ImplicitWeight::Cotangent {
        require_triangles(mesh)?;
    }
    let (laplacian, scales) = match weight {
        ImplicitWeight::Uniform => {
            let laplacian = uniform_laplacian(mesh)?;
            let valences = laplacian.diagonal();
            (laplacian, valences)
        }
        ImplicitWeight::Cotangent => (cotangent_laplacian(mesh)?, relative_masses(mesh)),
    };
    let matrix = laplacian.scaled(lambda).plus_diagonal(&scales)?;
    let diagonal = matrix.diagonal();
    let stays = |i: usize| {
        let v = VertexId::new(i);
        let is_held = boundary == Boundary::Fixed && mesh.is_boundary_vertex(v);
        fixed.contains(v) || is_held || diagonal[i] == 0.0
    };
    let mut system = FreeSystem::new(mesh.vertex_count(), stays);
    system.factor(&matrix, progress.part(0.0, 0.5))?;
    let mut failed = Ok(());
    let progress = progress.part(0.5, 1.0);
    let task = Task { fixed, boundary, volume, iterations, progress };
    let report = run(mesh, &task, |_, positions, _| {
        let mut x = columns(positions, 1.0);
        let rhs: Vec<f64> = x.iter().zip(scales.iter().cycle()).map(|(x, s)| x * s).collect();
        match system.solve(&rhs, &mut x) {
            Ok(()) => *positions = points(&x, 1.0),
            Err(error) => failed = Err(error),
        }
    })?;
    failed.map(|()| report)
}

/// Masses in squares of the mean edge length.
fn relative_masses(mesh: &Mesh) -> Vec<f64> {
    let mean = edge_length_range(mesh).map_or(0.0, |range| range.mean);
    let relative = |mass: &f64| if mean > 0.0 { mass / mean / mean } else { 0.0 };
    vertex_masses(mesh).values().iter().map(relative).collect()
}
