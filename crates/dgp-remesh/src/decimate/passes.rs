//! The order of [`Order::Passes`]: many cheap collapses at a time.
//!
//! Each pass ranks all edges with all threads, takes the cheapest part of them, and collapses those whose ends no
//! other collapse of the pass has touched. What is left when passes get stuck goes by the queue.
//!
//! - Input: triangles with the planes around each vertex.
//! - Cost: O(n): a pass collapses a part of what is left.
//! - Guarantees: those of the other order; the same bits for any number of threads.
//! - Reference: none; meshoptimizer's `simplify` goes in such passes too.
//!
//! [`Order::Passes`]: crate::Order::Passes

use dgp_mesh::{Cancelled, Progress, parallel};

use super::{edge::Candidate, report::Target, rings::NONE, state::State};

/// One in so many of the ranked edges is collapsed in a pass at most: fewer are closer to the best order, and slower.
const PART: usize = 3;

/// A pass that collapses less than one in so many of those it tries is stuck.
const STUCK: usize = 16;

/// A vertex, the one it is ranked with, and the collapse of their edge.
type Waiting = (u32, u32, Candidate);

impl State {
    /// Collapses in passes until the target is reached or nothing is left.
    pub(super) fn run_passes(&mut self, progress: Progress<'_>) -> Result<(), Cancelled> {
        let mut met = vec![0_u32; self.parent.len()];
        let mut left: Vec<u32> = (0..self.parent.len() as u32).collect();
        for pass in 1.. {
            let now = [self.rings.vertex_count, self.rings.face_count];
            progress.report(self.target.progress(self.start, now))?;
            left.retain(|&v| self.parent[v as usize] == v);
            self.refresh_all(&left);
            let mut waiting = self.rank_all(&left);
            let limit = (waiting.len() / PART + 1).min(self.wanted().saturating_mul(3) / 2 + 1);
            let order = |x: &Waiting, y: &Waiting| x.2.key.total_cmp(&y.2.key).then(x.0.cmp(&y.0));
            if limit < waiting.len() {
                waiting.select_nth_unstable_by(limit, order);
                waiting.truncate(limit);
            }
            waiting.sort_unstable_by(order);
            let before = self.collapses;
            for (v, w, found) in &waiting {
                let (v, w) = (*v, *w);
                if met[v as usize] == pass || met[w as usize] == pass {
                    continue;
                }
                let Some(shared) = self.check(v, w, found) else { continue };
                let (_, to) = self.collapse(v, w, &shared, found);
                met[v as usize] = pass;
                met[w as usize] = pass;
                self.mark_stale(to);
                if self.target.is_reached(self.rings.vertex_count, self.rings.face_count) {
                    return Ok(());
                }
            }
            if (self.collapses - before) * STUCK < waiting.len() || waiting.is_empty() {
                break;
            }
        }
        left.retain(|&v| self.parent[v as usize] == v);
        self.refresh_all(&left);
        self.run_best_first(progress)
    }

    /// How many collapses the target is away, about.
    fn wanted(&self) -> usize {
        match self.target {
            Target::Faces(count) => self.rings.face_count.saturating_sub(count).div_ceil(2),
            Target::Vertices(count) => self.rings.vertex_count.saturating_sub(count),
            Target::Error(_) => usize::MAX,
        }
    }

    fn mark_stale(&mut self, v: u32) {
        self.is_stale[v as usize] = true;
        if self.is_memoryless() {
            for k in 0..self.rings.ring_len(v) {
                let f = self.rings.ring(v)[k];
                for w in self.rings.others(f, v) {
                    self.is_stale[w as usize] = true;
                }
            }
        }
    }

    fn refresh_all(&mut self, left: &[u32]) {
        let stale: Vec<u32> = left.iter().copied().filter(|&v| self.is_stale[v as usize]).collect();
        let sums = parallel::map_blocks(stale.len(), 1024, |range| {
            let of = |&v: &u32| {
                let around = (!self.around.is_empty()).then(|| self.around(v));
                (around, (self.shares[0] > 0.0).then(|| self.present(v)))
            };
            stale[range].iter().map(of).collect::<Vec<_>>()
        });
        for (&v, (around, through)) in stale.iter().zip(sums.into_iter().flatten()) {
            let i = v as usize;
            self.is_stale[i] = false;
            if let Some(around) = around {
                self.around[i] = around;
            }
            if let Some(through) = through {
                self.through[i] = through;
            }
            if let Some(channels) = &mut self.channels {
                channels.refresh(&self.rings, &self.normals, v);
            }
        }
    }

    fn rank_all(&self, left: &[u32]) -> Vec<Waiting> {
        let blocks = parallel::map_blocks(left.len(), 1024, |range| {
            let ranked = left[range].iter().map(|&v| {
                let (w, found) = self.rank(v);
                (v, w, found)
            });
            let may = |x: &Waiting| x.1 != NONE && State::error(&x.2) <= self.error_limit;
            ranked.filter(may).collect::<Vec<_>>()
        });
        blocks.into_iter().flatten().collect()
    }
}
