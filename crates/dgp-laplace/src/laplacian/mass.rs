//! Mass: how much of the surface belongs to each vertex.
//!
//! ```text
//! Barycentric     M(i, i) = Σ area / 3
//! MixedVoronoi    M(i, i) = area nearer to i than to others, safe for obtuse triangles
//! Galerkin        M(i, i) = Σ area / 6,  M(i, j) = Σ area / 12 over the triangles at edge ij:  ∫ φᵢ φⱼ
//! ```
//!
//! - Input: any mesh for barycentric masses, triangles for the others.
//! - Cost: O(V) time and memory.
//! - Guarantees: 1ᵀ M 1 is the area. Vertices on no face, and those whose faces have no area, have 0.
//! - Reference: Meyer et al. 2003 (mixed Voronoi); Strang and Fix, *An Analysis of the Finite Element
//!   Method*, 1973.

use dgp_mesh::{
    EdgeMap, Mesh, VertexMap,
    measure::{VertexArea, face_areas, require_triangles, vertex_areas},
};
use dgp_sparse::SparseMatrix;

use super::assemble::matrix;
use crate::Error;

/// Which mass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MassKind {
    /// Diagonal: a third of each triangle.
    #[default]
    Barycentric,
    /// Diagonal: by nearness (Meyer et al. 2003).
    MixedVoronoi,
    /// The full matrix of linear finite elements.
    Galerkin,
}

/// The mass matrix of `mesh`.
///
/// Errors: [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`] for a Galerkin mass of polygons.
pub fn mass_matrix(mesh: &Mesh, kind: MassKind) -> Result<SparseMatrix, Error> {
    let lumped = |kind| Ok(SparseMatrix::from_diagonal(vertex_areas(mesh, kind).values()));
    match kind {
        MassKind::Barycentric => lumped(VertexArea::Barycentric),
        MassKind::MixedVoronoi => lumped(VertexArea::MixedVoronoi),
        MassKind::Galerkin => galerkin(mesh),
    }
}

/// The diagonal of the barycentric mass: a third of the area around each vertex.
pub fn vertex_masses(mesh: &Mesh) -> VertexMap<f64> {
    vertex_areas(mesh, VertexArea::Barycentric)
}

fn galerkin(mesh: &Mesh) -> Result<SparseMatrix, Error> {
    require_triangles(mesh)?;
    let areas = face_areas(mesh);
    let mut diagonal = vec![0.0; mesh.vertex_count()];
    for f in mesh.faces() {
        mesh.face_vertices(f).for_each(|v| diagonal[v.index()] += areas[f] / 6.0);
    }
    let shared: EdgeMap<f64> =
        mesh.map_edges(|e| mesh.edge_faces(e).into_iter().flatten().map(|f| areas[f] / 12.0).sum());
    matrix(mesh, &diagonal, |e| [shared[e]; 2])
}
