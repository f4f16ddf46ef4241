//! Clustering: graphs with ever fewer vertices that look alike from afar.
//!
//! A cluster starts with a vertex that is in none and takes up to three more, each time the one with
//! most edges to the cluster, so that clusters are round. What finds nobody joins a neighbor's cluster.

use std::ops::Range;

use super::separator::Local;
use crate::{
    Error, Progress,
    order::{Graph, NONE},
    parallel,
};

/// Clusters that one task contracts.
const CHUNK: usize = 16_384;

/// With this many vertices one cut is found at once.
const FEW: usize = 160;

/// Vertices per cluster.
const CLUSTER: usize = 4;

/// Clustering has come to an end when more than this part of the vertices remain.
const STALLED: f64 = 0.85;

/// A graph whose vertices and edges stand for several of the finest one.
#[derive(Debug)]
pub(super) struct Level<'a> {
    graph: Borrowed<'a>,
    /// Weights of vertices, and of edges in the place of the neighbor; empty where all are 1.
    weights: Vec<u32>,
    edge_weights: Vec<u32>,
    /// The vertex of the next coarser level that each is in.
    pub(super) cluster: Option<Vec<u32>>,
}

#[derive(Debug)]
enum Borrowed<'a> {
    Finest(&'a Graph),
    Coarse(Graph),
}

/// What clustering needs to know of a graph.
pub(super) trait Weighted {
    fn len(&self) -> usize;
    fn weight(&self, v: usize) -> u32;
    /// Neighbors of `v`, and the weights of the edges to them.
    fn edges(&self, v: usize) -> impl Iterator<Item = (u32, u32)> + '_;
}

impl Weighted for Level<'_> {
    fn len(&self) -> usize {
        self.graph().len()
    }

    fn weight(&self, v: usize) -> u32 {
        self.weights.get(v).copied().unwrap_or(1)
    }

    fn edges(&self, v: usize) -> impl Iterator<Item = (u32, u32)> + '_ {
        let starts = self.graph().starts();
        with_weights(self.neighbors(v), &self.edge_weights, starts[v], starts[v + 1])
    }
}

impl Weighted for Local {
    fn len(&self) -> usize {
        self.weights.len()
    }

    fn weight(&self, v: usize) -> u32 {
        self.weights[v]
    }

    fn edges(&self, v: usize) -> impl Iterator<Item = (u32, u32)> + '_ {
        let neighbors = self.neighbors(v);
        with_weights(neighbors, &self.edge_weights, self.starts[v], self.starts[v + 1])
    }
}

/// Neighbors with the weights of their edges, which are 1 where there are none.
fn with_weights<'a>(
    neighbors: &'a [u32],
    weights: &'a [u32],
    start: u32,
    end: u32,
) -> impl Iterator<Item = (u32, u32)> + 'a {
    let weights = weights.get(start as usize..end as usize).unwrap_or_default();
    neighbors.iter().copied().zip(weights.iter().copied().chain(std::iter::repeat(1)))
}

impl Level<'_> {
    pub(super) fn neighbors(&self, v: usize) -> &[u32] {
        self.graph().neighbors(v)
    }

    fn graph(&self) -> &Graph {
        match &self.graph {
            Borrowed::Finest(graph) => graph,
            Borrowed::Coarse(graph) => graph,
        }
    }
}

/// The levels from the finest, which is `graph`, to the coarsest.
pub(super) fn coarsen<'a>(
    graph: &'a Graph,
    progress: Progress<'_>,
) -> Result<Vec<Level<'a>>, Error> {
    let finest = Borrowed::Finest(graph);
    let level =
        Level { graph: finest, weights: Vec::new(), edge_weights: Vec::new(), cluster: None };
    let mut levels = vec![level];
    loop {
        let fine = &levels[levels.len() - 1];
        if fine.len() <= FEW {
            return Ok(levels);
        }
        progress.report(1.0 - fine.len() as f64 / graph.len() as f64)?;
        let Some((cluster, coarse)) = cluster(fine, CLUSTER, 0) else { return Ok(levels) };
        let Local { starts, neighbors, weights, edge_weights, .. } = coarse;
        let graph = Borrowed::Coarse(Graph::new(starts, neighbors));
        let coarse = Level { graph, weights, edge_weights, cluster: None };
        if let Some(fine) = levels.last_mut() {
            fine.cluster = Some(cluster);
        }
        levels.push(coarse);
    }
}

/// The cluster of each vertex, of about `size` vertices each, and the graph of the clusters; `None` when
/// clustering has come to an end. The first cluster is the one of vertex `start`.
pub(super) fn cluster(
    fine: &(impl Weighted + Sync),
    size: usize,
    start: usize,
) -> Option<(Vec<u32>, Local)> {
    let total: u64 = (0..fine.len()).map(|v| u64::from(fine.weight(v))).sum();
    let most = 3 * size as u64 * total / (2 * fine.len() as u64);
    let (cluster, count) = clusters(fine, most.max(2), size, start);
    if count as f64 > STALLED * fine.len() as f64 {
        return None;
    }
    let coarse = contract(fine, &cluster, count);
    Some((cluster, coarse))
}

/// The cluster of each vertex, and how many there are. None grows beyond the weight `most`.
fn clusters(level: &impl Weighted, most: u64, size: usize, start: usize) -> (Vec<u32>, usize) {
    let n = level.len();
    let mut cluster = vec![NONE; n];
    let mut weight_of: Vec<u64> = Vec::with_capacity(n / size + 1);
    // Edges from each vertex to the cluster that grows.
    let mut bonds = vec![0_u32; n];
    let mut candidates: Vec<u32> = Vec::new();
    for v in (start..n).chain(0..start) {
        if cluster[v] != NONE {
            continue;
        }
        let current = weight_of.len() as u32;
        let mut weight = u64::from(level.weight(v));
        let mut newest = v;
        cluster[v] = current;
        for _ in 1..size {
            for (w, bond) in level.edges(newest) {
                if cluster[w as usize] == NONE {
                    if bonds[w as usize] == 0 {
                        candidates.push(w);
                    }
                    bonds[w as usize] += bond;
                }
            }
            let fits = |w: u32| weight + u64::from(level.weight(w as usize)) <= most;
            let free = |&&w: &&u32| cluster[w as usize] == NONE && fits(w);
            let key = |&&w: &&u32| {
                let lightness = u32::MAX - level.weight(w as usize);
                (bonds[w as usize], lightness, u32::MAX - w)
            };
            let Some(&best) = candidates.iter().filter(free).max_by_key(key) else { break };
            newest = best as usize;
            cluster[newest] = current;
            weight += u64::from(level.weight(newest));
        }
        let alone = newest == v;
        for w in candidates.drain(..) {
            bonds[w as usize] = 0;
        }
        match alone.then(|| neighbor_cluster(level, v, &cluster, &weight_of, most)).flatten() {
            Some(other) => {
                cluster[v] = other;
                weight_of[other as usize] += weight;
            }
            None => weight_of.push(weight),
        }
    }
    let count = weight_of.len();
    (cluster, count)
}

/// The cluster next to `v` with the heaviest edge that can take it.
fn neighbor_cluster(
    level: &impl Weighted,
    v: usize,
    cluster: &[u32],
    weight_of: &[u64],
    most: u64,
) -> Option<u32> {
    let weight = u64::from(level.weight(v));
    let others = level.edges(v).map(|(w, bond)| (bond, cluster[w as usize]));
    let fitting = others.filter(|&(_, other)| {
        weight_of.get(other as usize).is_some_and(|other| other + weight <= most)
    });
    fitting
        .max_by_key(|&(bond, other)| (bond, u64::MAX - weight_of[other as usize]))
        .map(|best| best.1)
}

/// The graph whose vertices are the clusters.
fn contract(fine: &(impl Weighted + Sync), cluster: &[u32], count: usize) -> Local {
    let mut starts = vec![0_u32; count + 1];
    for &c in cluster {
        starts[c as usize + 1] += 1;
    }
    crate::matrix::accumulate(&mut starts);
    let mut next = starts.clone();
    let mut members = vec![0_u32; cluster.len()];
    for (v, &c) in cluster.iter().enumerate() {
        members[next[c as usize] as usize] = v as u32;
        next[c as usize] += 1;
    }
    let mut ranges: Vec<Range<usize>> =
        (0..count).step_by(CHUNK).map(|first| first..(first + CHUNK).min(count)).collect();
    let lists = parallel::map_chunks(&mut ranges, 1, |_, range| {
        let of = |c: usize| &members[starts[c] as usize..starts[c + 1] as usize];
        contract_some(fine, cluster, range[0].clone(), count, of)
    });
    let mut coarse = Local { starts: vec![0], free: count, ..Local::default() };
    for list in lists {
        let before = coarse.neighbors.len() as u32;
        coarse.starts.extend(list.starts.iter().map(|end| before + end));
        coarse.neighbors.extend(list.neighbors);
        coarse.weights.extend(list.weights);
        coarse.edge_weights.extend(list.edge_weights);
    }
    coarse
}

/// Weights and neighbors of some of the clusters, of which `of` gives the members; `starts` are the ends.
fn contract_some<'a>(
    fine: &impl Weighted,
    cluster: &[u32],
    range: Range<usize>,
    count: usize,
    of: impl Fn(usize) -> &'a [u32],
) -> Local {
    let mut list = Local::default();
    // Where the edge to each cluster stands, if it is at least the start of the current list.
    let mut place = vec![0_u32; count];
    for c in range {
        let Local { neighbors, edge_weights, .. } = &mut list;
        let start = neighbors.len();
        let mut weight = 0_u32;
        for &v in of(c) {
            weight += fine.weight(v as usize);
            for (w, bond) in fine.edges(v as usize) {
                let other = cluster[w as usize];
                if other as usize == c {
                    continue;
                }
                let at = place[other as usize] as usize;
                if at >= start && at < neighbors.len() && neighbors[at] == other {
                    edge_weights[at] += bond;
                } else {
                    place[other as usize] = neighbors.len() as u32;
                    neighbors.push(other);
                    edge_weights.push(bond);
                }
            }
        }
        list.weights.push(weight);
        list.starts.push(list.neighbors.len() as u32);
    }
    list
}
