//! The camera: which way it looks, how far away it must be to show everything, and where a point
//! lands in the picture.
//!
//! View coordinates are x to the right, y up, z toward the viewer.
//!
//! The perspective camera that fits is exact, not that of a bounding sphere. A point (x, y, z) is
//! inside the left and right sides of the picture of a camera at (X, ·, Z) if
//!
//! ```text
//! |x − X| ≤ t (Z − z)   ⇔   x + tz ≤ X + tZ   and   −x + tz ≤ −X + tZ
//! ```
//!
//! with t the tangent of half the angle of view. With A and B the greatest left sides over all points,
//! the nearest such camera has Z = (A + B) / 2t and X = (A − B) / 2; likewise for top and bottom.
//!
//! - Input: finite points.
//! - Cost: four maxima over all points.
//! - Reference: none.

use dgp_mesh::DVec3;

use crate::{Projection, Up, View};

/// Three axes of view coordinates in those of the scene.
#[derive(Clone, Copy)]
pub(crate) struct Basis {
    right: DVec3,
    up: DVec3,
    back: DVec3,
    /// Up in the scene; `up` is that only as far as it can be seen.
    axis: DVec3,
}

/// 30° to the right of the front, 20° from above.
const THREE_QUARTER: DVec3 = DVec3::new(0.469_846_31, 0.342_020_14, 0.813_797_68);

impl Basis {
    pub(crate) fn new(view: View, up: Up) -> Self {
        // A direction with y up as one with z up: front and top keep their names.
        let turned = |v: DVec3| match up {
            Up::Y => v,
            Up::Z => DVec3::new(v.x, -v.z, v.y),
        };
        let back = match view {
            View::ThreeQuarter => turned(THREE_QUARTER),
            View::Front => turned(DVec3::Z),
            View::Back => turned(-DVec3::Z),
            View::Left => turned(-DVec3::X),
            View::Right => turned(DVec3::X),
            View::Top => turned(DVec3::Y),
            View::Bottom => turned(-DVec3::Y),
            View::From(direction) => unit(direction),
            View::Eye { eye, target } => unit(0.5 * eye - 0.5 * target),
        };
        let axis = turned(DVec3::Y);
        // Seen from the very top or bottom, what points away from the front is up.
        let away = if back.dot(axis) > 0.0 { turned(-DVec3::Z) } else { turned(DVec3::Z) };
        let across = axis.cross(back);
        let right = if across.length() > 1e-9 { across } else { away.cross(back) }.normalize();
        Basis { right, up: back.cross(right), back, axis }
    }

    /// What points up in the scene, in view coordinates.
    pub(crate) fn axis(&self) -> DVec3 {
        self.view(self.axis)
    }

    /// `p` in view coordinates.
    #[inline]
    pub(crate) fn view(&self, p: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(p), self.up.dot(p), self.back.dot(p))
    }
}

/// The direction of `v`, however long it is.
fn unit(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize()
}

/// What a camera must know of the points it shall show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
    /// The greatest x + tz, −x + tz, y + sz, −y + sz.
    slants: [f64; 4],
}

impl Extent {
    pub(crate) const EMPTY: Extent =
        Extent { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY, slants: [f64::NEG_INFINITY; 4] };

    pub(crate) fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// The extent of both.
    pub(crate) fn union(self, other: Extent) -> Extent {
        Extent {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            slants: std::array::from_fn(|k| self.slants[k].max(other.slants[k])),
        }
    }

    /// Adds a point in view coordinates.
    #[inline]
    pub(crate) fn add(&mut self, p: DVec3, lens: &Lens) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
        let [t, s] = lens.tangents;
        let slants = [p.x + t * p.z, -p.x + t * p.z, p.y + s * p.z, -p.y + s * p.z];
        for (greatest, slant) in self.slants.iter_mut().zip(slants) {
            *greatest = greatest.max(slant);
        }
    }
}

/// The rectangle to draw in, and the angle of view it has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    /// Samples in a row and rows of samples.
    pub(crate) size: [u32; 2],
    /// Half of what models may fill, in samples.
    half: [f64; 2],
    /// The same as tangents of half the angle of view; infinite if orthographic.
    tangents: [f64; 2],
    /// Samples per unit of distance at unit depth.
    focal: f64,
    pub(crate) perspective: bool,
}

impl Lens {
    pub(crate) fn new(size: [u32; 2], margin: f64, projection: Projection) -> Self {
        let [w, h] = size.map(f64::from);
        let free = margin * w.min(h);
        let half = [w, h].map(|side| (0.5 * side - free).max(0.5));
        let (focal, perspective) = match projection {
            Projection::Perspective { field_of_view } => {
                (0.5 * w.min(h) / (0.5 * field_of_view).tan(), true)
            }
            Projection::Orthographic => (1.0, false),
        };
        let tangents = if perspective { half.map(|x| x / focal) } else { [0.0; 2] };
        Lens { size, half, tangents, focal, perspective }
    }
}

/// Turns points relative to the eye into samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    /// Where the camera is, in view coordinates.
    pub(crate) eye: DVec3,
    /// Samples in a row and rows of samples.
    pub(crate) size: [u32; 2],
    /// Samples per unit of distance, at unit depth if in perspective.
    pub(crate) focal: f64,
    pub(crate) perspective: bool,
    /// Depths between which all points lie.
    pub(crate) near: f64,
    pub(crate) far: f64,
}

/// The greatest depth is at most this many times the smallest that is drawn. Larger ratios waste the
/// digits of depth on what is just before the eye.
const DEPTH_RATIO: f64 = 1e5;

impl Camera {
    /// The nearest camera that shows everything.
    pub(crate) fn fit(extent: &Extent, lens: &Lens) -> Self {
        let extent = if extent.is_empty() { unit_extent(lens) } else { *extent };
        let size = extent.max - extent.min;
        let radius = size.max_element();
        // A single point is shown as if it were a unit across.
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let middle = 0.5 * (extent.min + extent.max);
        if !lens.perspective {
            let focal = (2.0 * lens.half[0] / size.x.max(1e-6 * radius))
                .min(2.0 * lens.half[1] / size.y.max(1e-6 * radius))
                .min(2.0 * lens.half[0].min(lens.half[1]) / (1e-3 * radius));
            let focal = if size.max_element() > 0.0 { focal } else { lens.half[0] };
            let eye = DVec3::new(middle.x, middle.y, extent.max.z + radius);
            return Camera::at(eye, focal, lens, &extent);
        }
        let [a, b, c, d] = extent.slants;
        let [t, s] = lens.tangents;
        let nearest = extent.max.z + 0.05 * radius;
        let z = (0.5 * (a + b) / t).max(0.5 * (c + d) / s).max(nearest);
        let z = if size.max_element() > 0.0 { z } else { extent.max.z + 0.5 / t.min(s) };
        Camera::at(DVec3::new(0.5 * (a - b), 0.5 * (c - d), z), lens.focal, lens, &extent)
    }

    /// A camera where the user wants it, in view coordinates.
    pub(crate) fn at_eye(eye: DVec3, extent: &Extent, lens: &Lens) -> Self {
        let extent = if extent.is_empty() { unit_extent(lens) } else { *extent };
        Camera::at(eye, lens.focal, lens, &extent)
    }

    fn at(eye: DVec3, focal: f64, lens: &Lens, extent: &Extent) -> Self {
        let farthest = eye.z - extent.min.z;
        let far = if farthest > 0.0 { farthest * 1.001 } else { 1.0 };
        let near = ((eye.z - extent.max.z) * 0.999).max(far / DEPTH_RATIO);
        Camera { eye, size: lens.size, focal, perspective: lens.perspective, near, far }
    }

    /// How many samples right of and above the middle of the picture `p` lands; `p` is relative to
    /// the eye and before it.
    #[inline]
    pub(crate) fn project(&self, p: DVec3) -> [f64; 2] {
        let scale = self.scale(-p.z);
        [p.x * scale, p.y * scale]
    }

    /// Samples per unit of length at this depth.
    #[inline]
    pub(crate) fn scale(&self, depth: f64) -> f64 {
        if self.perspective { self.focal / depth } else { self.focal }
    }

    /// Depth as a number from 0 (near) to 1 (far) that is linear in the picture.
    #[inline]
    pub(crate) fn order(&self, depth: f64) -> f64 {
        if self.perspective {
            (1.0 - self.near / depth) / (1.0 - self.near / self.far)
        } else {
            (depth - self.near) / (self.far - self.near)
        }
    }

    /// The depth of an order.
    #[inline]
    pub(crate) fn depth(&self, order: f64) -> f64 {
        if self.perspective {
            self.near / (1.0 - order * (1.0 - self.near / self.far))
        } else {
            self.near + order * (self.far - self.near)
        }
    }

    /// The point relative to the eye at this depth, seen that far right of and above the middle.
    #[inline]
    pub(crate) fn point(&self, [x, y]: [f64; 2], depth: f64) -> DVec3 {
        let scale = self.scale(depth);
        DVec3::new(x / scale, y / scale, -depth)
    }
}

/// The extent of a unit cube, for pictures of nothing.
fn unit_extent(lens: &Lens) -> Extent {
    let mut extent = Extent::EMPTY;
    for corner in 0..8 {
        let sign = |bit: u32| if corner >> bit & 1 == 0 { -0.5 } else { 0.5 };
        extent.add(DVec3::new(sign(0), sign(1), sign(2)), lens);
    }
    extent
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_quarter_view_is_a_unit_vector() {
        assert!((THREE_QUARTER.length() - 1.0).abs() < 1e-8);
    }

    #[test]
    fn front_looks_along_minus_z_and_top_down() {
        let front = Basis::new(View::Front, Up::Y);
        assert_eq!(front.view(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 2.0, 3.0));
        let top = Basis::new(View::Top, Up::Y);
        assert_eq!(top.view(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, -3.0, 2.0));
        let front = Basis::new(View::Front, Up::Z);
        assert_eq!(front.view(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 3.0, -2.0));
        let right = Basis::new(View::Right, Up::Y);
        assert_eq!(right.view(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(-3.0, 2.0, 1.0));
    }

    #[test]
    fn the_nearest_camera_touches_two_sides_of_the_picture() {
        let lens = Lens::new([400, 300], 0.1, Projection::default());
        let points = [[1.0, 0.0, 2.0], [-3.0, 0.5, 0.1], [0.3, -2.0, -1.0], [0.0, 2.5, 0.7]];
        let points = points.map(DVec3::from_array);
        let mut extent = Extent::EMPTY;
        for p in points {
            extent.add(p, &lens);
        }
        let camera = Camera::fit(&extent, &lens);
        let seen = points.map(|p| camera.project(p - camera.eye));
        let reach = |k: usize| {
            let side = seen.map(|p| p[k]);
            (side.iter().copied().fold(f64::MAX, f64::min), side.into_iter().fold(0.0, f64::max))
        };
        // 10 % of the shorter side is free on each side: 170 and 120 samples from the middle.
        let ((left, right), (bottom, top)) = (reach(0), reach(1));
        assert!(left >= -170.0 - 1e-9 && right <= 170.0 + 1e-9);
        let tall = (top - 120.0).abs() < 1e-9 && (bottom + 120.0).abs() < 1e-9;
        let wide = (left + 170.0).abs() < 1e-9 && (right - 170.0).abs() < 1e-9;
        assert!(tall || wide, "{left} {right} {bottom} {top}");
    }

    #[test]
    fn orders_and_depths_are_inverse() {
        for projection in [Projection::default(), Projection::Orthographic] {
            let lens = Lens::new([100, 100], 0.1, projection);
            let camera = Camera::fit(&unit_extent(&lens), &lens);
            for x in [0.0, 0.25, 1.0] {
                assert!((camera.order(camera.depth(x)) - x).abs() < 1e-12);
            }
        }
    }
}
