//! Values at corners, such as texture coordinates: refined within charts, so that seams stay.
//!
//! ```text
//! linear    at an old vertex the value of the corner, on an edge the mean of the two corners of the face,
//!           in a face the mean of its corners
//! smooth    by the masks of positions, on the mesh cut open along seams, whose rims stay where they are at
//!           vertices of a single face
//! ```
//!
//! A seam is an edge at one end of which its two faces have different values. Corners around a vertex
//! share a value where no seam is between them.
//!
//! - Input: a mesh with values at corners, and the plan of its refinement.
//! - Cost: O(corners) per level; smooth, that of a second plan.
//! - Guarantees: where two faces agree at an edge they agree along its halves; no value crosses a seam.
//! - Reference: DeRose, Kass and Truong, "Subdivision surfaces in character animation", SIGGRAPH 1998,
//!   section 5 (smooth); OpenSubdiv has the same choice.

use dgp_mesh::{
    AttributeTable, Connectivity, EdgeId, FaceList, HalfedgeId, Mesh, Progress, VertexId,
};

use crate::{
    BoundaryRule, Error, RefinementOptions, RefinementPlan, Scheme, Sharpness, StencilTable,
    doo_sabin::doo_sabin_weight,
    masks::Stencil,
    topology::{NONE, Topology},
};

/// How values at corners are refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceVarying {
    /// Within each face.
    #[default]
    Linear,
    /// As positions are, with seams as rims. Loop and Catmull–Clark have it; others are linear.
    Smooth,
}

/// The data of the corners of the last level, by corner, given those of the cage, by half-edge.
pub(crate) fn refined_corners(
    mesh: &Mesh,
    sharpness: &Sharpness,
    plan: &RefinementPlan,
    rule: FaceVarying,
    progress: Progress<'_>,
) -> Result<AttributeTable<VertexId>, Error> {
    // By corner, which the tables call vertices.
    let first = &plan.level(0).topology;
    let halfedge = |c: usize| HalfedgeId::new(first.corner_halfedge[c] as usize);
    let pick = |c: VertexId| Some(halfedge(c.index()));
    let mut data: AttributeTable<VertexId> =
        mesh.attributes().corner.gather(first.corner_count(), pick);
    if rule == FaceVarying::Smooth && plan.options().scheme.has_creases() {
        return smooth(first, &data, sharpness, plan, progress);
    }
    for step in 0..plan.levels() {
        data = corner_stencils(plan, step)?.apply_attributes(&data)?;
        progress.report((step + 1) as f64 / plan.levels() as f64)?;
    }
    Ok(data)
}

/// Refines on the cage cut open along its seams.
fn smooth(
    cage: &Topology,
    data: &AttributeTable<VertexId>,
    sharpness: &Sharpness,
    plan: &RefinementPlan,
    progress: Progress<'_>,
) -> Result<AttributeTable<VertexId>, Error> {
    let (place, sources) = cut_vertices(cage, data);
    let mut faces = FaceList::new();
    for f in 0..cage.face_count() as u32 {
        let corners = cage.corners(f).map(|c| VertexId::new(place[c as usize] as usize));
        faces.push(&corners.collect::<Vec<_>>());
    }
    let cut = Connectivity::from_faces(sources.len(), &faces)?;
    let topology = Topology::new(&cut);
    let mut cut_sharpness = Sharpness::new();
    for (c, &h) in topology.corner_halfedge.iter().enumerate() {
        let edge = EdgeId::new(cage.corner_halfedge[c] as usize / 2);
        cut_sharpness.set_edge(EdgeId::new(h as usize / 2), sharpness.edge(edge));
        let vertex = VertexId::new(cage.vertex(c as u32) as usize);
        cut_sharpness.set_vertex(VertexId::new(place[c] as usize), sharpness.vertex(vertex));
    }
    let boundary = BoundaryRule::EdgeAndCorner;
    let options = RefinementOptions { boundary, ..*plan.options() };
    let second = RefinementPlan::new(&cut, &cut_sharpness, &options, progress.part(0.0, 0.5))?;
    let pick = |v: VertexId| Some(VertexId::new(sources[v.index()] as usize));
    let mut values: AttributeTable<VertexId> = data.gather(sources.len(), pick);
    for step in 0..second.levels() {
        values = second.step_stencils(step)?.apply_attributes(&values)?;
        progress.report(0.5 + 0.5 * (step + 1) as f64 / second.levels() as f64)?;
    }
    // Both plans split corner by corner, so corners have the same numbers.
    let last = &second.last().topology;
    let pick = |c: VertexId| Some(VertexId::new(last.vertex(c.index() as u32) as usize));
    Ok(values.gather(last.corner_count(), pick))
}

/// The vertex of each corner once the cage is cut open along its seams, and a corner of each such vertex.
fn cut_vertices(cage: &Topology, data: &AttributeTable<VertexId>) -> (Vec<u32>, Vec<u32>) {
    let id = |c: u32| VertexId::new(c as usize);
    let agree = |c: u32, d: u32| data.equal(id(c), id(d));
    let is_seam = |h: u32| {
        let (c, twin) = (cage.corner(h), cage.corner(h ^ 1));
        // Each corner with that of the other face at the same vertex.
        twin == NONE || !agree(c, cage.next(twin)) || !agree(cage.next(c), twin)
    };
    let mut place = vec![NONE; cage.corner_count()];
    let mut sources = Vec::new();
    let mut spokes = Vec::new();
    for v in 0..cage.vertex_count() {
        cage.spokes(v, &mut spokes);
        spokes.retain(|&h| cage.corner(h) != NONE);
        // From a seam on, so that none of the runs of corners between seams is met twice.
        let first = spokes.iter().position(|&h| is_seam(h)).unwrap_or(0);
        spokes.rotate_left(first);
        for (k, &h) in spokes.iter().enumerate() {
            let corner = cage.corner(h);
            if k == 0 || is_seam(h) {
                sources.push(corner);
            }
            place[corner as usize] = sources.len() as u32 - 1;
        }
    }
    (place, sources)
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
