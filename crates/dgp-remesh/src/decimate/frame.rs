//! The coordinates in which decimation by quadrics computes.

use dgp_mesh::{DVec3, Mesh, VertexId, VertexMap, measure::bounding_box};

use super::rings::NONE;

/// Coordinates about the center in units of a power of two, so that squares neither overflow nor vanish.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    center: DVec3,
    pub(super) unit: f64,
}

impl Frame {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let Some(bounds) = bounding_box(mesh) else {
            return Frame { center: DVec3::ZERO, unit: 1.0 };
        };
        let center = 0.5 * bounds.min + 0.5 * bounds.max;
        let size = (0.5 * bounds.max - 0.5 * bounds.min).max_element();
        let unit = if size > 0.0 { 2_f64.powi(exponent(size)) } else { 1.0 };
        Frame { center, unit }
    }

    pub(super) fn inside(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.unit
    }

    /// Where a vertex is that holds the position that `held` has in the input, or else is at `p` inside.
    pub(super) fn position(&self, input: &VertexMap<DVec3>, held: u32, p: DVec3) -> DVec3 {
        match held {
            NONE => p * self.unit + self.center,
            held => input[VertexId::new(held as usize)],
        }
    }
}

/// The exponent of 2 in `x`, kept where its reciprocal is a number too.
fn exponent(x: f64) -> i32 {
    (((x.to_bits() >> 52) & 0x7ff) as i32 - 1023).clamp(-1021, 1021)
}
