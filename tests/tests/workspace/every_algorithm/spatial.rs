//! The lines of the table for spatial queries.

use dgp_mesh::{
    DVec3, Error, IndexedFaceSet, Progress,
    measure::BoundingBox,
    spatial::{
        DeviationOptions, HausdorffOptions, PointTree, Ray, SignedDistances, TriangleTree,
        WindingNumbers, WindingOptions, chamfer, deviation, hausdorff,
    },
};

use super::{
    outcome::Outcome,
    table::{Algorithm, set},
};

/// The outcome of what asks the tree of a surface.
fn asked<T: std::fmt::Debug>(
    set: &IndexedFaceSet,
    progress: Progress<'_>,
    ask: impl FnOnce(&TriangleTree, Progress<'_>) -> Result<T, Error>,
) -> Outcome {
    let tree = TriangleTree::new(set, progress.part(0.0, 0.5));
    Outcome::of(&tree.and_then(|tree| ask(&tree, progress.part(0.5, 1.0))))
}

/// Some points near the vertices that are finite.
fn points(set: &IndexedFaceSet) -> Vec<DVec3> {
    let finite = set.positions().values().iter().filter(|p| p.is_finite()).take(3000);
    finite.enumerate().map(|(i, &p)| p * (1.0 + 0.01 * (i % 7) as f64)).collect()
}

fn rays(set: &IndexedFaceSet) -> Vec<Ray> {
    let points = points(set);
    let pairs = points.windows(2).filter(|pair| (pair[1] - pair[0]).length_squared() > 0.0);
    pairs.map(|pair| Ray::new(pair[0], pair[1] - pair[0])).collect()
}

pub(crate) fn spatial() -> Vec<Algorithm> {
    vec![
        set("closest_points", |s, p| asked(s, p, |t, p| t.closest_points(&points(s), p))),
        set("first_hits", |s, p| asked(s, p, |t, p| t.first_hits(&rays(s), p))),
        set("are_hit", |s, p| asked(s, p, |t, p| t.are_hit(&rays(s), p))),
        set("self_intersections", |s, p| asked(s, p, TriangleTree::self_intersections)),
        set("SignedDistances", |s, p| {
            asked(s, p, |t, p| SignedDistances::new(t).at_points(&points(s), p))
        }),
        set("WindingNumbers", |s, p| {
            asked(s, p, |t, p| {
                WindingNumbers::new(t, WindingOptions::default())?.at_points(&points(s), p)
            })
        }),
        set("hausdorff", |s, p| {
            asked(s, p, |t, p| {
                let mut moved = s.clone();
                moved.positions_mut().iter_mut().for_each(|p| *p *= 1.01);
                let other = TriangleTree::new(&moved, Progress::NONE)?;
                let options = HausdorffOptions { queries: 20_000, ..HausdorffOptions::default() };
                hausdorff(t, &other, &options, p)
            })
        }),
        set("deviation", |s, p| {
            asked(s, p, |t, p| deviation(t, t, &DeviationOptions { samples: 2000 }, p))
        }),
        set("chamfer", |s, p| {
            let points = points(s);
            Outcome::of(&chamfer(&points, &points[points.len() / 2..], p))
        }),
        set("one by one", |s, _| {
            let tree = TriangleTree::new(s, Progress::NONE);
            let points = points(s);
            let near = PointTree::new(&points, Progress::NONE);
            let some = points.iter().take(20);
            Outcome::of(&tree.map(|tree| {
                let ask = |&p: &DVec3| {
                    let query = BoundingBox { min: 0.9 * p, max: p };
                    let ray = Ray::segment(p, -p);
                    (
                        tree.nearest_faces(p, 3),
                        tree.faces_within(p, 0.1 * p.length()),
                        tree.faces_in_box(&query),
                        tree.all_hits(&ray),
                        tree.winding_number(p),
                        near.as_ref().map(|near| near.nearest_points(p, 3)),
                    )
                };
                some.map(ask).collect::<Vec<_>>()
            }))
        }),
    ]
}
