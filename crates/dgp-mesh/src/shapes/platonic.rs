//! The five Platonic solids with their vertices on the unit sphere.

use glam::DVec3;

use super::manifold;
use crate::{FaceId, FaceList, Mesh};

/// The golden ratio, the long side of the rectangles that span an icosahedron.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// The sign of a coordinate from a bit of the number of its vertex.
const SIGNS: [f64; 2] = [-1.0, 1.0];

/// The regular tetrahedron: 4 vertices, 4 triangles.
pub fn tetrahedron() -> Mesh {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    solid(corners.map(DVec3::from), &[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
}

/// The cube: 8 vertices, 6 squares.
pub fn cube() -> Mesh {
    let corner = |i: usize| DVec3::new(SIGNS[i & 1], SIGNS[i >> 1 & 1], SIGNS[i >> 2 & 1]);
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    solid(std::array::from_fn::<_, 8, _>(corner), &faces)
}

/// The regular octahedron: 6 vertices, 8 triangles.
pub fn octahedron() -> Mesh {
    let corners = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    let faces =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    solid(corners, &faces)
}

/// The regular dodecahedron: 20 vertices, 12 pentagons. It is the dual of [`icosahedron`]: vertices
/// and faces have the numbers of its faces and vertices.
pub fn dodecahedron() -> Mesh {
    let dual = icosahedron();
    let center = |f| dual.face_vertices(f).map(|v| dual.position(v)).sum::<DVec3>();
    let corners: Vec<DVec3> = dual.faces().map(center).collect();
    let face = |v| dual.vertex_faces(v).map(FaceId::index).collect();
    let faces: Vec<Vec<usize>> = dual.vertices().map(face).collect();
    solid(corners, &faces)
}

/// The regular icosahedron: 12 vertices, 20 triangles.
pub fn icosahedron() -> Mesh {
    solid(icosahedron_corners(), &ICOSAHEDRON_FACES)
}

/// The vertices of [`icosahedron`].
pub(super) fn icosahedron_corners() -> [DVec3; 12] {
    // Three golden rectangles, each in one plane of the axes.
    let corners = std::array::from_fn(|i| {
        let (long, short) = (GOLDEN * SIGNS[i >> 1 & 1], SIGNS[i & 1]);
        match i >> 2 {
            0 => DVec3::new(short, long, 0.0),
            1 => DVec3::new(0.0, short, long),
            _ => DVec3::new(long, 0.0, short),
        }
    });
    corners.map(DVec3::normalize)
}

/// The faces of [`icosahedron`].
pub(super) const ICOSAHEDRON_FACES: [[usize; 3]; 20] = [
    [0, 4, 1],
    [0, 1, 6],
    [0, 6, 9],
    [0, 9, 8],
    [0, 8, 4],
    [4, 8, 5],
    [2, 5, 8],
    [2, 8, 9],
    [2, 9, 7],
    [2, 7, 3],
    [2, 3, 5],
    [3, 10, 5],
    [3, 11, 10],
    [3, 7, 11],
    [6, 11, 7],
    [1, 11, 6],
    [1, 10, 11],
    [1, 4, 10],
    [4, 5, 10],
    [6, 7, 9],
];

fn solid<F: AsRef<[usize]>>(corners: impl IntoIterator<Item = DVec3>, faces: &[F]) -> Mesh {
    let corners = corners.into_iter().map(DVec3::normalize).collect();
    manifold(corners, &FaceList::from_indices(faces)).expect("the faces of a solid are a manifold")
}
