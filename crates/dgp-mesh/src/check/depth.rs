//! Whether an odd number of closed surfaces surround a point.
//!
//! A ray from the point along +x crosses them an odd number of times. Seen along the ray, the point lies
//! in a triangle or not by the parity of edges beside it, counted half-open and decided exactly, so that
//! a ray through an edge or a vertex counts once.
//!
//! ```text
//! triangles all beyond the point in x   the point is in an odd number of them if it has an odd number
//!                                       of their edges beside it; an edge of two of them cancels
//! edges all beyond the point in y       an odd number of them is beside it if an odd number of their
//!                                       ends is above it
//! ```
//!
//! So a group that does not mix with the points costs what its rim costs, however many surfaces it is
//! made of. Groups are halved until they do not mix, or few points ask.
//!
//! - Input: triangles, and points on none of them.
//! - Cost: O(n) for few points; O(n log² n) for n triangles and points where triangles are small beside
//!   the gaps between surfaces; O(n²) at worst.
//! - Guarantees: the parity that all triangles have one by one, for triangles that touch or cross too.
//! - Reference: Shewchuk 1997 for the predicates; Jacobson, Kavan and Sorkine-Hornung, "Robust
//!   inside-outside segmentation using generalized winding numbers", 2013, where triangles far away
//!   are replaced by what has the same rim; the half-open rule is folklore.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::{VertexId, VertexMap};

/// So many points or triangles are asked one by one: each takes some nanoseconds, and a tenth of what
/// sorting the edges of a triangle takes.
const FEW: usize = 24;

/// Whether the rays from each of `points` along +x cross an odd number of `triangles`, whose order
/// changes. Coordinates must be such that their products neither overflow nor vanish.
pub(super) fn odd_crossings(
    points: &[DVec3],
    corners: &VertexMap<DVec3>,
    triangles: &mut [[VertexId; 3]],
) -> Vec<bool> {
    let mut crossings = Crossings { points, corners, odd: vec![false; points.len()] };
    crossings.with_triangles((0..points.len() as u32).collect(), triangles);
    crossings.odd
}

struct Crossings<'a> {
    points: &'a [DVec3],
    corners: &'a VertexMap<DVec3>,
    odd: Vec<bool>,
}

impl Crossings<'_> {
    /// Counts the triangles that the rays from `asking` cross.
    fn with_triangles(&mut self, mut asking: Vec<u32>, triangles: &mut [[VertexId; 3]]) {
        if asking.len().min(triangles.len()) <= FEW {
            for i in asking {
                let point = self.points[i as usize];
                let crossed =
                    |corners: &&[VertexId; 3]| crosses(point, corners.map(|v| self.corners[v]));
                self.odd[i as usize] ^= triangles.iter().filter(crossed).count() % 2 == 1;
            }
            return;
        }
        let (min, max) = self.bounds(triangles.as_flattened());
        asking.retain(|&i| {
            let p = self.points[i as usize];
            p.x < max.x && min.y <= p.y && p.y < max.y && min.z <= p.z && p.z < max.z
        });
        let beyond = asking.extract_if(.., |&mut i| self.points[i as usize].x < min.x).collect();
        self.with_rim(beyond, triangles);
        if asking.is_empty() {
            return;
        }
        let axis = (max - min).max_position();
        let center =
            |corners: &[VertexId; 3]| corners.iter().map(|&v| self.corners[v][axis]).sum::<f64>();
        let middle = triangles.len() / 2;
        triangles.select_nth_unstable_by(middle, |s, t| center(s).total_cmp(&center(t)));
        let (low, high) = triangles.split_at_mut(middle);
        self.with_triangles(asking.clone(), low);
        self.with_triangles(asking, high);
    }

    /// Counts the triangles that the rays from `asking` cross, all of which lie beyond these points.
    fn with_rim(&mut self, asking: Vec<u32>, triangles: &[[VertexId; 3]]) {
        if asking.len() <= FEW {
            // Sorting would take longer.
            for i in asking {
                let point = self.points[i as usize];
                let is_around =
                    |corners: &&[VertexId; 3]| is_in(point, corners.map(|v| self.corners[v]));
                self.odd[i as usize] ^= triangles.iter().filter(is_around).count() % 2 == 1;
            }
            return;
        }
        let sides = |&[a, b, c]: &[VertexId; 3]| [[a, b], [b, c], [c, a]];
        let edges = triangles.iter().flat_map(sides).map(|[v, w]| [v.min(w), v.max(w)]);
        let mut rim = odd_ones(edges.collect());
        self.with_edges(asking, &mut rim);
    }

    /// Counts the edges that the points `asking` have beside them.
    fn with_edges(&mut self, mut asking: Vec<u32>, edges: &mut [[VertexId; 2]]) {
        if asking.len().min(edges.len()) <= FEW {
            for i in asking {
                let point = self.points[i as usize];
                let counts =
                    |ends: &&[VertexId; 2]| is_beside(point, ends.map(|v| self.corners[v]));
                self.odd[i as usize] ^= edges.iter().filter(counts).count() % 2 == 1;
            }
            return;
        }
        let (min, max) = self.bounds(edges.as_flattened());
        asking.retain(|&i| {
            let p = self.points[i as usize];
            p.y < max.y && min.z <= p.z && p.z < max.z
        });
        let beyond = asking.extract_if(.., |&mut i| self.points[i as usize].y < min.y).collect();
        self.with_ends(beyond, edges.as_flattened());
        if asking.is_empty() {
            return;
        }
        let axis = if max.y - min.y > max.z - min.z { 1 } else { 2 };
        let center = |[v, w]: [VertexId; 2]| self.corners[v][axis] + self.corners[w][axis];
        let middle = edges.len() / 2;
        edges.select_nth_unstable_by(middle, |&d, &e| center(d).total_cmp(&center(e)));
        let (low, high) = edges.split_at_mut(middle);
        self.with_edges(asking.clone(), low);
        self.with_edges(asking, high);
    }

    /// Counts the edges with these ends that the points `asking` have beside them, all of which lie
    /// beyond these points.
    fn with_ends(&mut self, asking: Vec<u32>, ends: &[VertexId]) {
        if asking.is_empty() {
            return;
        }
        let mut heights: Vec<f64> = ends.iter().map(|&v| self.corners[v].z).collect();
        heights.sort_unstable_by(f64::total_cmp);
        for i in asking {
            let z = self.points[i as usize].z;
            let below = heights.partition_point(|&height| height <= z);
            self.odd[i as usize] ^= (heights.len() - below) % 2 == 1;
        }
    }

    fn bounds(&self, corners: &[VertexId]) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        corners
            .iter()
            .map(|&v| self.corners[v])
            .fold(start, |(min, max), p| (min.min(p), max.max(p)))
    }
}

/// Those that occur an odd number of times, each once.
fn odd_ones(mut edges: Vec<[VertexId; 2]>) -> Vec<[VertexId; 2]> {
    edges.sort_unstable();
    edges.chunk_by(|d, e| d == e).filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect()
}

/// Whether the ray from `point` along +x crosses the triangle.
fn crosses(point: DVec3, triangle: [DVec3; 3]) -> bool {
    if !is_in(point, triangle) {
        return false;
    }
    let [a, b, c] = triangle;
    let solid = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let side = orient3d(solid(a), solid(b), solid(c), solid(point));
    side * orient2d(flat(a), flat(b), flat(c)).signum() > 0.0
}

/// Whether `point` is in the triangle, seen along x.
fn is_in(point: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    is_beside(point, [a, b]) ^ is_beside(point, [b, c]) ^ is_beside(point, [c, a])
}

/// Whether the ray from `point` along +y crosses the edge, seen along x.
fn is_beside(point: DVec3, [p, q]: [DVec3; 2]) -> bool {
    let (low, high) = if p.z < q.z { (p, q) } else { (q, p) };
    low.z <= point.z && point.z < high.z && orient2d(flat(low), flat(high), flat(point)) > 0.0
}

fn flat(p: DVec3) -> Coord<f64> {
    Coord { x: p.y, y: p.z }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

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

    proptest! {
        /// On a small grid most points are level with corners, on edges or on triangles.
        #[test]
        fn all_at_once_count_what_each_counts_alone(
            corners in prop::collection::vec(prop::array::uniform3(0_u8..6), 40..80),
            faces in prop::collection::vec(prop::array::uniform3(0_usize..40), 300..600),
            points in prop::collection::vec(prop::array::uniform3(-1_i8..12), 200..400),
        ) {
            let corners: Vec<DVec3> =
                corners.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
            let corners = VertexMap::from(corners);
            let points: Vec<DVec3> =
                points.iter().map(|p| DVec3::from(p.map(|x| f64::from(x) / 2.0))).collect();
            let mut faces: Vec<_> = faces.iter().map(|face| face.map(VertexId::new)).collect();
            let alone = points.iter().map(|&point| {
                faces.iter().filter(|face| crosses(point, face.map(|v| corners[v]))).count() % 2 == 1
            });
            let alone: Vec<bool> = alone.collect();
            prop_assert!(alone.contains(&true) && alone.contains(&false));
            prop_assert_eq!(odd_crossings(&points, &corners, &mut faces), alone);
        }
    }
}
