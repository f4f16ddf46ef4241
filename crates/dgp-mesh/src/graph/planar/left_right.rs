//! The left–right test: orientation, then constraints on the sides of back edges.

use std::{
    cmp::Ordering::{Equal, Greater, Less},
    mem,
};

use crate::{EdgeId, EdgeMap, VertexId, VertexMap, graph::Graph};

/// What the embedding needs to know: an oriented graph with sides.
pub(super) struct Sides {
    /// The end each edge leads from and the one it leads to: tree edges down, back edges up.
    pub(super) ends: EdgeMap<[VertexId; 2]>,
    /// The tree edge that leads to each vertex; `None` at roots.
    pub(super) parent: VertexMap<Option<EdgeId>>,
    pub(super) roots: Vec<VertexId>,
    /// The order of edges that leave the same vertex.
    pub(super) nesting: EdgeMap<i64>,
    /// −1 for left, 1 for right, relative to `reference`.
    pub(super) side: EdgeMap<i8>,
    pub(super) reference: EdgeMap<Option<EdgeId>>,
}

/// The sides of all back edges, or `None` if they contradict each other.
pub(super) fn test(graph: &Graph) -> Option<Sides> {
    let search = Search::orient(graph);
    let out = sorted_out_edges(graph.vertex_count(), &search.ends, &search.nesting);
    let mut constraints = Constraints::new(graph, &search);
    for &root in &search.roots {
        constraints.visit(root, &out)?;
    }
    let Constraints { side, reference, .. } = constraints;
    let Search { ends, parent, roots, nesting, .. } = search;
    Some(Sides { ends, parent, roots, nesting, side, reference })
}

/// Edges that leave each vertex, in order.
pub(super) struct OutEdges {
    starts: Vec<u32>,
    edges: Vec<EdgeId>,
}

impl OutEdges {
    pub(super) fn of(&self, v: VertexId) -> &[EdgeId] {
        &self.edges[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }
}

/// The edges that leave each vertex by increasing `key`, whose size is at most 2V + 1: by counting.
pub(super) fn sorted_out_edges(
    vertex_count: usize,
    ends: &EdgeMap<[VertexId; 2]>,
    key: &EdgeMap<i64>,
) -> OutEdges {
    let offset = key.values().iter().copied().min().unwrap_or(0);
    let bucket = |e: EdgeId| (key[e] - offset) as usize;
    let range = key.ids().map(bucket).max().map_or(0, |most| most + 1);
    let mut next = vec![0_u32; range + 1];
    key.ids().for_each(|e| next[bucket(e) + 1] += 1);
    (0..range).for_each(|b| next[b + 1] += next[b]);
    let mut by_key = vec![EdgeId::new(0); key.len()];
    for e in key.ids() {
        by_key[next[bucket(e)] as usize] = e;
        next[bucket(e)] += 1;
    }

    let mut starts = vec![0_u32; vertex_count + 1];
    ends.values().iter().for_each(|[from, _]| starts[from.index() + 1] += 1);
    (0..vertex_count).for_each(|v| starts[v + 1] += starts[v]);
    let mut next = starts.clone();
    let mut edges = vec![EdgeId::new(0); key.len()];
    for e in by_key {
        let at = &mut next[ends[e][0].index()];
        edges[*at as usize] = e;
        *at += 1;
    }
    OutEdges { starts, edges }
}

/// Phase 1: a depth-first search that orients the edges and finds how high each one returns.
struct Search {
    ends: EdgeMap<[VertexId; 2]>,
    parent: VertexMap<Option<EdgeId>>,
    roots: Vec<VertexId>,
    height: VertexMap<u32>,
    /// The height of the highest vertex that the edge, or what hangs below it, returns to.
    low: EdgeMap<u32>,
    /// The next highest.
    second_low: EdgeMap<u32>,
    nesting: EdgeMap<i64>,
}

const UNSEEN: u32 = u32::MAX;

impl Search {
    fn orient(graph: &Graph) -> Self {
        let (n, m) = (graph.vertex_count(), graph.edge_count());
        let mut search = Search {
            ends: graph.edges().to_vec().into(),
            parent: VertexMap::filled(n, None),
            roots: Vec::new(),
            height: VertexMap::filled(n, UNSEEN),
            low: EdgeMap::filled(m, 0),
            second_low: EdgeMap::filled(m, 0),
            nesting: EdgeMap::filled(m, 0),
        };
        let mut is_oriented: EdgeMap<bool> = EdgeMap::filled(m, false);
        let mut next: VertexMap<u32> = VertexMap::filled(n, 0);
        let mut path = Vec::new();
        for root in graph.vertices() {
            if search.height[root] != UNSEEN {
                continue;
            }
            search.roots.push(root);
            search.height[root] = 0;
            path.push(root);
            while let Some(&v) = path.last() {
                let Some(&(w, e)) = graph.arcs(v).get(next[v] as usize) else {
                    path.pop();
                    continue;
                };
                if !is_oriented[e] {
                    is_oriented[e] = true;
                    search.ends[e] = [v, w];
                    search.low[e] = search.height[v];
                    search.second_low[e] = search.height[v];
                    if search.height[w] == UNSEEN {
                        // Down; this edge is finished when the search is back.
                        search.parent[w] = Some(e);
                        search.height[w] = search.height[v] + 1;
                        path.push(w);
                        continue;
                    }
                    search.low[e] = search.height[w];
                }
                if search.ends[e][0] == v {
                    search.finish(e);
                }
                next[v] += 1;
            }
        }
        search
    }

    fn finish(&mut self, e: EdgeId) {
        let v = self.ends[e][0];
        let is_chordal = self.second_low[e] < self.height[v];
        self.nesting[e] = 2 * i64::from(self.low[e]) + i64::from(is_chordal);
        let Some(p) = self.parent[v] else { return };
        let (low, second) = (self.low[e], self.second_low[e]);
        match low.cmp(&self.low[p]) {
            Less => {
                self.second_low[p] = self.low[p].min(second);
                self.low[p] = low;
            }
            Equal => self.second_low[p] = self.second_low[p].min(second),
            Greater => self.second_low[p] = self.second_low[p].min(low),
        }
    }
}

/// Back edges that return on the same side: a chain of references from the highest to the lowest.
#[derive(Clone, Copy, Default)]
struct Interval {
    low: Option<EdgeId>,
    high: Option<EdgeId>,
}

impl Interval {
    fn is_empty(self) -> bool {
        self.low.is_none() && self.high.is_none()
    }
}

/// Two intervals that return on different sides.
#[derive(Clone, Copy, Default)]
struct Conflict {
    left: Interval,
    right: Interval,
}

impl Conflict {
    fn swap(&mut self) {
        mem::swap(&mut self.left, &mut self.right);
    }
}

/// Phase 2: constraints of back edges, children before parents.
struct Constraints<'a> {
    search: &'a Search,
    stack: Vec<Conflict>,
    /// How high the stack was before each edge.
    bottom: EdgeMap<u32>,
    /// A back edge below each edge that returns highest.
    low_edge: EdgeMap<Option<EdgeId>>,
    side: EdgeMap<i8>,
    reference: EdgeMap<Option<EdgeId>>,
    next: VertexMap<u32>,
}

impl<'a> Constraints<'a> {
    fn new(graph: &Graph, search: &'a Search) -> Self {
        let (n, m) = (graph.vertex_count(), graph.edge_count());
        Constraints {
            search,
            stack: Vec::new(),
            bottom: EdgeMap::filled(m, UNSEEN),
            low_edge: EdgeMap::filled(m, None),
            side: EdgeMap::filled(m, 1),
            reference: EdgeMap::filled(m, None),
            next: VertexMap::filled(n, 0),
        }
    }

    fn visit(&mut self, root: VertexId, out: &OutEdges) -> Option<()> {
        let mut path = vec![root];
        while let Some(&v) = path.last() {
            let Some(&e) = out.of(v).get(self.next[v] as usize) else {
                path.pop();
                if let Some(parent) = self.search.parent[v] {
                    self.remove_back_edges(parent);
                }
                continue;
            };
            let w = self.search.ends[e][1];
            let is_tree = self.search.parent[w] == Some(e);
            if self.bottom[e] == UNSEEN {
                self.bottom[e] = self.stack.len() as u32;
                if is_tree {
                    path.push(w);
                    continue;
                }
                self.low_edge[e] = Some(e);
                let right = Interval { low: Some(e), high: Some(e) };
                self.stack.push(Conflict { left: Interval::default(), right });
            }
            // All of e is done; join its back edges to those before.
            if self.search.low[e] < self.search.height[v] {
                let parent = self.search.parent[v].expect("a root has nothing to return to");
                if self.next[v] == 0 {
                    self.low_edge[parent] = self.low_edge[e];
                } else {
                    self.add_constraints(e, parent)?;
                }
            }
            self.next[v] += 1;
        }
        Some(())
    }

    fn low(&self, e: Option<EdgeId>) -> u32 {
        e.map_or(UNSEEN, |e| self.search.low[e])
    }

    fn conflicts(&self, interval: Interval, e: EdgeId) -> bool {
        interval.high.is_some_and(|high| self.search.low[high] > self.search.low[e])
    }

    /// Makes `to` follow `from` in a chain.
    fn refer(&mut self, from: Option<EdgeId>, to: Option<EdgeId>) {
        if let Some(from) = from {
            self.reference[from] = to;
        }
    }

    /// The back edges below `e` return on one side, those of its elder siblings that end above on the
    /// other. `None` where they cannot.
    fn add_constraints(&mut self, e: EdgeId, parent: EdgeId) -> Option<()> {
        let mut merged = Conflict::default();
        // Return edges of e, on the right.
        while self.stack.len() > self.bottom[e] as usize {
            let mut top = self.stack.pop().expect("higher than the bottom");
            if !top.left.is_empty() {
                top.swap();
            }
            if !top.left.is_empty() {
                return None;
            }
            if self.low(top.right.low) > self.search.low[parent] {
                if merged.right.is_empty() {
                    merged.right.high = top.right.high;
                } else {
                    self.refer(merged.right.low, top.right.high);
                }
                merged.right.low = top.right.low;
            } else {
                self.refer(top.right.low, self.low_edge[parent]);
            }
        }
        // Return edges of the siblings before that conflict with them, on the left.
        while let Some(&top) = self.stack.last()
            && (self.conflicts(top.left, e) || self.conflicts(top.right, e))
        {
            let mut top = self.stack.pop().expect("just looked at");
            if self.conflicts(top.right, e) {
                top.swap();
            }
            if self.conflicts(top.right, e) {
                return None;
            }
            if merged.right.is_empty() {
                merged.right.high = top.right.high;
            } else {
                self.refer(merged.right.low, top.right.high);
            }
            if top.right.low.is_some() {
                merged.right.low = top.right.low;
            }
            if merged.left.is_empty() {
                merged.left.high = top.left.high;
            } else {
                self.refer(merged.left.low, top.left.high);
            }
            merged.left.low = top.left.low;
        }
        if !(merged.left.is_empty() && merged.right.is_empty()) {
            self.stack.push(merged);
        }
        Some(())
    }

    /// Forgets the back edges that end where `e` starts, and finds the side of `e`.
    fn remove_back_edges(&mut self, e: EdgeId) {
        let u = self.search.ends[e][0];
        let height = self.search.height[u];
        // Whole conflicts.
        while let Some(&top) = self.stack.last()
            && self.low(top.left.low).min(self.low(top.right.low)) == height
        {
            if let Some(low) = top.left.low {
                self.side[low] = -1;
            }
            self.stack.pop();
        }
        // One that is left in part.
        if let Some(mut top) = self.stack.pop() {
            let other = top.right.low;
            self.trim(&mut top.left, other, u);
            let other = top.left.low;
            self.trim(&mut top.right, other, u);
            self.stack.push(top);
        }
        // The side of e is that of its highest return edge.
        if self.search.low[e] < height
            && let Some(&top) = self.stack.last()
        {
            let (left, right) = (top.left.high, top.right.high);
            let is_left = left.is_some() && (right.is_none() || self.low(left) > self.low(right));
            self.reference[e] = if is_left { left } else { right };
        }
    }

    fn trim(&mut self, interval: &mut Interval, other: Option<EdgeId>, u: VertexId) {
        while let Some(high) = interval.high
            && self.search.ends[high][1] == u
        {
            interval.high = self.reference[high];
        }
        if let (None, Some(low)) = (interval.high, interval.low) {
            self.reference[low] = other;
            self.side[low] = -1;
            interval.low = None;
        }
    }
}
