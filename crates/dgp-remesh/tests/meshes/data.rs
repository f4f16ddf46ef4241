//! Data as dimensions of decimation by quadrics: what is linear stays exact, what jumps stays where it jumps.

use dgp_mesh::{COLOR, Color, DVec2, Mesh, NORMAL, Normal, Progress, UV, VertexSet, shapes};
use dgp_remesh::{DecimationReport, Order, QuadricOptions, Target, decimate_quadric, seam_edges};

fn run(mesh: &mut Mesh, faces: usize, options: &QuadricOptions) -> DecimationReport {
    let target = Target::Faces(faces);
    let report = decimate_quadric(mesh, target, &VertexSet::new(), options, Progress::NONE);
    mesh.validate().expect("a valid mesh");
    report.expect("a mesh of triangles")
}

fn weighted(attribute_weight: f64) -> QuadricOptions {
    QuadricOptions { attribute_weight, ..QuadricOptions::default() }
}

fn gray(x: f64) -> Color {
    Color([x as f32, x as f32, x as f32, 1.0])
}

/// The grid from 0 to 1 in both directions.
fn unit_grid(n: usize) -> Mesh {
    let mut mesh = shapes::grid(n, n).unwrap();
    let bounds = dgp_mesh::measure::bounding_box(&mesh).unwrap();
    let size = (bounds.max - bounds.min).max_element();
    mesh.set_positions(mesh.positions().map(|&p| (p - bounds.min) / size));
    mesh
}

#[test]
fn what_is_linear_on_a_plane_stays_exact() {
    for order in [Order::Best, Order::Passes] {
        let mut mesh = unit_grid(24);
        let linear = |x: f64, y: f64| DVec2::new(3.0 * x - y + 0.5, 0.25 * x + 2.0 * y);
        let shade = |x: f64, y: f64| 0.2 + 0.5 * x + 0.25 * y;
        let of_vertices: Vec<Color> =
            mesh.positions().values().iter().map(|p| gray(shade(p.x, p.y))).collect();
        let at = |h| {
            let p = mesh.position(mesh.from(h));
            if mesh.face(h).is_some() { linear(p.x, p.y) } else { DVec2::ZERO }
        };
        let of_corners: Vec<DVec2> = mesh.halfedges().map(at).collect();
        mesh.attributes_mut().vertex.insert(COLOR, of_vertices);
        mesh.attributes_mut().corner.insert(UV, of_corners);
        let report = run(&mut mesh, 10, &QuadricOptions { order, ..weighted(0.1) });
        assert!(mesh.face_count() <= 10);
        assert!(report.largest_error < 1e-6, "{}", report.largest_error);
        let colors = mesh.attributes().vertex.get::<Color>(COLOR).unwrap();
        for v in mesh.vertices() {
            let p = mesh.position(v);
            let off = f64::from(colors[v].0[0]) - shade(p.x, p.y);
            assert!(off.abs() < 1e-6, "{off}");
            assert_eq!(colors[v].0[3], 1.0);
        }
        let uv = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
        for h in mesh.halfedges().filter(|&h| mesh.face(h).is_some()) {
            let p = mesh.position(mesh.from(h));
            let off = (uv[h] - linear(p.x, p.y)).length();
            assert!(off < 1e-9, "{off}");
        }
        assert!(seam_edges(&mesh).is_empty());
    }
}

#[test]
fn a_step_of_color_stays_where_it_is() {
    let n = 32;
    let step = |x: f64| ((x - 0.5) * n as f64).clamp(0.0, 1.0);
    let mut mesh = unit_grid(n);
    let colors: Vec<Color> = mesh.positions().values().iter().map(|p| gray(step(p.x))).collect();
    mesh.attributes_mut().vertex.insert(COLOR, colors);
    // On a plane nothing else holds a vertex: without a weight the step is lost.
    let worst = |weight: f64| {
        let mut mesh = mesh.clone();
        let _ = run(&mut mesh, 24, &weighted(weight));
        let colors = mesh.attributes().vertex.get::<Color>(COLOR).unwrap();
        let mut worst = 0.0_f64;
        for f in mesh.faces() {
            let corners = mesh.triangle(f).unwrap();
            for t in 0..=8 {
                for s in 0..=8 - t {
                    let (s, t) = (f64::from(s) / 8.0, f64::from(t) / 8.0);
                    let weights = [1.0 - s - t, s, t];
                    let mix = |of: &dyn Fn(usize) -> f64| -> f64 {
                        (0..3).map(|k| weights[k] * of(k)).sum()
                    };
                    let x = mix(&|k| mesh.position(corners[k]).x);
                    let shade = mix(&|k| f64::from(colors[corners[k]].0[0]));
                    worst = worst.max((shade - step(x)).abs());
                }
            }
        }
        worst
    };
    assert!(worst(0.0) > 0.5, "{}", worst(0.0));
    assert!(worst(0.1) < 1e-3, "{}", worst(0.1));
}

#[test]
fn seams_stay_where_data_count() {
    let mut mesh = unit_grid(16);
    let uv: Vec<DVec2> = mesh
        .halfedges()
        .map(|h| {
            let Some(f) = mesh.face(h) else { return DVec2::ZERO };
            let p = mesh.position(mesh.from(h));
            // The other chart lies turned by a quarter.
            if mesh.face_center(f).x < 0.5 {
                DVec2::new(p.x, p.y)
            } else {
                DVec2::new(5.0 - p.y, p.x)
            }
        })
        .collect();
    mesh.attributes_mut().corner.insert(UV, uv);
    assert_eq!(seam_edges(&mesh).len(), 16);
    let _ = run(&mut mesh, 12, &weighted(0.2));
    let uv = mesh.attributes().corner.get::<DVec2>(UV).unwrap();
    for h in mesh.halfedges() {
        let Some(f) = mesh.face(h) else { continue };
        let p = mesh.position(mesh.from(h));
        let is_left = mesh.face_center(f).x < 0.5;
        let expected = if is_left { DVec2::new(p.x, p.y) } else { DVec2::new(5.0 - p.y, p.x) };
        assert!((uv[h] - expected).length() < 1e-9, "{} {expected}", uv[h]);
    }
    let seams = seam_edges(&mesh);
    let length: f64 = seams.iter().map(|e| mesh.edge_length(e)).sum();
    assert!((length - 1.0).abs() < 1e-9, "{length}");
}

#[test]
fn normals_stay_unit_and_close_to_those_of_the_sphere() {
    let mut mesh = shapes::icosphere(4).unwrap();
    let normals: Vec<Normal> =
        mesh.positions().values().iter().map(|p| Normal(p.normalize())).collect();
    mesh.attributes_mut().vertex.insert(NORMAL, normals);
    let _ = run(&mut mesh, 500, &weighted(0.05));
    let normals = mesh.attributes().vertex.get::<Normal>(NORMAL).unwrap();
    for v in mesh.vertices() {
        let n = normals[v].0;
        assert!((n.length() - 1.0).abs() < 1e-12);
        assert!(n.dot(mesh.position(v).normalize()) > 0.995, "{n}");
    }
}

#[test]
fn numbers_that_are_none_do_not_count() {
    let mut mesh = unit_grid(8);
    let mut uv = vec![DVec2::ZERO; mesh.halfedge_count()];
    uv[5] = DVec2::new(f64::NAN, 0.0);
    mesh.attributes_mut().corner.insert(UV, uv);
    let report = run(&mut mesh, 20, &weighted(0.1));
    assert!(report.largest_error.is_finite());
    assert!(mesh.positions().values().iter().all(|p| p.is_finite()));
}

#[test]
fn scale_changes_nothing() {
    let mut plain = shapes::blob(3).unwrap();
    let colors: Vec<Color> =
        plain.positions().values().iter().map(|p| gray(0.5 + 0.3 * p.z)).collect();
    plain.attributes_mut().vertex.insert(COLOR, colors);
    let mut large = plain.clone();
    large.set_positions(large.positions().map(|&p| p * 2_f64.powi(700)));
    let options = QuadricOptions { polish: 2, ..weighted(0.1) };
    let _ = run(&mut plain, 200, &options);
    let _ = run(&mut large, 200, &options);
    assert_eq!(plain.attributes(), large.attributes());
    for v in plain.vertices() {
        assert_eq!(large.position(v), plain.position(v) * 2_f64.powi(700));
    }
}
