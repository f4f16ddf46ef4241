//! The lines of the table for subdivision.

use dgp_mesh::{
    DVec3, FaceId, Mesh, Progress,
    measure::{NormalWeight, bounding_box, vertex_normals},
};
use dgp_subdiv::{
    AdaptiveOptions, ButterflyRule, FaceVarying, LoopWeights, PhongOptions, RefinementOptions,
    RefinementPlan, Scheme, Sharpness, SubdivisionOptions, Surface, phong_tessellate,
    refine_adaptively, refine_to_tolerance, subdivide,
};

use super::{
    outcome::Outcome,
    table::{Algorithm, made, mesh},
};

pub(crate) fn subdivisions() -> Vec<Algorithm> {
    let mut all = schemes();
    all.extend(surfaces());
    all
}

fn refinement(scheme: Scheme, levels: usize) -> RefinementOptions {
    RefinementOptions { scheme, levels, ..RefinementOptions::default() }
}

/// A crease that wears off after every third edge, where the scheme has a rule for it.
fn creased(mesh: &Mesh, scheme: Scheme) -> Sharpness {
    let mut sharpness = Sharpness::new();
    if scheme.has_creases() {
        for e in mesh.edges().step_by(3) {
            sharpness.set_edge(e, 1.5);
        }
    }
    sharpness
}

fn refined(mesh: &Mesh, scheme: Scheme, surface: Surface, progress: Progress<'_>) -> Outcome {
    let face_varying = FaceVarying::Smooth;
    let options = SubdivisionOptions { refinement: refinement(scheme, 1), surface, face_varying };
    made(subdivide(mesh, &creased(mesh, scheme), &options, progress))
}

fn schemes() -> Vec<Algorithm> {
    vec![
        mesh("subdivide, Loop", |m, p| {
            refined(m, Scheme::Loop(LoopWeights::Original), Surface::Refined, p)
        }),
        mesh("subdivide, Loop by Warren", |m, p| {
            refined(m, Scheme::Loop(LoopWeights::Warren), Surface::Refined, p)
        }),
        mesh("subdivide, Loop without special case", |m, p| {
            refined(m, Scheme::Loop(LoopWeights::Simple), Surface::Refined, p)
        }),
        mesh("subdivide, Catmull–Clark", |m, p| {
            refined(m, Scheme::CatmullClark, Surface::Refined, p)
        }),
        mesh("subdivide, bilinear", |m, p| refined(m, Scheme::Bilinear, Surface::Refined, p)),
        mesh("subdivide, √3", |m, p| refined(m, Scheme::Sqrt3, Surface::Refined, p)),
        mesh("subdivide, Doo–Sabin", |m, p| refined(m, Scheme::DooSabin, Surface::Refined, p)),
        mesh("subdivide, butterfly", |m, p| {
            refined(m, Scheme::Butterfly(ButterflyRule::Original), Surface::Refined, p)
        }),
        mesh("subdivide, modified butterfly", |m, p| {
            refined(m, Scheme::Butterfly(ButterflyRule::Modified), Surface::Refined, p)
        }),
    ]
}

fn adaptive() -> AdaptiveOptions {
    let refinement = refinement(Scheme::CatmullClark, 2);
    AdaptiveOptions { refinement, face_varying: FaceVarying::SharpEnds }
}

fn surfaces() -> Vec<Algorithm> {
    vec![
        mesh("subdivide to the limit, Loop", |m, p| {
            refined(m, Scheme::Loop(LoopWeights::Original), Surface::LimitAndNormals, p)
        }),
        mesh("subdivide to the limit, Catmull–Clark", |m, p| {
            refined(m, Scheme::CatmullClark, Surface::LimitAndNormals, p)
        }),
        mesh("RefinementPlan", |m, p| {
            let options = refinement(Scheme::CatmullClark, 1);
            let plan = RefinementPlan::new(
                m,
                &creased(m, Scheme::CatmullClark),
                &options,
                p.part(0.0, 0.5),
            );
            let found = plan.and_then(|plan| {
                let cage = m.positions().values();
                let refined = plan.refine(cage)?;
                let parts = (0..plan.counts(1).faces as usize).step_by(7).map(FaceId::new);
                let points = parts.map(|f| plan.evaluate(&refined, f, [0.3, 0.4]));
                let points = points.collect::<Result<Vec<_>, _>>()?;
                Ok((plan.stencils()?.apply(cage)?, plan.limit(&refined)?, points))
            });
            Outcome::of(&found)
        }),
        mesh("phong_tessellate", |m, p| {
            let normals = vertex_normals(m, NormalWeight::Angle);
            let options = PhongOptions { segments: 2, ..PhongOptions::default() };
            made(phong_tessellate(m, &normals, &options, p).map(|m| (m, ())))
        }),
        mesh("refine_adaptively", |m, p| {
            let options = adaptive();
            let half = bounding_box(m).map_or(0.0, |b| b.center().x);
            let asked = |_: usize, corners: &[DVec3]| corners.iter().any(|p| p.x < half);
            let smooth = Sharpness::new();
            made(refine_adaptively(m, &smooth, &options, asked, p).map(|m| (m, ())))
        }),
        mesh("refine_to_tolerance", |m, p| {
            let options = adaptive();
            let tolerance = bounding_box(m).map_or(1.0, |b| 0.01 * b.diagonal());
            made(refine_to_tolerance(m, &Sharpness::new(), &options, tolerance, p))
        }),
    ]
}
