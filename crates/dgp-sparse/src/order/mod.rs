//! In which order to eliminate the rows, so that the factor stays sparse.

mod dissection;
mod graph;
mod minimum_degree;
mod tree;

pub(crate) use graph::Graph;
use minimum_degree::minimum_degree;
pub(crate) use tree::{NONE, Tree};

use crate::{Error, Progress, SparseMatrix};

/// How to find the order in which a Cholesky factorization eliminates the rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Ordering {
    /// Minimum degree for small matrices, dissection for large ones.
    #[default]
    Automatic,
    /// Eliminates the row with the fewest neighbors first (Amestoy, Davis, Duff 1996).
    MinimumDegree,
    /// Cuts the graph in two by few rows, which are eliminated last, and so on (George 1973).
    Dissection,
    /// As the rows stand.
    Natural,
    /// As listed: entry `k` is the row that is eliminated as the `k`-th.
    Given(Vec<u32>),
}

/// Below this number of rows a minimum degree order and one factorization take no longer than dissection
/// and its cheaper factorization, and fill in little more: measured on spheres and on gyroids.
const DISSECTION_PAYS: usize = 60_000;

/// The order in which to eliminate the rows of a symmetric matrix: entry `k` is the row that is
/// eliminated as the `k`-th.
pub fn elimination_order(
    matrix: &SparseMatrix,
    ordering: &Ordering,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    matrix.check_symmetric()?;
    order(&Graph::of(matrix), ordering, progress)
}

/// The same for a graph.
pub(crate) fn order(
    graph: &Graph,
    ordering: &Ordering,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    let n = graph.len();
    progress.report(0.0)?;
    match ordering {
        Ordering::Natural => Ok((0..n as u32).collect()),
        Ordering::Given(order) => inverse(order, n).map(|_| order.clone()),
        Ordering::MinimumDegree => Ok(minimum_degree(graph)),
        Ordering::Automatic if n < DISSECTION_PAYS => Ok(minimum_degree(graph)),
        Ordering::Automatic | Ordering::Dissection => dissection::dissection(graph, progress),
    }
}

/// At which place each row stands in `order`.
pub(crate) fn inverse(order: &[u32], n: usize) -> Result<Vec<u32>, Error> {
    let mut place = vec![NONE; n];
    for (k, &row) in order.iter().enumerate() {
        match place.get_mut(row as usize) {
            Some(free) if *free == NONE => *free = k as u32,
            _ => return Err(Error::NotPermutation { row: row as usize }),
        }
    }
    match place.iter().position(|&place| place == NONE) {
        Some(row) => Err(Error::NotPermutation { row }),
        None => Ok(place),
    }
}

/// The order that faer finds, to compare with.
#[cfg(test)]
pub(crate) fn faer_minimum_degree(graph: &Graph) -> Vec<u32> {
    use faer::{
        dyn_stack::{MemBuffer, MemStack},
        sparse::{SymbolicSparseColMatRef, linalg::amd},
    };
    let n = graph.len();
    let (mut order, mut inverse) = (vec![0_u32; n], vec![0_u32; n]);
    let pattern = SymbolicSparseColMatRef::new_unsorted_checked(
        n,
        n,
        graph.starts(),
        None,
        graph.neighbors_of_all(),
    );
    let size = amd::order_scratch::<u32>(n, graph.neighbors_of_all().len());
    let mut memory = MemBuffer::new(size);
    let control = amd::Control::default();
    amd::order(&mut order, &mut inverse, pattern, control, MemStack::new(&mut memory))
        .expect("a graph whose indices fit");
    order
}
