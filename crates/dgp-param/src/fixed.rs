//! Maps to the plane whose boundary is given: every other vertex is the weighted mean of its neighbors.
//!
//! ```text
//! Σ_j w_ij (u_j − u_i) = 0     inside;     u_i as given     at the boundary
//! ```
//!
//! | weights | w_ij | on a convex outline |
//! |---|---|---|
//! | uniform (Tutte) | 1 | never folds |
//! | mean value (Floater) | (tan γ/2 + tan δ/2)/‖p_i − p_j‖ | never folds |
//! | harmonic (Eck) | (cot α + cot β)/2 | may fold where α + β > π |
//!
//! [`map_with_laplacian`] takes any other matrix, such as that of the intrinsic Delaunay triangulation, inside of
//! which no weight is negative.
//!
//! - Input: triangles (any polygons for uniform and mean value weights), a disk or a disk with holes whose rims
//!   are free.
//! - Cost: one factorization; uniform and harmonic weights by Cholesky, mean value by LU.
//! - Guarantees: linear functions of a flat mesh are reproduced by harmonic and mean value weights. With
//!   positive weights and a convex outline no face folds over (Tutte, Floater), unless all its corners come to
//!   lie on one side of the outline.
//! - Reference: Tutte, "How to draw a graph", 1963; Eck et al., "Multiresolution analysis of arbitrary
//!   meshes", 1995; Floater, "Mean value coordinates", 2003.

use dgp_mesh::{
    DVec2, EdgeMap, HalfedgeId, HalfedgeMap, Mesh, Progress, VertexId, VertexMap,
    measure::{cotangent_weights, edge_lengths},
};
use dgp_sparse::{CholeskyOptions, FixedSystem, Lu, SparseMatrix};

use crate::{Error, error::with_progress};

/// How much each neighbor counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Weights {
    /// All the same (Tutte 1963): never folds, keeps no shape.
    Uniform,
    /// Cotangents (Eck et al. 1995): least stretched on average, may fold where triangles are obtuse.
    Harmonic,
    /// Tangents of half angles (Floater 2003): never folds, nearly harmonic.
    #[default]
    MeanValue,
}

/// Lays out `mesh` in the plane, the vertices of `boundary` at `positions`.
///
/// `boundary` may also be a part of the vertices of a loop, or other vertices: what is not listed is free. On a
/// [convex outline](crate::convex_boundary) uniform and mean value weights never fold a face.
///
/// Errors: [`Error::WrongLength`]; [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`] for harmonic
/// weights; [`Error::NoWeight`] where edges have no length; [`Error::Solve`] where a piece has no vertex
/// that is held; [`Error::Cancelled`].
pub fn map_to_boundary(
    mesh: &Mesh,
    boundary: &[VertexId],
    positions: &[DVec2],
    weights: Weights,
    progress: Progress<'_>,
) -> Result<VertexMap<DVec2>, Error> {
    progress.report(0.0)?;
    let laplacian = match weights {
        Weights::Uniform => from_edges(mesh, &vec![1.0; mesh.edge_count()].into())?,
        Weights::Harmonic => from_edges(mesh, &cotangent_weights(mesh)?)?,
        Weights::MeanValue => mean_value(mesh)?,
    };
    map_with_laplacian(&laplacian, boundary, positions, progress)
}

/// The same with the weights of a matrix: w_ij = −L(i, j), the rows summing to zero. Symmetric matrices are
/// factored by Cholesky, others by LU.
///
/// Errors: [`Error::WrongLength`]; [`Error::Solve`], also where the matrix is not square or names no such
/// vertex; [`Error::Cancelled`].
pub fn map_with_laplacian(
    laplacian: &SparseMatrix,
    boundary: &[VertexId],
    positions: &[DVec2],
    progress: Progress<'_>,
) -> Result<VertexMap<DVec2>, Error> {
    Error::check_length("the positions of the boundary", positions.len(), boundary.len())?;
    laplacian.check_square()?;
    progress.report(0.0)?;
    let fixed: Vec<u32> = boundary.iter().map(|v| v.index() as u32).collect();
    let values: Vec<f64> =
        [0, 1].iter().flat_map(|&k| positions.iter().map(move |p| p[k])).collect();
    let solve = if laplacian.check_symmetric().is_ok() { symmetric } else { unsymmetric };
    let flat = solve(laplacian, &fixed, &values, progress.part(0.1, 1.0))?;
    progress.report(1.0)?;
    let (u, v) = flat.split_at(laplacian.rows());
    Ok(u.iter().zip(v).map(|(&u, &v)| DVec2::new(u, v)).collect::<Vec<_>>().into())
}

/// The Laplacian with a weight for each edge.
pub(crate) fn from_edges(mesh: &Mesh, weights: &EdgeMap<f64>) -> Result<SparseMatrix, Error> {
    let edge = |e| {
        let [a, b] = mesh.edge_vertices(e).map(|v| v.index() as u32);
        (a, b, weights[e])
    };
    let edges: Vec<(u32, u32, f64)> = mesh.edges().map(edge).collect();
    Ok(SparseMatrix::from_edges(mesh.vertex_count(), &edges)?)
}

/// The matrix of mean value coordinates; row i has the weights of vertex i.
fn mean_value(mesh: &Mesh) -> Result<SparseMatrix, Error> {
    let lengths = edge_lengths(mesh);
    let tangents: HalfedgeMap<f64> = mesh.map_halfedges(|h| match mesh.face(h) {
        Some(_) => (0.5 * mesh.corner_angle(h)).tan(),
        None => 0.0,
    });
    // Left of h lies the corner of h; right of it that of the next spoke clockwise.
    let weight = |h: HalfedgeId| (tangents[h] + tangents[mesh.cw(h)]) / lengths[h.edge()];
    let mut triplets = Vec::with_capacity(2 * mesh.halfedge_count());
    for h in mesh.halfedges() {
        let weight = weight(h);
        if !weight.is_finite() {
            return Err(Error::NoWeight { edge: h.edge() });
        }
        let (i, j) = (mesh.from(h).index() as u32, mesh.to(h).index() as u32);
        triplets.extend([(i, i, weight), (i, j, -weight)]);
    }
    let n = mesh.vertex_count();
    Ok(SparseMatrix::from_triplets(n, n, &triplets)?)
}

/// Both coordinates, one after the other.
fn symmetric(
    laplacian: &SparseMatrix,
    fixed: &[u32],
    values: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<f64>, Error> {
    if fixed.len() == laplacian.rows() {
        return Ok(in_place(laplacian.rows(), fixed, values));
    }
    with_progress(progress, |progress| {
        let options = CholeskyOptions::default();
        let system = FixedSystem::new(laplacian, fixed, &options, progress)?;
        Ok(system.solve_many(&vec![0.0; 2 * laplacian.rows()], values, 2)?)
    })
}

/// The same where row i has the weights of vertex i and column i others.
fn unsymmetric(
    laplacian: &SparseMatrix,
    fixed: &[u32],
    values: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<f64>, Error> {
    let n = laplacian.rows();
    let mut all = in_place(n, fixed, values);
    let mut is_fixed = vec![false; n];
    for (entry, &row) in fixed.iter().enumerate() {
        let row = row as usize;
        let Some(fixed) = is_fixed.get_mut(row) else {
            let (column, rows, columns) = (row, n, n);
            return Err(dgp_sparse::Error::OutOfRange { entry, row, column, rows, columns }.into());
        };
        *fixed = true;
    }
    let free: Vec<u32> = (0..n as u32).filter(|&i| !is_fixed[i as usize]).collect();
    if free.is_empty() {
        return Ok(all);
    }
    let inner = laplacian.submatrix(&free, &free)?;
    let mut rhs = Vec::with_capacity(2 * free.len());
    for known in all.chunks_exact(n) {
        // What is free is still zero.
        let product = laplacian.product(known);
        rhs.extend(free.iter().map(|&i| -product[i as usize]));
    }
    let solution = with_progress(progress, |progress| {
        let lu = Lu::new(&inner, progress)?;
        lu.solve_many(&rhs)
    })?;
    for (x, solution) in all.chunks_exact_mut(n).zip(solution.chunks_exact(free.len())) {
        free.iter().zip(solution).for_each(|(&i, &value)| x[i as usize] = value);
    }
    Ok(all)
}

/// Known values at their places, 0 elsewhere.
fn in_place(n: usize, fixed: &[u32], values: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; 2 * n];
    for (x, values) in all.chunks_exact_mut(n.max(1)).zip(values.chunks_exact(fixed.len().max(1))) {
        for (&row, &value) in fixed.iter().zip(values) {
            if let Some(place) = x.get_mut(row as usize) {
                *place = value;
            }
        }
    }
    all
}
