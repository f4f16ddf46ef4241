//! Clusters of vertices, and how they get better.

use std::collections::VecDeque;

use dgp_mesh::{DVec3, Progress, VertexId, graph::VertexAdjacency};

use super::refine::Fine;
use crate::Error;

/// The part of E that a move must gain at least of what its vertex costs: less is rounding.
const LEAST_GAIN: f64 = 1e-9;

/// Vertices without area count for this part of the mean, so that each cluster has a mean.
const LEAST_MASS: f64 = 1e-6;

/// The label of what has changed its cluster already.
const TAKEN: u32 = u32::MAX - 1;

/// The clusters of the vertices of a mesh.
pub(super) struct Clusters<'a> {
    pub(super) fine: &'a Fine,
    rings: VertexAdjacency,
    is_border: Vec<bool>,
    mass: Vec<f64>,
    /// The cluster of each vertex; `u32::MAX` on no face.
    pub(super) labels: Vec<u32>,
    /// Σ m x, Σ m and number of vertices of each cluster.
    sums: Vec<DVec3>,
    weights: Vec<f64>,
    pub(super) sizes: Vec<u32>,
}

impl<'a> Clusters<'a> {
    pub(super) fn new(fine: &'a Fine, labels: &[u32]) -> Self {
        let mesh = &fine.mesh;
        let mass: Vec<f64> =
            fine.areas.iter().zip(&fine.density).map(|(area, density)| area * density).collect();
        let least = LEAST_MASS * mass.iter().sum::<f64>() / mass.len() as f64;
        let mut clusters = Clusters {
            fine,
            rings: mesh.vertex_adjacency(),
            is_border: mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect(),
            mass: mass.into_iter().map(|m| m.max(least)).collect(),
            labels: labels.to_vec(),
            sums: Vec::new(),
            weights: Vec::new(),
            sizes: Vec::new(),
        };
        clusters.sum_up();
        clusters
    }

    pub(super) fn len(&self) -> usize {
        self.sizes.len()
    }

    pub(super) fn is_border(&self, v: VertexId) -> bool {
        self.is_border[v.index()]
    }

    pub(super) fn label(&self, v: VertexId) -> u32 {
        self.labels[v.index()]
    }

    /// The mean of a cluster.
    pub(super) fn mean(&self, cluster: u32) -> DVec3 {
        self.sums[cluster as usize] / self.weights[cluster as usize]
    }

    /// E, and its part of each cluster over the weight.
    pub(super) fn energy(&self) -> f64 {
        self.spreads().iter().zip(&self.weights).map(|(spread, weight)| spread * weight).sum()
    }

    /// The mean squared distance from the mean of each cluster.
    pub(super) fn spreads(&self) -> Vec<f64> {
        let mut spreads = vec![0.0; self.len()];
        for v in self.vertices() {
            let cluster = self.label(v);
            let square = self.position(v).distance_squared(self.mean(cluster));
            spreads[cluster as usize] += self.mass[v.index()] * square;
        }
        spreads.iter().zip(&self.weights).map(|(sum, weight)| sum / weight).collect()
    }

    /// Moves vertices between clusters until E gets no less; returns how many.
    pub(super) fn improve(&mut self, progress: Progress<'_>) -> Result<usize, Error> {
        /// Vertices looked at between two reports.
        const STEP: usize = 1 << 16;
        self.sum_up();
        let mut waiting: VecDeque<VertexId> = self
            .vertices()
            .filter(|&v| self.rings.neighbors(v).iter().any(|&w| self.label(w) != self.label(v)))
            .collect();
        let mut is_waiting = vec![false; self.labels.len()];
        for v in &waiting {
            is_waiting[v.index()] = true;
        }
        let (mut looks, mut moves) = (0_usize, 0);
        let mut around = Vec::new();
        while let Some(v) = waiting.pop_front() {
            if looks.is_multiple_of(STEP) {
                // Most moves are made at first.
                progress.report(1.0 - 1.0 / (1.0 + looks as f64 / self.labels.len() as f64))?;
            }
            looks += 1;
            is_waiting[v.index()] = false;
            let Some(to) = self.best_move(v, &mut around) else { continue };
            self.relabel(v, to);
            moves += 1;
            for &w in self.rings.neighbors(v).iter().chain([&v]) {
                if !std::mem::replace(&mut is_waiting[w.index()], true) {
                    waiting.push_back(w);
                }
            }
        }
        Ok(moves)
    }

    /// Cuts clusters in two between vertices that are far apart.
    pub(super) fn halve(&mut self, flawed: &[u32]) {
        let mut members: Vec<Vec<VertexId>> = vec![Vec::new(); flawed.len()];
        for v in self.vertices() {
            if let Ok(k) = flawed.binary_search(&self.label(v)) {
                members[k].push(v);
            }
        }
        for (&cluster, members) in flawed.iter().zip(&members) {
            let farthest = |from: DVec3| {
                let distance = |v: VertexId| self.position(v).distance_squared(from);
                members
                    .iter()
                    .copied()
                    .max_by(|&v, &w| distance(v).total_cmp(&distance(w)).then(w.cmp(&v)))
            };
            let Some(first) = farthest(self.mean(cluster)) else { continue };
            let others = || members.iter().copied().filter(|&v| v != first);
            let from = self.position(first);
            let distance = |v: VertexId| self.position(v).distance_squared(from);
            let second =
                others().max_by(|&v, &w| distance(v).total_cmp(&distance(w)).then(w.cmp(&v)));
            let Some(second) = second else { continue };
            self.divide(cluster, [first, second]);
        }
        self.sum_up();
    }

    /// Gives a cluster and a new one what is fewer edges from the first and from the second vertex.
    fn divide(&mut self, cluster: u32, ends: [VertexId; 2]) {
        let new = self.sizes.len() as u32;
        self.sizes.push(0);
        self.sums.push(DVec3::ZERO);
        self.weights.push(0.0);
        let mut reached = vec![ends[0], ends[1]];
        let mut sides: Vec<u32> = vec![cluster, new];
        for end in ends {
            self.labels[end.index()] = TAKEN;
        }
        let mut next = 0;
        while next < reached.len() {
            let (v, side) = (reached[next], sides[next]);
            next += 1;
            for &w in self.rings.neighbors(v) {
                if self.labels[w.index()] == cluster {
                    self.labels[w.index()] = TAKEN;
                    reached.push(w);
                    sides.push(side);
                }
            }
        }
        for (v, side) in reached.into_iter().zip(sides) {
            self.labels[v.index()] = side;
        }
    }

    /// The vertices on faces.
    fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.fine.mesh.vertices().filter(|&v| self.label(v) != u32::MAX)
    }

    fn position(&self, v: VertexId) -> DVec3 {
        self.fine.mesh.position(v)
    }

    fn sum_up(&mut self) {
        let count = self.vertices().map(|v| self.label(v) as usize + 1).max().unwrap_or(0);
        self.sums = vec![DVec3::ZERO; count];
        self.weights = vec![0.0; count];
        self.sizes = vec![0; count];
        for v in
            (0..self.labels.len()).map(VertexId::new).filter(|v| self.labels[v.index()] != u32::MAX)
        {
            let (cluster, m) = (self.label(v) as usize, self.mass[v.index()]);
            self.sums[cluster] += m * self.fine.mesh.position(v);
            self.weights[cluster] += m;
            self.sizes[cluster] += 1;
        }
    }

    fn relabel(&mut self, v: VertexId, to: u32) {
        let (from, to) = (self.label(v) as usize, to as usize);
        let m = self.mass[v.index()];
        let moment = m * self.position(v);
        self.sums[from] -= moment;
        self.weights[from] -= m;
        self.sizes[from] -= 1;
        self.sums[to] += moment;
        self.weights[to] += m;
        self.sizes[to] += 1;
        self.labels[v.index()] = to as u32;
    }

    /// The cluster around `v` in which it costs least, if that is less than in its own and both stay what they
    /// are: what they have of the ring is one piece, and one of two neighbors on a boundary.
    fn best_move(&self, v: VertexId, around: &mut Vec<Around>) -> Option<u32> {
        let own = self.label(v);
        let (m, p) = (self.mass[v.index()], self.position(v));
        if self.sizes[own as usize] == 1 || !(self.weights[own as usize] > m) {
            return None;
        }
        self.look_around(v, around);
        let mine = around.iter().find(|other| other.label == own)?;
        if mine.pieces != 1 || (self.is_border(v) && mine.border > 1) || around.len() == 1 {
            return None;
        }
        let weight = self.weights[own as usize];
        let cost = p.distance_squared(self.mean(own)) * weight / (weight - m);
        let mut best = (cost * (1.0 - LEAST_GAIN), None);
        for other in around.iter().filter(|other| other.label != own) {
            if other.pieces != 1 || (self.is_border(v) && other.border != 1) {
                continue;
            }
            let weight = self.weights[other.label as usize];
            let cost = p.distance_squared(self.mean(other.label)) * weight / (weight + m);
            if cost < best.0 {
                best = (cost, Some(other.label));
            }
        }
        best.1
    }

    /// The clusters in the ring of `v`.
    fn look_around(&self, v: VertexId, around: &mut Vec<Around>) {
        around.clear();
        let ring = self.rings.neighbors(v);
        let is_border = self.is_border(v);
        let last = ring.len() - 1;
        for (i, &w) in ring.iter().enumerate() {
            let label = self.label(w);
            let before = match i {
                0 if is_border => None,
                0 => Some(self.label(ring[last])),
                _ => Some(self.label(ring[i - 1])),
            };
            let starts = u32::from(before != Some(label));
            let border = u32::from(is_border && (i == 0 || i == last));
            match around.iter_mut().find(|known| known.label == label) {
                Some(known) => {
                    known.pieces += starts;
                    known.border += border;
                }
                None => around.push(Around { label, pieces: starts, border }),
            }
        }
    }
}

/// What a cluster has of the ring of a vertex.
struct Around {
    label: u32,
    /// Pieces without a gap.
    pieces: u32,
    /// Neighbors along the boundary.
    border: u32,
}
