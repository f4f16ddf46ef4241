//! First cuts of blocks, where they have a few hundred vertices.
//!
//! Two vertices u and w far from each other are found by walking to the farthest one twice. Vertices
//! are sorted by d(u) − d(w), the lighter half goes to u, and what borders on the other half becomes
//! the cut, which is then improved. That is done in several directions; the lightest cut counts.

use super::{
    LEAF,
    coarsen::{Level, Weighted, cluster},
    regions::Regions,
    separator::{CUT, Cut, Improver, Local},
};
use crate::{order::NONE, parallel};

/// How many directions are tried.
const DIRECTIONS: u32 = 4;

/// How often each first cut is improved, at most.
const PASSES: usize = 4;

/// A component with less than this part of the weight leaves room for others on its side.
const LARGE: f64 = 0.6;

/// Blocks of more vertices are clustered before they are cut.
const COARSEST: usize = 1500;

/// Vertices per cluster where they are: few, since there is time for it.
const CLUSTER: usize = 2;

/// Blocks that one task cuts.
const CHUNK: usize = 4;

/// Cuts all blocks of more than `most` vertices on this level, until none is left.
pub(super) fn split_blocks(
    level: &Level<'_>,
    label: &mut [u32],
    regions: &mut Regions,
    most: usize,
) {
    let (starts, members) = regions.members(label);
    let mut place = vec![0_u32; members.len()];
    for (i, &v) in members.iter().enumerate() {
        place[v as usize] = i as u32;
    }
    let of = |region: u32| {
        &members[starts[region as usize] as usize..starts[region as usize + 1] as usize]
    };
    let is_large = |&region: &u32| {
        regions.is_block(region)
            && regions.weight(region) > LEAF
            && of(region).len() > most
            && regions.can_be_cut(region)
    };
    let large = (0..regions.len() as u32).filter(is_large);
    let mut divisions: Vec<(u32, Division)> =
        large.map(|region| (region, Division::default())).collect();
    let labels = &*label;
    parallel::map_chunks(&mut divisions, CHUNK, |_, divisions| {
        let mut bisector = Bisector { most, ..Bisector::default() };
        for (region, division) in divisions {
            let block = of(*region);
            let start = starts[*region as usize];
            let local = extract(level, block, |w| {
                (labels[w as usize] == *region).then(|| place[w as usize] - start)
            });
            division.label = vec![0; block.len()];
            division.parts.push([NONE; 2]);
            division.weights.push([0; 2]);
            let all: Vec<u32> = (0..block.len() as u32).collect();
            divide(&local, &all, 0, division, &mut bisector);
        }
    });
    for (region, division) in divisions {
        let mut global = vec![region; division.parts.len()];
        for (k, parts) in division.parts.iter().enumerate() {
            if parts[0] != NONE && regions.can_be_cut(global[k]) {
                let created = regions.cut(global[k], division.weights[k]);
                for side in 0..2 {
                    global[parts[side] as usize] = created[side];
                }
            } else if parts[0] != NONE {
                // Too deep: what lies below stays one block.
                for &part in parts {
                    global[part as usize] = global[k];
                }
            }
        }
        for (&v, &part) in of(region).iter().zip(&division.label) {
            label[v as usize] = global[part as usize];
        }
    }
}

/// How a block was cut: a tree like [`Regions`], and where each of its vertices is in it.
#[derive(Debug, Default)]
struct Division {
    parts: Vec<[u32; 2]>,
    weights: Vec<[u64; 2]>,
    label: Vec<u32>,
}

/// The graph of a block, where `local` gives the number of a vertex in it.
fn extract(level: &Level<'_>, block: &[u32], local: impl Fn(u32) -> Option<u32>) -> Local {
    let mut graph = Local { starts: vec![0], free: block.len(), ..Local::default() };
    for &v in block {
        for (w, bond) in level.edges(v as usize) {
            if let Some(w) = local(w) {
                graph.neighbors.push(w);
                graph.edge_weights.push(bond);
            }
        }
        graph.starts.push(graph.neighbors.len() as u32);
        graph.weights.push(level.weight(v as usize));
    }
    graph
}

/// Cuts `graph`, whose vertices are `ids` in the block, until its parts are small.
fn divide(graph: &Local, ids: &[u32], node: u32, out: &mut Division, bisector: &mut Bisector) {
    let total: u64 = graph.weights.iter().map(|&weight| u64::from(weight)).sum();
    if graph.len() <= bisector.most || total <= LEAF {
        return;
    }
    let cut = bisector.bisect(graph);
    // A graph without a small cut is better left to minimum degree.
    if cut.weight[0].min(cut.weight[1]) == 0 || 2 * cut.weight[2] > total as i64 {
        return;
    }
    let first = out.parts.len() as u32;
    out.parts[node as usize] = [first, first + 1];
    out.weights[node as usize] = [cut.weight[0] as u64, cut.weight[1] as u64];
    out.parts.extend([[NONE; 2]; 2]);
    out.weights.extend([[0; 2]; 2]);
    for side in 0..2_u8 {
        let inside: Vec<u32> =
            (0..graph.len() as u32).filter(|&v| cut.side[v as usize] == side).collect();
        for &v in &inside {
            out.label[ids[v as usize] as usize] = first + u32::from(side);
        }
        let part = bisector.part(graph, &inside);
        let part_ids: Vec<u32> = inside.iter().map(|&v| ids[v as usize]).collect();
        divide(&part, &part_ids, first + u32::from(side), out, bisector);
    }
}

/// Memory for [`Bisector::bisect`], to be used again.
#[derive(Debug, Default)]
struct Bisector {
    /// Blocks with fewer vertices are not cut.
    most: usize,
    improver: Improver,
    queue: Vec<u32>,
    renumbering: Vec<u32>,
}

impl Bisector {
    /// The graph of some of the vertices.
    fn part(&mut self, graph: &Local, inside: &[u32]) -> Local {
        self.renumbering.clear();
        self.renumbering.resize(graph.len(), NONE);
        for (i, &v) in inside.iter().enumerate() {
            self.renumbering[v as usize] = i as u32;
        }
        let mut part = Local { starts: vec![0], free: inside.len(), ..Local::default() };
        for &v in inside {
            for (w, bond) in graph.edges(v as usize) {
                if self.renumbering[w as usize] != NONE {
                    part.neighbors.push(self.renumbering[w as usize]);
                    part.edge_weights.push(bond);
                }
            }
            part.starts.push(part.neighbors.len() as u32);
            part.weights.push(graph.weights[v as usize]);
        }
        part
    }

    /// A light cut with sides of similar weight.
    fn bisect(&mut self, graph: &Local) -> Cut {
        let from_first = self.distances(graph, 0).0;
        if !from_first.contains(&NONE) {
            return self.cut(graph);
        }
        let total: i64 = (0..graph.len()).map(|v| graph.weighs(v)).sum();
        let components = self.components(graph);
        let largest =
            components.iter().copied().max_by_key(|&(start, weight)| (weight, u32::MAX - start));
        let (start, weight) = largest.expect("a graph to cut has vertices");
        let mut side = vec![CUT; graph.len()];
        if weight as f64 <= LARGE * total as f64 {
            return self.distribute(graph, components, side);
        }
        let from_start = self.distances(graph, start).0;
        let inside: Vec<u32> =
            (0..graph.len() as u32).filter(|&v| from_start[v as usize] != NONE).collect();
        let part = self.part(graph, &inside);
        let cut = self.cut(&part);
        for (&v, &part_side) in inside.iter().zip(&cut.side) {
            side[v as usize] = part_side;
        }
        let others = components.into_iter().filter(|&(first, _)| first != start).collect();
        self.distribute(graph, others, side)
    }

    /// A cut found on a graph of clusters and improved on this one.
    fn cut(&mut self, graph: &Local) -> Cut {
        if graph.len() <= COARSEST {
            return self.first_cut(graph);
        }
        let Some((cluster, coarse)) = cluster(graph, CLUSTER) else { return self.first_cut(graph) };
        let coarse_cut = self.cut(&coarse);
        let side = cluster.iter().map(|&c| coarse_cut.side[c as usize]).collect();
        let mut cut = Cut::new(graph, side);
        self.improver.improve(graph, &mut cut, PASSES);
        cut
    }

    /// The lightest of cuts in several directions.
    fn first_cut(&mut self, graph: &Local) -> Cut {
        let n = graph.len() as u32;
        let total: i64 = (0..graph.len()).map(|v| graph.weighs(v)).sum();
        let mut best: Option<Cut> = None;
        let mut start = 0;
        for direction in 0..DIRECTIONS {
            let first = self.distances(graph, start).1;
            let (to_first, second) = self.distances(graph, first);
            let to_second = self.distances(graph, second).0;
            let mut cut = halve(graph, &to_first, &to_second, total);
            self.improver.improve(graph, &mut cut, PASSES);
            if best.as_ref().is_none_or(|best| cut.quality() < best.quality()) {
                best = Some(cut);
            }
            // Across the first direction; then from anywhere.
            start = match direction {
                0 => {
                    let across = |&v: &u32| to_first[v as usize].min(to_second[v as usize]);
                    (0..n).max_by_key(across).unwrap_or(0)
                }
                _ => direction.wrapping_mul(0x9e37_79b9) % n,
            };
        }
        best.expect("at least one direction is tried")
    }

    /// First vertex and weight of each component.
    fn components(&mut self, graph: &Local) -> Vec<(u32, i64)> {
        let mut reached = vec![false; graph.len()];
        let mut components = Vec::new();
        for start in 0..graph.len() {
            if std::mem::replace(&mut reached[start], true) {
                continue;
            }
            self.queue.clear();
            self.queue.push(start as u32);
            let (mut next, mut weight) = (0, 0);
            while next < self.queue.len() {
                let v = self.queue[next] as usize;
                weight += graph.weighs(v);
                for &w in graph.neighbors(v) {
                    if !std::mem::replace(&mut reached[w as usize], true) {
                        self.queue.push(w);
                    }
                }
                next += 1;
            }
            components.push((start as u32, weight));
        }
        components
    }

    /// Puts each of these components on the side that is lighter, heavy ones first.
    fn distribute(&mut self, graph: &Local, mut components: Vec<(u32, i64)>, side: Vec<u8>) -> Cut {
        components.sort_by_key(|&(start, weight)| (-weight, start));
        let mut cut = Cut::new(graph, side);
        for (start, weight) in components {
            let lighter = usize::from(cut.weight[1] < cut.weight[0]);
            cut.weight[lighter] += weight;
            cut.weight[usize::from(CUT)] -= weight;
            self.queue.clear();
            self.queue.push(start);
            cut.side[start as usize] = lighter as u8;
            let mut next = 0;
            while next < self.queue.len() {
                for &w in graph.neighbors(self.queue[next] as usize) {
                    if std::mem::replace(&mut cut.side[w as usize], lighter as u8) == CUT {
                        self.queue.push(w);
                    }
                }
                next += 1;
            }
        }
        Cut::new(graph, cut.side)
    }

    /// Steps from `start` to each vertex, and the last one reached; [`NONE`] for other components.
    fn distances(&mut self, graph: &Local, start: u32) -> (Vec<u32>, u32) {
        let mut distance = vec![NONE; graph.len()];
        distance[start as usize] = 0;
        self.queue.clear();
        self.queue.push(start);
        let mut next = 0;
        while next < self.queue.len() {
            let v = self.queue[next] as usize;
            for &w in graph.neighbors(v) {
                if distance[w as usize] == NONE {
                    distance[w as usize] = distance[v] + 1;
                    self.queue.push(w);
                }
            }
            next += 1;
        }
        (distance, self.queue[next - 1])
    }
}

/// The half of the weight that is nearer to the first end, and a cut between it and the rest.
fn halve(graph: &Local, first: &[u32], second: &[u32], total: i64) -> Cut {
    let n = graph.len();
    // Counting sort by the difference.
    let key = |v: usize| (first[v] + n as u32 - second[v]) as usize;
    let mut weight_of = vec![0_i64; 2 * n + 1];
    for v in 0..n {
        weight_of[key(v)] += graph.weighs(v);
    }
    let (mut below, mut level) = (0, 0);
    while 2 * (below + weight_of[level]) <= total {
        below += weight_of[level];
        level += 1;
    }
    // Of the level that contains the half, vertices go to the first side until it is full.
    let mut side = vec![1_u8; n];
    for (v, side) in side.iter_mut().enumerate() {
        let key = key(v);
        if key < level {
            *side = 0;
        } else if key == level && 2 * below < total {
            below += graph.weighs(v);
            *side = 0;
        }
    }
    let borders = |v: usize| graph.neighbors(v).iter().any(|&w| side[w as usize] != side[v]);
    let border: Vec<usize> = (0..n).filter(|&v| borders(v)).collect();
    let mut weights = [0; 2];
    for &v in &border {
        weights[usize::from(side[v])] += graph.weighs(v);
    }
    let lighter = u8::from(weights[1] < weights[0]);
    for v in border.into_iter().filter(|&v| side[v] == lighter).collect::<Vec<_>>() {
        side[v] = CUT;
    }
    Cut::new(graph, side)
}
