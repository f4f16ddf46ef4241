//! The smoothest surface through a patch that continues what is around it.
//!
//! ```text
//! minimize  Σ |(L x)ᵢ|² / mᵢ  over the vertices inside the patch and on its rim
//! ```
//!
//! L has the cotangent weights of the refined patch, m are the areas around vertices. Inside, that is L M⁻¹ L x =
//! 0, the equation of a thin plate; the terms of the rim make the surface leave it as it arrives.
//!
//! - Input: vertices with triangles around them, and one more ring of the mesh.
//! - Cost: one factorization for the unknowns.
//! - Reference: Botsch and Kobbelt, "An intuitive framework for real-time freeform modeling", 2004; Liepa,
//!   "Filling holes in meshes", 2003.
//! - Departs from it: weights are kept between 0.05 and 20, because slivers of the cover would have others.

use std::collections::{BTreeMap, BTreeSet};

use dgp_mesh::{DVec3, EdgeId, Editor, Mesh, Progress, VertexId};
use dgp_sparse::{CholeskyOptions, FixedSystem, SparseMatrix};

use crate::Error;

/// The smallest weight of an edge, and the inverse of the largest.
const SMALLEST: f64 = 0.05;

/// Moves some vertices to where the surface is smoothest.
pub(super) fn fair(
    editor: &mut Editor<'_>,
    vertices: &[VertexId],
    progress: Progress<'_>,
) -> Result<(), Error> {
    let mesh = editor.mesh();
    // The unknown vertices come first, then the rim, then what is needed for the Laplacian there.
    let mut place: BTreeMap<VertexId, u32> = BTreeMap::new();
    let mut all: Vec<VertexId> = Vec::new();
    let mut add = |v: VertexId, all: &mut Vec<VertexId>| {
        if let std::collections::btree_map::Entry::Vacant(free) = place.entry(v) {
            free.insert(all.len() as u32);
            all.push(v);
        }
    };
    for &v in vertices {
        add(v, &mut all);
    }
    let unknown = all.len();
    let mut inner = unknown;
    for ring in 0..2 {
        for i in 0..all.len() {
            for w in mesh.vertex_neighbors(all[i]) {
                add(w, &mut all);
            }
        }
        if ring == 0 {
            inner = all.len();
        }
    }
    let mut seen: BTreeSet<EdgeId> = BTreeSet::new();
    let mut edges = Vec::new();
    for &v in &all[..inner] {
        for h in mesh.vertex_halfedges(v) {
            if seen.insert(h.edge()) {
                let [a, b] = mesh.edge_vertices(h.edge());
                edges.push((place[&a], place[&b], weight(mesh, h.edge())));
            }
        }
    }
    let laplacian = SparseMatrix::from_edges(all.len(), &edges).map_err(Error::Solve)?;
    let mut inverse_mass = vec![0.0; all.len()];
    for (i, &v) in all[..inner].iter().enumerate() {
        let area: f64 = mesh.vertex_faces(v).map(|f| mesh.face_area(f) / 3.0).sum();
        inverse_mass[i] = if area > 0.0 { 1.0 / area } else { 0.0 };
    }
    let largest = inverse_mass.iter().copied().fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        // The whole patch is a point: nothing is smoother.
        return Ok(());
    }
    for m in &mut inverse_mass {
        *m /= largest;
    }
    progress.report(0.2)?;
    let energy = laplacian.gram(&inverse_mass).map_err(Error::Solve)?;
    let fixed: Vec<u32> = (unknown as u32..all.len() as u32).collect();
    let options = CholeskyOptions::default();
    let system = FixedSystem::new(&energy, &fixed, &options, dgp_sparse::Progress::NONE)
        .map_err(Error::Solve)?;
    progress.report(0.8)?;
    // Relative to a point nearby, so that digits are not lost far from the origin.
    let origin = mesh.position(all[unknown]);
    let around: Vec<DVec3> = all[unknown..].iter().map(|&v| mesh.position(v) - origin).collect();
    let values: Vec<f64> = (0..3).flat_map(|k| around.iter().map(move |p| p[k])).collect();
    let solution =
        system.solve_many(&vec![0.0; 3 * all.len()], &values, 3).map_err(Error::Solve)?;
    for (i, &v) in vertices.iter().enumerate() {
        let coordinate = |k: usize| solution[k * all.len() + i];
        editor.set_position(v, origin + DVec3::new(coordinate(0), coordinate(1), coordinate(2)));
    }
    Ok(())
}

/// Half of the cotangents opposite to an edge, within bounds.
fn weight(mesh: &Mesh, e: EdgeId) -> f64 {
    let triangles =
        e.halfedges().into_iter().filter(|&h| mesh.face(h).is_some_and(|f| mesh.degree(f) == 3));
    let sum: f64 = triangles.map(|h| 0.5 * mesh.cotangent(h)).sum();
    if sum.is_finite() { sum.clamp(SMALLEST, 1.0 / SMALLEST) } else { 1.0 / SMALLEST }
}
