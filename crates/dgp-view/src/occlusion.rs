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
//! with v from the pixel's point to the other's. This is done for blocks of 2×2 pixels. The discs of
//! neighboring blocks are turned against each other, and for each pixel a mean over the 4×4 blocks around
//! it that are at its depth then takes out the grain.
//!
//! - Input: what is seen at each sample.
//! - Cost: 16 blocks looked up per block, and 16 per pixel, in parallel; four bytes a pixel and eight a block.
//! - Reference: McGuire, Osman, Bukowski, Hennessy, "The Alchemy screen-space ambient obscurance
//!   algorithm", HPG 2011.
//! - Departs from it: weights fall to zero at the radius instead of with the square of the distance; a
//!   quarter of the places, since hollows are much larger than pixels.

use std::f64::consts::TAU;

use dgp_mesh::{DVec3, VertexId, parallel};

use crate::{
    camera::Camera,
    raster::{Kind, Layer, seen},
};

/// Blocks looked at for each.
const TAPS: usize = 16;
/// Patterns of them: one for each of 4×4 blocks.
const PATTERNS: usize = 16;
/// The golden angle spreads points evenly over a disc.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// Cosines below this come from the surface itself, which is faceted.
const BIAS: f64 = 0.12;
/// What half a sky taken away counts as full occlusion.
const CONTRAST: f64 = 2.8;
/// Pixels along a side of a block.
const SIDE: usize = 2;

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
        let pixels = View::new(camera, samples);
        let blocks = View::new(camera, SIDE * samples);
        let depth_of = |key: Option<u64>| {
            key.and_then(seen).map_or(f32::INFINITY, |(_, order)| camera.depth(order) as f32)
        };
        let depth = |v: VertexId| depth_of(blocks.nearest(keys, v.index()));
        let depths = parallel::map(blocks.width * blocks.height, depth).into_values();
        let taps = Taps::new();
        let open = |v: VertexId| {
            let i = v.index();
            let nearest = blocks.nearest(keys, i).and_then(seen);
            let Some(normal) = nearest.and_then(|(id, _)| normal(layers, id)) else { return 1.0 };
            (1.0 - strength * CONTRAST * taps.taken(&blocks, &depths, i, normal, radius)).max(0.0)
                as f32
        };
        let grainy = parallel::map(blocks.width * blocks.height, open).into_values();
        let values = parallel::map(pixels.width * pixels.height, |v: VertexId| {
            let place = [v.index() % pixels.width, v.index() / pixels.width];
            let depth = depth_of(pixels.nearest(keys, v.index()));
            mean_around(&blocks, &depths, &grainy, place, depth, 0.1 * radius as f32)
        });
        Openness { width: pixels.width, values: values.into_values() }
    }

    #[inline]
    pub(crate) fn at(&self, x: usize, y: usize) -> f64 {
        if self.values.is_empty() { 1.0 } else { f64::from(self.values[y * self.width + x]) }
    }
}

/// Squares of samples and where they are in space.
struct View<'c> {
    camera: &'c Camera,
    /// Samples along a side of a square.
    samples: usize,
    width: usize,
    height: usize,
}

impl<'c> View<'c> {
    fn new(camera: &'c Camera, samples: usize) -> Self {
        let [width, height] = camera.size.map(|side| (side as usize).div_ceil(samples));
        View { camera, samples, width, height }
    }

    /// The key of what is nearest in square `i`.
    fn nearest(&self, keys: &[u64], i: usize) -> Option<u64> {
        let [row, rows] = self.camera.size.map(|side| side as usize);
        let (x, y) = (i % self.width * self.samples, i / self.width * self.samples);
        let columns = x..(x + self.samples).min(row);
        let lines = y..(y + self.samples).min(rows);
        lines.flat_map(|y| &keys[y * row + columns.start..y * row + columns.end]).min().copied()
    }

    /// The point seen in a square, relative to the eye.
    fn point(&self, x: usize, y: usize, depth: f64) -> DVec3 {
        let [w, h] = self.camera.size.map(|side| 0.5 * f64::from(side));
        let middle = |k: usize| (k as f64 + 0.5) * self.samples as f64;
        self.camera.point([middle(x) - w, h - middle(y)], depth)
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

    /// The share of its sky that others take from block `i`.
    fn taken(&self, view: &View<'_>, depths: &[f32], i: usize, normal: DVec3, radius: f64) -> f64 {
        let (x, y) = (i % view.width, i / view.width);
        let p = view.point(x, y, f64::from(depths[i]));
        let reach = (radius * view.camera.scale(-p.z) / view.samples as f64).clamp(1.0, 150.0);
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

/// The mean over the 4×4 blocks around a pixel that are at about its depth; if none is, the value of
/// the one that is nearest to it.
fn mean_around(
    blocks: &View<'_>,
    depths: &[f32],
    values: &[f32],
    [x, y]: [usize; 2],
    depth: f32,
    reach: f32,
) -> f32 {
    if depth.is_infinite() {
        return 1.0;
    }
    // Two blocks on either side of the pixel, which lies in the left or the right half of its own.
    let around = |k: usize, count: usize| {
        let middle = k.div_ceil(SIDE);
        middle.saturating_sub(2)..(middle + 2).min(count)
    };
    let (mut sum, mut count) = (0.0, 0.0);
    let mut closest = (f32::INFINITY, 1.0);
    for by in around(y, blocks.height) {
        for bx in around(x, blocks.width) {
            let j = by * blocks.width + bx;
            let apart = (depths[j] - depth).abs();
            if apart <= reach {
                sum += values[j];
                count += 1.0;
            }
            if apart < closest.0 {
                closest = (apart, values[j]);
            }
        }
    }
    if count > 0.0 { sum / count } else { closest.1 }
}
