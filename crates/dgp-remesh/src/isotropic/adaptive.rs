//! Remeshing as fine as the shape needs: edges are short where the surface bends.
//!
//! Lengths come from curvature and the tolerance (see [`sizing`](super::sizing)). Then the distance to the input
//! is measured; where it is too large, edges become shorter, and once more.
//!
//! - Input: triangles, with holes perhaps.
//! - Cost: as for one length, and the Hausdorff distance for each correction.
//! - Guarantees: the report says between which bounds the Hausdorff distance to the input surely lies.
//! - Reference: Dunyach, Vanderhaeghe, Barthe, Botsch, "Adaptive remeshing for real-time mesh deformation",
//!   Eurographics 2013 (short papers).
//! - Departs from it: the error is measured, and lengths corrected until it is within the tolerance.

use dgp_mesh::{
    DVec3, EdgeSet, Mesh, Progress, VertexSet,
    measure::bounding_box,
    parallel,
    spatial::{ClosestPoint, HausdorffOptions, TriangleTree, hausdorff},
};

use super::{
    Distance, FEASIBLE, RemeshReport, Run,
    options::{AdaptiveOptions, in_range},
    sizing::{Sizing, Wanted},
};
use crate::Error;

/// Iterations after a correction.
const AGAIN: usize = 4;
/// Lengths are made for this part of the tolerance.
const AIM: f64 = 0.8;
/// The least factor by which a correction shortens.
const LEAST: f64 = 0.5;
/// How far the bounds of the distance may be apart, in units of the tolerance.
const SLACK: f64 = 0.05;

/// Makes the triangles of `mesh` nearly equilateral and as large as a distance of `tolerance` to the input allows,
/// in the unit of the coordinates.
///
/// All else is as in [`remesh_isotropic`](crate::remesh_isotropic). The report's `distance` tells whether the
/// tolerance was met; where corners and fixed vertices contradict it, or `shortest` does, it may not be.
///
/// ```
/// use dgp_mesh::{EdgeSet, Progress, VertexSet, shapes};
/// use dgp_remesh::{AdaptiveOptions, remesh_adaptive};
///
/// let mut mesh = shapes::torus(1.0, 0.2, 200, 60)?;
/// let none = (VertexSet::new(), EdgeSet::new());
/// let options = AdaptiveOptions::default();
/// let report = remesh_adaptive(&mut mesh, 0.01, (&none.0, &none.1), &options, Progress::NONE)?;
/// assert!(report.distance.is_some_and(|distance| distance.upper <= 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Errors: those of [`remesh_isotropic`](crate::remesh_isotropic), of `tolerance` instead of `length`.
pub fn remesh_adaptive(
    mesh: &mut Mesh,
    tolerance: f64,
    kept: (&VertexSet, &EdgeSet),
    options: &AdaptiveOptions,
    progress: Progress<'_>,
) -> Result<RemeshReport, Error> {
    options.check()?;
    in_range(
        "tolerance",
        tolerance,
        tolerance > 0.0 && tolerance.is_finite(),
        "positive and finite",
    )?;
    let diagonal = bounding_box(mesh).map_or(0.0, |bounds| bounds.diagonal());
    let mut run = Run::new(mesh, kept, &options.remesh, 4.0 * tolerance, progress.part(0.0, 0.05))?;
    let scaled = tolerance * run.down;
    let shortest = options.shortest * scaled;
    in_range("tolerance", tolerance, shortest > 0.0, "not so small beside the mesh")?;
    let wanted = Wanted {
        tolerance: AIM * scaled,
        shortest,
        longest: (options.longest * diagonal * run.down).max(shortest),
        gradation: options.gradation,
    };
    run.sizing = Sizing::from_curvature(mesh, &run.surface, &run.lines, &wanted)?;
    run.take_sizes();
    in_range("tolerance", tolerance, run.surface.is_feasible(), FEASIBLE)?;
    run.iterate(options.remesh.iterations, progress.part(0.05, 0.5))?;
    let mut corrections = 0;
    let distance = loop {
        let part =
            |x: f64| 0.5 + 0.45 * (corrections as f64 + x) / (options.corrections + 1) as f64;
        let found = run.measure(mesh, scaled, progress.part(part(0.0), part(0.5)))?;
        let is_within_tolerance = found.upper <= scaled;
        let may_go_on = corrections < options.corrections && !found.factors.is_empty();
        if is_within_tolerance
            || !may_go_on
            || !run.sizing.shorten(mesh, &run.ground.positions, &found.factors, wanted.gradation)
        {
            let [lower, upper] = [found.lower, found.upper].map(|x| x / run.down);
            break Distance { lower, upper, is_within_tolerance, corrections };
        }
        run.take_sizes();
        run.iterate(AGAIN, progress.part(part(0.5), part(1.0)))?;
        corrections += 1;
    };
    let mut report = run.finish(mesh, progress.part(0.95, 1.0))?;
    report.distance = Some(distance);
    Ok(report)
}

/// What is known of the distance, and how much shorter edges should be at each vertex of the input.
struct Found {
    lower: f64,
    upper: f64,
    /// Empty if there is nothing to compare.
    factors: Vec<f64>,
}

impl Run {
    /// Looks up the length wanted at each vertex.
    pub(super) fn take_sizes(&mut self) {
        let (ground, sizing) = (&self.ground, &self.sizing);
        let surface = &self.surface;
        let sizes = parallel::map(surface.vertices.len(), |v: dgp_mesh::VertexId| {
            let vertex = &surface.vertices[v.index()];
            let mut near = vertex.near;
            let found = ground.tree.closest_point_near(surface.positions[v.index()], &mut near);
            found.map_or(vertex.size, |found| sizing.at(&found))
        });
        for (vertex, size) in self.surface.vertices.iter_mut().zip(sizes.into_values()) {
            vertex.size = size;
        }
    }

    /// Compares what there is with the input.
    fn measure(
        &self,
        input: &Mesh,
        tolerance: f64,
        progress: Progress<'_>,
    ) -> Result<Found, Error> {
        let result = self.surface.packed(1.0)?.mesh;
        let tree = TriangleTree::new(&result, Progress::NONE)?;
        let ground = &self.ground.tree;
        let (Some(one), Some(other)) = (tree.bounding_box(), ground.bounding_box()) else {
            return Ok(Found { lower: 0.0, upper: 0.0, factors: Vec::new() });
        };
        let diagonal = one.union(&other).diagonal();
        if !(diagonal > 0.0) {
            return Ok(Found { lower: 0.0, upper: 0.0, factors: Vec::new() });
        }
        let mut factors = vec![1.0_f64; input.vertex_count()];
        let mut note = |place: &ClosestPoint, distance: f64| {
            if distance > AIM * tolerance {
                // Distances go with squares of lengths.
                let factor = (AIM * tolerance / distance).sqrt().max(LEAST);
                for v in place.vertices {
                    factors[v.index()] = factors[v.index()].min(factor);
                }
            }
        };
        let places = |mesh: &Mesh, positions: &[DVec3]| -> Vec<DVec3> {
            let at = |v: dgp_mesh::VertexId| positions[v.index()];
            let middles = mesh.edges().map(|e| {
                let [a, b] = mesh.edge_vertices(e);
                0.5 * at(a) + 0.5 * at(b)
            });
            let centers = mesh.faces().filter_map(|f| mesh.triangle(f)).map(|corners| {
                let [a, b, c] = corners.map(at);
                (a + b + c) / 3.0
            });
            middles.chain(centers).collect()
        };
        // From the result to the input …
        let here = places(&result, result.positions().values());
        for found in ground.closest_points(&here, progress.part(0.0, 0.2))? {
            note(&found, found.distance);
        }
        // … and back.
        let mut there = places(input, &self.ground.positions);
        there.extend_from_slice(&self.ground.positions);
        let back = tree.closest_points(&there, progress.part(0.2, 0.4))?;
        let far: Vec<_> =
            back.iter().zip(&there).filter(|(found, _)| found.distance > AIM * tolerance).collect();
        for (found, &place) in far {
            if let Some(own) = ground.closest_point(place) {
                note(&own, found.distance);
            }
        }
        let options = HausdorffOptions {
            tolerance: SLACK * tolerance / diagonal,
            ..HausdorffOptions::default()
        };
        let bounds = hausdorff(&tree, ground, &options, progress.part(0.4, 1.0))?;
        for (bounds, is_on_input) in [(bounds.forward, false), (bounds.backward, true)] {
            let place = if is_on_input { bounds.point } else { bounds.nearest };
            if bounds.upper > tolerance
                && let Some(own) = ground.closest_point(place)
            {
                note(&own, bounds.upper);
            }
        }
        Ok(Found { lower: bounds.lower(), upper: bounds.upper(), factors })
    }
}
