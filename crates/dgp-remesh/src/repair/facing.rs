//! Which way open surfaces look: the side that is seen from outside is the outer one.
//!
//! From points spread over a component rays go out in opposite directions. A ray that leaves on the front
//! and meets nothing speaks for the front being outside, one on the back for the back; where both meet
//! something, the one that gets farther.
//!
//! - Input: a mesh of any polygons. Closed components are for `repair` to turn, by their volume.
//! - Cost: 2 rays for each sample, some log n each; 512 samples a component.
//! - Guarantees: the same for any number of threads; a component is turned only if its back is seen twice
//!   as often as its front.
//! - Reference: Takayama, Jacobson, Kavan and Sorkine-Hornung, "A simple method for correcting facet
//!   orientations in polygon meshes based on ray casting", JCGT 3(4), 2014.
//! - Departs from it: samples are spread evenly over the area instead of at random, and doubt keeps a
//!   component as it is.

use std::f64::consts::TAU;

use dgp_mesh::{
    CornerId, FaceId, FaceList, FaceSet, IndexedFaceSet, Mesh, Progress,
    spatial::{Ray, TriangleTree},
    topology::components,
};

use super::geometry;
use crate::Error;

/// Samples of each component.
const SAMPLES: usize = 512;
/// How many times as often the back must be seen as the front.
const MARGIN: f64 = 2.0;

/// The open components of `mesh` whose back is seen from outside and not their front, each by its faces.
///
/// Errors: [`Error::NotFinite`], [`Error::Cancelled`].
pub fn hidden_fronts(mesh: &Mesh, progress: Progress<'_>) -> Result<Vec<Vec<FaceId>>, Error> {
    geometry::need_finite(mesh)?;
    let parts = components(mesh).faces();
    let is_open = |part: &Vec<FaceId>| {
        part.iter().any(|&f| mesh.face_halfedges(f).any(|h| mesh.face(h.twin()).is_none()))
    };
    let open: Vec<Vec<FaceId>> = parts.into_iter().filter(is_open).collect();
    if open.is_empty() {
        progress.report(1.0)?;
        return Ok(open);
    }
    let tree = TriangleTree::new(mesh, progress.part(0.0, 0.3))?;
    let diagonal = geometry::diagonal(mesh);
    let mut turned = Vec::new();
    let count = open.len();
    for (k, part) in open.into_iter().enumerate() {
        let at = |k: usize| 0.3 + 0.7 * k as f64 / count as f64;
        let rays = rays(mesh, &part, diagonal);
        let hits = tree.first_hits(&rays, progress.part(at(k), at(k + 1)))?;
        let (mut front, mut back) = (0.0, 0.0);
        for pair in hits.chunks_exact(2) {
            match [pair[0].map(|hit| hit.t), pair[1].map(|hit| hit.t)] {
                [None, None] => {}
                [None, Some(_)] => front += 1.0,
                [Some(_), None] => back += 1.0,
                [Some(s), Some(t)] => {
                    let free = if s > t { &mut front } else { &mut back };
                    *free += 0.25 * f64::from(u8::from(s != t));
                }
            }
        }
        if back > MARGIN * front && back > 0.05 * SAMPLES as f64 {
            turned.push(part);
        }
    }
    progress.report(1.0)?;
    Ok(turned)
}

/// `mesh` with these components turned over; faces keep their first corner.
pub(super) fn turned(mesh: &Mesh, parts: &[Vec<FaceId>]) -> Result<Mesh, Error> {
    let turned: FaceSet = parts.iter().flatten().copied().collect();
    let set = mesh.to_indexed();
    let mut faces = FaceList::new();
    let mut corners = Vec::new();
    for (f, face) in set.faces().iter() {
        let mut face = face.to_vec();
        let start = set.faces().face_start(f).index();
        let mut sources: Vec<usize> = (start..start + face.len()).collect();
        if turned.contains(f) {
            face[1..].reverse();
            sources[1..].reverse();
        }
        faces.push(&face);
        corners.extend(sources);
    }
    let mut new = IndexedFaceSet::new(set.positions().clone(), faces)?;
    new.vertex_attributes = set.vertex_attributes;
    new.face_attributes = set.face_attributes;
    new.corner_attributes = set.corner_attributes.gather(corners.len(), |c: CornerId| {
        corners.get(c.index()).map(|&corner| CornerId::new(corner))
    });
    Ok(Mesh::new(&new)?)
}

/// Rays from the samples of a component, in pairs: in front and behind.
fn rays(mesh: &Mesh, part: &[FaceId], diagonal: f64) -> Vec<Ray> {
    let areas: Vec<f64> = part.iter().map(|&f| mesh.face_area(f)).collect();
    let total: f64 = areas.iter().sum();
    let mut rays = Vec::with_capacity(2 * SAMPLES);
    if !(total > 0.0 && total.is_finite()) {
        return rays;
    }
    let (mut k, mut below) = (0, 0.0);
    for i in 0..SAMPLES {
        let wanted = (i as f64 + 0.5) / SAMPLES as f64 * total;
        while k + 1 < part.len() && below + areas[k] < wanted {
            below += areas[k];
            k += 1;
        }
        let (origin, normal) = (mesh.face_center(part[k]), mesh.face_normal(part[k]));
        if !(origin.is_finite() && normal.is_normalized()) {
            continue;
        }
        // A direction of the hemisphere, by the golden angle and the cosine.
        let height = (((i * 193) % SAMPLES) as f64 + 0.5) / SAMPLES as f64;
        let around = TAU * (i as f64 * 0.5 * (5.0_f64.sqrt() - 1.0)).fract();
        let (cosine, sine) = (height.sqrt(), (1.0 - height).sqrt());
        let (u, v) = normal.any_orthonormal_pair();
        let direction = cosine * normal + sine * (around.cos() * u + around.sin() * v);
        // Off the surface by what rounding can be.
        let lift = 1e-9 * diagonal * normal;
        rays.push(Ray::new(origin + lift, direction));
        rays.push(Ray::new(origin - lift, -direction));
    }
    rays
}
