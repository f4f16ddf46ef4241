//! What there is of a level: the faces of the result or to be split, and those that support them.

use std::collections::HashMap;

use dgp_mesh::DVec3;

use super::data::{Carried, Data};
use crate::{
    Counts, RefinementOptions,
    limit::{Limit, LimitMasks},
    masks,
    primal::{Kind, Primal},
    sharpness::Creases,
    split::{split_polygons, split_triangles},
    topology::{NONE, Topology},
};

/// The vertices of all levels; one that several levels have is one.
#[derive(Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<DVec3>,
    is_placed: Vec<bool>,
}

impl Vertices {
    pub(super) fn add(&mut self) -> u32 {
        self.positions.push(DVec3::ZERO);
        self.is_placed.push(false);
        self.positions.len() as u32 - 1
    }
}

/// How the faces of a level hang together: on the surface, or within charts.
pub(super) struct Layer {
    pub(super) topology: Topology,
    pub(super) creases: Creases,
    /// Which vertex of all levels a vertex is.
    pub(super) ids: Vec<u32>,
    /// Where the data of its vertices begin.
    pub(super) first_row: usize,
    /// For edges of the part that is split their numbers in it.
    pub(super) part_edges: HashMap<u32, u32>,
}

/// Faces that are split with all that touch them.
pub(super) struct Part {
    /// As it is before the split.
    pub(super) topology: Topology,
    pub(super) creases: Creases,
    /// Which vertices and edges of the layer its own are.
    pub(super) vertices: Vec<u32>,
    edges: Vec<u32>,
}

impl Layer {
    pub(super) fn new(topology: &Topology, creases: &Creases, ids: Vec<u32>) -> Self {
        let (topology, creases) = (topology.clone(), creases.clone());
        Layer { topology, creases, ids, first_row: 0, part_edges: HashMap::new() }
    }

    fn part(&self, faces: &[u32]) -> Part {
        let Layer { topology, creases, .. } = self;
        let (part, vertices, edges) = topology.part(faces);
        let sharp_edges = edges.iter().map(|&e| creases.edge(topology, e as usize)).collect();
        let sharp = vertices.iter().map(|&v| creases.vertex(v as usize)).collect();
        Part { topology: part, creases: Creases::listed(sharp_edges, sharp), vertices, edges }
    }

    /// The next level of `part`; new vertices get numbers from `add`.
    fn next(&self, part: &Part, kind: Kind, mut add: impl FnMut() -> u32) -> Layer {
        let topology = split(&part.topology, kind);
        let mut ids: Vec<u32> = part.vertices.iter().map(|&v| self.ids[v as usize]).collect();
        ids.resize_with(topology.vertex_count(), &mut add);
        Layer::new(&topology, &part.creases.refined(), ids)
    }
}

fn split(topology: &Topology, kind: Kind) -> Topology {
    match kind {
        Kind::Loop(_) => split_triangles(topology),
        Kind::CatmullClark | Kind::Bilinear => split_polygons(topology),
    }
}

/// What there is of a level: faces of the result or to be split, then others that support them.
pub(super) struct Patch {
    pub(super) surface: Layer,
    /// The same faces and corners cut open along seams, if there are data of corners.
    pub(super) charts: Option<Layer>,
    /// Where vertices are at this level, not yet on the limit surface.
    pub(super) values: Vec<DVec3>,
    /// How many faces are not just support.
    pub(super) leaves: usize,
    /// Those of them to be split, in order.
    pub(super) asked: Vec<u32>,
    /// The face of the cage that each leaf lies in.
    pub(super) cage_faces: Vec<u32>,
    /// The edge of the cage that each edge lies on, or none.
    pub(super) cage_edges: Vec<u32>,
}

impl Patch {
    /// Puts the corners of leaves onto the limit surface.
    pub(super) fn place(&self, kind: Kind, vertices: &mut Vertices) {
        let Layer { topology, creases, ids, .. } = &self.surface;
        let masks = LimitMasks { topology, creases, kind, what: Limit::Position };
        let limits = masks::apply(&masks, &self.values);
        for c in (0..self.leaves as u32).flat_map(|f| topology.corners(f)) {
            let v = topology.vertex(c) as usize;
            let id = ids[v] as usize;
            if !vertices.is_placed[id] {
                vertices.is_placed[id] = true;
                vertices.positions[id] = limits[v];
            }
        }
    }

    /// Where the corners of a leaf are on the limit surface.
    pub(super) fn corners(&self, f: u32, vertices: &Vertices, corners: &mut Vec<DVec3>) {
        corners.clear();
        let Layer { topology, ids, .. } = &self.surface;
        let id = |c: u32| ids[topology.vertex(c) as usize] as usize;
        corners.extend(topology.corners(f).map(|c| vertices.positions[id(c)]));
    }

    /// `asked`, then the faces that touch them.
    fn with_support(&self, asked: &[u32]) -> Vec<u32> {
        let topology = &self.surface.topology;
        let mut is_in = vec![false; topology.face_count()];
        let mut faces = asked.to_vec();
        for &f in &faces {
            is_in[f as usize] = true;
        }
        let mut spokes = Vec::new();
        for c in asked.iter().flat_map(|&f| topology.corners(f)) {
            topology.spokes(topology.vertex(c) as usize, &mut spokes);
            for corner in spokes.iter().map(|&h| topology.corner(h)).filter(|&c| c != NONE) {
                let f = topology.face(corner);
                if !is_in[f as usize] {
                    is_in[f as usize] = true;
                    faces.push(f);
                }
            }
        }
        faces
    }

    /// `faces` and all that touch them, before the split, and where vertices are after it.
    pub(super) fn part(&self, faces: &[u32], kind: Kind) -> (Part, Vec<DVec3>) {
        let part = self.surface.part(&self.with_support(faces));
        let old: Vec<DVec3> = part.vertices.iter().map(|&v| self.values[v as usize]).collect();
        let values = masks::apply(&Primal::new(&part.topology, &part.creases, kind), &old);
        (part, values)
    }

    /// Splits the faces asked for, with all that touch them.
    pub(super) fn split(&mut self, kind: Kind, vertices: &mut Vertices, data: &mut Data) -> Patch {
        let (part, values) = self.part(&self.asked, kind);
        let Part { topology, .. } = &part;
        let mut surface = self.surface.next(&part, kind, || vertices.add());
        if let Some(carried) = &mut data.vertex {
            surface.first_row = carried.refine(self.surface.first_row, &part, kind);
        }
        // The faces asked for come first in the part, and so do their children.
        let corners = topology.corners(self.asked.len() as u32 - 1).end;
        let cage_face = |f: u32| self.cage_faces[self.asked[f as usize] as usize];
        let (leaves, cage_faces) = match kind {
            Kind::Loop(_) => {
                let leaves = 4 * self.asked.len();
                (leaves, (0..leaves as u32).map(|f| cage_face(f / 4)).collect())
            }
            Kind::CatmullClark | Kind::Bilinear => {
                (corners as usize, (0..corners).map(|c| cage_face(topology.face(c))).collect())
            }
        };
        // Halves of edges come first, then new edges.
        let halves = part.edges.iter().flat_map(|&e| [self.cage_edges[e as usize]; 2]);
        let mut cage_edges: Vec<u32> = halves.collect();
        cage_edges.resize(surface.topology.edge_count(), NONE);
        let of_asked = topology.corner_halfedge[..corners as usize].iter().map(|&h| h / 2);
        self.surface.part_edges = of_asked.map(|e| (part.edges[e as usize], e)).collect();
        let faces = self.with_support(&self.asked);
        let charts = match (&mut self.charts, &mut data.corner) {
            (Some(charts), Some(carried)) => Some(charts.split(&faces, kind, carried)),
            _ => None,
        };
        Patch { surface, charts, values, leaves, asked: Vec::new(), cage_faces, cage_edges }
    }

    pub(super) fn bytes(&self) -> u64 {
        let charts = self.charts.as_ref().map_or(0, |charts| bytes_of(&charts.topology));
        bytes_of(&self.surface.topology).saturating_add(charts)
    }
}

impl Layer {
    /// Splits `faces` of the charts as those of the surface are.
    fn split(&mut self, faces: &[u32], kind: Kind, carried: &mut Carried) -> Layer {
        let part = self.part(faces);
        let mut next = self.next(&part, kind, || carried.add());
        next.first_row = carried.refine(self.first_row, &part, kind);
        // Of all faces: what is split on one side of a seam puts vertices on the other side too.
        self.part_edges = part.edges.iter().copied().zip(0..).collect();
        next
    }
}

pub(super) fn bytes_of(topology: &Topology) -> u64 {
    let counts = Counts {
        vertices: topology.vertex_count() as u64,
        edges: topology.edge_count() as u64,
        corners: topology.corner_count() as u64,
        faces: topology.face_count() as u64,
    };
    let none =
        RefinementOptions { levels: 0, memory_limit: u64::MAX, ..RefinementOptions::default() };
    none.predict(counts).map_or(u64::MAX, |(_, bytes)| bytes)
}
