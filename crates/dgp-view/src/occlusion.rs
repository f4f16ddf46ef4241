//! Ambient occlusion: hollows see less of the sky and are darker, which shows depth where light
//! alone does not.
//!
//! For each pixel a few others in a disc around it are looked at. What stands above the tangent plane
//! at the pixel, and is not further away than a radius, takes a share of its sky:
//!
//! ```text
//! open = 1 − strength · c · mean of max(0, cos ∠(v, n) − bias) (1 − |v|²/r²)₊
//! ```
//!
//! with v from the pixel's point to the other's. The discs of neighboring pixels are turned against
//! each other, and a mean over 4×4 pixels at the same depth then takes out the grain.
//!
//! - Input: the depth of each pixel.
//! - Cost: 16 pixels looked up per pixel, in parallel; four bytes a pixel, twice.
//! - Reference: McGuire, Osman, Bukowski, Hennessy, "The Alchemy screen-space ambient obscurance
//!   algorithm", HPG 2011.
//! - Departs from it: weights fall to zero at the radius instead of with the square of the distance.

use std::f64::consts::TAU;

use dgp_mesh::{DVec3, VertexId, parallel};

use crate::{
    camera::Camera,
    raster::{Kind, Layer, seen},
};

/// Pixels looked at for each.
const TAPS: usize = 16;
/// Patterns of them: one for each pixel of a 4×4 block.
const PATTERNS: usize = 16;
/// The golden angle spreads points evenly over a disc.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// Cosines below this come from the surface itself, which is faceted.
const BIAS: f64 = 0.12;
/// What half a sky taken away counts as full occlusion.
const CONTRAST: f64 = 2.8;

/// How much of the sky each pixel sees, from 0 to 1.
pub(crate) struct Openness {
    width: usize,
    values: Vec<f32>,
}

impl Openness {
    /// Everything sees all of it.
    pub(crate) fn full() -> Self {
        Openness { width: 0, values: Vec::new() }
    }

    /// `samples` is the number of samples along a pixel, `radius` the distance in space up to which
    /// things take light from each other.
    pub(crate) fn new(
        layers: &[Layer<'_>],
        keys: &[u64],
        camera: &Camera,
        samples: usize,
        strength: f64,
        radius: f64,
    ) -> Self {
        let row = camera.size[0] as usize;
        let [width, height] = camera.size.map(|side| side as usize / samples);
        let nearest = |i: usize| {
            let (x, y) = (i % width * samples, i / width * samples);
            let block = (0..samples * samples).map(|k| (y + k / samples) * row + x + k % samples);
            block.map(|place| keys[place]).min().and_then(seen)
        };
        let view = View { camera, samples: samples as f64, width, height };
        let depth = |v: VertexId| {
            nearest(v.index()).map_or(f32::INFINITY, |(_, order)| camera.depth(order) as f32)
        };
        let depths = parallel::map(width * height, depth).into_values();
        let taps = Taps::new();
        let open = |v: VertexId| {
            let i = v.index();
            let normal = nearest(i).and_then(|(id, _)| normal(layers, id));
            let Some(normal) = normal else { return 1.0 };
            (1.0 - strength * CONTRAST * taps.taken(&view, &depths, i, normal, radius)).max(0.0)
                as f32
        };
        let grainy = parallel::map(width * height, open).into_values();
        let values = parallel::map(width * height, |v: VertexId| {
            mean_around(&view, &depths, &grainy, v.index(), 0.1 * radius as f32)
        });
        Openness { width, values: values.into_values() }
    }

    #[inline]
    pub(crate) fn at(&self, x: usize, y: usize) -> f64 {
        if self.values.is_empty() { 1.0 } else { f64::from(self.values[y * self.width + x]) }
    }
}

/// Pixels and where they are in space.
struct View<'c> {
    camera: &'c Camera,
    samples: f64,
    width: usize,
    height: usize,
}

impl View<'_> {
    /// The point seen in a pixel, relative to the eye.
    fn point(&self, x: usize, y: usize, depth: f64) -> DVec3 {
        let [w, h] = [self.width, self.height].map(|side| 0.5 * side as f64);
        let place = [x as f64 + 0.5 - w, h - y as f64 - 0.5].map(|x| x * self.samples);
        self.camera.point(place, depth)
    }
}

/// The unit normal, toward the viewer, of the triangle with this number; none for lines and points.
fn normal(layers: &[Layer<'_>], id: u32) -> Option<DVec3> {
    let layer = &layers[layers.partition_point(|layer| layer.base <= id) - 1];
    let Kind::Triangles { body, .. } = &layer.kind else { return None };
    let [a, b, c] = body.points((id - layer.base) as usize);
    let n = (b - a).cross(c - a).normalize_or_zero();
    let toward = if n.dot(a) > 0.0 { -n } else { n };
    (n != DVec3::ZERO).then_some(toward)
}

/// Points in a unit disc, for each pattern.
struct Taps(Vec<[[f64; 2]; TAPS]>);

impl Taps {
    fn new() -> Self {
        let tap = |pattern: usize, i: usize| {
            let turn = TAU * pattern as f64 / PATTERNS as f64;
            let (sin, cos) = (i as f64 * GOLDEN_ANGLE + turn).sin_cos();
            let reach = (i as f64 + 0.5) / TAPS as f64;
            [cos * reach, sin * reach]
        };
        Taps((0..PATTERNS).map(|pattern| std::array::from_fn(|i| tap(pattern, i))).collect())
    }

    /// The share of its sky that others take from pixel `i`.
    fn taken(&self, view: &View<'_>, depths: &[f32], i: usize, normal: DVec3, radius: f64) -> f64 {
        let (x, y) = (i % view.width, i / view.width);
        let p = view.point(x, y, f64::from(depths[i]));
        let reach = (radius * view.camera.scale(-p.z) / view.samples).clamp(2.0, 300.0);
        // The order of a 4×4 ordered dither: neighbors get patterns that differ much.
        let pattern = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5][y % 4 * 4 + x % 4];
        let mut taken = 0.0;
        for [dx, dy] in self.0[pattern] {
            let (tx, ty) = ((x as f64 + 0.5 + dx * reach), (y as f64 + 0.5 + dy * reach));
            if tx < 0.0 || ty < 0.0 || tx >= view.width as f64 || ty >= view.height as f64 {
                continue;
            }
            let (tx, ty) = (tx as usize, ty as usize);
            let depth = depths[ty * view.width + tx];
            if depth.is_infinite() {
                continue;
            }
            let v = view.point(tx, ty, f64::from(depth)) - p;
            let near = 1.0 - v.length_squared() / (radius * radius);
            if near > 0.0 {
                taken += (v.normalize_or_zero().dot(normal) - BIAS).max(0.0) * near;
            }
        }
        taken / TAPS as f64
    }
}

/// The mean over the 4×4 pixels around one, at about its depth.
fn mean_around(view: &View<'_>, depths: &[f32], values: &[f32], i: usize, reach: f32) -> f32 {
    let depth = depths[i];
    if depth.is_infinite() {
        return 1.0;
    }
    let (x, y) = (i % view.width, i / view.width);
    let (mut sum, mut count) = (0.0, 0.0);
    for ny in y.saturating_sub(2)..(y + 2).min(view.height) {
        for nx in x.saturating_sub(2)..(x + 2).min(view.width) {
            let j = ny * view.width + nx;
            if (depths[j] - depth).abs() <= reach {
                sum += values[j];
                count += 1.0;
            }
        }
    }
    if count > 0.0 { sum / count } else { values[i] }
}
