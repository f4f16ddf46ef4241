//! Edits keep a manifold.

use dgp_mesh::shapes;

use super::*;

fn surface(mesh: &Mesh) -> Surface {
    Surface::new(mesh, mesh.positions().values().to_vec(), 1.0).unwrap()
}

/// All that must hold between triangles and vertices.
fn check(surface: &Surface) {
    let mut count = 0;
    for f in (0..surface.triangles.len()).filter(|&f| surface.has(f)) {
        count += 1;
        for h in (4 * f as u32)..(4 * f as u32 + 3) {
            let t = surface.twin(h);
            if t != NONE {
                assert_eq!(surface.twin(t), h, "twins");
                assert_eq!(surface.from(t), surface.to(h), "twins are opposite");
                assert_eq!(surface.line(t), surface.line(h), "lines of twins");
            }
            assert!(surface.vertex(surface.from(h)).is_there, "no corner is gone");
        }
    }
    assert_eq!(count, surface.face_count);
    for v in 0..surface.vertices.len() as u32 {
        let vertex = surface.vertex(v);
        if !vertex.is_there || vertex.spoke == NONE {
            continue;
        }
        let mut neighbors = Vec::new();
        surface.each_neighbor(v, |w| neighbors.push(w));
        assert!(surface.spokes(v).all(|h| surface.from(h) == v), "spokes leave their vertex");
        assert_eq!(neighbors.len(), vertex.valence as usize, "valence of {v}");
        let first = surface.twin(vertex.spoke);
        assert_eq!(first == NONE, vertex.on_rim, "the first spoke of {v}");
        neighbors.sort_unstable();
        neighbors.dedup();
        assert_eq!(neighbors.len(), vertex.valence as usize, "no double edge at {v}");
    }
}

#[test]
fn any_sequence_of_edits_keeps_a_manifold() {
    for mesh in [
        shapes::icosphere(2).unwrap(),
        shapes::grid(5, 6).unwrap(),
        shapes::annulus(0.5, 1.0, 9, 2).unwrap(),
        shapes::surface_of_genus(2, 1).unwrap(),
    ] {
        let mut surface = surface(&mesh);
        check(&surface);
        let mut random = 12_345_u64;
        let mut done = [0; 3];
        for _ in 0..4000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695);
            let pick = (random >> 33) as usize;
            let h = (4 * (pick / 12 % surface.triangles.len()) + pick % 3) as u32;
            if !surface.has((h >> 2) as usize) {
                continue;
            }
            match pick / 3 % 4 {
                0 => {
                    let p =
                        surface.position(surface.from(h)).midpoint(surface.position(surface.to(h)));
                    surface.split(h, p, Vertex::new(1.0)).unwrap();
                    done[0] += 1;
                }
                1 if surface.twin(h) != NONE => {
                    let t = surface.twin(h);
                    let (c, d) = (surface.from(prev(h)), surface.from(prev(t)));
                    let least = |v: u32| if surface.vertex(v).on_rim { 2 } else { 3 };
                    let (a, b) = (surface.from(h), surface.to(h));
                    let may = [a, b].iter().all(|&v| surface.vertex(v).valence > least(v));
                    if may && !surface.are_joined(c, d) {
                        surface.flip(h);
                        done[1] += 1;
                    }
                }
                _ if surface.may_collapse(h) => {
                    let goes = if pick.is_multiple_of(2) { surface.from(h) } else { surface.to(h) };
                    surface.collapse(h, goes);
                    done[2] += 1;
                }
                _ => {}
            }
            if pick.is_multiple_of(64) {
                check(&surface);
            }
        }
        check(&surface);
        assert!(done.iter().all(|&count| count > 30), "{done:?}");
    }
}

#[test]
fn a_flip_back_and_forth_changes_no_neighbor() {
    let mut surface = surface(&shapes::icosphere(1).unwrap());
    let before: Vec<u32> = surface.vertices.iter().map(|v| v.valence).collect();
    let h = 7 * 4 + 1;
    surface.flip(h);
    check(&surface);
    assert_ne!(before, surface.vertices.iter().map(|v| v.valence).collect::<Vec<_>>());
    surface.flip(h);
    check(&surface);
    assert_eq!(before, surface.vertices.iter().map(|v| v.valence).collect::<Vec<_>>());
}
