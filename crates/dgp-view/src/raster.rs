//! Which triangle, line or point is seen at each sample.
//!
//! Corners are rounded to 1/256 of a sample; from there on, whether a triangle covers a sample is
//! decided in integers, exactly, and samples on an edge belong to the triangle right of or below it
//! (the top-left rule): triangles that share an edge cover each sample on it once. A sample keeps the
//! least of (depth, number of the primitive) as one 64-bit key, so neither the order in which
//! primitives come nor the number of threads can change the picture.
//!
//! - Input: triangles, lines and points in front of the camera.
//! - Cost: O(primitives) to sort them into bands of rows, then the samples they cover, by bands in
//!   parallel.
//! - Reference: Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988; Burns, Hunt,
//!   "The visibility buffer", Journal of Computer Graphics Techniques 2(2), 2013.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, AtomicUsize, Ordering},
};

use dgp_mesh::{Cancelled, DVec3, Progress, VertexId, parallel};

use crate::{
    BackFaces, Fill,
    body::Body,
    camera::Camera,
    capsule::{Capsule, draw_capsule},
    clip::clip,
};

/// Subpixels per sample.
pub(crate) const UNIT: i64 = 256;

/// Corners further than this from the middle, in subpixels, are cut off: products of two such
/// distances fit in 64 bits.
pub(crate) const GUARD: f64 = (1_i64 << 29) as f64;

/// The key of a sample where nothing is seen.
pub(crate) const NOTHING: u64 = u64::MAX;

/// Primitives per block when they are sorted into bands.
const BLOCK: usize = 1 << 15;

/// Primitives that are numbered from `base` on.
pub(crate) struct Layer<'b> {
    pub(crate) base: u32,
    pub(crate) kind: Kind<'b>,
}

/// What a layer consists of.
pub(crate) enum Kind<'b> {
    /// The triangles of body number `index`, and where its vertices land.
    Triangles { index: usize, body: &'b Body<'b>, landed: Vec<Landed> },
    /// Lines and points.
    Capsules(&'b [Capsule]),
}

/// Where a vertex lands in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Landed {
    /// In subpixels from the upper left; [`OUTSIDE`] if before the near plane, too far off, or
    /// nowhere.
    pub(crate) x: i32,
    pub(crate) y: i32,
    /// From 0 (near) to 1 (far).
    pub(crate) order: f64,
}

/// Marks vertices whose triangles need to be clipped.
const OUTSIDE: i32 = i32::MIN;

/// The layer of a surface whose positions are relative to the eye.
pub(crate) fn triangle_layer<'b>(
    base: u32,
    index: usize,
    body: &'b Body<'b>,
    camera: &Camera,
) -> Layer<'b> {
    let landed = |v: VertexId| land(body.positions[v.index()], camera);
    let landed = parallel::map(body.positions.len(), landed).into_values();
    Layer { base, kind: Kind::Triangles { index, body, landed } }
}

/// Where `p` lands.
pub(crate) fn land(p: DVec3, camera: &Camera) -> Landed {
    let [x, y] = camera.project(p).map(|x| (x * UNIT as f64).round());
    // Written so that a NaN is outside.
    if !(-p.z >= camera.near && x.abs() <= GUARD && y.abs() <= GUARD) {
        return Landed { x: OUTSIDE, y: OUTSIDE, order: 0.0 };
    }
    let [w, h] = camera.size.map(|side| side as i32 * (UNIT as i32 / 2));
    Landed { x: w + x as i32, y: h - y as i32, order: camera.order(-p.z) }
}

impl Layer<'_> {
    /// How many primitives are drawn.
    pub(crate) fn len(&self) -> usize {
        match &self.kind {
            // Faces that are not filled hide nothing.
            Kind::Triangles { body, .. } if body.style.fill == Fill::None => 0,
            Kind::Triangles { body, .. } => body.triangles.len(),
            Kind::Capsules(capsules) => capsules.len(),
        }
    }

    /// The rows primitive `i` may touch.
    fn rows(&self, i: usize, camera: &Camera) -> Range<i64> {
        match &self.kind {
            Kind::Triangles { body, landed, .. } => {
                let corners = body.triangles[i].map(|v| landed[v as usize]);
                if corners.iter().any(|corner| corner.x == OUTSIDE) {
                    let pieces = clip(body.points(i), camera);
                    let rows = pieces.map(|piece| triangle_box(&piece, camera).1);
                    return rows.fold(0..0, join);
                }
                let (columns, rows) = triangle_box(&corners, camera);
                if columns.is_empty() { 0..0 } else { rows }
            }
            Kind::Capsules(capsules) => capsules[i].rows(camera),
        }
    }

    /// Draws primitive `i` into the given rows.
    fn draw(&self, i: usize, camera: &Camera, band: &mut Band<'_>) {
        let id = self.base + i as u32;
        match &self.kind {
            Kind::Triangles { body, landed, .. } => {
                let faces = match body.style.back_faces {
                    BackFaces::Hidden => Facing::Front,
                    BackFaces::Colored(_) | BackFaces::LikeFront => Facing::Any,
                };
                let corners = body.triangles[i].map(|v| landed[v as usize]);
                if corners.iter().any(|corner| corner.x == OUTSIDE) {
                    for piece in clip(body.points(i), camera) {
                        draw_triangle(piece, id, faces, camera, band);
                    }
                } else {
                    draw_triangle(corners, id, faces, camera, band);
                }
            }
            Kind::Capsules(capsules) => draw_capsule(&capsules[i], id, camera, band),
        }
    }
}

/// Some rows of samples.
pub(crate) struct Band<'k> {
    pub(crate) rows: Range<i64>,
    /// Samples in a row.
    pub(crate) width: usize,
    /// The key of each sample.
    pub(crate) keys: &'k mut [u64],
}

impl Band<'_> {
    /// The keys of columns `from..to` of a row of the band.
    #[inline]
    pub(crate) fn row(&mut self, y: i64, from: usize, to: usize) -> &mut [u64] {
        let start = (y - self.rows.start) as usize * self.width;
        &mut self.keys[start + from..start + to]
    }
}

/// The key of primitive `id` at this depth: nearer ones are less, and of equally near ones those with
/// the smaller number.
#[inline]
pub(crate) fn key(order: f64, id: u32) -> u64 {
    u64::from((order * 4_294_967_294.0) as u32) << 32 | u64::from(id)
}

/// The primitive and the depth of a key.
#[inline]
pub(crate) fn seen(key: u64) -> Option<(u32, f64)> {
    (key != NOTHING).then(|| (key as u32, (key >> 32) as f64 / 4_294_967_294.0))
}

/// Equal steps of a computation that threads take in any order.
pub(crate) struct Steps<'p> {
    progress: Progress<'p>,
    count: usize,
    done: AtomicUsize,
    cancelled: AtomicBool,
}

impl<'p> Steps<'p> {
    pub(crate) fn new(progress: Progress<'p>, count: usize) -> Self {
        Steps { progress, count, done: AtomicUsize::new(0), cancelled: AtomicBool::new(false) }
    }

    /// Reports a step before it is taken; once one is cancelled, all later ones are.
    pub(crate) fn one_more(&self) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) as f64 / self.count.max(1) as f64;
        if self.cancelled.load(Ordering::Relaxed) || self.progress.report(done.min(1.0)).is_err() {
            self.cancelled.store(true, Ordering::Relaxed);
            return Err(Cancelled);
        }
        Ok(())
    }

    /// Whether all steps were taken.
    pub(crate) fn finish(self) -> Result<(), Cancelled> {
        if self.cancelled.into_inner() { Err(Cancelled) } else { Ok(()) }
    }
}

/// The key of every sample, row after row from the top.
pub(crate) fn visibility(
    layers: &[Layer<'_>],
    camera: &Camera,
    progress: Progress<'_>,
) -> Result<Vec<u64>, Cancelled> {
    let [width, height] = camera.size.map(|side| side as usize);
    // Enough bands for many threads, and few enough that triangles rarely lie in two.
    let band_rows = height.div_ceil(64).max(16);
    let band_count = height.div_ceil(band_rows);
    let bins: Vec<_> =
        layers.iter().map(|layer| bin(layer, camera, band_rows, band_count)).collect();
    let mut keys = vec![NOTHING; width * height];
    let steps = Steps::new(progress, band_count);
    parallel::for_each_chunk(&mut keys, width * band_rows, |first, keys| {
        if steps.one_more().is_err() {
            return;
        }
        let top = (first / width) as i64;
        let b = top as usize / band_rows;
        let rows = top..top + (keys.len() / width) as i64;
        let mut band = Band { rows, width, keys };
        for (layer, blocks) in layers.iter().zip(&bins) {
            for &i in blocks.iter().flat_map(|bands| &bands[b]) {
                layer.draw(i as usize, camera, &mut band);
            }
        }
    });
    steps.finish()?;
    Ok(keys)
}

/// Which vertices of each body belong to triangles that are seen at some sample.
pub(crate) fn seen_vertices(
    bodies: &[Body<'_>],
    layers: &[Layer<'_>],
    keys: &[u64],
) -> Vec<Vec<bool>> {
    // Threads may mark a vertex at the same time: it is marked in any case.
    let none =
        |body: &Body<'_>| (0..body.positions.len()).map(|_| AtomicBool::new(false)).collect();
    let marks: Vec<Vec<AtomicBool>> = bodies.iter().map(none).collect();
    parallel::map_blocks(keys.len(), BLOCK, |range| {
        let mut last = None;
        for &key in &keys[range] {
            let Some((id, _)) = seen(key) else { continue };
            if last == Some(id) {
                continue;
            }
            last = Some(id);
            let layer = &layers[layers.partition_point(|layer| layer.base <= id) - 1];
            if let Kind::Triangles { index, body, .. } = &layer.kind {
                for v in body.triangles[(id - layer.base) as usize] {
                    marks[*index][v as usize].store(true, Ordering::Relaxed);
                }
            }
        }
    });
    let plain = |marks: Vec<AtomicBool>| marks.into_iter().map(AtomicBool::into_inner).collect();
    marks.into_iter().map(plain).collect()
}

/// The primitives that touch each band, by blocks of primitives.
fn bin(
    layer: &Layer<'_>,
    camera: &Camera,
    band_rows: usize,
    band_count: usize,
) -> Vec<Vec<Vec<u32>>> {
    parallel::map_blocks(layer.len(), BLOCK, |range| {
        let mut bands = vec![Vec::new(); band_count];
        for i in range {
            let rows = layer.rows(i, camera);
            if rows.is_empty() {
                continue;
            }
            let (first, last) =
                (rows.start as usize / band_rows, (rows.end - 1) as usize / band_rows);
            bands[first..=last].iter_mut().for_each(|band| band.push(i as u32));
        }
        bands
    })
}

/// The samples whose centers lie between two subpixels, both included, of `count`.
#[inline]
fn centers(low: i32, high: i32, count: u32) -> Range<i64> {
    let first = (i64::from(low) + UNIT / 2 - 1).div_euclid(UNIT);
    let end = (i64::from(high) - UNIT / 2).div_euclid(UNIT) + 1;
    first.max(0)..end.min(i64::from(count))
}

/// The columns and rows of samples in the box around a triangle.
#[inline]
fn triangle_box(corners: &[Landed; 3], camera: &Camera) -> (Range<i64>, Range<i64>) {
    let [a, b, c] = corners;
    let columns = centers(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), camera.size[0]);
    let rows = centers(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), camera.size[1]);
    (columns, rows)
}

fn join(a: Range<i64>, b: Range<i64>) -> Range<i64> {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b,
        (_, true) => a,
        _ => a.start.min(b.start)..a.end.max(b.end),
    }
}

/// A side of a triangle: how far left of it a subpixel is, times its length.
struct Side {
    /// At the sample where drawing starts, and what a sample to the right and one below add.
    value: i64,
    right: i64,
    below: i64,
}

impl Side {
    #[inline]
    fn new(a: Landed, b: Landed, x: i64, y: i64) -> Self {
        let (dx, dy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
        let value = dx * (y - i64::from(a.y)) - dy * (x - i64::from(a.x));
        // Samples on a side count if it is a top or a left one.
        let counts = dy < 0 || (dy == 0 && dx > 0);
        Side { value: value - i64::from(!counts), right: -dy * UNIT, below: dx * UNIT }
    }
}

/// Which triangles are drawn.
#[derive(Clone, Copy, PartialEq)]
enum Facing {
    Any,
    Front,
}

fn draw_triangle(
    corners: [Landed; 3],
    id: u32,
    facing: Facing,
    camera: &Camera,
    band: &mut Band<'_>,
) {
    let (columns, rows) = triangle_box(&corners, camera);
    let rows = rows.start.max(band.rows.start)..rows.end.min(band.rows.end);
    if columns.is_empty() || rows.is_empty() {
        return;
    }
    let [a, b, c] = corners;
    let difference =
        |p: Landed, q: Landed| (i64::from(q.x) - i64::from(p.x), i64::from(q.y) - i64::from(p.y));
    let ((bx, by), (cx, cy)) = (difference(a, b), difference(a, c));
    let area = bx * cy - by * cx;
    let [a, b, c] = match area {
        0 => return,
        // Rows count downward: what is clockwise here is seen from behind.
        1.. if facing == Facing::Front => return,
        1.. => [a, b, c],
        _ => [a, c, b],
    };
    let (x, y) = (columns.start * UNIT + UNIT / 2, rows.start * UNIT + UNIT / 2);
    let mut sides = [Side::new(a, b, x, y), Side::new(b, c, x, y), Side::new(c, a, x, y)];

    // Depth is linear in the picture; it is kept within the triangle, where rounding could leave it.
    let per_area = UNIT as f64 / area as f64;
    let (to_b, to_c) = (corners[1].order - a.order, corners[2].order - a.order);
    let right = (to_b * cy as f64 - to_c * by as f64) * per_area;
    let below = (to_c * bx as f64 - to_b * cx as f64) * per_area;
    let [low, high] = {
        let [p, q, r] = corners.map(|corner| corner.order);
        [p.min(q).min(r), p.max(q).max(r)]
    };
    let offset = |p: i64, q: i32| (p - i64::from(q)) as f64 / UNIT as f64;
    let mut start = a.order + right * offset(x, a.x) + below * offset(y, a.y);

    for row in rows {
        let mut values = [sides[0].value, sides[1].value, sides[2].value];
        let samples = band.row(row, columns.start as usize, columns.end as usize);
        for (i, sample) in samples.iter_mut().enumerate() {
            if values[0] | values[1] | values[2] >= 0 {
                let order = (start + right * i as f64).clamp(low, high);
                *sample = (*sample).min(key(order, id));
            }
            values[0] += sides[0].right;
            values[1] += sides[1].right;
            values[2] += sides[2].right;
        }
        for side in &mut sides {
            side.value += side.below;
        }
        start += below;
    }
}
