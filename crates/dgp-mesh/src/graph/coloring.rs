//! Coloring vertices so that neighbors differ: smallest last, and five colors by Kempe chains.
//!
//! Smallest last: take away a vertex of least degree, again and again; give colors in the reverse order,
//! each vertex the first that its neighbors do not have. A vertex has at most d neighbors when it is put
//! back, where d is the largest degree met, the degeneracy: d + 1 colors suffice. A planar graph has a
//! vertex of degree at most 5, since E ≤ 3V − 6, and so has what remains of it: six colors suffice.
//!
//! With five, a vertex may find all of them around it. In a planar graph there are then two colors whose
//! vertices do not connect the two neighbors that have them, and swapping the colors in one of the two
//! parts frees one (Heawood's proof of the five color theorem).
//!
//! - Input: any graph.
//! - Cost: O(V + E); five colors O(V²) at worst, on meshes nearly linear.
//! - Guarantees: at most 6 colors for planar graphs, at most 5 by [`five_coloring`].
//! - Reference: Matula and Beck, "Smallest-last ordering and clustering and graph coloring algorithms",
//!   Journal of the ACM 30(3), 1983; Heawood, "Map-colour theorem", 1890.

use super::Graph;
use crate::{VertexId, VertexMap};

/// Colors of vertices, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use]
pub struct Coloring {
    /// The color of each vertex.
    pub colors: VertexMap<u32>,
    /// How many colors there are.
    pub count: usize,
    /// The largest degree that a vertex had when it was taken away: 5 at most in planar graphs.
    pub degeneracy: usize,
}

impl Coloring {
    /// Whether all neighbors differ.
    pub fn is_proper(&self, graph: &Graph) -> bool {
        graph.edges().iter().all(|&[a, b]| self.colors[a] != self.colors[b])
    }
}

/// Colors the vertices of `graph` in smallest-last order: at most 6 colors if it is planar.
pub fn smallest_last_coloring(graph: &Graph) -> Coloring {
    let (order, degeneracy) = smallest_last_order(graph);
    let mut colors = Colors::new(graph);
    for &v in order.iter().rev() {
        let free = colors.free(v);
        colors.set(v, free);
    }
    colors.finish(degeneracy)
}

/// Colors the vertices of `graph` with five colors: always possible if it is planar.
///
/// `None` if a vertex cannot be given one of five colors so, which proves that the graph is not planar.
#[must_use]
pub fn five_coloring(graph: &Graph) -> Option<Coloring> {
    let (order, degeneracy) = smallest_last_order(graph);
    let mut colors = Colors::new(graph);
    for &v in order.iter().rev() {
        let mut free = colors.free(v);
        if free >= 5 {
            free = colors.free_by_swap(v)?;
        }
        colors.set(v, free);
    }
    Some(colors.finish(degeneracy))
}

/// The vertices in the order in which one of least degree is taken away, and the largest such degree.
pub fn smallest_last_order(graph: &Graph) -> (Vec<VertexId>, usize) {
    let n = graph.vertex_count();
    let mut degree: Vec<usize> = graph.vertices().map(|v| graph.degree(v)).collect();
    let most = degree.iter().copied().max().unwrap_or(0);
    // Buckets of vertices by degree; those that have moved on meanwhile are passed over.
    let mut buckets: Vec<Vec<VertexId>> = vec![Vec::new(); most + 1];
    for v in graph.vertices() {
        buckets[degree[v.index()]].push(v);
    }
    let mut is_taken = vec![false; n];
    let mut order = Vec::with_capacity(n);
    let (mut least, mut degeneracy) = (0, 0);
    while order.len() < n {
        let Some(v) = buckets[least].pop() else {
            least += 1;
            continue;
        };
        if is_taken[v.index()] || degree[v.index()] != least {
            continue;
        }
        is_taken[v.index()] = true;
        order.push(v);
        degeneracy = degeneracy.max(least);
        for &(w, _) in graph.arcs(v) {
            if !is_taken[w.index()] {
                degree[w.index()] -= 1;
                buckets[degree[w.index()]].push(w);
            }
        }
        // Taking v away lowers degrees by one at most.
        least = least.saturating_sub(1);
    }
    (order, degeneracy)
}

/// A coloring in the making.
struct Colors<'a> {
    graph: &'a Graph,
    given: Vec<Option<u32>>,
    /// The vertex that last saw each color at a neighbor, counted from 1.
    seen: Vec<u32>,
}

impl<'a> Colors<'a> {
    fn new(graph: &'a Graph) -> Self {
        let most = graph.vertices().map(|v| graph.degree(v)).max().unwrap_or(0);
        Colors { graph, given: vec![None; graph.vertex_count()], seen: vec![0; most + 2] }
    }

    fn set(&mut self, v: VertexId, color: u32) {
        self.given[v.index()] = Some(color);
    }

    /// The first color that no neighbor of `v` has.
    fn free(&mut self, v: VertexId) -> u32 {
        let mark = v.index() as u32 + 1;
        for &(w, _) in self.graph.arcs(v) {
            if let Some(color) = self.given[w.index()] {
                self.seen[color as usize] = mark;
            }
        }
        let free = self.seen.iter().position(|&seen| seen != mark);
        free.expect("there are more colors than neighbors") as u32
    }

    /// One of the first five colors, made free at `v` by swapping two colors in a part of the graph.
    fn free_by_swap(&mut self, v: VertexId) -> Option<u32> {
        for x in 0..5 {
            for y in 0..5 {
                // All neighbors of color x, and what hangs together with them in colors x and y.
                let part = (x != y).then(|| self.chain(v, x, y));
                let Some(part) = part else { continue };
                let meets =
                    |&(w, _): &(VertexId, _)| self.given[w.index()] == Some(y) && part.contains(&w);
                if self.graph.arcs(v).iter().any(meets) {
                    continue;
                }
                for w in part {
                    let color = self.given[w.index()];
                    self.given[w.index()] = Some(if color == Some(x) { y } else { x });
                }
                return Some(x);
            }
        }
        None
    }

    /// The vertices of colors `x` and `y` that paths of these colors join to neighbors of `v` of color
    /// `x`.
    fn chain(&self, v: VertexId, x: u32, y: u32) -> std::collections::BTreeSet<VertexId> {
        let mut found = std::collections::BTreeSet::new();
        let is = |w: VertexId, color| self.given[w.index()] == Some(color);
        let mut stack: Vec<VertexId> =
            self.graph.arcs(v).iter().map(|arc| arc.0).filter(|&w| is(w, x)).collect();
        while let Some(w) = stack.pop() {
            if found.insert(w) {
                let next = self.graph.arcs(w).iter().map(|arc| arc.0);
                stack.extend(next.filter(|&u| is(u, x) || is(u, y)));
            }
        }
        found
    }

    fn finish(self, degeneracy: usize) -> Coloring {
        let colors: Vec<u32> = self.given.into_iter().flatten().collect();
        let count = colors.iter().max().map_or(0, |&color| color as usize + 1);
        Coloring { colors: colors.into(), count, degeneracy }
    }
}
