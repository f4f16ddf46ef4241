//! The hierarchy over points, and how far two sets of points are apart.
//!
//! ```text
//! Chamfer distance = mean over a in A of min |a − b|  +  mean over b in B of min |b − a|
//! ```
//!
//! - Input: finite points, equal ones allowed.
//! - Cost: O(n log n) to build, some log n a question; many in parallel.
//! - Guarantees: of points at the same distance the first. The same bits for any number of threads.
//! - Reference: Fan, Su and Guibas, "A point set generation network for 3D object reconstruction from a
//!   single image", CVPR 2017 (Chamfer distance).
//! - Departs from it: both the mean of distances and that of their squares are given.

use glam::DVec3;

use super::{
    batch,
    build::{Item, build},
    frame::Frame,
    nodes::Nodes,
};
use crate::{
    Error, Progress, VertexId,
    measure::{BoundingBox, scale},
    parallel,
};

/// Points ordered so that those near a place are found fast. Points are known by their number.
#[derive(Clone, Debug)]
pub struct PointTree {
    pub(super) nodes: Nodes,
    /// Scaled, in order of the leaves; so are the numbers.
    pub(super) points: Vec<DVec3>,
    pub(super) numbers: Vec<u32>,
}

/// A point found by a [`PointTree`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearPoint {
    /// Which point, counted from 0.
    pub index: usize,
    /// How far it is.
    pub distance: f64,
}

impl PointTree {
    /// The tree of `points`.
    ///
    /// Errors: [`Error::NonFinitePoint`], [`Error::TooMany`].
    pub fn new(points: &[DVec3], progress: Progress<'_>) -> Result<Self, Error> {
        progress.report(0.0)?;
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(Error::NonFinitePoint { index });
        }
        if points.len() > crate::MAX_ELEMENTS {
            let (count, limit) = (points.len(), crate::MAX_ELEMENTS);
            return Err(Error::TooMany { kind: "points", count, limit });
        }
        let frame = Frame::of(BoundingBox::of_points(points.iter().copied()));
        let item = |v: VertexId| {
            let (lo, hi) = frame.rounded(frame.scaled(points[v.index()]));
            let wide = |x: [f32; 3]| [x[0], x[1], x[2], 0.0];
            Item { lo: wide(lo), hi: wide(hi), id: v.index() as u32 }
        };
        let mut items = parallel::map(points.len(), item).into_values();
        let nodes = build(&mut items);
        progress.report(0.9)?;
        let numbers: Vec<u32> = items.iter().map(|item| item.id).collect();
        let points = numbers.iter().map(|&i| frame.scaled(points[i as usize])).collect();
        progress.report(1.0)?;
        Ok(PointTree { nodes: Nodes { nodes, frame }, points, numbers })
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The nearest point; `None` if there are none or `p` is not finite.
    pub fn nearest(&self, p: DVec3) -> Option<NearPoint> {
        self.nearest_from(p, &mut None)
    }

    /// The `count` nearest points, nearest first; fewer if there are fewer, none if `p` is not finite.
    pub fn nearest_points(&self, p: DVec3, count: usize) -> Vec<NearPoint> {
        let q = self.nodes.frame.scaled(p);
        if count == 0 || !q.is_finite() {
            return Vec::new();
        }
        let mut best: Vec<(u64, u32)> = Vec::with_capacity(count.min(self.len()) + 1);
        self.nodes.near(q, f64::INFINITY, |items| {
            for i in items {
                let square = (self.points[i] - q).length_squared();
                let new = (square.to_bits(), self.numbers[i]);
                let place = best.partition_point(|b| *b < new);
                if place < count {
                    best.insert(place, new);
                    best.truncate(count);
                }
            }
            if best.len() < count { f64::INFINITY } else { f64::from_bits(best[count - 1].0) }
        });
        let found = |&(square, number): &(u64, u32)| NearPoint {
            index: number as usize,
            distance: f64::from_bits(square).sqrt() * self.nodes.frame.scale.up,
        };
        best.iter().map(found).collect()
    }

    /// The nearest point of the tree for each of `points`.
    ///
    /// Errors: [`Error::NonFinitePoint`], [`Error::Empty`] if the tree has no points.
    pub fn nearest_each(
        &self,
        points: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Vec<NearPoint>, Error> {
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(Error::NonFinitePoint { index });
        }
        if self.is_empty() {
            return Err(Error::Empty);
        }
        batch::ordered(&self.nodes.frame, points, progress, |i, last| {
            self.nearest_from(points[i], last).expect("there are points")
        })
    }

    /// The nearest point; `last` is the place of one that may be near, and then of the one found.
    fn nearest_from(&self, p: DVec3, last: &mut Option<usize>) -> Option<NearPoint> {
        let q = self.nodes.frame.scaled(p);
        if self.is_empty() || !p.is_finite() {
            return None;
        }
        if !(q.length_squared() < f64::MAX) {
            // So far away that squares overflow: whichever is nearest along the way there.
            let way = scale::unit(p);
            let key = |&i: &usize| self.points[i].dot(way);
            let far = (0..self.len()).max_by(|a, b| {
                key(a).total_cmp(&key(b)).then(self.numbers[*b].cmp(&self.numbers[*a]))
            })?;
            return Some(self.found(p, far));
        }
        let square_to = |i: usize| (self.points[i] - q).length_squared();
        let mut best = last.map_or((f64::INFINITY, usize::MAX), |i| (square_to(i), i));
        self.nodes.near(q, best.0, |items| {
            for i in items {
                let square = square_to(i);
                let is_first = |j: usize| j == usize::MAX || self.numbers[i] < self.numbers[j];
                if square < best.0 || (square == best.0 && is_first(best.1)) {
                    best = (square, i);
                }
            }
            best.0
        });
        *last = Some(best.1);
        Some(self.found(p, best.1))
    }

    fn found(&self, p: DVec3, i: usize) -> NearPoint {
        let point = self.points[i] * self.nodes.frame.scale.up;
        NearPoint { index: self.numbers[i] as usize, distance: scale::distance(p, point) }
    }
}

/// The mean distances between two sets of points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use]
pub struct Chamfer {
    /// The mean distance from a point of the first set to the second.
    pub forward: f64,
    /// The mean distance from a point of the second set to the first.
    pub backward: f64,
    /// The mean of the squared distances from the first to the second.
    pub forward_square: f64,
    /// The mean of the squared distances from the second to the first.
    pub backward_square: f64,
    /// The largest distance either way: the Hausdorff distance of the sets.
    pub largest: f64,
}

impl Chamfer {
    /// The Chamfer distance: the sum of both means.
    pub fn distance(&self) -> f64 {
        self.forward + self.backward
    }
}

/// How far two sets of points are apart.
///
/// Errors: [`Error::Empty`] if one is empty, [`Error::NonFinitePoint`].
pub fn chamfer(a: &[DVec3], b: &[DVec3], progress: Progress<'_>) -> Result<Chamfer, Error> {
    if a.is_empty() || b.is_empty() {
        return Err(Error::Empty);
    }
    let to_b = PointTree::new(b, progress.part(0.0, 0.1))?;
    let from_a = means(&to_b.nearest_each(a, progress.part(0.1, 0.5))?);
    let to_a = PointTree::new(a, progress.part(0.5, 0.6))?;
    let from_b = means(&to_a.nearest_each(b, progress.part(0.6, 1.0))?);
    Ok(Chamfer {
        forward: from_a[0],
        backward: from_b[0],
        forward_square: from_a[1],
        backward_square: from_b[1],
        largest: from_a[2].max(from_b[2]),
    })
}

/// The mean distance, the mean of squares, and the largest.
fn means(found: &[NearPoint]) -> [f64; 3] {
    let sums = parallel::reduce(
        found.len(),
        [0.0; 3],
        |v: VertexId| {
            let d = found[v.index()].distance;
            [d, d * d, d]
        },
        |a, b| [a[0] + b[0], a[1] + b[1], a[2].max(b[2])],
    );
    let count = found.len() as f64;
    [sums[0] / count, sums[1] / count, sums[2]]
}
