//! Ear cutting: cuts off corner after corner whose triangle holds no other.
//!
//! An ear is a convex corner i such that no corner that is not convex lies in the closed triangle
//! (before i, i, after i). Every simple polygon has two; cutting one off leaves a simple polygon. Ears
//! wait in a queue. A convex corner that is no ear waits for the corner that keeps it from being one,
//! and is queued again when that one is cut off or becomes convex. Corners that are not convex lie in
//! a grid of cells, of which a test visits those that the triangle touches.
//!
//! - Input: any polygon. If it is not simple the queue may run dry; then the best of a few corners is
//!   cut off as it is.
//! - Cost: O(n) memory; time O(n log n) or so for polygons of practice (10⁵ corners of a rough circle
//!   or of a comb in a fraction of a second), O(n²) if most triangles are long and thin across the rest.
//! - Guarantees: n − 2 triangles; in a simple polygon all turn counterclockwise and none overlap, in
//!   one that touches itself, as around holes joined by a cut, too.
//! - Reference: Meisters, "Polygons have ears", American Mathematical Monthly 82, 1975; cells after
//!   Held, "FIST: fast industrial-strength triangulation of polygons", Algorithmica 30, 2001.
//! - Departs from it: the waiting lists instead of repeated rounds.

use std::collections::VecDeque;

use glam::DVec2;

use super::plane::{View, turn};

/// How many corners to look at for the best one when there are no ears.
const CANDIDATES: usize = 16;
/// More than rounding can move a turned point or one on a side of a triangle: coordinates are below 2.
const SLACK: f64 = 32.0 * f64::EPSILON;
/// How often to look at all corners again when there seem to be no ears: polygons that touch themselves
/// need it once or twice, and in those that cross themselves it does not help.
const REFILLS: usize = 32;

/// Adds the triangles of the polygon in `view`, avoiding diagonals for which `is_taken` holds.
pub(super) fn triangulate(
    view: &View,
    is_taken: &dyn Fn(usize, usize) -> bool,
    triangles: &mut Vec<[usize; 3]>,
) {
    let mut ring = Ring::new(&view.points);
    let mut cursor = 0;
    while ring.left > 3 {
        let ear = ring.next_ear(is_taken).or_else(|| {
            ring.refill(cursor);
            ring.next_ear(is_taken)
        });
        let ear = ear.unwrap_or_else(|| ring.least_bad(cursor, is_taken));
        let (before, after) = (ring.before[ear], ring.after[ear]);
        triangles.push([before, ear, after]);
        ring.cut_off(ear);
        cursor = after;
    }
    let [a, b] = [ring.before[cursor], ring.after[cursor]];
    triangles.push([a, cursor, b]);
}

/// The corners that are left.
struct Ring<'a> {
    points: &'a [DVec2],
    before: Vec<usize>,
    after: Vec<usize>,
    left: usize,
    is_cut: Vec<bool>,
    is_convex: Vec<bool>,
    queue: VecDeque<usize>,
    is_queued: Vec<bool>,
    /// The corners that are no ears because of corner i.
    waiting: Vec<Vec<usize>>,
    cells: Cells,
    refills: usize,
}

impl<'a> Ring<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let n = points.len();
        let before: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
        let after: Vec<usize> = (0..n).map(|i| (i + 1) % n).collect();
        let is_convex: Vec<bool> =
            (0..n).map(|i| turn(points[before[i]], points[i], points[after[i]]) > 0.0).collect();
        let inward: Vec<usize> = (0..n).filter(|&i| !is_convex[i]).collect();
        // Every other ear first: triangles stay compact.
        let ears = (0..n).step_by(2).chain((1..n).step_by(2)).filter(|&i| is_convex[i]);
        Ring {
            points,
            queue: ears.collect(),
            is_queued: is_convex.clone(),
            waiting: vec![Vec::new(); n],
            cells: Cells::new(points, &inward),
            left: n,
            is_cut: vec![false; n],
            before,
            after,
            is_convex,
            refills: REFILLS,
        }
    }

    fn turn(&self, a: usize, b: usize, c: usize) -> f64 {
        turn(self.points[a], self.points[b], self.points[c])
    }

    /// The first ear in the queue; what turns out to be none leaves it.
    fn next_ear(&mut self, is_taken: &dyn Fn(usize, usize) -> bool) -> Option<usize> {
        while let Some(i) = self.queue.pop_front() {
            self.is_queued[i] = false;
            if self.is_cut[i] || !self.is_convex[i] || is_taken(self.before[i], self.after[i]) {
                continue;
            }
            match self.obstacle(i) {
                Some(obstacle) => self.waiting[obstacle].push(i),
                None => return Some(i),
            }
        }
        None
    }

    /// A corner that keeps the convex corner `i` from being an ear.
    fn obstacle(&self, i: usize) -> Option<usize> {
        let tip = [self.before[i], i, self.after[i]];
        let triangle = tip.map(|corner| self.points[corner]);
        self.cells.find(triangle, |other| {
            !self.is_cut[other]
                && !self.is_convex[other]
                && !tip.contains(&other)
                && self.is_in_the_way(triangle, other)
        })
    }

    fn is_in_the_way(&self, triangle: [DVec2; 3], other: usize) -> bool {
        let [a, b, c] = triangle;
        let p = self.points[other];
        if turn(a, b, p) < 0.0 || turn(b, c, p) < 0.0 || turn(c, a, p) < 0.0 {
            return false;
        }
        // Where a polygon touches itself in a corner of the triangle, it matters where it goes.
        let Some(k) = triangle.iter().position(|&corner| corner == p) else {
            return true;
        };
        let (left, right) = (triangle[(k + 1) % 3], triangle[(k + 2) % 3]);
        [self.before[other], self.after[other]].iter().any(|&neighbor| {
            let q = self.points[neighbor];
            turn(p, left, q) > 0.0 && turn(p, q, right) > 0.0
        })
    }

    /// Queues all convex corners again, some times: where a polygon touches itself, an obstacle may go
    /// away without being cut off.
    fn refill(&mut self, cursor: usize) {
        if self.refills == 0 {
            return;
        }
        self.refills -= 1;
        let mut i = cursor;
        for _ in 0..self.left {
            if self.is_convex[i] {
                self.enqueue(i);
            }
            i = self.after[i];
        }
    }

    /// The best of some corners from `cursor` on: convex and empty of obstacles is out of reach, so
    /// convex before straight before the rest.
    fn least_bad(&self, cursor: usize, is_taken: &dyn Fn(usize, usize) -> bool) -> usize {
        let mut best = (i32::MIN, cursor);
        let mut i = cursor;
        for _ in 0..CANDIDATES.min(self.left) {
            let (before, after) = (self.before[i], self.after[i]);
            let turn = self.turn(before, i, after);
            let rank = if is_taken(before, after) {
                -2
            } else if turn > 0.0 {
                1
            } else if turn < 0.0 {
                -1
            } else {
                0
            };
            if rank > best.0 {
                best = (rank, i);
            }
            i = after;
        }
        best.1
    }

    fn cut_off(&mut self, i: usize) {
        let (before, after) = (self.before[i], self.after[i]);
        self.after[before] = after;
        self.before[after] = before;
        self.is_cut[i] = true;
        self.left -= 1;
        self.release(i);
        for neighbor in [before, after] {
            let was_convex = self.is_convex[neighbor];
            let (a, b) = (self.before[neighbor], self.after[neighbor]);
            self.is_convex[neighbor] = self.turn(a, neighbor, b) > 0.0;
            if self.is_convex[neighbor] {
                if !was_convex {
                    self.release(neighbor);
                }
                self.enqueue(neighbor);
            }
        }
    }

    /// Queues what waits for `i`.
    fn release(&mut self, i: usize) {
        for waiter in std::mem::take(&mut self.waiting[i]) {
            self.enqueue(waiter);
        }
    }

    fn enqueue(&mut self, i: usize) {
        if !self.is_queued[i] && !self.is_cut[i] {
            self.is_queued[i] = true;
            self.queue.push_back(i);
        }
    }
}

/// Corners in the nearly square cells of a grid over their bounding box, about one in each. The box is
/// turned along the corners, so that even a long straight row of them fills its cells.
struct Cells {
    /// The direction of the rows.
    axis: DVec2,
    low: DVec2,
    high: DVec2,
    /// Cells per unit of length.
    density: DVec2,
    /// Columns and rows.
    size: [usize; 2],
    /// The corners of cell c are at `[c]..[c + 1]`.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Cells {
    fn new(points: &[DVec2], corners: &[usize]) -> Self {
        let axis = principal_direction(points, corners);
        let points: Vec<DVec2> = points.iter().map(|&p| turned(axis, p)).collect();
        let low = corners.iter().fold(DVec2::INFINITY, |low, &i| low.min(points[i]));
        let high = corners.iter().fold(DVec2::NEG_INFINITY, |high, &i| high.max(points[i]));
        let extent = high - low;
        let count = corners.len() as f64;
        let along = |length: f64, other: f64| {
            let cells = (count * length / other).sqrt().ceil();
            if length > 0.0 && cells >= 1.0 { cells.min(count) } else { 1.0 }
        };
        let (columns, rows) = (along(extent.x, extent.y), along(extent.y, extent.x));
        let per_length = |count: f64, length: f64| if count > 1.0 { count / length } else { 0.0 };
        let mut cells = Cells {
            axis,
            low,
            high,
            density: DVec2::new(per_length(columns, extent.x), per_length(rows, extent.y)),
            size: [columns as usize, rows as usize],
            starts: vec![0; columns as usize * rows as usize + 2],
            corners: vec![0; corners.len()],
        };
        // A counting sort: starts[c + 1] is where cell c begins, and moves to its end as it fills.
        for &i in corners {
            let cell = cells.index(cells.cell(points[i]));
            cells.starts[cell + 2] += 1;
        }
        for c in 2..cells.starts.len() {
            cells.starts[c] += cells.starts[c - 1];
        }
        for &i in corners {
            let cell = cells.index(cells.cell(points[i]));
            let place = &mut cells.starts[cell + 1];
            cells.corners[*place as usize] = i as u32;
            *place += 1;
        }
        cells
    }

    fn index(&self, [column, row]: [usize; 2]) -> usize {
        row * self.size[0] + column
    }

    /// The cell of `p`, or the nearest one if it is outside the box.
    fn cell(&self, p: DVec2) -> [usize; 2] {
        // Casting rounds down, and what is below 0 or no number becomes 0.
        let cell = (p - self.low) * self.density;
        [(cell.x as usize).min(self.size[0] - 1), (cell.y as usize).min(self.size[1] - 1)]
    }

    /// A corner with `property` in the cells that `triangle` touches.
    fn find(&self, triangle: [DVec2; 3], property: impl Fn(usize) -> bool) -> Option<usize> {
        let triangle = triangle.map(|p| turned(self.axis, p));
        let [a, b, c] = triangle;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let (low, high) = (low - SLACK, high + SLACK);
        let is_apart = high.x < self.low.x || high.y < self.low.y;
        if is_apart || low.x > self.high.x || low.y > self.high.y {
            return None;
        }
        for row in self.cell(low)[1]..=self.cell(high)[1] {
            let Some([left, right]) = self.across(triangle, row) else {
                continue;
            };
            let first = self.index([self.cell(DVec2::new(left, 0.0))[0], row]);
            let last = self.index([self.cell(DVec2::new(right, 0.0))[0], row]);
            // What is no number must not turn the range around.
            let range = self.starts[first] as usize..self.starts[last.max(first) + 1] as usize;
            if let Some(&i) = self.corners[range].iter().find(|&&i| property(i as usize)) {
                return Some(i as usize);
            }
        }
        None
    }

    /// From where to where `triangle` reaches in a row of cells, slightly widened against rounding.
    fn across(&self, triangle: [DVec2; 3], row: usize) -> Option<[f64; 2]> {
        let height = (self.high.y - self.low.y) / self.size[1] as f64;
        let below = self.low.y + row as f64 * height - SLACK;
        let above = self.low.y + (row + 1) as f64 * height + SLACK;
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut reach = |x: f64| {
            left = left.min(x);
            right = right.max(x);
        };
        for k in 0..3 {
            let (p, q) = (triangle[k], triangle[(k + 1) % 3]);
            if below <= p.y && p.y <= above {
                reach(p.x);
            }
            for y in [below, above] {
                if (p.y < y) != (q.y < y) {
                    reach(p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)).clamp(0.0, 1.0));
                }
            }
        }
        (left <= right).then_some([left - SLACK, right + SLACK])
    }
}

/// The unit vector along which the corners spread most; the x axis where there is none.
fn principal_direction(points: &[DVec2], corners: &[usize]) -> DVec2 {
    let mean = corners.iter().map(|&i| points[i]).sum::<DVec2>() / corners.len().max(1) as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &i in corners {
        let d = points[i] - mean;
        xx += d.x * d.x;
        xy += d.x * d.y;
        yy += d.y * d.y;
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    if angle.is_finite() { DVec2::from_angle(angle) } else { DVec2::X }
}

/// `p` in a frame whose first axis is `axis`.
fn turned(axis: DVec2, p: DVec2) -> DVec2 {
    DVec2::new(axis.dot(p), axis.perp_dot(p))
}
