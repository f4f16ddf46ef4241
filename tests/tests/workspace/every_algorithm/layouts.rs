//! The lines of the table for maps to the plane.

use dgp_mesh::{Mesh, Progress};
use dgp_param::{
    Outline, Weights, boundary_crossings, convex_boundary, disk_boundary, distortion,
    face_distortions, least_squares_conformal, map_to_boundary,
};

use super::{
    outcome::Outcome,
    table::{Algorithm, mesh},
};

pub(crate) fn layouts() -> Vec<Algorithm> {
    vec![
        mesh("disk_boundary", |m, _| Outcome::of(&disk_boundary(m))),
        mesh("map_to_boundary, Tutte", |m, p| fixed(m, Weights::Uniform, &Outline::Circle, p)),
        mesh("map_to_boundary, harmonic", |m, p| fixed(m, Weights::Harmonic, &Outline::Square, p)),
        mesh("map_to_boundary, mean value", |m, p| {
            fixed(m, Weights::MeanValue, &Outline::Circle, p)
        }),
        mesh("least_squares_conformal", |m, p| Outcome::of(&least_squares_conformal(m, &[], p))),
        mesh("distortion", |m, _| {
            let map = m.positions().map(|p| p.truncate());
            Outcome::of(&(distortion(m, &map), face_distortions(m, &map)))
        }),
        mesh("boundary_crossings", |m, _| {
            let points: Vec<_> = m.positions().values().iter().take(300).collect();
            let finite = points.iter().filter(|p| p.is_finite());
            Outcome::of(&boundary_crossings(&finite.map(|p| p.truncate()).collect::<Vec<_>>()))
        }),
    ]
}

fn fixed(mesh: &Mesh, weights: Weights, outline: &Outline, progress: Progress<'_>) -> Outcome {
    let map = disk_boundary(mesh).and_then(|rim| {
        let held = convex_boundary(mesh, &rim, outline)?;
        map_to_boundary(mesh, &rim, &held, weights, progress)
    });
    Outcome::of(&map)
}
