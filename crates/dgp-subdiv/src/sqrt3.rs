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
//! - Input: triangles; no vertex inside with only two faces.
//! - Cost: O(F) per level, with half-edges joined by [`Connectivity::from_faces`].
//! - Guarantees: grows three times a level, in place of four; masks are convex.
//! - Reference: Kobbelt, "√3-subdivision", SIGGRAPH 2000.

use std::f64::consts::TAU;

use dgp_mesh::{Connectivity, FaceList, VertexId};

use crate::{
    Error,
    masks::{Masks, Means, Stencil},
    topology::{NONE, Topology},
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

/// The new vertices, numbered after the old ones.
struct Points {
    cuts_rims: bool,
    /// The point of each face, or the first of the two at its side at a rim that is cut.
    of_face: Vec<u32>,
    /// The face of each point.
    face: Vec<u32>,
}

impl Points {
    fn new(topology: &Topology, step: usize) -> Self {
        let cuts_rims = step % 2 == 1;
        let (mut of_face, mut face) = (Vec::new(), Vec::new());
        for f in 0..topology.face_count() as u32 {
            of_face.push((topology.vertex_count() + face.len()) as u32);
            face.push(f);
            if cuts_rims && rim_corner(topology, f).is_some() {
                face.push(f);
            }
        }
        Points { cuts_rims, of_face, face }
    }

    /// The corner of `face` whose side is at a rim that is cut.
    fn cut(&self, topology: &Topology, face: u32) -> Option<u32> {
        if self.cuts_rims { rim_corner(topology, face) } else { None }
    }

    /// What the face of a half-edge has on the far side of it: its point, or that nearest to the side.
    fn apex(&self, topology: &Topology, halfedge: u32) -> u32 {
        let corner = topology.corner(halfedge);
        let face = topology.face(corner);
        let first = self.of_face[face as usize];
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

/// The connectivity of the next level, and the face each of its faces comes from.
pub(crate) fn refined(topology: &Topology, step: usize) -> Result<(Topology, Vec<u32>), Error> {
    let points = Points::new(topology, step);
    let vertex = |v: u32| VertexId::new(v as usize);
    let (mut triangles, mut parents) = (Vec::new(), Vec::new());
    for f in 0..topology.face_count() as u32 {
        for c in topology.corners(f) {
            let h = topology.corner_halfedge[c as usize];
            let (a, b) = (topology.vertex(c), topology.to(h));
            let triangle = if topology.corner(h ^ 1) != NONE {
                [a, points.apex(topology, h ^ 1), points.apex(topology, h)]
            } else if points.cuts_rims {
                let first = points.of_face[f as usize];
                [first, first + 1, topology.vertex(topology.prev(c))]
            } else {
                [a, b, points.of_face[f as usize]]
            };
            triangles.push(triangle.map(vertex));
            parents.push(f);
        }
    }
    let vertices = topology.vertex_count() + points.face.len();
    let mesh = Connectivity::from_faces(vertices, &FaceList::from_triangles(triangles))?;
    Ok((Topology::new(&mesh), parents))
}

impl<'a> Sqrt3<'a> {
    pub(crate) fn new(topology: &'a Topology, step: usize) -> Self {
        Sqrt3 { topology, points: Points::new(topology, step) }
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
        let face = self.points.face[point];
        let Some(rim) = self.points.cut(topology, face) else {
            let corners = topology.corners(face);
            stencil.entries.extend(corners.map(|c| (topology.vertex(c), 1.0 / 3.0)));
            return;
        };
        // Near the start of the side or near its end; beyond that end lies one more vertex of the rim.
        let is_first =
            self.points.of_face[face as usize] as usize == topology.vertex_count() + point;
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
        self.topology.vertex_count() + self.points.face.len()
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
