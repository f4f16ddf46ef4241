//! A soft shadow on the ground, so that a model is seen to stand rather than to float.
//!
//! The models are drawn once more, from below and without perspective, into a small picture of their
//! heights above the ground. What is low casts a dark shadow, what is high a faint one; then the
//! picture is blurred and laid on the plane through the lowest point.

use dgp_mesh::{Cancelled, DVec3, Progress, VertexId, parallel};

use crate::{
    Fill, Projection,
    body::Body,
    camera::{Camera, Extent, Lens},
    raster::{seen, triangle_layer, visibility},
};

/// Pixels along a side of the picture of heights.
const SIDE: usize = 192;
/// The part of its side that stays free, so that the blurred shadow ends inside.
const MARGIN: f64 = 0.16;
/// How far the blur reaches, in pixels of it: three box blurs of twice this and one.
const BLUR: usize = 5;
/// The height, as a fraction of the size of the models, at which a shadow is half as dark.
const HALF_HEIGHT: f64 = 0.16;

/// A shadow on the ground.
pub(crate) struct Shadow {
    /// Axes of the ground and up, in view coordinates.
    axes: [DVec3; 3],
    /// The camera below the ground.
    below: Camera,
    /// Where the ground is along the third axis.
    ground: f64,
    /// From 0 (none) to 1, row after row.
    darkness: Vec<f32>,
}

impl Shadow {
    /// The shadow of bodies in coordinates relative to the eye; none if there is nothing, or if the
    /// eye is below the ground. `up` is a unit vector.
    pub(crate) fn new(
        bodies: &[Body<'_>],
        up: DVec3,
        camera: &Camera,
        strength: f64,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let across = up.any_orthonormal_vector();
        let axes = [across, up.cross(across), up];
        // Seen from below, toward the viewer is down.
        let turned = |p: DVec3| DVec3::new(axes[0].dot(p), axes[1].dot(p), -axes[2].dot(p));
        let lens = Lens::new([SIDE as u32; 2], MARGIN, Projection::Orthographic);
        let mut flat = Vec::new();
        for body in bodies.iter().filter(|body| body.style.fill == Fill::Shaded) {
            let place = |v: VertexId| turned(body.positions[v.index()]);
            flat.push(body.moved(parallel::map(body.positions.len(), place).into_values()));
        }
        let extents = flat.iter().map(|body| body.extent(&lens));
        let extent = extents.fold(Extent::EMPTY, Extent::union);
        let size = (extent.max - extent.min).max_element();
        if extent.is_empty() || size <= 0.0 {
            return Ok(None);
        }
        // The eye is at the origin; parallel light comes from it everywhere.
        let ground = -extent.max.z;
        let sees_ground = if camera.perspective { ground < 0.0 } else { up.z > 1e-6 };
        if !sees_ground {
            return Ok(None);
        }
        let below = Camera::fit(&extent, &lens);
        for body in &mut flat {
            parallel::for_each_chunk(&mut body.positions, parallel::BLOCK, |_, positions| {
                for p in positions {
                    *p -= below.eye;
                }
            });
        }
        let mut layers = Vec::new();
        let mut base = 0;
        for (i, body) in flat.iter().enumerate() {
            layers.push(triangle_layer(base, i, body, &below));
            base += body.triangles.len() as u32;
        }
        let keys = visibility(&layers, &below, progress)?;
        let bottom = below.eye.z - extent.max.z;
        let dark = |&key: &u64| {
            let (_, order) = seen(key)?;
            let height = (below.depth(order) - bottom).max(0.0) / (HALF_HEIGHT * size);
            Some((strength / (1.0 + height * height)) as f32)
        };
        let mut darkness: Vec<f32> = keys.iter().map(|key| dark(key).unwrap_or(0.0)).collect();
        for _ in 0..3 {
            darkness = blur_rows_and_turn(&blur_rows_and_turn(&darkness));
        }
        Ok(Some(Shadow { axes, below, ground, darkness }))
    }

    /// How dark the ground is where it is seen in this direction: right of and above the middle.
    pub(crate) fn at(&self, camera: &Camera, place: [f64; 2]) -> f32 {
        let near = camera.point(place, camera.near);
        let along = camera.point(place, camera.far) - near;
        let t = (self.ground - self.axes[2].dot(near)) / self.axes[2].dot(along);
        let p = near + t * along;
        // Beyond the horizon, or behind the eye.
        if !(p.is_finite() && p.z < 0.0) {
            return 0.0;
        }
        let eye = self.below.eye;
        let x = (self.axes[0].dot(p) - eye.x) * self.below.focal + 0.5 * SIDE as f64 - 0.5;
        let y = 0.5 * SIDE as f64 - 0.5 - (self.axes[1].dot(p) - eye.y) * self.below.focal;
        let last = (SIDE - 1) as f64;
        if !((0.0..last).contains(&x) && (0.0..last).contains(&y)) {
            return 0.0;
        }
        let (i, j) = (x as usize, y as usize);
        let (s, t) = ((x - i as f64) as f32, (y - j as f64) as f32);
        let at = |i: usize, j: usize| self.darkness[j * SIDE + i];
        let upper = at(i, j) + s * (at(i + 1, j) - at(i, j));
        let lower = at(i, j + 1) + s * (at(i + 1, j + 1) - at(i, j + 1));
        upper + t * (lower - upper)
    }
}

/// Means over runs of a row, rows and columns exchanged.
fn blur_rows_and_turn(values: &[f32]) -> Vec<f32> {
    let mut blurred = vec![0.0; SIDE * SIDE];
    for (j, row) in values.chunks(SIDE).enumerate() {
        for i in 0..SIDE {
            let run = &row[i.saturating_sub(BLUR)..(i + BLUR + 1).min(SIDE)];
            blurred[i * SIDE + j] = run.iter().sum::<f32>() / (2 * BLUR + 1) as f32;
        }
    }
    blurred
}
