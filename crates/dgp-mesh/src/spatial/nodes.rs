//! The hierarchy itself: a flat array of nodes of four boxes each, and how to walk it.
//!
//! A node holds the boxes of its four children side by side, so that one pass of vector instructions
//! tests all of them, and is two cache lines long. Boxes are in single precision and a little too
//! large (see [`frame`](super::frame)): they decide what is looked at, never what is found.

use std::ops::Range;

use glam::DVec3;

use super::frame::{Frame, above};

/// How many children a node has.
pub(super) const WIDTH: usize = 4;

/// The most nodes that wait on a walk: three for each level.
const STACK: usize = 3 * super::build::MAX_DEPTH + WIDTH;

/// Boxes of four children. A child of count zero is the node `first`; any other is a leaf with the
/// items `first..first + count`. Empty children have boxes that nothing meets.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Node {
    pub(super) lo: [[f32; WIDTH]; 3],
    pub(super) hi: [[f32; WIDTH]; 3],
    pub(super) first: [u32; WIDTH],
    pub(super) count: [u32; WIDTH],
}

impl Node {
    /// A node without children.
    pub(super) const EMPTY: Node = Node {
        lo: [[f32::INFINITY; WIDTH]; 3],
        hi: [[f32::NEG_INFINITY; WIDTH]; 3],
        first: [u32::MAX; WIDTH],
        count: [0; WIDTH],
    };

    /// Whether child `i` is there.
    #[inline]
    pub(super) fn has(&self, i: usize) -> bool {
        self.first[i] != u32::MAX
    }

    /// The items of child `i`, if it is a leaf.
    #[inline]
    pub(super) fn leaf(&self, i: usize) -> Option<Range<usize>> {
        let first = self.first[i] as usize;
        (self.count[i] > 0).then(|| first..first + self.count[i] as usize)
    }
}

/// A point, as boxes see it.
pub(super) trait Target {
    /// What its distances are counted in.
    type Number: Copy + PartialOrd;
    const ZERO: Self::Number;
    /// Lower bounds of the squared distances to the children of a node, but for a part of 2⁻²⁰.
    fn distances(&self, node: &Node) -> [Self::Number; WIDTH];
    /// A bound beyond which nothing has a squared distance of `square` or less.
    fn limit(square: f64) -> Self::Number;
}

/// A point not far from the boxes: in single precision, between two corners.
pub(super) struct Near {
    lo: [f32; 3],
    hi: [f32; 3],
}

impl Target for Near {
    type Number = f32;
    const ZERO: f32 = 0.0;

    #[inline]
    fn distances(&self, node: &Node) -> [f32; WIDTH] {
        let mut sum = [0.0; WIDTH];
        for axis in 0..3 {
            for (i, sum) in sum.iter_mut().enumerate() {
                let before = node.lo[axis][i] - self.hi[axis];
                let behind = self.lo[axis] - node.hi[axis][i];
                let out = if before > behind { before } else { behind };
                let out = if out > 0.0 { out } else { 0.0 };
                *sum += out * out;
            }
        }
        sum
    }

    #[inline]
    fn limit(square: f64) -> f32 {
        // The squares and sums of `distances` lose a part of 2⁻²¹ at most, and what vanishes.
        above(square * (1.0 + 1.0 / (1_u64 << 20) as f64)) + f32::MIN_POSITIVE
    }
}

/// A point so far away that single precision would see all boxes at the same distance.
pub(super) struct Far(DVec3);

impl Target for Far {
    type Number = f64;
    const ZERO: f64 = 0.0;

    fn distances(&self, node: &Node) -> [f64; WIDTH] {
        let mut sum = [0.0; WIDTH];
        for (axis, x) in self.0.to_array().into_iter().enumerate() {
            for (i, sum) in sum.iter_mut().enumerate() {
                let before = f64::from(node.lo[axis][i]) - x;
                let behind = x - f64::from(node.hi[axis][i]);
                let out = before.max(behind).max(0.0);
                *sum += out * out;
            }
        }
        sum
    }

    fn limit(square: f64) -> f64 {
        square * (1.0 + 1.0 / (1_u64 << 44) as f64) + f64::MIN_POSITIVE
    }
}

/// A ray, as boxes see it: by the sides at which it enters and leaves.
pub(super) struct Beam {
    /// The end of the interval of its start that makes it enter a box as early as can be.
    pub(super) near: [f32; 3],
    /// The end that makes it leave a box as late as can be.
    pub(super) far: [f32; 3],
    /// One over its direction: finite and not zero.
    pub(super) inverse: [f32; 3],
}

impl Beam {
    /// Where it enters each child, and where it leaves, but for a part of 2⁻²¹.
    #[inline]
    fn interval(&self, node: &Node) -> ([f32; WIDTH], [f32; WIDTH]) {
        let (mut enter, mut leave) = ([0.0; WIDTH], [f32::INFINITY; WIDTH]);
        for axis in 0..3 {
            let inverse = self.inverse[axis];
            let (first, last) = if inverse > 0.0 {
                (&node.lo[axis], &node.hi[axis])
            } else {
                (&node.hi[axis], &node.lo[axis])
            };
            for i in 0..WIDTH {
                let a = (first[i] - self.near[axis]) * inverse;
                let b = (last[i] - self.far[axis]) * inverse;
                enter[i] = if a > enter[i] { a } else { enter[i] };
                leave[i] = if b < leave[i] { b } else { leave[i] };
            }
        }
        (enter, leave)
    }
}

/// The hierarchy over items `0..n`.
#[derive(Clone, Debug)]
pub(super) struct Nodes {
    pub(super) nodes: Vec<Node>,
    pub(super) frame: Frame,
}

impl Nodes {
    /// Offers leaves near `q` (scaled) to `visit(items, limit)`, nearest box first. `visit` gives the
    /// squared distance beyond which nothing is wanted any more, which starts at `limit`.
    #[inline]
    pub(super) fn near(&self, q: DVec3, limit: f64, visit: impl FnMut(Range<usize>) -> f64) {
        // Up to here single precision tells apart what is a millionth of the size apart.
        const NEAR: f64 = 8.0;
        let local = q - self.frame.center;
        if local.abs().max_element() < NEAR {
            let (lo, hi) = self.frame.rounded(q);
            self.walk_near(&Near { lo, hi }, limit, visit);
        } else {
            self.walk_near(&Far(local), limit, visit);
        }
    }

    #[inline]
    fn walk_near<T: Target>(
        &self,
        target: &T,
        limit: f64,
        mut visit: impl FnMut(Range<usize>) -> f64,
    ) {
        let mut stack = [(T::ZERO, 0_u32, 0_u32); STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        let mut limit = T::limit(limit);
        while waiting > 0 {
            waiting -= 1;
            let (distance, first, count) = stack[waiting];
            if distance > limit {
                continue;
            }
            if count > 0 {
                limit = T::limit(visit(first as usize..(first + count) as usize));
                continue;
            }
            let node = &self.nodes[first as usize];
            let distances = target.distances(node);
            let bottom = waiting;
            for (i, distance) in distances.into_iter().enumerate() {
                if distance > limit || !node.has(i) {
                    continue;
                }
                insert(&mut stack[bottom..=waiting], (distance, node.first[i], node.count[i]));
                waiting += 1;
            }
        }
    }

    /// Offers leaves on `beam` to `visit(items)`, nearest first. `visit` gives how far along the beam more
    /// is wanted, which starts at `limit`.
    pub(super) fn along(
        &self,
        beam: &Beam,
        mut limit: f32,
        mut visit: impl FnMut(Range<usize>) -> f32,
    ) {
        const SLACK: f32 = 1.0 + 1.0 / (1 << 19) as f32;
        let mut stack = [(0.0_f32, 0_u32, 0_u32); STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let (distance, first, count) = stack[waiting];
            if distance > limit {
                continue;
            }
            if count > 0 {
                limit = visit(first as usize..(first + count) as usize);
                continue;
            }
            let node = &self.nodes[first as usize];
            let (enter, leave) = beam.interval(node);
            let bottom = waiting;
            for i in 0..WIDTH {
                let distance = enter[i];
                if distance > leave[i] * SLACK || distance > limit {
                    continue;
                }
                insert(&mut stack[bottom..=waiting], (distance, node.first[i], node.count[i]));
                waiting += 1;
            }
        }
    }

    /// Offers all leaves whose box meets the box from `lo` to `hi` to `visit`, which tells whether to go
    /// on.
    pub(super) fn overlapping(
        &self,
        lo: [f32; 3],
        hi: [f32; 3],
        mut visit: impl FnMut(Range<usize>) -> bool,
    ) {
        let mut stack = [0_u32; STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let node = &self.nodes[stack[waiting] as usize];
            let mut meets = [true; WIDTH];
            for axis in 0..3 {
                for (i, meets) in meets.iter_mut().enumerate() {
                    // Both sides are looked at, so that there is no branch.
                    let apart = [node.lo[axis][i] > hi[axis], lo[axis] > node.hi[axis][i]];
                    *meets &= apart == [false; 2];
                }
            }
            for i in (0..WIDTH).filter(|&i| meets[i]) {
                if let Some(items) = node.leaf(i) {
                    if !visit(items) {
                        return;
                    }
                } else {
                    stack[waiting] = node.first[i];
                    waiting += 1;
                }
            }
        }
    }
}

/// Puts an entry among those before the last place, which are sorted: the nearest is last.
#[inline]
fn insert<T: Copy + PartialOrd>(stack: &mut [(T, u32, u32)], entry: (T, u32, u32)) {
    let mut place = stack.len() - 1;
    while place > 0 && stack[place - 1].0 < entry.0 {
        stack[place] = stack[place - 1];
        place -= 1;
    }
    stack[place] = entry;
}
