//! The lines of the table for repair of surfaces.

use dgp_mesh::{Mesh, Progress, RepairOptions, Tolerance, defects, weld_as, weld_exact};
use dgp_remesh::{
    FillOptions, IntersectionOptions, LeastComponent, OpenSurfaces, Patch, SliverOptions,
    SurfaceRepairOptions, cap_faces, drop_small_components, hidden_fronts, needle_faces,
    remove_self_intersections, remove_slivers, repair_surface, stitch_rims,
};

use super::{
    outcome::Outcome,
    table::{Algorithm, changed, made, mesh, set},
};

pub(crate) fn repairs() -> Vec<Algorithm> {
    vec![
        set("repair_surface", |s, p| made(repair_surface(s, &SurfaceRepairOptions::default(), p))),
        set("repair_surface with everything", |s, p| made(repair_surface(s, &everything(), p))),
        set("self-intersections of defects", |s, p| {
            let mut report = defects(s, p.part(0.0, 0.5)).unwrap_or_default();
            let result = report.add_self_intersections(s, p.part(0.5, 1.0));
            Outcome::of(&result.map(|()| report))
        }),
        set("weld_as", |s, _| Outcome::of(&weld_as(s, weld_exact(s.positions().values())))),
        mesh("stitch_rims", |m, p| changed(m, |m| stitch_rims(m, Tolerance::OfDiagonal(0.01), p))),
        mesh("remove_slivers", |m, p| {
            let options = SliverOptions { needle_ratio: 3.0, cap_angle: 2.2, max_move: 0.1 };
            changed(m, |m| remove_slivers(m, &options, p))
        }),
        mesh("needle_faces, cap_faces", |m, _| {
            Outcome::of(&(needle_faces(m, 3.0), cap_faces(m, 2.2)))
        }),
        mesh("remove_self_intersections", cut),
        mesh("drop_small_components", |m, p| {
            let least = LeastComponent { faces: 3, area: 0.1, volume: 0.1 };
            changed(m, |m| drop_small_components(m, &least, p))
        }),
        mesh("hidden_fronts", |m, p| Outcome::of(&hidden_fronts(m, p))),
    ]
}

fn everything() -> SurfaceRepairOptions {
    SurfaceRepairOptions {
        faces: RepairOptions {
            weld: Some(Tolerance::OfDiagonal(1e-6)),
            ..SurfaceRepairOptions::default().faces
        },
        components: LeastComponent { faces: 2, area: 0.01, volume: 0.01 },
        holes: Some(FillOptions { patch: Patch::Cover, ..FillOptions::default() }),
        open_surfaces: OpenSurfaces::BySight,
        ..SurfaceRepairOptions::default()
    }
}

fn cut(input: &Mesh, progress: Progress<'_>) -> Outcome {
    let options = IntersectionOptions { max_removed: 1.0, ..IntersectionOptions::default() };
    changed(input, |m| remove_self_intersections(m, &options, progress))
}
