//! Boxes whose six sides are grids.

use glam::DVec3;

use super::{Tiling, at_least, face_count, length, manifold, patch::cells};
use crate::{Error, FaceList, Mesh, VertexId};

/// A box of this `size` around the origin with `n[k]` cells along axis k, each cell two triangles.
pub fn cuboid(size: DVec3, n: [usize; 3]) -> Result<Mesh, Error> {
    tiled(size, n, Tiling::Triangles)
}

/// A box of this `size` around the origin with `n[k]` quads along axis k.
pub fn quad_cuboid(size: DVec3, n: [usize; 3]) -> Result<Mesh, Error> {
    tiled(size, n, Tiling::Quads)
}

fn tiled(size: DVec3, n: [usize; 3], tiling: Tiling) -> Result<Mesh, Error> {
    for axis in 0..3 {
        length("size", size[axis])?;
        at_least("n", n[axis], 1, "at least 1")?;
        face_count(&[4, n[axis], n[(axis + 1) % 3]])?;
    }
    let shell = Shell { n };
    let [x, y, z] = n;
    let positions = shell.points().map(|p| {
        let at = |axis: usize| size[axis] * (p[axis] as f64 / n[axis] as f64 - 0.5);
        DVec3::new(at(0), at(1), at(2))
    });
    let mut faces = FaceList::new();
    let mut add = |columns, rows, point: &dyn Fn(usize, usize) -> [usize; 3]| {
        for (_, face) in cells([columns, rows], tiling, |i, j| shell.vertex(point(i, j))).iter() {
            faces.push(face);
        }
    };
    add(y, x, &|i, j| [j, i, 0]);
    add(x, z, &|i, j| [i, 0, j]);
    add(z, y, &|i, j| [0, j, i]);
    add(y, z, &|i, j| [x, i, j]);
    add(z, x, &|i, j| [j, y, i]);
    add(x, y, &|i, j| [i, j, z]);
    manifold(positions.collect(), &faces)
}

/// The lattice points on the surface of a box, layer by layer.
#[derive(Clone, Copy)]
struct Shell {
    n: [usize; 3],
}

impl Shell {
    /// The points in order of their vertices.
    fn points(self) -> impl Iterator<Item = [usize; 3]> {
        let [x, y, z] = self.n;
        (0..=z).flat_map(move |k| {
            let full = k == 0 || k == z;
            let rows = if full { y + 1 } else { 0 };
            let disk = (0..rows).flat_map(move |j| (0..=x).map(move |i| [i, j, k]));
            let around = if full { 0 } else { 2 * (x + y) };
            disk.chain((0..around).map(move |step| {
                let [i, j] = match step {
                    _ if step < x => [step, 0],
                    _ if step < x + y => [x, step - x],
                    _ if step < 2 * x + y => [2 * x + y - step, y],
                    _ => [0, 2 * (x + y) - step],
                };
                [i, j, k]
            }))
        })
    }

    fn vertex(self, [i, j, k]: [usize; 3]) -> VertexId {
        let [x, y, z] = self.n;
        let (disk, around) = ((x + 1) * (y + 1), 2 * (x + y));
        let index = match k {
            0 => j * (x + 1) + i,
            _ if k == z => disk + (z - 1) * around + j * (x + 1) + i,
            _ => {
                let step = match (i, j) {
                    (_, 0) => i,
                    _ if i == x => x + j,
                    _ if j == y => 2 * x + y - i,
                    _ => 2 * (x + y) - j,
                };
                disk + (k - 1) * around + step
            }
        };
        VertexId::new(index)
    }
}
