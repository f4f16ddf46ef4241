//! The smallest box with sides along the axes.

use glam::DVec3;

use super::{Surface, scale};
use crate::{VertexId, parallel};

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// The corner of smallest coordinates.
    pub min: DVec3,
    /// The corner of largest coordinates.
    pub max: DVec3,
}

impl BoundingBox {
    /// The box of one point.
    #[inline]
    pub fn of_point(point: DVec3) -> Self {
        BoundingBox { min: point, max: point }
    }

    /// The box of `points`; `None` if there are none. Points that are not finite do not count.
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        let mut points = points.into_iter().filter(|p| p.is_finite());
        let first = BoundingBox::of_point(points.next()?);
        Some(points.fold(first, |sum, p| sum.union(&BoundingBox::of_point(p))))
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(&self, other: &BoundingBox) -> Self {
        BoundingBox { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The lengths of the sides.
    #[inline]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The point in the middle.
    #[inline]
    pub fn center(&self) -> DVec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The distance between opposite corners: the length tolerances are usually relative to.
    pub fn diagonal(&self) -> f64 {
        scale::length(self.size())
    }

    /// Whether `point` lies in the box, its sides included.
    #[inline]
    pub fn contains(&self, point: DVec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }
}

/// The smallest box around all vertices, those of no face included.
///
/// `None` if there are none. Vertices with a coordinate that is infinite or not a number do not
/// count.
pub fn bounding_box(surface: &impl Surface) -> Option<BoundingBox> {
    let positions = surface.vertex_positions().values();
    let nothing =
        BoundingBox { min: DVec3::splat(f64::INFINITY), max: DVec3::splat(f64::NEG_INFINITY) };
    let all = parallel::reduce(
        positions.len(),
        nothing,
        |v: VertexId| {
            let p = positions[v.index()];
            if p.is_finite() { BoundingBox::of_point(p) } else { nothing }
        },
        |a, b| a.union(&b),
    );
    (all != nothing).then_some(all)
}
