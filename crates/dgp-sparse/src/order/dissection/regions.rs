//! The tree of regions: each is a block, or was cut into two by the vertices that carry its label.

use crate::order::NONE;

/// Cuts deeper than this are not made: a path is a bit for each.
const MAX_DEPTH: u8 = 60;

/// The tree. Regions are numbered so that each comes after the one it is a part of.
///
/// Every vertex carries the label of a region: a block that it is in, or a region that it helps to
/// cut. Neighbors carry labels of which one is above the other, or the same.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    regions: Vec<Region>,
}

#[derive(Clone, Debug)]
struct Region {
    parent: u32,
    /// The two parts, or [`NONE`] for a block.
    parts: [u32; 2],
    depth: u8,
    /// Which part was taken at each depth on the way from the whole graph to here, lowest bit first.
    path: u64,
    /// The weight of all vertices here, those of the cut counted.
    weight: u64,
}

impl Regions {
    /// One block.
    pub(super) fn new(weight: u64) -> Regions {
        let parts = [NONE; 2];
        Regions { regions: vec![Region { parent: NONE, parts, depth: 0, path: 0, weight }] }
    }

    pub(super) fn len(&self) -> usize {
        self.regions.len()
    }

    pub(super) fn is_block(&self, region: u32) -> bool {
        self.regions[region as usize].parts[0] == NONE
    }

    pub(super) fn parts(&self, region: u32) -> [u32; 2] {
        self.regions[region as usize].parts
    }

    pub(super) fn weight(&self, region: u32) -> u64 {
        self.regions[region as usize].weight
    }

    /// What the vertices that cut a region weigh.
    pub(super) fn weight_of_cut(&self, region: u32) -> u64 {
        match self.parts(region) {
            [NONE, _] => 0,
            parts => self.weight(region) - parts.map(|part| self.weight(part)).iter().sum::<u64>(),
        }
    }

    pub(super) fn can_be_cut(&self, region: u32) -> bool {
        self.regions[region as usize].depth < MAX_DEPTH
    }

    /// Cuts a block into two of these weights.
    pub(super) fn cut(&mut self, region: u32, weights: [u64; 2]) -> [u32; 2] {
        let Region { depth, path, .. } = self.regions[region as usize];
        let first = self.regions.len() as u32;
        for (side, weight) in weights.into_iter().enumerate() {
            self.regions.push(Region {
                parent: region,
                parts: [NONE; 2],
                depth: depth + 1,
                path: path | (side as u64) << depth,
                weight,
            });
        }
        self.regions[region as usize].parts = [first, first + 1];
        [first, first + 1]
    }

    /// On which side of the cut of `region` what carries `label` is; `None` where it is not below it.
    /// One of the two must be above the other.
    pub(super) fn side(&self, region: u32, label: u32) -> Option<usize> {
        let depth = self.regions[region as usize].depth;
        let below = &self.regions[label as usize];
        (below.depth > depth).then_some((below.path >> depth & 1) as usize)
    }

    /// Moves `weight` from the region labeled `from` to the one labeled `to`, both below `top`.
    pub(super) fn transfer(&mut self, top: u32, from: u32, to: u32, weight: u64) {
        let mut region = from;
        while region != top {
            self.regions[region as usize].weight -= weight;
            region = self.regions[region as usize].parent;
        }
        let mut region = to;
        while region != top {
            self.regions[region as usize].weight += weight;
            region = self.regions[region as usize].parent;
        }
    }

    /// The regions that were cut, by depth.
    pub(super) fn cuts_by_depth(&self) -> Vec<Vec<u32>> {
        let mut depths: Vec<Vec<u32>> = Vec::new();
        for region in (0..self.len() as u32).filter(|&region| !self.is_block(region)) {
            let depth = usize::from(self.regions[region as usize].depth);
            if depths.len() <= depth {
                depths.resize(depth + 1, Vec::new());
            }
            depths[depth].push(region);
        }
        depths
    }

    /// Where the vertices with each label start in the list that follows, and that list.
    pub(super) fn members(&self, label: &[u32]) -> (Vec<u32>, Vec<u32>) {
        let mut starts = vec![0_u32; self.len() + 1];
        for &label in label {
            starts[label as usize + 1] += 1;
        }
        crate::matrix::accumulate(&mut starts);
        let mut next = starts.clone();
        let mut members = vec![0_u32; label.len()];
        for (v, &label) in label.iter().enumerate() {
            members[next[label as usize] as usize] = v as u32;
            next[label as usize] += 1;
        }
        (starts, members)
    }

    /// All regions, each after its parts.
    pub(super) fn bottom_up(&self) -> Vec<u32> {
        // Top down, second part first, and then reversed.
        let mut order = Vec::with_capacity(self.len());
        let mut stack = vec![0_u32];
        while let Some(region) = stack.pop() {
            order.push(region);
            if !self.is_block(region) {
                stack.extend(self.parts(region));
            }
        }
        order.reverse();
        order
    }
}
