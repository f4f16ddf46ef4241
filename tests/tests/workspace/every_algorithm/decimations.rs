//! The lines of the table for decimation.

use dgp_mesh::{
    EdgeSet, HalfedgeId, Mesh, Progress, VertexSet,
    measure::{bounding_box, edge_length_range},
};
use dgp_remesh::{
    AdaptiveOptions, BlueNoiseOptions, CollapseCost, CurvatureCost, DecimationOptions, FillOptions,
    LengthCost, Memory, Order, Patch, Placement, PoissonOptions, ProgressiveMesh, QuadricCost,
    QuadricOptions, RemeshOptions, Rims, SampleNormal, Target, VoronoiOptions, VoronoiPlacement,
    decimate, decimate_quadric, fill_holes, remesh_adaptive, remesh_isotropic, sample_attributes,
    sample_blue_noise, sample_normals, sample_poisson_disk, sample_stratified, sample_uniform,
    seam_edges, sharp_edges, triangle_quality, voronoi_remesh,
};

use super::{
    outcome::Outcome,
    table::{Algorithm, changed, made, mesh, set},
};

pub(crate) fn decimations() -> Vec<Algorithm> {
    vec![
        mesh("decimate_quadric", |m, p| quadric(m, &QuadricOptions::default(), p)),
        mesh("decimate_quadric at ends", |m, p| {
            let options =
                QuadricOptions { placement: Placement::Ends, ..QuadricOptions::default() };
            quadric(m, &options, p)
        }),
        mesh("decimate_quadric with features and memory", |m, p| {
            let options = QuadricOptions {
                feature_angle: 0.5,
                memory: Memory::Blend(0.1),
                ..QuadricOptions::default()
            };
            quadric(m, &options, p)
        }),
        mesh("decimate_quadric, fast", |m, p| quadric(m, &QuadricOptions::fast(), p)),
        mesh("decimate_quadric in passes, polished", |m, p| {
            let options =
                QuadricOptions { order: Order::Passes, polish: 2, ..QuadricOptions::default() };
            quadric(m, &options, p)
        }),
        mesh("decimate_quadric with data", |m, p| {
            quadric(m, &QuadricOptions { attribute_weight: 0.1, ..QuadricOptions::default() }, p)
        }),
        mesh("decimate by length", |m, p| any(m, &mut LengthCost, p)),
        mesh("decimate by curvature", |m, p| any(m, &mut CurvatureCost, p)),
        mesh("decimate by quadrics", |m, p| any(m, &mut QuadricCost::new(m, 1.0), p)),
        mesh("decimate by probabilistic quadrics", |m, p| {
            any(m, &mut QuadricCost::probabilistic(m, 0.01), p)
        }),
        mesh("decimate by height", |m, p| {
            any(m, &mut |m: &Mesh, h: HalfedgeId| m.position(m.from(h)).z, p)
        }),
        mesh("decimate within a distance", within),
        mesh("ProgressiveMesh", |m, p| {
            let options = QuadricOptions::default();
            let levels = ProgressiveMesh::new(m, Target::Faces(10), &options, p);
            Outcome::of(&levels.map(|levels| levels.to_bytes()))
        }),
        mesh("fill_holes", |m, p| filled(m, Patch::Cover, p)),
        mesh("fill_holes refined", |m, p| filled(m, Patch::Refined, p)),
        mesh("fill_holes fair", |m, p| filled(m, Patch::Fair, p)),
        set("sample_uniform", |s, p| {
            Outcome::of(&sample_uniform(s, 300, 1, p).map(|samples| {
                let normals = sample_normals(s, &samples, SampleNormal::Smooth);
                (sample_attributes(s, &samples), normals, samples)
            }))
        }),
        set("sample_stratified", |s, p| Outcome::of(&sample_stratified(s, 300, 1, p))),
        set("sample_blue_noise", |s, p| {
            Outcome::of(&sample_blue_noise(s, 100, &BlueNoiseOptions::default(), p))
        }),
        set("sample_poisson_disk", |s, p| {
            let size = bounding_box(s).map_or(1.0, |bounds| bounds.diagonal());
            Outcome::of(&sample_poisson_disk(s, 0.1 * size, &PoissonOptions::default(), p))
        }),
        mesh("voronoi_remesh", |m, p| made(voronoi_remesh(m, 60, &VoronoiOptions::default(), p))),
        mesh("voronoi_remesh by curvature", |m, p| {
            let options = VoronoiOptions {
                gradation: 1.5,
                placement: VoronoiPlacement::Sharp,
                ..VoronoiOptions::default()
            };
            made(voronoi_remesh(m, 60, &options, p))
        }),
        mesh("remesh_isotropic", |m, p| remeshed(m, &RemeshOptions::default(), p)),
        mesh("remesh_isotropic with kept rims", |m, p| {
            let options =
                RemeshOptions { rims: Rims::Kept, iterations: 3, ..RemeshOptions::default() };
            remeshed(m, &options, p)
        }),
        mesh("remesh_adaptive", |m, p| {
            let tolerance = 0.02 * bounding_box(m).map_or(0.0, |bounds| bounds.diagonal());
            let remesh = RemeshOptions { iterations: 4, ..RemeshOptions::default() };
            let options = AdaptiveOptions { remesh, corrections: 1, ..AdaptiveOptions::default() };
            let kept = (&VertexSet::new(), &sharp_edges(m, 1.0));
            changed(m, |m| remesh_adaptive(m, tolerance, kept, &options, p))
        }),
        mesh("triangle_quality", |m, _| Outcome::of(&triangle_quality(m))),
        mesh("sharp_edges, seam_edges", |m, _| Outcome::of(&(sharp_edges(m, 0.5), seam_edges(m)))),
    ]
}

fn quadric(input: &Mesh, options: &QuadricOptions, progress: Progress<'_>) -> Outcome {
    let target = Target::Faces(input.face_count() / 3);
    changed(input, |m| decimate_quadric(m, target, &VertexSet::new(), options, progress))
}

fn remeshed(input: &Mesh, options: &RemeshOptions, progress: Progress<'_>) -> Outcome {
    let mean = edge_length_range(input).map_or(0.0, |lengths| lengths.mean);
    let kept = (&VertexSet::new(), &sharp_edges(input, 1.0));
    changed(input, |m| remesh_isotropic(m, 1.2 * mean, kept, options, progress))
}

fn filled(input: &Mesh, patch: Patch, progress: Progress<'_>) -> Outcome {
    let options = FillOptions { patch, ..FillOptions::default() };
    changed(input, |m| fill_holes(m, &options, progress))
}

fn any(input: &Mesh, cost: &mut impl CollapseCost, progress: Progress<'_>) -> Outcome {
    let target = Target::Vertices(input.vertex_count() / 3);
    let kept = (&VertexSet::new(), &sharp_edges(input, 1.0));
    let options = DecimationOptions { least_shape: 0.1, ..DecimationOptions::default() };
    changed(input, |m| decimate(m, target, cost, kept, &options, progress))
}

fn within(input: &Mesh, progress: Progress<'_>) -> Outcome {
    let max_distance = 0.01 * bounding_box(input).map_or(0.0, |bounds| bounds.diagonal());
    let options = DecimationOptions { max_distance, ..DecimationOptions::default() };
    let kept = (&VertexSet::new(), &EdgeSet::new());
    changed(input, |m| decimate(m, Target::Faces(0), &mut LengthCost, kept, &options, progress))
}
