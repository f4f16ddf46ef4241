//! √3 subdivision: triangles into three, with the old edges flipped; two steps cut each edge into three.
//!
//! ```text
//! face     (p + q + r)/3
//! vertex   (1 − α) v + (α/d) Σ w        α = (4 − 2 cos 2π/d)/9
//!
//! rim, at every second step:   p₋ = (10 o + 16 v + w)/27   v′ = (4 o + 19 v + 4 w)/27
//!                              p₊ = (o + 16 v + 10 w)/27   o, w: the neighbors of v along the rim
//! ```
//!
//! At the other steps the rim stays as it is: its triangles only get a point inside. Then each of them has
//! just one edge at the rim, which the next step cuts in three in place of putting a point inside.
//!
//! The children of triangle f are numbered by its corners: child c has corner c and the side that starts there.
//! Edge e is flipped and keeps its number, as does the middle part of a rim; edge E + c leads from the vertex
//! of corner c to the point of its face. Where a rim is cut, the corner across is joined to both points; the
//! second of these edges comes after all others.
//!
//! - Input: triangles; no vertex inside with only two faces.
//! - Cost: O(F) per level, in parallel; nothing is searched.
//! - Guarantees: grows three times a level, in place of four; masks are convex.
//! - Reference: Kobbelt, "√3-subdivision", SIGGRAPH 2000.

use std::f64::consts::TAU;

use dgp_mesh::{Connectivity, FaceId, FaceList, HalfedgeArrays, HalfedgeId, VertexId, parallel};

use crate::{
    Counts,
    masks::{Masks, Means, Stencil, Value},
    primal::COMMON,
    topology::{NONE, Starts, Topology},
};

/// α, how far a vertex of `valence` edges moves toward the mean of its neighbors.
pub fn sqrt3_alpha(valence: usize) -> f64 {
    (4.0 - 2.0 * (TAU / valence as f64).cos()) / 9.0
}

/// The masks of a step.
pub(crate) struct Sqrt3<'a> {
    topology: &'a Topology,
    points: Points,
}

/// The new vertices, numbered after the old ones in the order of faces.
struct Points {
    cuts_rims: bool,
    /// The faces whose rim is cut, in order: they have two points, the others one.
    cut: Vec<u32>,
}

impl Points {
    fn new(topology: &Topology, step: usize) -> Self {
        let cuts_rims = step % 2 == 1;
        let has_rim = |&f: &u32| cuts_rims && rim_corner(topology, f).is_some();
        let cut = parallel::map_blocks(topology.face_count(), parallel::BLOCK, |block| {
            (block.start as u32..block.end as u32).filter(has_rim).collect::<Vec<u32>>()
        });
        Points { cuts_rims, cut: cut.concat() }
    }

    /// How many faces before `face` have a cut rim.
    #[inline]
    fn cuts_before(&self, face: u32) -> u32 {
        if self.cut.is_empty() { 0 } else { self.cut.partition_point(|&f| f < face) as u32 }
    }

    /// The point of a face, or the first of the two at its side at a rim that is cut.
    #[inline]
    fn of_face(&self, topology: &Topology, face: u32) -> u32 {
        topology.vertex_count() as u32 + face + self.cuts_before(face)
    }

    /// The face of a point, and whether it is the second one there.
    #[inline]
    fn face(&self, point: u32) -> (u32, bool) {
        let (mut low, mut high) = (0, self.cut.len());
        while low < high {
            let middle = low.midpoint(high);
            if self.cut[middle] + (middle as u32) < point {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        match low.checked_sub(1) {
            Some(last) if self.cut[last] + low as u32 == point => (self.cut[last], true),
            _ => (point - low as u32, false),
        }
    }

    fn count(&self, topology: &Topology) -> usize {
        topology.face_count() + self.cut.len()
    }

    /// The corner of `face` whose side is at a rim that is cut.
    #[inline]
    fn cut(&self, topology: &Topology, face: u32) -> Option<u32> {
        if self.cut.is_empty() { None } else { rim_corner(topology, face) }
    }

    /// What the face of a half-edge has on the far side of it: its point, or that nearest to the side.
    #[inline]
    fn apex(&self, topology: &Topology, halfedge: u32) -> u32 {
        let corner = topology.corner(halfedge);
        let face = topology.face(corner);
        let first = self.of_face(topology, face);
        match self.cut(topology, face) {
            // The side after the rim starts where the rim ends, near the second point.
            Some(rim) => first + u32::from(topology.next(rim) == corner),
            None => first,
        }
    }
}

/// The corner of `face` whose side is at a hole.
fn rim_corner(topology: &Topology, face: u32) -> Option<u32> {
    let at_hole = |&c: &u32| topology.corner(topology.corner_halfedge[c as usize] ^ 1) == NONE;
    topology.corners(face).find(at_hole)
}

fn map<T: Send>(count: usize, f: impl Fn(u32) -> T + Sync + Send) -> Vec<T> {
    parallel::map(count, |i: VertexId| f(i.index() as u32)).into_values()
}

/// The connectivity of the next level; its face c comes from that of corner c.
pub(crate) fn refined(topology: &Topology, step: usize) -> Topology {
    let links = Links { topology, points: Points::new(topology, step) };
    let halfedges = 2 * (topology.edge_count() + topology.corner_count() + links.points.cut.len());
    let corners = topology.corner_count();
    let vertices = topology.vertex_count() + links.points.count(topology);
    Topology {
        starts: Starts::Every(3),
        corner_vertex: map(corners, |c| links.vertices(c)).into_flattened(),
        corner_halfedge: map(corners, |c| links.sides(c)).into_flattened(),
        halfedge_corner: map(halfedges, |h| links.corner(h)),
        vertex_halfedge: map(vertices, |v| links.first(v)),
    }
}

/// How many elements the next level has.
pub(crate) fn counts(topology: &Topology, step: usize) -> Counts {
    let points = Points::new(topology, step);
    let corners = topology.corner_count();
    Counts {
        vertices: (topology.vertex_count() + points.count(topology)) as u64,
        edges: (topology.edge_count() + corners + points.cut.len()) as u64,
        corners: 3 * corners as u64,
        faces: corners as u64,
    }
}

/// The faces of the next level.
pub(crate) fn faces(topology: &Topology, step: usize) -> FaceList {
    let links = Links { topology, points: Points::new(topology, step) };
    let vertices = |c| links.vertices(c).map(|v| VertexId::new(v as usize));
    FaceList::from_corners(map(topology.corner_count(), vertices).into_flattened(), 3)
}

/// The next level as a mesh, with the numbers that [`refined`] gives.
pub(crate) fn connectivity(topology: &Topology, step: usize) -> Connectivity {
    let links = Links { topology, points: Points::new(topology, step) };
    let vertices = topology.vertex_count() + links.points.count(topology);
    let halfedge = |h: u32| HalfedgeId::new(h as usize);
    let face = |side: Side| (side.face != NONE).then(|| FaceId::new(side.face as usize));
    Connectivity::from_arrays(HalfedgeArrays {
        prev: links.each_side(|side| halfedge(side.prev)).into(),
        to: links.each_side(|side| VertexId::new(side.to as usize)).into(),
        face: links.each_side(face).into(),
        vertex_halfedge: map(vertices, |v| Some(halfedge(links.start(v)))).into(),
        face_halfedge: map(topology.corner_count(), |c| halfedge(links.sides(c)[0])).into(),
    })
}

/// What a mesh knows of a half-edge.
struct Side {
    prev: u32,
    to: u32,
    /// [`NONE`] at a hole.
    face: u32,
}

/// The numbers of what a step makes.
struct Links<'a> {
    topology: &'a Topology,
    points: Points,
}

impl Links<'_> {
    /// A value for each half-edge.
    fn each_side<T: Send>(&self, value: impl Fn(Side) -> T + Sync + Send) -> Vec<T> {
        let Links { topology, points } = self;
        let (edges, corners) = (topology.edge_count() as u32, topology.corner_count() as u32);
        let count = (edges + corners) as usize + points.cut.len();
        if !points.cut.is_empty() {
            let side = |h| value(self.side(h));
            return map(count, |e| [2 * e, 2 * e + 1].map(side)).into_flattened();
        }
        let pair = |e: u32| match e.checked_sub(edges) {
            None => [2 * e, 2 * e + 1].map(|h| value(self.flipped(h))),
            Some(c) => self.spokes_of(c).map(&value),
        };
        map(count, pair).into_flattened()
    }

    /// A half-edge with the number of one of the level before, where no rim is cut.
    #[inline]
    fn flipped(&self, h: u32) -> Side {
        let topology = self.topology;
        let point = |c| topology.vertex_count() as u32 + topology.face(c);
        match [topology.corner(h), topology.corner(h ^ 1)] {
            [NONE, _] => {
                let prev = topology.vertex_halfedge[topology.from(h) as usize] ^ 1;
                Side { prev, to: topology.to(h), face: NONE }
            }
            [c, NONE] => Side { prev: self.spoke(c) + 1, to: topology.to(h), face: c },
            [c, twin] => Side { prev: self.spoke(topology.next(twin)), to: point(c), face: c },
        }
    }

    /// The half-edges between the vertex of a corner and the point of its face, where no rim is cut.
    #[inline]
    fn spokes_of(&self, c: u32) -> [Side; 2] {
        let topology = self.topology;
        let (h, before) = (topology.corner_halfedge[c as usize], topology.prev(c));
        let arrives = topology.corner_halfedge[before as usize];
        let point = topology.vertex_count() as u32 + topology.face(c);
        let out = match topology.corner(arrives ^ 1) {
            NONE => Side { prev: arrives, to: point, face: before },
            twin => Side { prev: self.spoke(twin) + 1, to: point, face: twin },
        };
        let prev = if topology.corner(h ^ 1) == NONE { self.spoke(topology.next(c)) } else { h };
        [out, Side { prev, to: topology.vertex(c), face: c }]
    }

    /// Any half-edge, where rims are cut.
    fn side(&self, h: u32) -> Side {
        let Links { topology, points } = self;
        let corner = self.corner(h);
        if corner != NONE {
            let (c, k) = (corner / 3, corner as usize % 3);
            let (prev, to) = (self.sides(c)[(k + 2) % 3], self.vertices(c)[(k + 1) % 3]);
            return Side { prev, to, face: c };
        }
        // Along the rim, which is on the right: to the second point, to the first, to the end.
        let c = match h.checked_sub(self.spoke(0)) {
            None => topology.corner(h ^ 1),
            Some(spoke) => spoke / 2,
        };
        let first = points.of_face(topology, topology.face(c));
        let (prev, to) = if h < self.spoke(0) {
            (self.spoke(topology.next(c)), first)
        } else if h % 2 == 1 {
            (topology.corner_halfedge[c as usize] ^ 1, topology.vertex(c))
        } else {
            let arrives = topology.vertex_halfedge[topology.vertex(c) as usize];
            (self.spoke(topology.corner(arrives)) + 1, first + 1)
        };
        Side { prev, to, face: NONE }
    }

    /// What a mesh starts the fan of a vertex with.
    #[inline]
    fn start(&self, v: u32) -> u32 {
        let Links { topology, points } = self;
        let beyond = |h: u32| topology.corner(h ^ 1);
        if let Some(&first) = topology.vertex_halfedge.get(v as usize) {
            if beyond(first) != NONE {
                return self.first(v);
            }
            let rim = topology.start(first);
            return if points.cuts_rims { self.spoke(topology.next(beyond(rim))) } else { rim };
        }
        let (face, is_second) = points.face(v - topology.vertex_count() as u32);
        match points.cut(topology, face) {
            Some(rim) if is_second => topology.corner_halfedge[rim as usize] ^ 1,
            Some(rim) => self.spoke(rim) + 1,
            None => self.first(v),
        }
    }

    /// The vertices of the child at a corner.
    #[inline]
    fn vertices(&self, c: u32) -> [u32; 3] {
        let Links { topology, points } = self;
        let h = topology.corner_halfedge[c as usize];
        let start = topology.vertex(c);
        if topology.corner(h ^ 1) != NONE {
            [start, points.apex(topology, h ^ 1), points.apex(topology, h)]
        } else if points.cuts_rims {
            let first = points.of_face(topology, topology.face(c));
            [first, first + 1, topology.vertex(topology.prev(c))]
        } else {
            let end = topology.vertex(topology.next(c));
            [start, end, points.of_face(topology, topology.face(c))]
        }
    }

    /// From the vertex of a corner to the point of its face.
    #[inline]
    fn spoke(&self, corner: u32) -> u32 {
        2 * (self.topology.edge_count() as u32 + corner)
    }

    /// From the corner across a cut rim to the second point of its face.
    #[inline]
    fn second_spoke(&self, face: u32) -> u32 {
        self.spoke(self.topology.corner_count() as u32 + self.points.cuts_before(face))
    }

    /// The half-edges of the child at a corner.
    #[inline]
    fn sides(&self, c: u32) -> [u32; 3] {
        let Links { topology, points } = self;
        let h = topology.corner_halfedge[c as usize];
        match topology.corner(h ^ 1) {
            NONE if points.cuts_rims => {
                [h, self.second_spoke(topology.face(c)) + 1, self.spoke(topology.prev(c))]
            }
            NONE => [h, self.spoke(topology.next(c)), self.spoke(c) + 1],
            twin => {
                let start = topology.next(twin);
                let face = topology.face(start);
                let first = match points.cut(topology, face) {
                    // The side that arrives there is nearest to the second point.
                    Some(rim) if topology.prev(rim) == start => self.second_spoke(face),
                    _ => self.spoke(start),
                };
                [first, h, self.spoke(c) + 1]
            }
        }
    }

    /// The corner where a half-edge starts.
    #[inline]
    fn corner(&self, h: u32) -> u32 {
        let topology = self.topology;
        let beyond = |c: u32| topology.corner(topology.corner_halfedge[c as usize] ^ 1);
        if h < self.spoke(0) {
            return match topology.corner(h) {
                NONE => NONE,
                // Its face has it first at a rim.
                c => 3 * c + u32::from(topology.corner(h ^ 1) != NONE),
            };
        }
        let c = (h - self.spoke(0)) / 2;
        if c >= topology.corner_count() as u32 {
            let face = self.points.cut[c as usize - topology.corner_count()];
            let rim = rim_corner(topology, face).unwrap_or(NONE);
            return if h.is_multiple_of(2) { 3 * beyond(topology.next(rim)) } else { 3 * rim + 1 };
        }
        let rim = self.points.cut(topology, topology.face(c));
        if h % 2 == 1 {
            return if rim == Some(c) { NONE } else { 3 * c + 2 };
        }
        let before = topology.prev(c);
        match rim {
            Some(rim) if rim == before => NONE,
            Some(rim) if topology.prev(rim) == c => 3 * rim + 2,
            _ => match beyond(before) {
                NONE => 3 * before + 1,
                twin => 3 * twin,
            },
        }
    }

    /// The first half-edge of a vertex.
    #[inline]
    fn first(&self, v: u32) -> u32 {
        let topology = self.topology;
        if let Some(&first) = topology.vertex_halfedge.get(v as usize) {
            let keeps_rim = topology.corner(first ^ 1) == NONE && !self.points.cuts_rims;
            return if keeps_rim { first } else { self.spoke(topology.corner(first)) };
        }
        let (face, is_second) = self.points.face(v - topology.vertex_count() as u32);
        match self.points.cut(topology, face) {
            Some(rim) if is_second => self.spoke(topology.next(rim)) + 1,
            Some(rim) => topology.corner_halfedge[rim as usize],
            None => self.spoke(topology.corners(face).start) + 1,
        }
    }
}

impl<'a> Sqrt3<'a> {
    pub(crate) fn new(topology: &'a Topology, step: usize) -> Self {
        Sqrt3 { topology, points: Points::new(topology, step) }
    }

    /// The new values, without rows being written down but where rims are cut.
    pub(crate) fn refined<T: Value>(&self, old: &[T]) -> Vec<T> {
        let topology = self.topology;
        let vertices = topology.vertex_count();
        let mask = |valence: usize| {
            let alpha = sqrt3_alpha(valence);
            [1.0 - alpha, alpha / valence as f64]
        };
        let common: Vec<[f64; 2]> = (0..COMMON).map(|valence| mask(valence.max(1))).collect();
        let written = |row: usize| {
            let mut stencil = Stencil::default();
            self.row(row, &mut stencil);
            let entries = stencil.entries.iter();
            entries.fold(T::default(), |sum, &(v, weight)| sum + old[v as usize] * weight)
        };
        let vertex = |v: usize| {
            let first = topology.vertex_halfedge[v];
            let (mut spoke, mut valence, mut neighbors) = (first, 0, T::default());
            loop {
                let corner = topology.corner(spoke);
                if corner == NONE {
                    return if self.points.cuts_rims { written(v) } else { old[v] };
                }
                neighbors = neighbors + old[topology.vertex(topology.next(corner)) as usize];
                valence += 1;
                spoke = topology.corner_halfedge[topology.prev(corner) as usize] ^ 1;
                if spoke == first {
                    break;
                }
            }
            let [center, neighbor] = common.get(valence).copied().unwrap_or_else(|| mask(valence));
            old[v] * center + neighbors * neighbor
        };
        map(self.rows(), |row| {
            let row = row as usize;
            if row < vertices {
                return vertex(row);
            }
            let (face, _) = self.points.face((row - vertices) as u32);
            if self.points.cut(topology, face).is_some() {
                return written(row);
            }
            let corners = topology.corners(face);
            let sum = corners.fold(T::default(), |sum, c| sum + old[topology.vertex(c) as usize]);
            sum * (1.0 / 3.0)
        })
    }

    fn vertex(&self, v: usize, stencil: &mut Stencil) {
        let mut spokes = std::mem::take(&mut stencil.spokes);
        let closed = self.topology.spokes(v, &mut spokes);
        let neighbors = |h: &u32| self.topology.to(*h);
        if closed {
            let alpha = sqrt3_alpha(spokes.len());
            let share = alpha / spokes.len() as f64;
            stencil.push(v as u32, 1.0 - alpha);
            stencil.entries.extend(spokes.iter().map(|h| (neighbors(h), share)));
        } else if self.points.cuts_rims {
            stencil.push(v as u32, 19.0 / 27.0);
            stencil.push(neighbors(&spokes[0]), 4.0 / 27.0);
            stencil.push(neighbors(&spokes[spokes.len() - 1]), 4.0 / 27.0);
        } else {
            stencil.push(v as u32, 1.0);
        }
        stencil.spokes = spokes;
    }

    fn point(&self, point: usize, stencil: &mut Stencil) {
        let topology = self.topology;
        let (face, is_second) = self.points.face(point as u32);
        let Some(rim) = self.points.cut(topology, face) else {
            let corners = topology.corners(face);
            stencil.entries.extend(corners.map(|c| (topology.vertex(c), 1.0 / 3.0)));
            return;
        };
        // Near the start of the side or near its end; beyond that end lies one more vertex of the rim.
        let is_first = !is_second;
        let (start, end) = (topology.vertex(rim), topology.vertex(topology.next(rim)));
        let (near, far) = if is_first { (start, end) } else { (end, start) };
        let mut spokes = std::mem::take(&mut stencil.spokes);
        topology.spokes(near as usize, &mut spokes);
        let beyond = if is_first { spokes[spokes.len() - 1] } else { spokes[0] };
        stencil.push(near, 16.0 / 27.0);
        stencil.push(far, 10.0 / 27.0);
        stencil.push(topology.to(beyond), 1.0 / 27.0);
        stencil.spokes = spokes;
    }
}

impl Masks for Sqrt3<'_> {
    fn rows(&self) -> usize {
        self.topology.vertex_count() + self.points.count(self.topology)
    }

    fn topology(&self) -> &Topology {
        self.topology
    }

    fn means(&self) -> Means {
        Means::Unused
    }

    fn row(&self, row: usize, stencil: &mut Stencil) {
        let vertices = self.topology.vertex_count();
        if row < vertices { self.vertex(row, stencil) } else { self.point(row - vertices, stencil) }
    }
}
