//! Building the hierarchy: along a curve through space at first, then by the surface area heuristic.
//!
//! ```text
//! cost of a cut = area(left box) · number(left) + area(right box) · number(right)
//! ```
//!
//! Items are sorted along the Z-order curve. Large parts are cut where the highest bit of the curve
//! changes, which is the middle of a cell of space. In parts of some hundred items, items fall into equal
//! bins along the axis in which their centers extend furthest; the cut is the cheapest between bins. The
//! last eight are halved. Two rounds of cuts give the four children of a node.
//!
//! - Input: boxes, in single precision.
//! - Cost: O(n log n), in parallel but for the sort; memory of 80 bytes an item while it runs.
//! - Guarantees: a bounded number of levels (from some depth on cuts go through the middle of the list);
//!   the same bits for any number of threads.
//! - Reference: Wald, "On fast construction of SAH-based bounding volume hierarchies", IEEE Symposium
//!   on Interactive Ray Tracing 2007; Lauterbach, Garland, Sengupta, Luebke and Manocha, "Fast BVH
//!   construction on GPUs", Computer Graphics Forum 28(2), 2009 (the curve); Goldsmith and Salmon,
//!   "Automatic creation of object hierarchies for ray tracing", IEEE Computer Graphics and Applications
//!   7(5), 1987 (the heuristic).
//! - Departs from it: one axis only is binned, a third of the work.

use super::{
    curve,
    nodes::{Node, WIDTH},
};
use crate::parallel;

/// The most items in a leaf.
const LEAF: usize = 2;
/// The bins items fall into.
const BINS: usize = 16;
/// So many items are halved.
const FEW: usize = 8;
/// Parts of more items are cut along the curve.
const CLUSTER: usize = 512;
/// From this depth on cuts go through the middle.
const DEEP: usize = 22;
/// The largest depth: each further level has a quarter of the items, of 2³² at most.
pub(super) const MAX_DEPTH: usize = DEEP + 18;
/// Parts of more items are built side by side.
const PARALLEL: usize = 1 << 13;

/// The box of an item; the fourth numbers are there for vector instructions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) lo: [f32; 4],
    pub(super) hi: [f32; 4],
    pub(super) id: u32,
}

/// A box that grows.
#[derive(Clone, Copy)]
struct Bounds {
    lo: [f32; 4],
    hi: [f32; 4],
}

impl Bounds {
    const EMPTY: Bounds = Bounds { lo: [f32::INFINITY; 4], hi: [f32::NEG_INFINITY; 4] };

    #[inline]
    fn grow(&mut self, lo: &[f32; 4], hi: &[f32; 4]) {
        for i in 0..4 {
            self.lo[i] = if lo[i] < self.lo[i] { lo[i] } else { self.lo[i] };
            self.hi[i] = if hi[i] > self.hi[i] { hi[i] } else { self.hi[i] };
        }
    }

    /// Half the area of the sides; zero for the empty box.
    #[inline]
    fn area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|i| (self.hi[i] - self.lo[i]).max(0.0));
        x * y + y * z + z * x
    }
}

/// Twice the center of an item.
#[inline]
fn center(item: &Item) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for (i, sum) in sum.iter_mut().enumerate() {
        *sum = item.lo[i] + item.hi[i];
    }
    sum
}

/// Items that belong together, and what is around them and their centers.
struct Group<'a> {
    items: &'a mut [Item],
    /// Where the first of them stands among all.
    start: usize,
    bounds: Bounds,
    centers: Bounds,
}

impl<'a> Group<'a> {
    fn new(items: &'a mut [Item], start: usize) -> Self {
        let (mut bounds, mut centers) = (Bounds::EMPTY, Bounds::EMPTY);
        for item in &*items {
            bounds.grow(&item.lo, &item.hi);
            let center = center(item);
            centers.grow(&center, &center);
        }
        Group { items, start, bounds, centers }
    }

    /// Both sides of the cheapest cut.
    fn cut(self, is_deep: bool) -> [Group<'a>; 2] {
        let extent = [0, 1, 2].map(|i| self.centers.hi[i] - self.centers.lo[i]);
        let axis = (0..3).fold(0, |best, i| if extent[i] > extent[best] { i } else { best });
        let factor = BINS as f32 / extent[axis];
        if is_deep || !factor.is_finite() {
            return self.halves();
        }
        if self.items.len() <= FEW {
            let place = |item: &Item| item.lo[axis] + item.hi[axis];
            self.items.sort_unstable_by(|a, b| place(a).total_cmp(&place(b)).then(a.id.cmp(&b.id)));
            return self.halves();
        }
        let origin = self.centers.lo[axis];
        let bin_of = |item: &Item| {
            (((item.lo[axis] + item.hi[axis] - origin) * factor) as usize).min(BINS - 1)
        };
        let mut boxes = [Bounds::EMPTY; BINS];
        let mut counts = [0_u32; BINS];
        for item in &*self.items {
            let bin = bin_of(item);
            boxes[bin].grow(&item.lo, &item.hi);
            counts[bin] += 1;
        }
        let cut = cheapest(&boxes, &counts);
        self.divide(|item| bin_of(item) < cut)
    }

    /// Sorts the items by side.
    fn divide(self, is_left: impl Fn(&Item) -> bool) -> [Group<'a>; 2] {
        let mut sides = [(Bounds::EMPTY, Bounds::EMPTY); 2];
        let mut add = |side: usize, item: &Item| {
            sides[side].0.grow(&item.lo, &item.hi);
            let center = center(item);
            sides[side].1.grow(&center, &center);
        };
        let (mut low, mut high) = (0, self.items.len());
        loop {
            while low < high && is_left(&self.items[low]) {
                add(0, &self.items[low]);
                low += 1;
            }
            while low < high && !is_left(&self.items[high - 1]) {
                add(1, &self.items[high - 1]);
                high -= 1;
            }
            if low == high {
                break;
            }
            self.items.swap(low, high - 1);
        }
        let start = self.start;
        let (left, right) = self.items.split_at_mut(low);
        if left.is_empty() || right.is_empty() {
            let items = if left.is_empty() { right } else { left };
            return Group { items, start, bounds: self.bounds, centers: self.centers }.halves();
        }
        let [(a, a_centers), (b, b_centers)] = sides;
        [
            Group { items: left, start, bounds: a, centers: a_centers },
            Group { items: right, start: start + low, bounds: b, centers: b_centers },
        ]
    }

    /// Both halves of the list as it stands.
    fn halves(self) -> [Group<'a>; 2] {
        let middle = self.items.len() / 2;
        let (left, right) = self.items.split_at_mut(middle);
        [Group::new(left, self.start), Group::new(right, self.start + middle)]
    }
}

/// The number of bins left of the cheapest cut.
fn cheapest(boxes: &[Bounds; BINS], counts: &[u32; BINS]) -> usize {
    let mut right_costs = [0.0; BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for i in (1..BINS).rev() {
        bounds.grow(&boxes[i].lo, &boxes[i].hi);
        count += counts[i];
        right_costs[i] = bounds.area() * count as f32;
    }
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    let mut best = (f32::INFINITY, 1);
    for i in 1..BINS {
        bounds.grow(&boxes[i - 1].lo, &boxes[i - 1].hi);
        count += counts[i - 1];
        let cost = bounds.area() * count as f32 + right_costs[i];
        if cost < best.0 {
            best = (cost, i);
        }
    }
    best.1
}

/// A part of the tree: nodes in one array that count from its start, or a node over other parts.
enum Part {
    Whole(Vec<Node>),
    Above(Box<Node>, Vec<(usize, Part)>),
}

impl Part {
    fn len(&self) -> usize {
        match self {
            Part::Whole(nodes) => nodes.len(),
            Part::Above(_, parts) => 1 + parts.iter().map(|(_, part)| part.len()).sum::<usize>(),
        }
    }

    /// Adds the nodes of this part to `all`.
    fn append(self, all: &mut Vec<Node>) {
        let base = all.len() as u32;
        match self {
            Part::Whole(nodes) => all.extend(nodes.into_iter().map(|mut node| {
                for i in 0..WIDTH {
                    let is_node = node.count[i] == 0 && node.has(i);
                    node.first[i] += if is_node { base } else { 0 };
                }
                node
            })),
            Part::Above(node, parts) => {
                all.push(*node);
                for (i, part) in parts {
                    all[base as usize].first[i] = all.len() as u32;
                    part.append(all);
                }
            }
        }
    }
}

/// The nodes over `items`, which it brings into the order of the leaves. No items, no nodes.
pub(super) fn build(items: &mut Vec<Item>) -> Vec<Node> {
    if items.is_empty() {
        return Vec::new();
    }
    let key = |i: usize| {
        let [x, y, z, _] = center(&items[i]).map(|x| 0.5 * f64::from(x));
        curve::key([x, y, z])
    };
    let keys = curve::sorted(items.len(), key);
    let sorted = |i: crate::VertexId| items[keys[i.index()].1 as usize];
    *items = parallel::map(items.len(), sorted).into_values();
    let (_, part) = build_part(Run { items, keys: &keys, start: 0 }, 0);
    let mut nodes = Vec::with_capacity(part.len());
    part.append(&mut nodes);
    nodes
}

/// Items in order of their keys.
struct Run<'a> {
    items: &'a mut [Item],
    keys: &'a [(u32, u32)],
    /// Where the first of them stands among all.
    start: usize,
}

impl<'a> Run<'a> {
    /// Both sides of the change of the highest bit, or all of it if it is small or has no such change.
    fn cut(self) -> (Run<'a>, Option<Run<'a>>) {
        let Run { items, keys, start } = self;
        let (Some(first), Some(last)) = (keys.first(), keys.last()) else {
            return (Run { items, keys, start }, None);
        };
        if items.len() <= CLUSTER || first.0 == last.0 {
            return (Run { items, keys, start }, None);
        }
        let bit = (first.0 ^ last.0).ilog2();
        let middle = keys.partition_point(|key| key.0 >> bit & 1 == 0);
        let (left, right) = items.split_at_mut(middle);
        let (left_keys, right_keys) = keys.split_at(middle);
        let right = Run { items: right, keys: right_keys, start: start + middle };
        (Run { items: left, keys: left_keys, start }, Some(right))
    }

    /// Two to four runs, or one that is not to be cut along the curve.
    fn quarters(self) -> Vec<Run<'a>> {
        let (left, right) = self.cut();
        let Some(right) = right else { return vec![left] };
        let halves = [left.cut(), right.cut()];
        halves.into_iter().flat_map(|(a, b)| std::iter::once(a).chain(b)).collect()
    }
}

/// The nodes over `run`, and the box around it.
fn build_part(run: Run<'_>, depth: usize) -> (Bounds, Part) {
    let is_small = run.items.len() <= PARALLEL;
    let mut runs = if is_small { vec![run] } else { run.quarters() };
    if runs.len() == 1 {
        let mut nodes = Vec::new();
        let mut bounds = Bounds::EMPTY;
        if let Some(run) = runs.pop() {
            nodes.reserve(run.items.len() / 2 + 1);
            bounds = build_run(run, depth, &mut nodes);
        }
        return (bounds, Part::Whole(nodes));
    }
    let parts = build_parts(runs, depth + 1);
    let mut node = Node::EMPTY;
    let mut all = Bounds::EMPTY;
    for (i, (bounds, _)) in parts.iter().enumerate() {
        set_box(&mut node, i, bounds);
        all.grow(&bounds.lo, &bounds.hi);
    }
    let parts = parts.into_iter().map(|(_, part)| part).enumerate().collect();
    (all, Part::Above(Box::new(node), parts))
}

/// The parts over `runs`, side by side.
fn build_parts(mut runs: Vec<Run<'_>>, depth: usize) -> Vec<(Bounds, Part)> {
    if runs.len() <= 1 {
        return runs.into_iter().map(|run| build_part(run, depth)).collect();
    }
    let others = runs.split_off(runs.len() / 2);
    let (mut parts, right) =
        parallel::join(|| build_parts(runs, depth), || build_parts(others, depth));
    parts.extend(right);
    parts
}

/// Adds the node over `run` and all below it; returns the box around it.
fn build_run(run: Run<'_>, depth: usize, nodes: &mut Vec<Node>) -> Bounds {
    let mut runs = run.quarters();
    if runs.len() == 1 {
        let Some(run) = runs.pop() else { return Bounds::EMPTY };
        let group = Group::new(run.items, run.start);
        let bounds = group.bounds;
        build_nodes(group, depth, nodes);
        return bounds;
    }
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    let mut all = Bounds::EMPTY;
    for (i, run) in runs.into_iter().enumerate() {
        nodes[index].first[i] = nodes.len() as u32;
        let bounds = build_run(run, depth + 1, nodes);
        set_box(&mut nodes[index], i, &bounds);
        all.grow(&bounds.lo, &bounds.hi);
    }
    all
}

/// Adds the node over `group` and all below it.
fn build_nodes(group: Group<'_>, depth: usize, nodes: &mut Vec<Node>) {
    let is_deep = depth >= DEEP;
    let mut groups = [const { None }; WIDTH];
    groups[0] = Some(group);
    // The group of largest area is cut next; far down, the one of most items.
    for next in 1..WIDTH {
        let mut largest = (-1.0, 0);
        for (i, group) in groups.iter().enumerate() {
            let Some(group) = group.as_ref().filter(|group| group.items.len() > LEAF) else {
                continue;
            };
            let size = if is_deep { group.items.len() as f32 } else { group.bounds.area() };
            if size > largest.0 {
                largest = (size, i);
            }
        }
        let Some(group) = groups[largest.1].take_if(|_| largest.0 >= 0.0) else { break };
        let [left, right] = group.cut(is_deep);
        groups[largest.1] = Some(left);
        groups[next] = Some(right);
    }
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    for (i, group) in groups.into_iter().enumerate() {
        let Some(group) = group else { break };
        set_box(&mut nodes[index], i, &group.bounds);
        if group.items.len() <= LEAF {
            nodes[index].first[i] = group.start as u32;
            nodes[index].count[i] = group.items.len() as u32;
        } else {
            nodes[index].first[i] = nodes.len() as u32;
            build_nodes(group, depth + 1, nodes);
        }
    }
}

fn set_box(node: &mut Node, i: usize, bounds: &Bounds) {
    for axis in 0..3 {
        node.lo[axis][i] = bounds.lo[axis];
        node.hi[axis][i] = bounds.hi[axis];
    }
}
