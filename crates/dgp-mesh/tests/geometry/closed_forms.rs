//! Numbers that are known exactly.

use std::f64::consts::{PI, SQRT_2};

use dgp_mesh::{
    DMat3, DVec3, Mesh,
    measure::{
        NormalWeight, VertexArea, area, edge_lengths, mass_properties, oriented_box,
        surface_centroid, vertex_areas, vertex_centroid, vertex_normals, volume,
    },
    shapes,
    topology::face_list_report,
};

use crate::{is_close, moved, rotation};

#[test]
fn platonic_solids_have_their_areas_volumes_angles_and_moments() {
    let root = |x: f64| x.sqrt();
    let phi = f64::midpoint(1.0, root(5.0));
    // Edge length 1: area, volume, cosine of the angle between faces, moment of inertia over mass.
    let solids: [(Mesh, f64, f64, f64, f64); 5] = [
        (shapes::tetrahedron(), root(3.0), 1.0 / (6.0 * SQRT_2), 1.0 / 3.0, 1.0 / 20.0),
        (shapes::cube(), 6.0, 1.0, 0.0, 1.0 / 6.0),
        (shapes::octahedron(), 2.0 * root(3.0), SQRT_2 / 3.0, -1.0 / 3.0, 1.0 / 10.0),
        (
            shapes::dodecahedron(),
            3.0 * root(25.0 + 10.0 * root(5.0)),
            (15.0 + 7.0 * root(5.0)) / 4.0,
            -1.0 / root(5.0),
            (39.0 * phi + 28.0) / 150.0,
        ),
        (
            shapes::icosahedron(),
            5.0 * root(3.0),
            5.0 * (3.0 + root(5.0)) / 12.0,
            -root(5.0) / 3.0,
            phi * phi / 10.0,
        ),
    ];
    for (mesh, expected_area, expected_volume, cosine, moment) in solids {
        let side = mesh.edge_length(mesh.edges().next().unwrap());
        assert!(edge_lengths(&mesh).values().iter().all(|&l| is_close(l, side, 1e-14)));
        assert!(is_close(area(&mesh), expected_area * side.powi(2), 1e-14));
        assert!(is_close(volume(&mesh), expected_volume * side.powi(3), 1e-14));
        for e in mesh.edges() {
            assert!((PI - mesh.dihedral_angle(e).unwrap() - cosine.acos()).abs() < 1e-14);
        }
        let found = mass_properties(&mesh).unwrap();
        assert!(found.centroid.length() < 1e-15);
        let expected = moment * found.volume * side.powi(2);
        assert!(found.inertia.abs_diff_eq(DMat3::from_diagonal(DVec3::splat(expected)), 1e-14));
        let report = face_list_report(mesh.vertex_count(), &mesh.to_faces());
        assert!(report.watertight && report.genus == Some(0) && report.regular.is_some());
    }
}

#[test]
fn a_box_has_its_moments_axes_and_oriented_box() {
    let size = DVec3::new(5.0, 3.0, 2.0);
    let turn = rotation(DVec3::new(0.3, -0.8, 1.1));
    let offset = DVec3::new(10.0, -20.0, 30.0);
    for mesh in [shapes::cuboid(size, [3, 2, 1]), shapes::quad_cuboid(size, [1, 2, 3])] {
        let mesh = moved(&mesh.unwrap(), |p| turn * p + offset);
        let found = mass_properties(&mesh).unwrap();
        let squares = size * size;
        let mass = 30.0;
        let moments = DVec3::new(
            mass * (squares.y + squares.z) / 12.0,
            mass * (squares.x + squares.z) / 12.0,
            mass * (squares.x + squares.y) / 12.0,
        );
        assert!(is_close(found.volume, mass, 1e-13));
        assert!(found.principal_moments.abs_diff_eq(moments, 1e-11), "{found:?}");
        for k in 0..3 {
            assert!(found.principal_axes.col(k).dot(turn.col(k)).abs() > 1.0 - 1e-13);
        }
        let back = found.principal_axes
            * DMat3::from_diagonal(found.principal_moments)
            * found.principal_axes.transpose();
        assert!(back.abs_diff_eq(found.inertia, 1e-11));
        for center in [found.centroid, surface_centroid(&mesh).unwrap()] {
            assert!((center - vertex_box_center(&mesh)).length() < 1e-13);
        }
        let tight = oriented_box(&mesh).unwrap();
        assert!(tight.size.abs_diff_eq(size, 1e-12), "{tight:?}");
        assert!((tight.center - found.centroid).length() < 1e-12);
    }
}

fn vertex_box_center(mesh: &Mesh) -> DVec3 {
    // The corners of a box are symmetric about its middle.
    let far = |a: DVec3, b: DVec3| if a.distance(b) > 6.0 { Some(0.5 * (a + b)) } else { None };
    let p = mesh.positions().values();
    p.iter().flat_map(|&a| p.iter().map(move |&b| (a, b))).find_map(|(a, b)| far(a, b)).unwrap()
}

#[test]
fn a_turned_cube_is_found_though_it_has_no_principal_axes() {
    let turn = rotation(DVec3::new(0.5, 0.4, 0.3));
    let tight = oriented_box(&moved(&shapes::cube(), |p| turn * p)).unwrap();
    let side = 2.0 / 3_f64.sqrt();
    assert!(tight.size.abs_diff_eq(DVec3::splat(side), 1e-12), "{tight:?}");
}

#[test]
fn a_concave_polygon_has_the_area_and_center_of_its_inside() {
    // An L of three unit squares: its plain fan of triangles would overlap itself.
    let outline = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
    let positions: Vec<DVec3> = outline.iter().map(|&(x, y)| DVec3::new(x, y, 5.0)).collect();
    let faces = dgp_mesh::FaceList::from_indices(&[[0, 1, 2, 3, 4, 5]]);
    let set = dgp_mesh::IndexedFaceSet::new(positions, faces).unwrap();
    assert!(is_close(area(&set), 3.0, 1e-15));
    let center = surface_centroid(&set).unwrap();
    assert!(center.abs_diff_eq(DVec3::new(5.0 / 6.0, 5.0 / 6.0, 5.0), 1e-15), "{center}");
    assert_eq!(vertex_centroid(&set), Some(DVec3::new(1.0, 1.0, 5.0)));
    let mesh = Mesh::new(&set).unwrap();
    assert_eq!(mesh.face_normal(dgp_mesh::FaceId::new(0)), DVec3::Z);
}

#[test]
fn normals_by_max_are_exact_on_spheres() {
    for mesh in [shapes::icosphere(3).unwrap(), shapes::uv_sphere(14, 9).unwrap()] {
        let offset = DVec3::new(0.4, -7.0, 2.0);
        let mesh = moved(&mesh, |p| 3.0 * p + offset);
        let normals = vertex_normals(&mesh, NormalWeight::Max);
        for v in mesh.vertices() {
            let exact = (mesh.position(v) - offset) / 3.0;
            assert!((normals[v] - exact).length() < 1e-13, "{v}");
        }
    }
}

#[test]
fn mixed_voronoi_areas_are_those_of_the_nearest_points() {
    // Right triangles: each vertex inside owns the unit cell around it.
    let mesh = shapes::grid(4, 4).unwrap();
    let cell = area(&mesh) / 16.0;
    let areas = vertex_areas(&mesh, VertexArea::MixedVoronoi);
    for v in mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)) {
        assert!(is_close(areas[v], cell, 1e-14), "{v}");
    }
    // An obtuse triangle: half of it at the obtuse corner, a quarter at the others.
    let positions = vec![DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(1.0, 1.0, 0.0)];
    let faces = dgp_mesh::FaceList::from_indices(&[[0, 1, 2]]);
    let mesh = Mesh::new(&dgp_mesh::IndexedFaceSet::new(positions, faces).unwrap()).unwrap();
    let areas = vertex_areas(&mesh, VertexArea::MixedVoronoi);
    assert_eq!(areas.values(), [0.5, 0.5, 1.0]);
}

#[test]
fn bending_is_positive_on_ridges_and_negative_in_valleys() {
    for (height, sign) in [(1.0, -1.0), (-1.0, 1.0), (0.0, 0.0)] {
        // Two triangles on the edge from 0 to 1, facing up; their other corners at `height`.
        let positions = [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.5, height), (1.0, 0.5, height)];
        let positions: Vec<DVec3> = positions.into_iter().map(DVec3::from).collect();
        let faces = dgp_mesh::FaceList::from_indices(&[[0, 1, 2], [1, 0, 3]]);
        let mesh = Mesh::new(&dgp_mesh::IndexedFaceSet::new(positions, faces).unwrap()).unwrap();
        let bends: Vec<f64> = mesh.edges().filter_map(|e| mesh.dihedral_angle(e)).collect();
        assert_eq!(bends.len(), 1, "the rim has no angle");
        assert!((bends[0] - sign * PI / 2.0).abs() < 1e-15, "{height}: {bends:?}");
    }
}

#[test]
fn faces_without_area_give_zeros_and_no_nan() {
    // A triangle of three points on a line, one of two equal points, and one of a single point.
    let x = DVec3::X;
    let positions = vec![0.0 * x, x, 2.0 * x, x, x, x, 5.0 * x];
    let faces = dgp_mesh::FaceList::from_indices(&[[0, 1, 2], [1, 3, 6], [3, 4, 5]]);
    let set = dgp_mesh::IndexedFaceSet::new(positions, faces);
    // Faces 0 and 1 share a vertex only, so take them apart.
    let mut found = 0;
    for (_, face) in set.unwrap().faces().iter() {
        let corners: Vec<DVec3> =
            face.iter().map(|v| [0.0, 1.0, 2.0, 1.0, 1.0, 1.0, 5.0][v.index()] * x).collect();
        let faces = dgp_mesh::FaceList::from_indices(&[[0, 1, 2]]);
        let mesh = Mesh::new(&dgp_mesh::IndexedFaceSet::new(corners, faces).unwrap()).unwrap();
        let f = dgp_mesh::FaceId::new(0);
        assert_eq!((mesh.face_normal(f), mesh.face_area(f)), (DVec3::ZERO, 0.0));
        for h in mesh.face_halfedges(f) {
            assert_eq!(mesh.cotangent(h), 0.0);
            assert!(mesh.corner_angle(h).is_finite());
        }
        for weight in [NormalWeight::Area, NormalWeight::Angle, NormalWeight::Max] {
            assert!(vertex_normals(&mesh, weight).values().iter().all(|&n| n == DVec3::ZERO));
        }
        for kind in [VertexArea::Barycentric, VertexArea::MixedVoronoi] {
            assert!(vertex_areas(&mesh, kind).values().iter().all(|&a| a == 0.0));
        }
        assert!(mass_properties(&mesh).is_none() && surface_centroid(&mesh).is_none());
        assert!(oriented_box(&mesh).unwrap().size.is_finite());
        found += 1;
    }
    assert_eq!(found, 3);
}
