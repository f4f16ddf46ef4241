//! Meshes and face sets, good and bad, small and large, with data on every kind of element.

use dgp_mesh::{
    COLOR, Color, DVec2, DVec3, FaceList, GROUP, IndexedFaceSet, Label, Mesh, UV, shapes,
};

/// Faces, and their mesh if they are one.
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) set: IndexedFaceSet,
    pub(crate) mesh: Option<Mesh>,
}

impl Input {
    fn new(name: &str, mut set: IndexedFaceSet) -> Self {
        let (vertices, corners) = (set.vertex_count(), set.faces().corners().len());
        let part = |i: usize, n: usize| (i % n) as f64 / n as f64;
        let colors: Vec<Color> = (0..vertices).map(|i| Color([part(i, 7) as f32; 4])).collect();
        let heat: Vec<f64> = (0..vertices).map(|i| part(i, 11)).collect();
        let uv: Vec<DVec2> = (0..corners).map(|i| DVec2::new(part(i, 5), part(i, 13))).collect();
        let groups =
            (0..set.face_count()).map(|i| Label::new(["a", "b"][i % 2])).collect::<Vec<_>>();
        set.vertex_attributes.insert(COLOR, colors);
        set.vertex_attributes.insert("heat", heat);
        set.corner_attributes.insert(UV, uv);
        set.face_attributes.insert(GROUP, groups);
        let mesh = Mesh::new(&set).ok();
        Input { name: name.to_owned(), set, mesh }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.set.positions().values().iter().all(|p| p.is_finite())
    }
}

/// Large enough that every parallel loop is cut into several blocks.
pub(crate) fn large() -> Vec<Input> {
    let noisy = shapes::with_noise(shapes::icosphere(5).unwrap(), 0.02, 7).unwrap();
    let holed = shapes::with_holes(&noisy, 6, 3, 3).unwrap();
    let scan = shapes::like_a_scan(&shapes::trefoil(300, 30).unwrap(), 5).unwrap();
    vec![
        Input::new("a large sphere with holes", holed.to_indexed()),
        Input::new("a large torus of quads", bent(&shapes::quad_torus(2.0, 0.7, 120, 90).unwrap())),
        Input::new("a large scan", scan),
    ]
}

/// Everything a mesh can be, and everything faces can be that are none.
pub(crate) fn small() -> Vec<Input> {
    let mut inputs = meshes();
    inputs.extend(bad());
    inputs
}

fn meshes() -> Vec<Input> {
    let noisy = shapes::with_noise(shapes::icosphere(2).unwrap(), 0.02, 7).unwrap();
    let holed = shapes::with_holes(&noisy, 3, 1, 3).unwrap();
    let meshes = [
        ("nothing", Mesh::default()),
        ("a tetrahedron", shapes::tetrahedron()),
        ("a cube", shapes::cube()),
        ("a dodecahedron", shapes::dodecahedron()),
        ("a noisy sphere", noisy),
        ("a sphere with holes", holed),
        ("a sphere of quads", shapes::quad_sphere(4).unwrap()),
        ("a torus", shapes::torus(2.0, 0.7, 12, 8).unwrap()),
        ("genus 3", shapes::surface_of_genus(3, 1).unwrap()),
        ("a grid", shapes::grid(5, 7).unwrap()),
        ("an annulus", shapes::annulus(0.5, 1.5, 12, 3).unwrap()),
        ("a capped cone", shapes::capped_cone(1.0, 2.0, 12, 3).unwrap()),
        ("a knot", shapes::trefoil(60, 8).unwrap()),
    ];
    let mut inputs: Vec<Input> =
        meshes.iter().map(|(name, mesh)| Input::new(name, mesh.to_indexed())).collect();
    for (name, factor) in [("huge", 1e300), ("tiny", 1e-300), ("smallest", f64::from_bits(1))] {
        inputs.push(Input::new(name, moved(&shapes::icosphere(1).unwrap(), |p| p * factor)));
    }
    let far = DVec3::new(1e9, -2e9, 3e9);
    inputs.push(Input::new("far away", moved(&shapes::cube(), |p| p + far)));
    inputs.push(Input::new("flat", moved(&shapes::icosphere(1).unwrap(), |p| p.with_z(0.0))));
    inputs.push(Input::new("a line", moved(&shapes::icosphere(1).unwrap(), |p| DVec3::X * p.x)));
    inputs.push(Input::new("a point", moved(&shapes::cube(), |_| DVec3::ONE)));
    let spiral: Vec<DVec3> = (0..300)
        .map(|i| {
            let (out, k) = if i < 150 { (1.0, i) } else { (0.9, 299 - i) };
            let t = f64::from(k) * 0.1;
            DVec3::new(t * out * t.cos(), t * out * t.sin(), 0.1 * t)
        })
        .collect();
    inputs.push(set("a spiral", &spiral, &[(0..300).collect()]));
    inputs.push(set(
        "a bow",
        &plane(&[[0, 0], [2, 2], [2, 0], [0, 2], [1, 5]]),
        &[(0..5).collect()],
    ));
    inputs
}

fn bad() -> Vec<Input> {
    let points = plane(&[[0, 0], [2, 0], [0, 2], [2, 2], [1, 1], [5, 5], [0, 0]]);
    let mut wrong = points.clone();
    wrong[1].x = f64::NAN;
    wrong[2].y = f64::INFINITY;
    let mut lifted = points.clone();
    lifted.iter_mut().enumerate().for_each(|(i, p)| p.z = i as f64);
    let sphere = shapes::icosphere(2).unwrap().to_indexed();
    let twice = {
        let mut faces = sphere.faces().clone();
        for (_, face) in sphere.faces().iter() {
            faces.push(face);
        }
        IndexedFaceSet::new(sphere.positions().clone(), faces).unwrap()
    };
    vec![
        set("points", &points, &[]),
        set("no numbers", &wrong, &[vec![0, 1, 2], vec![1, 3, 2]]),
        set("only no numbers", &[DVec3::NAN; 3], &[vec![0, 1, 2]]),
        set(
            "faces of no corner, one and two",
            &points,
            &[vec![], vec![0], vec![0, 1], vec![0, 1, 2]],
        ),
        set("repeated corners", &points, &[vec![0, 0, 1], vec![0, 1, 0, 2], vec![3, 3, 3, 3]]),
        set("three faces at an edge", &lifted, &[vec![0, 1, 2], vec![1, 0, 3], vec![0, 1, 4]]),
        set("two fans at a vertex", &lifted, &[vec![0, 1, 4], vec![2, 4, 3]]),
        set("faces that disagree", &lifted, &[vec![0, 1, 2], vec![1, 2, 3]]),
        set("a face and its copy", &lifted, &[vec![0, 1, 2], vec![0, 1, 2], vec![1, 2, 0]]),
        set("a face and its back", &lifted, &[vec![0, 1, 2], vec![2, 1, 0]]),
        set("points at one place", &points, &[vec![0, 1, 2], vec![6, 2, 1]]),
        Input::new("a Möbius strip", shapes::mobius_strip(20, 3).unwrap()),
        Input::new("everything twice", twice),
        Input::new("a scan", shapes::like_a_scan(&shapes::icosphere(3).unwrap(), 3).unwrap()),
        Input::new("a flipped patch", shapes::flip_patch(&sphere, 0.5, 2)),
        Input::new("a loose patch", shapes::unweld_patch(&sphere, 0.5, 2)),
    ]
}

/// Quads that are not flat.
fn bent(mesh: &Mesh) -> IndexedFaceSet {
    moved(mesh, |p| p + 0.05 * DVec3::new((9.0 * p.y).sin(), (7.0 * p.z).sin(), (8.0 * p.x).sin()))
}

fn moved(mesh: &Mesh, change: impl Fn(DVec3) -> DVec3) -> IndexedFaceSet {
    let mut set = mesh.to_indexed();
    set.positions_mut().iter_mut().for_each(|p| *p = change(*p));
    set
}

fn plane(points: &[[i32; 2]]) -> Vec<DVec3> {
    points.iter().map(|p| DVec3::new(f64::from(p[0]), f64::from(p[1]), 0.0)).collect()
}

fn set(name: &str, points: &[DVec3], faces: &[Vec<usize>]) -> Input {
    let faces = FaceList::from_indices(faces);
    Input::new(name, IndexedFaceSet::new(points.to_vec(), faces).unwrap())
}
