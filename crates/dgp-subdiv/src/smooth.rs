//! Values of the next level where nothing but rims is sharp: the rules of [`primal`](crate::primal) without
//! rows being written down.
//!
//! The first step reads the cage. Each later one refines a level that is itself a split, so what stands
//! around an edge or a new vertex is known from the level before, which is a quarter as large: of a triangle
//! and the middles of its sides, say. Only around the vertices of that level is there anything to walk.
//!
//! ```text
//!        ●            row of              reads
//!       ╱ ╲           old vertex v        the middles of its edges
//!      ○───○          middle of an edge   the ends, the middles of the other sides of its two triangles
//!     ╱ ╲ ╱ ╲         half of a side      the end, the middle, one other side of each triangle
//!    ●───○───●        inner edge          the three middles of its triangle and a corner
//! ```
//!
//! - Input: a level without creases, of triangles where they are split.
//! - Cost: O(corners), in parallel; each value is written once.
//! - Guarantees: the same bits for any number of threads.

use dgp_mesh::{VertexId, parallel};

use crate::{
    masks::Value,
    primal::{COMMON, Kind},
    topology::{Corners, Every, NONE, Starts, Topology},
};

/// The new values: old vertices, edges, faces (where the scheme splits polygons). `before` is the level
/// before `topology`, if that is a split.
pub(crate) fn refined<T: Value>(
    before: Option<&Topology>,
    topology: &Topology,
    kind: Kind,
    old: &[T],
) -> Vec<T> {
    let mut common = [[0.0; 3]; COMMON];
    for (valence, mask) in common.iter_mut().enumerate().skip(1) {
        *mask = kind.smooth_vertex(valence);
    }
    let read = before.unwrap_or(topology);
    let rules = Rules { topology: read, kind, common, old };
    match (before, kind, &read.starts) {
        (None, Kind::Loop(_), _) => rules.triangles(),
        (Some(_), Kind::Loop(_), _) => rules.split_triangles(),
        (_, Kind::Bilinear, _) => Rules { topology, ..rules }.bilinear(),
        (None, _, Starts::Every(3)) => rules.polygons(&Every::<3>),
        (None, _, Starts::Every(4)) => rules.polygons(&Every::<4>),
        (None, ..) => rules.polygons(read),
        (Some(_), _, Starts::Every(3)) => rules.split_polygons(&Every::<3>),
        (Some(_), _, Starts::Every(4)) => rules.split_polygons(&Every::<4>),
        (Some(_), ..) => rules.split_polygons(read),
    }
}

/// What rows are made of.
struct Rules<'a, T> {
    /// The level that is refined, or the one before it.
    topology: &'a Topology,
    kind: Kind,
    /// Masks of smooth vertices by valence.
    common: [[f64; 3]; COMMON],
    old: &'a [T],
}

fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    parallel::map(count, |i: VertexId| f(i.index())).into_values()
}

/// A point at a rim: its neighbors along it count an eighth each.
#[inline]
fn rim<T: Value>(point: T, ends: T) -> T {
    point * 0.75 + ends * 0.125
}

impl<T: Value> Rules<'_, T> {
    #[inline]
    fn at(&self, vertex: u32) -> T {
        self.old[vertex as usize]
    }

    /// A smooth vertex, given the sums of its neighbors and of the means of its faces.
    #[inline]
    fn smooth(&self, point: T, valence: usize, neighbors: T, means: T) -> T {
        let common = self.common.get(valence).copied();
        let mask = common.unwrap_or_else(|| self.kind.smooth_vertex(valence));
        let sum = point * mask[0] + neighbors * mask[1];
        if self.kind.splits_polygons() { sum + means * mask[2] } else { sum }
    }

    /// A vertex of the level read, given what its spokes lead to and the mean of the face at a corner.
    #[inline]
    fn vertex(
        &self,
        corners: &impl Corners,
        v: usize,
        end: impl Fn(u32) -> T,
        mean: impl Fn(u32) -> T,
    ) -> T {
        let topology = self.topology;
        let first = topology.vertex_halfedge[v];
        let (mut spoke, mut valence) = (first, 0);
        let (mut neighbors, mut means) = (T::default(), T::default());
        loop {
            let corner = topology.corner(spoke);
            if corner == NONE {
                // The last one beside a hole, which the first begins beside.
                return rim(self.old[v], end(first) + end(spoke));
            }
            neighbors = neighbors + end(spoke);
            means = means + mean(corner);
            valence += 1;
            spoke = topology.corner_halfedge[corners.preceding(corner) as usize] ^ 1;
            if spoke == first {
                return self.smooth(self.old[v], valence, neighbors, means);
            }
        }
    }

    /// A smooth edge, given the sum of its ends and of what is across or the means of its faces.
    #[inline]
    fn edge(&self, ends: T, sides: T) -> T {
        let [end, side] = self.kind.smooth_edge();
        ends * end + sides * side
    }

    /// The corners where the half-edges of an edge start, or the sum of its ends at a rim.
    #[inline]
    fn sides(&self, e: u32) -> Result<[u32; 2], T> {
        let topology = self.topology;
        let corners = [topology.corner(2 * e), topology.corner(2 * e + 1)];
        if corners.contains(&NONE) {
            return Err(self.at(topology.from(2 * e)) + self.at(topology.to(2 * e)));
        }
        Ok(corners)
    }

    fn bilinear(&self) -> Vec<T> {
        let topology = self.topology;
        let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
        map(vertices + edges + topology.face_count(), |row| {
            if row < vertices {
                self.old[row]
            } else if row < vertices + edges {
                let h = 2 * (row - vertices) as u32;
                (self.at(topology.from(h)) + self.at(topology.to(h))) * 0.5
            } else {
                self.mean((row - vertices - edges) as u32)
            }
        })
    }

    /// The mean of a face of the level read.
    #[inline]
    fn mean(&self, f: u32) -> T {
        let corners = self.topology.corners(f);
        let weight = 1.0 / corners.len() as f64;
        corners.fold(T::default(), |sum, c| sum + self.at(self.topology.vertex(c)) * weight)
    }

    fn triangles(&self) -> Vec<T> {
        let (topology, corners) = (self.topology, &Every::<3>);
        let vertices = topology.vertex_count();
        map(vertices + topology.edge_count(), |row| {
            if row < vertices {
                return self.vertex(corners, row, |h| self.at(topology.to(h)), |_| T::default());
            }
            match self.sides((row - vertices) as u32) {
                Err(ends) => ends * 0.5,
                Ok([c, d]) => {
                    let across = |c: u32| self.at(topology.vertex(corners.preceding(c)));
                    let ends = self.at(topology.vertex(c)) + self.at(topology.vertex(d));
                    self.edge(ends, across(c) + across(d))
                }
            }
        })
    }

    fn split_triangles(&self) -> Vec<T> {
        let (topology, corners) = (self.topology, &Every::<3>);
        let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
        let (points, halves) = (vertices + edges, 2 * edges);
        let middle = |e: u32| self.old[vertices + e as usize];
        let side = |c: u32| middle(topology.edge(c));
        map(points + halves + topology.corner_count(), |row| {
            if row < vertices {
                self.vertex(corners, row, |h| middle(h >> 1), |_| T::default())
            } else if row < points {
                let e = (row - vertices) as u32;
                let [c, d] = match self.sides(e) {
                    Err(ends) => return rim(middle(e), ends),
                    Ok(sides) => sides,
                };
                let ends = self.at(topology.vertex(c)) + self.at(topology.vertex(d));
                let left = side(corners.following(c)) + side(corners.preceding(c));
                let right = side(corners.following(d)) + side(corners.preceding(d));
                self.smooth(middle(e), 6, ends + (left + right), T::default())
            } else if row < points + halves {
                let h = (row - points) as u32;
                let (c, d) = (topology.corner(h), topology.corner(h ^ 1));
                if c == NONE || d == NONE {
                    return (self.at(topology.from(h)) + middle(h >> 1)) * 0.5;
                }
                let across = side(corners.preceding(c)) + side(corners.following(d));
                self.edge(self.at(topology.vertex(c)) + middle(h >> 1), across)
            } else {
                let c = (row - points - halves) as u32;
                let across = self.at(topology.vertex(c)) + side(corners.following(c));
                self.edge(side(c) + side(corners.preceding(c)), across)
            }
        })
    }

    fn polygons(&self, corners: &impl Corners) -> Vec<T> {
        let topology = self.topology;
        let vertices = topology.vertex_count();
        let points = vertices + topology.edge_count();
        let means = map(topology.face_count(), |f| self.mean(f as u32));
        let mean = |c: u32| means[corners.face(c) as usize];
        map(points + means.len(), |row| {
            if row < vertices {
                return self.vertex(corners, row, |h| self.at(topology.to(h)), mean);
            }
            if row >= points {
                return means[row - points];
            }
            match self.sides((row - vertices) as u32) {
                Err(ends) => ends * 0.5,
                Ok([c, d]) => {
                    let ends = self.at(topology.vertex(c)) + self.at(topology.vertex(d));
                    self.edge(ends, mean(c) + mean(d))
                }
            }
        })
    }

    fn split_polygons(&self, corners: &impl Corners) -> Vec<T> {
        let topology = self.topology;
        let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
        let (points, halves) = (vertices + edges + topology.face_count(), 2 * edges);
        let middle = |e: u32| self.old[vertices + e as usize];
        let side = |c: u32| middle(topology.edge(c));
        let center = |c: u32| self.old[vertices + edges + corners.face(c) as usize];
        let means = map(topology.corner_count(), |c| {
            let c = c as u32;
            let ends = self.at(topology.vertex(c)) + center(c);
            (ends + (side(c) + side(corners.preceding(c)))) * 0.25
        });
        let mean = |c: u32| means[c as usize];
        map(points + halves + 2 * means.len(), |row| {
            if row < vertices {
                self.vertex(corners, row, |h| middle(h >> 1), mean)
            } else if row < vertices + edges {
                let e = (row - vertices) as u32;
                let [c, d] = match self.sides(e) {
                    Err(ends) => return rim(middle(e), ends),
                    Ok(sides) => sides,
                };
                let ends = self.at(topology.vertex(c)) + self.at(topology.vertex(d));
                let left = mean(c) + mean(corners.following(c));
                let right = mean(d) + mean(corners.following(d));
                self.smooth(middle(e), 4, ends + (center(c) + center(d)), left + right)
            } else if row < points {
                let around = topology.corners((row - vertices - edges) as u32);
                let (mut neighbors, mut sum) = (T::default(), T::default());
                for c in around.clone() {
                    neighbors = neighbors + side(c);
                    sum = sum + mean(c);
                }
                self.smooth(self.old[row], around.len(), neighbors, sum)
            } else if row < points + halves {
                let h = (row - points) as u32;
                let (c, d) = (topology.corner(h), topology.corner(h ^ 1));
                if c == NONE || d == NONE {
                    return (self.at(topology.from(h)) + middle(h >> 1)) * 0.5;
                }
                let ends = self.at(topology.vertex(c)) + middle(h >> 1);
                self.edge(ends, mean(c) + mean(corners.following(d)))
            } else if row < points + halves + means.len() {
                let c = (row - points - halves) as u32;
                self.edge(side(c) + center(c), mean(c) + mean(corners.following(c)))
            } else {
                means[row - points - halves - means.len()]
            }
        })
    }
}
