//! Least squares conformal maps: angles kept as well as possible, the boundary free.
//!
//! ```text
//! E(u) = ½ Σ w_ij |u_i − u_j|²  −  Σ ½ (u_i × u_j)      the second sum along the boundary
//!        Dirichlet energy          area of the picture
//! ```
//!
//! E ≥ 0, and 0 only where the map is conformal. Two vertices are held, or all would shrink to a point.
//!
//! - Input: triangles with area, a disk or a disk with holes.
//! - Cost: one Cholesky factorization of 2n − 4 unknowns.
//! - Guarantees: what can be unrolled is unrolled without error; moving, turning and scaling the pins does the same
//!   to the map. Folds are possible.
//! - Reference: Lévy, Petitjean, Ray and Maillot, "Least squares conformal maps for automatic texture atlas
//!   generation", 2002; Desbrun, Meyer and Alliez, "Intrinsic parameterizations of surface meshes", 2002.

use dgp_mesh::{DVec2, Mesh, Progress, VertexId, VertexMap, measure::cotangent_weights};
use dgp_sparse::{CholeskyOptions, FixedSystem, SparseMatrix};

use crate::{Error, disk_boundary, error::with_progress, fixed::from_edges};

/// A vertex that is held, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pin {
    /// The vertex.
    pub vertex: VertexId,
    /// Where it is in the plane.
    pub position: DVec2,
}

/// Lays out `mesh` in the plane with angles kept as well as possible.
///
/// Two or more `pins` hold it; without any, two vertices of the boundary far from each other are held as far
/// apart as they are in space, the first at the origin and the second on the positive u axis.
///
/// Errors: those of [`disk_boundary`](disk_boundary()); [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`];
/// [`Error::NoArea`]; [`Error::Pins`]; [`Error::Solve`]; [`Error::Cancelled`].
pub fn least_squares_conformal(
    mesh: &Mesh,
    pins: &[Pin],
    progress: Progress<'_>,
) -> Result<VertexMap<DVec2>, Error> {
    progress.report(0.0)?;
    let boundary = disk_boundary(mesh)?;
    if let Some(face) = mesh.faces().find(|&f| mesh.face_vector_area(f).length() == 0.0) {
        return Err(Error::NoArea { face });
    }
    let chosen;
    let pins = if pins.is_empty() {
        chosen = far_apart(mesh, &boundary);
        &chosen[..]
    } else {
        pins
    };
    check_pins(mesh, pins)?;
    let n = mesh.vertex_count();
    let energy = conformal_energy(mesh)?;
    let fixed: Vec<u32> = pins
        .iter()
        .flat_map(|pin| [pin.vertex.index(), n + pin.vertex.index()])
        .map(|i| i as u32)
        .collect();
    let values: Vec<f64> = pins.iter().flat_map(|pin| pin.position.to_array()).collect();
    let flat = with_progress(progress.part(0.1, 1.0), |progress| {
        let system = FixedSystem::new(&energy, &fixed, &CholeskyOptions::default(), progress)?;
        system.solve(&vec![0.0; 2 * n], &values)
    })?;
    progress.report(1.0)?;
    let (u, v) = flat.split_at(n);
    Ok(u.iter().zip(v).map(|(&u, &v)| DVec2::new(u, v)).collect::<Vec<_>>().into())
}

/// The matrix A with E(u) = ½ uᵀ A u, all first coordinates before all second ones.
fn conformal_energy(mesh: &Mesh) -> Result<SparseMatrix, Error> {
    let laplacian = from_edges(mesh, &cotangent_weights(mesh)?)?;
    let n = mesh.vertex_count() as u32;
    let mut triplets = Vec::with_capacity(2 * laplacian.entries() + 4 * 64);
    for (i, j, value) in laplacian.triplets() {
        let (i, j) = (i as u32, j as u32);
        triplets.push((i, j, value));
        triplets.push((n + i, n + j, value));
    }
    for h in mesh.halfedges().filter(|&h| mesh.is_boundary_halfedge(h)) {
        // The surface lies left of the twin: its boundary runs from the end of `h` to its start.
        let (a, b) = (mesh.to(h).index() as u32, mesh.from(h).index() as u32);
        for (i, j, value) in [(a, n + b, -0.5), (b, n + a, 0.5)] {
            triplets.push((i, j, value));
            triplets.push((j, i, value));
        }
    }
    Ok(SparseMatrix::from_triplets(2 * n as usize, 2 * n as usize, &triplets)?)
}

/// Two vertices of the boundary: the one farthest from its first, and the one farthest from that.
fn far_apart(mesh: &Mesh, boundary: &[VertexId]) -> Vec<Pin> {
    let farthest = |from: VertexId| {
        let distance = |v: VertexId| mesh.position(v).distance_squared(mesh.position(from));
        // The first of equals.
        boundary.iter().rev().copied().max_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    };
    let Some(first) = boundary.first().and_then(|&v| farthest(v)) else { return Vec::new() };
    let Some(second) = farthest(first) else { return Vec::new() };
    let length = mesh.position(first).distance(mesh.position(second));
    vec![
        Pin { vertex: first, position: DVec2::ZERO },
        Pin { vertex: second, position: DVec2::new(length, 0.0) },
    ]
}

fn check_pins(mesh: &Mesh, pins: &[Pin]) -> Result<(), Error> {
    let problem = |problem| Err(Error::Pins { problem });
    if pins.len() < 2 {
        return problem("fewer than two vertices are held");
    }
    let mut vertices: Vec<VertexId> = pins.iter().map(|pin| pin.vertex).collect();
    vertices.sort_unstable();
    if vertices.iter().any(|v| v.index() >= mesh.vertex_count()) {
        return problem("a vertex that is held is not in the mesh");
    }
    if vertices.windows(2).any(|pair| pair[0] == pair[1]) {
        return problem("a vertex is held twice");
    }
    if pins.iter().any(|pin| !pin.position.is_finite()) {
        return problem("the place of a vertex that is held is not finite");
    }
    if pins.iter().all(|pin| pin.position == pins[0].position) {
        return problem("all vertices that are held are at one place");
    }
    Ok(())
}
