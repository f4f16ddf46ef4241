//! Pairs of edits that undo each other.

use dgp_mesh::{DVec3, EdgeId, Editor, FaceId, Mesh, shapes};

use super::{canonical_faces, five_meshes, with_data};

/// Does `there`, then `back` at the element it returned, at each element; all but refusals must
/// restore the mesh exactly. Returns how often it was done.
fn restores<I, J>(
    name: &str,
    mut mesh: Mesh,
    elements: impl Iterator<Item = I>,
    there: impl Fn(&mut Editor<'_>, I) -> Option<J>,
    back: impl Fn(&mut Editor<'_>, J),
) -> usize {
    let before = mesh.clone();
    let mut count = 0;
    for element in elements {
        let mut editor = Editor::new(&mut mesh);
        if let Some(made) = there(&mut editor, element) {
            editor.validate().unwrap();
            back(&mut editor, made);
            count += 1;
        }
        let _ = editor.finish();
        assert!(mesh == before, "{name}");
    }
    count
}

fn middle(editor: &Editor<'_>, e: EdgeId) -> DVec3 {
    let [a, b] = editor.mesh().edge_vertices(e).map(|v| editor.mesh().position(v));
    0.25 * a + 0.75 * b
}

#[test]
fn collapsing_the_new_half_undoes_a_split_exactly() {
    for (name, mesh) in five_meshes() {
        for triangles in [false, true] {
            let edges = mesh.edges();
            let count = restores(
                name,
                mesh.clone(),
                edges,
                |editor, e| {
                    let half = EdgeId::new(editor.mesh().edge_count());
                    let position = middle(editor, e);
                    if triangles {
                        editor.split_edge_triangles(e, position).unwrap();
                    } else {
                        editor.split_edge(e, position).unwrap();
                    }
                    Some(half.halfedge())
                },
                |editor, half| {
                    editor.collapse(half).unwrap();
                },
            );
            assert_eq!(count, mesh.edge_count());
        }
    }
}

#[test]
fn merging_around_the_new_vertex_undoes_a_face_split_exactly() {
    for (name, mesh) in five_meshes() {
        let faces = mesh.faces();
        let count = restores(
            name,
            mesh.clone(),
            faces,
            |editor, f| {
                let sum: DVec3 =
                    editor.mesh().face_vertices(f).map(|v| editor.mesh().position(v)).sum();
                Some((f, editor.split_face(f, sum / editor.mesh().degree(f) as f64).unwrap()))
            },
            |editor, (f, center)| assert_eq!(editor.merge_vertex_faces(center), Ok(f)),
        );
        assert_eq!(count, mesh.face_count());
    }
}

#[test]
fn merging_over_the_new_edge_undoes_a_cut_exactly() {
    let polygons = [
        with_data(shapes::dodecahedron()),
        with_data(shapes::quad_surface_of_genus(2, 1).unwrap()),
        with_data(shapes::quad_grid(4, 3).unwrap()),
    ];
    for mesh in polygons {
        let sides = mesh.halfedges();
        let count = restores(
            "polygons",
            mesh.clone(),
            sides,
            |editor, h| {
                let across = editor.mesh().next(editor.mesh().next(h));
                editor.split_face_by(h, across).ok()
            },
            |editor, chord| {
                editor.merge_faces(chord).unwrap();
            },
        );
        let inner = mesh.halfedges().filter(|&h| !mesh.is_boundary_halfedge(h)).count();
        assert_eq!(count, inner);
    }
}

#[test]
fn an_edge_flipped_all_the_way_round_is_back() {
    for (name, mut mesh) in five_meshes() {
        let before = mesh.clone();
        let mut flipped = 0;
        for e in before.edges() {
            let [Some(f), Some(g)] = before.edge_faces(e) else { continue };
            let turns = before.degree(f) + before.degree(g) - 2;
            let mut editor = Editor::new(&mut mesh);
            if editor.can_flip(e).is_err() {
                continue;
            }
            for _ in 0..turns {
                editor.flip(e).unwrap();
                editor.validate().unwrap();
            }
            drop(editor);
            flipped += 1;
            // All but the half-edges with which rings start.
            for h in before.halfedges() {
                assert_eq!(mesh.next(h), before.next(h), "{name} {e}");
                assert_eq!(mesh.prev(h), before.prev(h), "{name} {e}");
                assert_eq!(mesh.to(h), before.to(h), "{name} {e}");
                assert_eq!(mesh.face(h), before.face(h), "{name} {e}");
            }
            for f in before.faces() {
                assert_eq!(mesh.face_halfedge(f), before.face_halfedge(f), "{name} {e}");
            }
            assert_eq!(mesh.attributes(), before.attributes());
            assert_eq!(mesh.positions(), before.positions());
        }
        assert!(flipped > 0, "{name}");
    }
}

#[test]
fn a_face_added_again_is_back_under_a_new_id() {
    for (name, mut mesh) in five_meshes() {
        let before = mesh.clone();
        for f in before.faces() {
            let corners: Vec<_> = before.face_vertices(f).collect();
            let mut copy = mesh.clone();
            let mut editor = Editor::new(&mut copy);
            if editor.remove_face(f).is_err() {
                continue;
            }
            editor.validate().unwrap();
            editor.add_face(&corners).unwrap();
            let _ = editor.finish();
            copy.validate().unwrap();
            assert_eq!(canonical_faces(&copy), canonical_faces(&before), "{name} {f}");
        }
        mesh.reverse();
        mesh.validate().unwrap();
        assert_ne!(canonical_faces(&mesh), canonical_faces(&before));
        mesh.reverse();
        assert!(mesh == before, "{name}: twice reversed");
    }
}

#[test]
fn reversed_faces_start_with_the_same_corner_and_keep_its_data() {
    let before = with_data(shapes::quad_grid(3, 2).unwrap());
    let mut mesh = before.clone();
    mesh.reverse();
    let uv = |mesh: &Mesh, f: FaceId| {
        let uv = mesh.attributes().corner.get::<dgp_mesh::DVec2>(dgp_mesh::UV).unwrap();
        mesh.face_halfedges(f).map(|h| (mesh.from(h), uv[h])).collect::<Vec<_>>()
    };
    for f in before.faces() {
        let mut expected = uv(&before, f);
        expected[1..].reverse();
        assert_eq!(uv(&mesh, f), expected);
    }
}
