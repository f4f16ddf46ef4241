//! Adaptive refinement: no cracks, the same surface as everywhere refined.

use dgp_mesh::{DVec3, Mesh, Progress, VertexId, shapes, topology::euler_characteristic};
use dgp_subdiv::{
    AdaptiveOptions, Counts, Error, LoopWeights, RefinementOptions, RefinementPlan, SHARP, Scheme,
    Sharpness, refine_adaptively, refine_to_tolerance,
};

const LOOP: Scheme = Scheme::Loop(LoopWeights::Original);

fn cages() -> Vec<(Mesh, Scheme)> {
    vec![
        (shapes::cube(), Scheme::CatmullClark),
        (shapes::dodecahedron(), Scheme::CatmullClark),
        (shapes::quad_grid(4, 3).unwrap(), Scheme::CatmullClark),
        (shapes::tetrahedron(), LOOP),
        (shapes::icosahedron(), LOOP),
        (shapes::torus(2.0, 1.0, 6, 5).unwrap(), LOOP),
        (shapes::grid(3, 3).unwrap(), LOOP),
    ]
}

fn creased(mesh: &Mesh) -> Sharpness {
    let mut sharpness = Sharpness::new();
    for e in mesh.edges().step_by(3) {
        sharpness.set_edge(e, if e.index() % 2 == 0 { 1.4 } else { SHARP });
    }
    sharpness
}

fn options(scheme: Scheme, levels: usize) -> AdaptiveOptions {
    let refinement = RefinementOptions { scheme, levels, ..RefinementOptions::default() };
    AdaptiveOptions { refinement, ..AdaptiveOptions::default() }
}

fn little(levels: usize) -> AdaptiveOptions {
    let AdaptiveOptions { refinement, .. } = options(Scheme::CatmullClark, levels);
    let refinement = RefinementOptions { memory_limit: 1 << 20, ..refinement };
    AdaptiveOptions { refinement, ..AdaptiveOptions::default() }
}

#[test]
fn split_everywhere_is_the_limit_of_the_refined_mesh() {
    for (mesh, scheme) in cages() {
        for sharpness in [Sharpness::new(), creased(&mesh)] {
            let options = options(scheme, 3);
            let all = refine_adaptively(&mesh, &sharpness, &options, |_, _| true, Progress::NONE)
                .unwrap();
            let plan = RefinementPlan::new(&mesh, &sharpness, &options.refinement, Progress::NONE)
                .unwrap();
            let limits = plan.limit(&plan.refine(mesh.positions().values()).unwrap()).unwrap();
            assert_eq!(all.face_count() as u64, plan.counts(3).faces);
            // Faces come in the same order, corner by corner.
            let (faces, expected) = (all.to_faces(), plan.faces(3));
            for ((f, face), (_, other)) in faces.iter().zip(expected.iter()) {
                for (v, w) in face.iter().zip(other) {
                    let distance = all.position(*v).distance(limits[w.index()]);
                    assert!(distance < 1e-13, "{scheme:?} {f} {distance}");
                }
            }
        }
    }
}

#[test]
fn levels_meet_without_cracks() {
    for (mesh, scheme) in cages() {
        for sharpness in [Sharpness::new(), creased(&mesh)] {
            // Towards one corner, so that all levels are side by side.
            let target = mesh.position(VertexId::new(0)) * 0.7;
            let near = |level: usize, corners: &[DVec3]| {
                let size = 2.0 * 0.6_f64.powi(level as i32);
                corners.iter().any(|p| p.distance(target) < size)
            };
            let options = options(scheme, 5);
            let refined =
                refine_adaptively(&mesh, &sharpness, &options, near, Progress::NONE).unwrap();
            // An open side would add a hole; a cage with a rim has one hole still.
            assert_eq!(euler_characteristic(&refined), euler_characteristic(&mesh), "{scheme:?}");
            let is_closed = |m: &Mesh| m.vertices().all(|v| !m.is_boundary_vertex(v));
            assert_eq!(is_closed(&refined), is_closed(&mesh));
            let all = 4_usize.pow(5) * mesh.face_count();
            assert!(refined.face_count() > 4 * mesh.face_count() && refined.face_count() < all);
            let regular = if scheme == LOOP { 3 } else { 4 };
            let many = refined.faces().filter(|&f| refined.degree(f) > regular).count();
            assert!(many > 0, "faces of different levels meet");
        }
    }
}

#[test]
fn only_schemes_with_a_limit_are_taken_and_memory_is_kept_to() {
    let mesh = shapes::cube();
    let refuse = |options: AdaptiveOptions| {
        let all = |_: usize, _: &[DVec3]| true;
        refine_adaptively(&mesh, &Sharpness::new(), &options, all, Progress::NONE).unwrap_err()
    };
    assert!(matches!(refuse(options(Scheme::DooSabin, 2)), Error::NoLimit { .. }));
    assert!(matches!(refuse(little(40)), Error::TooLarge { level, .. } if level < 10));
}

/// How many faces there are if all are split so often.
fn everywhere(mesh: &Mesh, options: RefinementOptions, levels: usize) -> u64 {
    let counts = Counts {
        vertices: mesh.vertex_count() as u64,
        edges: mesh.edge_count() as u64,
        corners: mesh.faces().map(|f| mesh.degree(f) as u64).sum(),
        faces: mesh.face_count() as u64,
    };
    let options = RefinementOptions { levels, memory_limit: u64::MAX, ..options };
    options.predict(counts).unwrap().0[levels].faces
}

#[test]
fn a_tolerance_is_kept_with_fewer_faces_than_everywhere() {
    let mut saved = 0;
    for (mesh, scheme) in cages() {
        for sharpness in [Sharpness::new(), creased(&mesh)] {
            // As many levels as the slowest point asks for; see the next test.
            let (options, tolerance) = (options(scheme, 12), 4e-3);
            let refine = |tolerance| {
                refine_to_tolerance(&mesh, &sharpness, &options, tolerance, Progress::NONE).unwrap()
            };
            let (refined, report) = refine(tolerance);
            assert_eq!(euler_characteristic(&refined), euler_characteristic(&mesh), "{scheme:?}");
            assert!(
                report.faces_beyond == 0 && report.largest_deviation <= tolerance,
                "{report:?}"
            );
            assert!(report.levels >= 1, "each face is split once");
            let all = everywhere(&mesh, options.refinement, report.levels);
            assert!(refined.face_count() as u64 <= all, "{scheme:?} {report:?}");
            saved += usize::from((refined.face_count() as u64) < all);
            // A quarter of the tolerance takes no fewer, and comes closer.
            let (finer, closer) = refine(tolerance / 4.0);
            assert!(finer.face_count() >= refined.face_count());
            assert!(closer.largest_deviation <= report.largest_deviation, "{closer:?}");
            assert!(
                closer.faces_beyond == 0 && closer.largest_deviation <= tolerance / 4.0,
                "{scheme:?} {closer:?}"
            );
        }
    }
    assert!(saved > 6, "only {saved} of 14 meshes have faces of several sizes");
}

/// Where the surface is smooth a level quarters what faces are off by. A sharp vertex is the tip of a spike:
/// with the vertex at 0 Loop's edges have w′ = ⅜ w + ⅛ (w₋ + w₊), which shrinks the mean of the ring by 5/8, and
/// all other waves around it by ⅜ + ¼ cos(2πk/d), so from some level on a level shrinks the deviation by 5/8.
/// That is why cages with corners take more levels, not why they would miss the tolerance.
#[test]
fn spikes_take_as_many_levels_as_their_eigenvalue_says() {
    let mesh = shapes::icosahedron();
    let mut sharpness = Sharpness::new();
    sharpness.set_vertex(VertexId::new(0), SHARP);
    let refine = |levels, tolerance| {
        let options = options(LOOP, levels);
        refine_to_tolerance(&mesh, &sharpness, &options, tolerance, Progress::NONE).unwrap().1
    };
    let reports = [10, 11, 12].map(|levels| refine(levels, 1e-4));
    for pair in reports.windows(2) {
        let ratio = pair[1].largest_deviation / pair[0].largest_deviation;
        // Waves next to the mean are smaller by (0.452/0.625)¹⁰ by then.
        assert!((ratio - 0.625).abs() < 0.625 * 0.03, "{ratio} {pair:?}");
        // Only the five faces at the tip are beyond, or the next ones too.
        assert!((1..=20).contains(&pair[0].faces_beyond), "{pair:?}");
    }
    let [.., last] = reports;
    let more = (last.largest_deviation / 1e-4).ln() / (1.0_f64 / 0.625).ln();
    let enough = refine(12 + more.ceil() as usize + 1, 1e-4);
    assert!(enough.faces_beyond == 0 && enough.largest_deviation <= 1e-4, "{enough:?}");
    assert!(enough.levels.abs_diff(12 + more.ceil() as usize) <= 1, "{enough:?} {more}");
}

#[test]
fn levels_that_do_not_suffice_are_told_and_tolerances_are_positive() {
    let (mesh, smooth) = (shapes::cube(), Sharpness::new());
    let refine = |options, tolerance| {
        refine_to_tolerance(&mesh, &smooth, &options, tolerance, Progress::NONE)
    };
    let (refined, report) = refine(options(Scheme::CatmullClark, 2), 1e-9).unwrap();
    assert_eq!((refined.face_count(), report.faces_beyond, report.levels), (96, 96, 2));
    assert!(report.largest_deviation > 1e-3, "{report:?}");
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = refine(options(Scheme::CatmullClark, 2), tolerance).unwrap_err();
        assert!(matches!(error, Error::InvalidOption { name: "tolerance", .. }), "{error}");
    }
    assert!(matches!(refine(little(40), 1e-12), Err(Error::TooLarge { level, .. }) if level < 10));
}
