//! Where a ray or a segment meets a surface.
//!
//! The ray is sheared so that it runs along one axis; it passes through a triangle if it lies on the
//! same side of all three of its edges, which two triangles at a common edge decide by the same bits.
//!
//! - Input: any surface; rays of any direction and origin.
//! - Cost: some log n for the first hit; many rays in parallel.
//! - Guarantees: no ray slips between two triangles that share an edge or a vertex. Of hits equally far
//!   the one of the face first in the surface. A ray in the plane of a triangle does not hit it.
//! - Reference: Woop, Benthin and Wald, "Watertight ray/triangle intersection", Journal of Computer
//!   Graphics Techniques 2(1), 2013; Ize, "Robust BVH ray traversal", Journal of Computer Graphics
//!   Techniques 2(2), 2013.
//! - Departs from it: in f64 throughout, boxes in f32 rounded outward; the origin of a ray from afar is
//!   moved to the surface for the boxes.

use std::ops::Range;

use glam::DVec3;

use super::{
    TriangleTree, batch,
    frame::{above, below},
    nodes::Beam,
};
use crate::{Error, FaceId, Progress, VertexId, measure::scale::Scale};

/// The points `origin` + t `direction` for t from 0 to `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; need not be a unit vector.
    pub direction: DVec3,
    /// Up to which t; infinite for a ray.
    pub end: f64,
}

impl Ray {
    /// The ray without end.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Ray { origin, direction, end: f64::INFINITY }
    }

    /// The segment from `a` (t = 0) to `b` (t = 1).
    pub fn segment(a: DVec3, b: DVec3) -> Self {
        Ray { origin: a, direction: b - a, end: 1.0 }
    }

    /// Whether it leads anywhere.
    fn is_valid(&self) -> bool {
        let leads = self.direction.is_finite() && self.direction != DVec3::ZERO;
        self.origin.is_finite() && leads && self.end >= 0.0
    }
}

/// Where a ray meets a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// How far along the ray, in units of its direction.
    pub t: f64,
    /// Where it is.
    pub point: DVec3,
    /// The face.
    pub face: FaceId,
    /// The triangle: the corners of the face, or of a part of it if that is a polygon.
    pub vertices: [VertexId; 3],
    /// The coordinates of the point in that triangle: not negative, of sum 1.
    pub barycentric: [f64; 3],
    /// Whether the ray comes from the side from which the face turns counterclockwise.
    pub is_front: bool,
}

/// A triangle on the ray: t in the frame, which one, weights of its corners, whether seen from front.
#[derive(Clone, Copy)]
struct Hit {
    t: f64,
    triangle: usize,
    weights: [f64; 3],
    is_front: bool,
}

/// A ray made ready: in the frame, sheared, and as boxes see it.
struct Sheared {
    origin: DVec3,
    axes: [usize; 3],
    shear: [f64; 3],
    end: f64,
    /// What brings t back to the units of the ray.
    unit: [f64; 2],
    /// Where the beam starts.
    start: f64,
    beam: Beam,
}

impl TriangleTree {
    /// The first face that `ray` meets; `None` if there is none, also for a ray that is not finite or
    /// leads nowhere.
    pub fn first_hit(&self, ray: &Ray) -> Option<RayHit> {
        let sheared = self.sheared(ray)?;
        let mut best: Option<Hit> = None;
        self.walk(&sheared, |items| {
            for hit in items.filter_map(|i| self.hit(&sheared, i)) {
                let is_better = best.is_none_or(|best| {
                    hit.t < best.t
                        || (hit.t == best.t && self.faces[hit.triangle] < self.faces[best.triangle])
                });
                if is_better {
                    best = Some(hit);
                }
            }
            best.map_or(sheared.end, |best| best.t)
        });
        best.map(|hit| self.hit_of(&sheared, &hit))
    }

    /// Whether `ray` meets any face: cheaper than the first.
    pub fn is_hit(&self, ray: &Ray) -> bool {
        let Some(sheared) = self.sheared(ray) else { return false };
        let mut is_hit = false;
        self.walk(&sheared, |mut items| {
            is_hit = items.any(|i| self.hit(&sheared, i).is_some());
            // Nothing is nearer than that.
            if is_hit { -1.0 } else { sheared.end }
        });
        is_hit
    }

    /// All places where `ray` meets faces, in order. On an edge or at a vertex that is once for each of
    /// the faces there.
    pub fn all_hits(&self, ray: &Ray) -> Vec<RayHit> {
        let Some(sheared) = self.sheared(ray) else { return Vec::new() };
        let mut hits = Vec::new();
        self.walk(&sheared, |items| {
            hits.extend(items.filter_map(|i| self.hit(&sheared, i)));
            sheared.end
        });
        hits.sort_unstable_by(|a, b| {
            let key = |hit: &Hit| (self.faces[hit.triangle], hit.triangle);
            a.t.total_cmp(&b.t).then(key(a).cmp(&key(b)))
        });
        hits.iter().map(|hit| self.hit_of(&sheared, hit)).collect()
    }

    /// [`first_hit`](Self::first_hit) of each of `rays`.
    ///
    /// Errors: [`Error::InvalidRay`].
    pub fn first_hits(
        &self,
        rays: &[Ray],
        progress: Progress<'_>,
    ) -> Result<Vec<Option<RayHit>>, Error> {
        self.for_rays(rays, progress, |ray| self.first_hit(ray))
    }

    /// [`is_hit`](Self::is_hit) of each of `rays`.
    ///
    /// Errors: [`Error::InvalidRay`].
    pub fn are_hit(&self, rays: &[Ray], progress: Progress<'_>) -> Result<Vec<bool>, Error> {
        self.for_rays(rays, progress, |ray| self.is_hit(ray))
    }

    fn for_rays<T: Send>(
        &self,
        rays: &[Ray],
        progress: Progress<'_>,
        f: impl Fn(&Ray) -> T + Sync,
    ) -> Result<Vec<T>, Error> {
        if let Some(index) = rays.iter().position(|ray| !ray.is_valid()) {
            return Err(Error::InvalidRay { index });
        }
        let origins: Vec<DVec3> = rays.iter().map(|ray| ray.origin).collect();
        batch::ordered(&self.nodes.frame, &origins, progress, |i, (): &mut ()| f(&rays[i]))
    }

    /// The ray in the frame; `None` if it cannot meet anything.
    fn sheared(&self, ray: &Ray) -> Option<Sheared> {
        if self.is_empty() || !ray.is_valid() {
            return None;
        }
        let frame = &self.nodes.frame;
        let scale = Scale::of(ray.direction.abs().max_element());
        // The largest component is from 1 to 2 now.
        let direction = ray.direction * scale.down;
        let origin = frame.scaled(ray.origin);
        let end = ray.end * frame.scale.down * scale.up;
        let local = origin - frame.center;
        let far = local.abs().max_element();
        if !far.is_finite() {
            return None;
        }

        // All that is there lies within −2..2; what far coordinates lose is added.
        let loss = far / (1_u64 << 48) as f64;
        let size = 4.0 + loss;
        let (mut start, mut stop) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (x, d) = (local[axis], direction[axis]);
            if d != 0.0 {
                let (a, b) = ((-size - x) / d, (size - x) / d);
                start = start.max(a.min(b));
                stop = stop.min(a.max(b));
            } else if x.abs() > size {
                return None;
            }
        }
        if start > stop || start > end {
            return None;
        }
        let beam = beam(local + start * direction, direction, loss);

        let longest = (0..3)
            .fold(0, |best, i| if direction[i].abs() > direction[best].abs() { i } else { best });
        let [mut x, mut y, z] = [(longest + 1) % 3, (longest + 2) % 3, longest];
        // Keeps the sense of rotation.
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear = [direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]];
        let unit = [frame.scale.up, scale.down];
        Some(Sheared { origin, axes: [x, y, z], shear, end, unit, start, beam })
    }

    /// Offers leaves on the ray to `visit`, nearest first; that tells up to which t more is wanted.
    fn walk(&self, ray: &Sheared, mut visit: impl FnMut(Range<usize>) -> f64) {
        let limit = |t: f64| above((t - ray.start) * (1.0 + 1e-6));
        self.nodes.along(&ray.beam, limit(ray.end), |items| limit(visit(items)));
    }

    /// Whether and where the ray meets a triangle.
    #[inline]
    fn hit(&self, ray: &Sheared, triangle: usize) -> Option<Hit> {
        let [x, y, z] = ray.axes;
        let [sx, sy, sz] = ray.shear;
        let [a, b, c] = self.triangles[triangle].map(|p| {
            let p = p - ray.origin;
            [p[x] - sx * p[z], p[y] - sy * p[z], sz * p[z]]
        });
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let weights = [u / sum, v / sum, w / sum];
        let t = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2];
        (t >= 0.0 && t <= ray.end).then_some(Hit { t, triangle, weights, is_front: sum > 0.0 })
    }

    /// What was found, in the units of the surface.
    fn hit_of(&self, ray: &Sheared, hit: &Hit) -> RayHit {
        let [a, b, c] = self.triangles[hit.triangle];
        let [_, v, w] = hit.weights;
        let point = a + v * (b - a) + w * (c - a);
        RayHit {
            t: hit.t * ray.unit[0] * ray.unit[1],
            point: point * self.nodes.frame.scale.up,
            face: self.faces[hit.triangle],
            vertices: self.vertices[hit.triangle],
            barycentric: hit.weights,
            is_front: hit.is_front,
        }
    }
}

/// The ray as boxes see it: its start may be off by `loss`.
fn beam(start: DVec3, direction: DVec3, loss: f64) -> Beam {
    // Directions below this count as parallel to the sides of boxes: on its way past the surface the
    // ray moves less than the pad.
    const PARALLEL: f64 = 1.0 / (1_u64 << 50) as f64;
    const PAD: f64 = 1.0 / (1_u64 << 40) as f64;
    let mut beam = Beam { near: [0.0; 3], far: [0.0; 3], inverse: [0.0; 3] };
    for axis in 0..3 {
        let (x, mut d) = (start[axis], direction[axis]);
        let mut pad = loss;
        if d.abs() < PARALLEL {
            pad += PAD;
            d = PARALLEL;
        }
        let (lo, hi) = (below(x - pad), above(x + pad));
        (beam.near[axis], beam.far[axis]) = if d > 0.0 { (hi, lo) } else { (lo, hi) };
        beam.inverse[axis] = (1.0 / d) as f32;
    }
    beam
}
