//! First cuts of blocks, where they have a few hundred vertices.
//!
//! Vertices are sorted by their distance to a vertex u, or by d(u) − d(w) for two far from each other, and
//! the lighter half goes to one side. That is done in several directions on clusters of the block; the
//! best halves, by the edges between them, are improved on the block itself. What borders there on the
//! other half becomes the cut.

use super::{
    LEAF,
    coarsen::{Level, Weighted, cluster},
    halves::HalfImprover,
    regions::Regions,
    separator::{CUT, Cut, Improver, Local},
};
use crate::{order::NONE, parallel};

/// How many directions are tried for large blocks, of which there are few, and for others.
const DIRECTIONS: [u32; 2] = [4, 3];

/// How often first halves are improved, at most, and how often the best of them and their cut.
const FIRST_PASSES: usize = 2;
const PASSES: usize = 4;

/// A component with less than this part of the weight leaves room for others on its side.
const LARGE: f64 = 0.6;

/// Blocks of more vertices are clustered before they are halved.
const COARSEST: usize = 200;

/// Vertices per cluster where they are: few, since there is time for it.
const CLUSTER: usize = 3;

/// Blocks that weigh more are large.
const LARGE_BLOCK: i64 = 10_000;

/// Halves of a large block that weighs w are hard to find where more than this many √w edges join them:
/// a sphere has 2 to 5.
const HARD: f64 = 3.0;

/// How often they are looked for then, each time with other clusters.
const ATTEMPTS: usize = 2;

/// Blocks that one task cuts.
const CHUNK: usize = 4;

/// Cuts all blocks of more than `most` vertices on this level, until none is left.
pub(super) fn split_blocks(
    level: &Level<'_>,
    label: &mut [u32],
    regions: &mut Regions,
    most: usize,
    seed: u32,
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
        let mut bisector = Bisector { most, seed, ..Bisector::default() };
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
    /// Decides where searches start.
    seed: u32,
    improver: Improver,
    halves: HalfImprover,
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

    /// A cut between halves.
    fn cut(&mut self, graph: &Local) -> Cut {
        let total: i64 = (0..graph.len()).map(|v| graph.weighs(v)).sum();
        let mut best = self.halve(graph, total, self.seed);
        let hard = best.0 as f64 > HARD * (total as f64).sqrt();
        if total > LARGE_BLOCK && graph.len() > COARSEST && hard {
            for attempt in 1..ATTEMPTS {
                let other = self.halve(graph, total, self.seed + 10 * attempt as u32);
                if other.0 < best.0 {
                    best = other;
                }
            }
        }
        let mut cut = thin(graph, best.1);
        self.improver.improve(graph, &mut cut, PASSES);
        cut
    }

    /// Halves found on a graph of clusters and improved on this one, and how bad they are.
    fn halve(&mut self, graph: &Local, total: i64, seed: u32) -> (i64, Vec<u8>) {
        if graph.len() > COARSEST {
            let start = scattered(seed, graph.len() as u32) as usize;
            if let Some((cluster, coarse)) = cluster(graph, CLUSTER, start) {
                let (_, halves) = self.halve(&coarse, total, seed);
                let mut side: Vec<u8> = cluster.iter().map(|&c| halves[c as usize]).collect();
                let quality = self.halves.improve(graph, &mut side, PASSES);
                return (quality, side);
            }
        }
        self.first_halves(graph, total, seed)
    }

    /// The best of halves around several vertices, and how bad they are.
    fn first_halves(&mut self, graph: &Local, total: i64, seed: u32) -> (i64, Vec<u8>) {
        let n = graph.len() as u32;
        let directions = DIRECTIONS[usize::from(total <= LARGE_BLOCK)];
        let mut start = scattered(seed, n);
        let mut best = (i64::MAX, Vec::new());
        for direction in 0..directions {
            let mut side = if direction % 2 == 0 {
                // Between two vertices far from each other.
                let first = self.distances(graph, start).1;
                let (to_first, second) = self.distances(graph, first);
                let to_second = self.distances(graph, second).0;
                nearest(graph, total, |v| to_first[v] + n - to_second[v])
            } else {
                let (to_start, _) = self.distances(graph, start);
                nearest(graph, total, |v| to_start[v])
            };
            let quality = self.halves.improve(graph, &mut side, FIRST_PASSES);
            if quality < best.0 {
                best = (quality, side);
            }
            start = scattered(direction + 1 + 16 * seed, n);
        }
        best
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

/// One of `n` numbers, far from those for other seeds.
fn scattered(seed: u32, n: u32) -> u32 {
    seed.wrapping_mul(0x9e37_79b9) % n
}

/// On side 0 the half of the weight for which `key`, a number below twice that of the vertices, is smallest.
fn nearest(graph: &Local, total: i64, key: impl Fn(usize) -> u32) -> Vec<u8> {
    let n = graph.len();
    // Counting sort.
    let mut weight_of = vec![0_i64; 2 * n + 1];
    for v in 0..n {
        weight_of[key(v) as usize] += graph.weighs(v);
    }
    let (mut below, mut level) = (0, 0);
    while 2 * (below + weight_of[level]) <= total {
        below += weight_of[level];
        level += 1;
    }
    // Of the level that contains the half, vertices go to the first side until it is full.
    let mut side = vec![1_u8; n];
    for (v, side) in side.iter_mut().enumerate() {
        let key = key(v) as usize;
        if key < level {
            *side = 0;
        } else if key == level && 2 * below < total {
            below += graph.weighs(v);
            *side = 0;
        }
    }
    side
}

/// The vertices of the lighter border between two halves become the cut.
fn thin(graph: &Local, mut side: Vec<u8>) -> Cut {
    let borders = |v: usize| graph.neighbors(v).iter().any(|&w| side[w as usize] != side[v]);
    let border: Vec<usize> = (0..graph.len()).filter(|&v| borders(v)).collect();
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
