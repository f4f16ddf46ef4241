//! Symmetric 2 × 2 tensors in tangent planes, and their principal values.

use std::ops::Add;

use glam::DVec3;

/// The principal curvatures of a vertex and their directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrincipalCurvatures {
    /// κ₁, the larger, positive where the surface bends away from its normal.
    pub max: f64,
    /// κ₂, the smaller.
    pub min: f64,
    /// The unit direction in which the surface bends by κ₁, up to sign; zero where the vertex has no
    /// normal. Where both curvatures agree every direction is principal, and this is one of them.
    pub max_direction: DVec3,
    /// The direction of κ₂: normal × direction of κ₁.
    pub min_direction: DVec3,
}

impl PrincipalCurvatures {
    /// The mean curvature (κ₁ + κ₂) / 2.
    pub fn mean(&self) -> f64 {
        0.5 * self.max + 0.5 * self.min
    }

    /// The Gaussian curvature κ₁ κ₂.
    pub fn gaussian(&self) -> f64 {
        self.max * self.min
    }
}

/// A tangent plane with an orthonormal frame.
#[derive(Clone, Copy)]
pub(super) struct Tangents {
    pub(super) normal: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
}

impl Tangents {
    /// The plane with this unit normal; `None` if that is zero.
    pub(super) fn of_normal(normal: DVec3) -> Option<Self> {
        if normal == DVec3::ZERO {
            return None;
        }
        let (u, v) = normal.any_orthonormal_pair();
        Some(Tangents { normal, u, v })
    }
}

/// The matrix [[uu, uv], [uv, vv]] in the frame of some [`Tangents`].
#[derive(Clone, Copy, Default)]
pub(super) struct Tensor {
    pub(super) uu: f64,
    pub(super) uv: f64,
    pub(super) vv: f64,
}

impl Tensor {
    pub(super) fn scaled(self, factor: f64) -> Self {
        Tensor { uu: factor * self.uu, uv: factor * self.uv, vv: factor * self.vv }
    }

    pub(super) fn is_finite(self) -> bool {
        (self.uu + self.uv + self.vv).is_finite()
    }

    /// xᵀ T y for vectors given by their components.
    pub(super) fn form(self, [x, y]: [f64; 2], [z, w]: [f64; 2]) -> f64 {
        x * (self.uu * z + self.uv * w) + y * (self.uv * z + self.vv * w)
    }

    /// Its values and directions; those of size up to `rounding` count as 0.
    pub(super) fn principal(self, tangents: &Tangents, rounding: f64) -> PrincipalCurvatures {
        let Tensor { uu, uv, vv } = self;
        let (mean, half) = (0.5 * uu + 0.5 * vv, 0.5 * uu - 0.5 * vv);
        let radius = half.hypot(uv);
        // Of the two ways to write the eigenvector, the one that does not cancel.
        let (x, y) = if half >= 0.0 { (radius + half, uv) } else { (uv, radius - half) };
        let max_direction = (x * tangents.u + y * tangents.v).try_normalize().unwrap_or(tangents.u);
        let clean = |x: f64| if x.abs() <= rounding { 0.0 } else { x };
        PrincipalCurvatures {
            max: clean(mean + radius),
            min: clean(mean - radius),
            max_direction,
            min_direction: tangents.normal.cross(max_direction),
        }
    }
}

impl Add for Tensor {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Tensor { uu: self.uu + other.uu, uv: self.uv + other.uv, vv: self.vv + other.vv }
    }
}
