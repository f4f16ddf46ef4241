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
use crate::{order::NONE, parallel};

/// How far from the cut vertices take part; the last of these rings stays fixed.
const RINGS: usize = 2;

/// How often each cut is improved, at most.
const PASSES: usize = 3;

/// On levels of more vertices cuts are improved by several bands side by side.
const SMALL: usize = 16_384;

/// How many these are.
const BANDS: usize = 4;

/// Improves all cuts of a level. Those at the same depth of the tree know nothing of each other: they are
/// shared among threads.
pub(super) fn refine(level: &Level<'_>, label: &mut [u32], regions: &mut Regions) {
    let (starts, members) = regions.members(label);
    let of = |region: u32| {
        &members[starts[region as usize] as usize..starts[region as usize + 1] as usize]
    };
    let mut joined: Vec<Vec<u32>> = vec![Vec::new(); regions.len()];
    let count = if level.len() < SMALL { 1 } else { BANDS };
    let mut bands: Vec<Band> = Vec::new();
    bands.resize_with(count, || Band { local: vec![NONE; level.len()], ..Band::default() });
    for cuts in regions.cuts_by_depth() {
        let mut loads = vec![0; count];
        for region in cuts {
            let least = (0..count).min_by_key(|&i| loads[i]).unwrap_or(0);
            loads[least] += of(region).len() + joined[region as usize].len();
            bands[least].cuts.push(region);
        }
        let (now, tree) = (&*label, &*regions);
        parallel::map_chunks(&mut bands, 1, |_, bands| {
            let members = |region| of(region).iter().chain(&joined[region as usize]);
            bands[0].improve(level, now, tree, members);
        });
        for change in bands.iter_mut().flat_map(|band| band.changes.drain(..)) {
            change.apply(level, label, regions, &mut joined);
        }
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
    /// The regions whose cuts are to be improved, and what was found.
    cuts: Vec<u32>,
    changes: Vec<Change>,
}

/// Vertices that change sides at a cut, with the side before and after.
struct Change {
    region: u32,
    vertices: Vec<(u32, u8, u8)>,
}

impl Band {
    /// Improves the cuts listed, of which `members` gives the vertices and perhaps others.
    fn improve<'a, I: Iterator<Item = &'a u32>>(
        &mut self,
        level: &Level<'_>,
        label: &[u32],
        regions: &Regions,
        members: impl Fn(u32) -> I,
    ) {
        for region in std::mem::take(&mut self.cuts) {
            self.collect(level, label, regions, region, members(region));
            let before = self.cut.side.clone();
            self.improver.improve(&self.graph, &mut self.cut, PASSES);
            for &v in &self.vertices {
                self.local[v as usize] = NONE;
            }
            let marks = before.iter().zip(&self.cut.side);
            let all = self.vertices.iter().zip(marks).map(|(&v, (&old, &new))| (v, old, new));
            self.changes.push(Change { region, vertices: all.filter(|c| c.1 != c.2).collect() });
        }
    }

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
}

impl Change {
    /// Gives new labels to what changed.
    fn apply(
        &self,
        level: &Level<'_>,
        label: &mut [u32],
        regions: &mut Regions,
        joined: &mut [Vec<u32>],
    ) {
        let Change { region, vertices } = self;
        // First all labels that are no longer true, so that what leaves the cut sees only what stays.
        for &(v, ..) in vertices.iter().filter(|&&(_, before, _)| before != CUT) {
            let old = std::mem::replace(&mut label[v as usize], *region);
            regions.transfer(*region, old, *region, u64::from(level.weight(v as usize)));
        }
        for &(v, _, after) in vertices.iter().filter(|&&(_, _, after)| after != CUT) {
            let part = regions.parts(*region)[usize::from(after)];
            let new = lowest(level, label, regions, part, v as usize);
            label[v as usize] = new;
            regions.transfer(*region, *region, new, u64::from(level.weight(v as usize)));
            if !regions.is_block(new) {
                joined[new as usize].push(v);
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
