//! Queries against brute force over the indexed faces, and reports against what is known.

use std::collections::{BTreeMap, BTreeSet};

use dgp_mesh::{
    FaceId, VertexId, shapes,
    topology::{
        ClaimedCounts, FaceKind, boundary_loops, components, edge_uses, euler_characteristic,
        face_list_components, face_list_report, genus, path_length, plausibility,
    },
};

use crate::meshes;

#[test]
fn queries_agree_with_brute_force_over_the_faces() {
    for (name, mesh) in meshes() {
        let faces = mesh.to_faces();
        let mut neighbors: BTreeMap<VertexId, BTreeSet<VertexId>> = BTreeMap::new();
        let mut around: BTreeMap<VertexId, BTreeSet<FaceId>> = BTreeMap::new();
        for (f, face) in faces.iter() {
            for (i, &a) in face.iter().enumerate() {
                let b = face[(i + 1) % face.len()];
                neighbors.entry(a).or_default().insert(b);
                neighbors.entry(b).or_default().insert(a);
                around.entry(a).or_default().insert(f);
            }
        }
        let lists = mesh.vertex_adjacency();
        assert_eq!(lists.vertex_count(), mesh.vertex_count());
        for v in mesh.vertices() {
            let ring: Vec<VertexId> = mesh.vertex_neighbors(v).collect();
            assert_eq!(ring.iter().copied().collect::<BTreeSet<_>>(), neighbors[&v], "{name} {v}");
            assert_eq!((ring.len(), mesh.valence(v)), (neighbors[&v].len(), ring.len()), "{name}");
            assert_eq!(lists.neighbors(v), ring, "{name} {v}");
            assert_eq!(mesh.vertex_faces(v).collect::<BTreeSet<_>>(), around[&v], "{name} {v}");
            // In order: neighbors that follow each other share a face with v, all around or from
            // one end of the gap to the other.
            let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
            let gaps = pairs.filter(|&(&a, &b)| {
                !mesh.vertex_faces(v).any(|f| {
                    let corners: Vec<VertexId> = mesh.face_vertices(f).collect();
                    let at = corners.iter().position(|&c| c == v).unwrap();
                    let n = corners.len();
                    corners[(at + 1) % n] == a && corners[(at + n - 1) % n] == b
                })
            });
            assert_eq!(gaps.count(), usize::from(mesh.is_boundary_vertex(v)), "{name} {v}");
        }
        let some = |k: usize| VertexId::new(k * 7 % mesh.vertex_count());
        for (v, w) in (0..200).map(|k| (some(k), some(3 * k + 1))) {
            assert_eq!(mesh.are_adjacent(v, w), neighbors[&v].contains(&w), "{name} {v} {w}");
            let common: BTreeSet<FaceId> = mesh.common_faces(v, w).collect();
            assert_eq!(common, &around[&v] & &around[&w], "{name} {v} {w}");
        }
    }
}

#[test]
fn boundary_loops_are_the_edges_with_one_face_in_order() {
    for (name, mesh) in meshes() {
        let uses = edge_uses(mesh.vertex_count(), &mesh.to_faces());
        assert_eq!(uses.len(), mesh.edge_count(), "{name}");
        let mut rim: BTreeSet<[VertexId; 2]> =
            uses.iter().filter(|e| e.is_boundary()).map(|e| e.vertices).collect();
        for hole in boundary_loops(&mesh) {
            assert_eq!(hole.iter().min(), hole.first(), "{name}");
            for (&h, &g) in hole.iter().zip(hole.iter().cycle().skip(1)) {
                assert_eq!(mesh.to(h), mesh.from(g), "{name}");
                assert!(mesh.is_boundary_halfedge(h), "{name}");
                assert!(rim.remove(&mesh.edge_vertices(h.edge())), "{name}: {h} twice");
            }
        }
        assert!(rim.is_empty(), "{name}");
    }
    let cylinder = shapes::cylinder(1.0, 2.0, 200, 3).unwrap();
    for hole in boundary_loops(&cylinder) {
        assert!((path_length(&cylinder, &hole) - std::f64::consts::TAU).abs() < 1e-3);
    }
}

#[test]
fn mesh_and_face_list_have_the_same_topology() {
    for (name, mesh) in meshes() {
        let faces = mesh.to_faces();
        let report = face_list_report(mesh.vertex_count(), &faces);
        assert!(report.manifold && report.oriented && report.orientable, "{name}");
        assert_eq!(components(&mesh), face_list_components(mesh.vertex_count(), &faces), "{name}");
        assert_eq!(report.components.len(), components(&mesh).count, "{name}");
        assert_eq!(report.boundary_loops, boundary_loops(&mesh).len(), "{name}");
        assert_eq!(report.euler_characteristic, euler_characteristic(&mesh), "{name}");
        assert_eq!(report.genus, Some(genus(&mesh)), "{name}");
        let degrees: usize = report.valence.iter().map(|(k, count)| k * count).sum();
        assert_eq!(degrees, 2 * mesh.edge_count(), "{name}");
        let sides: usize = report.degree.iter().map(|(k, count)| k * count).sum();
        assert_eq!(sides + report.boundary_edges, 2 * mesh.edge_count(), "{name}");
        let claimed = ClaimedCounts {
            vertices: report.vertices,
            edges: report.edges,
            faces: report.faces,
            components: report.components.len(),
            boundary_loops: report.boundary_loops,
            kind: match (report.triangles, report.quads) {
                (n, _) if n == report.faces => FaceKind::Triangles,
                (_, n) if n == report.faces => FaceKind::Quads,
                _ => FaceKind::Polygons,
            },
        };
        let verdict = plausibility(&claimed);
        assert_eq!((verdict.broken, verdict.genus), (vec![], report.genus), "{name}");
    }
}

#[test]
fn genus_is_what_the_shape_was_made_with() {
    for handles in 0..5 {
        let report =
            |mesh: &dgp_mesh::Mesh| face_list_report(mesh.vertex_count(), &mesh.to_faces());
        if handles > 0 {
            let mesh = shapes::surface_of_genus(handles, 1).unwrap();
            assert_eq!(report(&mesh).genus, Some(handles));
        }
        let sphere = shapes::icosphere(2).unwrap();
        let closed = report(&sphere);
        assert_eq!(closed.faces, 2 * closed.vertices - 4);
        assert_eq!(closed.edges, 3 * closed.vertices - 6);
        let mean = 6.0 - 12.0 / closed.vertices as f64;
        assert!((closed.mean_valence().unwrap() - mean).abs() < 1e-14);
    }
    let strip = shapes::mobius_strip(20, 3).unwrap();
    let found = face_list_report(strip.vertex_count(), strip.faces());
    assert!(!found.orientable && found.manifold && found.boundary_loops == 1);
    assert_eq!((found.genus, found.euler_characteristic), (None, 0));
    let torus = shapes::quad_torus(2.0, 1.0, 8, 6).unwrap();
    let found = face_list_report(torus.vertex_count(), &torus.to_faces());
    assert_eq!((found.regular, found.genus), (Some(4), Some(1)));
}
