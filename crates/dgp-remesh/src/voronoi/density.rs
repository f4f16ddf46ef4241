//! How densely vertices are wanted, by curvature.
//!
//! ```text
//! ρ = c^γ,   c = √(κ₁² + κ₂²), smoothed, and between a hundredth of a high value and that value
//! ```

use dgp_mesh::{Mesh, VertexId, curvature::principal_curvatures};

use crate::Error;

/// The part of the vertices that bend less than the high value.
const HIGH: f64 = 0.99;

/// The high value over the low one.
const RANGE: f64 = 100.0;

/// How often values are replaced by means with their neighbors: noise has curvature too.
const SMOOTHED: usize = 3;

/// ρ at each vertex, at most 1.
pub(super) fn density(mesh: &Mesh, gradation: f64) -> Result<Vec<f64>, Error> {
    if gradation == 0.0 {
        return Ok(vec![1.0; mesh.vertex_count()]);
    }
    let curvatures = principal_curvatures(mesh)?;
    let mut bend = curvatures.map(|k| k.max.hypot(k.min));
    for _ in 0..SMOOTHED {
        bend = mesh.map_vertices(|v: VertexId| {
            let (sum, count) = mesh
                .vertex_neighbors(v)
                .fold((bend[v], 1.0), |(sum, count), w| (sum + bend[w], count + 1.0));
            sum / count
        });
    }
    let mut sorted = bend.values().to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let high = sorted.get((HIGH * sorted.len() as f64) as usize).copied().unwrap_or(0.0);
    if !(high > 0.0 && high.is_finite()) {
        return Ok(vec![1.0; mesh.vertex_count()]);
    }
    let part = |c: &f64| (c / high).clamp(1.0 / RANGE, 1.0).powf(gradation);
    Ok(bend.values().iter().map(part).collect())
}
