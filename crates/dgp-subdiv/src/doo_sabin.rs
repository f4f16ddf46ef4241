//! Doo–Sabin subdivision: a smaller copy of each face, joined by faces for edges and vertices.
//!
//! ```text
//! corner of a face of n    Σ α_i p_i    α_0 = ¼ + 5/(4n),  α_i = (3 + 2 cos 2πi/n)/(4n)
//!
//! faces: of each face its n new corners; of each edge between two faces the four at its ends; of each
//! vertex inside those around it
//! ```
//!
//! - Input: any polygons; no vertex inside with only two faces.
//! - Cost: O(corners) per level, with half-edges joined by [`Connectivity::from_faces`].
//! - Guarantees: masks are convex; from the first level on four edges meet at each vertex inside.
//! - Reference: Doo and Sabin, "Behaviour of recursive division surfaces near extraordinary points", 1978.
//! - Departs from it: nothing, but it has no rule for rims of holes, so they recede at each level.

use std::f64::consts::TAU;

use dgp_mesh::{Connectivity, FaceList, VertexId};

use crate::{
    Error,
    masks::{Masks, Means, Stencil},
    topology::{NONE, Topology},
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

/// The connectivity of the next level, and the face each of its faces comes from.
pub(crate) fn refined(topology: &Topology) -> Result<(Topology, Vec<u32>), Error> {
    let mut faces = FaceList::new();
    let mut parents = Vec::new();
    let mut add = |corners: &mut dyn Iterator<Item = u32>| {
        let face: Vec<u32> = corners.collect();
        let ids: Vec<VertexId> = face.iter().map(|&c| VertexId::new(c as usize)).collect();
        faces.push(&ids);
        parents.push(topology.face(face[0]));
    };
    for f in 0..topology.face_count() as u32 {
        add(&mut topology.corners(f));
    }
    for e in 0..topology.edge_count() as u32 {
        let [c, twin] = [topology.corner(2 * e), topology.corner(2 * e + 1)];
        if c != NONE && twin != NONE {
            add(&mut [topology.next(c), c, topology.next(twin), twin].into_iter());
        }
    }
    let mut spokes = Vec::new();
    for v in 0..topology.vertex_count() {
        if topology.spokes(v, &mut spokes) {
            add(&mut spokes.iter().map(|&h| topology.corner(h)));
        }
    }
    let mesh = Connectivity::from_faces(topology.corner_count(), &faces)?;
    Ok((Topology::new(&mesh), parents))
}
