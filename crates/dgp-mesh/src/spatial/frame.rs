//! The coordinates a hierarchy computes in: about one in size, whatever the unit.
//!
//! All coordinates are multiplied by a power of two, which is exact; distances near 1e±300 then
//! neither overflow nor vanish, and a surface scaled by 2^k gives a hierarchy of the same bits.
//! Boxes are moved to the middle as well and kept in single precision, rounded outward.

use glam::DVec3;

use crate::measure::{BoundingBox, scale::Scale};

/// The power of two of a size, and the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) scale: Scale,
    /// Of the bounding box, scaled down.
    pub(super) center: DVec3,
}

impl Frame {
    /// The frame of what has this bounding box.
    pub(super) fn of(bounds: Option<BoundingBox>) -> Self {
        /// Sizes that vanish beside the coordinates count as a little of those, or scaling would make
        /// them overflow.
        const LEAST: f64 = 1.0 / (1_u64 << 60) as f64;
        let Some(bounds) = bounds else {
            return Frame { scale: Scale::of(0.0), center: DVec3::ZERO };
        };
        // Half the size cannot overflow, the size can.
        let half = 0.5 * bounds.max - 0.5 * bounds.min;
        let largest = bounds.max.abs().max(bounds.min.abs()).max_element();
        let scale = Scale::of(half.max_element().max(LEAST * largest));
        Frame { scale, center: 0.5 * (bounds.min * scale.down) + 0.5 * (bounds.max * scale.down) }
    }

    /// A point in the units of the frame; may be infinite for points very far away.
    #[inline]
    pub(super) fn scaled(&self, p: DVec3) -> DVec3 {
        p * self.scale.down
    }

    /// The single-precision interval around each coordinate of a scaled point, from the middle.
    ///
    /// The step outward is taken whether the conversion rounded or not, so that it covers the rounding
    /// of the subtraction too.
    #[inline]
    pub(super) fn rounded(&self, scaled: DVec3) -> ([f32; 3], [f32; 3]) {
        let local = (scaled - self.center).to_array();
        (local.map(below), local.map(above))
    }
}

/// A single-precision number less than `x`.
#[inline]
pub(super) fn below(x: f64) -> f32 {
    (x as f32).next_down()
}

/// A single-precision number greater than `x`.
#[inline]
pub(super) fn above(x: f64) -> f32 {
    (x as f32).next_up()
}
