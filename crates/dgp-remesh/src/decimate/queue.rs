//! The order of [`Order::Best`]: the cheapest collapse of all is done next.
//!
//! Each vertex waits with its best edge to a vertex of a larger number. What a collapse changes around it is
//! not ranked again at once but when its turn comes.
//!
//! - Input: triangles with the planes around each vertex.
//! - Cost: O(n log n).
//! - Reference: Garland and Heckbert 1997.
//!
//! [`Order::Best`]: crate::Order::Best

use dgp_mesh::{Cancelled, Progress, VertexId, graph::IndexedHeap, parallel};

use super::{report::StopReason, rings::NONE, state::State};

/// Who waits, and for what.
pub(super) struct Queue {
    heap: IndexedHeap<VertexId>,
    best: Vec<u32>,
    is_ranked: Vec<bool>,
}

impl Queue {
    fn new(state: &State) -> Self {
        let n = state.parent.len();
        let ranked = parallel::map(n, |v: VertexId| state.rank(v.index() as u32)).into_values();
        let keys = ranked.iter().enumerate().filter(|(_, (w, _))| *w != NONE);
        Queue {
            heap: IndexedHeap::from_keys(keys.map(|(v, (_, found))| (VertexId::new(v), found.key))),
            best: ranked.iter().map(|&(w, _)| w).collect(),
            is_ranked: vec![true; n],
        }
    }
}

impl State {
    /// Collapses the cheapest edge until the target is reached or nothing is left.
    pub(super) fn run_best_first(&mut self, progress: Progress<'_>) -> Result<(), Cancelled> {
        let mut queue = Queue::new(self);
        progress.report(0.0)?;
        let mut turns = 0_usize;
        while let Some((id, key)) = queue.heap.pop() {
            turns += 1;
            if turns.is_multiple_of(4096) {
                let now = [self.rings.vertex_count, self.rings.face_count];
                progress.report(self.target.progress(self.start, now))?;
            }
            let v = id.index() as u32;
            let best = queue.best[v as usize];
            if !queue.is_ranked[v as usize] || best == NONE || self.is_stale[best as usize] {
                queue.is_ranked[v as usize] = true;
                self.refresh_around(v);
                let (w, found) = self.rank(v);
                queue.best[v as usize] = w;
                if w == NONE {
                    continue;
                }
                if queue.heap.first().is_some_and(|(_, next)| found.key > next) {
                    queue.heap.set(id, found.key);
                    continue;
                }
            }
            let w = queue.best[v as usize];
            let found = self.candidate(v, w);
            if let Some(shared) = self.check(v, w, &found) {
                let (from, to) = self.collapse(v, w, &shared, &found);
                queue.heap.remove(VertexId::new(from as usize));
                self.touch(&mut queue, to, key);
                if self.target.is_reached(self.rings.vertex_count, self.rings.face_count) {
                    return Ok(());
                }
            } else {
                self.rank_checked(&mut queue, v);
            }
        }
        self.stop = StopReason::NothingLeft;
        Ok(())
    }

    /// Looks for the best edge of `v` that may be collapsed.
    fn rank_checked(&mut self, queue: &mut Queue, v: u32) {
        let mut found: Vec<(f64, u32)> = Vec::new();
        self.rings.each_neighbor(v, |w| {
            if self.is_allowed(v, w) {
                found.push((self.candidate(v, w).key, w));
            }
        });
        found.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        for (key, w) in found {
            let candidate = self.candidate(v, w);
            if w != queue.best[v as usize] && self.check(v, w, &candidate).is_some() {
                queue.best[v as usize] = w;
                queue.heap.set(VertexId::new(v as usize), key);
                return;
            }
        }
    }

    /// Has the surroundings of `v` ranked anew.
    fn touch(&mut self, queue: &mut Queue, v: u32, key: f64) {
        self.is_stale[v as usize] = true;
        let is_memoryless = self.is_memoryless();
        for k in 0..self.rings.ring_len(v) {
            let f = self.rings.ring(v)[k];
            for w in self.rings.others(f, v) {
                if !queue.is_ranked[w as usize] && self.is_stale[w as usize] == is_memoryless {
                    continue;
                }
                self.is_stale[w as usize] |= is_memoryless;
                queue.is_ranked[w as usize] = false;
                let id = VertexId::new(w as usize);
                if queue.heap.key(id).is_none() {
                    queue.heap.set(id, key);
                }
            }
        }
        self.refresh_around(v);
        let (w, found) = self.rank(v);
        queue.is_ranked[v as usize] = true;
        queue.best[v as usize] = w;
        let id = VertexId::new(v as usize);
        if w == NONE {
            queue.heap.remove(id);
        } else {
            queue.heap.set(id, found.key);
        }
    }
}
