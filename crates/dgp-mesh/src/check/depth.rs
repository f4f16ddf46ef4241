//! Whether an odd number of closed surfaces surround a point.
//!
//! A ray from the point along +x crosses them an odd number of times. Seen along the ray, the point lies
//! in a triangle or not by the parity of edges beside it, counted half-open and decided exactly, so that
//! a ray through an edge or a vertex counts once. Triangles are found by a tree of rectangles.
//!
//! - Input: closed surfaces of triangles, and points on none of them.
//! - Cost: O(n log n) for the tree, O(log n + hits) for a point.
//! - Reference: Shewchuk 1997 for the predicates; the half-open rule is folklore.

use std::ops::Range;

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Rectangles in a leaf of the tree.
const LEAF: usize = 8;

/// Rectangles in the plane of y and z, to be found by a point in them.
pub(super) struct Rectangles {
    ids: Vec<u32>,
    /// Corners of the rectangles by id, x ignored.
    corners: Vec<(DVec3, DVec3)>,
    nodes: Vec<Node>,
}

struct Node {
    min: DVec3,
    max: DVec3,
    ids: Range<usize>,
    halves: Option<[usize; 2]>,
}

impl Rectangles {
    pub(super) fn new(corners: Vec<(DVec3, DVec3)>) -> Self {
        let ids: Vec<u32> = (0..corners.len() as u32).collect();
        let mut tree = Rectangles { ids, corners, nodes: Vec::new() };
        tree.add(0..tree.ids.len());
        tree
    }

    fn add(&mut self, range: Range<usize>) -> usize {
        let ids = &mut self.ids[range.clone()];
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = ids.iter().fold(start, |(min, max), &i| {
            let (low, high) = self.corners[i as usize];
            (min.min(low), max.max(high))
        });
        let number = self.nodes.len();
        self.nodes.push(Node { min, max, ids: range.clone(), halves: None });
        if range.len() > LEAF {
            let axis = if max.y - min.y > max.z - min.z { 1 } else { 2 };
            let key = |i: u32| {
                let (low, high) = self.corners[i as usize];
                low[axis].midpoint(high[axis])
            };
            let middle = range.len() / 2;
            ids.select_nth_unstable_by(middle, |&i, &j| key(i).total_cmp(&key(j)).then(i.cmp(&j)));
            let middle = range.start + middle;
            let halves = [self.add(range.start..middle), self.add(middle..range.end)];
            self.nodes[number].halves = Some(halves);
        }
        number
    }

    /// Visits all rectangles with `point` in them or on their rim.
    pub(super) fn at(&self, point: DVec3, mut visit: impl FnMut(usize)) {
        let within = |min: DVec3, max: DVec3| {
            min.y <= point.y && point.y <= max.y && min.z <= point.z && point.z <= max.z
        };
        let mut stack = vec![0];
        while let Some(n) = stack.pop() {
            let node = &self.nodes[n];
            if !within(node.min, node.max) {
                continue;
            }
            if let Some(halves) = node.halves {
                stack.extend(halves);
                continue;
            }
            for &i in &self.ids[node.ids.clone()] {
                let (min, max) = self.corners[i as usize];
                if within(min, max) {
                    visit(i as usize);
                }
            }
        }
    }
}

/// Whether the ray from `point` along +x crosses the triangle.
pub(super) fn crosses(point: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let flat = |p: DVec3| Coord { x: p.y, y: p.z };
    let beside = |p: DVec3, q: DVec3| {
        let (low, high) = if p.z < q.z { (p, q) } else { (q, p) };
        low.z <= point.z && point.z < high.z && orient2d(flat(low), flat(high), flat(point)) > 0.0
    };
    let is_in = beside(a, b) ^ beside(b, c) ^ beside(c, a);
    if !is_in {
        return false;
    }
    let solid = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let side = orient3d(solid(a), solid(b), solid(c), solid(point));
    side * orient2d(flat(a), flat(b), flat(c)).signum() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often rays from `point` cross an octahedron around the origin.
    fn crossings(point: DVec3) -> usize {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut count = 0;
        for signs in 0..8 {
            let sign = |k: u32| if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
            let corners = [sign(0) * x, sign(1) * y, sign(2) * z];
            count += usize::from(crosses(point, corners));
        }
        count
    }

    #[test]
    fn rays_through_edges_and_vertices_count_once() {
        for (point, expected) in [
            (DVec3::ZERO, 1),
            (DVec3::new(-0.1, 0.2, 0.0), 1),
            (DVec3::new(0.1, 0.0, 0.2), 1),
            (DVec3::new(0.1, 0.2, 0.3), 1),
            (DVec3::new(-3.0, 0.0, 0.0), 2),
            (DVec3::new(-3.0, 0.2, 0.3), 2),
            (DVec3::new(3.0, 0.0, 0.0), 0),
            (DVec3::new(0.0, 2.0, 0.0), 0),
        ] {
            assert_eq!(crossings(point), expected, "{point}");
        }
    }

    #[test]
    fn the_tree_finds_what_trying_all_finds() {
        let at = |i: usize| DVec3::new(0.0, (i * 7 % 31) as f64, (i * 11 % 29) as f64);
        let corners: Vec<_> = (0..200).map(|i| (at(i), at(i) + (i % 5) as f64)).collect();
        let tree = Rectangles::new(corners.clone());
        for i in 0..200 {
            let point = at(i + 50) + 0.5;
            let mut found = Vec::new();
            tree.at(point, |j| found.push(j));
            found.sort_unstable();
            let all = (0..200).filter(|&j| {
                let (min, max) = corners[j];
                (min.y..=max.y).contains(&point.y) && (min.z..=max.z).contains(&point.z)
            });
            assert_eq!(found, all.collect::<Vec<_>>());
        }
    }
}
