//! The connectivity of one level, by corners: what a step of refinement reads and writes in order.
//!
//! Corners are counted face after face. The half-edges of edge e are 2e and 2e + 1, as in
//! [`Connectivity`]; each corner knows its vertex and the half-edge that starts there, and each half-edge its
//! corner, so the sides of a face need no links: they follow one another. The numbers of the children of a
//! split are arithmetic on those of the parents (see [`split`](crate::split)), so no edge is ever searched
//! for. Where a half-edge leads is read at the corners of a face beside it, which lie side by side.

use std::collections::HashMap;

use dgp_mesh::{Connectivity, FaceId, FaceList, HalfedgeArrays, HalfedgeId, VertexId, parallel};

#[cfg(test)]
use crate::Counts;

/// What a half-edge beside a hole has in place of a corner, and an isolated vertex of a half-edge.
pub(crate) const NONE: u32 = u32::MAX;

/// Faces, edges and vertices of one level.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Topology {
    pub(crate) starts: Starts,
    /// The vertex at each corner.
    pub(crate) corner_vertex: Vec<u32>,
    /// The half-edge that starts at each corner.
    pub(crate) corner_halfedge: Vec<u32>,
    /// The corner each half-edge starts at, [`NONE`] at holes.
    pub(crate) halfedge_corner: Vec<u32>,
    /// The first half-edge of each vertex, counterclockwise; at a hole the one that has it on its right.
    pub(crate) vertex_halfedge: Vec<u32>,
}

/// Where the corners of each face begin.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Starts {
    /// Each face has this many corners.
    Every(u32),
    /// Those of face f are at `starts[f]..starts[f + 1]`.
    At {
        /// The first corner of each face, and the number of corners.
        starts: Vec<u32>,
        /// The face of each corner.
        corner_face: Vec<u32>,
    },
}

impl Starts {
    /// Of faces with these numbers of corners.
    pub(crate) fn of(degrees: impl Iterator<Item = u32>) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        starts.extend(degrees.map(|degree| {
            end += degree;
            end
        }));
        let degree = starts.get(1).copied().unwrap_or(3);
        if starts.windows(2).all(|pair| pair[1] - pair[0] == degree) {
            return Starts::Every(degree);
        }
        let mut corner_face = Vec::with_capacity(end as usize);
        for (&end, f) in starts[1..].iter().zip(0..) {
            corner_face.resize(end as usize, f);
        }
        Starts::At { starts, corner_face }
    }
}

impl Topology {
    /// That of a mesh. Half-edges, faces and vertices keep their numbers.
    pub(crate) fn new(mesh: &Connectivity) -> Self {
        let (starts, corner_halfedge, halfedge_corner) = if let Some(sides) = sides_of::<3>(mesh) {
            let corners = corners_of::<3>(mesh, &sides);
            (Starts::Every(3), sides.into_flattened(), corners)
        } else if let Some(sides) = sides_of::<4>(mesh) {
            let corners = corners_of::<4>(mesh, &sides);
            (Starts::Every(4), sides.into_flattened(), corners)
        } else {
            polygons(mesh)
        };
        let vertex = |c: VertexId| {
            mesh.from(HalfedgeId::new(corner_halfedge[c.index()] as usize)).index() as u32
        };
        let first = |v: VertexId| match mesh.vertex_halfedge(v) {
            // At a hole the mesh keeps the half-edge without a face; the first one comes after it.
            Some(h) if mesh.is_boundary_halfedge(h) => mesh.ccw(h).index() as u32,
            Some(h) => h.index() as u32,
            None => NONE,
        };
        Topology {
            starts,
            corner_vertex: parallel::map(corner_halfedge.len(), vertex).into_values(),
            vertex_halfedge: mesh.map_vertices(first).into_values(),
            corner_halfedge,
            halfedge_corner,
        }
    }

    /// The faces as lists of vertices.
    pub(crate) fn faces(&self) -> FaceList {
        face_list(&self.starts, &self.corner_vertex)
    }

    /// As a mesh. Half-edges, faces and vertices keep their numbers.
    pub(crate) fn connectivity(&self) -> Connectivity {
        let halfedge = |h: u32| HalfedgeId::new(h as usize);
        let vertices = |v: VertexId| match self.vertex_halfedge[v.index()] {
            NONE => None,
            first => Some(halfedge(self.start(first))),
        };
        Connectivity::from_arrays(HalfedgeArrays {
            prev: parallel::map(self.halfedge_corner.len(), |h: HalfedgeId| {
                halfedge(match self.halfedge_corner[h.index()] {
                    NONE => self.vertex_halfedge[self.from(h.index() as u32) as usize] ^ 1,
                    corner => self.corner_halfedge[self.prev(corner) as usize],
                })
            }),
            to: parallel::map(self.halfedge_corner.len(), |h: HalfedgeId| {
                VertexId::new(self.to(h.index() as u32) as usize)
            }),
            face: parallel::map(self.halfedge_corner.len(), |h: HalfedgeId| {
                match self.halfedge_corner[h.index()] {
                    NONE => None,
                    corner => Some(FaceId::new(self.face(corner) as usize)),
                }
            }),
            vertex_halfedge: parallel::map(self.vertex_count(), vertices),
            face_halfedge: parallel::map(self.face_count(), |f: FaceId| {
                let first = self.corners(f.index() as u32).start;
                halfedge(self.corner_halfedge[first as usize])
            }),
        })
    }

    /// What a mesh starts the fan of a vertex with, given what this does: the half-edge without a face where
    /// there is one.
    pub(crate) fn start(&self, first: u32) -> u32 {
        if self.corner(first ^ 1) != NONE {
            return first;
        }
        let mut spoke = first;
        while self.corner(spoke) != NONE {
            spoke = self.corner_halfedge[self.prev(self.corner(spoke)) as usize] ^ 1;
        }
        spoke
    }

    /// How many elements there are.
    #[cfg(test)]
    pub(crate) fn counts(&self) -> Counts {
        Counts {
            vertices: self.vertex_count() as u64,
            edges: self.edge_count() as u64,
            corners: self.corner_count() as u64,
            faces: self.face_count() as u64,
        }
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.vertex_halfedge.len()
    }

    pub(crate) fn edge_count(&self) -> usize {
        self.halfedge_corner.len() / 2
    }

    pub(crate) fn corner_count(&self) -> usize {
        self.corner_halfedge.len()
    }

    pub(crate) fn face_count(&self) -> usize {
        match &self.starts {
            Starts::Every(degree) => self.corner_halfedge.len() / *degree as usize,
            Starts::At { starts, .. } => starts.len() - 1,
        }
    }

    #[inline]
    pub(crate) fn face(&self, corner: u32) -> u32 {
        match &self.starts {
            Starts::Every(4) => corner >> 2,
            Starts::Every(3) => corner / 3,
            Starts::Every(degree) => corner / degree,
            Starts::At { corner_face, .. } => corner_face[corner as usize],
        }
    }

    /// The corners of a face.
    #[inline]
    pub(crate) fn corners(&self, face: u32) -> std::ops::Range<u32> {
        match &self.starts {
            Starts::Every(degree) => face * degree..(face + 1) * degree,
            Starts::At { starts, .. } => starts[face as usize]..starts[face as usize + 1],
        }
    }

    /// The following corner of the same face.
    #[inline]
    pub(crate) fn next(&self, corner: u32) -> u32 {
        match self.starts {
            Starts::Every(4) => return corner & !3 | (corner + 1) & 3,
            Starts::Every(3) if corner % 3 == 2 => return corner - 2,
            Starts::Every(3) => return corner + 1,
            _ => {}
        }
        let corners = self.corners(self.face(corner));
        if corner + 1 == corners.end { corners.start } else { corner + 1 }
    }

    /// The preceding corner of the same face.
    #[inline]
    pub(crate) fn prev(&self, corner: u32) -> u32 {
        match self.starts {
            Starts::Every(4) => return corner & !3 | corner.wrapping_sub(1) & 3,
            Starts::Every(3) if corner.is_multiple_of(3) => return corner + 2,
            Starts::Every(3) => return corner - 1,
            _ => {}
        }
        let corners = self.corners(self.face(corner));
        if corner == corners.start { corners.end - 1 } else { corner - 1 }
    }

    /// The vertex at a corner.
    #[inline]
    pub(crate) fn vertex(&self, corner: u32) -> u32 {
        self.corner_vertex[corner as usize]
    }

    /// The edge of the side that starts at a corner.
    #[inline]
    pub(crate) fn edge(&self, corner: u32) -> u32 {
        self.corner_halfedge[corner as usize] >> 1
    }

    /// The vertex a half-edge leaves.
    #[inline]
    pub(crate) fn from(&self, halfedge: u32) -> u32 {
        match self.corner(halfedge) {
            NONE => self.vertex(self.next(self.corner(halfedge ^ 1))),
            corner => self.vertex(corner),
        }
    }

    /// The vertex a half-edge arrives at.
    #[inline]
    pub(crate) fn to(&self, halfedge: u32) -> u32 {
        match self.corner(halfedge) {
            NONE => self.vertex(self.corner(halfedge ^ 1)),
            corner => self.vertex(self.next(corner)),
        }
    }

    /// The corner a half-edge starts at, [`NONE`] at a hole.
    #[inline]
    pub(crate) fn corner(&self, halfedge: u32) -> u32 {
        self.halfedge_corner[halfedge as usize]
    }

    /// Whether an edge lacks a face.
    #[inline]
    pub(crate) fn is_boundary_edge(&self, edge: usize) -> bool {
        self.halfedge_corner[2 * edge] == NONE || self.halfedge_corner[2 * edge + 1] == NONE
    }

    /// Whether a vertex is at a hole; one on no face is.
    #[inline]
    pub(crate) fn is_boundary_vertex(&self, vertex: usize) -> bool {
        let first = self.vertex_halfedge[vertex];
        first == NONE || self.corner(first ^ 1) == NONE
    }

    /// Writes the half-edges that leave `vertex`, counterclockwise; the face left of one lies before the
    /// next. Returns whether they close: at a hole they do not, and the last has no face.
    #[inline]
    pub(crate) fn spokes(&self, vertex: usize, spokes: &mut Vec<u32>) -> bool {
        spokes.clear();
        let first = self.vertex_halfedge[vertex];
        if first == NONE {
            return false;
        }
        let mut spoke = first;
        loop {
            spokes.push(spoke);
            let corner = self.corner(spoke);
            if corner == NONE {
                return false;
            }
            spoke = self.corner_halfedge[self.prev(corner) as usize] ^ 1;
            if spoke == first {
                return true;
            }
        }
    }

    /// The faces listed, as a topology of their own, with the vertices and edges of this one that its
    /// vertices and edges are; edges to other faces become rims. Where the faces hang together at a
    /// vertex only, one of the fans there is its fan.
    pub(crate) fn part(&self, faces: &[u32]) -> (Topology, Vec<u32>, Vec<u32>) {
        let (mut vertices, mut edges) = (Numbers::default(), Numbers::default());
        let (mut corner_halfedge, mut starts, mut corner_face) = (Vec::new(), vec![0], Vec::new());
        for (&face, f) in faces.iter().zip(0..) {
            for c in self.corners(face) {
                let h = self.corner_halfedge[c as usize];
                corner_halfedge.push(2 * edges.of(h >> 1) + h % 2);
                corner_face.push(f);
            }
            starts.push(corner_halfedge.len() as u32);
        }
        let mut halfedge_corner = vec![NONE; 2 * edges.ids.len()];
        for (&h, c) in corner_halfedge.iter().zip(0..) {
            halfedge_corner[h as usize] = c;
        }
        for &e in &edges.ids {
            vertices.of(self.from(2 * e));
            vertices.of(self.from(2 * e + 1));
        }
        let of_cage = faces.iter().flat_map(|&face| self.corners(face)).map(|c| self.vertex(c));
        let corner_vertex: Vec<u32> = of_cage.map(|v| vertices.of(v)).collect();
        let mut vertex_halfedge = vec![NONE; vertices.ids.len()];
        for (h, &corner) in (0..).zip(&halfedge_corner).filter(|(_, corner)| **corner != NONE) {
            let first = &mut vertex_halfedge[corner_vertex[corner as usize] as usize];
            // Beside a rim the first one has it on its right.
            if halfedge_corner[h as usize ^ 1] == NONE || *first == NONE {
                *first = h;
            }
        }
        let degree = starts[1];
        let uniform = starts.windows(2).all(|pair| pair[1] - pair[0] == degree);
        let starts =
            if uniform { Starts::Every(degree) } else { Starts::At { starts, corner_face } };
        let part =
            Topology { starts, corner_vertex, corner_halfedge, halfedge_corner, vertex_halfedge };
        (part, vertices.ids, edges.ids)
    }
}

/// Which corner comes after which and which face it is of, for loops that know the degree of faces.
pub(crate) trait Corners: Sync {
    /// The face of a corner.
    fn face(&self, corner: u32) -> u32;
    /// The following corner of the same face.
    fn following(&self, corner: u32) -> u32;
    /// The preceding corner of the same face.
    fn preceding(&self, corner: u32) -> u32;
}

/// Faces of `N` corners each.
pub(crate) struct Every<const N: u32>;

impl<const N: u32> Corners for Every<N> {
    #[inline]
    fn face(&self, corner: u32) -> u32 {
        corner / N
    }

    #[inline]
    fn following(&self, corner: u32) -> u32 {
        if corner % N == N - 1 { corner - (N - 1) } else { corner + 1 }
    }

    #[inline]
    fn preceding(&self, corner: u32) -> u32 {
        if corner.is_multiple_of(N) { corner + (N - 1) } else { corner - 1 }
    }
}

impl Corners for Topology {
    #[inline]
    fn face(&self, corner: u32) -> u32 {
        Topology::face(self, corner)
    }

    #[inline]
    fn following(&self, corner: u32) -> u32 {
        self.next(corner)
    }

    #[inline]
    fn preceding(&self, corner: u32) -> u32 {
        self.prev(corner)
    }
}

/// Faces that begin at `starts`, with these vertices at their corners.
pub(crate) fn face_list(starts: &Starts, corner_vertex: &[u32]) -> FaceList {
    let vertex = |c: VertexId| VertexId::new(corner_vertex[c.index()] as usize);
    let corners = parallel::map(corner_vertex.len(), vertex).into_values();
    match starts {
        Starts::Every(degree) => FaceList::from_corners(corners, *degree as usize),
        Starts::At { starts, .. } => FaceList::from_ends(corners, &starts[1..]),
    }
}

/// The sides of each face if there are faces and each has `N`.
fn sides_of<const N: usize>(mesh: &Connectivity) -> Option<Vec<[u32; N]>> {
    let degree = mesh.faces().next().map(|f| mesh.degree(f));
    if degree != Some(N) {
        return None;
    }
    let sides = mesh.map_faces(|f| {
        let mut sides = [mesh.face_halfedge(f); N];
        for k in (1..N).rev() {
            sides[k] = mesh.prev(sides[(k + 1) % N]);
        }
        let closes = mesh.prev(sides[1]) == sides[0];
        if closes { sides.map(|h| h.index() as u32) } else { [NONE; N] }
    });
    let sides = sides.into_values();
    let has_other = parallel::map_blocks(sides.len(), parallel::BLOCK, |block| {
        sides[block].iter().any(|sides| sides[0] == NONE)
    });
    (!has_other.contains(&true)).then_some(sides)
}

/// The corner of each half-edge, given the sides of each face.
fn corners_of<const N: usize>(mesh: &Connectivity, sides: &[[u32; N]]) -> Vec<u32> {
    let corner = |h: HalfedgeId| match mesh.face(h) {
        None => NONE,
        Some(f) => {
            let place = sides[f.index()].iter().position(|&side| side == h.index() as u32);
            (N * f.index() + place.unwrap_or_default()) as u32
        }
    };
    mesh.map_halfedges(corner).into_values()
}

/// Where the corners of faces of any degrees begin, the half-edge of each corner and the corner of each
/// half-edge.
fn polygons(mesh: &Connectivity) -> (Starts, Vec<u32>, Vec<u32>) {
    let mut corner_halfedge = Vec::with_capacity(mesh.halfedge_count());
    let mut halfedge_corner = vec![NONE; mesh.halfedge_count()];
    let starts = Starts::of(mesh.faces().map(|f| {
        let first = corner_halfedge.len();
        for h in mesh.face_halfedges(f) {
            halfedge_corner[h.index()] = corner_halfedge.len() as u32;
            corner_halfedge.push(h.index() as u32);
        }
        (corner_halfedge.len() - first) as u32
    }));
    (starts, corner_halfedge, halfedge_corner)
}

/// Numbers from 0 in the order in which ids are first asked for.
#[derive(Default)]
struct Numbers {
    ids: Vec<u32>,
    /// Only looked up, so its order reaches nobody.
    number: HashMap<u32, u32>,
}

impl Numbers {
    fn of(&mut self, id: u32) -> u32 {
        let Numbers { ids, number } = self;
        *number.entry(id).or_insert_with(|| {
            ids.push(id);
            ids.len() as u32 - 1
        })
    }
}
