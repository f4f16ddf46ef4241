//! Halves of a small graph, and moves that leave fewer edges between them.
//!
//! Clusters are too coarse to tell how many vertices of the finest graph a cut through them will take; the
//! weights of the edges between two clusters count what is there. So the first halves of a block are
//! compared by edges, and only what is best becomes a cut by vertices.
//!
//! - Input: a graph of some hundred vertices with weights, and halves of it.
//! - Cost: O(E log E) for each pass of moves.
//! - Reference: Fiduccia and Mattheyses, "A linear-time heuristic for improving network partitions",
//!   1982.

use std::collections::BinaryHeap;

use super::{coarsen::Weighted, separator::Local};

/// No half may have more than this part of the weight.
const HEAVIEST: f64 = 0.58;

/// How many moves without a better state are made at least.
const PATIENCE: usize = 30;

/// Memory of [`HalfImprover::improve`], to be used again.
#[derive(Debug, Default)]
pub(super) struct HalfImprover {
    /// By how much the edges between the halves become lighter if a vertex changes sides.
    gains: Vec<i64>,
    moved: Vec<bool>,
    /// Vertices of each half by gain; entries may be out of date.
    heaps: [BinaryHeap<(i64, u32)>; 2],
    log: Vec<u32>,
}

/// The weight of the edges between the halves, and of the halves.
#[derive(Clone, Copy, Debug)]
struct State {
    edges: i64,
    weight: [i64; 2],
}

impl State {
    /// Smaller is better: edges, raised by the part of the weight by which the halves differ.
    fn quality(&self) -> i64 {
        let imbalance = (self.weight[0] - self.weight[1]).abs();
        let total = (self.weight[0] + self.weight[1]).max(1);
        self.edges + self.edges * imbalance / total
    }
}

impl HalfImprover {
    /// Moves vertices so that fewer edges join the halves, in at most so many passes. Returns how bad the
    /// halves are then.
    pub(super) fn improve(&mut self, graph: &Local, side: &mut [u8], passes: usize) -> i64 {
        let mut state = State { edges: 0, weight: [0; 2] };
        for v in 0..graph.len() {
            state.weight[usize::from(side[v])] += graph.weighs(v);
            for (w, bond) in graph.edges(v) {
                if side[w as usize] != side[v] {
                    state.edges += i64::from(bond);
                }
            }
        }
        state.edges /= 2;
        for _ in 0..passes {
            if !self.pass(graph, side, &mut state) {
                break;
            }
        }
        state.quality()
    }

    fn pass(&mut self, graph: &Local, side: &mut [u8], state: &mut State) -> bool {
        let n = graph.len();
        self.gains.clear();
        self.moved.clear();
        self.moved.resize(n, false);
        self.log.clear();
        self.heaps.iter_mut().for_each(BinaryHeap::clear);
        for v in 0..n {
            let (mut inside, mut outside) = (0, 0);
            for (w, bond) in graph.edges(v) {
                if side[w as usize] == side[v] {
                    inside += i64::from(bond);
                } else {
                    outside += i64::from(bond);
                }
            }
            self.gains.push(outside - inside);
            if outside > 0 {
                self.heaps[usize::from(side[v])].push((outside - inside, u32::MAX - v as u32));
            }
        }
        let total = state.weight[0] + state.weight[1];
        let limit = (HEAVIEST * total as f64) as i64;
        let before = state.quality();
        let (mut best, mut best_state, mut best_length, mut worse) = (before, *state, 0, 0);
        while worse <= PATIENCE + n / 10 {
            let Some(v) = self.choose(graph, side, state, limit) else { break };
            let from = usize::from(side[v]);
            self.moved[v] = true;
            state.edges -= self.gains[v];
            state.weight[from] -= graph.weighs(v);
            state.weight[1 - from] += graph.weighs(v);
            side[v] = 1 - side[v];
            self.log.push(v as u32);
            for (w, bond) in graph.edges(v) {
                let w = w as usize;
                let change = 2 * i64::from(bond);
                self.gains[w] += if side[w] == side[v] { -change } else { change };
                if !self.moved[w] {
                    self.heaps[usize::from(side[w])].push((self.gains[w], u32::MAX - w as u32));
                }
            }
            let quality = state.quality();
            if quality < best {
                (best, best_state, best_length, worse) = (quality, *state, self.log.len(), 0);
            } else {
                worse += 1;
            }
        }
        while self.log.len() > best_length {
            if let Some(v) = self.log.pop() {
                side[v as usize] = 1 - side[v as usize];
            }
        }
        *state = best_state;
        best < before
    }

    /// The best move that keeps the balance.
    fn choose(&mut self, graph: &Local, side: &[u8], state: &State, limit: i64) -> Option<usize> {
        loop {
            let tops = [self.top(side, 0), self.top(side, 1)];
            let from = match tops {
                [None, None] => return None,
                [Some(_), None] => 0,
                [None, Some(_)] => 1,
                [Some((zero, _)), Some((one, _))] if zero != one => usize::from(one > zero),
                _ => usize::from(state.weight[1] > state.weight[0]),
            };
            for from in [from, 1 - from] {
                if let Some((_, v)) = tops[from] {
                    let to = 1 - from;
                    if state.weight[to] + graph.weighs(v) <= limit
                        || state.weight[to] < state.weight[from]
                    {
                        return Some(v);
                    }
                    self.heaps[from].pop();
                }
            }
        }
    }

    /// Gain and vertex of the best move out of a half, once what is out of date is gone.
    fn top(&mut self, side: &[u8], from: usize) -> Option<(i64, usize)> {
        while let Some(&(gain, reversed)) = self.heaps[from].peek() {
            let v = (u32::MAX - reversed) as usize;
            if usize::from(side[v]) == from && !self.moved[v] && gain == self.gains[v] {
                return Some((gain, v));
            }
            self.heaps[from].pop();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of `width` × `height` vertices of weight 1.
    fn grid(width: usize, height: usize) -> Local {
        let mut local = Local { starts: vec![0], free: width * height, ..Local::default() };
        for v in 0..width * height {
            let (x, y) = (v % width, v / width);
            let steps = [(x > 0, -1), (x + 1 < width, 1), (y > 0, -(width as isize))];
            let last = (y + 1 < height, width as isize);
            for (_, step) in steps.into_iter().chain([last]).filter(|&(there, _)| there) {
                local.neighbors.push(v.wrapping_add_signed(step) as u32);
            }
            local.starts.push(local.neighbors.len() as u32);
            local.weights.push(1);
        }
        local
    }

    #[test]
    fn ragged_halves_become_straight() {
        let graph = grid(20, 8);
        let mut side: Vec<u8> =
            (0..160).map(|v| u8::from(v % 20 + 3 * (v / 20 % 2) > 10)).collect();
        let quality = HalfImprover::default().improve(&graph, &mut side, 10);
        assert_eq!(quality, 8, "edges between equal halves");
        assert_eq!(side.iter().map(|&side| u32::from(side)).sum::<u32>(), 80);
    }

    #[test]
    fn heavy_edges_are_not_cut() {
        // A path of sixteen whose middle edge is heavy: one beside it is cut, though halves are unequal.
        let mut graph = grid(16, 1);
        graph.edge_weights = vec![1; graph.neighbors.len()];
        for v in [7, 8] {
            for place in graph.starts[v] as usize..graph.starts[v + 1] as usize {
                if graph.neighbors[place] as usize + v == 15 {
                    graph.edge_weights[place] = 9;
                }
            }
        }
        let mut side: Vec<u8> = (0..16).map(|v| u8::from(v > 7)).collect();
        HalfImprover::default().improve(&graph, &mut side, 10);
        assert_eq!(side[7], side[8]);
        assert_ne!(side[0], side[15]);
    }
}
