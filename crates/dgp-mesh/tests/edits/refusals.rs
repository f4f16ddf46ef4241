//! Edits that would leave no manifold: each refused with its reason, on the smallest mesh that has it.

use dgp_mesh::{DVec3, EditError, Editor, FaceId, FaceSet, HalfedgeId, Mesh, shapes};

use super::{flat, side, v};

/// The refusal of `edit`, which must not change the mesh.
fn refusal<T: std::fmt::Debug>(
    mesh: &Mesh,
    edit: impl Fn(&mut Editor<'_>) -> Result<T, EditError>,
) -> EditError {
    let mut copy = mesh.clone();
    let error = edit(&mut Editor::new(&mut copy)).unwrap_err();
    assert!(copy == *mesh, "{error}: but the mesh changed");
    error
}

/// ```text
/// 3 ─ 2
/// │ ╱ │
/// 0 ─ 1
/// ```
fn square() -> Mesh {
    flat(4, &[&[0, 1, 2], &[0, 2, 3]])
}

#[test]
fn flips() {
    let square = square();
    let rim = side(&square, 0, 1).edge();
    assert_eq!(refusal(&square, |e| e.flip(rim)), EditError::BoundaryEdge { edge: rim });

    // In a tetrahedron all vertices are joined already.
    let tetrahedron = shapes::tetrahedron();
    for e in tetrahedron.edges() {
        assert!(matches!(
            refusal(&tetrahedron, |editor| editor.flip(e)),
            EditError::EdgeExists { .. }
        ));
    }

    // Two triangles back to back have the same opposite vertex.
    let pillow = flat(3, &[&[0, 1, 2], &[0, 2, 1]]);
    let e = side(&pillow, 0, 1).edge();
    assert_eq!(
        refusal(&pillow, |editor| editor.flip(e)),
        EditError::RepeatedVertex { vertex: v(2) }
    );

    // Split, both would be joined to it.
    assert!(matches!(
        refusal(&pillow, |editor| editor.split_edge_triangles(e, DVec3::ZERO)),
        EditError::SameCorners { .. }
    ));

    // 2 is on both quads, at two edges next to each other.
    let corner = flat(5, &[&[0, 1, 2, 3], &[1, 0, 4, 2]]);
    let e = side(&corner, 0, 1).edge();
    assert_eq!(
        refusal(&corner, |editor| editor.flip(e)),
        EditError::RepeatedVertex { vertex: v(2) }
    );
}

#[test]
fn collapses() {
    // Across the square: the boundary would touch itself.
    let square = square();
    let diagonal = side(&square, 0, 2);
    assert_eq!(
        refusal(&square, |e| e.collapse(diagonal)),
        EditError::BoundaryEnds { edge: diagonal.edge() }
    );

    // A lone triangle, and one that hangs on the edge only.
    let triangle = flat(3, &[&[0, 1, 2]]);
    for h in triangle.halfedges() {
        assert!(matches!(refusal(&triangle, |e| e.collapse(h)), EditError::LastFace { .. }));
    }

    // A ring of three quads around a hole of three sides, open at the other end too: any edge of the
    // hole has the third vertex beside it.
    let ring = flat(6, &[&[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]]);
    let h = side(&ring, 0, 1);
    assert_eq!(
        refusal(&ring, |e| e.collapse(h)),
        EditError::LinkCondition { edge: h.edge(), vertex: v(2) }
    );

    let tetrahedron = shapes::tetrahedron();
    for h in tetrahedron.halfedges() {
        assert!(matches!(refusal(&tetrahedron, |e| e.collapse(h)), EditError::SameCorners { .. }));
    }
    let pillow = flat(3, &[&[0, 1, 2], &[0, 2, 1]]);
    let h = side(&pillow, 0, 1);
    assert!(matches!(refusal(&pillow, |e| e.collapse(h)), EditError::SameCorners { .. }));
}

#[test]
fn a_polygon_at_both_ends_of_an_edge_but_not_at_it_is_refused() {
    // The edge 0–1 with triangles 2 and 3 beside it; a hexagon meets 0 and 1 at opposite corners.
    let mesh = flat(
        8,
        &[
            &[0, 1, 2],
            &[1, 0, 3],
            &[0, 2, 4],
            &[2, 1, 5],
            &[0, 4, 6, 1, 7, 3],
            &[2, 5, 4],
            &[1, 6, 4, 5],
        ],
    );
    let h = side(&mesh, 0, 1);
    assert_eq!(refusal(&mesh, |e| e.collapse(h)), EditError::RepeatedVertex { vertex: v(1) });
}

#[test]
fn cuts_and_merges() {
    let quads = shapes::quad_grid(2, 1).unwrap();
    let (h, other) = {
        let mut faces = quads.faces().map(|f| quads.face_halfedge(f));
        (faces.next().unwrap(), faces.next().unwrap())
    };
    let next = quads.next(h);
    assert!(matches!(refusal(&quads, |e| e.split_face_by(h, next)), EditError::EdgeExists { .. }));
    assert!(matches!(refusal(&quads, |e| e.split_face_by(h, h)), EditError::RepeatedVertex { .. }));
    assert_eq!(
        refusal(&quads, |e| e.split_face_by(h, other)),
        EditError::DifferentFaces { halfedges: [h, other] }
    );
    let rim = quads.halfedges().find(|&h| quads.is_boundary_halfedge(h)).unwrap();
    assert_eq!(
        refusal(&quads, |e| e.split_face_by(rim, quads.next(rim))),
        EditError::BoundaryHalfedge { halfedge: rim }
    );
    assert_eq!(
        refusal(&quads, |e| e.merge_faces(rim.edge())),
        EditError::BoundaryEdge { edge: rim.edge() }
    );
    assert_eq!(
        refusal(&quads, |e| e.merge_vertex_faces(v(0))),
        EditError::BoundaryVertex { vertex: v(0) }
    );

    // Two quads that share two edges: a merged face would have a loose end.
    let corner = flat(5, &[&[0, 1, 2, 3], &[1, 0, 4, 2]]);
    let e = side(&corner, 0, 1).edge();
    assert_eq!(
        refusal(&corner, |editor| editor.merge_faces(e)),
        EditError::RepeatedVertex { vertex: v(2) }
    );
    let pillow = flat(3, &[&[0, 1, 2], &[0, 2, 1]]);
    assert_eq!(
        refusal(&pillow, |e| e.merge_vertex_faces(v(0))),
        EditError::TooFewCorners { count: 2 }
    );
}

#[test]
fn additions() {
    let mut square = square();
    let apart = Editor::new(&mut square).add_vertex(DVec3::ONE).unwrap();
    let more = Editor::new(&mut square).add_vertex(DVec3::NEG_ONE).unwrap();
    let add = |corners: &[usize]| {
        let corners: Vec<_> = corners.iter().map(|&i| v(i)).collect();
        refusal(&square, |e| e.add_face(&corners))
    };
    assert_eq!((apart, more), (v(4), v(5)));
    assert_eq!(add(&[0, 1]), EditError::TooFewCorners { count: 2 });
    assert_eq!(add(&[0, 4, 0]), EditError::RepeatedVertex { vertex: v(0) });
    assert_eq!(add(&[0, 4, 9]), EditError::NoVertex { vertex: v(9) });
    let face = FaceId::new(0);
    assert_eq!(add(&[0, 1, 4]), EditError::SideTaken { vertices: [v(0), v(1)], face });
    assert_eq!(add(&[0, 4, 5]), EditError::SeveralFans { vertex: v(0) });
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(refusal(&square, |e| e.add_vertex(DVec3::splat(bad))), EditError::NonFinite);
        let e = side(&square, 0, 2).edge();
        assert_eq!(
            refusal(&square, |editor| editor.split_edge_triangles(e, DVec3::splat(bad))),
            EditError::NonFinite
        );
    }
}

#[test]
fn removals() {
    // The middle of three triangles around 0.
    let fan = flat(5, &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4]]);
    let middle = FaceId::new(1);
    assert_eq!(refusal(&fan, |e| e.remove_face(middle)), EditError::SeveralFans { vertex: v(0) });

    let mut mesh = fan;
    let mut editor = Editor::new(&mut mesh);
    let faces: FaceSet = [middle].into_iter().collect();
    let removal = editor.remove_faces(&faces).unwrap();
    assert_eq!(removal.copies, [(v(0), v(5))]);
    assert_eq!(removal.isolated, []);
    assert_eq!(editor.remove_face(middle), Err(EditError::NoFace { face: middle }));
    let removal = editor.remove_vertex(v(5)).unwrap();
    assert_eq!(removal.isolated.len(), 2);
    assert_eq!(editor.remove_isolated_vertices(), 2);
    let compaction = editor.finish();
    mesh.validate().unwrap();
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (3, 1));
    assert_eq!(compaction.faces.values().iter().flatten().count(), 1);
}

#[test]
fn what_is_gone() {
    let mut mesh = shapes::icosahedron();
    let mut editor = Editor::new(&mut mesh);
    let h = HalfedgeId::new(0);
    let [gone, kept] = [editor.mesh().from(h), editor.mesh().to(h)];
    assert_eq!(editor.collapse(h), Ok(kept));
    assert_eq!(editor.collapse(h), Err(EditError::NoHalfedge { halfedge: h }));
    assert_eq!(editor.flip(h.edge()), Err(EditError::NoEdge { edge: h.edge() }));
    assert_eq!(editor.remove_vertex(gone).unwrap_err(), EditError::NoVertex { vertex: gone });
    assert!(!editor.has_vertex(gone) && !editor.vertices().any(|w| w == gone));
    // Walks from what is gone end.
    assert_eq!(editor.mesh().vertex_halfedges(gone).count(), 0);
    assert_eq!(editor.mesh().loop_halfedges(h).count(), 1);
    assert_eq!((editor.vertex_count(), editor.edge_count(), editor.face_count()), (11, 27, 18));
    assert_eq!(editor.edges().count(), 27);
    assert_eq!(editor.halfedges().count(), 54);
    assert_eq!(editor.faces().count(), 18);
}
