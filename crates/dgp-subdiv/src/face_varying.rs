//! Values at corners, such as texture coordinates: refined within charts, so that seams stay.
//!
//! ```text
//! linear    at an old vertex the value of the corner, on an edge the mean of the two corners of the face,
//!           in a face the mean of its corners
//! others    by the masks of positions, on the mesh cut open along seams; which vertices of its rims stay
//!           where they are is the rule
//! √3        linear: two steps cut a triangle into nine, whose corners are at thirds of its sides
//! ```
//!
//! A seam is an edge at one end of which its two faces have different values. Corners around a vertex
//! share a value where no seam is between them.
//!
//! - Input: a mesh with values at corners, and the plan of its refinement.
//! - Cost: O(corners) per level; but for `linear`, that of a second plan.
//! - Guarantees: where two faces agree at an edge they agree along its halves; no value crosses a seam.
//! - Reference: DeRose, Kass and Truong, "Subdivision surfaces in character animation", SIGGRAPH 1998,
//!   section 5; the choice of rules is that of OpenSubdiv.

use dgp_mesh::{
    AttributeTable, Connectivity, EdgeId, FaceList, HalfedgeId, Mesh, Progress, VertexId,
};

use crate::{
    BoundaryRule, Error, RefinementOptions, RefinementPlan, SHARP, Scheme, Sharpness, StencilTable,
    doo_sabin::doo_sabin_weight,
    masks::Stencil,
    plan::Level,
    topology::{NONE, Topology},
};

/// How values at corners are refined. Loop and Catmull–Clark have all rules; other schemes are linear.
///
/// The names in brackets are those of OpenSubdiv, `FVAR_LINEAR_…`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceVarying {
    /// Within each face (`ALL`).
    #[default]
    Linear,
    /// As positions are. Rims of charts are smooth curves through the corners of charts, the vertices where
    /// a chart has one face (`CORNERS_ONLY`).
    Smooth,
    /// Corners of charts are smooth too (`NONE`).
    SmoothCorners,
    /// As `Smooth`, and vertices where more than two charts meet stay (`CORNERS_PLUS1`).
    SharpJunctions,
    /// As `SharpJunctions`; ends of seams stay, and both charts where one of two has a corner
    /// (`CORNERS_PLUS2`).
    SharpEnds,
    /// As positions are, but all rims of charts are straight (`BOUNDARIES`).
    SharpRims,
}

/// The data of the corners of the last level, by corner, given those of the cage, by half-edge; and the
/// names of those left out.
pub(crate) fn refined_corners(
    mesh: &Mesh,
    plan: &RefinementPlan,
    rule: FaceVarying,
    progress: Progress<'_>,
) -> Result<(AttributeTable<VertexId>, Vec<String>), Error> {
    let mut data = by_corner(mesh, &plan.level(0).topology);
    let scheme = plan.options().scheme;
    if scheme == Scheme::Sqrt3 {
        return thirds(plan, data, progress);
    }
    if rule != FaceVarying::Linear && scheme.has_creases() {
        return Ok((smooth(plan, &data, rule, progress)?, Vec::new()));
    }
    for step in 0..plan.levels() {
        data = corner_stencils(plan, step)?.apply_attributes(&data)?;
        progress.report((step + 1) as f64 / plan.levels() as f64)?;
    }
    Ok((data, Vec::new()))
}

/// The data of corners by corner, which tables call vertices.
pub(crate) fn by_corner(mesh: &Mesh, cage: &Topology) -> AttributeTable<VertexId> {
    let halfedge = |c: VertexId| HalfedgeId::new(cage.corner_halfedge[c.index()] as usize);
    mesh.attributes().corner.gather(cage.corner_count(), |c: VertexId| Some(halfedge(c)))
}

/// Refines on the cage cut open along its seams.
fn smooth(
    plan: &RefinementPlan,
    data: &AttributeTable<VertexId>,
    rule: FaceVarying,
    progress: Progress<'_>,
) -> Result<AttributeTable<VertexId>, Error> {
    let charts = Charts::new(plan.level(0), data, rule)?;
    let (second, mut values) = (charts.plan(plan, progress.part(0.0, 0.5))?, charts.values(data));
    for step in 0..second.levels() {
        values = second.step_stencils(step)?.apply_attributes(&values)?;
        progress.report(0.5 + 0.5 * (step + 1) as f64 / second.levels() as f64)?;
    }
    // Both plans split corner by corner, so corners have the same numbers.
    let last = &second.last().topology;
    let pick = |c: VertexId| Some(VertexId::new(last.vertex(c.index() as u32) as usize));
    Ok(values.gather(last.corner_count(), pick))
}

/// The cage cut open along the seams of its data. Faces and corners keep their numbers.
pub(crate) struct Charts {
    connectivity: Connectivity,
    sharpness: Sharpness,
    /// A corner of the cage at each vertex.
    sources: Vec<u32>,
}

impl Charts {
    pub(crate) fn new(
        cage: &Level,
        data: &AttributeTable<VertexId>,
        rule: FaceVarying,
    ) -> Result<Self, Error> {
        let Level { topology, creases, .. } = cage;
        let Cut { place, sources, stays } = Cut::new(topology, data, rule);
        let mut faces = FaceList::new();
        for f in 0..topology.face_count() as u32 {
            let corners = topology.corners(f).map(|c| VertexId::new(place[c as usize] as usize));
            faces.push(&corners.collect::<Vec<_>>());
        }
        let connectivity = Connectivity::from_faces(sources.len(), &faces)?;
        let mut sharpness = Sharpness::new();
        for (c, &h) in Topology::new(&connectivity).corner_halfedge.iter().enumerate() {
            let edge = creases.listed_edge(topology.corner_halfedge[c] as usize / 2);
            sharpness.set_edge(EdgeId::new(h as usize / 2), edge);
            let vertex = creases.vertex(topology.vertex(c as u32) as usize);
            let vertex = if stays[place[c] as usize] { SHARP } else { vertex };
            sharpness.set_vertex(VertexId::new(place[c] as usize), vertex);
        }
        Ok(Charts { connectivity, sharpness, sources })
    }

    /// Refines the charts as `plan` does the cage.
    pub(crate) fn plan(
        &self,
        plan: &RefinementPlan,
        progress: Progress<'_>,
    ) -> Result<RefinementPlan, Error> {
        // The rule has chosen the corners that stay.
        let options = RefinementOptions { boundary: BoundaryRule::EdgeOnly, ..*plan.options() };
        RefinementPlan::new(&self.connectivity, &self.sharpness, &options, progress)
    }

    /// The data of the vertices, given those of corners of the cage.
    pub(crate) fn values(&self, data: &AttributeTable<VertexId>) -> AttributeTable<VertexId> {
        let pick = |v: VertexId| Some(VertexId::new(self.sources[v.index()] as usize));
        data.gather(self.sources.len(), pick)
    }
}

/// Where the cage is cut.
#[derive(Default)]
struct Cut {
    /// The vertex of each corner.
    place: Vec<u32>,
    /// A corner of each vertex.
    sources: Vec<u32>,
    /// Whether the rule keeps the vertex where it is.
    stays: Vec<bool>,
}

impl Cut {
    fn new(cage: &Topology, data: &AttributeTable<VertexId>, rule: FaceVarying) -> Self {
        let mut cut = Cut { place: vec![NONE; cage.corner_count()], ..Cut::default() };
        let (mut spokes, mut counts) = (Vec::new(), Vec::new());
        for v in 0..cage.vertex_count() {
            let closed = cage.spokes(v, &mut spokes);
            spokes.retain(|&h| cage.corner(h) != NONE);
            // From a seam on, so that none of the runs of corners between seams is met twice.
            let first = spokes.iter().position(|&h| is_seam(cage, data, h));
            spokes.rotate_left(first.unwrap_or(0));
            counts.clear();
            for (k, &h) in spokes.iter().enumerate() {
                let corner = cage.corner(h);
                if k == 0 || is_seam(cage, data, h) {
                    cut.sources.push(corner);
                    counts.push(0_usize);
                }
                cut.place[corner as usize] = cut.sources.len() as u32 - 1;
                if let Some(last) = counts.last_mut() {
                    *last += 1;
                }
            }
            let at_rim = first.is_some() || !closed;
            let any_corner = counts.contains(&1);
            cut.stays.extend(counts.iter().map(|&faces| {
                let is_corner = at_rim && faces == 1;
                let is_junction = counts.len() > 2;
                let is_end = closed && at_rim && counts.len() == 1;
                match rule {
                    FaceVarying::Linear | FaceVarying::SmoothCorners => false,
                    FaceVarying::Smooth => is_corner,
                    FaceVarying::SharpJunctions => is_corner || is_junction,
                    FaceVarying::SharpEnds => {
                        let beside_corner = counts.len() == 2 && any_corner;
                        is_corner || is_junction || is_end || beside_corner
                    }
                    FaceVarying::SharpRims => at_rim,
                }
            }));
        }
        cut
    }
}

/// Whether the faces at the edge of `h` have different values at one of its ends, or one face is missing.
fn is_seam(cage: &Topology, data: &AttributeTable<VertexId>, h: u32) -> bool {
    let (c, twin) = (cage.corner(h), cage.corner(h ^ 1));
    if c == NONE || twin == NONE {
        return true;
    }
    across(cage, c, twin).into_iter().any(|[a, b]| !data.equal(a, b))
}

/// The corners of two faces at the ends of the edge between them, that start at `c` and `twin`.
fn across(cage: &Topology, c: u32, twin: u32) -> [[VertexId; 2]; 2] {
    let id = |c: u32| VertexId::new(c as usize);
    [[id(c), id(cage.next(twin))], [id(cage.next(c)), id(twin)]]
}

/// The stencils from the corners of level `step` to those of the next. Not for √3, whose triangles
/// lie in two faces each.
fn corner_stencils(plan: &RefinementPlan, step: usize) -> Result<StencilTable, Error> {
    let (old, new) = (&plan.level(step).topology, &plan.level(step + 1).topology);
    let write: &(dyn Fn(u32, &mut Stencil) + Sync) = match plan.options().scheme {
        Scheme::CatmullClark | Scheme::Bilinear => &|child, stencil| polygon(old, child, stencil),
        Scheme::Loop(_) | Scheme::Butterfly(_) => &|child, stencil| triangle(child, stencil),
        Scheme::DooSabin => &|child, stencil| {
            // A new vertex is a corner of this level.
            let corner = new.vertex(child);
            let corners = old.corners(old.face(corner));
            let degree = corners.len();
            for c in corners {
                stencil.push(c, doo_sabin_weight(degree, corner.abs_diff(c) as usize));
            }
        },
        Scheme::Sqrt3 => return Err(Error::NoLimit { scheme: "√3" }),
    };
    StencilTable::from_rows(old.corner_count(), new.corner_count(), |row, stencil| {
        write(row as u32, stencil);
        stencil.entries.sort_unstable_by_key(|&(column, _)| column);
    })
}

/// Child 4c + k: the corner, the middle of its side, the middle of the face, that of the side before.
fn polygon(old: &Topology, child: u32, stencil: &mut Stencil) {
    let c = child / 4;
    match child % 4 {
        0 => stencil.push(c, 1.0),
        1 => [c, old.next(c)].into_iter().for_each(|c| stencil.push(c, 0.5)),
        2 => {
            let corners = old.corners(old.face(c));
            let weight = 1.0 / corners.len() as f64;
            corners.for_each(|c| stencil.push(c, weight));
        }
        _ => [old.prev(c), c].into_iter().for_each(|c| stencil.push(c, 0.5)),
    }
}

/// Child 12f + 3k + i of the triangle at corner k, 12f + 9 + k of that in the middle.
fn triangle(child: u32, stencil: &mut Stencil) {
    let (first, k, i) = (child / 12 * 3, child % 12 / 3, child % 3);
    let corner = |k: u32| first + k % 3;
    let ends = match (k, i) {
        (3, i) => [corner(i), corner(i + 1)],
        (k, 0) => return stencil.push(corner(k), 1.0),
        (k, 1) => [corner(k), corner(k + 1)],
        (k, _) => [corner(k), corner(k + 2)],
    };
    for c in ends {
        stencil.push(c, 0.5);
    }
}

/// The data of corners under √3, and the names of those left out: after an odd number of steps triangles lie
/// across the old edges, and a column with seams has no value for them.
fn thirds(
    plan: &RefinementPlan,
    mut data: AttributeTable<VertexId>,
    progress: Progress<'_>,
) -> Result<(AttributeTable<VertexId>, Vec<String>), Error> {
    let level = |k: usize| &plan.level(k).topology;
    for step in (0..plan.levels() / 2).map(|pair| 2 * pair) {
        let (old, new) = (level(step), level(step + 2));
        let thirds = Thirds::new(old);
        let stencils =
            StencilTable::from_rows(old.corner_count(), new.corner_count(), |row, stencil| {
                thirds.write(new, row as u32, stencil);
            })?;
        data = stencils.apply_attributes(&data)?;
        progress.report((step + 2) as f64 / plan.levels() as f64)?;
    }
    if plan.levels().is_multiple_of(2) {
        return Ok((data, Vec::new()));
    }
    let (old, new) = (level(plan.levels() - 1), level(plan.levels()));
    let halfedges = 0..2 * old.edge_count() as u32;
    let inner =
        halfedges.map(|h| [old.corner(h), old.corner(h ^ 1)]).filter(|c| !c.contains(&NONE));
    let left_out = data.differing(inner.flat_map(|[c, twin]| across(old, c, twin)));
    for name in &left_out {
        data.remove(name);
    }
    // Without seams all corners at a vertex agree.
    let stencils =
        StencilTable::from_rows(old.corner_count(), new.corner_count(), |row, stencil| {
            let v = new.vertex(row as u32) as usize;
            match v.checked_sub(old.vertex_count()) {
                None => stencil.push(old.corner(old.vertex_halfedge[v]), 1.0),
                Some(face) => old.corners(face as u32).for_each(|c| stencil.push(c, 1.0 / 3.0)),
            }
        })?;
    Ok((stencils.apply_attributes(&data)?, left_out))
}

/// The face of the cage that each face of the last level under √3 lies in; after an odd number of steps, when
/// faces lie across edges, one of the two.
pub(crate) fn faces_of_thirds(plan: &RefinementPlan) -> Vec<u32> {
    let count = |k: usize| plan.level(k).topology.face_count() as u32;
    let levels = plan.levels();
    // A step makes a triangle of each corner.
    let mut faces: Vec<u32> = if levels.is_multiple_of(2) {
        (0..count(levels)).collect()
    } else {
        (0..count(levels)).map(|f| f / 3).collect()
    };
    for step in (0..levels / 2).map(|pair| 2 * pair).rev() {
        let thirds = Thirds::new(&plan.level(step).topology);
        let new = &plan.level(step + 2).topology;
        for face in &mut faces {
            *face = thirds.face(new, *face);
        }
    }
    faces
}

/// Two steps of √3: which triangle each of the new ones lies in, and where in it.
struct Thirds<'a> {
    old: &'a Topology,
    /// The points of the second step lie at thirds of edges: the corner at the start of a side, and whether
    /// it is the third near the end of that side.
    points: Vec<(u32, bool)>,
}

impl<'a> Thirds<'a> {
    fn new(old: &'a Topology) -> Self {
        let mut points = Vec::new();
        // The first step makes a triangle of each corner, with the side that starts there; the second puts
        // a point into it, or at a rim two.
        for c in 0..old.corner_count() as u32 {
            points.push((c, false));
            if old.corner(old.corner_halfedge[c as usize] ^ 1) == NONE {
                points.push((c, true));
            }
        }
        Thirds { old, points }
    }

    /// The side whose third a vertex of the second step is.
    fn third(&self, v: u32) -> Option<(u32, bool)> {
        let before = self.old.vertex_count() + self.old.face_count();
        (v as usize).checked_sub(before).map(|point| self.points[point])
    }

    fn write(&self, new: &Topology, child: u32, stencil: &mut Stencil) {
        let old = self.old;
        let face = self.face(new, new.face(child));
        let v = new.vertex(child);
        let at = |vertex: u32| old.corners(face).find(|&c| old.vertex(c) == vertex);
        if let Some((c, near_end)) = self.third(v) {
            let ends = [old.vertex(c), old.vertex(old.next(c))];
            let shares = if near_end { [1.0, 2.0] } else { [2.0, 1.0] };
            for (end, share) in ends.into_iter().zip(shares) {
                let corner = at(end).expect("the third of an edge belongs to its faces");
                stencil.push(corner, share / 3.0);
            }
        } else if v as usize >= old.vertex_count() {
            old.corners(face).for_each(|c| stencil.push(c, 1.0 / 3.0));
        } else {
            stencil.push(at(v).expect("an old vertex is a corner of its faces"), 1.0);
        }
        stencil.entries.sort_unstable_by_key(|&(column, _)| column);
    }

    /// The triangle that one of the new ones lies in.
    fn face(&self, new: &Topology, child: u32) -> u32 {
        let old = self.old;
        let mut common: Option<Vec<u32>> = None;
        for v in new.corners(child).map(|c| new.vertex(c)) {
            if let Some((c, _)) = self.third(v) {
                let twin = old.corner(old.corner_halfedge[c as usize] ^ 1);
                let corners = [c, twin].into_iter().filter(|&c| c != NONE);
                let beside: Vec<u32> = corners.map(|c| old.face(c)).collect();
                common = Some(match common {
                    None => beside,
                    Some(faces) => faces.into_iter().filter(|f| beside.contains(f)).collect(),
                });
            } else if v as usize >= old.vertex_count() {
                // The middle of a triangle.
                return v - old.vertex_count() as u32;
            }
        }
        // At a vertex, between thirds of two edges, which have one triangle in common.
        common.unwrap_or_default().first().copied().expect("new triangles lie in old ones")
    }
}
