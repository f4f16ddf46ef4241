//! What the triangles of a mesh add to the vertices at their corners.

use std::ops::{Add, Range};

use glam::DVec3;

use crate::{
    FaceId, Mesh, VertexId,
    measure::{VertexArea, cross_of_shorter, scale::Scale, voronoi_share},
    parallel,
};

/// Angles, cotangents and area of a triangle.
pub(super) struct Corners {
    /// The angles, which sum to π but for rounding in triangles without area too.
    pub(super) angles: [f64; 3],
    /// Their cotangents; 0 without area.
    pub(super) cotangents: [f64; 3],
    pub(super) area: f64,
}

impl Corners {
    pub(super) fn of([a, b, c]: [DVec3; 3]) -> Self {
        let (ab, bc, ca) = (b - a, c - b, a - c);
        let scale = Scale::of(ab.abs().max(bc.abs()).max(ca.abs()).max_element());
        let [ab, bc, ca] = [ab, bc, ca].map(|side| side * scale.down);
        let cross = cross_of_shorter(ab, bc, ca);
        let doubled = cross.length();
        let dots = [-ca.dot(ab), -ab.dot(bc), -bc.dot(ca)];
        Corners {
            angles: angles(doubled, dots),
            cotangents: dots.map(|dot| cotangent(doubled, dot)),
            area: 0.5 * doubled * scale.up * scale.up,
        }
    }

    /// The parts of the area that belong to the corners.
    pub(super) fn areas(&self, kind: VertexArea) -> [f64; 3] {
        let [a, b, c] = self.cotangents;
        match kind {
            VertexArea::Barycentric => [self.area / 3.0; 3],
            VertexArea::MixedVoronoi => {
                [[a, b, c], [b, c, a], [c, a, b]].map(|corner| self.area * voronoi_share(corner))
            }
        }
    }
}

/// The angles with these dot products of their sides and the same cross product.
fn angles(doubled: f64, dots: [f64; 3]) -> [f64; 3] {
    use std::f64::consts::{FRAC_PI_2, PI};
    if doubled == 0.0 {
        // A side without length: the limit of equal angles at its ends.
        let is_short = dots.map(|dot| dot == 0.0);
        match is_short.iter().filter(|short| **short).count() {
            0 => {}
            3 => return [PI / 3.0; 3],
            _ => return is_short.map(|short| if short { FRAC_PI_2 } else { 0.0 }),
        }
    }
    dots.map(|dot| doubled.atan2(dot))
}

fn cotangent(doubled: f64, dot: f64) -> f64 {
    if doubled > 0.0 { (dot / doubled).clamp(-f64::MAX, f64::MAX) } else { 0.0 }
}

/// The sum at each vertex of what `term(face, its corners)` gives the three corners of each triangle.
///
/// Adding up face by face reads memory in order and computes each face once. Two halves, whatever the
/// number of threads, give the same bits for all.
pub(super) fn sum_at_corners<T: Copy + Default + Add<Output = T> + Send + Sync>(
    mesh: &Mesh,
    term: impl Fn(FaceId, [VertexId; 3]) -> [T; 3] + Sync,
) -> Vec<T> {
    let part = |faces: Range<usize>| {
        if faces.is_empty() && faces.start > 0 {
            return Vec::new();
        }
        let mut sums = vec![T::default(); mesh.vertex_count()];
        for f in faces.map(FaceId::new) {
            let Some(corners) = mesh.triangle(f) else { continue };
            for (v, term) in corners.into_iter().zip(term(f, corners)) {
                sums[v.index()] = sums[v.index()] + term;
            }
        }
        sums
    };
    let count = mesh.face_count();
    let middle = if count > 2 * parallel::BLOCK { count / 2 } else { count };
    let (mut sums, others) = parallel::join(|| part(0..middle), || part(middle..count));
    for (sum, &other) in sums.iter_mut().zip(&others) {
        *sum = *sum + other;
    }
    sums
}
