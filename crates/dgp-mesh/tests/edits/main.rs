//! Edits: random sequences keep every invariant, inverse pairs restore the mesh, data follow.

mod charts;
mod inverse;
mod order;
mod random;
mod refusals;

use dgp_mesh::{Connectivity, DVec2, DVec3, FaceList, IndexedFaceSet, Mesh, UV, VertexId, shapes};

/// A triangle mesh closed and open, one of genus 1 and one of genus 2, and polygons.
fn five_meshes() -> Vec<(&'static str, Mesh)> {
    let faces = shapes::grid(9, 9).unwrap();
    let meshes = [
        ("icosphere", shapes::icosphere(2).unwrap()),
        ("torus", shapes::torus(2.0, 1.0, 16, 8).unwrap()),
        ("grid with holes", shapes::with_holes(&faces, 3, 1, 5).unwrap()),
        ("dodecahedron", shapes::dodecahedron()),
        ("double torus", shapes::quad_surface_of_genus(2, 1).unwrap()),
    ];
    meshes.into_iter().map(|(name, mesh)| (name, with_data(mesh))).collect()
}

/// An affine function of position, as data that must stay one.
fn affine(p: DVec3) -> DVec2 {
    DVec2::new(0.3 * p.x - 0.7 * p.y + 0.2 * p.z + 0.1, 0.5 * p.y + 0.9 * p.z - 1.5)
}

/// Corner and vertex data that are affine in position, and names on edges and faces.
fn with_data(mut mesh: Mesh) -> Mesh {
    let uv = mesh.map_halfedges(|h| {
        mesh.face(h).map_or(DVec2::ZERO, |_| affine(mesh.position(mesh.from(h))))
    });
    let place = mesh.map_vertices(|v| mesh.position(v));
    let edge_name = mesh.map_edges(|e| e.index() as u32);
    let face_name = mesh.map_faces(|f| f.index() as u32);
    let attributes = mesh.attributes_mut();
    attributes.corner.insert(UV, uv);
    attributes.vertex.insert("place", place);
    attributes.edge.insert("name", edge_name);
    attributes.face.insert("name", face_name);
    mesh
}

fn mesh(positions: &[[f64; 3]], faces: &[&[usize]]) -> Mesh {
    let positions: Vec<DVec3> = positions.iter().map(|&p| p.into()).collect();
    Mesh::new(&IndexedFaceSet::new(positions, FaceList::from_indices(faces)).unwrap()).unwrap()
}

/// The same faces on vertices in the plane, for tests in which positions do not matter.
fn flat(vertices: usize, faces: &[&[usize]]) -> Mesh {
    let positions: Vec<[f64; 3]> = (0..vertices).map(|i| [i as f64, (i * i) as f64, 0.0]).collect();
    mesh(&positions, faces)
}

fn v(i: usize) -> VertexId {
    VertexId::new(i)
}

fn side(mesh: &Connectivity, a: usize, b: usize) -> dgp_mesh::HalfedgeId {
    mesh.halfedge_between(v(a), v(b)).unwrap()
}

/// All faces as lists of vertices, each from its smallest on, in order: the same for meshes that
/// differ in the numbers of faces and edges only.
fn canonical_faces(mesh: &Connectivity) -> Vec<Vec<VertexId>> {
    let mut faces: Vec<Vec<VertexId>> = mesh
        .faces()
        .map(|f| {
            let mut face: Vec<_> = mesh.face_vertices(f).collect();
            let smallest = (0..face.len()).min_by_key(|&i| face[i]).unwrap();
            face.rotate_left(smallest);
            face
        })
        .collect();
    faces.sort();
    faces
}
