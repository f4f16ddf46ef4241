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
    Counts, Error, RefinementOptions, RefinementPlan, Scheme, Sharpness,
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
    let choose = |patch: &Patch, level: usize, vertices: &Vertices, _: u64| {
        let leaves = if level < options.levels { patch.leaves } else { 0 };
        Ok(patch.asked(0..leaves as u32, level, vertices, &wants_split))
    };
    refine(mesh, sharpness, options, choose, progress)
}

/// What [`refine_to_tolerance`] reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use]
pub struct ToleranceReport {
    /// How often the faces that were split most were split.
    pub levels: usize,
    /// How far, at most, the limit surface was found off the faces.
    pub largest_deviation: f64,
    /// How many faces are off by more than the tolerance, because `levels` did not suffice.
    pub faces_beyond: usize,
}

/// The limit surface of `mesh` with faces split until they are as flat as `tolerance`, a length, at most
/// `options.levels` times, without attributes.
///
/// Each face is split once, so that a bend and its opposite on one edge are seen. From then on it is split
/// if a corner or the middle of the surface above it is farther than `tolerance` from its plane, or the
/// middle above a side from that side. So the deviation is measured at the middles, not bounded.
///
/// Errors: as [`refine_adaptively`], and [`Error::InvalidOption`] unless `tolerance` is positive.
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_subdiv::{RefinementOptions, Sharpness, refine_to_tolerance};
///
/// let options = RefinementOptions { levels: 8, ..RefinementOptions::default() };
/// let (cube, smooth) = (shapes::cube(), Sharpness::new());
/// let (mesh, report) = refine_to_tolerance(&cube, &smooth, &options, 1e-3, Progress::NONE)?;
/// assert!(report.faces_beyond == 0 && report.largest_deviation <= 1e-3);
/// assert_eq!(dgp_mesh::topology::euler_characteristic(&mesh), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refine_to_tolerance(
    mesh: &Mesh,
    sharpness: &Sharpness,
    options: &RefinementOptions,
    tolerance: f64,
    progress: Progress<'_>,
) -> Result<(Mesh, ToleranceReport), Error> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        let (name, expected) = ("tolerance", "positive");
        return Err(Error::InvalidOption { name, value: tolerance, expected });
    }
    let kind = kind(options.scheme)?;
    let mut report = ToleranceReport::default();
    let choose = |patch: &Patch, level: usize, vertices: &Vertices, bytes: u64| {
        report.levels = level;
        let mut asked = Vec::new();
        let limit = options.memory_limit;
        for (f, deviation) in (0..).zip(patch.deviations(kind, vertices, (bytes, limit), level)?) {
            if level < options.levels && (level == 0 || deviation > tolerance) {
                asked.push(f);
            } else {
                report.largest_deviation = report.largest_deviation.max(deviation);
                report.faces_beyond += usize::from(deviation > tolerance);
            }
        }
        Ok(asked)
    };
    let refined = refine(mesh, sharpness, options, choose, progress)?;
    Ok((refined, report))
}

fn kind(scheme: Scheme) -> Result<Kind, Error> {
    match Kind::of(scheme) {
        Some(kind) if kind != Kind::Bilinear => Ok(kind),
        _ => Err(Error::NoLimit { scheme: scheme.name() }),
    }
}

/// Splits the faces that `choose` lists, given what there is of a level, its number, all vertices and the
/// bytes used so far. What it lists of the last level is not split.
fn refine(
    mesh: &Mesh,
    sharpness: &Sharpness,
    options: &RefinementOptions,
    mut choose: impl FnMut(&Patch, usize, &Vertices, u64) -> Result<Vec<u32>, Error>,
    progress: Progress<'_>,
) -> Result<Mesh, Error> {
    check_finite(mesh.positions().values())?;
    let kind = kind(options.scheme)?;
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
        let asked = choose(patch, level, &vertices, bytes)?;
        if level == options.levels || asked.is_empty() {
            break;
        }
        patch.asked = asked;
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

    /// Where the corners of a leaf are on the limit surface.
    fn corners(&self, f: u32, vertices: &Vertices, corners: &mut Vec<DVec3>) {
        corners.clear();
        let id = |c: u32| self.ids[self.topology.vertex(c) as usize] as usize;
        corners.extend(self.topology.corners(f).map(|c| vertices.positions[id(c)]));
    }

    /// Those of `leaves` that are to be split.
    fn asked(
        &self,
        leaves: std::ops::Range<u32>,
        level: usize,
        vertices: &Vertices,
        wants_split: impl Fn(usize, &[DVec3]) -> bool,
    ) -> Vec<u32> {
        let mut corners = Vec::new();
        let wants = |&f: &u32| {
            self.corners(f, vertices, &mut corners);
            wants_split(level, &corners)
        };
        leaves.filter(wants).collect()
    }

    /// How far each leaf is from the limit surface above its middle and those of its sides, and from flat.
    fn deviations(
        &self,
        kind: Kind,
        vertices: &Vertices,
        (bytes, limit): (u64, u64),
        level: usize,
    ) -> Result<Vec<f64>, Error> {
        let leaves: Vec<u32> = (0..self.leaves as u32).collect();
        if leaves.is_empty() {
            return Ok(Vec::new());
        }
        let Part { topology: part, creases, values, .. } = self.part(&leaves, kind);
        let topology = match kind {
            Kind::Loop(_) => split_triangles(&part),
            Kind::CatmullClark | Kind::Bilinear => split_polygons(&part),
        };
        let bytes = bytes.saturating_add(bytes_of(&topology));
        if bytes > limit {
            let faces = topology.face_count() as u64;
            return Err(Error::TooLarge { level: level + 1, faces, bytes, limit });
        }
        let creases = creases.refined();
        let what = Limit::Position;
        let masks = LimitMasks { topology: &topology, creases: &creases, kind, what };
        let limits = masks::apply(&masks, &values);
        // Points on edges are numbered after the vertices, points in faces after those.
        let (edges, faces) = (part.vertex_count(), part.vertex_count() + part.edge_count());
        let mut corners = Vec::new();
        let deviation = |f: &u32| {
            self.corners(*f, vertices, &mut corners);
            let mut worst = 0.0_f64;
            let next = corners.iter().cycle().skip(1);
            for ((&a, &b), c) in corners.iter().zip(next).zip(part.corners(*f)) {
                let middle = limits[edges + part.corner_halfedge[c as usize] as usize / 2];
                worst = worst.max(distance_to_segment(middle, a, b));
            }
            let in_face = match kind {
                Kind::Loop(_) => None,
                Kind::CatmullClark | Kind::Bilinear => Some(limits[faces + *f as usize]),
            };
            worst.max(distance_to_plane(&corners, in_face))
        };
        Ok(leaves.iter().map(deviation).collect())
    }

    /// `faces` and all that touch them, refined once.
    fn part(&self, asked: &[u32], kind: Kind) -> Part {
        let topology = &self.topology;
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
        let (part, vertices, edges) = topology.part(&faces);
        let sharp_edges = edges.iter().map(|&e| self.creases.edge(topology, e as usize)).collect();
        let sharp = vertices.iter().map(|&v| self.creases.vertex(v as usize)).collect();
        let creases = Creases::listed(sharp_edges, sharp);
        let old: Vec<DVec3> = vertices.iter().map(|&v| self.values[v as usize]).collect();
        let values = masks::apply(&Primal::new(&part, &creases, kind), &old);
        Part { topology: part, creases, values, vertices, edges }
    }

    /// Splits the faces asked for, with all that touch them.
    fn split(&mut self, kind: Kind, vertices: &mut Vertices) -> Patch {
        let Part { topology: part, creases, values, vertices: part_vertices, edges: part_edges } =
            self.part(&self.asked, kind);
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
        bytes_of(&self.topology)
    }
}

/// Faces that are split with all that touch them.
struct Part {
    /// As it is before the split.
    topology: Topology,
    creases: Creases,
    /// Where vertices are after it.
    values: Vec<DVec3>,
    /// Which vertices and edges of the patch its own are.
    vertices: Vec<u32>,
    edges: Vec<u32>,
}

fn bytes_of(topology: &Topology) -> u64 {
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

fn distance_to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (ab, ap) = (b - a, p - a);
    let square = ab.length_squared();
    let t = if square > 0.0 { (ap.dot(ab) / square).clamp(0.0, 1.0) } else { 0.0 };
    ap.distance(t * ab)
}

/// How far corners and one more point are from the plane through the mean of the corners that is as
/// parallel to them as can be.
fn distance_to_plane(corners: &[DVec3], point: Option<DVec3>) -> f64 {
    let center = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let next = corners.iter().cycle().skip(1);
    let normal: DVec3 =
        corners.iter().zip(next).map(|(&a, &b)| (a - center).cross(b - center)).sum();
    let normal = normal.normalize_or_zero();
    let points = corners.iter().copied().chain(point);
    points.map(|p| (p - center).dot(normal).abs()).fold(0.0, f64::max)
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
