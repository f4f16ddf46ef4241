//! Long random sequences of all edits.

use std::collections::BTreeMap;

use dgp_mesh::{
    Compaction, DVec2, DVec3, EdgeId, EditError, Editor, FaceId, FaceSet, HalfedgeId, Mesh, UV,
    VertexId, shapes, shapes::Random,
};
use proptest::prelude::*;

use super::{affine, five_meshes, with_data};

/// An edit and the numbers that choose where.
#[derive(Clone, Copy, Debug)]
struct Step {
    kind: usize,
    at: [usize; 2],
    x: f64,
}

const KINDS: [&str; 14] = [
    "flip",
    "collapse",
    "collapse_at",
    "merge_faces",
    "merge_vertex_faces",
    "remove_face",
    "remove_faces",
    "remove_vertex",
    "split_edge",
    "split_edge_triangles",
    "split_face",
    "split_face_by",
    "add_face",
    "add_vertex",
];
/// Kinds before this one keep or lower the number of faces, others keep or raise it.
const GROWING: usize = 8;
/// Between this one and that kinds make holes.
const REMOVING: usize = 5;

fn apply(editor: &mut Editor<'_>, step: Step) -> Result<(), EditError> {
    let Step { kind, at, x } = step;
    let mesh = editor.mesh();
    let v = VertexId::new(at[0] % mesh.vertex_count().max(1));
    let h = HalfedgeId::new(at[0] % mesh.halfedge_count().max(1));
    let f = FaceId::new(at[0] % mesh.face_count().max(1));
    let e = h.edge();
    let euler_before = euler(editor);
    let keeps_euler = match KINDS[kind] {
        "flip" => editor.flip(e).map(|()| true),
        "collapse" => editor.collapse(h).map(|_| true),
        "collapse_at" => {
            let position = along(editor, e, x)?;
            editor.collapse_at(h, position).map(|_| true)
        }
        "merge_faces" => editor.merge_faces(e).map(|_| true),
        "merge_vertex_faces" => editor.merge_vertex_faces(v).map(|_| true),
        "remove_face" => editor.remove_face(f).map(|()| false),
        "remove_faces" => {
            let faces: FaceSet = [f, FaceId::new(at[1] % editor.mesh().face_count().max(1))]
                .into_iter()
                .filter(|&f| editor.has_face(f))
                .collect();
            let removal = editor.remove_faces(&faces)?;
            for (vertex, copy) in removal.copies {
                assert_eq!(editor.mesh().position(vertex), editor.mesh().position(copy));
            }
            Ok(false)
        }
        "remove_vertex" => editor.remove_vertex(v).map(|_| false),
        "split_edge" => {
            let position = along(editor, e, x)?;
            editor.split_edge(e, position).map(|_| true)
        }
        "split_edge_triangles" => {
            let position = along(editor, e, x)?;
            editor.split_edge_triangles(e, position).map(|_| true)
        }
        "split_face" => {
            let position = inside(editor, f, x)?;
            editor.split_face(f, position).map(|_| true)
        }
        "split_face_by" => {
            let Some(f) = live(editor, h).and_then(|h| editor.mesh().face(h)) else {
                return Err(EditError::BoundaryHalfedge { halfedge: h });
            };
            let sides: Vec<_> = editor.mesh().face_halfedges(f).collect();
            editor.split_face_by(h, sides[at[1] % sides.len()]).map(|_| true)
        }
        "add_face" => add_face(editor, h, v, x).map(|()| false),
        "add_vertex" => {
            let position = DVec3::new(x, 1.0 - x, 0.5);
            let v = editor.add_vertex(position)?;
            let places = editor.attributes_mut().vertex.get_mut::<DVec3>("place").unwrap();
            places[v.index()] = position;
            Ok(false)
        }
        _ => unreachable!(),
    }?;
    if keeps_euler {
        assert_eq!(euler(editor), euler_before, "{step:?}");
    }
    Ok(())
}

/// Adds an ear on two sides of a hole, fills the hole, or adds a flap with a vertex `v`.
fn add_face(editor: &mut Editor<'_>, h: HalfedgeId, v: VertexId, x: f64) -> Result<(), EditError> {
    let mesh = editor.mesh();
    let rim: Vec<VertexId> = match live(editor, h) {
        Some(h) if mesh.face(h).is_none() => mesh.loop_halfedges(h).map(|g| mesh.from(g)).collect(),
        _ => return Err(EditError::BoundaryHalfedge { halfedge: h }),
    };
    let vertices = match x {
        x if x < 0.1 => vec![rim[0], rim[1], v],
        x if x < 0.6 && rim.len() <= 12 => rim,
        _ => vec![rim[0], rim[1], rim[2]],
    };
    let f = editor.add_face(&vertices)?;
    // Corners at vertices that were isolated have no neighbor to continue.
    let corners: Vec<(HalfedgeId, DVec2)> = editor
        .mesh()
        .face_halfedges(f)
        .filter(|&h| editor.mesh().valence(editor.mesh().from(h)) == 2)
        .map(|h| (h, affine(editor.mesh().position(editor.mesh().from(h)))))
        .collect();
    let uvs = editor.attributes_mut().corner.get_mut::<DVec2>(UV).unwrap();
    for (h, uv) in corners {
        if uvs[h.index()] == DVec2::ZERO {
            uvs[h.index()] = uv;
        }
    }
    Ok(())
}

fn live(editor: &Editor<'_>, h: HalfedgeId) -> Option<HalfedgeId> {
    editor.has_halfedge(h).then_some(h)
}

fn along(editor: &Editor<'_>, e: EdgeId, x: f64) -> Result<DVec3, EditError> {
    if !editor.has_edge(e) {
        return Err(EditError::NoEdge { edge: e });
    }
    let [a, b] = editor.mesh().edge_vertices(e).map(|v| editor.mesh().position(v));
    Ok(a + x * (b - a))
}

/// A point of a triangle, or the mean of the corners.
fn inside(editor: &Editor<'_>, f: FaceId, x: f64) -> Result<DVec3, EditError> {
    if !editor.has_face(f) {
        return Err(EditError::NoFace { face: f });
    }
    let corners: Vec<_> =
        editor.mesh().face_vertices(f).map(|v| editor.mesh().position(v)).collect();
    Ok(match corners[..] {
        // Well inside: near a side of a sliver, rounding alone can put a point outside of it.
        [a, b, c] => {
            let x = 0.2 + 0.6 * x;
            0.2 * a + 0.8 * (x * b + (1.0 - x) * c)
        }
        _ => corners.iter().sum::<DVec3>() / corners.len() as f64,
    })
}

fn euler(editor: &Editor<'_>) -> i64 {
    editor.vertex_count() as i64 - editor.edge_count() as i64 + editor.face_count() as i64
}

/// Vertex and corner data are still the affine functions of position they were.
fn data_are_affine(editor: &Editor<'_>) {
    let mesh = editor.mesh();
    let uv = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
    let place = mesh.attributes().vertex.get::<DVec3>("place").unwrap();
    for v in editor.vertices() {
        let distance = place[v].distance(mesh.position(v));
        assert!(distance < 1e-12, "{v}: {} {}", place[v], mesh.position(v));
    }
    for h in editor.halfedges() {
        let expected = match mesh.face(h) {
            Some(_) => affine(mesh.position(mesh.from(h))),
            None => DVec2::ZERO,
        };
        assert!(uv[h].distance(expected) < 1e-12, "{h}: {} instead of {expected}", uv[h]);
    }
}

/// Positions, faces and data are where the maps say.
fn maps_are_right(before: &Mesh, compaction: &Compaction, after: &Mesh) {
    let uv = |mesh: &Mesh| mesh.attributes().corner.get::<DVec2>(UV).unwrap().to_map();
    let edge_name = |mesh: &Mesh| mesh.attributes().edge.get::<u32>("name").unwrap().to_map();
    let face_name = |mesh: &Mesh| mesh.attributes().face.get::<u32>("name").unwrap().to_map();
    let (uv, edge_name, face_name) = (
        [uv(before), uv(after)],
        [edge_name(before), edge_name(after)],
        [face_name(before), face_name(after)],
    );
    let mut counts = [0; 3];
    for (old, new) in compaction.vertices.iter() {
        let Some(new) = *new else { continue };
        counts[0] += 1;
        assert_eq!(before.position(old), after.position(new));
    }
    for (old, new) in compaction.edges.iter() {
        let Some(new) = *new else { continue };
        counts[1] += 1;
        let ends = before.edge_vertices(old).map(|v| compaction.vertices[v].unwrap());
        assert_eq!(ends, after.edge_vertices(new));
        assert_eq!(edge_name[0][old], edge_name[1][new]);
        for h in old.halfedges() {
            assert_eq!(uv[0][h], uv[1][compaction.halfedge(h).unwrap()]);
        }
    }
    for (old, new) in compaction.faces.iter() {
        let Some(new) = *new else { continue };
        counts[2] += 1;
        let corners = before.face_vertices(old).map(|v| compaction.vertices[v].unwrap());
        assert!(corners.eq(after.face_vertices(new)));
        assert_eq!(face_name[0][old], face_name[1][new]);
    }
    assert_eq!(counts, [after.vertex_count(), after.edge_count(), after.face_count()]);
}

#[test]
fn a_hundred_thousand_random_edits_keep_every_invariant() {
    const EDITS: usize = 100_000;
    /// So often everything is checked, which takes as long as many edits.
    const CHECK_EVERY: usize = 200;
    for (name, mut mesh) in five_meshes() {
        let size = mesh.face_count();
        let mut random = Random::new(size as u64);
        let mut done: BTreeMap<&str, usize> = BTreeMap::new();
        let mut edits = 0;
        while edits < EDITS {
            let mut editor = Editor::new(&mut mesh);
            for attempt in 0..CHECK_EVERY * 10 {
                let is_small = editor.face_count() < size.min(random.below(2 * size));
                let mut kind = if is_small {
                    GROWING + random.below(KINDS.len() - GROWING)
                } else {
                    random.below(GROWING)
                };
                // Holes are rare, for many edits need a closed neighborhood.
                if KINDS[kind].starts_with("remove") && random.below(32) > 0 {
                    kind = random.below(REMOVING);
                }
                let at = [random.bits() as usize >> 1, random.bits() as usize >> 1];
                let step = Step { kind, at, x: random.uniform() };
                let copy = (attempt % 20 == 0).then(|| editor.mesh().clone());
                let result = apply(&mut editor, step);
                match (&result, copy) {
                    (Ok(()), _) => *done.entry(KINDS[kind]).or_default() += 1,
                    (Err(_), Some(copy)) => assert_eq!(*editor.mesh(), copy, "{step:?}"),
                    (Err(_), None) => {}
                }
                edits += usize::from(result.is_ok());
                if result.is_ok() {
                    let mesh = editor.mesh();
                    let place = mesh.attributes().vertex.get::<DVec3>("place").unwrap();
                    let last = VertexId::new(mesh.vertex_count() - 1);
                    for v in [last] {
                        if editor.has_vertex(v) && place[v].distance(mesh.position(v)) > 1e-13 {
                            println!(
                                "BAD {step:?} {} {v} {:?}",
                                KINDS[kind],
                                mesh.position(v) - place[v]
                            );
                            for w in mesh.vertex_neighbors(v) {
                                println!(
                                    "  {} {} err {:e}",
                                    mesh.position(w) - mesh.position(v),
                                    w,
                                    place[w].distance(mesh.position(w))
                                );
                            }
                            panic!();
                        }
                    }
                }
                if attempt % CHECK_EVERY == 0 {
                    if let Err(error) = editor.validate() {
                        panic!("{name} after {edits} edits, {step:?}: {error}");
                    }
                    data_are_affine(&editor);
                }
            }
            // Lest they outnumber the others.
            let count = editor.vertex_count();
            let isolated = editor.remove_isolated_vertices();
            assert_eq!(editor.vertex_count(), count - isolated);
            data_are_affine(&editor);
            let before = editor.mesh().clone();
            let compaction = editor.finish();
            maps_are_right(&before, &compaction, &mesh);
            mesh.validate().unwrap();
        }
        for kind in KINDS {
            assert!(done[kind] > 100, "{name}: {kind} succeeded only {} times", done[kind]);
        }
    }
}

proptest! {
    #[test]
    fn every_step_of_a_short_sequence_keeps_every_invariant(
        shape in 0_usize..4,
        steps in prop::collection::vec(
            (0..KINDS.len(), any::<[usize; 2]>(), 0.0..=1.0_f64)
                .prop_map(|(kind, at, x)| Step { kind, at, x }),
            0..40,
        ),
    ) {
        let mut mesh = with_data(match shape {
            0 => shapes::tetrahedron(),
            1 => shapes::cube(),
            2 => shapes::quad_grid(2, 2).unwrap(),
            _ => shapes::grid(2, 1).unwrap(),
        });
        let mut editor = Editor::new(&mut mesh);
        for step in steps {
            let before = editor.mesh().clone();
            if apply(&mut editor, step).is_err() {
                prop_assert_eq!(editor.mesh(), &before);
            } else if let Err(error) = editor.validate() {
                prop_assert!(false, "{:?}: {}", step, error);
            }
            data_are_affine(&editor);
        }
        let before = editor.mesh().clone();
        let compaction = editor.finish();
        maps_are_right(&before, &compaction, &mesh);
    }
}
