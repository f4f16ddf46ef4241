//! Lines and points as capsules: all samples within a distance of a segment, which may be a point.

use std::ops::Range;

use dgp_mesh::DVec3;

use crate::{
    camera::Camera,
    color::Linear,
    raster::{Band, key},
};

/// A segment of some width, or a ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    /// Its ends, relative to the eye.
    pub(crate) ends: [DVec3; 2],
    pub(crate) radius: Radius,
    pub(crate) color: Linear,
    pub(crate) look: Look,
}

/// Half the width of a capsule.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Radius {
    /// In samples.
    Samples(f64),
    /// In the units of space, so that what is further away is smaller; in samples it is at least the
    /// second number.
    Space(f64, f64),
}

/// How light falls on a capsule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// Not at all; drawn a little before the surface it lies on.
    Line,
    /// As on a ball.
    Ball,
    /// As on a surface with this normal.
    Surfel([f32; 3]),
}

/// A capsule in samples from the upper left.
#[derive(Clone, Copy)]
pub(crate) struct Flat {
    pub(crate) a: [f64; 2],
    /// From the first to the second end.
    pub(crate) along: [f64; 2],
    depths: [f64; 2],
    pub(crate) radius: f64,
}

impl Capsule {
    /// Where the capsule lands; `None` if it is before the near plane or nowhere.
    pub(crate) fn flat(&self, camera: &Camera) -> Option<Flat> {
        let [mut a, mut b] = self.ends;
        if !(a.is_finite() && b.is_finite()) {
            return None;
        }
        let near = camera.near;
        if -a.z < near && -b.z < near {
            return None;
        }
        if -a.z < near {
            a = b + (a - b) * ((-b.z - near) / (a.z - b.z));
        } else if -b.z < near {
            b = a + (b - a) * ((-a.z - near) / (b.z - a.z));
        }
        let [w, h] = camera.size.map(|side| 0.5 * f64::from(side));
        let place = |p: DVec3| {
            let scale = camera.scale((-p.z).max(near));
            [w + p.x * scale, h - p.y * scale]
        };
        let radius = match self.radius {
            Radius::Samples(radius) => radius,
            Radius::Space(radius, least) => (radius * camera.scale(-a.z)).max(least),
        };
        let depth = |p: DVec3| match self.look {
            // As far before the surface as it is wide, so that it is not cut where that is bent.
            Look::Line => -p.z - 1.5 * radius / camera.scale(-p.z),
            Look::Ball | Look::Surfel(_) => -p.z,
        };
        let (p, q) = (place(a), place(b));
        let along = [q[0] - p[0], q[1] - p[1]];
        Some(Flat { a: p, along, depths: [depth(a).max(near), depth(b).max(near)], radius })
    }

    pub(crate) fn rows(&self, camera: &Camera) -> Range<i64> {
        self.flat(camera).map_or(0..0, |flat| {
            let columns = flat.reach(0, camera);
            if columns.is_empty() { 0..0 } else { flat.reach(1, camera) }
        })
    }
}

impl Flat {
    /// The columns (0) or rows (1) of samples in the box around it.
    fn reach(&self, axis: usize, camera: &Camera) -> Range<i64> {
        let (a, b) = (self.a[axis], self.a[axis] + self.along[axis]);
        samples(a.min(b) - self.radius, a.max(b) + self.radius, camera.size[axis])
    }

    /// How far along the segment, from 0 to 1, the point nearest to `(x, y)` is, and the square of its
    /// distance.
    #[inline]
    pub(crate) fn nearest(&self, x: f64, y: f64) -> (f64, f64) {
        let (px, py) = (x - self.a[0], y - self.a[1]);
        let [dx, dy] = self.along;
        let length = dx * dx + dy * dy;
        let t = if length > 0.0 { ((px * dx + py * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
        let (qx, qy) = (px - t * dx, py - t * dy);
        (t, qx * qx + qy * qy)
    }
}

/// The samples whose centers lie between two places, of `count`.
fn samples(low: f64, high: f64, count: u32) -> Range<i64> {
    let count = f64::from(count);
    (low - 0.5).ceil().clamp(0.0, count) as i64
        ..((high - 0.5).floor() + 1.0).clamp(0.0, count) as i64
}

pub(crate) fn draw_capsule(capsule: &Capsule, id: u32, camera: &Camera, band: &mut Band<'_>) {
    let Some(flat) = capsule.flat(camera) else { return };
    let (columns, rows) = (flat.reach(0, camera), flat.reach(1, camera));
    let square = flat.radius * flat.radius;
    let [dx, dy] = flat.along;
    for row in rows.start.max(band.rows.start)..rows.end.min(band.rows.end) {
        let y = row as f64 + 0.5;
        // The strip around the line, where that is narrower than the box.
        let mut columns = columns.clone();
        if dy != 0.0 {
            let middle = flat.a[0] + (y - flat.a[1]) * dx / dy;
            let half = flat.radius * dx.hypot(dy) / dy.abs();
            let strip = samples(middle - half, middle + half, camera.size[0]);
            columns = columns.start.max(strip.start)..columns.end.min(strip.end);
        }
        if columns.is_empty() {
            continue;
        }
        let keys = band.row(row, columns.start as usize, columns.end as usize);
        for (i, sample) in keys.iter_mut().enumerate() {
            let (t, distance) = flat.nearest((columns.start + i as i64) as f64 + 0.5, y);
            if distance > square {
                continue;
            }
            let [near, far] = flat.depths;
            let order = match capsule.look {
                Look::Line | Look::Surfel(_) => {
                    let (a, b) = (camera.order(near), camera.order(far));
                    a + t * (b - a)
                }
                Look::Ball => {
                    let bulge = (square - distance).sqrt() / camera.scale(near);
                    camera.order((near - bulge).max(camera.near))
                }
            };
            *sample = (*sample).min(key(order.clamp(0.0, 1.0), id));
        }
    }
}
