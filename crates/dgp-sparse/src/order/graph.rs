//! The graph of a symmetric matrix: rows, joined where an entry is stored.

use crate::SparseMatrix;

/// Neighbors of each vertex, one list after the other.
#[derive(Clone, Debug)]
pub(crate) struct Graph {
    starts: Vec<u32>,
    neighbors: Vec<u32>,
}

impl Graph {
    /// The graph of a matrix whose pattern is symmetric.
    pub(crate) fn of(matrix: &SparseMatrix) -> Graph {
        let n = matrix.columns();
        let mut starts = Vec::with_capacity(n + 1);
        let mut neighbors = Vec::with_capacity(matrix.entries());
        starts.push(0);
        for j in 0..n {
            let (rows, _) = matrix.column(j);
            neighbors.extend(rows.iter().filter(|&&i| i as usize != j));
            starts.push(neighbors.len() as u32);
        }
        Graph { starts, neighbors }
    }

    /// The graph with these lists, of which `starts` has one end more.
    pub(crate) fn new(starts: Vec<u32>, neighbors: Vec<u32>) -> Graph {
        Graph { starts, neighbors }
    }

    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn neighbors(&self, v: usize) -> &[u32] {
        &self.neighbors[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    pub(crate) fn starts(&self) -> &[u32] {
        &self.starts
    }

    pub(crate) fn neighbors_of_all(&self) -> &[u32] {
        &self.neighbors
    }
}
