//! Distortion of maps that are known, and crossings.

use dgp_mesh::{DVec2, DVec3, Mesh, VertexMap};
use dgp_param::{boundary_crossings, distortion, face_distortions};

use super::{bent_grid, hills};

fn flat(n: usize) -> Mesh {
    bent_grid(n, |p| DVec3::new(p.x, p.y, 0.0))
}

fn image(mesh: &Mesh, matrix: [[f64; 2]; 2]) -> VertexMap<DVec2> {
    let [x, y] = matrix.map(DVec2::from);
    mesh.positions().map(|p| x * p.x + y * p.y)
}

#[test]
fn affine_maps_have_their_singular_values() {
    let mesh = flat(5);
    let (cos, sin) = (0.8, 0.6);
    // Turn, stretch by 3 and ½, turn back by another angle.
    let column = |x: f64, y: f64| {
        let turned = DVec2::from_angle(1.1).rotate(DVec2::new(x, y));
        DVec2::new(cos, sin).rotate(DVec2::new(3.0, 0.5) * turned).to_array()
    };
    let map = image(&mesh, [column(1.0, 0.0), column(0.0, 1.0)]);
    for face in face_distortions(&mesh, &map).unwrap().values() {
        assert!((face.largest - 3.0).abs() < 1e-13 && (face.smallest - 0.5).abs() < 1e-13);
        assert!((face.conformal() - 0.5 * (6.0 + 1.0 / 6.0)).abs() < 1e-12);
        assert!((face.areal() - 0.5 * (1.5 + 1.0 / 1.5)).abs() < 1e-12);
        let mixed = 0.25 * face.conformal() + 0.75 * face.areal();
        assert!((face.isometric(0.25) - mixed).abs() < 1e-12);
        let energy = 9.0 + 0.25 + 1.0 / 9.0 + 4.0;
        assert!((face.symmetric_dirichlet() - energy).abs() < 1e-11);
        assert!((face.largest_stretch() - 2.0).abs() < 1e-12);
        assert!((face.stretch() - (0.5 * (4.0 + 1.0 / 9.0_f64)).sqrt()).abs() < 1e-12);
    }
    let report = distortion(&mesh, &map).unwrap();
    assert!((report.mapped_area - 1.5).abs() < 1e-12 && (report.area - 1.0).abs() < 1e-12);
    // Once scaled to the same area, areas are kept.
    assert!((report.areal.max - 1.0).abs() < 1e-12);
}

#[test]
fn isometries_and_scalings_have_none() {
    let mesh = flat(4);
    for factor in [1.0, 1e-6, 1e9] {
        let report = distortion(&mesh, &image(&mesh, [[0.0, factor], [-factor, 0.0]])).unwrap();
        for spread in [report.conformal, report.areal] {
            assert!((spread.max - 1.0).abs() < 1e-12 && (spread.min - 1.0).abs() < 1e-12);
        }
        assert!((report.symmetric_dirichlet.mean - 4.0).abs() < 1e-11);
        assert!((report.stretch - 1.0).abs() < 1e-12);
    }
}

#[test]
fn faces_turned_over_or_flat_are_counted() {
    let mesh = flat(3);
    let mirrored = distortion(&mesh, &image(&mesh, [[1.0, 0.0], [0.0, -1.0]])).unwrap();
    assert_eq!((mirrored.flipped, mirrored.flat), (mesh.face_count(), 0));
    assert!((mirrored.mapped_area + 1.0).abs() < 1e-12);
    let collapsed = distortion(&mesh, &image(&mesh, [[1.0, 0.0], [0.0, 0.0]])).unwrap();
    assert_eq!((collapsed.flipped, collapsed.flat), (0, mesh.face_count()));

    // One vertex pulled across the other side of its ring.
    let mut map = image(&mesh, [[1.0, 0.0], [0.0, 1.0]]);
    let inside = mesh.vertices().find(|&v| !mesh.is_boundary_vertex(v)).unwrap();
    map[inside] += DVec2::new(0.9, 0.0);
    let folded = distortion(&mesh, &map).unwrap();
    assert!(folded.flipped >= 1 && folded.flipped < 6, "{}", folded.flipped);
}

#[test]
fn no_distortion_is_below_that_of_an_isometry() {
    let mesh = hills(12);
    let map: VertexMap<DVec2> = mesh.positions().map(|p| p.truncate());
    let report = distortion(&mesh, &map).unwrap();
    assert!(report.conformal.min >= 1.0 && report.areal.min >= 1.0);
    assert!(report.symmetric_dirichlet.min >= 4.0);
}

#[test]
fn crossings_of_a_polygon_are_found_as_looking_at_all_pairs_does() {
    let points = |list: &[[f64; 2]]| list.iter().copied().map(DVec2::from).collect::<Vec<_>>();
    let square = points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert!(boundary_crossings(&square).is_empty());
    let bow_tie = points(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(boundary_crossings(&bow_tie), [[0, 2]]);
    let there_and_back = points(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
    assert_eq!(boundary_crossings(&there_and_back), [[0, 1], [0, 2]]);
    // A rose with many loops, against all pairs.
    let rose: Vec<DVec2> = (0..120)
        .map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / 120.0;
            (0.3 + (5.0 * angle).cos()) * DVec2::from_angle(2.0 * angle)
        })
        .collect();
    let n = rose.len();
    let cross = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    let mut expected = Vec::new();
    for i in 0..n {
        for j in i + 2..n {
            if i == 0 && j == n - 1 {
                continue;
            }
            let (a, b, c, d) = (rose[i], rose[i + 1], rose[j], rose[(j + 1) % n]);
            if cross(a, b, c) * cross(a, b, d) <= 0.0 && cross(c, d, a) * cross(c, d, b) <= 0.0 {
                expected.push([i, j]);
            }
        }
    }
    assert!(expected.len() > 10);
    assert_eq!(boundary_crossings(&rose), expected);
}
