//! Subdivision of a mesh with the data that travel with it.
//!
//! - Input: a mesh that suits the scheme (see [`RefinementPlan::new`]) with finite coordinates.
//! - Cost: that of a plan, and of joining the refined faces; data cost a mix per element and level.
//! - Guarantees: no position is infinite or no number; groups, texture coordinates, colors and the user's
//!   data travel.
//!
//! | data of | become |
//! |---|---|
//! | vertices | mixed by the same stencils as positions |
//! | corners | within each face or chart (see [`FaceVarying`]), so seams stay; left out where triangles lie across seams: by an odd number of steps of √3 |
//! | edges | those of the two halves; defaults inside faces. Left out by √3 and Doo–Sabin |
//! | faces | those of the face of the cage |

use dgp_mesh::{
    Connectivity, DVec3, FaceId, FaceList, HalfedgeId, Mesh, NORMAL, Normal, Progress, VertexId,
    VertexMap,
    measure::{NormalWeight, vertex_normal},
};

use crate::{
    Counts, Error, RefinementOptions, RefinementPlan, SHARP, SHARPNESS, Scheme, Sharpness,
    face_varying::{FaceVarying, refined_corners},
    options::BoundaryRule,
    plan::{Level, first},
    topology::{NONE, Topology},
};

/// How [`subdivide`] refines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SubdivisionOptions {
    /// Scheme, levels, rims, memory.
    pub refinement: RefinementOptions,
    /// Where the vertices of the result are.
    pub surface: Surface,
    /// How data of corners, such as texture coordinates, are refined.
    pub face_varying: FaceVarying,
}

/// Where refined vertices are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surface {
    /// Where the last level has them, so that the result can be refined further.
    #[default]
    Refined,
    /// On the limit surface.
    Limit,
    /// On the limit surface, with its normals as the vertex attribute [`NORMAL`], in place of normals there
    /// were. Where creases or corners stay sharp for ever inside the surface, which has several normals
    /// there, it is the mean over the faces.
    LimitAndNormals,
}

/// What [`subdivide`] did.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct SubdivisionReport {
    /// Elements of the cage.
    pub cage: Counts,
    /// Elements of the result.
    pub refined: Counts,
    /// V − E + F of the cage and of the result.
    pub euler_characteristic: [i64; 2],
    /// The bytes predicted for the plan and the refined mesh.
    pub predicted_bytes: u64,
    /// The attributes that could not be carried along.
    pub left_out: Vec<String>,
}

/// The mesh refined, with its data, and what is sharp still in the attributes [`SHARPNESS`] if the mesh
/// had any.
///
/// Errors: those of [`RefinementPlan::new`]; [`Error::NotFinite`]; [`Error::NoLimit`] if limit positions
/// are asked of a scheme that has none; [`Error::Mesh`] if faces at holes are left out and what remains
/// hangs together at a vertex only.
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_subdiv::{RefinementOptions, Sharpness, SubdivisionOptions, subdivide};
///
/// let refinement = RefinementOptions { levels: 2, ..RefinementOptions::default() };
/// let options = SubdivisionOptions { refinement, ..SubdivisionOptions::default() };
/// let (mesh, report) = subdivide(&shapes::cube(), &Sharpness::new(), &options, Progress::NONE)?;
/// assert_eq!((mesh.face_count(), report.euler_characteristic), (96, [2, 2]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn subdivide(
    mesh: &Mesh,
    sharpness: &Sharpness,
    options: &SubdivisionOptions,
    progress: Progress<'_>,
) -> Result<(Mesh, SubdivisionReport), Error> {
    check_finite(mesh.positions().values())?;
    let plan = RefinementPlan::new(mesh, sharpness, &options.refinement, progress.part(0.0, 0.4))?;
    let mut positions = plan.refine(mesh.positions().values())?;
    let tangents = match options.surface {
        Surface::LimitAndNormals => Some(plan.limit_tangents(&positions)?),
        Surface::Refined | Surface::Limit => None,
    };
    if options.surface != Surface::Refined {
        positions = plan.limit(&positions)?;
    }
    check_finite(&positions)?;
    progress.report(0.6)?;
    let result = Selection::new(mesh, &plan);
    let mut refined = result.join(&plan, positions)?;
    progress.report(0.8)?;
    let left_out = carry(mesh, options, (&plan, &result), &mut refined, progress.part(0.8, 1.0))?;
    if let Some(tangents) = tangents {
        let normals = result.normals(&plan, &tangents, &refined);
        refined.attributes_mut().corner.remove(NORMAL);
        refined.attributes_mut().vertex.insert(NORMAL, normals);
    }
    let report = SubdivisionReport {
        cage: plan.counts(0),
        refined: Counts {
            vertices: refined.vertex_count() as u64,
            edges: refined.edge_count() as u64,
            corners: result.corner_count(&plan) as u64,
            faces: refined.face_count() as u64,
        },
        euler_characteristic: [mesh.connectivity(), refined.connectivity()].map(|mesh| {
            // Neither has vertices on no face.
            let [v, e, f] = [mesh.vertex_count(), mesh.edge_count(), mesh.face_count()];
            v as i64 - e as i64 + f as i64
        }),
        predicted_bytes: plan.predicted_bytes(),
        left_out,
    };
    Ok((refined, report))
}

pub(crate) fn check_finite(positions: &[DVec3]) -> Result<(), Error> {
    let is_bad = |v: VertexId| !positions[v.index()].is_finite();
    first(positions.len(), is_bad).map_or(Ok(()), |vertex| Err(Error::NotFinite { vertex }))
}

/// Which faces of the last level become those of the result, and the vertices and corners with them.
struct Selection(
    /// `None` if all do.
    Option<Part>,
);

/// Elements of the last level, in order.
struct Part {
    faces: Vec<u32>,
    vertices: Vec<u32>,
    corners: Vec<u32>,
}

impl Selection {
    fn new(mesh: &Mesh, plan: &RefinementPlan) -> Self {
        if plan.options().boundary != BoundaryRule::None {
            return Selection(None);
        }
        let topology = &plan.last().topology;
        let touches = mesh.map_faces(|f| mesh.face_vertices(f).any(|v| mesh.is_boundary_vertex(v)));
        let kept = plan.cage_faces();
        let faces = kept.iter().filter(|(_, cage)| !touches[**cage]).map(|(f, _)| f.index() as u32);
        let faces: Vec<u32> = faces.collect();
        if faces.len() == topology.face_count() {
            return Selection(None);
        }
        let corners: Vec<u32> = faces.iter().flat_map(|&f| topology.corners(f)).collect();
        let mut is_used = vec![false; topology.vertex_count()];
        for &c in &corners {
            is_used[topology.vertex(c) as usize] = true;
        }
        let count = topology.vertex_count() as u32;
        let vertices = (0..count).filter(|&v| is_used[v as usize]).collect();
        Selection(Some(Part { faces, vertices, corners }))
    }

    /// The vertex of the last level that is `v` of the result.
    fn vertex(&self, v: VertexId) -> VertexId {
        match &self.0 {
            Some(part) => VertexId::new(part.vertices[v.index()] as usize),
            None => v,
        }
    }

    /// The face of the last level that is `f` of the result.
    fn face(&self, f: FaceId) -> FaceId {
        match &self.0 {
            Some(part) => FaceId::new(part.faces[f.index()] as usize),
            None => f,
        }
    }

    fn corner_count(&self, plan: &RefinementPlan) -> usize {
        match &self.0 {
            Some(part) => part.corners.len(),
            None => plan.counts(plan.levels()).corners as usize,
        }
    }

    fn join(&self, plan: &RefinementPlan, positions: Vec<DVec3>) -> Result<Mesh, Error> {
        let Some(part) = &self.0 else {
            return Ok(Mesh::from_parts(plan.connectivity(), positions.into()));
        };
        let topology = &plan.last().topology;
        let mut number = vec![NONE; positions.len()];
        part.vertices.iter().zip(0..).for_each(|(&v, new)| number[v as usize] = new);
        let mut list = FaceList::new();
        let mut face = Vec::new();
        for &f in &part.faces {
            face.clear();
            let vertex = |c| VertexId::new(number[topology.vertex(c) as usize] as usize);
            face.extend(topology.corners(f).map(vertex));
            list.push(&face);
        }
        let positions: Vec<DVec3> = part.vertices.iter().map(|&v| positions[v as usize]).collect();
        let connectivity = Connectivity::from_faces(positions.len(), &list)?;
        Ok(Mesh::from_parts(connectivity, positions.into()))
    }

    /// The normals of the result.
    fn normals(
        &self,
        plan: &RefinementPlan,
        [first, second]: &[Vec<DVec3>; 2],
        refined: &Mesh,
    ) -> VertexMap<Normal> {
        let Level { topology, creases, .. } = plan.last();
        let mut sharp_edges = vec![0_u32; first.len()];
        for e in 0..topology.edge_count() {
            if creases.listed_edge(e) >= SHARP && !topology.is_boundary_edge(e) {
                for h in [2 * e as u32, 2 * e as u32 + 1] {
                    sharp_edges[topology.to(h) as usize] += 1;
                }
            }
        }
        refined.map_vertices(|v| {
            let old = self.vertex(v).index();
            // A single sharp edge ends there, where the surface is smooth.
            let is_smooth = if topology.is_boundary_vertex(old) {
                sharp_edges[old] == 0
            } else {
                sharp_edges[old] < 2 && creases.vertex(old) < SHARP
            };
            let normal = first[old].normalize_or_zero().cross(second[old].normalize_or_zero());
            match normal.try_normalize() {
                Some(normal) if is_smooth => Normal(normal),
                _ => Normal(vertex_normal(refined, v, NormalWeight::Angle)),
            }
        })
    }

    /// For each half-edge of the result that has a face, its corner at the last level.
    fn halfedge_corners(&self, topology: &Topology, refined: &Mesh) -> Vec<Option<u32>> {
        let Some(part) = &self.0 else {
            // Half-edges have the numbers they have in the plan.
            let corner = |&c: &u32| (c != NONE).then_some(c);
            return topology.halfedge_corner.iter().map(corner).collect();
        };
        let mut corners = vec![None; refined.halfedge_count()];
        let mut rest = part.corners.as_slice();
        for f in refined.faces() {
            let (mine, others) = rest.split_at(topology.corners(topology.face(rest[0])).len());
            rest = others;
            // Both go around the same way, perhaps from another corner on.
            let vertex = |v: VertexId| self.vertex(v).index() as u32;
            let start = topology.vertex(mine[0]);
            let sides: Vec<HalfedgeId> = refined.face_halfedges(f).collect();
            let first = sides.iter().position(|&h| vertex(refined.from(h)) == start);
            let first = first.expect("a face keeps its corners");
            for (k, &corner) in mine.iter().enumerate() {
                corners[sides[(first + k) % sides.len()].index()] = Some(corner);
            }
        }
        corners
    }
}

/// Gives `refined` the data of `mesh`; returns the names of those that are left out.
fn carry(
    mesh: &Mesh,
    options: &SubdivisionOptions,
    (plan, result): (&RefinementPlan, &Selection),
    refined: &mut Mesh,
    progress: Progress<'_>,
) -> Result<Vec<String>, Error> {
    let (old, scheme) = (mesh.attributes(), plan.options().scheme);
    let mut left_out = Vec::new();
    if !old.vertex.is_empty() {
        let mut data = old.vertex.clone();
        for step in 0..plan.levels() {
            data = plan.step_stencils(step)?.apply_attributes(&data)?;
            progress.report(0.3 * (step + 1) as f64 / plan.levels() as f64)?;
        }
        let pick = |v: VertexId| Some(result.vertex(v));
        refined.attributes_mut().vertex = data.gather(refined.vertex_count(), pick);
    }
    if !old.face.is_empty() {
        let cage_faces = plan.cage_faces();
        let pick = |f: FaceId| Some(cage_faces[result.face(f)]);
        refined.attributes_mut().face = old.face.gather(refined.face_count(), pick);
    }
    progress.report(0.4)?;
    if old.corner.is_empty() && old.edge.is_empty() {
        return Ok(left_out);
    }
    let last = plan.last();
    let corners = result.halfedge_corners(&last.topology, refined);
    if !old.corner.is_empty() {
        let rule = options.face_varying;
        let (data, without) = refined_corners(mesh, plan, rule, progress.part(0.4, 0.9))?;
        left_out.extend(without);
        let pick = |h: HalfedgeId| corners[h.index()].map(|c| VertexId::new(c as usize));
        refined.attributes_mut().corner = data.gather(corners.len(), pick);
    }
    if matches!(scheme, Scheme::Sqrt3 | Scheme::DooSabin) {
        left_out.extend(old.edge.names().map(str::to_owned));
    } else if !old.edge.is_empty() {
        carry_edges(mesh, plan, &corners, refined);
    }
    carry_sharpness(plan, result, &corners, refined);
    Ok(left_out)
}

/// Halves of edges get the data of the whole.
fn carry_edges(mesh: &Mesh, plan: &RefinementPlan, corners: &[Option<u32>], refined: &mut Mesh) {
    let halfedges = &plan.last().topology.corner_halfedge;
    let edges = refined.edge_count();
    let source = |e: dgp_mesh::EdgeId| {
        let corner = e.halfedges().into_iter().find_map(|h| corners[h.index()]);
        let number = halfedges[corner.expect("an edge has a face") as usize] as usize / 2;
        // Each level numbers the halves of edge e 2e and 2e + 1 and all others beyond them.
        let whole = number >> plan.levels();
        (whole < mesh.edge_count()).then(|| dgp_mesh::EdgeId::new(whole))
    };
    refined.attributes_mut().edge = mesh.attributes().edge.gather(edges, source);
}

/// What is left of sharpness, in place of the mixes, where the mesh had any.
fn carry_sharpness(
    plan: &RefinementPlan,
    result: &Selection,
    corners: &[Option<u32>],
    refined: &mut Mesh,
) {
    let level = plan.last();
    if refined.attributes().edge.get::<f64>(SHARPNESS).is_some() {
        let edges = refined.map_edges(|e| {
            let corner = e.halfedges().into_iter().find_map(|h| corners[h.index()]);
            let corner = corner.expect("an edge has a face") as usize;
            let edge = level.topology.corner_halfedge[corner] as usize / 2;
            level.creases.listed_edge(edge)
        });
        refined.attributes_mut().edge.insert(SHARPNESS, edges);
    }
    if refined.attributes().vertex.get::<f64>(SHARPNESS).is_some() {
        let sharp = |v: VertexId| level.creases.vertex(result.vertex(v).index());
        let vertices = refined.map_vertices(sharp);
        refined.attributes_mut().vertex.insert(SHARPNESS, vertices);
    }
}
