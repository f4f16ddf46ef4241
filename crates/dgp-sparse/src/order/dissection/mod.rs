//! Nested dissection: cuts a graph in two by few vertices, which are eliminated last, and so on.
//!
//! ```text
//! coarse ●──────────● fine        1. cluster vertices, level by level, until few are left
//!   cut blocks → thin and          2. on each level, from coarse to fine: project the cuts found so
//!   straighten all cuts → …           far, move them to where they are smallest, cut blocks in two
//!                                  3. order the blocks that remain by minimum degree
//! ```
//!
//! Other multilevel programs cluster each part of the graph again after each cut. Here all cuts share
//! one clustering: each is found on the level where its block has a few hundred vertices, and moves
//! only locally on the finer ones. The cost is some passes over the graph instead of some passes for
//! each level of the dissection.
//!
//! - Input: any graph. It need not be connected.
//! - Cost: O(edges), and O(cut log cut) for each cut.
//! - Guarantees: same order for any number of threads.
//! - Reference: George, "Nested dissection of a regular finite element mesh", 1973; Karypis and Kumar,
//!   "A fast and high quality multilevel scheme for partitioning irregular graphs", 1998; Ashcraft and
//!   Liu, "Applications of the Dulmage–Mendelsohn decomposition and network flow to graph
//!   bisection improvement", 1998.
//! - Departs from them: the shared clustering.

mod bisect;
mod coarsen;
mod halves;
mod refine;
mod regions;
mod separator;

use super::{
    Graph, NONE,
    minimum_degree::{MinimumDegree, dense_limit},
};
use std::ops::Range;

use crate::{Error, Progress, parallel};
use coarsen::{Level, Weighted, coarsen};
use regions::Regions;

/// Blocks that weigh no more are not cut further: minimum degree orders them as well.
const LEAF: u64 = 1000;

/// Blocks of more vertices than this are cut on the level where they occur, unless it is the finest one.
/// More would make the search for a cut slower, fewer would make cuts that finer levels cannot mend.
const BLOCK: usize = 350;

/// The same on the finest level, where only what could not be clustered is as large.
const FINEST_BLOCK: usize = 2000;

/// Levels with fewer than this part of the vertices are where everything is decided, at little cost.
const COARSE: usize = 32;

/// The first cut of a surface like a sphere of n vertices weighs 6 to 8 √n on a coarse level. Where it
/// weighs more than this many √n there are many handles, and cuts that differ more: it pays to find
/// several and keep the best.
const HARD: f64 = 9.8;

/// How many are found then.
const ATTEMPTS: u32 = 12;

/// An order for the whole of `graph`.
pub(crate) fn dissection(graph: &Graph, progress: Progress<'_>) -> Result<Vec<u32>, Error> {
    let n = graph.len();
    // Vertices with very many neighbors would be in each cut: they come last.
    let limit = dense_limit(n);
    let dense: Vec<u32> =
        (0..n as u32).filter(|&v| graph.neighbors(v as usize).len() > limit).collect();
    if dense.is_empty() {
        return dissect(graph, progress);
    }
    let sparse: Vec<u32> =
        (0..n as u32).filter(|&v| graph.neighbors(v as usize).len() <= limit).collect();
    let order = dissect(&subgraph(graph, &sparse), progress)?;
    Ok(order.into_iter().map(|i| sparse[i as usize]).chain(dense).collect())
}

fn dissect(graph: &Graph, progress: Progress<'_>) -> Result<Vec<u32>, Error> {
    let n = graph.len();
    let levels = coarsen(graph, progress.part(0.0, 0.3))?;
    let coarse = levels.iter().position(|level| COARSE * level.len() < n).unwrap_or(levels.len());
    let mut cuts = Cuts::new(&levels);
    for depth in (coarse..levels.len()).rev() {
        progress.report(0.3)?;
        cuts.descend(&levels, depth, 0);
    }
    if cuts.regions.weight_of_cut(0) as f64 > HARD * (n as f64).sqrt() {
        progress.report(0.3)?;
        cuts = cuts.or_better(&levels, coarse..levels.len());
    }
    for depth in (0..coarse).rev() {
        progress.report(0.4 + 0.3 * (coarse - depth) as f64 / coarse as f64)?;
        cuts.descend(&levels, depth, 0);
    }
    let Cuts { label, regions } = cuts;
    progress.report(0.7)?;
    let order = eliminate(graph, &label, &regions);
    progress.report(1.0)?;
    Ok(order)
}

/// The cuts found so far.
struct Cuts {
    /// Of each vertex of the present level.
    label: Vec<u32>,
    regions: Regions,
}

impl Cuts {
    /// None, on the coarsest level.
    fn new(levels: &[Level<'_>]) -> Cuts {
        let n = levels[0].len();
        let label = vec![0; levels.last().map_or(n, Weighted::len)];
        Cuts { label, regions: Regions::new(n as u64) }
    }

    /// Goes down to the level `depth` from the one above it: improves all cuts, and cuts large blocks.
    /// What it starts from depends on `seed`.
    fn descend(&mut self, levels: &[Level<'_>], depth: usize, seed: u32) {
        let level = &levels[depth];
        if let Some(cluster) = &level.cluster {
            self.label = cluster.iter().map(|&c| self.label[c as usize]).collect();
            refine::refine(level, &mut self.label, &mut self.regions);
        }
        let most = if depth == 0 { FINEST_BLOCK } else { BLOCK };
        bisect::split_blocks(level, &mut self.label, &mut self.regions, most, seed);
    }

    /// The best of these cuts, which were found on a range of levels, and some that start elsewhere.
    fn or_better(self, levels: &[Level<'_>], range: Range<usize>) -> Cuts {
        let mut others: Vec<u32> = (1..ATTEMPTS).collect();
        let others = parallel::map_chunks(&mut others, 1, |_, seed| {
            let mut cuts = Cuts::new(levels);
            for depth in range.clone().rev() {
                cuts.descend(levels, depth, seed[0]);
            }
            cuts
        });
        let all = std::iter::once(self).chain(others);
        all.min_by(|a, b| a.cost().total_cmp(&b.cost())).expect("there is one at least")
    }

    /// About the entries of the factor that are due to the cuts.
    fn cost(&self) -> f64 {
        let regions = 0..self.regions.len() as u32;
        regions.map(|region| (self.regions.weight_of_cut(region) as f64).powi(2)).sum()
    }
}

/// The graph of some vertices, renumbered as they are listed.
fn subgraph(graph: &Graph, vertices: &[u32]) -> Graph {
    let mut new = vec![NONE; graph.len()];
    for (i, &v) in vertices.iter().enumerate() {
        new[v as usize] = i as u32;
    }
    let (mut starts, mut neighbors) = (vec![0], Vec::new());
    for &v in vertices {
        let kept = graph.neighbors(v as usize).iter().map(|&w| new[w as usize]);
        neighbors.extend(kept.filter(|&i| i != NONE));
        starts.push(neighbors.len() as u32);
    }
    Graph::new(starts, neighbors)
}

/// Blocks are ordered by minimum degree, each with the cuts around it as halo; a cut comes after the
/// two sides of it.
fn eliminate(graph: &Graph, label: &[u32], regions: &Regions) -> Vec<u32> {
    let (starts, members) = regions.members(label);
    let of = |region: u32| {
        &members[starts[region as usize] as usize..starts[region as usize + 1] as usize]
    };
    let sequence = regions.bottom_up();
    // Few large chunks, since each needs a map from vertices to their place in a block.
    let mut pieces: Vec<(u32, Vec<u32>)> =
        sequence.iter().map(|&region| (region, Vec::new())).collect();
    let chunk = pieces.len().div_ceil(8);
    parallel::map_chunks(&mut pieces, chunk, |_, pieces| {
        let mut engine = MinimumDegree::default();
        let mut local = vec![NONE; graph.len()];
        for (region, order) in pieces {
            if regions.is_block(*region) {
                *order = order_block(graph, of(*region), &mut engine, &mut local);
            } else {
                *order = of(*region).to_vec();
            }
        }
    });
    pieces.into_iter().flat_map(|(_, order)| order).collect()
}

fn order_block(
    graph: &Graph,
    block: &[u32],
    engine: &mut MinimumDegree,
    local: &mut [u32],
) -> Vec<u32> {
    for (i, &v) in block.iter().enumerate() {
        local[v as usize] = i as u32;
    }
    engine.clear(block.len());
    let mut halo = Vec::new();
    for &v in block {
        engine.push(graph.neighbors(v as usize).iter().map(|&w| {
            let place = &mut local[w as usize];
            if *place == NONE {
                *place = (block.len() + halo.len()) as u32;
                halo.push(w);
            }
            *place
        }));
    }
    for &v in &halo {
        let neighbors = graph.neighbors(v as usize).iter().map(|&w| local[w as usize]);
        engine.push(neighbors.filter(|&i| (i as usize) < block.len()));
    }
    let mut order = Vec::with_capacity(block.len());
    engine.run(|i| order.push(block[i as usize]));
    for &v in block.iter().chain(&halo) {
        local[v as usize] = NONE;
    }
    order
}
