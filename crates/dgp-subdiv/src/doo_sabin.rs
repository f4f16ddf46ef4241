//! Doo–Sabin subdivision: a smaller copy of each face, joined by faces for edges and vertices.
//!
//! ```text
//! corner of a face of n    Σ α_i p_i    α_0 = ¼ + 5/(4n),  α_i = (3 + 2 cos 2πi/n)/(4n)
//!
//! faces: of each face its n new corners; of each edge between two faces the four at its ends; of each
//! vertex inside those around it
//! ```
//!
//! Numbers: vertex c at corner c. Edge c is the side of the face from corner c on; then follow two edges per
//! edge between two faces, the one of half-edge h near the vertex it leaves.
//!
//! - Input: any polygons; no vertex inside with only two faces.
//! - Cost: O(corners) per level; nothing is searched.
//! - Guarantees: masks are convex; from the first level on four edges meet at each vertex inside.
//! - Reference: Doo and Sabin, "Behaviour of recursive division surfaces near extraordinary points", 1978.
//! - Departs from it: nothing, but it has no rule for rims of holes, so they recede at each level.

use std::f64::consts::TAU;

use dgp_mesh::{VertexId, parallel};

use crate::{
    masks::{Masks, Means, Stencil, Value},
    primal::COMMON,
    topology::{NONE, Starts, Topology},
};

/// α_i, how much the corner `i` steps away counts in a face of `degree` corners.
pub fn doo_sabin_weight(degree: usize, i: usize) -> f64 {
    let n = degree as f64;
    if i == 0 {
        0.25 + 5.0 / (4.0 * n)
    } else {
        (3.0 + 2.0 * (TAU * i as f64 / n).cos()) / (4.0 * n)
    }
}

/// The masks of a step; a row per corner.
pub(crate) struct DooSabin<'a> {
    topology: &'a Topology,
}

impl<'a> DooSabin<'a> {
    pub(crate) fn new(topology: &'a Topology) -> Self {
        DooSabin { topology }
    }
}

impl Masks for DooSabin<'_> {
    fn rows(&self) -> usize {
        self.topology.corner_count()
    }

    fn topology(&self) -> &Topology {
        self.topology
    }

    fn means(&self) -> Means {
        Means::Unused
    }

    fn row(&self, row: usize, stencil: &mut Stencil) {
        let corners = self.topology.corners(self.topology.face(row as u32));
        let degree = corners.len();
        for c in corners {
            let distance = (row as u32).abs_diff(c) as usize;
            stencil.push(self.topology.vertex(c), doo_sabin_weight(degree, distance));
        }
    }
}

/// The new values, without rows being written down.
pub(crate) fn refined_values<T: Value>(topology: &Topology, old: &[T]) -> Vec<T> {
    let weights = |degree: usize| (0..degree).map(|i| doo_sabin_weight(degree, i)).collect();
    let common: Vec<Vec<f64>> = (0..COMMON).map(weights).collect();
    map(topology.corner_count(), |row| {
        let corners = topology.corners(topology.face(row));
        let degree = corners.len();
        let common = common.get(degree);
        corners.fold(T::default(), |sum, c| {
            let i = row.abs_diff(c) as usize;
            let weight = common.map_or_else(|| doo_sabin_weight(degree, i), |weights| weights[i]);
            sum + old[topology.vertex(c) as usize] * weight
        })
    })
}

fn map<T: Send>(count: usize, f: impl Fn(u32) -> T + Sync + Send) -> Vec<T> {
    parallel::map(count, |i: VertexId| f(i.index() as u32)).into_values()
}

/// The connectivity of the next level, and the face each of its faces comes from.
pub(crate) fn refined(topology: &Topology) -> (Topology, Vec<u32>) {
    let links = Links::new(topology);
    let corners = topology.corner_count() as u32;
    let spokes = |v: &u32| {
        let mut spokes = Vec::new();
        topology.spokes(*v as usize, &mut spokes);
        spokes
    };
    // Faces of faces, of edges, of vertices.
    let mut corner_vertex: Vec<u32> = (0..corners).collect();
    let mut corner_halfedge: Vec<u32> = (0..corners).map(|c| 2 * c).collect();
    let edges = parallel::map_blocks(links.inside.len(), parallel::BLOCK, |block| {
        links.inside[block].iter().map(|&e| links.edge_face(e)).collect::<Vec<_>>()
    });
    for (vertices, halfedges) in edges.into_iter().flatten() {
        corner_vertex.extend(vertices);
        corner_halfedge.extend(halfedges);
    }
    let closed = |v: &u32| !topology.is_boundary_vertex(*v as usize);
    let centers: Vec<u32> = (0..topology.vertex_count() as u32).filter(closed).collect();
    let fans = parallel::map_blocks(centers.len(), parallel::BLOCK, |block| {
        let (mut lengths, mut vertices, mut halfedges) = (Vec::new(), Vec::new(), Vec::new());
        for spokes in centers[block].iter().map(spokes) {
            lengths.push(spokes.len() as u32);
            vertices.extend(spokes.iter().map(|&h| topology.corner(h)));
            // From one corner to the next across the spoke between them, which the next one starts.
            let after = spokes.iter().cycle().skip(1).take(spokes.len());
            halfedges.extend(after.map(|&h| links.across(h) + 1));
        }
        (lengths, vertices, halfedges)
    });
    let mut lengths = Vec::with_capacity(centers.len());
    for (fan_lengths, vertices, halfedges) in fans {
        lengths.extend(fan_lengths);
        corner_vertex.extend(vertices);
        corner_halfedge.extend(halfedges);
    }
    let degrees = (0..topology.face_count() as u32).map(|f| topology.corners(f).len() as u32);
    let degrees = degrees.chain(links.inside.iter().map(|_| 4)).chain(lengths);
    let mut halfedge_corner = vec![NONE; 2 * (corners as usize + 2 * links.inside.len())];
    for (&h, c) in corner_halfedge.iter().zip(0..) {
        halfedge_corner[h as usize] = c;
    }
    let parents = (0..topology.face_count() as u32)
        .chain(links.inside.iter().map(|&e| topology.face(topology.corner(2 * e))))
        .chain(
            centers
                .iter()
                .map(|&v| topology.face(topology.corner(topology.vertex_halfedge[v as usize]))),
        );
    let children = Topology {
        starts: Starts::of(degrees),
        vertex_halfedge: map(corners as usize, |c| links.first(c)),
        corner_vertex,
        corner_halfedge,
        halfedge_corner,
    };
    (children, parents.collect())
}

/// The numbers of what a step makes.
struct Links<'a> {
    topology: &'a Topology,
    /// The edges between two faces.
    inside: Vec<u32>,
    /// Where they are among themselves; empty if all edges are.
    rank: Vec<u32>,
}

impl<'a> Links<'a> {
    fn new(topology: &'a Topology) -> Self {
        let edges = 0..topology.edge_count() as u32;
        let is_inside = |e: &u32| !topology.is_boundary_edge(*e as usize);
        let inside: Vec<u32> = edges.filter(is_inside).collect();
        let mut rank = Vec::new();
        if inside.len() < topology.edge_count() {
            rank.resize(topology.edge_count(), NONE);
            inside.iter().zip(0..).for_each(|(&e, place)| rank[e as usize] = place);
        }
        Links { topology, inside, rank }
    }

    /// From the corner of a half-edge, which has two faces, to the corner at the same vertex across it.
    #[inline]
    fn across(&self, h: u32) -> u32 {
        let e = h / 2;
        let rank = self.rank.get(e as usize).copied().unwrap_or(e);
        2 * (self.topology.corner_count() as u32 + 2 * rank + h % 2)
    }

    /// The corners and the half-edges of the face of an edge.
    #[inline]
    fn edge_face(&self, e: u32) -> ([u32; 4], [u32; 4]) {
        let [c, twin] = [2 * e, 2 * e + 1].map(|h| self.topology.corner(h));
        let vertices = [self.topology.next(c), c, self.topology.next(twin), twin];
        (vertices, [2 * c + 1, self.across(2 * e), 2 * twin + 1, self.across(2 * e + 1)])
    }

    /// The first half-edge of the vertex at a corner.
    #[inline]
    fn first(&self, c: u32) -> u32 {
        let topology = self.topology;
        let h = topology.corner_halfedge[c as usize];
        let at_hole = topology.is_boundary_vertex(topology.vertex(c) as usize);
        // At a hole the one that has it on its right.
        if at_hole && topology.corner(h ^ 1) != NONE { self.across(h) } else { 2 * c }
    }
}
