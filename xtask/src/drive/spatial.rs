//! The hierarchy of triangles: build and queries, as CGAL's driver does them in `spatial.hpp`.

use dgp_mesh::{
    DVec3, IndexedFaceSet, Progress,
    measure::{BoundingBox, bounding_box},
    spatial::{HausdorffOptions, Ray, TriangleTree, one_sided_hausdorff},
};
use serde_json::{Map, Value, json};

use super::{Call, time};
use crate::{raw, shell::Outcome};

/// How many points or rays are asked for.
const QUERIES: usize = 100_000;

/// The operations by name.
pub(super) const OPERATIONS: [&str; 9] = [
    "tree-build",
    "closest-near",
    "closest-box",
    "ray-first",
    "ray-any",
    "segment-any",
    "box-faces",
    "self-intersections",
    "hausdorff",
];

/// Random numbers that a few lines of C++ give too: SplitMix64 (Steele, Lea and Flood 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

/// The surface and the box around it.
struct Input {
    set: IndexedFaceSet,
    bounds: BoundingBox,
}

impl Input {
    fn in_box(&self, count: usize) -> Vec<DVec3> {
        let mut numbers = Numbers(1);
        (0..count).map(|_| self.bounds.min + self.bounds.size() * numbers.point()).collect()
    }

    /// Vertices moved by up to half a percent of the diagonal.
    fn near(&self, count: usize) -> Vec<DVec3> {
        let mut numbers = Numbers(2);
        let positions = self.set.positions().values();
        let size = 0.01 * self.bounds.diagonal();
        let moved = |_| {
            let p = positions[(numbers.next() * positions.len() as f64) as usize];
            p + size * (numbers.point() - 0.5)
        };
        (0..count).map(moved).collect()
    }

    fn moved(&self) -> IndexedFaceSet {
        let mut numbers = Numbers(3);
        let mut set = self.set.clone();
        let size = 0.002 * self.bounds.diagonal();
        set.positions_mut().iter_mut().for_each(|p| *p += size * (numbers.point() - 0.5));
        set
    }
}

/// Runs the operation; `value` is a figure that a peer must find too.
pub(super) fn perform(call: &Call, report: &mut Map<String, Value>) -> Outcome<()> {
    let set = raw::read(&call.input)?;
    let bounds = bounding_box(&set).ok_or("no vertices")?;
    let input = Input { set, bounds };
    let built = |set: &IndexedFaceSet| TriangleTree::new(set, Progress::NONE);
    let mut value = 0.0;
    let mut run = |body: &mut dyn FnMut() -> Outcome<f64>| {
        time(report, call.repeat, || {
            value = body()?;
            Ok(())
        })
    };
    match call.operation.as_str() {
        "tree-build" => return time(report, call.repeat, || Ok(built(&input.set)?)),
        "closest-near" | "closest-box" => {
            let tree = built(&input.set)?;
            let is_near = call.operation == "closest-near";
            let points = if is_near { input.near(QUERIES) } else { input.in_box(QUERIES / 10) };
            run(&mut || {
                let found = tree.closest_points(&points, Progress::NONE)?;
                Ok(found.iter().map(|hit| hit.distance).sum())
            })?;
        }
        "ray-first" | "ray-any" | "segment-any" => {
            let tree = built(&input.set)?;
            let points = input.in_box(2 * QUERIES);
            let is_segment = call.operation == "segment-any";
            let ray = |pair: &[DVec3]| match (is_segment, pair[1] - pair[0]) {
                (true, _) => Ray::segment(pair[0], pair[1]),
                (false, direction) => Ray::new(pair[0], direction),
            };
            let rays: Vec<Ray> = points.chunks(2).map(ray).collect();
            let is_first = call.operation == "ray-first";
            run(&mut || {
                if is_first {
                    let hits = tree.first_hits(&rays, Progress::NONE)?;
                    let far = |(hit, ray): (&Option<dgp_mesh::spatial::RayHit>, &Ray)| {
                        hit.map(|hit| hit.point.distance(ray.origin))
                    };
                    return Ok(hits.iter().zip(&rays).filter_map(far).sum());
                }
                let are_hit = tree.are_hit(&rays, Progress::NONE)?;
                Ok(are_hit.iter().filter(|&&is_hit| is_hit).count() as f64)
            })?;
        }
        "box-faces" => {
            let tree = built(&input.set)?;
            let half = 0.005 * input.bounds.diagonal();
            let points = input.near(QUERIES / 10);
            run(&mut || {
                let count = |&p: &DVec3| {
                    tree.faces_in_box(&BoundingBox { min: p - half, max: p + half }).len() as f64
                };
                Ok(points.iter().map(count).sum())
            })?;
        }
        "self-intersections" => {
            let moved = input.moved();
            // As CGAL does, hierarchy included.
            run(&mut || Ok(built(&moved)?.self_intersections(Progress::NONE)?.len() as f64))?;
        }
        "hausdorff" => {
            let moved = input.moved();
            let bound = 1e-4 * input.bounds.diagonal();
            let both = bounding_box(&moved).map_or(input.bounds, |b| b.union(&input.bounds));
            let tolerance = bound / both.diagonal();
            let options = HausdorffOptions { tolerance, ..HausdorffOptions::default() };
            run(&mut || {
                let (a, b) = (built(&input.set)?, built(&moved)?);
                let found = one_sided_hausdorff(&a, &b, &options, Progress::NONE)?;
                Ok(0.5 * (found.lower + found.upper))
            })?;
            report.insert("bound".into(), json!(bound));
        }
        operation => return Err(format!("no operation `{operation}`").into()),
    }
    report.insert("value".into(), json!(value));
    Ok(())
}
