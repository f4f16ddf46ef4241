//! The graph of a symmetric matrix: rows, joined where an entry is stored.

use crate::{SparseMatrix, parallel};

/// Vertices that one task renumbers.
const CHUNK: usize = 16_384;

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

    /// The same graph with `order[k]` as vertex k, where `place` is the inverse of `order`.
    pub(crate) fn permuted(&self, order: &[u32], place: &[u32]) -> Graph {
        let mut chunks: Vec<&[u32]> = order.chunks(CHUNK).collect();
        let lists = parallel::map_chunks(&mut chunks, 1, |_, chunk| {
            let degree = |&v: &u32| self.neighbors(v as usize).len();
            let total: usize = chunk[0].iter().map(degree).sum();
            let mut lengths = Vec::with_capacity(chunk[0].len());
            let mut neighbors = Vec::with_capacity(total);
            for v in chunk[0] {
                lengths.push(degree(v) as u32);
                neighbors.extend(self.neighbors(*v as usize).iter().map(|&w| place[w as usize]));
            }
            (lengths, neighbors)
        });
        let mut starts = Vec::with_capacity(order.len() + 1);
        let mut neighbors = Vec::with_capacity(self.neighbors.len());
        let mut end = 0;
        starts.push(0);
        for (lengths, list) in lists {
            starts.extend(lengths.iter().map(|length| {
                end += length;
                end
            }));
            neighbors.extend(list);
        }
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
