//! Reordering.

use dgp_mesh::{DVec2, DVec3, IndexedFaceSet, Mesh, UV, VertexId, VertexMap, reorder, shapes};

use super::five_meshes;

#[test]
fn a_reordered_mesh_is_the_same_surface() {
    for (name, before) in five_meshes() {
        let mut after = before.clone();
        let new = reorder(&mut after);
        after.validate().unwrap();
        let uv = |mesh: &Mesh| mesh.attributes().corner.get::<DVec2>(UV).unwrap().to_map();
        let uv = [uv(&before), uv(&after)];
        let place = after.attributes().vertex.get::<DVec3>("place").unwrap();
        let edge_name = after.attributes().edge.get::<u32>("name").unwrap();
        let face_name = after.attributes().face.get::<u32>("name").unwrap();
        for v in before.vertices() {
            assert_eq!(after.position(new.vertices[v]), before.position(v), "{name}");
            assert_eq!(place[new.vertices[v]], before.position(v), "{name}");
        }
        for h in before.halfedges() {
            let g = new.halfedge(h);
            assert_eq!(after.next(g), new.halfedge(before.next(h)));
            assert_eq!(after.prev(g), new.halfedge(before.prev(h)));
            assert_eq!(after.to(g), new.vertices[before.to(h)]);
            assert_eq!(after.face(g), before.face(h).map(|f| new.faces[f]));
            assert_eq!(uv[1][g], uv[0][h]);
        }
        for e in before.edges() {
            assert_eq!(edge_name[new.edges[e]] as usize, e.index());
        }
        for f in before.faces() {
            assert_eq!(face_name[new.faces[f]] as usize, f.index());
            assert_eq!(after.face_halfedge(new.faces[f]), new.halfedge(before.face_halfedge(f)));
        }
    }
}

#[test]
fn neighbors_are_closer_in_memory_than_in_random_order() {
    let sphere = shapes::icosphere(4).unwrap();
    let mut mesh = Mesh::new(&shapes::shuffled(&sphere.to_indexed(), 1)).unwrap();
    let distance = |mesh: &Mesh| {
        let total: usize = mesh
            .edges()
            .map(|e| mesh.edge_vertices(e).map(VertexId::index))
            .map(|[a, b]| a.abs_diff(b))
            .sum();
        total as f64 / mesh.edge_count() as f64
    };
    let before = distance(&mesh);
    let _ = reorder(&mut mesh);
    // A third of the vertices in random order.
    assert!(before > 0.3 * mesh.vertex_count() as f64);
    assert!(distance(&mesh) < 0.1 * before, "{before} → {}", distance(&mesh));
}

#[test]
fn the_order_does_not_depend_on_the_scale() {
    let mesh = shapes::blob(2).unwrap();
    let order = |scale: f64| {
        let mut scaled = mesh.clone();
        scaled.set_positions(mesh.map_vertices(|v| mesh.position(v) * scale));
        reorder(&mut scaled)
    };
    let expected = order(1.0);
    for exponent in [-1000, -3, 900] {
        assert_eq!(order(2_f64.powi(exponent)), expected);
    }
}

#[test]
fn meshes_without_extent_keep_their_order() {
    let mut point = shapes::tetrahedron();
    point.set_positions(VertexMap::filled(4, DVec3::ONE));
    let new = reorder(&mut point);
    assert!(new.vertices.iter().all(|(old, &new)| old == new));
    point.validate().unwrap();
    let mut empty = Mesh::new(&IndexedFaceSet::default()).unwrap();
    assert!(reorder(&mut empty).vertices.is_empty());
}
