//! The three edits, over all edges: long ones are split, short ones collapsed, others flipped for the sake of
//! valences and angles.

use dgp_mesh::{DVec3, Progress, parallel};

use super::{
    lines::{Line, along},
    surface::{Freedom, NONE, Surface, Vertex, next, prev},
};
use crate::Error;

/// Longer than so many times the length wanted is long.
pub(super) const LONG: f64 = 4.0 / 3.0;
/// Shorter than so many times the length wanted is short.
pub(super) const SHORT: f64 = 4.0 / 5.0;
/// By how much a collapse may exceed what is long, at most.
const MOST_STRETCH: f64 = 1.5;
/// Classes of edges by their lengths: see [`class_of`].
const CLASSES: usize = 64;
/// The least cosine between a triangle before and after an edit.
const LEAST_COSINE: f64 = 0.5;
/// Of two triangles that are bent less than this, a flip may bend them up to it.
const FLAT: f64 = 0.9;
/// A flip for the sake of valences makes no angle of a larger cosine, unless there was one.
const SHARP: f64 = 0.94;
/// The largest part of a loop between neighbors on it: beyond half of it, the shorter way is another.
const LARGEST_PART: f64 = 0.45;
/// Edits between two looks at the progress.
const BETWEEN: usize = 1 << 13;

/// Which flips are done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// Valences, and of equal ones angles.
    Valences,
    /// Angles, where valences become no worse.
    Angles,
}

/// Splitting.
impl Surface {
    /// The length of an edge in units of what is wanted, squared.
    #[inline]
    pub(super) fn relative(&self, h: u32) -> f64 {
        let size = self.size(self.from(h), self.to(h));
        self.square(h) / (size * size)
    }

    /// Whether `h` stands for its edge: of two half-edges the first.
    #[inline]
    pub(super) fn stands_for_edge(&self, h: u32) -> bool {
        h < self.twin(h)
    }

    /// The half-edges that stand for edges and of which `f` gives something, with that, in their order.
    fn found<T: Send>(&self, f: impl Fn(u32) -> Option<T> + Sync + Send) -> Vec<(u32, T)> {
        let blocks = parallel::map_blocks(self.triangles.len(), parallel::BLOCK, |range| {
            let there = range.filter(|&f| self.has(f)).flat_map(halfedges);
            let edges = there.filter(|&h| self.stands_for_edge(h));
            edges.filter_map(|h| Some((h, f(h)?))).collect::<Vec<_>>()
        });
        blocks.into_iter().flatten().collect()
    }

    /// Splits edges that are too long at their middles, nearly the longest first, until there are more than `most`
    /// triangles: then lines contradict the lengths wanted. Returns how many.
    pub(super) fn split_long(
        &mut self,
        lines: &[Line],
        most: usize,
        progress: Progress<'_>,
    ) -> Result<usize, Error> {
        progress.report(0.0)?;
        // Edges whose squared lengths are within a factor of 2 are in the same class.
        let class = |surface: &Surface, h: u32| {
            let relative = surface.relative(h);
            (relative > LONG * LONG).then(|| class_of(relative))
        };
        let mut classes: Vec<Vec<u32>> = vec![Vec::new(); CLASSES];
        for (h, class) in self.found(|h| class(self, h)) {
            classes[class].push(h);
        }
        let mut count = 0;
        for k in (0..CLASSES).rev() {
            let mut i = 0;
            while i < classes[k].len() && self.face_count <= most {
                if i % BETWEEN == 0 {
                    progress.report((CLASSES - k) as f64 / CLASSES as f64)?;
                }
                let h = classes[k][i];
                i += 1;
                // It may have become shorter, and then waits for its turn.
                match class(self, h) {
                    Some(now) if now >= k => {}
                    Some(now) => {
                        classes[now].push(h);
                        continue;
                    }
                    None => continue,
                }
                let Some(new) = self.split_in_middle(h, lines)? else { continue };
                count += 1;
                for g in new.into_iter().filter(|&g| g != NONE) {
                    if let Some(class) = class(self, g) {
                        classes[class.min(k)].push(g);
                    }
                }
            }
            classes[k] = Vec::new();
        }
        Ok(count)
    }

    /// Splits the edge of `h`, and returns a half-edge of each edge that is new or has other half-edges now.
    fn split_in_middle(&mut self, h: u32, lines: &[Line]) -> Result<Option<[u32; 6]>, Error> {
        let (a, b) = (self.from(h), self.to(h));
        let [one, other] = [a, b].map(|v| *self.vertex(v));
        let near = if one.freedom == Freedom::Free { one.near } else { other.near };
        let mut vertex = Vertex { near, ..Vertex::new(0.5 * (one.size + other.size)) };
        let mut position = 0.5 * self.position(a) + 0.5 * self.position(b);
        let number = self.line(h);
        if number != NONE {
            let line = &lines[number as usize];
            if line.is_kept {
                return Ok(None);
            }
            vertex.freedom = Freedom::Line;
            vertex.line = number;
            vertex.along = self.middle(line, a, b);
            position = line.point(vertex.along);
            vertex.wanted = if self.twin(h) == NONE { 4 } else { 6 };
        }
        // Where numbers are too coarse there is nothing between the ends.
        if position == self.position(a) || position == self.position(b) {
            return Ok(None);
        }
        let t = self.twin(h);
        let m = self.split(h, position, vertex)?;
        let half = self.vertex(m).spoke;
        let [across, beside] = if t == NONE { [NONE; 2] } else { [prev(t), prev(self.twin(half))] };
        Ok(Some([h, half, next(h), next(half), across, beside]))
    }

    /// The place on `line` between two neighbors on it.
    fn middle(&self, line: &Line, a: u32, b: u32) -> f64 {
        let start = along(self, line, a);
        start + 0.5 * line.way(start, along(self, line, b))
    }
}

/// A collapse that may be done.
struct Collapse {
    goes: u32,
    stays: u32,
    position: DVec3,
    /// Where on its line the vertex is then.
    along: f64,
}

/// Collapsing.
impl Surface {
    /// Collapses edges that are too short, the shortest first, unless others would become too long or turn over.
    /// Returns how many.
    pub(super) fn collapse_short(
        &mut self,
        lines: &[Line],
        progress: Progress<'_>,
    ) -> Result<usize, Error> {
        progress.report(0.0)?;
        let class = |relative: f64| (relative < SHORT * SHORT).then(|| SHORT * SHORT / relative);
        let mut short = self.found(|h| class(self.relative(h)).map(class_of));
        // Stable, so that edges of a class keep their order.
        short.sort_by_key(|&(_, class)| CLASSES - class);
        let mut count = 0;
        for (i, (h, _)) in short.iter().enumerate() {
            if i % BETWEEN == 0 {
                progress.report(i as f64 / short.len() as f64)?;
            }
            let f = (h >> 2) as usize;
            if self.has(f) && self.relative(*h) < SHORT * SHORT {
                count += usize::from(self.try_collapse(*h, lines));
            }
        }
        Ok(count)
    }

    /// Collapses the edge of `h`, if nothing speaks against it.
    fn try_collapse(&mut self, h: u32, lines: &[Line]) -> bool {
        let Some(Collapse { goes, stays, position, along }) = self.planned(h, lines) else {
            return false;
        };
        // The shorter an edge is, the longer others may become in its place: where triangles are stretched alike, all
        // collapses would be refused otherwise. What is too long then is split again.
        let most = LONG * (SHORT / self.relative(h).sqrt()).min(MOST_STRETCH);
        if self.is_too_long([goes, stays], position, most)
            || self.turns(goes, stays, position)
            || self.turns(stays, goes, position)
            || !self.may_collapse(h)
        {
            return false;
        }
        self.collapse(h, goes);
        self.positions[stays as usize] = position;
        self.vertices[stays as usize].along = along;
        true
    }

    /// Which end goes, and where the other one is put: what is on a line stays on it, what is fixed stays.
    fn planned(&self, h: u32, lines: &[Line]) -> Option<Collapse> {
        let (a, b) = (self.from(h), self.to(h));
        let line = match self.line(h) {
            NONE => None,
            number => Some(&lines[number as usize]),
        };
        if line.is_some_and(|line| line.is_kept) {
            return None;
        }
        let may_go = |v: u32| match self.vertex(v).freedom {
            Freedom::Free => true,
            Freedom::Line => line.is_some(),
            Freedom::Fixed => false,
        };
        let (goes, stays) = if may_go(a) { (a, b) } else { (b, a) };
        if !may_go(goes) {
            return None;
        }
        let mut plan = Collapse {
            goes,
            stays,
            position: self.position(stays),
            along: self.vertex(stays).along,
        };
        match line {
            Some(line) => {
                if may_go(stays) {
                    plan.along = self.middle(line, goes, stays);
                    plan.position = line.point(plan.along);
                }
                let place = if may_go(stays) { plan.along } else { along(self, line, stays) };
                if line.is_loop && self.parts_loop(line, [goes, stays], place) {
                    return None;
                }
            }
            None if may_go(stays) => {
                plan.position = 0.5 * self.position(a) + 0.5 * self.position(b);
            }
            None => {}
        }
        Some(plan)
    }

    /// Whether neighbors on a loop would be too far apart if two that are next to each other were at `place`.
    fn parts_loop(&self, line: &Line, pair: [u32; 2], place: f64) -> bool {
        let on_line = pair.into_iter().filter(|&v| self.vertex(v).freedom == Freedom::Line);
        on_line.into_iter().any(|v| {
            let here = self.vertex(v).along;
            self.line_neighbors(v).into_iter().filter(|w| !pair.contains(w) && *w != NONE).any(
                |w| {
                    let way = line.way(place, here) + line.way(here, along(self, line, w));
                    way.abs() > LARGEST_PART * line.length()
                },
            )
        })
    }

    /// Whether an edge at `a` or `b` would be longer than `most` times the length wanted if both were at `p`, and longer
    /// than it was.
    fn is_too_long(&self, [a, b]: [u32; 2], p: DVec3, most: f64) -> bool {
        let mut is_long = false;
        for (v, other) in [(a, b), (b, a)] {
            let here = self.position(v);
            self.each_neighbor(v, |w| {
                let size = most * self.size(v, w);
                let q = self.position(w);
                let now = q.distance_squared(p);
                is_long |= w != other && now > size * size && now > q.distance_squared(here);
            });
        }
        is_long
    }

    /// Whether a triangle at `v` but not at `other` turns too far when `v` moves to `p`.
    fn turns(&self, v: u32, other: u32, p: DVec3) -> bool {
        let here = self.position(v);
        self.spokes(v).any(|h| {
            let (x, y) = (self.to(h), self.from(prev(h)));
            if x == other || y == other {
                return false;
            }
            let (x, y) = (self.position(x), self.position(y));
            let before = (x - here).cross(y - here);
            let after = (x - p).cross(y - p);
            let (was, is) = (before.length_squared(), after.length_squared());
            let cosine = before.dot(after);
            // What had no area may turn as it likes.
            was > 0.0 && (cosine <= 0.0 || cosine * cosine < LEAST_COSINE * LEAST_COSINE * was * is)
        })
    }
}

/// Flipping.
impl Surface {
    /// Flips edges for the sake of valences and angles. Returns how many.
    pub(super) fn flip_all(&mut self, aim: Aim, progress: Progress<'_>) -> Result<usize, Error> {
        progress.report(0.0)?;
        let better = self.found(|h| self.is_better_flipped(h, aim).then_some(()));
        let mut waiting: Vec<u32> = better.into_iter().map(|(h, ())| h).collect();
        // Flips lead to others nearby; there is an end to that, but it may be far.
        let most = waiting.len() + 3 * self.face_count;
        let (mut i, mut count) = (0, 0);
        while i < waiting.len().min(most) {
            if i % BETWEEN == 0 {
                progress.report(i as f64 / waiting.len() as f64)?;
            }
            let h = waiting[i];
            i += 1;
            if !self.is_better_flipped(h, aim) {
                continue;
            }
            self.flip(h);
            count += 1;
            let t = self.twin(h);
            let around = [next(h), prev(h), next(t), prev(t)];
            waiting.extend(around.into_iter().filter(|&g| self.is_better_flipped(g, aim)));
        }
        Ok(count)
    }

    fn is_better_flipped(&self, h: u32, aim: Aim) -> bool {
        let t = self.twin(h);
        if t == NONE || self.line(h) != NONE {
            return false;
        }
        let ids = [self.from(h), self.to(h), self.from(prev(h)), self.from(prev(t))];
        let gain = self.valence_gain(ids);
        if gain < 0 {
            return false;
        }
        let [a, b, c, d] = ids.map(|v| self.position(v));
        let before = sharpest(a, b, c).max(sharpest(b, a, d));
        let after = sharpest(a, d, c).max(sharpest(b, c, d));
        let is_better = if gain > 0 && aim == Aim::Valences {
            after < SHARP.max(before)
        } else {
            // By more than rounding, or two flips might undo each other.
            after < before - 1e-9
        };
        is_better && keeps_side([a, b, c, d]) && !self.are_joined(ids[2], ids[3])
    }

    /// By how much Σ (valence − wanted)² of the corners becomes less when ab is flipped to cd; negative also where a
    /// vertex would have too few edges.
    #[inline]
    fn valence_gain(&self, [a, b, c, d]: [u32; 4]) -> i64 {
        let excess = |v: u32| {
            let vertex = self.vertex(v);
            i64::from(vertex.valence) - i64::from(vertex.wanted)
        };
        let loses = |v: u32| {
            let vertex = self.vertex(v);
            vertex.valence <= if vertex.on_rim { 2 } else { 3 }
        };
        if loses(a) || loses(b) {
            return -1;
        }
        2 * (excess(a) + excess(b) - excess(c) - excess(d)) - 4
    }
}

/// The class of a number above 1: how often it can be halved, up to the last class.
#[inline]
fn class_of(number: f64) -> usize {
    let exponent = (number.to_bits() >> 52) as usize;
    exponent.saturating_sub(1023).min(CLASSES - 1)
}

/// The half-edges of triangle `f`.
#[inline]
pub(super) fn halfedges(f: usize) -> impl Iterator<Item = u32> {
    let first = 4 * f as u32;
    first..first + 3
}

/// The cosine of the smallest angle of a triangle; 2 if it has no area.
#[inline]
fn sharpest(p: DVec3, q: DVec3, r: DVec3) -> f64 {
    let sides = [q - p, r - q, p - r];
    let [x, y, z] = sides.map(DVec3::length_squared);
    // The smallest angle is opposite to the shortest side.
    let (product, squares) = if x <= y && x <= z {
        (-sides[1].dot(sides[2]), y * z)
    } else if y <= z {
        (-sides[2].dot(sides[0]), z * x)
    } else {
        (-sides[0].dot(sides[1]), x * y)
    };
    let cosine = product / squares.sqrt();
    if cosine < 1.0 { cosine } else { 2.0 }
}

/// Whether the triangles of both diagonals look the same way, and the new ones are not bent by much more.
#[inline]
fn keeps_side([a, b, c, d]: [DVec3; 4]) -> bool {
    let (n, m) = ((b - a).cross(c - a), (a - b).cross(d - b));
    let (x, y) = ((d - a).cross(c - a), (c - b).cross(d - b));
    let cosine = |u: DVec3, v: DVec3| {
        let product = u.dot(v) / (u.length() * v.length());
        if product.is_finite() { product } else { 1.0 }
    };
    let sum = n + m;
    // What has no area may come to look where it will.
    (sum == DVec3::ZERO || (x.dot(sum) > 0.0 && y.dot(sum) > 0.0))
        && cosine(x, y) >= cosine(n, m).min(FLAT)
}
