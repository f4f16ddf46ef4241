//! The tufted cover: a Laplacian for triangles that form no manifold.
//!
//! Each triangle gets two sides, like a sheet of paper. Around an edge, each side that faces a wedge of space
//! is glued to the one that faces the same wedge; at a rim the two sides of a triangle to each other. That
//! makes a closed surface in which every edge has two triangles, whatever the faces; it is made intrinsic
//! Delaunay, and half of its Laplacian is the result. On a manifold without holes it is that of
//! [`intrinsic_delaunay`](super::intrinsic_delaunay).
//!
//! - Input: triangles over shared vertices: more than two at an edge, misoriented, repeated, without area,
//!   with holes. Faces that name a vertex twice are left out.
//! - Cost: O(F log F), and the flips.
//! - Guarantees: symmetric, weights not negative but for rounding, L·1 = 0.
//! - Reference: Sharp and Crane, "A Laplacian for nonmanifold triangle meshes", SGP 2020.

use dgp_mesh::{DVec3, FaceId, IndexedFaceSet, Progress, VertexId};

use super::{IntrinsicLaplacian, IntrinsicOptions, IntrinsicTriangulation, delaunay_report};
use crate::{Error, unit::unit_of};

/// The Laplacian and masses of any triangles.
///
/// Errors: [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`] for faces of more or fewer corners,
/// [`Error::NotFinite`], [`Error::InvalidOption`], [`Error::Cancelled`].
pub fn tufted_laplacian(
    set: &IndexedFaceSet,
    options: &IntrinsicOptions,
    progress: Progress<'_>,
) -> Result<IntrinsicLaplacian, Error> {
    let mut triangles = Vec::with_capacity(set.face_count());
    for (face, corners) in set.faces().iter() {
        let Ok([a, b, c]) = <[VertexId; 3]>::try_from(corners) else {
            let error = dgp_mesh::Error::NotTriangle { face, degree: corners.len() };
            return Err(Error::Mesh(error));
        };
        triangles.push([a, b, c].map(|v| v.index() as u32));
    }
    let soup = Soup { positions: set.positions().values(), triangles: &triangles };
    of_triangles(&soup, Gluing::Around, 1.0, *options, progress)
}

/// Triangles over shared vertices.
pub(super) struct Soup<'a> {
    pub(super) positions: &'a [DVec3],
    pub(super) triangles: &'a [[u32; 3]],
}

/// Which sides of the triangles around an edge are glued.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Gluing {
    /// Those that face the same wedge of space, as in the paper.
    Around,
    /// Those of triangles opposite each other: several copies of the two triangles at an edge make
    /// several sheets, and no copy is glued to another of the same triangle.
    Across,
}

/// The Laplacian of the triangles of `soup`, of which each counts `share`.
pub(super) fn of_triangles(
    soup: &Soup<'_>,
    gluing: Gluing,
    share: f64,
    options: IntrinsicOptions,
    progress: Progress<'_>,
) -> Result<IntrinsicLaplacian, Error> {
    let Soup { positions, triangles } = *soup;
    if let Some(bad) = positions.iter().position(|p| !p.is_finite()) {
        return Err(Error::NotFinite { vertex: VertexId::new(bad) });
    }
    if triangles.len() > (u32::MAX / 6) as usize {
        let (count, limit) = (triangles.len(), (u32::MAX / 6) as usize);
        return Err(Error::Mesh(dgp_mesh::Error::TooMany { kind: "triangles", count, limit }));
    }
    let unit = unit_of(positions);
    let point = |v: u32| positions[v as usize] * unit;
    let kept: Vec<[u32; 3]> =
        triangles.iter().copied().filter(|[a, b, c]| a != b && b != c && c != a).collect();
    let mut cover = cover(positions.len(), &kept, gluing, &point);
    let mut report = delaunay_report(&mut cover, options, progress)?;
    // Two sides count for one.
    let factor = 0.5 * share;
    let laplacian = cover.laplacian()?.scaled(factor);
    report.least_weight = cover.least_weight().map(|weight| factor * weight);
    report.added_length /= unit;
    report.dropped_faces = triangles.len() - kept.len();
    let masses = cover.masses().map(|mass| factor * mass / unit / unit);
    Ok(IntrinsicLaplacian { laplacian, masses, report })
}

/// The sides of the front of a triangle, and those of its back along the same edges.
const FRONT: [u32; 3] = [0, 1, 2];
const BACK: [u32; 3] = [3, 5, 4];

/// The two sides of all triangles, glued.
fn cover(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    gluing: Gluing,
    point: &impl Fn(u32) -> DVec3,
) -> IntrinsicTriangulation {
    let count = 6 * triangles.len();
    let (mut from, mut length) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for &[a, b, c] in triangles {
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[p, q]| point(p).distance(point(q)));
        // The front a, b, c, then the back b, a, c.
        from.extend([a, b, c, b, a, c]);
        length.extend([ab, bc, ca, ab, ca, bc]);
    }
    let mut uses: Vec<Use> = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            let [p, q, opposite] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let sides = [FRONT[k], BACK[k]].map(|side| 6 * t as u32 + side);
            let [forward, backward] = if p < q { sides } else { [sides[1], sides[0]] };
            let face = FaceId::new(t);
            uses.push(Use { ends: [p.min(q), p.max(q)], face, opposite, forward, backward });
        }
    }
    uses.sort_by_key(|edge| (edge.ends, edge.face));
    let mut across = vec![0; count];
    for around in uses.chunk_by_mut(|a, b| a.ends == b.ends) {
        if around.len() > 2 {
            sort_around(around, point);
        }
        // The triangles in the order in which they are glued: around, or from one half to the other and back.
        let half = around.len().div_ceil(2);
        let place = |i: usize| {
            let i = i % around.len();
            if gluing == Gluing::Around { i } else { i / 2 + (i % 2) * half }
        };
        for i in 0..around.len() {
            // The side along the edge faces what comes next around it, the one against it what was before.
            let (edge, next) = (&around[place(i)], &around[place(i + 1)]);
            across[edge.forward as usize] = next.backward;
            across[next.backward as usize] = edge.forward;
        }
    }
    IntrinsicTriangulation::from_parts(vertex_count, from, across, length)
}

/// A triangle at an edge.
struct Use {
    /// The smaller vertex first.
    ends: [u32; 2],
    face: FaceId,
    opposite: u32,
    /// The side of the triangle that leads from the smaller vertex to the larger, and the other.
    forward: u32,
    backward: u32,
}

/// Sorts triangles counterclockwise around the direction of their edge.
fn sort_around(around: &mut [Use], point: &impl Fn(u32) -> DVec3) {
    let [start, end] = around[0].ends.map(point);
    let Some(axis) = (end - start).try_normalize() else { return };
    let away = |edge: &Use| {
        let to = point(edge.opposite) - start;
        to - axis * axis.dot(to)
    };
    let (right, up) = axis.any_orthonormal_pair();
    let up = if right.cross(up).dot(axis) < 0.0 { -up } else { up };
    let angle = |edge: &Use| {
        let direction = away(edge);
        direction.dot(up).atan2(direction.dot(right))
    };
    around.sort_by(|a, b| angle(a).total_cmp(&angle(b)).then(a.face.cmp(&b.face)));
}
