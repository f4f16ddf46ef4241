//! Coordinates near zero and one: where sums over a whole mesh are formed.

use glam::DVec3;

use super::{BoundingBox, Surface, bounding_box, scale::Scale};

/// The middle of a mesh and the power of two of its size.
///
/// Sums of products of coordinates lose digits far from the origin and leave the range of f64 for
/// very large and small meshes. In this frame all coordinates are below 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// The middle of the bounding box, scaled down.
    center: DVec3,
    scale: Scale,
}

impl Frame {
    /// The frame of the vertices of `surface` that are finite.
    pub(crate) fn of(surface: &impl Surface) -> Self {
        Frame::of_box(bounding_box(surface))
    }

    /// The frame of `points`.
    pub(crate) fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        Frame::of_box(BoundingBox::of_points(points))
    }

    fn of_box(bounds: Option<BoundingBox>) -> Self {
        let Some(bounds) = bounds else {
            return Frame { center: DVec3::ZERO, scale: Scale::of(0.0) };
        };
        // Half the size cannot overflow, the size can.
        let half = 0.5 * bounds.max - 0.5 * bounds.min;
        let mut scale = Scale::of(half.max_element());
        if half == DVec3::ZERO {
            scale = Scale::of(bounds.max.abs().max_element());
        }
        Frame { center: bounds.center() * scale.down, scale }
    }

    /// `point` at the scale of this frame, but not moved: exact, and all that differences need.
    #[inline]
    pub(crate) fn scaled(&self, point: DVec3) -> DVec3 {
        point * self.scale.down
    }

    /// `point` in this frame.
    #[inline]
    pub(crate) fn local(&self, point: DVec3) -> DVec3 {
        self.moved(self.scaled(point))
    }

    /// A point at the scale of this frame, in this frame.
    #[inline]
    pub(crate) fn moved(&self, scaled: DVec3) -> DVec3 {
        scaled - self.center
    }

    /// A point of this frame in space.
    #[inline]
    pub(crate) fn global(&self, local: DVec3) -> DVec3 {
        (local + self.center) * self.scale.up
    }

    /// A length, area, volume, … (by `power`) of this frame in space.
    #[inline]
    pub(crate) fn measure(&self, local: f64, power: u32) -> f64 {
        (0..power).fold(local, |x, _| x * self.scale.up)
    }

    /// Something per length, per area, … (by `power`) of this frame in space.
    #[inline]
    pub(crate) fn per_measure(&self, local: f64, power: u32) -> f64 {
        (0..power).fold(local, |x, _| x * self.scale.down)
    }
}
