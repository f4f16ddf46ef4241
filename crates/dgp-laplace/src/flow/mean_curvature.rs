//! Mean curvature flow: moves a surface toward smaller area, and the form of it that stays a surface.
//!
//! ```text
//! (M(x) + τ L(x)) x' = M(x) x      MeanCurvature: mass and stiffness of the surface as it is
//! (M(x) + τ L(x₀)) x' = M(x) x     Conformalized: stiffness of the surface as it was in the beginning
//! ```
//!
//! The first shrinks every surface, and thin necks to nothing in finite time; the second leads closed surfaces
//! of genus 0 to spheres, and the map to them comes near to one that keeps angles.
//!
//! - Input: a triangle mesh. Vertices of holes and those in the given set stay.
//! - Cost: a factorization per step; its analysis is done once.
//! - Guarantees: each step is implicit and stable. A round sphere stays round: r' = r/(1 + 2τ/r²).
//! - Reference: Desbrun, Meyer, Schröder and Barr, "Implicit fairing of irregular meshes using diffusion and
//!   curvature flow", SIGGRAPH 1999; Kazhdan, Solomon and Ben-Chen, "Can mean-curvature flow be modified to be
//!   non-singular?", SGP 2012.

use dgp_mesh::{
    DVec3, Mesh, Progress, VertexId, VertexMap, VertexSet,
    measure::{self, VertexArea, vertex_areas},
};

use crate::{
    Error,
    laplacian::cotangent_laplacian,
    solve::{FreeSystem, columns, points},
    unit::unit_of,
};

/// Which flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FlowKind {
    /// By the curvature of the surface as it is.
    #[default]
    MeanCurvature,
    /// By the angles the surface had in the beginning: no singularities.
    Conformalized,
}

/// What becomes of the size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FlowSize {
    /// It shrinks.
    #[default]
    Shrinks,
    /// After each step the surface is scaled about the mean of its vertices to the area it had.
    KeepsArea,
}

/// How [`mean_curvature_flow`] runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowOptions {
    /// How many steps.
    pub steps: usize,
    /// Which flow.
    pub kind: FlowKind,
    /// What becomes of the size.
    pub size: FlowSize,
}

impl Default for FlowOptions {
    fn default() -> Self {
        FlowOptions { steps: 10, kind: FlowKind::default(), size: FlowSize::default() }
    }
}

/// What [`mean_curvature_flow`] did.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct FlowReport {
    /// How many steps were done.
    pub steps: usize,
    /// How many vertices could move.
    pub free_vertices: usize,
    /// The area at the start.
    pub area_before: f64,
    /// The area in the end.
    pub area_after: f64,
    /// How far vertices moved in the last step, at most: small beside the size where the flow has come
    /// to rest.
    pub last_displacement: f64,
}

/// Flows for `options.steps` steps of `time` each, in units of length².
///
/// If cancelled, or after an error of a step, the steps done so far remain.
/// Errors: [`Error::InvalidOption`] unless the time is positive and finite, [`Error::FixedArea`] if the area
/// is to stay and vertices too, [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`], [`Error::Sparse`]
/// where triangles have degenerated, [`Error::Cancelled`].
pub fn mean_curvature_flow(
    mesh: &mut Mesh,
    fixed: &VertexSet,
    time: f64,
    options: &FlowOptions,
    progress: Progress<'_>,
) -> Result<FlowReport, Error> {
    if !(time > 0.0 && time.is_finite()) {
        return Err(Error::option("time", time, "positive and finite"));
    }
    let is_rim = |v: VertexId| mesh.is_boundary_vertex(v) && !mesh.is_isolated_vertex(v);
    let held = mesh.vertices().filter(|&v| is_rim(v) || fixed.contains(v)).count();
    if options.size == FlowSize::KeepsArea && held > 0 {
        return Err(Error::FixedArea { fixed: held });
    }
    let stays = |v: usize| {
        let v = VertexId::new(v);
        mesh.is_boundary_vertex(v) || fixed.contains(v)
    };
    let mut system = FreeSystem::new(mesh.vertex_count(), stays);
    let first = cotangent_laplacian(mesh)?;
    let area_before = measure::area(mesh);
    let mut report = FlowReport {
        steps: 0,
        free_vertices: system.free_count(),
        area_before,
        area_after: area_before,
        last_displacement: 0.0,
    };
    for step in 0..options.steps {
        let part = |x: usize| (step + x) as f64 / options.steps as f64;
        let progress = progress.part(part(0), part(1));
        progress.report(0.0)?;
        let laplacian = match options.kind {
            FlowKind::MeanCurvature if step > 0 => cotangent_laplacian(mesh)?,
            _ => first.clone(),
        };
        // At a scale at which lengths are about 1.
        let unit = unit_of(mesh.positions().values());
        let areas = vertex_areas(mesh, VertexArea::Barycentric);
        let masses: Vec<f64> = areas.values().iter().map(|area| area * unit * unit).collect();
        let matrix = laplacian.scaled(time * unit * unit).plus_diagonal(&masses)?;
        system.factor(&matrix, progress)?;
        let mut x = columns(mesh.positions().values(), unit);
        let rhs: Vec<f64> = x.iter().zip(masses.iter().cycle()).map(|(x, m)| x * m).collect();
        system.solve(&rhs, &mut x)?;
        let moved = resized(mesh, points(&x, unit).into(), area_before, options.size);
        report.last_displacement = mesh
            .vertices()
            .map(|v| (0.5 * moved[v] - 0.5 * mesh.position(v)).length() * 2.0)
            .fold(0.0, f64::max);
        mesh.set_positions(moved);
        report.steps = step + 1;
        report.area_after = measure::area(mesh);
    }
    Ok(report)
}

/// `moved`, scaled to `area` if the size is to stay.
fn resized(mesh: &Mesh, moved: VertexMap<DVec3>, area: f64, size: FlowSize) -> VertexMap<DVec3> {
    if size == FlowSize::Shrinks {
        return moved;
    }
    let mut after = mesh.clone();
    after.set_positions(moved);
    let factor = (area / measure::area(&after)).sqrt();
    let used: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_isolated_vertex(v)).collect();
    let count = used.len().max(1) as f64;
    let mean = used.iter().map(|&v| after.position(v) / count).sum::<DVec3>();
    if !(factor > 0.0 && factor.is_finite()) {
        return after.positions().clone();
    }
    let scale = |v: VertexId| {
        let p = after.position(v);
        if mesh.is_isolated_vertex(v) { p } else { mean + factor * (p - mean) }
    };
    mesh.map_vertices(scale)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use dgp_mesh::shapes;

    use super::*;

    fn flow(mesh: &mut Mesh, time: f64, options: &FlowOptions) -> FlowReport {
        mean_curvature_flow(mesh, &VertexSet::new(), time, options, Progress::NONE).unwrap()
    }

    fn radii(mesh: &Mesh) -> (f64, f64) {
        let radii = mesh.positions().map(|p| p.length());
        let least = radii.values().iter().copied().fold(f64::INFINITY, f64::min);
        (least, radii.values().iter().copied().fold(0.0, f64::max))
    }

    /// Row 11 of the oracles.
    #[test]
    fn a_sphere_shrinks_as_implicit_euler_says() {
        for (steps, expected, measured) in
            [(10, 0.783_785_4, 0.783_784_9), (40, 0.777_022_6, 0.777_022_0)]
        {
            let tau = 0.1 / steps as f64;
            let mut r: f64 = 1.0;
            for _ in 0..steps {
                r /= 1.0 + 2.0 * tau / (r * r);
            }
            assert!((r - expected).abs() < 1e-7, "the recurrence: {r}");
            for kind in [FlowKind::MeanCurvature, FlowKind::Conformalized] {
                let mut mesh = shapes::icosphere(5).unwrap();
                let report =
                    flow(&mut mesh, tau, &FlowOptions { steps, kind, ..FlowOptions::default() });
                let lengths = mesh.positions().map(|p| p.length());
                let count = lengths.len() as f64;
                let mean = lengths.values().iter().sum::<f64>() / count;
                let square: f64 = lengths.values().iter().map(|l| (l - mean).powi(2)).sum();
                assert!((mean - measured).abs() < 2e-6, "{kind:?} {steps} steps: {mean}");
                let spread = (square / count).sqrt();
                assert!(spread < 2.5e-5, "{kind:?}: spread {spread}");
                assert!(report.area_after < report.area_before);
            }
        }
    }

    /// A sphere is where the smooth flow leads; the mesh comes near to one with order 2.
    #[test]
    fn the_conformalized_flow_rounds_a_dumbbell() {
        let mut errors = Vec::new();
        for n in [8, 16, 32] {
            let mut round = shapes::dumbbell(0.3, 2 * n, 3 * n).unwrap();
            let size = FlowSize::KeepsArea;
            let options = FlowOptions { steps: 60, kind: FlowKind::Conformalized, size };
            let report = flow(&mut round, 0.5, &options);
            let radii = round.positions().map(|p| p.length());
            let areas = vertex_areas(&round, VertexArea::Barycentric);
            let total: f64 = areas.values().iter().sum();
            let mean = radii.iter().map(|(v, r)| areas[v] * r).sum::<f64>() / total;
            let square = radii.iter().map(|(v, r)| areas[v] * (r - mean).powi(2)).sum::<f64>();
            errors.push((square / total).sqrt() / mean);
            assert!((report.area_after / report.area_before - 1.0).abs() < 1e-12);
            // So near to rest that the distance to it does not count beside the error.
            assert!(report.last_displacement < 0.01 * errors[errors.len() - 1]);
        }
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.3), "{orders:?} {errors:?}");
    }

    #[test]
    fn what_is_flat_and_what_is_fixed_stays() {
        let mut disk = shapes::disk(8).unwrap();
        let before = disk.clone();
        let _ = flow(&mut disk, 0.1, &FlowOptions::default());
        for v in disk.vertices() {
            assert!(disk.position(v).distance(before.position(v)) < 1e-12, "{v}");
            assert!(!disk.is_boundary_vertex(v) || disk.position(v) == before.position(v));
        }
        let mut sphere = shapes::icosphere(3).unwrap();
        let fixed: VertexSet = [VertexId::new(9)].into_iter().collect();
        let result =
            mean_curvature_flow(&mut sphere, &fixed, 0.01, &FlowOptions::default(), Progress::NONE);
        assert_eq!(result.unwrap().free_vertices, sphere.vertex_count() - 1);
        assert_eq!(
            sphere.position(VertexId::new(9)),
            shapes::icosphere(3).unwrap().position(VertexId::new(9))
        );
        let keeps = FlowOptions { size: FlowSize::KeepsArea, ..FlowOptions::default() };
        let result = mean_curvature_flow(&mut sphere, &fixed, 0.01, &keeps, Progress::NONE);
        assert_eq!(result, Err(Error::FixedArea { fixed: 1 }));
    }

    /// A soap film between two rings: row 21 of the oracles.
    #[test]
    fn a_cylinder_becomes_a_catenoid() {
        for (height, area, neck) in [(0.5, 3.108_112, 0.967_521), (1.0, 5.991_797, 0.848_338)] {
            let mut found = Vec::new();
            for n in [8, 16, 32] {
                let rings = (n as f64 * height) as usize;
                let mut mesh = shapes::cylinder(1.0, height, 2 * n, rings).unwrap();
                let mut film = || {
                    let options = FlowOptions { steps: 20, ..FlowOptions::default() };
                    let report = flow(&mut mesh, 1.0, &options);
                    let radii = mesh.positions().values().iter().map(|p| p.x.hypot(p.y));
                    [report.area_after, radii.fold(2.0, f64::min)]
                };
                let (before, after) = (film(), film());
                for (k, exact) in [area, neck].into_iter().enumerate() {
                    let error = (after[k] - exact).abs();
                    // At rest, but for vertices that slide within the film.
                    let rest = (after[k] - before[k]).abs();
                    assert!(rest < 0.01 * error, "{height} {n}: {before:?} {after:?}");
                }
                found.push(after);
            }
            for (k, exact) in [area, neck].into_iter().enumerate() {
                let [_, a, b] = [0, 1, 2].map(|i| found[i][k]);
                let errors = [0, 1, 2].map(|i| (found[i][k] - exact).abs());
                let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
                assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "{found:?}");
                // Without its part of order 2 the error is that of order 4.
                let extrapolated = (4.0 * b - a) / 3.0;
                assert!((extrapolated - exact).abs() < 0.05 * errors[2], "{extrapolated}");
            }
        }
    }

    #[test]
    fn scaled_by_a_power_of_two_it_is_the_same() {
        let options = FlowOptions { steps: 3, ..FlowOptions::default() };
        let start = shapes::blob(3).unwrap();
        let mut plain = start.clone();
        let _ = flow(&mut plain, 0.01, &options);
        for k in [-300, 5, 300] {
            let s = 2_f64.powi(k);
            let mut scaled = start.clone();
            scaled.set_positions(start.positions().map(|&p| s * p));
            let _ = flow(&mut scaled, 0.01 * s * s, &options);
            assert!(plain.vertices().all(|v| scaled.position(v) == s * plain.position(v)), "2^{k}");
        }
    }

    #[test]
    fn a_cancelled_run_keeps_its_steps() {
        let mut mesh = shapes::icosphere(2).unwrap();
        let stop =
            |x: f64| if x > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let options = FlowOptions { steps: 4, ..FlowOptions::default() };
        let none = VertexSet::new();
        let result = mean_curvature_flow(&mut mesh, &none, 0.01, &options, Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))));
        assert!(radii(&mesh).1 < 0.999);
    }
}
