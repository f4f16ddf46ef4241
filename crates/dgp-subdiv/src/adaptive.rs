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
//! Data travel the same way: those of vertices to the limit of their own values; those of corners within
//! charts, where a vertex has one value, so that a face gets at the vertices of a smaller neighbor across a
//! seam the values of its own chart; those of faces and edges to their parts.
//!
//! - Input: as for [`RefinementPlan::new`](crate::RefinementPlan::new), for Loop and Catmull–Clark.
//! - Cost: O(faces split and what touches them) per level.
//! - Guarantees: a manifold with the Euler characteristic of the cage; vertices on the limit surface; corners
//!   whose values agree in the cage agree in the result.
//! - Reference: none; the support ring is that of feature-adaptive refinement (Nießner et al., "Feature-
//!   adaptive GPU rendering of Catmull–Clark subdivision surfaces", 2012).

mod data;
mod join;
mod patch;

use dgp_mesh::{DVec3, Mesh, Progress};

use self::{
    data::{Carried, Data},
    patch::{Layer, Patch, Vertices, bytes_of},
};
use crate::{
    Error, FaceVarying, RefinementOptions, RefinementPlan, Scheme, Sharpness,
    face_varying::{Charts, by_corner},
    limit::{Limit, LimitMasks},
    masks,
    plan::Level,
    primal::Kind,
    split::{split_polygons, split_triangles},
    subdivide::check_finite,
};

/// How [`refine_adaptively`] and [`refine_to_tolerance`] refine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AdaptiveOptions {
    /// Scheme, how often faces are split at most, rims, memory. Faces at holes cannot be left out:
    /// [`BoundaryRule::None`](crate::BoundaryRule::None) is taken as `EdgeOnly`.
    pub refinement: RefinementOptions,
    /// How data of corners, such as texture coordinates, are refined.
    pub face_varying: FaceVarying,
}

/// The limit surface of `mesh` with faces split where `wants_split` says so, at most
/// `options.refinement.levels` times, with its data but sharpness. `wants_split` gets the level of a face
/// and its corners on the limit surface.
///
/// Errors: those of [`RefinementPlan::new`]; [`Error::NoLimit`] unless the scheme is Loop or
/// Catmull–Clark; [`Error::TooLarge`] once what is asked for needs more than the memory limit;
/// [`Error::NotFinite`]; [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_subdiv::{AdaptiveOptions, RefinementOptions, Sharpness, refine_adaptively};
///
/// let refinement = RefinementOptions { levels: 6, ..RefinementOptions::default() };
/// let options = AdaptiveOptions { refinement, ..AdaptiveOptions::default() };
/// let top = |_: usize, corners: &[dgp_mesh::DVec3]| corners.iter().any(|p| p.z > 0.25);
/// let mesh = refine_adaptively(&shapes::cube(), &Sharpness::new(), &options, top, Progress::NONE)?;
/// assert_eq!(dgp_mesh::topology::euler_characteristic(&mesh), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refine_adaptively(
    mesh: &Mesh,
    sharpness: &Sharpness,
    options: &AdaptiveOptions,
    wants_split: impl Fn(usize, &[DVec3]) -> bool,
    progress: Progress<'_>,
) -> Result<Mesh, Error> {
    let choose = |patch: &Patch, level: usize, vertices: &Vertices, _: u64| {
        let leaves = if level < options.refinement.levels { patch.leaves } else { 0 };
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
/// `options.refinement.levels` times, with its data but sharpness.
///
/// Each face is split once, so that a bend and its opposite on one edge are seen. From then on it is split
/// if a corner or the middle of the surface above it is farther than `tolerance` from its plane, or the
/// middle above a side from that side. So the deviation is measured at the middles, not bounded.
///
/// Errors: as [`refine_adaptively`], and [`Error::InvalidOption`] unless `tolerance` is positive.
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_subdiv::{AdaptiveOptions, RefinementOptions, Sharpness, refine_to_tolerance};
///
/// let refinement = RefinementOptions { levels: 8, ..RefinementOptions::default() };
/// let options = AdaptiveOptions { refinement, ..AdaptiveOptions::default() };
/// let (cube, smooth) = (shapes::cube(), Sharpness::new());
/// let (mesh, report) = refine_to_tolerance(&cube, &smooth, &options, 1e-3, Progress::NONE)?;
/// assert!(report.faces_beyond == 0 && report.largest_deviation <= 1e-3);
/// assert_eq!(dgp_mesh::topology::euler_characteristic(&mesh), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refine_to_tolerance(
    mesh: &Mesh,
    sharpness: &Sharpness,
    options: &AdaptiveOptions,
    tolerance: f64,
    progress: Progress<'_>,
) -> Result<(Mesh, ToleranceReport), Error> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        let (name, expected) = ("tolerance", "positive");
        return Err(Error::InvalidOption { name, value: tolerance, expected });
    }
    let RefinementOptions { scheme, levels, memory_limit: limit, .. } = options.refinement;
    let kind = kind(scheme)?;
    let mut report = ToleranceReport::default();
    let choose = |patch: &Patch, level: usize, vertices: &Vertices, bytes: u64| {
        report.levels = level;
        let mut asked = Vec::new();
        for (f, deviation) in (0..).zip(patch.deviations(kind, vertices, (bytes, limit), level)?) {
            if level < levels && (level == 0 || deviation > tolerance) {
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
    options: &AdaptiveOptions,
    mut choose: impl FnMut(&Patch, usize, &Vertices, u64) -> Result<Vec<u32>, Error>,
    progress: Progress<'_>,
) -> Result<Mesh, Error> {
    check_finite(mesh.positions().values())?;
    let RefinementOptions { scheme, levels, memory_limit: limit, .. } = options.refinement;
    let kind = kind(scheme)?;
    // Checks the cage; its levels are made here.
    let cage = RefinementOptions { levels: 0, ..options.refinement };
    let plan = RefinementPlan::new(mesh, sharpness, &cage, progress.part(0.0, 0.1))?;
    let (mut vertices, mut patches) = (Vertices::default(), Vec::new());
    let (first, mut data) = start(mesh, &plan, options.face_varying, &mut vertices)?;
    patches.push(first);
    let mut bytes = plan.predicted_bytes();
    for level in 0..=levels {
        progress.report(0.1 + 0.7 * level as f64 / (levels + 1) as f64)?;
        let patch: &mut Patch = &mut patches[level];
        patch.place(kind, &mut vertices);
        check_finite(&vertices.positions)?;
        let asked = choose(patch, level, &vertices, bytes)?;
        if level == levels || asked.is_empty() {
            break;
        }
        patch.asked = asked;
        let next = patch.split(kind, &mut vertices, &mut data);
        bytes = bytes.saturating_add(next.bytes());
        if bytes > limit {
            let faces = next.leaves as u64;
            return Err(Error::TooLarge { level: level + 1, faces, bytes, limit });
        }
        patches.push(next);
    }
    let result = join::join(mesh, &patches, &vertices, &mut data, kind)?;
    progress.report(1.0)?;
    Ok(result)
}

/// The cage, and its data.
fn start(
    mesh: &Mesh,
    plan: &RefinementPlan,
    rule: FaceVarying,
    vertices: &mut Vertices,
) -> Result<(Patch, Data), Error> {
    let Level { topology, creases, .. } = plan.last();
    let ids = (0..mesh.vertex_count()).map(|_| vertices.add()).collect();
    let attributes = mesh.attributes();
    let mut data = Data { vertex: None, corner: None };
    if !attributes.vertex.is_empty() {
        data.vertex = Some(Carried::new(attributes.vertex.clone(), false));
    }
    let mut charts = None;
    if !attributes.corner.is_empty() {
        let corners = by_corner(mesh, topology);
        let cut = Charts::new(plan.last(), &corners, rule)?;
        let cut_plan = cut.plan(plan, Progress::NONE)?;
        let Level { topology, creases, .. } = cut_plan.last();
        let ids = (0..topology.vertex_count() as u32).collect();
        charts = Some(Layer::new(topology, creases, ids));
        data.corner = Some(Carried::new(cut.values(&corners), rule == FaceVarying::Linear));
    }
    let patch = Patch {
        surface: Layer::new(topology, creases, ids),
        charts,
        values: mesh.positions().values().to_vec(),
        leaves: topology.face_count(),
        asked: Vec::new(),
        cage_faces: (0..topology.face_count() as u32).collect(),
        cage_edges: (0..topology.edge_count() as u32).collect(),
    };
    Ok((patch, data))
}

impl Patch {
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
        let (part, values) = self.part(&leaves, kind);
        let (part, creases) = (part.topology, part.creases);
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
