//! Vertices moved to the means of their Voronoi cells on the surface, now that what counts is where they are and no
//! longer which vertices of the refined input are theirs.
//!
//! ```text
//! x ← nearest point of the surface to  x + ω (1 − n nᵀ) (∫ ρ y dy / ∫ ρ dy − x)      over the cell of x in its star
//! ```
//!
//! n is the normal of x. Between the steps edges are flipped whose opposite angles sum up to more than π. The cell of a
//! vertex in a triangle around it ends at the perpendicular bisectors, or, where the triangle is obtuse, at the middle
//! of its longest side.
//!
//! - Input: a triangulation near a surface, and vertices that stay where they are.
//! - Cost: some microseconds for a vertex and step, in parallel.
//! - Guarantees: no triangle is turned over by a step.
//! - Reference: Lloyd, "Least squares quantization in PCM", IEEE Transactions on Information Theory 28(2), 1982; Du,
//!   Faber and Gunzburger, "Centroidal Voronoi tessellations", SIAM Review 41(4), 1999.
//! - Departs from it: cells are those of the triangulation; steps are longer than to the mean.

use dgp_mesh::{
    DVec3, EdgeId, Editor, HalfedgeId, Mesh, Progress, VertexId, VertexMap,
    measure::face_normals,
    spatial::{ClosestPoint, TriangleTree},
};

use crate::Error;

/// ω: up to 2 steps do not get longer and longer.
const STEP: f64 = 1.6;

/// Cotangents of two angles whose sum is above π by rounding only sum up to more than this.
const SLACK: f64 = -1e-9;

/// Normals of a triangle before and after a step have a larger product than this.
const TURNED: f64 = 0.3;

/// Where vertices may be, and how densely.
pub(super) struct Ground<'a> {
    /// The input at unit scale.
    mesh: Mesh,
    tree: TriangleTree,
    density: &'a [f64],
}

impl<'a> Ground<'a> {
    pub(super) fn new(input: &Mesh, unit: f64, density: &'a [f64]) -> Result<Self, Error> {
        let positions: Vec<DVec3> = input.positions().values().iter().map(|&p| p / unit).collect();
        let mesh = Mesh::from_parts(input.connectivity().clone(), positions.into());
        let tree = TriangleTree::new(&mesh, Progress::NONE)?;
        Ok(Ground { mesh, tree, density })
    }

    /// The nearest point for each of `points`.
    pub(super) fn nearest(&self, points: &[DVec3]) -> Result<Vec<ClosestPoint>, Error> {
        Ok(self.tree.closest_points(points, Progress::NONE)?)
    }

    fn density(&self, at: &ClosestPoint) -> f64 {
        at.vertices
            .iter()
            .zip(at.barycentric)
            .map(|(v, weight)| weight * self.density[v.index()])
            .sum()
    }
}

/// Moves all vertices but those that are fixed, so often.
pub(super) fn relax(
    mesh: &mut Mesh,
    is_fixed: &[bool],
    ground: &Ground<'_>,
    steps: usize,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let normals = face_normals(&ground.mesh);
    let found = ground.nearest(mesh.positions().values())?;
    let mut density: VertexMap<f64> =
        found.iter().map(|at| ground.density(at)).collect::<Vec<f64>>().into();
    let mut editor = Editor::new(mesh);
    for step in 0..steps {
        progress.report(step as f64 / steps as f64)?;
        flip(&mut editor, is_fixed);
        let mesh = editor.mesh();
        let targets = mesh.map_vertices(|v| {
            let p = mesh.position(v);
            if is_fixed[v.index()] {
                return p;
            }
            let step = STEP * (cell_mean(mesh, &density, v) - p);
            // The mean lies inside of what is convex: at the end of an ear it would make the ear shorter.
            let normal: DVec3 = mesh.vertex_faces(v).map(|f| mesh.face_normal(f)).sum();
            p + step - normal.normalize_or_zero() * step.dot(normal.normalize_or_zero())
        });
        let found = ground.nearest(targets.values())?;
        let mut moved: VertexMap<DVec3> = mesh.map_vertices(|v| {
            let at = &found[v.index()];
            let normal: DVec3 = mesh.vertex_faces(v).map(|f| mesh.face_normal(f)).sum();
            // Not to the other side of a plate.
            let is_free = !is_fixed[v.index()] && normals[at.face].dot(normal) > 0.0;
            if is_free { at.point } else { mesh.position(v) }
        });
        keep_sides(mesh, &mut moved);
        for v in (0..moved.len()).map(VertexId::new) {
            if moved[v] != editor.mesh().position(v) {
                density[v] = ground.density(&found[v.index()]);
                editor.set_position(v, moved[v]);
            }
        }
    }
    flip(&mut editor, is_fixed);
    let _ = editor.finish();
    Ok(())
}

/// Leaves vertices of triangles where they are that would be turned over.
fn keep_sides(mesh: &Mesh, moved: &mut VertexMap<DVec3>) {
    loop {
        let turned = mesh.map_faces(|f| {
            let [a, b, c] = corners(mesh, mesh.face_halfedge(f));
            let is_moved = [a, b, c].iter().any(|&v| moved[v] != mesh.position(v));
            let normal = (moved[b] - moved[a]).cross(moved[c] - moved[a]).normalize_or_zero();
            is_moved && !(normal.dot(mesh.face_normal(f)) > TURNED)
        });
        let mut is_done = true;
        for f in mesh.faces().filter(|&f| turned[f]) {
            for v in corners(mesh, mesh.face_halfedge(f)) {
                moved[v] = mesh.position(v);
                is_done = false;
            }
        }
        if is_done {
            return;
        }
    }
}

/// The corners of a triangle, from the start of one of its sides on.
fn corners(mesh: &Mesh, h: HalfedgeId) -> [VertexId; 3] {
    [h, mesh.next(h), mesh.prev(h)].map(|h| mesh.from(h))
}

/// ∫ ρ y dy / ∫ ρ dy over the cell of `v`; `v` itself if it has none.
fn cell_mean(mesh: &Mesh, density: &VertexMap<f64>, v: VertexId) -> DVec3 {
    let (mut moment, mut mass) = (DVec3::ZERO, 0.0);
    for h in mesh.vertex_halfedges(v).filter(|&h| mesh.face(h).is_some()) {
        let corners = corners(mesh, h);
        let [x, y, z] = corners.map(|w| mesh.position(w));
        let [p, q, r] = corners.map(|w| density[w]);
        let [s, t] = center(x, y, z);
        let middle = x + s * (y - x) + t * (z - x);
        let between = p + s * (q - p) + t * (r - p);
        // From the vertex over the middle of a side to the center, and back over that of the other side.
        for (side, other) in [(0.5 * (x + y), 0.5 * (p + q)), (0.5 * (x + z), 0.5 * (p + r))] {
            let area = (side - x).cross(middle - x).length();
            // ρ is linear: the integrals over a triangle are exact.
            let sum = p + other + between;
            mass += area * sum;
            moment +=
                0.25 * area * ((p + sum) * x + (other + sum) * side + (between + sum) * middle);
        }
    }
    if mass > 0.0 { moment / mass } else { mesh.position(v) }
}

/// Where perpendicular bisectors meet, as weights of the second and the third corner; the middle of the longest side if
/// that is not inside.
fn center(x: DVec3, y: DVec3, z: DVec3) -> [f64; 2] {
    let [a, b, c] = [(y - z).length_squared(), (z - x).length_squared(), (x - y).length_squared()];
    if a >= b + c {
        return [0.5, 0.5];
    }
    if b >= a + c {
        return [0.0, 0.5];
    }
    if c >= a + b {
        return [0.5, 0.0];
    }
    let weights = [a * (b + c - a), b * (a + c - b), c * (a + b - c)];
    let sum = weights[0] + weights[1] + weights[2];
    [weights[1] / sum, weights[2] / sum]
}

/// Flips edges until no opposite angles sum up to more than π, but not between vertices that are fixed.
fn flip(editor: &mut Editor<'_>, is_fixed: &[bool]) {
    /// Each pass leaves few for the next.
    const PASSES: usize = 4;
    for _ in 0..PASSES {
        let mesh = editor.mesh();
        let wrong = mesh.map_edges(|e| is_wrong(mesh, e));
        let wrong: Vec<EdgeId> = wrong.iter().filter(|(_, is)| **is).map(|(e, _)| e).collect();
        let mut flips = 0;
        for e in wrong {
            let mesh = editor.mesh();
            let is_free = mesh.edge_vertices(e).iter().any(|v| !is_fixed[v.index()]);
            if is_free && is_wrong(mesh, e) && stays_up(mesh, e) && editor.flip(e).is_ok() {
                flips += 1;
            }
        }
        if flips == 0 {
            return;
        }
    }
}

fn is_wrong(mesh: &Mesh, e: EdgeId) -> bool {
    !mesh.is_boundary_edge(e)
        && e.halfedges().into_iter().map(|h| mesh.cotangent(h)).sum::<f64>() < SLACK
}

/// Whether both triangles after a flip look where those before do.
fn stays_up(mesh: &Mesh, e: EdgeId) -> bool {
    let [h, t] = e.halfedges();
    let [a, b] = [mesh.from(h), mesh.from(t)].map(|v| mesh.position(v));
    let [c, d] = [h, t].map(|h| mesh.position(mesh.from(mesh.prev(h))));
    let normal = |x: DVec3, y: DVec3, z: DVec3| (y - x).cross(z - x).normalize_or_zero();
    let before = [normal(a, b, c), normal(b, a, d)];
    let after = [normal(c, a, d), normal(d, b, c)];
    before.iter().all(|x| after.iter().all(|y| x.dot(*y) > TURNED))
}
