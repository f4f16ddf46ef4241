//! New vertices in a patch, until its edges are about as long as those around.
//!
//! ```text
//! σ(v) = mean length of the edges at v outside of the patch;   σ(m) = mean of the corners' σ, m the center
//! split at m where  α |m − v| > σ(m) and α |m − v| > σ(v)  for every corner v
//! ```
//!
//! After each round of splits edges are flipped as long as the angles opposite to one sum up to more than π.
//!
//! - Input: a patch of triangles, and σ on its rim.
//! - Cost: O(new vertices) splits, and about as many flips for each.
//! - Reference: Liepa, "Filling holes in meshes", 2003; Pfeifle and Seidel, "Triangular B-splines for
//!   blending and filling of polygonal holes", 1996.
//! - Departs from it: angles instead of spheres tell which edges to flip, so that flips come to an end.

use std::{collections::BTreeMap, f64::consts::PI};

use dgp_mesh::{EdgeId, EdgeSet, Editor, FaceId, FaceSet, HalfedgeId, Mesh, Progress, VertexId};

use crate::Error;

/// Rounds of splits, at most: each halves the edges about.
const ROUNDS: usize = 40;

/// Angles that sum up to no more than π and this are left as they are.
const SLACK: f64 = 1e-9;

/// σ of the corners of a rim.
pub(super) fn scales(mesh: &Mesh, rim: &[HalfedgeId]) -> BTreeMap<VertexId, f64> {
    let scale = |v: VertexId| {
        let (mut sum, mut count) = (0.0, 0);
        for h in mesh.vertex_halfedges(v) {
            sum += mesh.edge_length(h.edge());
            count += 1;
        }
        (v, sum / f64::from(count))
    };
    rim.iter().map(|&h| scale(mesh.from(h))).collect()
}

/// Splits and flips until nothing is too long. Returns the new vertices.
pub(super) fn refine(
    editor: &mut Editor<'_>,
    patch: &mut FaceSet,
    mut scales: BTreeMap<VertexId, f64>,
    density: f64,
    progress: Progress<'_>,
) -> Result<Vec<VertexId>, Error> {
    let mut vertices = Vec::new();
    relax(editor, patch, patch.iter().collect());
    for round in 0..ROUNDS {
        progress.report(round as f64 / ROUNDS as f64)?;
        let mut changed = Vec::new();
        for f in patch.iter().collect::<Vec<FaceId>>() {
            let mesh = editor.mesh();
            let corners: Vec<VertexId> = mesh.face_vertices(f).collect();
            let center = mesh.face_center(f);
            let scale = corners.iter().map(|v| scales[v]).sum::<f64>() / corners.len() as f64;
            let is_large = corners.iter().all(|&v| {
                let distance = density * center.distance(mesh.position(v));
                distance > scale && distance > scales[&v]
            });
            if !is_large {
                continue;
            }
            let v = editor.split_face(f, center).map_err(Error::Edit)?;
            scales.insert(v, scale);
            vertices.push(v);
            let around: Vec<FaceId> = editor.mesh().vertex_faces(v).collect();
            patch.extend(around.iter().copied());
            changed.extend(around);
        }
        if changed.is_empty() {
            break;
        }
        relax(editor, patch, changed);
    }
    Ok(vertices)
}

/// Flips edges inside the patch, from those of some faces on, until all are as they should be.
fn relax(editor: &mut Editor<'_>, patch: &FaceSet, faces: Vec<FaceId>) {
    let mut waiting: Vec<EdgeId> = Vec::new();
    let mut queued = EdgeSet::new();
    for f in faces {
        for h in editor.mesh().face_halfedges(f) {
            if queued.insert(h.edge()) {
                waiting.push(h.edge());
            }
        }
    }
    // Each flip makes the patch better by a finite amount; the limit is for rounding.
    let mut left = 50 * waiting.len() + 1000;
    while let Some(e) = waiting.pop() {
        queued.remove(e);
        if !is_inside(editor.mesh(), patch, e) || opposite_angles(editor.mesh(), e) <= PI + SLACK {
            continue;
        }
        if left == 0 || editor.flip(e).is_err() {
            continue;
        }
        left -= 1;
        for h in e.halfedges() {
            for side in editor.mesh().loop_halfedges(h) {
                if side.edge() != e && queued.insert(side.edge()) {
                    waiting.push(side.edge());
                }
            }
        }
    }
}

fn is_inside(mesh: &Mesh, patch: &FaceSet, e: EdgeId) -> bool {
    e.halfedges().into_iter().all(|h| mesh.face(h).is_some_and(|f| patch.contains(f)))
}

/// The sum of the angles opposite to an edge of two triangles.
fn opposite_angles(mesh: &Mesh, e: EdgeId) -> f64 {
    e.halfedges().into_iter().map(|h| mesh.corner_angle(mesh.prev(h))).sum()
}
