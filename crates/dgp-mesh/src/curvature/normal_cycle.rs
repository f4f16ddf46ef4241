//! Principal curvatures by the normal cycle: the bends of edges, averaged over a neighborhood.
//!
//! ```text
//! T(B) = 1/|B| Σ β(e) |e ∩ B| ē ēᵀ      over the edges e
//! ```
//!
//! with the angle β by which the surface bends at e (negative in valleys), the direction ē and the
//! region B. A surface bends across an edge, so the direction of κ₁ is at right angles to that of the
//! larger value of T.
//!
//! - Input: a triangle mesh, with or without holes, and how far to look.
//! - Cost: O(V) for one-rings; for balls proportional to the faces in all of them.
//! - Guarantees: depends on the surface, hardly on its triangles, once the ball holds many. Exactly 0 in
//!   a plane. Finite.
//! - Reference: Cohen-Steiner and Morvan, "Restricted Delaunay triangulations and normal cycle", SoCG
//!   2003.
//! - Departs from it: T is restricted to the plane across the mean normal of B, instead of taking the
//!   eigenvector of its value nearest to zero for the normal, which fails where the surface is flat.

use glam::DVec3;

use super::{
    principal::rounding,
    tensor::{PrincipalCurvatures, Tangents, Tensor},
};
use crate::{
    EdgeMap, Error, FaceId, HalfedgeId, Mesh, Progress, VertexId, VertexMap,
    measure::{
        NormalWeight, VertexArea, frame::Frame, require_triangles, scale, vertex_areas,
        vertex_normals,
    },
    parallel,
};

/// The region over which [`normal_cycle_curvatures`] averages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Neighborhood {
    /// Half of each edge at the vertex, and the area that belongs to it: exact in total, rough at each
    /// vertex.
    OneRing,
    /// What of the surface lies within this distance of the vertex and hangs together with it there.
    Ball(f64),
}

/// How often a run over all vertices reports.
const ROUNDS: usize = 16;

/// The principal curvatures and directions at each vertex, averaged over `neighborhood`.
///
/// All zero on no face and where the normals of the neighborhood cancel.
/// Errors: [`Error::NotTriangle`], [`Error::InvalidOption`] for a radius that is not positive and
/// finite, [`Error::Cancelled`].
pub fn normal_cycle_curvatures(
    mesh: &Mesh,
    neighborhood: Neighborhood,
    progress: Progress<'_>,
) -> Result<VertexMap<PrincipalCurvatures>, Error> {
    require_triangles(mesh)?;
    let frame = Frame::of(mesh);
    let per_length = frame.per_measure(1.0, 1);
    let bends = mesh.map_edges(|e| mesh.dihedral_angle(e).unwrap_or(0.0));
    let regions = match neighborhood {
        Neighborhood::OneRing => one_rings(mesh, &frame, &bends),
        Neighborhood::Ball(radius) => {
            if !(radius > 0.0 && radius.is_finite()) {
                return Err(Error::option("radius", radius, "positive and finite"));
            }
            balls(mesh, &frame, &bends, radius * per_length, progress)?
        }
    };
    Ok(mesh.map_vertices(|v| {
        let region = &regions[v];
        let Some(tangents) = Tangents::of_normal(scale::unit(region.normal)) else {
            return PrincipalCurvatures::default();
        };
        let tensor = region.tensor(&tangents).scaled(1.0 / region.area);
        let tensor = if tensor.is_finite() { tensor } else { Tensor::default() };
        let rounding = rounding(mesh, &frame, v, region.area);
        let found = tensor.principal(&tangents, rounding);
        PrincipalCurvatures { max: found.max * per_length, min: found.min * per_length, ..found }
    }))
}

/// Sums over a region.
#[derive(Clone, Copy, Default)]
struct Region {
    normal: DVec3,
    area: f64,
    /// Σ β |e ∩ B| ē ēᵀ: xx, yy, zz, then yz, zx, xy.
    squares: DVec3,
    products: DVec3,
}

impl Region {
    /// Adds a bend by `angle` over `length` of an edge of unit direction `d`.
    fn add(&mut self, angle: f64, length: f64, d: DVec3) {
        self.squares += angle * length * d * d;
        self.products += angle * length * DVec3::new(d.y * d.z, d.z * d.x, d.x * d.y);
    }

    /// The tensor in a tangent plane, turned by a right angle, so that it is the curvature along its
    /// directions.
    fn tensor(&self, tangents: &Tangents) -> Tensor {
        let (s, p) = (self.squares, self.products);
        let times = |x: DVec3| {
            DVec3::new(
                s.x * x.x + p.z * x.y + p.y * x.z,
                p.z * x.x + s.y * x.y + p.x * x.z,
                p.y * x.x + p.x * x.y + s.z * x.z,
            )
        };
        let (u, v) = (tangents.u, tangents.v);
        Tensor { uu: v.dot(times(v)), uv: -u.dot(times(v)), vv: u.dot(times(u)) }
    }
}

fn one_rings(mesh: &Mesh, frame: &Frame, bends: &EdgeMap<f64>) -> VertexMap<Region> {
    let normals = vertex_normals(mesh, NormalWeight::Angle);
    let areas = vertex_areas(mesh, VertexArea::Barycentric);
    mesh.map_vertices(|v| {
        let area = frame.per_measure(areas[v], 2);
        let mut region = Region { normal: normals[v], area, ..Region::default() };
        for h in mesh.vertex_halfedges(v) {
            let side = side(mesh, frame, h);
            region.add(bends[h.edge()], 0.5 * scale::length(side), scale::unit(side));
        }
        region
    })
}

fn side(mesh: &Mesh, frame: &Frame, h: HalfedgeId) -> DVec3 {
    frame.scaled(mesh.position(mesh.to(h))) - frame.scaled(mesh.position(mesh.from(h)))
}

fn balls(
    mesh: &Mesh,
    frame: &Frame,
    bends: &EdgeMap<f64>,
    radius: f64,
    progress: Progress<'_>,
) -> Result<VertexMap<Region>, Error> {
    let count = mesh.vertex_count();
    let round = count.div_ceil(ROUNDS).max(1);
    let mut regions = Vec::with_capacity(count);
    for first in (0..count).step_by(round) {
        progress.report(first as f64 / count as f64)?;
        let in_round = round.min(count - first);
        // Few blocks, as each keeps a mark for every face.
        for block in parallel::map_blocks(in_round, in_round.div_ceil(4), |range| {
            let mut search = Search::new(mesh, frame, bends, radius);
            let of = |v: usize| search.region(VertexId::new(first + v));
            range.map(of).collect::<Vec<Region>>()
        }) {
            regions.extend(block);
        }
    }
    Ok(regions.into())
}

/// Finds what lies in balls.
struct Search<'a> {
    mesh: &'a Mesh,
    frame: &'a Frame,
    bends: &'a EdgeMap<f64>,
    radius: f64,
    /// The last vertex that found each face, counted from 1.
    found: Vec<u32>,
    queue: Vec<FaceId>,
}

impl<'a> Search<'a> {
    fn new(mesh: &'a Mesh, frame: &'a Frame, bends: &'a EdgeMap<f64>, radius: f64) -> Self {
        let found = vec![0; mesh.face_count()];
        Search { mesh, frame, bends, radius, found, queue: Vec::new() }
    }

    fn region(&mut self, v: VertexId) -> Region {
        let mut region = Region::default();
        self.queue.clear();
        for f in self.mesh.vertex_faces(v) {
            self.visit(f, v);
        }
        let center = self.frame.scaled(self.mesh.position(v));
        let mut next = 0;
        while let Some(&f) = self.queue.get(next) {
            next += 1;
            let mesh = self.mesh;
            let corners: [DVec3; 3] = mesh
                .triangle(f)
                .expect("the faces are triangles")
                .map(|v| self.frame.scaled(mesh.position(v)) - center);
            let normal = mesh.face_normal(f);
            let area = area_in_ball(corners, normal, self.radius);
            region.normal += area * normal;
            region.area += area;
            for h in mesh.face_halfedges(f) {
                let [from, to] = [mesh.from(h), mesh.to(h)]
                    .map(|v| self.frame.scaled(mesh.position(v)) - center);
                let Some([start, end]) = part_in_ball(from, to, self.radius) else { continue };
                let side = to - from;
                // Each edge is met from both of its faces.
                let length = 0.5 * (end - start) * scale::length(side);
                region.add(self.bends[h.edge()], length, scale::unit(side));
                if let Some(other) = mesh.face(h.twin()) {
                    self.visit(other, v);
                }
            }
        }
        region
    }

    fn visit(&mut self, f: FaceId, v: VertexId) {
        let mark = v.index() as u32 + 1;
        if self.found[f.index()] != mark {
            self.found[f.index()] = mark;
            self.queue.push(f);
        }
    }
}

/// Between which parameters the segment runs within the ball around the origin.
fn part_in_ball(from: DVec3, to: DVec3, radius: f64) -> Option<[f64; 2]> {
    let along = to - from;
    let (a, b) = (along.length_squared(), from.dot(along));
    // The distance of the line, by the part of `from` across it, so that nothing cancels.
    let across = if a > 0.0 { from - along * (b / a) } else { from };
    let rest = radius * radius - across.length_squared();
    if rest < 0.0 {
        return None;
    }
    if a == 0.0 {
        return Some([0.0, 1.0]);
    }
    let reach = (rest / a).sqrt();
    let [start, end] = [(-b / a - reach).max(0.0), (-b / a + reach).min(1.0)];
    (start <= end).then_some([start, end])
}

/// The area of the part of a triangle with this unit normal that lies in the ball around the origin.
fn area_in_ball(corners: [DVec3; 3], normal: DVec3, radius: f64) -> f64 {
    let height = corners[0].dot(normal);
    let square = radius * radius - height * height;
    if square <= 0.0 {
        return 0.0;
    }
    // In the plane of the triangle the ball is a disk. Side by side, what of the disk lies between the
    // side and the center: a triangle where the side is inside, sectors where it is outside.
    let disk = square.sqrt();
    let points = corners.map(|p| p - height * normal);
    let mut area = 0.0;
    for k in 0..3 {
        let (a, b) = (points[k], points[(k + 1) % 3]);
        let turn = |p: DVec3, q: DVec3| normal.dot(p.cross(q));
        let sector = |p: DVec3, q: DVec3| 0.5 * square * turn(p, q).atan2(p.dot(q));
        area += match part_in_ball(a, b, disk) {
            None => sector(a, b),
            Some([start, end]) => {
                let (p, q) = (a + start * (b - a), a + end * (b - a));
                let before = if start > 0.0 { sector(a, p) } else { 0.0 };
                let after = if end < 1.0 { sector(q, b) } else { 0.0 };
                before + 0.5 * turn(p, q) + after
            }
        };
    }
    area.max(0.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn a_triangle_around_the_ball_holds_a_disk_and_a_small_one_is_inside() {
        let corners = |size: f64| {
            [0.0, 1.0, 2.0].map(|k| {
                let (sin, cos) = (2.0 * PI * k / 3.0).sin_cos();
                DVec3::new(size * cos, size * sin, 0.6)
            })
        };
        // Radius 1 at height 0.6 is a disk of radius 0.8; the inner circle of the triangle is half
        // its outer one.
        assert!((area_in_ball(corners(3.0), DVec3::Z, 1.0) - 0.64 * PI).abs() < 1e-14);
        let whole = 0.75 * 3.0_f64.sqrt() * 0.25;
        assert!((area_in_ball(corners(0.5), DVec3::Z, 1.0) - whole).abs() < 1e-15);
        assert_eq!(area_in_ball(corners(3.0), DVec3::Z, 0.5), 0.0);
        // Half a disk: one side runs through the center.
        let half =
            [DVec3::new(-9.0, 0.0, 0.0), DVec3::new(9.0, 0.0, 0.0), DVec3::new(0.0, 9.0, 0.0)];
        assert!((area_in_ball(half, DVec3::Z, 1.0) - 0.5 * PI).abs() < 1e-14);
    }

    #[test]
    fn segments_are_cut_where_they_leave_the_ball() {
        let (a, b) = (DVec3::new(-2.0, 0.6, 0.0), DVec3::new(2.0, 0.6, 0.0));
        let [start, end] = part_in_ball(a, b, 1.0).unwrap();
        assert!((start - 0.3).abs() < 1e-15 && (end - 0.7).abs() < 1e-15);
        assert_eq!(part_in_ball(a, b, 0.5), None);
        assert_eq!(part_in_ball(b, b + DVec3::X, 1.0), None);
    }
}
