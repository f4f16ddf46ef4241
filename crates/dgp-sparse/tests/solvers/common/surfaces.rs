//! Graphs of surface meshes, without the surfaces.

use std::collections::BTreeMap;

use dgp_sparse::SparseMatrix;

use super::elements::icosphere;

/// The number of vertices, and the triangles.
pub(crate) type Surface = (usize, Vec<[u32; 3]>);

/// An icosahedron whose faces are cut in four so often.
pub(crate) fn sphere(level: usize) -> Surface {
    let (points, faces) = icosphere(level);
    (points.len(), faces)
}

/// A gyroid: so many cells of a grid along each side of a cube that holds two periods,
/// whose opposite sides are glued. A closed surface of genus 33.
pub(crate) fn gyroid(cells: u32) -> Surface {
    let turn = 4.0 * std::f64::consts::PI / f64::from(cells);
    let value = |p: [u32; 3]| {
        let [x, y, z] = p.map(|i| turn * (f64::from(i % cells) + 0.123));
        x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()
    };
    let index =
        |p: [u32; 3]| p.iter().fold(0_u64, |sum, &i| sum * u64::from(cells) + u64::from(i % cells));
    let mut crossings: BTreeMap<(u64, u64), u32> = BTreeMap::new();
    let mut faces = Vec::new();
    // Each cell is six tetrahedra along its diagonal (Freudenthal).
    let axes = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    for cell in 0..cells.pow(3) {
        let corner = [cell % cells, cell / cells % cells, cell / cells / cells];
        for path in axes {
            let mut points = [corner; 4];
            for step in 0..3 {
                points[step + 1] = points[step];
                points[step + 1][path[step]] += 1;
            }
            let (inside, outside): (Vec<_>, Vec<_>) =
                points.into_iter().partition(|&p| value(p) < 0.0);
            let mut cross = |a: usize, b: usize| {
                let (p, q) = (index(inside[a]), index(outside[b]));
                let next = crossings.len() as u32;
                *crossings.entry((p.min(q), p.max(q))).or_insert(next)
            };
            match (inside.len(), outside.len()) {
                (1, 3) => faces.push([cross(0, 0), cross(0, 1), cross(0, 2)]),
                (3, 1) => faces.push([cross(0, 0), cross(1, 0), cross(2, 0)]),
                (2, 2) => {
                    let quad = [cross(0, 0), cross(0, 1), cross(1, 1), cross(1, 0)];
                    faces.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
                }
                _ => {}
            }
        }
    }
    (crossings.len(), faces)
}

/// Each edge once, with weight 1.
pub(crate) fn edges_of(faces: &[[u32; 3]]) -> Vec<(u32, u32, f64)> {
    let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
    let mut edges: Vec<(u32, u32)> =
        faces.iter().flat_map(sides).map(|(a, b)| (a.min(b), a.max(b))).collect();
    edges.sort_unstable();
    edges.dedup();
    edges.into_iter().map(|(a, b)| (a, b, 1.0)).collect()
}

/// L + M of the graph, where M is a small mass.
pub(crate) fn system((n, faces): &Surface) -> SparseMatrix {
    let laplacian = SparseMatrix::from_edges(*n, &edges_of(faces)).unwrap();
    laplacian.plus_diagonal(&vec![1e-3; *n]).unwrap()
}
