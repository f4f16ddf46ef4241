//! Triangles that span a closed polygon in space, by dynamic programming.
//!
//! The best triangulation of the part between vertices i and k is that of a triangle (i, m, k) and the
//! best ones of the parts i…m and m…k:
//!
//! ```text
//! w[i, k] = min over m of  w[i, m] + w[m, k] + w(i, m, k)
//! ```
//!
//! where a weight is the largest bend at an edge, then the area, then the squared lengths of sides,
//! compared in this order. Bends and areas are counted in small steps, so that on a flat hole, where
//! all triangulations bend and cover the same, the shortest edges win and not the rounding errors.
//!
//! - Input: a closed chain of at least three vertices.
//! - Cost: O(n³) up to [`DYNAMIC`] vertices. Longer rims are first cut down to that by taking off the
//!   ears with the shortest diagonals, O(n log n).
//! - Reference: Barequet & Sharir, "Filling gaps in the boundary of a polyhedron", CAGD 1995; Liepa,
//!   "Filling holes in meshes", SGP 2003, for the bends.

use std::{
    cmp::Reverse,
    collections::{BTreeSet, BinaryHeap},
};

use glam::DVec3;

use super::separate::direction;

/// Rims up to this length are filled in the best way: 1.3 million triangles are tried.
const DYNAMIC: usize = 200;

/// Steps per radian in which bends are compared.
const BEND_STEPS: f64 = 1e5;

/// Steps in which areas are compared, relative to the square of the size of the hole.
const AREA_STEPS: f64 = 1e9;

/// How bad a triangulation is.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Weight {
    bend: u32,
    area: u64,
    lengths: f64,
}

impl Weight {
    const NONE: Weight = Weight { bend: 0, area: 0, lengths: 0.0 };
    const IMPOSSIBLE: Weight = Weight { bend: u32::MAX, area: u64::MAX, lengths: f64::INFINITY };

    fn and(self, other: Weight) -> Weight {
        if self.bend.max(other.bend) == u32::MAX {
            return Weight::IMPOSSIBLE;
        }
        Weight {
            bend: self.bend.max(other.bend),
            area: self.area.saturating_add(other.area),
            lengths: self.lengths + other.lengths,
        }
    }
}

/// Triangles that span the polygon, in its sense of rotation, none of whose inner edges joins two
/// vertices that are `joined` already. `outside[k]` is the normal of the face beyond edge k, k + 1.
pub(super) fn triangulate(
    points: &[DVec3],
    outside: &[Option<DVec3>],
    joined: &BTreeSet<(usize, usize)>,
) -> Option<Vec<[usize; 3]>> {
    let mut triangles = Vec::new();
    let rim = cut_ears(points, outside, joined, &mut triangles)?;
    let table = Table::new(points, &rim, joined);
    table.collect(0, rim.len() - 1, &mut triangles).then_some(triangles)
}

/// A vertex of the rim, and the normal beyond the edge from it to the next one.
type Rim = Vec<(usize, Option<DVec3>)>;

/// Takes ears off until few enough vertices are left.
fn cut_ears(
    points: &[DVec3],
    outside: &[Option<DVec3>],
    joined: &BTreeSet<(usize, usize)>,
    triangles: &mut Vec<[usize; 3]>,
) -> Option<Rim> {
    let n = points.len();
    let mut left = n;
    let mut beyond = outside.to_vec();
    let mut next: Vec<usize> = (0..n).map(|i| (i + 1) % n).collect();
    let mut prev: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
    let mut stays = vec![true; n];
    let mut heap = BinaryHeap::new();
    // Lengths are not negative, so their bits are ordered like them.
    let ear = |i: usize, a: usize, b: usize| {
        Reverse((points[a].distance_squared(points[b]).to_bits(), i, a, b))
    };
    if n > DYNAMIC {
        heap.extend((0..n).map(|i| ear(i, prev[i], next[i])));
    }
    while left > DYNAMIC {
        let Reverse((_, i, a, b)) = heap.pop()?;
        // Skips ears whose neighbors are no longer these, and edges that exist.
        if !stays[i] || prev[i] != a || next[i] != b || joined.contains(&(a.min(b), a.max(b))) {
            continue;
        }
        triangles.push([a, i, b]);
        stays[i] = false;
        left -= 1;
        (next[a], prev[b]) = (b, a);
        beyond[a] = normal(points, [a, i, b]);
        heap.extend([ear(a, prev[a], b), ear(b, a, next[b])]);
    }
    Some((0..n).filter(|&i| stays[i]).map(|i| (i, beyond[i])).collect())
}

/// The best triangulations of all parts of a rim.
struct Table<'a> {
    rim: &'a Rim,
    weights: Vec<Weight>,
    /// The vertex between the ends of each part.
    middles: Vec<usize>,
    /// The normal of the triangle at the edge between the ends of each part.
    normals: Vec<Option<DVec3>>,
}

impl<'a> Table<'a> {
    fn new(points: &[DVec3], rim: &'a Rim, joined: &BTreeSet<(usize, usize)>) -> Self {
        let n = rim.len();
        let mut table = Table {
            rim,
            weights: vec![Weight::NONE; n * n],
            middles: vec![0; n * n],
            normals: vec![None; n * n],
        };
        for (i, &(_, beyond)) in rim[..n - 1].iter().enumerate() {
            table.normals[i * n + i + 1] = beyond;
        }
        for length in 2..n {
            for i in 0..n - length {
                table.solve(points, joined, i, i + length);
            }
        }
        table
    }

    fn solve(&mut self, points: &[DVec3], joined: &BTreeSet<(usize, usize)>, i: usize, k: usize) {
        let n = self.rim.len();
        let (a, c) = (self.rim[i].0, self.rim[k].0);
        let whole = (i, k) == (0, n - 1);
        let mut best = (Weight::IMPOSSIBLE, 0, None);
        if whole || !joined.contains(&(a, c)) {
            for m in i + 1..k {
                let parts = self.weights[i * n + m].and(self.weights[m * n + k]);
                if parts >= best.0 {
                    continue;
                }
                let triangle = [a, self.rim[m].0, c];
                let own = normal(points, triangle);
                let mut bend = bend_of(own, self.normals[i * n + m])
                    .max(bend_of(own, self.normals[m * n + k]));
                if whole {
                    bend = bend.max(bend_of(own, self.rim[k].1));
                }
                let weight = parts.and(size(points, triangle, bend));
                if weight < best.0 {
                    best = (weight, m, own);
                }
            }
        }
        let place = i * n + k;
        (self.weights[place], self.middles[place], self.normals[place]) = best;
    }

    /// Adds the triangles of the part i…k; returns false if there are none.
    fn collect(&self, i: usize, k: usize, triangles: &mut Vec<[usize; 3]>) -> bool {
        let n = self.rim.len();
        if self.weights[i * n + k] == Weight::IMPOSSIBLE {
            return false;
        }
        let mut parts = vec![(i, k)];
        while let Some((i, k)) = parts.pop() {
            if k > i + 1 {
                let m = self.middles[i * n + k];
                triangles.push([i, m, k].map(|place| self.rim[place].0));
                parts.extend([(i, m), (m, k)]);
            }
        }
        true
    }
}

fn normal(points: &[DVec3], [a, b, c]: [usize; 3]) -> Option<DVec3> {
    direction((points[b] - points[a]).cross(points[c] - points[a]))
}

/// The angle between two faces in steps; a flat one counts as folded over.
fn bend_of(a: Option<DVec3>, b: Option<DVec3>) -> u32 {
    let angle = match (a, b) {
        (Some(a), Some(b)) => a.dot(b).clamp(-1.0, 1.0).acos(),
        _ => std::f64::consts::PI,
    };
    (angle * BEND_STEPS).round() as u32
}

fn size(points: &[DVec3], [a, b, c]: [usize; 3], bend: u32) -> Weight {
    let (a, b, c) = (points[a], points[b], points[c]);
    let area = 0.5 * (b - a).cross(c - a).length();
    let lengths = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    Weight { bend, area: (area * AREA_STEPS).round() as u64, lengths }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn ring(n: usize) -> Vec<DVec3> {
        let at = |i: usize| TAU * i as f64 / n as f64;
        (0..n).map(|i| DVec3::new(at(i).cos(), at(i).sin(), 0.0)).collect()
    }

    fn area(points: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let part = |&[a, b, c]: &[usize; 3]| (points[b] - points[a]).cross(points[c] - points[a]).z;
        triangles.iter().map(part).sum::<f64>() / 2.0
    }

    #[test]
    fn flat_rims_of_any_length_are_covered_once() {
        for n in [3, 4, 7, 150, 201, 1000] {
            let points = ring(n);
            let beyond = vec![Some(DVec3::Z); n];
            let triangles = triangulate(&points, &beyond, &BTreeSet::new()).unwrap();
            assert_eq!(triangles.len(), n - 2);
            let exact = n as f64 / 2.0 * (TAU / n as f64).sin();
            assert!((area(&points, &triangles) - exact).abs() < 1e-12, "{n}");
        }
    }

    #[test]
    fn a_dent_is_not_covered_from_outside() {
        // An arrowhead: only the diagonal from the dent to the tip stays within.
        let points =
            [[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let triangles = triangulate(&points, &[Some(DVec3::Z); 4], &BTreeSet::new()).unwrap();
        assert!(triangles.iter().all(|t| t.contains(&0) && t.contains(&2)), "{triangles:?}");
    }

    #[test]
    fn edges_that_exist_are_not_used_again() {
        let points = ring(4);
        let joined: BTreeSet<_> = [(0, 2)].into();
        let triangles = triangulate(&points, &[None; 4], &joined).unwrap();
        assert!(triangles.iter().all(|t| t.contains(&1) && t.contains(&3)), "{triangles:?}");
        assert_eq!(triangulate(&points, &[None; 4], &[(0, 2), (1, 3)].into()), None);
    }
}
