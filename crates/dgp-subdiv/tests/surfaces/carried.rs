//! Data that travel through adaptive refinement, Phong tessellation and √3.

use dgp_mesh::{
    DVec2, DVec3, EdgeId, Mesh, NORMAL, Normal, Progress, UV, VertexId,
    measure::{NormalWeight, vertex_normals},
    shapes,
};
use dgp_subdiv::{
    AdaptiveOptions, FaceVarying, LoopWeights, PhongOptions, RefinementOptions, SHARP, SHARPNESS,
    Scheme, Sharpness, SubdivisionOptions, phong_tessellate, refine_adaptively,
    refine_to_tolerance, subdivide,
};

use crate::data::decorated;

const LOOP: Scheme = Scheme::Loop(LoopWeights::Original);

const RULES: [FaceVarying; 6] = [
    FaceVarying::Linear,
    FaceVarying::Smooth,
    FaceVarying::SmoothCorners,
    FaceVarying::SharpJunctions,
    FaceVarying::SharpEnds,
    FaceVarying::SharpRims,
];

fn options(scheme: Scheme, levels: usize, face_varying: FaceVarying) -> AdaptiveOptions {
    let refinement = RefinementOptions { scheme, levels, ..RefinementOptions::default() };
    AdaptiveOptions { refinement, face_varying }
}

/// The area of each chart, and whether each corner is in that of its part.
fn chart_areas(cage: &Mesh, refined: &Mesh) -> Vec<f64> {
    let data = refined.attributes();
    let (part, uv) = (data.face.get::<u32>("part").unwrap(), data.corner.get::<DVec2>(UV).unwrap());
    let mut areas = vec![0.0; cage.face_count()];
    for f in refined.faces() {
        let corners: Vec<DVec2> = refined.face_halfedges(f).map(|h| uv[h]).collect();
        let low = 10.0 * f64::from(part[f]);
        let inside = |p: &DVec2| (low - 1e-12..=low + 1.0 + 1e-12).contains(&p.x);
        assert!(corners.iter().all(inside), "{f} of part {}: {corners:?}", part[f]);
        for (k, p) in corners.iter().enumerate() {
            areas[part[f] as usize] += p.perp_dot(corners[(k + 1) % corners.len()]) / 2.0;
        }
    }
    areas
}

/// The pieces of each edge of the cage lead from one of its ends to the other.
fn check_edges(cage: &Mesh, refined: &Mesh) {
    let edge = refined.attributes().edge.get::<u32>("edge").unwrap();
    for e in cage.edges() {
        let pieces = refined.edges().filter(|&x| edge[x] == e.index() as u32 + 1);
        let mut ends: Vec<VertexId> = pieces.flat_map(|x| refined.edge_vertices(x)).collect();
        ends.sort_unstable();
        let once = |v: &VertexId| ends.iter().filter(|w| *w == v).count() == 1;
        assert_eq!(ends.iter().filter(|v| once(v)).count(), 2, "{e}: {ends:?}");
        assert!(ends.len() >= 2, "{e}");
    }
}

#[test]
fn data_travel_to_the_limit_with_the_faces_that_are_split() {
    for (mesh, scheme, whole) in
        [(shapes::cube(), Scheme::CatmullClark, 1.0), (shapes::octahedron(), LOOP, 0.5)]
    {
        let mesh = decorated(mesh);
        let target = mesh.position(VertexId::new(0)) * 0.7;
        for rule in RULES {
            let near = |level: usize, corners: &[DVec3]| {
                let size = 1.5 * 0.6_f64.powi(level as i32);
                corners.iter().any(|p| p.distance(target) < size)
            };
            let options = options(scheme, 4, rule);
            let smooth = Sharpness::new();
            let refined =
                refine_adaptively(&mesh, &smooth, &options, near, Progress::NONE).unwrap();
            let place = refined.attributes().vertex.get::<DVec3>("place").unwrap();
            for v in refined.vertices() {
                assert!(place[v].distance(refined.position(v)) < 1e-14, "{scheme:?} {v}");
            }
            // The charts are faces of their own; round corners are the only ones that shrink them.
            let areas = chart_areas(&mesh, &refined);
            let full = rule != FaceVarying::SmoothCorners;
            assert!(
                areas.iter().all(|a| if full { (a - whole).abs() < 1e-12 } else { *a < whole }),
                "{scheme:?} {rule:?} {areas:?}"
            );
            check_edges(&mesh, &refined);
            let regular = if scheme == LOOP { 3 } else { 4 };
            assert!(refined.faces().any(|f| refined.degree(f) > regular));
        }
    }
}

/// A torus of two charts, the surface creased where they meet, with its positions as texture.
fn two_charts(mesh: &Mesh) -> (Mesh, Sharpness) {
    let mut mesh = mesh.clone();
    let half = mesh.face_count() / 2;
    let chart: Vec<u32> = (0..mesh.face_count()).map(|f| u32::from(f >= half)).collect();
    let mut texture = vec![DVec3::ZERO; mesh.halfedge_count()];
    for f in mesh.faces() {
        for h in mesh.face_halfedges(f) {
            texture[h.index()] = mesh.position(mesh.from(h)) + offset(chart[f.index()]);
        }
    }
    let mut sharpness = Sharpness::new();
    let mut seams = vec![0; mesh.vertex_count()];
    for e in mesh.edges() {
        let charts = e.halfedges().map(|h| chart[mesh.face(h).unwrap().index()]);
        if charts[0] != charts[1] {
            sharpness.set_edge(e, SHARP);
            mesh.edge_vertices(e).into_iter().for_each(|v| seams[v.index()] += 1);
        }
    }
    assert!(seams.iter().all(|n| [0, 2].contains(n)) && seams.contains(&2), "{seams:?}");
    mesh.attributes_mut().corner.insert("texture", texture);
    mesh.attributes_mut().face.insert("chart", chart);
    (mesh, sharpness)
}

fn offset(chart: u32) -> DVec3 {
    DVec3::new(0.0, 100.0, -50.0) * f64::from(chart)
}

#[test]
fn faces_get_the_values_of_their_own_chart_at_vertices_that_the_other_has_made() {
    for (mesh, scheme) in [
        (shapes::quad_torus(2.0, 0.5, 8, 6).unwrap(), Scheme::CatmullClark),
        (shapes::torus(2.0, 1.0, 6, 6).unwrap(), LOOP),
    ] {
        let (mesh, sharpness) = two_charts(&mesh);
        // The first faces of the second chart have a seam.
        let seam = mesh
            .edges()
            .find(|&e| sharpness.edge(e) > 0.0)
            .map(|e| mesh.edge_vertices(e).map(|v| mesh.position(v)))
            .unwrap();
        let middle = seam[0].midpoint(seam[1]);
        // The surface is smooth along its creases, and so are the rims of charts under these rules.
        for rule in &RULES[1..5] {
            let (center, across) = (DVec3::new(middle.x, middle.y, 0.0), middle.cross(DVec3::Z));
            for side in [1.0, -1.0] {
                let wanted = |level: usize, corners: &[DVec3]| {
                    let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
                    let near = mean.distance(center) < 2.0 * 0.7_f64.powi(level as i32);
                    near && (mean - middle).dot(across) * side > 0.0
                };
                let options = options(scheme, 4, *rule);
                let refined =
                    refine_adaptively(&mesh, &sharpness, &options, wanted, Progress::NONE).unwrap();
                let data = refined.attributes();
                let texture = data.corner.get::<DVec3>("texture").unwrap();
                let chart = data.face.get::<u32>("chart").unwrap();
                let mut crowded = [0, 0];
                for f in refined.faces() {
                    for h in refined.face_halfedges(f) {
                        let p = refined.position(refined.from(h));
                        let found = texture[h] - offset(chart[f]);
                        assert!(found.distance(p) < 1e-12, "{scheme:?} {rule:?} {h} {found} {p}");
                    }
                    let regular = if scheme == LOOP { 3 } else { 4 };
                    crowded[chart[f] as usize] += usize::from(refined.degree(f) > regular);
                }
                assert!(crowded.iter().any(|&n| n > 0), "{scheme:?}: no face beside smaller ones");
                // Corners of one chart at a vertex have one value, bit for bit.
                for v in refined.vertices() {
                    let mut first = [None; 2];
                    for h in refined.vertex_halfedges(v) {
                        let chart = chart[refined.face(h).unwrap()] as usize;
                        assert_eq!(*first[chart].get_or_insert(texture[h]), texture[h], "{v}");
                    }
                }
            }
        }
    }
}

#[test]
fn sharpness_is_no_data_of_a_surface_at_its_limit() {
    let mut mesh = shapes::cube();
    let mut sharpness = Sharpness::new();
    sharpness.set_edge(EdgeId::new(2), 1.5);
    sharpness.to_attributes(&mut mesh);
    let options = options(Scheme::CatmullClark, 6, FaceVarying::Linear);
    let (refined, _) =
        refine_to_tolerance(&mesh, &sharpness, &options, 1e-2, Progress::NONE).unwrap();
    let data = refined.attributes();
    assert!(!data.edge.contains(SHARPNESS) && !data.vertex.contains(SHARPNESS));
}

#[test]
fn bent_triangles_keep_their_data() {
    for segments in [1, 2, 5] {
        let mut mesh = decorated(shapes::octahedron());
        let normals = vertex_normals(&mesh, NormalWeight::Angle);
        let given = normals.map(|&n| Normal(n));
        mesh.attributes_mut().vertex.insert(NORMAL, given);
        let options = PhongOptions { segments, alpha: 0.0, ..PhongOptions::default() };
        let bent = phong_tessellate(&mesh, &normals, &options, Progress::NONE).unwrap();
        let data = bent.attributes();
        // Without bending the place of a vertex is the mix of those of its corners.
        let place = data.vertex.get::<DVec3>("place").unwrap();
        let normal = data.vertex.get::<Normal>(NORMAL).unwrap();
        for v in bent.vertices() {
            assert!(place[v].distance(bent.position(v)) < 1e-15, "{v}");
            assert!((normal[v].0.length() - 1.0).abs() < 1e-15);
            assert!(normal[v].0.distance(bent.position(v).normalize()) < 1e-12);
        }
        let areas = chart_areas(&mesh, &bent);
        assert!(areas.iter().all(|a| (a - 0.5).abs() < 1e-14), "{areas:?}");
        check_edges(&mesh, &bent);
        let edge = data.edge.get::<u32>("edge").unwrap();
        let pieces = edge.values().iter().filter(|&&e| e > 0).count();
        assert_eq!(pieces, segments * mesh.edge_count());
    }
}

#[test]
fn two_steps_of_sqrt3_lie_in_the_old_triangles() {
    let closed =
        [shapes::octahedron(), shapes::icosahedron(), shapes::torus(2.0, 1.0, 5, 4).unwrap()];
    let open = [shapes::grid(3, 2).unwrap(), shapes::annulus(0.4, 1.0, 7, 2).unwrap()];
    for mesh in closed.into_iter().chain(open) {
        let mesh = decorated(mesh);
        for levels in [2, 4] {
            let refinement =
                RefinementOptions { scheme: Scheme::Sqrt3, levels, ..RefinementOptions::default() };
            let options = SubdivisionOptions { refinement, ..SubdivisionOptions::default() };
            let (refined, report) =
                subdivide(&mesh, &Sharpness::new(), &options, Progress::NONE).unwrap();
            assert_eq!(report.left_out, ["edge"]);
            let areas = chart_areas(&mesh, &refined);
            assert!(areas.iter().all(|a| (a - 0.5).abs() < 1e-12), "{levels} {areas:?}");
            // Each new triangle covers its share of the chart, and turns the same way.
            let uv = refined.attributes().corner.get::<DVec2>(UV).unwrap();
            let share = 0.5 / 3.0_f64.powi(levels as i32);
            for f in refined.faces() {
                let corners: Vec<DVec2> = refined.face_halfedges(f).map(|h| uv[h]).collect();
                let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]) / 2.0;
                assert!((area - share).abs() < 1e-14, "{levels} {f} {area}");
            }
        }
    }
}

#[test]
fn odd_steps_of_sqrt3_carry_what_has_no_seams() {
    let mut mesh = decorated(shapes::icosahedron());
    let place: Vec<DVec3> = mesh.halfedges().map(|h| mesh.position(mesh.from(h))).collect();
    mesh.attributes_mut().corner.insert("seamless", place);
    for levels in [1, 3] {
        let refinement =
            RefinementOptions { scheme: Scheme::Sqrt3, levels, ..RefinementOptions::default() };
        let options = SubdivisionOptions { refinement, ..SubdivisionOptions::default() };
        let (refined, report) =
            subdivide(&mesh, &Sharpness::new(), &options, Progress::NONE).unwrap();
        assert_eq!(report.left_out, [UV, "edge"]);
        let corner = &refined.attributes().corner;
        assert!(!corner.contains(UV));
        let seamless = corner.get::<DVec3>("seamless").unwrap();
        for v in refined.vertices() {
            let mut values = refined.vertex_halfedges(v).map(|h| seamless[h]);
            let first = values.next().unwrap();
            assert!(values.all(|value| value.distance(first) < 1e-15), "{v}");
            // Old vertices stay in a linear texture; new ones are in the middles of triangles.
            if v.index() < mesh.vertex_count() {
                assert!(first.distance(mesh.position(v)) < 1e-15);
            } else if levels == 1 {
                let face = mesh.faces().nth(v.index() - mesh.vertex_count()).unwrap();
                let middle =
                    mesh.face_vertices(face).map(|w| mesh.position(w)).sum::<DVec3>() / 3.0;
                assert!(first.distance(middle) < 1e-15);
            }
        }
    }
}
