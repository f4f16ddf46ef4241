//! Points within a distance of each other, by pairs of boxes of a k-d tree.

use std::ops::Range;

use glam::DVec3;

use super::{Tolerance, Welding, table};
use crate::{Cancelled, Error, Progress, check::union::Union};

/// Points in a leaf of the tree: few enough to compare all pairs.
const LEAF: usize = 8;

/// Boxes above this level report progress.
const REPORTED_LEVELS: u32 = 8;

pub(super) fn weld(
    points: &[DVec3],
    exact: Welding,
    tolerance: Tolerance,
    progress: Progress<'_>,
) -> Result<Welding, Error> {
    let distinct: Vec<DVec3> = exact.originals.values().iter().map(|v| points[v.index()]).collect();
    // Scaled by a power of two so that no square overflows, or vanishes beside the others.
    let largest = distinct.iter().filter(|p| p.is_finite()).map(|p| p.abs().max_element());
    let scale = power_of_two_above(largest.fold(0.0, f64::max)).recip();
    let scaled: Vec<DVec3> = distinct.iter().map(|&p| p * scale).collect();
    let finite: Vec<u32> =
        (0..scaled.len() as u32).filter(|&i| scaled[i as usize].is_finite()).collect();
    let distance = match tolerance {
        Tolerance::Exact => 0.0,
        Tolerance::Distance(distance) => distance * scale,
        Tolerance::OfDiagonal(fraction) => {
            let (min, max) = bounds(&scaled, &finite);
            if finite.is_empty() { 0.0 } else { fraction * (max - min).length() }
        }
    };
    if distance == 0.0 || finite.is_empty() {
        return Ok(exact);
    }
    let mut search = Search {
        tree: Tree::new(&scaled, finite),
        points: &scaled,
        union: Union::new(scaled.len()),
        square: distance * distance,
        progress,
    };
    progress.report(0.5)?;
    search.within(0, 0, 0)?;
    let mut union = search.union;
    let classes =
        table::from_firsts(&(0..scaled.len()).map(|i| union.find(i) as u32).collect::<Vec<_>>());
    Ok(Welding {
        vertices: exact.vertices.map(|&v| classes.vertices[v]),
        originals: classes.originals.map(|&v| exact.originals[v]),
    })
}

/// The power of two in (x, 2x], within what has a reciprocal.
fn power_of_two_above(x: f64) -> f64 {
    2.0_f64.powi((x.max(f64::MIN_POSITIVE).log2().floor() as i32 + 1).clamp(-1020, 1020))
}

fn bounds(points: &[DVec3], ids: &[u32]) -> (DVec3, DVec3) {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    ids.iter().map(|&i| points[i as usize]).fold(start, |(min, max), p| (min.min(p), max.max(p)))
}

/// Boxes of points, halved at the median of their longest side. Box 0 holds all points.
struct Tree {
    ids: Vec<u32>,
    boxes: Vec<Cell>,
}

struct Cell {
    min: DVec3,
    max: DVec3,
    ids: Range<usize>,
    halves: Option<[usize; 2]>,
}

impl Tree {
    fn new(points: &[DVec3], ids: Vec<u32>) -> Self {
        let mut tree = Tree { boxes: Vec::with_capacity(ids.len() / LEAF * 4 + 1), ids };
        tree.add(points, 0..tree.ids.len());
        tree
    }

    fn add(&mut self, points: &[DVec3], range: Range<usize>) -> usize {
        let ids = &mut self.ids[range.clone()];
        let (min, max) = bounds(points, ids);
        let number = self.boxes.len();
        self.boxes.push(Cell { min, max, ids: range.clone(), halves: None });
        if range.len() > LEAF {
            let axis = (max - min).max_position();
            let key = |i: u32| points[i as usize][axis];
            let middle = range.len() / 2;
            ids.select_nth_unstable_by(middle, |&i, &j| key(i).total_cmp(&key(j)).then(i.cmp(&j)));
            let middle = range.start + middle;
            let lower = self.add(points, range.start..middle);
            let upper = self.add(points, middle..range.end);
            self.boxes[number].halves = Some([lower, upper]);
        }
        number
    }
}

struct Search<'a> {
    tree: Tree,
    points: &'a [DVec3],
    union: Union,
    /// The distance, squared.
    square: f64,
    progress: Progress<'a>,
}

impl Search<'_> {
    /// Joins all that is near within box `a`, the `index`-th of its level.
    fn within(&mut self, a: usize, level: u32, index: u32) -> Result<(), Cancelled> {
        if level < REPORTED_LEVELS {
            self.progress.report(0.5 + 0.5 * f64::from(index) / f64::from(1 << level))?;
        }
        if self.is_tight(a) {
            let ids = self.tree.boxes[a].ids.clone();
            for k in ids.clone() {
                self.union.join(self.tree.ids[ids.start] as usize, self.tree.ids[k] as usize);
            }
        } else if let Some([lower, upper]) = self.tree.boxes[a].halves {
            self.within(lower, level + 1, 2 * index)?;
            self.within(upper, level + 1, 2 * index + 1)?;
            self.between(lower, upper);
        } else {
            self.join_pairs(a, a);
        }
        Ok(())
    }

    /// Joins what is near between two boxes that share no point.
    fn between(&mut self, a: usize, b: usize) {
        if self.gap(a, b) > self.square {
            return;
        }
        let (tight_a, tight_b) = (self.is_tight(a), self.is_tight(b));
        if tight_a && tight_b {
            // Each is one vertex already: a single near pair joins them.
            let first = |x: usize| self.tree.ids[self.tree.boxes[x].ids.start] as usize;
            let (v, w) = (first(a), first(b));
            if self.union.find(v) != self.union.find(w) && self.has_near_pair(a, b) {
                self.union.join(v, w);
            }
            return;
        }
        // The larger one is halved, but a tight one only when it must be.
        let size = |x: usize| self.tree.boxes[x].ids.len();
        let prefer_a = if tight_a == tight_b { size(a) >= size(b) } else { tight_b };
        match (self.tree.boxes[a].halves, self.tree.boxes[b].halves) {
            (Some([c, d]), other) if prefer_a || other.is_none() => {
                self.between(c, b);
                self.between(d, b);
            }
            (_, Some([c, d])) => {
                self.between(a, c);
                self.between(a, d);
            }
            _ => self.join_pairs(a, b),
        }
    }

    /// Whether a point of one box is near one of the other.
    fn has_near_pair(&self, a: usize, b: usize) -> bool {
        if self.gap(a, b) > self.square {
            return false;
        }
        let size = |x: usize| self.tree.boxes[x].ids.len();
        match (self.tree.boxes[a].halves, self.tree.boxes[b].halves) {
            (Some([c, d]), other) if size(a) >= size(b) || other.is_none() => {
                self.has_near_pair(c, b) || self.has_near_pair(d, b)
            }
            (_, Some([c, d])) => self.has_near_pair(a, c) || self.has_near_pair(a, d),
            _ => self.pairs(a, b).any(|(v, w)| self.is_near(v, w)),
        }
    }

    fn join_pairs(&mut self, a: usize, b: usize) {
        let near: Vec<_> = self.pairs(a, b).filter(|&(v, w)| self.is_near(v, w)).collect();
        for (v, w) in near {
            self.union.join(v, w);
        }
    }

    fn pairs(&self, a: usize, b: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let ids = |x: usize| self.tree.ids[self.tree.boxes[x].ids.clone()].iter();
        ids(a).flat_map(move |&v| ids(b).map(move |&w| (v as usize, w as usize)))
    }

    fn is_near(&self, v: usize, w: usize) -> bool {
        self.points[v].distance_squared(self.points[w]) <= self.square
    }

    /// Whether all points of a box are near each other.
    fn is_tight(&self, a: usize) -> bool {
        let Cell { min, max, .. } = self.tree.boxes[a];
        (max - min).length_squared() <= self.square
    }

    /// The square of the distance between two boxes.
    fn gap(&self, a: usize, b: usize) -> f64 {
        let (a, b) = (&self.tree.boxes[a], &self.tree.boxes[b]);
        (a.min - b.max).max(b.min - a.max).max(DVec3::ZERO).length_squared()
    }
}
