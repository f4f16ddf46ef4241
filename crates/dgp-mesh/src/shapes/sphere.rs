//! Unit spheres: split icosahedron, meridians and parallels, inflated cube.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{DVec2, DVec3};

use super::{
    Tiling, at_least, cuboid, face_count, manifold,
    platonic::{ICOSAHEDRON_FACES, icosahedron_corners},
    revolution::revolve,
};
use crate::{Error, FaceList, Mesh, VertexId, parallel};

/// The unit sphere from an icosahedron whose edges are split at their midpoints `level` times, new
/// vertices put on the sphere: 10·4^level + 2 vertices, 20·4^level triangles.
///
/// Vertices lie in rows that run across each face of the icosahedron, so that neighbors on the sphere
/// are close in memory: first the 12 corners, then the 30 edges, then the 20 faces. `level` is at
/// most 10.
pub fn icosphere(level: usize) -> Result<Mesh, Error> {
    let frequency = 1_usize << level.min(40);
    face_count(&[20, frequency, frequency])?;
    let corners = icosahedron_corners();
    let edges = icosahedron_edges();
    let arcs = edges.map(|[a, b]| arc(corners[a], corners[b], frequency));

    // === Number the vertices: corners, inner vertices of the edges, inner vertices of the faces
    let (on_edge, in_face) = (frequency - 1, (frequency - 1) * (frequency.max(2) - 2) / 2);
    let edge_between = |a: usize, b: usize| {
        let ends = [a.min(b), a.max(b)];
        edges.iter().position(|&edge| edge == ends).expect("the sides of a face are edges")
    };
    let vertex_on_side = |a: usize, b: usize, step: usize| match step {
        0 => a,
        _ if step == frequency => b,
        _ => {
            let step = if a < b { step } else { frequency - step };
            12 + edge_between(a, b) * on_edge + step - 1
        }
    };

    // === Fill each face of the icosahedron with rows of vertices and triangles
    let blocks = parallel::map_blocks(20, 1, |range| {
        let [a, b, c] = ICOSAHEDRON_FACES[range.start];
        let mut rows = Rows::new(frequency);
        let mut ids = vec![0_u32; rows.points.len()];
        for (start, end, place) in [(a, b, Side::Bottom), (a, c, Side::Left), (b, c, Side::Right)] {
            let points = &arcs[edge_between(start, end)];
            for step in 0..=frequency {
                let at = rows.on(place, step);
                rows.points[at] = points[if start < end { step } else { frequency - step }];
                ids[at] = vertex_on_side(start, end, step) as u32;
            }
        }
        rows.fill();
        let mut next = (12 + 30 * on_edge + range.start * in_face) as u32;
        let mut inner = Vec::with_capacity(in_face);
        for j in 1..frequency {
            for i in 1..frequency - j {
                let at = rows.at(i, j);
                ids[at] = next;
                next += 1;
                inner.push(rows.points[at]);
            }
        }
        let mut triangles = Vec::with_capacity(frequency * frequency);
        let vertex = |i, j| VertexId::new(ids[rows.at(i, j)] as usize);
        for j in 0..frequency {
            for i in 0..frequency - j {
                triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < frequency {
                    triangles.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
        (inner, triangles)
    });

    let mut positions = Vec::with_capacity(10 * frequency * frequency + 2);
    positions.extend(corners);
    positions.extend(arcs.iter().flat_map(|points| &points[1..frequency]));
    let mut triangles = Vec::with_capacity(20 * frequency * frequency);
    for (inner, part) in blocks {
        positions.extend(inner);
        triangles.extend(part);
    }
    manifold(positions, &FaceList::from_triangles(triangles))
}

/// The ends of the edges of the icosahedron, the smaller first, in order.
fn icosahedron_edges() -> [[usize; 2]; 30] {
    let mut edges = [[0; 2]; 30];
    let sides = ICOSAHEDRON_FACES.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    for (edge, side) in edges.iter_mut().zip(sides.filter(|side| side[0] < side[1])) {
        *edge = side;
    }
    edges.sort_unstable();
    edges
}

/// The points of an edge whose arcs are halved until there are `frequency` of them.
fn arc(start: DVec3, end: DVec3, frequency: usize) -> Vec<DVec3> {
    let mut points = vec![start; frequency + 1];
    points[frequency] = end;
    let mut step = frequency;
    while step > 1 {
        for i in (0..frequency).step_by(step) {
            points[i + step / 2] = midpoint(points[i], points[i + step]);
        }
        step /= 2;
    }
    points
}

/// The middle of the arc between two points of the unit sphere.
fn midpoint(p: DVec3, q: DVec3) -> DVec3 {
    (p + q).normalize()
}

/// A triangle of points in rows: row j has the points (0, j) to (frequency − j, j).
struct Rows {
    frequency: usize,
    points: Vec<DVec3>,
}

#[derive(Clone, Copy)]
enum Side {
    Bottom,
    Left,
    Right,
}

impl Rows {
    fn new(frequency: usize) -> Self {
        Rows { frequency, points: vec![DVec3::ZERO; (frequency + 1) * (frequency + 2) / 2] }
    }

    /// Where the point (i, j) is in the array.
    fn at(&self, i: usize, j: usize) -> usize {
        j * (2 * self.frequency + 3 - j) / 2 + i
    }

    /// Where the point `step` of a side is in the array.
    fn on(&self, side: Side, step: usize) -> usize {
        match side {
            Side::Bottom => self.at(step, 0),
            Side::Left => self.at(0, step),
            Side::Right => self.at(self.frequency - step, step),
        }
    }

    /// Sets the points inside, given those on the sides: halves the edges again and again.
    fn fill(&mut self) {
        let n = self.frequency;
        let mut step = n / 2;
        while step > 0 {
            // An edge of the coarser triangles is where one of i, j and i + j is a multiple of
            // 2·step; its middle is the point where the other two are odd multiples of step.
            for j in (0..=n).step_by(step) {
                for i in (0..=n - j).step_by(step) {
                    let (i_odd, j_odd) = (i / step % 2 == 1, j / step % 2 == 1);
                    let inside = i > 0 && j > 0 && i + j < n;
                    let (p, q) = match (i_odd, j_odd) {
                        _ if !inside => continue,
                        (false, false) => continue,
                        (true, false) => (self.at(i - step, j), self.at(i + step, j)),
                        (false, true) => (self.at(i, j - step), self.at(i, j + step)),
                        (true, true) => (self.at(i + step, j - step), self.at(i - step, j + step)),
                    };
                    let at = self.at(i, j);
                    self.points[at] = midpoint(self.points[p], self.points[q]);
                }
            }
            step /= 2;
        }
    }
}

/// The unit sphere of `meridians` × `parallels` quads, those at the poles (0, 0, ±1) triangles.
///
/// Rings run from south to north. `meridians` is at least 3, `parallels` at least 2.
pub fn uv_sphere(meridians: usize, parallels: usize) -> Result<Mesh, Error> {
    at_least("parallels", parallels, 2, "at least 2")?;
    face_count(&[meridians, parallels])?;
    let profile: Vec<DVec2> = (0..=parallels)
        .map(|j| {
            let latitude = PI * j as f64 / parallels as f64 - FRAC_PI_2;
            let is_pole = j == 0 || j == parallels;
            DVec2::new(if is_pole { 0.0 } else { latitude.cos() }, latitude.sin())
        })
        .collect();
    revolve(&profile, meridians, Tiling::Quads)
}

/// The unit sphere of 6·n² quads: an n × n × n cube inflated so that the quads have similar sizes.
pub fn quad_sphere(n: usize) -> Result<Mesh, Error> {
    let mut mesh = cuboid::quad_cuboid(DVec3::splat(2.0), [n, n, n])?;
    let bulge = |x: f64| (FRAC_PI_4 * x).tan();
    let inflated = mesh.map_vertices(|v| {
        let p = mesh.position(v);
        DVec3::new(bulge(p.x), bulge(p.y), bulge(p.z)).normalize()
    });
    mesh.set_positions(inflated);
    Ok(mesh)
}
