//! Cuts of a small graph into two sides by vertices, and moves that make them smaller.
//!
//! A vertex of the cut moves to one side, and its neighbors on the other side come into the cut, which
//! becomes cheaper by the cost of the vertex less that of these neighbors. The best move is made
//! again and again, also where it makes the cut dearer, no vertex twice; then all moves after the
//! cheapest state are undone.
//!
//! - Input: a graph with costs of its vertices, and sides for them that no edge joins.
//! - Cost: O(m log n) for each pass over the moves.
//! - Reference: Fiduccia and Mattheyses, "A linear-time heuristic for improving network partitions",
//!   1982; Ashcraft and Liu, "A partition improvement algorithm for generalized nested dissection",
//!   1994.

use std::collections::BinaryHeap;

/// The mark of a vertex of the cut; 0 and 1 are the sides.
pub(super) const CUT: u8 = 2;

/// No side may have more than this part of the weight: the bound that METIS uses.
const HEAVIEST: f64 = 0.6;

/// How many moves without a better state are made at least.
const PATIENCE: usize = 20;

/// The cost of a vertex of weight 1, large enough to tell roots of small weights apart.
const COST: f64 = 64.0;

/// What it costs to draw a fixed vertex into the cut: more than there is.
const FORBIDDEN: i64 = 1 << 40;

/// A small graph with weights, or a part of a larger one.
#[derive(Debug, Default)]
pub(super) struct Local {
    pub(super) starts: Vec<u32>,
    pub(super) neighbors: Vec<u32>,
    pub(super) weights: Vec<u32>,
    /// Weights of edges in the place of the neighbor; empty where they do not matter.
    pub(super) edge_weights: Vec<u32>,
    /// Vertices from here on stay on their side. They list no neighbors.
    pub(super) free: usize,
}

impl Local {
    pub(super) fn neighbors(&self, v: usize) -> &[u32] {
        &self.neighbors[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// What it costs to have `v` in the cut. A vertex that stands for w vertices of a surface is some √w
    /// of them wide, and that many a finer cut will take.
    pub(super) fn cost(&self, v: usize) -> i64 {
        (COST * f64::from(self.weights[v]).sqrt()) as i64
    }

    /// The weight of `v`, to calculate with.
    pub(super) fn weighs(&self, v: usize) -> i64 {
        i64::from(self.weights[v])
    }
}

/// Where each vertex is, and what the sides and the cut weigh.
#[derive(Clone, Debug, Default)]
pub(super) struct Cut {
    pub(super) side: Vec<u8>,
    pub(super) weight: [i64; 3],
    /// The cost of all vertices of the cut.
    pub(super) expense: i64,
}

impl Cut {
    /// The cut with these marks.
    pub(super) fn new(graph: &Local, side: Vec<u8>) -> Cut {
        let mut weight = [0; 3];
        for (v, &side) in side.iter().enumerate() {
            weight[usize::from(side)] += graph.weighs(v);
        }
        let mut cut = Cut { side, weight, expense: 0 };
        cut.expense = cut.expense_of(graph);
        cut
    }

    /// The cost of all vertices of the cut, added up.
    pub(super) fn expense_of(&self, graph: &Local) -> i64 {
        (0..self.side.len()).filter(|&v| self.side[v] == CUT).map(|v| graph.cost(v)).sum()
    }

    /// Smaller is better: the cost of the cut, raised by the part of the weight by which the sides differ,
    /// since what is cheap here is dear further down if the sides are unequal.
    pub(super) fn quality(&self) -> (i64, i64) {
        let imbalance = (self.weight[0] - self.weight[1]).abs();
        let total = self.weight.iter().sum::<i64>().max(1);
        (self.expense + self.expense * imbalance / total, imbalance)
    }

    fn set(&mut self, graph: &Local, v: usize, new: u8) -> u8 {
        let old = std::mem::replace(&mut self.side[v], new);
        self.weight[usize::from(old)] -= graph.weighs(v);
        self.weight[usize::from(new)] += graph.weighs(v);
        self.expense += graph.cost(v) * (i64::from(new == CUT) - i64::from(old == CUT));
        old
    }

    fn limit(&self) -> i64 {
        (HEAVIEST * self.weight.iter().sum::<i64>() as f64) as i64
    }
}

/// Memory of [`Improver::improve`], to be used again.
#[derive(Debug, Default)]
pub(super) struct Improver {
    /// What would come into the cut if a vertex of it moved to either side.
    pulled: Vec<[i64; 2]>,
    moved: Vec<bool>,
    /// Vertices by what moving them to either side gains; entries may be out of date.
    heaps: [BinaryHeap<(i64, u32)>; 2],
    /// Vertices whose mark changed, with the mark before.
    log: Vec<(u32, u8)>,
}

impl Improver {
    /// Makes the cut lighter, in at most so many passes.
    pub(super) fn improve(&mut self, graph: &Local, cut: &mut Cut, passes: usize) {
        for _ in 0..passes {
            if !self.pass(graph, cut) {
                break;
            }
        }
    }

    fn pass(&mut self, graph: &Local, cut: &mut Cut) -> bool {
        let before = cut.quality();
        let limit = cut.limit();
        self.pulled.clear();
        self.pulled.resize(graph.weights.len(), [0; 2]);
        self.moved.clear();
        self.moved.resize(graph.weights.len(), false);
        self.log.clear();
        self.heaps.iter_mut().for_each(BinaryHeap::clear);
        let mut count = 0;
        for v in 0..graph.free {
            if cut.side[v] == CUT {
                count += 1;
                self.enter(graph, cut, v);
            }
        }
        // How long to go on without a better state.
        let patience = PATIENCE + count / 4;
        let (mut best, mut best_length, mut worse) = (before, 0, 0);
        while worse <= patience {
            let Some((v, side)) = self.choose(graph, cut, limit) else { break };
            self.apply(graph, cut, v, side);
            let cost = cut.quality();
            if cost < best {
                (best, best_length, worse) = (cost, self.log.len(), 0);
            } else {
                worse += 1;
            }
        }
        while self.log.len() > best_length {
            if let Some((v, old)) = self.log.pop() {
                cut.set(graph, v as usize, old);
            }
        }
        best < before
    }

    /// Notes what would come into the cut if `v` left it.
    fn enter(&mut self, graph: &Local, cut: &Cut, v: usize) {
        let mut pulled = [0; 2];
        for &w in graph.neighbors(v) {
            let w = w as usize;
            if cut.side[w] != CUT {
                let cost = if w < graph.free { graph.cost(w) } else { FORBIDDEN };
                pulled[1 - usize::from(cut.side[w])] += cost;
            }
        }
        self.pulled[v] = pulled;
        self.offer(graph, v, 0);
        self.offer(graph, v, 1);
    }

    fn offer(&mut self, graph: &Local, v: usize, side: usize) {
        if !self.moved[v] && self.pulled[v][side] < FORBIDDEN {
            let gain = graph.cost(v) - self.pulled[v][side];
            self.heaps[side].push((gain, u32::MAX - v as u32));
        }
    }

    /// The best move that keeps the balance.
    fn choose(&mut self, graph: &Local, cut: &Cut, limit: i64) -> Option<(usize, usize)> {
        loop {
            let tops = [self.top(graph, cut, 0), self.top(graph, cut, 1)];
            let side = match tops {
                [None, None] => return None,
                [Some(_), None] => 0,
                [None, Some(_)] => 1,
                [Some((zero, _)), Some((one, _))] if zero != one => usize::from(one > zero),
                _ => usize::from(cut.weight[1] < cut.weight[0]),
            };
            let fits = |side: usize, v: usize| {
                let weight = cut.weight[side] + graph.weighs(v);
                weight <= limit || cut.weight[side] < cut.weight[1 - side]
            };
            for side in [side, 1 - side] {
                if let Some((_, v)) = tops[side] {
                    if fits(side, v) {
                        return Some((v, side));
                    }
                    self.heaps[side].pop();
                }
            }
        }
    }

    /// Gain and vertex of the best move to `side`, once what is out of date is gone.
    fn top(&mut self, graph: &Local, cut: &Cut, side: usize) -> Option<(i64, usize)> {
        while let Some(&(gain, reversed)) = self.heaps[side].peek() {
            let v = (u32::MAX - reversed) as usize;
            let current = graph.cost(v) - self.pulled[v][side];
            if cut.side[v] == CUT && !self.moved[v] && gain == current {
                return Some((gain, v));
            }
            self.heaps[side].pop();
        }
        None
    }

    fn apply(&mut self, graph: &Local, cut: &mut Cut, v: usize, side: usize) {
        let other = 1 - side;
        self.moved[v] = true;
        self.mark(graph, cut, v, side as u8);
        for &w in graph.neighbors(v) {
            let w = w as usize;
            if cut.side[w] == CUT {
                // Moving w to the other side would now draw v back.
                self.pulled[w][other] += graph.cost(v);
                self.offer(graph, w, other);
            } else if usize::from(cut.side[w]) == other {
                self.mark(graph, cut, w, CUT);
                for &x in graph.neighbors(w) {
                    let x = x as usize;
                    if cut.side[x] == CUT && x != w {
                        self.pulled[x][side] -= graph.cost(w);
                        self.offer(graph, x, side);
                    }
                }
                self.enter(graph, cut, w);
            }
        }
    }

    fn mark(&mut self, graph: &Local, cut: &mut Cut, v: usize, new: u8) {
        let old = cut.set(graph, v, new);
        self.log.push((v as u32, old));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of `width` × `height` vertices of weight 1.
    pub(super) fn grid(width: usize, height: usize) -> Local {
        let mut local = Local { starts: vec![0], free: width * height, ..Local::default() };
        for v in 0..width * height {
            let (x, y) = (v % width, v / width);
            let mut add = |there: bool, w: usize| {
                if there {
                    local.neighbors.push(w as u32);
                }
            };
            add(y > 0, v.wrapping_sub(width));
            add(x > 0, v.wrapping_sub(1));
            add(x + 1 < width, v + 1);
            add(y + 1 < height, v + width);
            local.starts.push(local.neighbors.len() as u32);
            local.weights.push(1);
        }
        local
    }

    fn is_sound(graph: &Local, cut: &Cut) -> bool {
        let apart = |v: usize, w: usize| cut.side[v] + cut.side[w] != 1;
        (0..graph.free).all(|v| graph.neighbors(v).iter().all(|&w| apart(v, w as usize)))
            && cut.weight == Cut::new(graph, cut.side.clone()).weight
            && cut.expense == cut.expense_of(graph)
    }

    #[test]
    fn a_thick_ragged_cut_becomes_a_straight_one() {
        let graph = grid(21, 9);
        let side = |v: usize| match (v % 21, v / 21) {
            (x, y) if x < 8 + y % 3 => 0,
            (x, y) if x > 11 + y % 2 => 1,
            _ => CUT,
        };
        let mut cut = Cut::new(&graph, (0..graph.weights.len()).map(side).collect());
        Improver::default().improve(&graph, &mut cut, 10);
        assert!(is_sound(&graph, &cut));
        assert_eq!(cut.weight[2], 9, "{:?}", cut.weight);
    }

    #[test]
    fn what_is_fixed_never_comes_into_the_cut() {
        // A path whose cut could move either way, but for the fixed ends.
        let mut graph = grid(5, 1);
        graph.free = 5;
        let order = [2, 1, 3, 0, 4_usize];
        let place = |v: u32| order.iter().position(|&w| w == v as usize).unwrap() as u32;
        let mut path = Local { starts: vec![0], free: 3, ..Local::default() };
        for v in order {
            if path.weights.len() < 3 {
                path.neighbors.extend(graph.neighbors(v).iter().map(|&w| place(w)));
            }
            path.starts.push(path.neighbors.len() as u32);
            path.weights.push([10, 1, 2, 1, 10][v]);
        }
        let mut cut = Cut::new(&path, vec![CUT, 0, 1, 0, 1]);
        Improver::default().improve(&path, &mut cut, 10);
        assert_eq!(cut.weight[2], 1);
        assert!(cut.side[3] != CUT && cut.side[4] != CUT);
    }
}
