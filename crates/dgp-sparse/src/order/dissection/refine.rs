//! Cuts that come from a coarser level are thick and ragged: here they become thin and straight.
//!
//! From the whole graph downwards each cut is improved within a band of some vertices on both sides. A
//! vertex that leaves the cut goes to the lowest region of that side which all of its neighbors allow;
//! if it borders on both sides of a lower cut, it joins that.

use super::{
    coarsen::{Level, Weighted},
    regions::Regions,
    separator::{CUT, Cut, Improver, Local},
};
use crate::order::NONE;

/// How far from the cut vertices take part; the last of these rings stays fixed.
const RINGS: usize = 2;

/// How often each cut is improved, at most.
const PASSES: usize = 3;

/// Improves all cuts of a level.
pub(super) fn refine(level: &Level<'_>, label: &mut [u32], regions: &mut Regions) {
    let (starts, members) = regions.members(label);
    let mut joined: Vec<Vec<u32>> = vec![Vec::new(); regions.len()];
    let mut band = Band::default();
    band.local.resize(level.len(), NONE);
    for region in 0..regions.len() as u32 {
        if regions.is_block(region) {
            continue;
        }
        let at = region as usize;
        let members = &members[starts[at] as usize..starts[at + 1] as usize];
        let joining = std::mem::take(&mut joined[at]);
        band.collect(level, label, regions, region, members.iter().chain(&joining));
        let before = band.cut.side.clone();
        band.improver.improve(&band.graph, &mut band.cut, PASSES);
        band.apply(level, label, regions, region, &before, &mut joined);
    }
}

/// A cut and what lies around it.
#[derive(Default)]
struct Band {
    graph: Local,
    cut: Cut,
    improver: Improver,
    /// The vertices of the band, and the number of each vertex in it.
    vertices: Vec<u32>,
    local: Vec<u32>,
}

impl Band {
    fn collect<'a>(
        &mut self,
        level: &Level<'_>,
        label: &[u32],
        regions: &Regions,
        region: u32,
        members: impl Iterator<Item = &'a u32>,
    ) {
        self.vertices.clear();
        self.cut.side.clear();
        for &v in members {
            if label[v as usize] == region && self.local[v as usize] == NONE {
                self.local[v as usize] = self.vertices.len() as u32;
                self.vertices.push(v);
                self.cut.side.push(CUT);
            }
        }
        let graph = &mut self.graph;
        graph.starts.clear();
        graph.neighbors.clear();
        graph.starts.push(0);
        let (mut next, mut ring_end) = (0, self.vertices.len());
        for _ in 0..RINGS {
            while next < ring_end {
                for &w in level.neighbors(self.vertices[next] as usize) {
                    let place = &mut self.local[w as usize];
                    if *place == NONE {
                        let Some(side) = regions.side(region, label[w as usize]) else { continue };
                        *place = self.vertices.len() as u32;
                        self.vertices.push(w);
                        self.cut.side.push(side as u8);
                    }
                    graph.neighbors.push(*place);
                }
                graph.starts.push(graph.neighbors.len() as u32);
                next += 1;
            }
            ring_end = self.vertices.len();
        }
        graph.free = next;
        graph.starts.resize(ring_end + 1, graph.neighbors.len() as u32);
        graph.weights.clear();
        graph.weights.extend(self.vertices.iter().map(|&v| level.weight(v as usize)));
        let parts = regions.parts(region).map(|part| regions.weight(part) as i64);
        let cut = regions.weight(region) as i64 - parts[0] - parts[1];
        self.cut.weight = [parts[0], parts[1], cut];
        self.cut.expense = self.cut.expense_of(graph);
    }

    /// Gives new labels to what changed.
    fn apply(
        &mut self,
        level: &Level<'_>,
        label: &mut [u32],
        regions: &mut Regions,
        region: u32,
        before: &[u8],
        joined: &mut [Vec<u32>],
    ) {
        for &v in &self.vertices {
            self.local[v as usize] = NONE;
        }
        let changed = || (0..before.len()).filter(|&i| before[i] != self.cut.side[i]);
        // First all labels that are no longer true, so that what leaves the cut sees only what stays.
        for i in changed().filter(|&i| before[i] != CUT) {
            let v = self.vertices[i] as usize;
            let old = std::mem::replace(&mut label[v], region);
            regions.transfer(region, old, region, u64::from(level.weight(v)));
        }
        for i in changed().filter(|&i| self.cut.side[i] != CUT) {
            let v = self.vertices[i] as usize;
            let part = regions.parts(region)[usize::from(self.cut.side[i])];
            label[v] = lowest(level, label, regions, part, v);
            regions.transfer(region, region, label[v], u64::from(level.weight(v)));
            if !regions.is_block(label[v]) {
                joined[label[v] as usize].push(v as u32);
            }
        }
    }
}

/// The lowest region within `part` that all neighbors of `v` allow.
fn lowest(level: &Level<'_>, label: &[u32], regions: &Regions, part: u32, v: usize) -> u32 {
    let mut region = part;
    while !regions.is_block(region) {
        let mut seen = [false; 2];
        for &w in level.neighbors(v) {
            if let Some(side) = regions.side(region, label[w as usize]) {
                seen[side] = true;
            }
        }
        let parts = regions.parts(region);
        region = match seen {
            [true, true] => break,
            [true, false] => parts[0],
            [false, true] => parts[1],
            [false, false] => {
                parts[usize::from(regions.weight(parts[1]) < regions.weight(parts[0]))]
            }
        };
    }
    region
}
