//! Texture seams: each side of a seam keeps its own values.

use dgp_mesh::{DVec2, DVec3, Editor, HalfedgeId, Label, Mesh, NORMAL, Normal, UV};

use super::{mesh, side, v};

/// ```text
/// 5 ─ 4 ─ 3
/// │ ╱ │ ╱ │      the left square is one chart, the right one another: a seam at 1–4
/// 0 ─ 1 ─ 2
/// ```
fn two_charts() -> Mesh {
    let mut mesh = mesh(
        &[[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [2., 1., 0.], [1., 1., 0.], [0., 1., 0.]],
        &[&[0, 1, 4], &[0, 4, 5], &[1, 2, 3], &[1, 3, 4]],
    );
    let uv = mesh.map_halfedges(|h| match mesh.face(h) {
        Some(f) => chart(f.index() < 2, mesh.position(mesh.from(h))),
        None => DVec2::ZERO,
    });
    mesh.attributes_mut().corner.insert(UV, uv);
    let part = mesh.map_faces(|f| Label::new(if f.index() < 2 { "left" } else { "right" }));
    mesh.attributes_mut().face.insert(dgp_mesh::GROUP, part);
    mesh
}

fn chart(is_left: bool, p: DVec3) -> DVec2 {
    if is_left { DVec2::new(p.x, p.y) } else { DVec2::new(5.0 - p.y, 2.0 * p.x) }
}

fn each_side_has_its_chart(mesh: &Mesh) {
    let uv = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
    let part = mesh.attributes().face.get::<Label>(dgp_mesh::GROUP).unwrap();
    for h in mesh.halfedges() {
        let Some(f) = mesh.face(h) else { continue };
        let expected = chart(part[f].as_str() == "left", mesh.position(mesh.from(h)));
        assert!(uv[h].distance(expected) < 1e-15, "{h} in {f}: {} for {expected}", uv[h]);
    }
}

#[test]
fn a_split_seam_stays_a_seam() {
    let position = DVec3::new(1.0, 0.25, 0.0);
    for with_triangles in [false, true] {
        let mut mesh = two_charts();
        let seam = side(&mesh, 1, 4).edge();
        let mut editor = Editor::new(&mut mesh);
        if with_triangles {
            editor.split_edge_triangles(seam, position).unwrap();
        } else {
            editor.split_edge(seam, position).unwrap();
        }
        drop(editor);
        each_side_has_its_chart(&mesh);
    }
}

#[test]
fn vertices_slide_along_a_seam() {
    // The rim 1–4 with a vertex in the middle of it, which may go either way.
    for toward in [1, 4] {
        for x in [1.0, 0.5] {
            let mut mesh = two_charts();
            let seam = side(&mesh, 1, 4).edge();
            let mut editor = Editor::new(&mut mesh);
            let m = editor.split_edge_triangles(seam, DVec3::new(1.0, 0.5, 0.0)).unwrap();
            let h = editor.mesh().halfedge_between(m, v(toward)).unwrap();
            let ends = [m, v(toward)].map(|w| editor.mesh().position(w));
            editor.collapse_at(h, (1.0 - x) * ends[0] + x * ends[1]).unwrap();
            drop(editor);
            mesh.validate().unwrap();
            each_side_has_its_chart(&mesh);
        }
    }
}

#[test]
fn a_vertex_that_leaves_a_seam_takes_its_own_chart_along() {
    // Into the seam: the corners of m are all of the left chart, and get the left value at 1.
    let mut mesh = two_charts();
    let mut editor = Editor::new(&mut mesh);
    let diagonal = side(editor.mesh(), 0, 4).edge();
    let m = editor.split_edge_triangles(diagonal, DVec3::new(0.5, 0.5, 0.0)).unwrap();
    let h = editor.mesh().halfedge_between(m, v(1)).unwrap();
    editor.collapse(h).unwrap();
    drop(editor);
    mesh.validate().unwrap();
    each_side_has_its_chart(&mesh);
}

#[test]
fn fill_ins_continue_their_neighbors() {
    let mut mesh = two_charts();
    let mut editor = Editor::new(&mut mesh);
    let f = editor.add_face(&[v(4), v(3), v(5)]).unwrap();
    drop(editor);
    let uv = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
    let corner = |a: usize, b: usize| uv[side(&mesh, a, b)];
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    assert_eq!(corner(4, 3), chart(false, at(1.0, 1.0)));
    assert_eq!(corner(3, 5), chart(false, at(2.0, 1.0)));
    assert_eq!(corner(5, 4), chart(true, at(0.0, 1.0)));
    let group = mesh.attributes().face.get::<Label>(dgp_mesh::GROUP).unwrap();
    assert_eq!(group[f].as_str(), "right");
}

#[test]
fn removed_faces_leave_no_corner_data_behind() {
    let mut mesh = two_charts();
    let mut editor = Editor::new(&mut mesh);
    let f = editor.mesh().face(side(editor.mesh(), 1, 2)).unwrap();
    editor.remove_face(f).unwrap();
    drop(editor);
    let uv = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
    let rim: Vec<HalfedgeId> = mesh.halfedges().filter(|&h| mesh.is_boundary_halfedge(h)).collect();
    assert!(rim.iter().all(|&h| uv[h] == DVec2::ZERO));
}

#[test]
fn reversed_normals_point_the_other_way() {
    let mut mesh = two_charts();
    let up = mesh.map_faces(|_| Normal(DVec3::Z));
    mesh.attributes_mut().face.insert(NORMAL, up);
    mesh.reverse();
    let normals = mesh.attributes().face.get::<Normal>(NORMAL).unwrap();
    assert!(normals.values().iter().all(|n| n.0 == -DVec3::Z));
}
