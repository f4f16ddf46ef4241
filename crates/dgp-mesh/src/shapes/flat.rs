//! Flat shapes in the plane z = 0.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{Tiling, at_least, face_count, length, manifold, patch::cells, revolution::revolve};
use crate::{Error, FaceList, Mesh, VertexId};

/// The unit square as `n` × `m` cells of two triangles, all cut along the same diagonal.
///
/// Vertex j·(n + 1) + i is at (i/n, j/m).
pub fn grid(n: usize, m: usize) -> Result<Mesh, Error> {
    tiled(n, m, Tiling::Triangles)
}

/// The unit square as `n` × `m` quads, numbered as in [`grid`].
pub fn quad_grid(n: usize, m: usize) -> Result<Mesh, Error> {
    tiled(n, m, Tiling::Quads)
}

fn tiled(n: usize, m: usize, tiling: Tiling) -> Result<Mesh, Error> {
    at_least("n", n, 1, "at least 1")?;
    at_least("m", m, 1, "at least 1")?;
    face_count(&[2, n, m])?;
    let row =
        |j: usize| (0..=n).map(move |i| DVec3::new(i as f64 / n as f64, j as f64 / m as f64, 0.0));
    let positions = (0..=m).flat_map(row).collect();
    manifold(positions, &cells([n, m], tiling, |i, j| VertexId::new(j * (n + 1) + i)))
}

/// The unit disk as a center and `rings` rings of 6, 12, 18, … vertices: 6·rings² triangles of
/// similar size.
pub fn disk(rings: usize) -> Result<Mesh, Error> {
    at_least("rings", rings, 1, "at least 1")?;
    face_count(&[6, rings, rings])?;
    let mut positions = vec![DVec3::ZERO];
    for ring in 1..=rings {
        let radius = ring as f64 / rings as f64;
        positions.extend((0..6 * ring).map(|i| {
            let (sin, cos) = (TAU * i as f64 / (6 * ring) as f64).sin_cos();
            DVec3::new(radius * cos, radius * sin, 0.0)
        }));
    }
    // Ring r begins after 1 + 6 + … + 6(r − 1) vertices.
    let vertex = |ring: usize, i: usize| {
        VertexId::new(if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) + i % (6 * ring) })
    };
    let mut triangles = Vec::with_capacity(6 * rings * rings);
    for ring in 1..=rings {
        for sector in 0..6 {
            for k in 0..ring {
                let (outer, inner) = (sector * ring + k, sector * (ring - 1) + k);
                let [p, q] = [vertex(ring, outer), vertex(ring, outer + 1)];
                triangles.push([p, q, vertex(ring - 1, inner)]);
                if k + 1 < ring {
                    triangles.push([q, vertex(ring - 1, inner + 1), vertex(ring - 1, inner)]);
                }
            }
        }
    }
    manifold(positions, &FaceList::from_triangles(triangles))
}

/// The ring between two circles around the origin: `n` cells around, `m` across, of two triangles.
pub fn annulus(inner: f64, outer: f64, n: usize, m: usize) -> Result<Mesh, Error> {
    length("inner", inner)?;
    length("outer", outer)?;
    if inner >= outer {
        return Err(Error::option("inner", inner, "less than `outer`"));
    }
    at_least("m", m, 1, "at least 1")?;
    face_count(&[m])?;
    let radius = |j: usize| outer + (inner - outer) * (j as f64 / m as f64);
    let profile: Vec<DVec2> = (0..=m).map(|j| DVec2::new(radius(j), 0.0)).collect();
    revolve(&profile, n, Tiling::Triangles)
}
