//! Adaptive refinement: faces are split where asked only, without cracks.
//!
//! ```text
//! level k:  ask for each face → split those asked for, with all that touch them as support
//!           the rest stays: vertices that a neighbor put on its sides become corners of it
//! ```
//!
//! All vertices lie on the limit surface, where a vertex is the same from each level on, and each is worked
//! out once. So faces of different levels meet exactly; a face beside smaller ones has more corners, which
//! [`dgp_mesh::triangulate`] or the caller may cut.
//!
//! - Input: as for [`RefinementPlan::new`](crate::RefinementPlan::new), for Loop and Catmull–Clark.
//! - Cost: O(faces split and what touches them) per level.
//! - Guarantees: a manifold with the Euler characteristic of the cage; vertices on the limit surface.
//! - Reference: none; the support ring is that of feature-adaptive refinement (Nießner et al., "Feature-
//!   adaptive GPU rendering of Catmull–Clark subdivision surfaces", 2012).

use std::collections::HashMap;

use dgp_mesh::{Connectivity, DVec3, FaceList, Mesh, Progress, VertexId};

use crate::{
    Counts, Error, RefinementOptions, RefinementPlan, Sharpness,
    limit::{Limit, LimitMasks},
    masks,
    plan::Level,
    primal::{Kind, Primal},
    sharpness::Creases,
    split::{split_polygons, split_triangles},
    subdivide::check_finite,
    topology::{NONE, Topology},
};

/// The limit surface of `mesh` with faces split where `wants_split` says so, at most `options.levels` times,
/// without attributes. `wants_split` gets the level of a face and its corners on the limit surface.
///
/// Errors: those of [`RefinementPlan::new`]; [`Error::NoLimit`] unless the scheme is Loop or
/// Catmull–Clark; [`Error::TooLarge`] once what is asked for needs more than `options.memory_limit`;
/// [`Error::NotFinite`]; [`Error::Cancelled`]. `options.boundary` may not leave faces out: `None` is taken
/// as `EdgeOnly`.
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_subdiv::{RefinementOptions, Sharpness, refine_adaptively};
///
/// let options = RefinementOptions { levels: 6, ..RefinementOptions::default() };
/// let top = |_: usize, corners: &[dgp_mesh::DVec3]| corners.iter().any(|p| p.z > 0.25);
/// let mesh = refine_adaptively(&shapes::cube(), &Sharpness::new(), &options, top, Progress::NONE)?;
/// assert_eq!(dgp_mesh::topology::euler_characteristic(&mesh), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refine_adaptively(
    mesh: &Mesh,
    sharpness: &Sharpness,
    options: &RefinementOptions,
    wants_split: impl Fn(usize, &[DVec3]) -> bool,
    progress: Progress<'_>,
) -> Result<Mesh, Error> {
    check_finite(mesh.positions().values())?;
    let scheme = options.scheme;
    let kind = match Kind::of(scheme) {
        Some(kind) if kind != Kind::Bilinear => kind,
        _ => return Err(Error::NoLimit { scheme: scheme.name() }),
    };
    // Checks the cage; its levels are made here.
    let cage = RefinementOptions { levels: 0, ..*options };
    let plan = RefinementPlan::new(mesh, sharpness, &cage, progress.part(0.0, 0.1))?;
    let Level { topology, creases, .. } = plan.last();
    let mut vertices = Vertices::default();
    let ids = (0..mesh.vertex_count()).map(|_| vertices.add()).collect();
    let mut patches = vec![Patch {
        leaves: topology.face_count(),
        topology: topology.clone(),
        creases: creases.clone(),
        values: mesh.positions().values().to_vec(),
        ids,
        asked: Vec::new(),
        part_edges: HashMap::new(),
    }];
    let mut bytes = plan.predicted_bytes();
    for level in 0..=options.levels {
        progress.report(0.1 + 0.7 * level as f64 / (options.levels + 1) as f64)?;
        let patch = &mut patches[level];
        patch.place(kind, &mut vertices);
        check_finite(&vertices.positions)?;
        if level < options.levels {
            patch.ask(level, &vertices, &wants_split);
        }
        if patch.asked.is_empty() {
            break;
        }
        let next = patch.split(kind, &mut vertices);
        bytes = bytes.saturating_add(next.bytes());
        if bytes > options.memory_limit {
            let (faces, limit) = (next.leaves as u64, options.memory_limit);
            return Err(Error::TooLarge { level: level + 1, faces, bytes, limit });
        }
        patches.push(next);
    }
    let result = join(&patches, &vertices)?;
    progress.report(1.0)?;
    Ok(result)
}

/// The vertices of all levels; one that several levels have is one.
#[derive(Default)]
struct Vertices {
    positions: Vec<DVec3>,
    is_placed: Vec<bool>,
}

impl Vertices {
    fn add(&mut self) -> u32 {
        self.positions.push(DVec3::ZERO);
        self.is_placed.push(false);
        self.positions.len() as u32 - 1
    }
}

/// What is there of a level: faces of the result or to be split, then others that support them.
struct Patch {
    topology: Topology,
    creases: Creases,
    /// Where vertices are at this level, not yet on the limit surface.
    values: Vec<DVec3>,
    /// Which vertex of all it is.
    ids: Vec<u32>,
    /// How many faces are not just support.
    leaves: usize,
    /// Those of them to be split, in order.
    asked: Vec<u32>,
    /// For each edge of a face that is split its number in the part that is split.
    part_edges: HashMap<u32, u32>,
}

impl Patch {
    /// Puts the corners of leaves onto the limit surface.
    fn place(&self, kind: Kind, vertices: &mut Vertices) {
        let Patch { topology, creases, .. } = self;
        let masks = LimitMasks { topology, creases, kind, what: Limit::Position };
        let limits = masks::apply(&masks, &self.values);
        for c in (0..self.leaves as u32).flat_map(|f| topology.corners(f)) {
            let v = topology.vertex(c) as usize;
            let id = self.ids[v] as usize;
            if !vertices.is_placed[id] {
                vertices.is_placed[id] = true;
                vertices.positions[id] = limits[v];
            }
        }
    }

    fn ask(
        &mut self,
        level: usize,
        vertices: &Vertices,
        wants_split: impl Fn(usize, &[DVec3]) -> bool,
    ) {
        let mut corners = Vec::new();
        for f in 0..self.leaves as u32 {
            corners.clear();
            let vertex = |c: u32| self.ids[self.topology.vertex(c) as usize] as usize;
            corners.extend(self.topology.corners(f).map(|c| vertices.positions[vertex(c)]));
            if wants_split(level, &corners) {
                self.asked.push(f);
            }
        }
    }

    /// Splits the faces asked for, with all that touch them.
    fn split(&mut self, kind: Kind, vertices: &mut Vertices) -> Patch {
        let topology = &self.topology;
        let mut is_in = vec![false; topology.face_count()];
        let mut faces = self.asked.clone();
        for &f in &faces {
            is_in[f as usize] = true;
        }
        let mut spokes = Vec::new();
        for c in self.asked.iter().flat_map(|&f| topology.corners(f)) {
            topology.spokes(topology.vertex(c) as usize, &mut spokes);
            for corner in spokes.iter().map(|&h| topology.corner(h)).filter(|&c| c != NONE) {
                let f = topology.face(corner);
                if !is_in[f as usize] {
                    is_in[f as usize] = true;
                    faces.push(f);
                }
            }
        }
        let (part, part_vertices, part_edges) = topology.part(&faces);
        let edges = part_edges.iter().map(|&e| self.creases.edge(topology, e as usize)).collect();
        let sharp = part_vertices.iter().map(|&v| self.creases.vertex(v as usize)).collect();
        let creases = Creases::listed(edges, sharp);
        let old: Vec<DVec3> = part_vertices.iter().map(|&v| self.values[v as usize]).collect();
        let values = masks::apply(&Primal::new(&part, &creases, kind), &old);
        let mut ids: Vec<u32> = part_vertices.iter().map(|&v| self.ids[v as usize]).collect();
        ids.resize_with(values.len(), || vertices.add());
        // The faces asked for come first in the part, and so do their children.
        let corners = part.corners(self.asked.len() as u32 - 1).end as usize;
        let (topology, leaves) = match kind {
            Kind::Loop(_) => (split_triangles(&part), 4 * self.asked.len()),
            Kind::CatmullClark | Kind::Bilinear => (split_polygons(&part), corners),
        };
        let of_asked = part.corner_halfedge[..corners].iter().map(|&h| h / 2);
        self.part_edges = of_asked.map(|e| (part_edges[e as usize], e)).collect();
        let creases = creases.refined();
        let (asked, part_edges) = (Vec::new(), HashMap::new());
        Patch { topology, creases, values, ids, leaves, asked, part_edges }
    }

    fn bytes(&self) -> u64 {
        let counts = Counts {
            vertices: self.values.len() as u64,
            edges: self.topology.edge_count() as u64,
            corners: self.topology.corner_count() as u64,
            faces: self.topology.face_count() as u64,
        };
        let none =
            RefinementOptions { levels: 0, memory_limit: u64::MAX, ..RefinementOptions::default() };
        none.predict(counts).map_or(u64::MAX, |(_, bytes)| bytes)
    }
}

/// The leaves of all levels that are not split, with the vertices on their sides.
fn join(patches: &[Patch], vertices: &Vertices) -> Result<Mesh, Error> {
    let mut number = vec![NONE; vertices.positions.len()];
    let mut positions = Vec::new();
    let mut list = FaceList::new();
    let (mut ids, mut face) = (Vec::new(), Vec::new());
    for (level, patch) in patches.iter().enumerate() {
        let mut asked = patch.asked.iter().copied().peekable();
        for f in 0..patch.leaves as u32 {
            if asked.next_if_eq(&f).is_some() {
                continue;
            }
            ids.clear();
            for c in patch.topology.corners(f) {
                ids.push(patch.ids[patch.topology.vertex(c) as usize]);
                side(patches, level, patch.topology.corner_halfedge[c as usize], &mut ids);
            }
            face.clear();
            for &id in &ids {
                if number[id as usize] == NONE {
                    number[id as usize] = positions.len() as u32;
                    positions.push(vertices.positions[id as usize]);
                }
                face.push(VertexId::new(number[id as usize] as usize));
            }
            list.push(&face);
        }
    }
    let connectivity = Connectivity::from_faces(positions.len(), &list)?;
    Ok(Mesh::from_parts(connectivity, positions.into()))
}

/// Adds the vertices that splits have put on a half-edge, in order.
fn side(patches: &[Patch], level: usize, halfedge: u32, ids: &mut Vec<u32>) {
    let Some(&edge) = patches[level].part_edges.get(&(halfedge / 2)) else {
        return;
    };
    // The halves, numbered as the split numbers them, along the half-edge; see `split`.
    let along = 2 * edge + halfedge % 2;
    let next = &patches[level + 1];
    side(patches, level + 1, 2 * along, ids);
    ids.push(next.ids[next.topology.to(2 * along) as usize]);
    side(patches, level + 1, 2 * (along ^ 1) + 1, ids);
}
