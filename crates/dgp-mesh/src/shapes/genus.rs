//! Closed surfaces with any number of handles.
//!
//! A plate of 2g + 1 by 3 blocks without g of the inner ones has genus g by construction. Rounds of
//! splitting its quads and averaging make it smooth: the averaging form of Catmull–Clark
//! subdivision, in which each new vertex moves to the mean of the centers of the quads around it.
//!
//! - Input: the number of handles, and how often to split.
//! - Cost: O(faces).
//! - Reference: Warren and Weimer, *Subdivision Methods for Geometric Design*, 2001, section 7.3.

use glam::DVec3;

use super::{Tiling, face_count, manifold};
use crate::{Error, FaceList, Mesh, VertexId};

/// A smooth closed surface of this `genus`, a chain of loops along the x axis, from `level` rounds of
/// splitting: 4^level·(8·genus + 14)·2 triangles or so. Genus 0 is a rounded plate.
pub fn surface_of_genus(genus: usize, level: usize) -> Result<Mesh, Error> {
    tiled(genus, level, Tiling::Triangles)
}

/// [`surface_of_genus`] in quads.
pub fn quad_surface_of_genus(genus: usize, level: usize) -> Result<Mesh, Error> {
    tiled(genus, level, Tiling::Quads)
}

fn tiled(genus: usize, level: usize, tiling: Tiling) -> Result<Mesh, Error> {
    let quads_per_quad = 1_usize << (2 * level.min(31));
    face_count(&[2, genus.saturating_add(1), 34, quads_per_quad])?;
    let mut mesh = plate(genus)?;
    for _ in 0..level {
        mesh = refine(&mesh)?;
    }
    if tiling == Tiling::Quads {
        return Ok(mesh);
    }
    let mut triangles = Vec::with_capacity(2 * mesh.face_count());
    let faces = mesh.to_faces();
    for &[a, b, c, d] in faces.corners().as_chunks::<4>().0 {
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    manifold(mesh.positions().values().to_vec(), &FaceList::from_triangles(triangles))
}

/// The surface of a plate of unit blocks with `genus` holes, around the origin.
fn plate(genus: usize) -> Result<Mesh, Error> {
    let [columns, rows] = [2 * genus + 1, 3];
    let vertex = |[i, j, k]: [usize; 3]| VertexId::new((j * (columns + 1) + i) * 2 + k);
    let is_block = |i: usize, j: usize| i < columns && j < rows && !(j == 1 && i % 2 == 1);
    let mut faces = FaceList::new();
    for j in 0..rows {
        for i in (0..columns).filter(|&i| is_block(i, j)) {
            let mut side = |[a, b, c, d]: [[usize; 3]; 4]| {
                faces.push(&[a, b, c, d].map(vertex));
            };
            side([[i, j, 1], [i + 1, j, 1], [i + 1, j + 1, 1], [i, j + 1, 1]]);
            side([[i, j, 0], [i, j + 1, 0], [i + 1, j + 1, 0], [i + 1, j, 0]]);
            // Below 0 wraps around to a huge number, which is no block.
            if !is_block(i, j.wrapping_sub(1)) {
                side([[i, j, 0], [i + 1, j, 0], [i + 1, j, 1], [i, j, 1]]);
            }
            if !is_block(i, j + 1) {
                side([[i, j + 1, 0], [i, j + 1, 1], [i + 1, j + 1, 1], [i + 1, j + 1, 0]]);
            }
            if !is_block(i.wrapping_sub(1), j) {
                side([[i, j, 0], [i, j, 1], [i, j + 1, 1], [i, j + 1, 0]]);
            }
            if !is_block(i + 1, j) {
                side([[i + 1, j, 0], [i + 1, j + 1, 0], [i + 1, j + 1, 1], [i + 1, j, 1]]);
            }
        }
    }
    let middle = DVec3::new(columns as f64, rows as f64, 1.0) / 2.0;
    let mut positions = Vec::with_capacity(2 * (columns + 1) * (rows + 1));
    for j in 0..=rows {
        for i in 0..=columns {
            positions.extend([0.0, 1.0].map(|k| DVec3::new(i as f64, j as f64, k) - middle));
        }
    }
    manifold(positions, &faces)
}

/// Splits each quad into four, then moves each vertex to the mean of the centers around it.
fn refine(mesh: &Mesh) -> Result<Mesh, Error> {
    let mean = |points: &mut dyn Iterator<Item = DVec3>| points.sum::<DVec3>() / 4.0;
    let centers = mesh.map_faces(|f| mean(&mut mesh.face_vertices(f).map(|v| mesh.position(v))));
    let [vertices, edges] = [mesh.vertex_count(), mesh.edge_count()];
    let mut split = mesh.positions().values().to_vec();
    split.extend(mesh.edges().map(|e| {
        let [v, w] = mesh.edge_vertices(e);
        0.5 * (mesh.position(v) + mesh.position(w))
    }));
    split.extend(centers.values());
    let mut faces = FaceList::new();
    faces.reserve(0, 16 * mesh.face_count());
    for f in mesh.faces() {
        for h in mesh.face_halfedges(f) {
            let middle = |h: crate::HalfedgeId| VertexId::new(vertices + h.edge().index());
            let center = VertexId::new(vertices + edges + f.index());
            faces.push(&[mesh.from(h), middle(h), center, middle(mesh.prev(h))]);
        }
    }
    let mut fine = manifold(split, &faces)?;
    let centers = fine.map_faces(|f| mean(&mut fine.face_vertices(f).map(|v| fine.position(v))));
    let averaged = fine.map_vertices(|v| {
        let sum = fine.vertex_faces(v).map(|f| centers[f]).sum::<DVec3>();
        sum / fine.valence(v) as f64
    });
    fine.set_positions(averaged);
    Ok(fine)
}
