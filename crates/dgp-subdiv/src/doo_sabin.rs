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

use dgp_mesh::{Connectivity, FaceId, HalfedgeArrays, HalfedgeId, VertexId, parallel};

use crate::{
    Counts,
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
    // Faces of faces, of edges, of vertices.
    let mut corner_vertex = map(topology.corner_count(), |c| c);
    let mut corner_halfedge = map(topology.corner_count(), |c| 2 * c);
    let of_edges = map(links.inside.count(), |place| links.edge_face(links.inside.id(place)));
    let mut halfedge_corner = map(links.halfedges(), |h| match h.checked_sub(2 * corners) {
        None if h % 2 == 0 => h / 2,
        None => links.edge_corner(topology.corner_halfedge[h as usize / 2], 0),
        // Those around vertices follow.
        Some(k) if k % 2 == 1 => NONE,
        Some(_) => links.edge_corner(links.crossed(h), 1),
    });
    for (vertices, halfedges) in of_edges {
        corner_vertex.extend(vertices);
        corner_halfedge.extend(halfedges);
    }
    let fans = parallel::map_blocks(links.closed.count(), parallel::BLOCK, |block| {
        let (mut lengths, mut vertices, mut halfedges) = (Vec::new(), Vec::new(), Vec::new());
        let mut spokes = Vec::new();
        for v in block.map(|place| links.closed.id(place as u32)) {
            topology.spokes(v as usize, &mut spokes);
            lengths.push(spokes.len() as u32);
            vertices.extend(spokes.iter().map(|&h| topology.corner(h)));
            // From one corner to the next across the spoke between them, which the next one starts.
            let after = spokes.iter().cycle().skip(1).take(spokes.len());
            halfedges.extend(after.map(|&h| links.across(h) + 1));
        }
        (lengths, vertices, halfedges)
    });
    let mut lengths = Vec::with_capacity(links.closed.count());
    for (fan_lengths, vertices, halfedges) in fans {
        lengths.extend(fan_lengths);
        for (&h, c) in halfedges.iter().zip(corner_halfedge.len() as u32..) {
            halfedge_corner[h as usize] = c;
        }
        corner_vertex.extend(vertices);
        corner_halfedge.extend(halfedges);
    }
    let degrees = (0..topology.face_count() as u32).map(|f| topology.corners(f).len() as u32);
    let degrees = degrees.chain((0..links.inside.count()).map(|_| 4)).chain(lengths);
    let parents = map(links.face_count(), |f| match links.origin(f) {
        Origin::Face(f) => f,
        Origin::Edge(e) => topology.face(topology.corner(2 * e)),
        Origin::Vertex(v) => topology.face(topology.corner(topology.vertex_halfedge[v as usize])),
    });
    let children = Topology {
        starts: Starts::of(degrees),
        vertex_halfedge: map(corners as usize, |c| links.first(c)),
        corner_vertex,
        corner_halfedge,
        halfedge_corner,
    };
    (children, parents)
}

/// How many elements the next level has.
pub(crate) fn counts(topology: &Topology) -> Counts {
    let links = Links::new(topology);
    let halfedges = links.halfedges();
    // All half-edges but one beside each side at a hole and those around vertices at holes.
    let at_hole = |c: u32| {
        let side = topology.corner(topology.corner_halfedge[c as usize] ^ 1) == NONE;
        let vertex = topology.is_boundary_vertex(topology.vertex(c) as usize);
        // One leads across each side that starts at such a vertex and has two faces.
        u64::from(side) + u64::from(vertex && !side)
    };
    let holes = if links.closed.is_all() && links.inside.is_all() {
        0
    } else {
        let corner = |c: HalfedgeId| at_hole(c.index() as u32);
        parallel::reduce(topology.corner_count(), 0, corner, |a, b| a + b)
    };
    Counts {
        vertices: topology.corner_count() as u64,
        edges: halfedges as u64 / 2,
        corners: halfedges as u64 - holes,
        faces: links.face_count() as u64,
    }
}

/// The next level as a mesh, with the numbers that [`refined`] gives.
pub(crate) fn connectivity(topology: &Topology) -> Connectivity {
    let links = Links::new(topology);
    let halfedge = |h: u32| HalfedgeId::new(h as usize);
    let face = |side: Side| (side.face != NONE).then(|| FaceId::new(side.face as usize));
    let start = |c| Some(halfedge(links.start(c)));
    Connectivity::from_arrays(HalfedgeArrays {
        prev: links.each_side(|side| halfedge(side.prev)).into(),
        to: links.each_side(|side| VertexId::new(side.to as usize)).into(),
        face: links.each_side(face).into(),
        vertex_halfedge: map(topology.corner_count(), start).into(),
        face_halfedge: map(links.face_count(), |f| halfedge(links.face_halfedge(f))).into(),
    })
}

/// Some of the numbers below a bound, in order.
struct Chosen {
    bound: usize,
    /// Empty if all are chosen.
    ids: Vec<u32>,
    /// Where each number is among those chosen, [`NONE`] if it is not; empty if all are.
    places: Vec<u32>,
}

impl Chosen {
    fn new(bound: usize, is_chosen: impl Fn(u32) -> bool + Sync + Send) -> Self {
        let missing = parallel::map_blocks(bound, parallel::BLOCK, |block| {
            block.into_iter().any(|id| !is_chosen(id as u32))
        });
        let (mut ids, mut places) = (Vec::new(), Vec::new());
        if missing.contains(&true) {
            ids.extend((0..bound as u32).filter(|&id| is_chosen(id)));
            places.resize(bound, NONE);
            ids.iter().zip(0..).for_each(|(&id, place)| places[id as usize] = place);
        }
        Chosen { bound, ids, places }
    }

    fn is_all(&self) -> bool {
        self.places.is_empty()
    }

    fn count(&self) -> usize {
        if self.is_all() { self.bound } else { self.ids.len() }
    }

    #[inline]
    fn id(&self, place: u32) -> u32 {
        if self.is_all() { place } else { self.ids[place as usize] }
    }

    #[inline]
    fn place(&self, id: u32) -> u32 {
        if self.is_all() { id } else { self.places[id as usize] }
    }
}

/// What a face comes from.
enum Origin {
    Face(u32),
    Edge(u32),
    Vertex(u32),
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
    /// The edges between two faces.
    inside: Chosen,
    /// The vertices at no hole.
    closed: Chosen,
}

impl<'a> Links<'a> {
    fn new(topology: &'a Topology) -> Self {
        let inside = |e: u32| !topology.is_boundary_edge(e as usize);
        let closed = |v: u32| !topology.is_boundary_vertex(v as usize);
        Links {
            topology,
            inside: Chosen::new(topology.edge_count(), inside),
            closed: Chosen::new(topology.vertex_count(), closed),
        }
    }

    fn halfedges(&self) -> usize {
        2 * (self.topology.corner_count() + 2 * self.inside.count())
    }

    fn face_count(&self) -> usize {
        self.topology.face_count() + self.inside.count() + self.closed.count()
    }

    /// What a face of the next level comes from.
    #[inline]
    fn origin(&self, face: u32) -> Origin {
        let (faces, edges) = (self.topology.face_count() as u32, self.inside.count() as u32);
        match face.checked_sub(faces) {
            None => Origin::Face(face),
            Some(place) if place < edges => Origin::Edge(self.inside.id(place)),
            Some(place) => Origin::Vertex(self.closed.id(place - edges)),
        }
    }

    /// From the corner of a half-edge, which has two faces, to the corner at the same vertex across it.
    #[inline]
    fn across(&self, h: u32) -> u32 {
        let place = self.inside.place(h / 2);
        2 * (self.topology.corner_count() as u32 + 2 * place + h % 2)
    }

    /// The half-edge that is crossed by one that is neither beside a face nor beside a hole.
    #[inline]
    fn crossed(&self, across: u32) -> u32 {
        let k = across / 2 - self.topology.corner_count() as u32;
        2 * self.inside.id(k / 2) + k % 2
    }

    /// The corners and the half-edges of the face of an edge.
    #[inline]
    fn edge_face(&self, e: u32) -> ([u32; 4], [u32; 4]) {
        let [c, twin] = [2 * e, 2 * e + 1].map(|h| self.topology.corner(h));
        let vertices = [self.topology.next(c), c, self.topology.next(twin), twin];
        (vertices, [2 * c + 1, self.across(2 * e), 2 * twin + 1, self.across(2 * e + 1)])
    }

    /// The corner of the face of an edge at which the side of half-edge `h` starts (`which` 0) or the half-edge
    /// across it (1); [`NONE`] at a hole.
    #[inline]
    fn edge_corner(&self, h: u32, which: u32) -> u32 {
        match self.inside.place(h / 2) {
            NONE => NONE,
            place => self.topology.corner_count() as u32 + 4 * place + 2 * (h % 2) + which,
        }
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

    /// What a mesh starts the fan of the vertex at a corner with: at a hole the half-edge without a face.
    #[inline]
    fn start(&self, c: u32) -> u32 {
        let topology = self.topology;
        if !topology.is_boundary_vertex(topology.vertex(c) as usize) {
            return self.first(c);
        }
        let before = topology.prev(c);
        let twin = topology.corner_halfedge[before as usize] ^ 1;
        if topology.corner(twin) == NONE { 2 * before + 1 } else { self.across(twin) + 1 }
    }

    #[inline]
    fn face_halfedge(&self, face: u32) -> u32 {
        let topology = self.topology;
        match self.origin(face) {
            Origin::Face(f) => 2 * topology.corners(f).start,
            Origin::Edge(e) => 2 * topology.corner(2 * e) + 1,
            Origin::Vertex(v) => {
                let first = topology.corner(topology.vertex_halfedge[v as usize]);
                let second = topology.corner_halfedge[topology.prev(first) as usize] ^ 1;
                self.across(second) + 1
            }
        }
    }

    /// A value for each half-edge.
    fn each_side<T: Send>(&self, value: impl Fn(Side) -> T + Sync + Send) -> Vec<T> {
        let corners = self.topology.corner_count() as u32;
        let pair = |i: u32| match i.checked_sub(corners) {
            None => self.beside_side(i).map(&value),
            Some(k) => self.across_side(2 * self.inside.id(k / 2) + k % 2).map(&value),
        };
        map(self.halfedges() / 2, pair).into_flattened()
    }

    /// The side of the copy of a face that starts at corner `c`, and its twin beside the face of an edge or a hole.
    #[inline]
    fn beside_side(&self, c: u32) -> [Side; 2] {
        let topology = self.topology;
        let next = topology.next(c);
        let side = Side { prev: 2 * topology.prev(c), to: next, face: topology.face(c) };
        let h = topology.corner_halfedge[c as usize];
        let twin = if topology.corner(h ^ 1) == NONE {
            Side { prev: self.first(next) ^ 1, to: c, face: NONE }
        } else {
            let face = topology.face_count() as u32 + self.inside.place(h / 2);
            Side { prev: self.across(h ^ 1), to: c, face }
        };
        [side, twin]
    }

    /// The half-edge across `h`, which has two faces, and its twin beside the face of a vertex or a hole.
    #[inline]
    fn across_side(&self, h: u32) -> [Side; 2] {
        let topology = self.topology;
        let (c, beyond) = (topology.corner(h), topology.next(topology.corner(h ^ 1)));
        let faces = topology.face_count() as u32;
        let side = Side { prev: 2 * c + 1, to: beyond, face: faces + self.inside.place(h / 2) };
        let twin = match self.closed.place(topology.vertex(c)) {
            NONE => Side { prev: self.first(beyond) ^ 1, to: c, face: NONE },
            place => Side {
                prev: self.across(topology.corner_halfedge[beyond as usize]) + 1,
                to: c,
                face: faces + self.inside.count() as u32 + place,
            },
        };
        [side, twin]
    }
}
