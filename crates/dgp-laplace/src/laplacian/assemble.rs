//! From values at edges to a matrix: count, then fill, without sorting.
//!
//! A mesh numbers its edges by their smaller, then by their larger vertex. Going through them in this
//! order, what each column has above its diagonal comes in order, and what it has below does too. Edges
//! of edited meshes are brought into that order first, by counting.

use dgp_mesh::{Connectivity, EdgeId};
use dgp_sparse::SparseMatrix;

use crate::Error;

/// The matrix with these entries: for an edge from a to b, a < b, `edge` gives that of row a, column b
/// and that of row b, column a.
pub(super) fn matrix(
    mesh: &Connectivity,
    diagonal: &[f64],
    edge: impl Fn(EdgeId) -> [f64; 2],
) -> Result<SparseMatrix, Error> {
    let n = mesh.vertex_count();
    let ends = |e: EdgeId| {
        let [a, b] = mesh.edge_vertices(e).map(|v| v.index() as u32);
        [a.min(b), a.max(b)]
    };
    let (mut starts, mut above) = (vec![0_u32; n + 1], vec![0_u32; n]);
    let (mut last, mut is_sorted) = ([0, 0], true);
    for e in mesh.edges() {
        let [a, b] = ends(e);
        is_sorted &= last <= [a, b];
        last = [a, b];
        starts[a as usize + 1] += 1;
        starts[b as usize + 1] += 1;
        above[b as usize] += 1;
    }
    for v in 0..n {
        starts[v + 1] += starts[v] + 1;
    }
    let count = starts[n] as usize;
    let (mut indices, mut values) = (vec![0_u32; count], vec![0.0; count]);
    // From here on, `above` is where the next entry above the diagonal goes, `below` likewise.
    let mut below = vec![0_u32; n];
    for v in 0..n {
        let place = starts[v] + above[v];
        indices[place as usize] = v as u32;
        values[place as usize] = diagonal[v];
        above[v] = starts[v];
        below[v] = place + 1;
    }
    let mut put = |e: EdgeId| {
        let ([a, b], [upper, lower]) = (ends(e), edge(e));
        for (column, row, next, value) in [(b, a, &mut above, upper), (a, b, &mut below, lower)] {
            let place = &mut next[column as usize];
            indices[*place as usize] = row;
            values[*place as usize] = value;
            *place += 1;
        }
    };
    if is_sorted {
        mesh.edges().for_each(&mut put);
    } else {
        let by_larger = counting_sort(n, mesh.edges(), |e| ends(e)[1]);
        let sorted = counting_sort(n, by_larger.into_iter(), |e| ends(e)[0]);
        sorted.into_iter().for_each(&mut put);
    }
    Ok(SparseMatrix::from_columns(n, starts, indices, values)?)
}

/// The edges by increasing `key` below `n`, those of equal key in the order given.
fn counting_sort(
    n: usize,
    edges: impl Iterator<Item = EdgeId>,
    key: impl Fn(EdgeId) -> u32,
) -> Vec<EdgeId> {
    let edges: Vec<EdgeId> = edges.collect();
    let mut next = vec![0_u32; n + 1];
    for &e in &edges {
        next[key(e) as usize + 1] += 1;
    }
    (0..n).for_each(|v| next[v + 1] += next[v]);
    let mut sorted = vec![EdgeId::new(0); edges.len()];
    for e in edges {
        let place = &mut next[key(e) as usize];
        sorted[*place as usize] = e;
        *place += 1;
    }
    sorted
}

/// The Laplacian with a weight for each edge.
pub(super) fn symmetric(
    mesh: &Connectivity,
    weight: impl Fn(EdgeId) -> f64,
) -> Result<SparseMatrix, Error> {
    let mut diagonal = vec![0.0; mesh.vertex_count()];
    for e in mesh.edges() {
        let w = weight(e);
        for v in mesh.edge_vertices(e) {
            diagonal[v.index()] += w;
        }
    }
    // Not −0 where a weight is 0.
    matrix(mesh, &diagonal, |e| [0.0 - weight(e); 2])
}
