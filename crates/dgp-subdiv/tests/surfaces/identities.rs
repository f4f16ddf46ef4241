//! What holds for every scheme on every cage, and analytic values.

use dgp_mesh::{
    Connectivity, DMat3, DVec3, EdgeId, FaceList, IndexedFaceSet, Mesh, Progress, VertexId, shapes,
    topology::euler_characteristic,
};
use dgp_subdiv::{
    BoundaryRule, ButterflyRule, LoopWeights, RefinementOptions, RefinementPlan, SHARP, Scheme,
    Sharpness, StencilTable,
};

const SCHEMES: [Scheme; 9] = [
    Scheme::Loop(LoopWeights::Original),
    Scheme::Loop(LoopWeights::Warren),
    Scheme::Loop(LoopWeights::Simple),
    Scheme::CatmullClark,
    Scheme::Bilinear,
    Scheme::Butterfly(ButterflyRule::Original),
    Scheme::Butterfly(ButterflyRule::Modified),
    Scheme::Sqrt3,
    Scheme::DooSabin,
];

fn triangles() -> Vec<Mesh> {
    vec![
        shapes::tetrahedron(),
        shapes::octahedron(),
        shapes::icosahedron(),
        shapes::grid(3, 2).unwrap(),
        shapes::annulus(0.4, 1.0, 7, 2).unwrap(),
        shapes::torus(2.0, 1.0, 6, 5).unwrap(),
    ]
}

fn polygons() -> Vec<Mesh> {
    vec![
        shapes::cube(),
        shapes::dodecahedron(),
        shapes::truncated_icosahedron(),
        shapes::quad_grid(3, 2).unwrap(),
        shapes::capped_cylinder(1.0, 2.0, 5, 2).unwrap(),
    ]
}

fn cages(scheme: Scheme) -> Vec<Mesh> {
    let mut cages = triangles();
    if !scheme.needs_triangles() {
        cages.extend(polygons());
    }
    cages
}

fn plan_of(mesh: &Mesh, scheme: Scheme, levels: usize, sharpness: &Sharpness) -> RefinementPlan {
    let options = RefinementOptions { scheme, levels, ..RefinementOptions::default() };
    RefinementPlan::new(mesh, sharpness, &options, Progress::NONE).unwrap()
}

/// Sharp enough here and there to reach every rule; nothing for schemes without.
fn some_sharpness(mesh: &Mesh, scheme: Scheme) -> Sharpness {
    let mut sharpness = Sharpness::new();
    if scheme.has_creases() {
        let values = [0.0, 0.3, 1.0, 1.7, SHARP, 0.0, 2.5];
        for e in mesh.edges() {
            sharpness.set_edge(e, values[e.index() % values.len()]);
        }
        sharpness.set_vertex(VertexId::new(1), 0.6);
    }
    sharpness
}

fn sums(table: &StencilTable) -> impl Iterator<Item = f64> + '_ {
    (0..table.rows()).map(|row| table.row(row).1.iter().sum())
}

#[test]
fn every_stencil_sums_to_one() {
    for scheme in SCHEMES {
        for mesh in cages(scheme) {
            for sharpness in [Sharpness::new(), some_sharpness(&mesh, scheme)] {
                let plan = plan_of(&mesh, scheme, 3, &sharpness);
                for step in 0..3 {
                    let table = plan.step_stencils(step).unwrap();
                    assert!(sums(&table).all(|sum| (sum - 1.0).abs() < 1e-14), "{scheme:?}");
                    let convex = (0..table.rows()).all(|i| table.row(i).1.iter().all(|w| *w > 0.0));
                    assert!(convex || matches!(scheme, Scheme::Butterfly(_)), "{scheme:?}");
                }
                assert!(sums(&plan.stencils().unwrap()).all(|sum| (sum - 1.0).abs() < 1e-13));
            }
        }
    }
}

#[test]
fn stencils_and_direct_refinement_agree() {
    for scheme in SCHEMES {
        for mesh in cages(scheme) {
            let plan = plan_of(&mesh, scheme, 3, &some_sharpness(&mesh, scheme));
            let positions = mesh.positions().values();
            let direct = plan.refine(positions).unwrap();
            let by_table = plan.stencils().unwrap().apply(positions).unwrap();
            for (p, q) in direct.iter().zip(&by_table) {
                assert!(p.distance(*q) < 1e-13, "{scheme:?} {p} {q}");
            }
        }
    }
}

#[test]
fn refinement_and_affine_maps_commute() {
    let matrix = DMat3::from_cols_array(&[1.0, 0.3, -0.2, 0.5, -2.0, 0.1, 0.0, 0.7, 0.4]);
    let map = |p: &DVec3| matrix * *p + DVec3::new(3.0, -1.0, 0.5);
    for scheme in SCHEMES {
        for mesh in cages(scheme) {
            let plan = plan_of(&mesh, scheme, 3, &some_sharpness(&mesh, scheme));
            let positions = mesh.positions().values();
            let moved: Vec<DVec3> = positions.iter().map(map).collect();
            let (before, after) = (plan.refine(&moved).unwrap(), plan.refine(positions).unwrap());
            for (p, q) in before.iter().zip(&after) {
                assert!(p.distance(map(q)) < 1e-13, "{scheme:?}");
            }
        }
    }
}

#[test]
fn scaling_by_a_power_of_two_scales_every_bit() {
    for scheme in SCHEMES {
        let mesh = shapes::icosahedron();
        let plan = plan_of(&mesh, scheme, 2, &some_sharpness(&mesh, scheme));
        let scale = 2_f64.powi(-70);
        let small: Vec<DVec3> = mesh.positions().values().iter().map(|&p| p * scale).collect();
        let scaled: Vec<DVec3> =
            plan.refine(mesh.positions().values()).unwrap().iter().map(|&p| p * scale).collect();
        assert_eq!(plan.refine(&small).unwrap(), scaled);
    }
}

#[test]
fn counts_follow_from_those_before_and_the_genus_stays() {
    for scheme in SCHEMES {
        for mesh in cages(scheme) {
            let plan = plan_of(&mesh, scheme, 3, &Sharpness::new());
            let is_closed = mesh.vertices().all(|v| !mesh.is_boundary_vertex(v));
            for level in 1..=3 {
                let (before, after) = (plan.counts(level - 1), plan.counts(level));
                let euler =
                    |c: dgp_subdiv::Counts| c.vertices as i64 - c.edges as i64 + c.faces as i64;
                // Doo–Sabin has no rule for rims, where faces may come apart.
                if is_closed || scheme != Scheme::DooSabin {
                    assert_eq!(euler(after), euler(before), "{scheme:?}");
                }
                match scheme {
                    Scheme::Loop(_) | Scheme::Butterfly(_) => {
                        assert_eq!(after.faces, 4 * before.faces);
                        assert_eq!(after.edges, 2 * before.edges + 3 * before.faces);
                    }
                    Scheme::CatmullClark | Scheme::Bilinear => {
                        assert_eq!(after.faces, before.corners);
                        assert_eq!(after.edges, 2 * before.edges + before.corners);
                    }
                    Scheme::Sqrt3 => assert_eq!(after.faces, 3 * before.faces),
                    Scheme::DooSabin => assert_eq!(after.vertices, before.corners),
                }
            }
            let refined = plan.connectivity();
            assert_eq!(refined.vertex_count() as u64, plan.counts(3).vertices);
            assert_eq!(refined.edge_count() as u64, plan.counts(3).edges);
            if is_closed {
                assert_eq!(euler_characteristic(&refined), euler_characteristic(&mesh));
            }
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let mesh = shapes::icosphere(3).unwrap();
    for scheme in SCHEMES {
        let sharpness = some_sharpness(&mesh, scheme);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let plan = plan_of(&mesh, scheme, 2, &sharpness);
                let positions = plan.refine(mesh.positions().values()).unwrap();
                (positions, plan.step_stencils(1).unwrap(), plan.faces(2))
            })
        };
        let one = run(1);
        assert!(one == run(2) && one == run(8), "{scheme:?}");
    }
}

#[test]
fn limits_have_their_analytic_values() {
    let loop_scheme = Scheme::Loop(LoopWeights::Original);
    let cases = [
        (shapes::tetrahedron(), loop_scheme, 1.0 / 5.0),
        (shapes::octahedron(), loop_scheme, 24.0 / 55.0),
        (shapes::icosahedron(), loop_scheme, 0.707_809_116_9),
        (shapes::cube(), Scheme::CatmullClark, 1.0 / 2.0),
    ];
    for (mesh, scheme, factor) in cases {
        for levels in 0..3 {
            let plan = plan_of(&mesh, scheme, levels, &Sharpness::new());
            let refined = plan.refine(mesh.positions().values()).unwrap();
            let limit = plan.limit(&refined).unwrap();
            for v in mesh.vertices() {
                let (p, q) = (mesh.position(v) * factor, limit[v.index()]);
                assert!(p.distance(q) < 1e-10 * p.length(), "{scheme:?} {levels} {p} {q}");
            }
        }
    }
}

/// Volume and area of the octahedron after eight levels, |x| + |y| + |z| ≤ 1.
#[test]
fn a_refined_octahedron_has_the_known_volume() {
    let mesh = shapes::octahedron();
    let radius = mesh.position(VertexId::new(0)).length();
    let plan = plan_of(&mesh, Scheme::Loop(LoopWeights::Original), 8, &Sharpness::new());
    let refined = plan.refine(mesh.positions().values()).unwrap();
    let (mut volume, mut area) = (0.0, 0.0);
    for (_, face) in plan.faces(8).iter() {
        let [a, b, c] = [0, 1, 2].map(|k| refined[face[k].index()] / radius);
        volume += a.dot(b.cross(c)) / 6.0;
        area += (b - a).cross(c - a).length() / 2.0;
    }
    // To the digits known.
    assert!((volume - 0.30386).abs() < 5e-6, "{volume}");
    assert!((area - 2.19119).abs() < 5e-6, "{area}");
}

fn limit_kinds() -> [Scheme; 2] {
    [Scheme::Loop(LoopWeights::Original), Scheme::CatmullClark]
}

/// How fast refinement gets there is in `fans.rs`.
#[test]
fn from_each_level_on_the_limit_is_the_same() {
    for scheme in limit_kinds() {
        for mesh in cages(scheme) {
            for sharpness in [Sharpness::new(), some_sharpness(&mesh, scheme)] {
                let cage = plan_of(&mesh, scheme, 0, &sharpness);
                let limit = cage.limit(mesh.positions().values()).unwrap();
                for levels in [1, 2, 5] {
                    let plan = plan_of(&mesh, scheme, levels, &sharpness);
                    let refined = plan.refine(mesh.positions().values()).unwrap();
                    for (p, q) in limit.iter().zip(&plan.limit(&refined).unwrap()) {
                        assert!(p.distance(*q) < 1e-12, "{scheme:?} {levels} {p} {q}");
                    }
                }
            }
        }
    }
}

#[test]
fn tangents_are_those_of_ever_smaller_triangles() {
    for scheme in limit_kinds() {
        for mesh in cages(scheme) {
            let is_flat =
                mesh.positions().values().iter().all(|p| p.z == mesh.position(VertexId::new(0)).z);
            let cage = plan_of(&mesh, scheme, 0, &Sharpness::new());
            let [u, v] = cage.limit_tangents(mesh.positions().values()).unwrap();
            let plan = plan_of(&mesh, scheme, 6, &Sharpness::new());
            let refined = plan.refine(mesh.positions().values()).unwrap();
            let connectivity: Connectivity = plan.connectivity();
            for w in mesh.vertices().filter(|&w| !mesh.is_boundary_vertex(w) || is_flat) {
                let normal = u[w.index()].cross(v[w.index()]);
                // A corner of one face at a rim has no second tangent where the rim runs straight on.
                let Some(normal) = normal.try_normalize() else {
                    continue;
                };
                let around: Vec<DVec3> = connectivity
                    .vertex_neighbors(w)
                    .map(|x| refined[x.index()] - refined[w.index()])
                    .collect();
                let mut sum = DVec3::ZERO;
                for (a, b) in around.iter().zip(around.iter().skip(1)) {
                    sum += a.cross(*b);
                }
                let numeric = sum.normalize();
                assert!(normal.dot(numeric) > 0.999, "{scheme:?} {w} {normal} {numeric}");
                for tangent in [u[w.index()], v[w.index()]] {
                    assert!(normal.dot(tangent).abs() <= 1e-14 * tangent.length());
                }
            }
        }
    }
}

#[test]
fn butterfly_keeps_its_vertices() {
    for rule in [ButterflyRule::Original, ButterflyRule::Modified] {
        for mesh in triangles() {
            let plan = plan_of(&mesh, Scheme::Butterfly(rule), 3, &Sharpness::new());
            let refined = plan.refine(mesh.positions().values()).unwrap();
            assert_eq!(&refined[..mesh.vertex_count()], mesh.positions().values());
            assert_eq!(plan.limit(&refined).unwrap(), refined);
        }
    }
}

#[test]
fn butterfly_reproduces_cubics_on_a_regular_grid() {
    // The eight-point mask has degree three; a patch far enough from the rim.
    let mesh = shapes::grid(8, 8).unwrap();
    let height = |p: DVec3| p.x.powi(3) - 2.0 * p.x * p.y + 0.3 * p.y.powi(3) + p.y;
    let values: Vec<f64> = mesh.positions().values().iter().map(|&p| height(p)).collect();
    let plan = plan_of(&mesh, Scheme::Butterfly(ButterflyRule::Modified), 1, &Sharpness::new());
    let refined = plan.refine(&values).unwrap();
    let places = plan.refine(mesh.positions().values()).unwrap();
    let (low, high) = (places[0].x, places[mesh.vertex_count() - 1].x);
    let inside = |x: f64| x > low + 0.3 * (high - low) && x < low + 0.7 * (high - low);
    let mut count = 0;
    for (value, place) in refined.iter().zip(&places).filter(|(_, p)| inside(p.x) && inside(p.y)) {
        assert!((value - height(*place)).abs() < 1e-13, "{place}");
        count += 1;
    }
    assert!(count > 10, "{count}");
}

#[test]
fn two_steps_of_sqrt3_cut_edges_in_three() {
    // A regular patch: the rim of the square stays straight and gets two points per edge.
    let mesh = shapes::grid(3, 3).unwrap();
    let plan = plan_of(&mesh, Scheme::Sqrt3, 2, &Sharpness::new());
    let rim = |c: &Connectivity| c.edges().filter(|&e| c.is_boundary_edge(e)).count();
    let refined = plan.connectivity();
    assert_eq!(rim(&refined), 3 * rim(&mesh));
    assert_eq!(refined.face_count(), 9 * mesh.face_count());
    let one = plan_of(&mesh, Scheme::Sqrt3, 1, &Sharpness::new()).connectivity();
    assert_eq!(rim(&one), rim(&mesh));
}

#[test]
fn doo_sabin_shrinks_a_cube_by_its_masks() {
    let mesh = shapes::cube();
    let plan = plan_of(&mesh, Scheme::DooSabin, 1, &Sharpness::new());
    assert_eq!((plan.counts(1).vertices, plan.counts(1).faces), (24, 26));
    let refined = plan.refine(mesh.positions().values()).unwrap();
    // 9/16, 3/16, 3/16, 1/16 in a quadrilateral: half way to the middle of the face, which is at 1.
    let half = mesh.position(VertexId::new(0)).x.abs();
    for p in refined {
        let mut sorted = p.abs().to_array();
        sorted.sort_by(f64::total_cmp);
        for (x, expected) in sorted.iter().zip([0.5 * half, 0.5 * half, half]) {
            assert!((x - expected).abs() < 1e-15, "{sorted:?}");
        }
    }
}

#[test]
fn sharp_cubes_stay_cubes() {
    let mesh = shapes::cube();
    let mut sharpness = Sharpness::new();
    mesh.edges().for_each(|e: EdgeId| sharpness.set_edge(e, SHARP));
    let plan = plan_of(&mesh, Scheme::CatmullClark, 3, &sharpness);
    let refined = plan.refine(mesh.positions().values()).unwrap();
    let half = mesh.position(VertexId::new(0)).x.abs();
    assert!(refined.iter().all(|p| (p.abs().max_element() - half).abs() < 1e-15));
    assert_eq!(&plan.limit(&refined).unwrap()[..8], mesh.positions().values());
}

#[test]
fn rims_follow_cubic_splines_and_corners_stay_where_asked() {
    let mesh = shapes::quad_grid(2, 2).unwrap();
    let corner = mesh.vertices().find(|&v| mesh.valence(v) == 2).unwrap();
    let at = |boundary| {
        let options = RefinementOptions { levels: 4, boundary, ..RefinementOptions::default() };
        let plan = RefinementPlan::new(&mesh, &Sharpness::new(), &options, Progress::NONE).unwrap();
        plan.refine(mesh.positions().values()).unwrap()[corner.index()]
    };
    let p = mesh.position(corner);
    assert_eq!(at(BoundaryRule::EdgeAndCorner), p);
    let neighbors: Vec<DVec3> = mesh.vertex_neighbors(corner).map(|v| mesh.position(v)).collect();
    let spline = 2.0 / 3.0 * p + (neighbors[0] + neighbors[1]) / 6.0;
    // Each level leaves a quarter of the way to the limit.
    let left = at(BoundaryRule::EdgeOnly).distance(spline) / p.distance(spline);
    assert!((left - 1.0 / 256.0).abs() < 1e-14, "{left}");
}

/// The limit of each vertex of the next two levels is at a known place of the faces of the cage.
#[test]
fn evaluation_meets_the_limits_of_refined_vertices() {
    for scheme in limit_kinds() {
        for mesh in cages(scheme) {
            for sharpness in [Sharpness::new(), some_sharpness(&mesh, scheme)] {
                let coarse = plan_of(&mesh, scheme, 1, &sharpness);
                let fine = plan_of(&mesh, scheme, 3, &sharpness);
                let values = coarse.refine(mesh.positions().values()).unwrap();
                let limits = fine.limit(&fine.refine(mesh.positions().values()).unwrap()).unwrap();
                let (faces, parts) = (coarse.faces(1), fine.faces(3));
                for (f, _) in faces.iter().take(40) {
                    let evaluate = |u: f64, v: f64| coarse.evaluate(&values, f, [u, v]).unwrap();
                    // Corner by corner, as faces split twice; then the place of their first corners.
                    let (degree, first) = (faces.degree(f), f.index());
                    for child in 0..4 {
                        for part in 0..4 {
                            let number = 4 * (4 * first + child) + part;
                            let vertex = parts.face(dgp_mesh::FaceId::new(number))[0];
                            let corner = place(degree, child, place(degree, part, [0.0, 0.0]));
                            let found = evaluate(corner[0], corner[1]).value;
                            let distance = found.distance(limits[vertex.index()]);
                            assert!(distance < 1e-13, "{scheme:?} {f} {corner:?} {distance}");
                        }
                    }
                }
            }
        }
    }
}

/// Where the point `[u, v]` of a child of a face lies in the face.
fn place(degree: usize, child: usize, [u, v]: [f64; 2]) -> [f64; 2] {
    let corners: &[[f64; 2]] = if degree == 4 {
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    } else {
        &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    };
    let middle = |a: [f64; 2], b: [f64; 2]| [f64::midpoint(a[0], b[0]), f64::midpoint(a[1], b[1])];
    let at = |k: usize| corners[k % degree];
    let [p, q, r] = if degree == 3 && child == 3 {
        [middle(at(0), at(1)), middle(at(1), at(2)), middle(at(2), at(0))]
    } else {
        [at(child), middle(at(child), at(child + 1)), middle(at(child), at(child + degree - 1))]
    };
    [0, 1].map(|x| p[x] + u * (q[x] - p[x]) + v * (r[x] - p[x]))
}

#[test]
fn derivatives_are_those_of_positions() {
    for scheme in limit_kinds() {
        for mesh in cages(scheme) {
            let plan = plan_of(&mesh, scheme, 1, &Sharpness::new());
            let values = plan.refine(mesh.positions().values()).unwrap();
            for f in (0..plan.counts(1).faces as usize).step_by(5).map(dgp_mesh::FaceId::new) {
                let at = |u: f64, v: f64| plan.evaluate(&values, f, [u, v]).unwrap();
                let (u, v, step) = (0.3, 0.4, 1e-5);
                let point = at(u, v);
                let numeric = [
                    (at(u + step, v).value - at(u - step, v).value) / (2.0 * step),
                    (at(u, v + step).value - at(u, v - step).value) / (2.0 * step),
                ];
                for (exact, numeric) in point.derivatives.iter().zip(numeric) {
                    assert!(exact.distance(numeric) < 1e-8, "{scheme:?} {f} {exact} {numeric}");
                }
            }
        }
    }
}

#[test]
fn points_beside_a_face_and_faces_of_many_corners_are_refused() {
    let mesh = shapes::dodecahedron();
    let plan = plan_of(&mesh, Scheme::CatmullClark, 0, &Sharpness::new());
    let (values, face) = (mesh.positions().values(), dgp_mesh::FaceId::new(3));
    let error = plan.evaluate(values, face, [0.5, 0.5]).unwrap_err();
    assert_eq!(error, dgp_subdiv::Error::NotQuad { face, degree: 5 });
    let mesh = shapes::icosahedron();
    let plan = plan_of(&mesh, Scheme::Loop(LoopWeights::Original), 0, &Sharpness::new());
    let error = plan.evaluate(mesh.positions().values(), face, [0.6, 0.5]).unwrap_err();
    assert!(matches!(error, dgp_subdiv::Error::InvalidOption { name: "v", .. }), "{error}");
}

#[test]
fn odd_cages_are_refused_or_refined_to_valid_meshes() {
    let mesh = |positions: &[[f64; 3]], faces: &[&[usize]]| {
        let positions: Vec<DVec3> = positions.iter().map(|&p| p.into()).collect();
        Mesh::new(&IndexedFaceSet::new(positions, FaceList::from_indices(faces)).unwrap()).unwrap()
    };
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.2], [1.0, 1.0, 0.0], [0.0, 1.0, 0.3]];
    let cages = [
        Mesh::default(),
        mesh(&square, &[]),
        mesh(&square[..3], &[&[0, 1, 2]]),
        mesh(&square[..3], &[&[0, 1, 2], &[2, 1, 0]]),
        mesh(&square, &[&[0, 1, 2, 3]]),
        mesh(&square, &[&[0, 1, 2, 3], &[3, 2, 1, 0]]),
        mesh(&square, &[&[0, 1, 2], &[2, 3, 0]]),
        shapes::grid(1, 1).unwrap(),
        shapes::cone(1.0, 1.0, 3, 1).unwrap(),
    ];
    let mut refined_meshes = 0;
    for (scheme, cage) in SCHEMES.iter().flat_map(|&s| cages.iter().map(move |c| (s, c))) {
        for sharpness in [Sharpness::new(), some_sharpness(cage, scheme)] {
            let options = RefinementOptions { scheme, levels: 4, ..RefinementOptions::default() };
            let sharpness = if sharpness.vertex(VertexId::new(1)) > 0.0 && cage.vertex_count() < 2 {
                Sharpness::new()
            } else {
                sharpness
            };
            let Ok(plan) = RefinementPlan::new(cage, &sharpness, &options, Progress::NONE) else {
                continue;
            };
            refined_meshes += 1;
            let refined = plan.refine(cage.positions().values()).unwrap();
            let fine = Mesh::from_parts(plan.connectivity(), refined.clone().into());
            fine.validate().unwrap();
            let mut all = refined.clone();
            for level in [0, 4] {
                let options = RefinementOptions { levels: level, ..options };
                let plan = RefinementPlan::new(cage, &sharpness, &options, Progress::NONE).unwrap();
                let values = plan.refine(cage.positions().values()).unwrap();
                if let Ok(limit) = plan.limit(&values) {
                    all.extend(limit);
                }
                if let Ok([u, v]) = plan.limit_tangents(&values) {
                    all.extend(u.into_iter().chain(v));
                }
            }
            assert!(all.iter().all(|p| p.is_finite()), "{scheme:?}");
        }
    }
    assert!(refined_meshes > 60, "{refined_meshes}");
}
