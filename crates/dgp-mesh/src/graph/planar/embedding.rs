//! The drawing: the order of edges around each vertex.

use super::left_right::{Sides, sorted_out_edges};
use crate::{EdgeId, HalfedgeId, VertexId, VertexMap, graph::Graph};

/// The order of the edges around each vertex: all that matters of a drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Embedding {
    /// The arcs that leave vertex v are at `[v]..[v + 1]`, counterclockwise.
    starts: Vec<u32>,
    arcs: Vec<(VertexId, EdgeId)>,
}

impl Embedding {
    /// The neighbors of `v`, each with the edge that leads there, counterclockwise.
    pub fn arcs(&self, v: VertexId) -> &[(VertexId, EdgeId)] {
        &self.arcs[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }

    /// The faces of the drawing, each as the vertices met along its rim with the face on the left, one
    /// loop after the other. A part of the graph has an outer face of its own; vertices without edges
    /// have none.
    pub fn faces(&self) -> Vec<Vec<VertexId>> {
        // The position of each arc among those of its vertex, by edge and direction.
        let mut place: Vec<Option<u32>> = vec![None; self.arcs.len()];
        let slot = |from: VertexId, to: VertexId, e: EdgeId| 2 * e.index() + usize::from(from > to);
        let vertices = || (0..self.starts.len() - 1).map(VertexId::new);
        for v in vertices() {
            for (k, &(w, e)) in self.arcs(v).iter().enumerate() {
                place[slot(v, w, e)] = Some(k as u32);
            }
        }
        let mut faces = Vec::new();
        let mut is_done = vec![false; self.arcs.len()];
        for v in vertices() {
            for &(w, e) in self.arcs(v) {
                let mut face = Vec::new();
                let (mut from, mut to, mut along) = (v, w, e);
                while !is_done[slot(from, to, along)] {
                    is_done[slot(from, to, along)] = true;
                    face.push(from);
                    // At the end turn right as sharply as there is an edge: clockwise next of the way
                    // back, so that the face stays on the left.
                    let arcs = self.arcs(to);
                    let back = place[slot(to, from, along)].expect("an edge has two arcs") as usize;
                    let (next, edge) = arcs[(back + arcs.len() - 1) % arcs.len()];
                    (from, to, along) = (to, next, edge);
                }
                if !face.is_empty() {
                    faces.push(face);
                }
            }
        }
        faces
    }

    /// The genus of the surface on which these orders draw the graph without crossings, by Euler's
    /// formula V − E + F = 2 − 2g for each part: 0 for what a plane can hold.
    pub fn genus(&self) -> usize {
        let n = self.starts.len() - 1;
        let mut parts = crate::topology::union_find::UnionFind::new(n);
        let vertices = || (0..n).map(VertexId::new);
        for v in vertices() {
            for &(w, _) in self.arcs(v) {
                parts.join(v.index(), w.index());
            }
        }
        let with_edges = vertices().filter(|&v| !self.arcs(v).is_empty());
        let mut count = 0;
        let mut used = 0;
        for v in with_edges {
            used += 1;
            count += usize::from(parts.find(v.index()) == v.index());
        }
        let euler = used as i64 - (self.arcs.len() / 2) as i64 + self.faces().len() as i64;
        ((2 * count as i64 - euler) / 2) as usize
    }
}

/// Phase 3: turns sides into orders.
pub(super) fn embed(graph: &Graph, mut sides: Sides) -> Embedding {
    resolve(&mut sides);
    for e in sides.ends.ids() {
        sides.nesting[e] *= i64::from(sides.side[e]);
    }
    let n = graph.vertex_count();
    let out = sorted_out_edges(n, &sides.ends, &sides.nesting);

    // Rings of arcs; arc 2e leads along edge e, arc 2e + 1 back.
    let mut rings = Rings::new(graph.edge_count());
    let mut first: VertexMap<Option<HalfedgeId>> = VertexMap::filled(n, None);
    for v in graph.vertices() {
        let mut last = None;
        for &e in out.of(v) {
            let arc = e.halfedge();
            match last {
                None => first[v] = Some(arc),
                Some(last) => rings.insert_after(last, arc),
            }
            last = Some(arc);
        }
    }
    // Back arcs are put beside the arc that leads down to where they come from.
    let mut left: VertexMap<Option<HalfedgeId>> = VertexMap::filled(n, None);
    let mut right = left.clone();
    let mut next: VertexMap<u32> = VertexMap::filled(n, 0);
    for &root in &sides.roots {
        let mut path = vec![root];
        while let Some(&v) = path.last() {
            let Some(&e) = out.of(v).get(next[v] as usize) else {
                path.pop();
                continue;
            };
            next[v] += 1;
            let (w, arc, back) = (sides.ends[e][1], e.halfedge(), e.halfedge().twin());
            if sides.parent[w] == Some(e) {
                if let Some(first) = first[w] {
                    rings.insert_before(first, back);
                }
                first[w] = Some(back);
                (left[v], right[v]) = (Some(arc), Some(arc));
                path.push(w);
            } else if sides.side[e] == 1 {
                rings.insert_after(right[w].expect("w lies on the path"), back);
            } else {
                rings.insert_before(left[w].expect("w lies on the path"), back);
                left[w] = Some(back);
            }
        }
    }

    let mut starts = vec![0_u32];
    let mut arcs = Vec::with_capacity(2 * graph.edge_count());
    for v in graph.vertices() {
        let start = arcs.len();
        let mut at = first[v];
        while let Some(arc) = at {
            let [from, to] = sides.ends[arc.edge()];
            arcs.push((if from == v { to } else { from }, arc.edge()));
            at = Some(rings.next[arc.index()]).filter(|&next| Some(next) != first[v]);
        }
        // The rings run clockwise.
        arcs[start..].reverse();
        starts.push(arcs.len() as u32);
    }
    Embedding { starts, arcs }
}

/// Makes all sides absolute, following references to their ends.
fn resolve(sides: &mut Sides) {
    let mut chain = Vec::new();
    for e in sides.ends.ids() {
        let mut at = e;
        while let Some(next) = sides.reference[at] {
            chain.push(at);
            at = next;
        }
        while let Some(before) = chain.pop() {
            sides.side[before] *= sides.side[at];
            sides.reference[before] = None;
            at = before;
        }
    }
}

/// Doubly linked rings of arcs.
struct Rings {
    next: Vec<HalfedgeId>,
    prev: Vec<HalfedgeId>,
}

impl Rings {
    /// Each arc in a ring of its own.
    fn new(edge_count: usize) -> Self {
        let alone: Vec<HalfedgeId> = (0..2 * edge_count).map(HalfedgeId::new).collect();
        Rings { next: alone.clone(), prev: alone }
    }

    /// Puts `arc`, which is alone, between `at` and the next of `at`.
    fn insert_after(&mut self, at: HalfedgeId, arc: HalfedgeId) {
        let next = self.next[at.index()];
        self.next[at.index()] = arc;
        self.prev[arc.index()] = at;
        self.next[arc.index()] = next;
        self.prev[next.index()] = arc;
    }

    fn insert_before(&mut self, at: HalfedgeId, arc: HalfedgeId) {
        self.insert_after(self.prev[at.index()], arc);
    }
}
