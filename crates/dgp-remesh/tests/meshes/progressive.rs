//! Progressive meshes: levels replay bit for bit, files come back, damage is told.

use std::collections::BTreeMap;

use dgp_mesh::{COLOR, Color, DVec2, DVec3, Mesh, Progress, UV, VertexSet, shapes};
use dgp_remesh::{
    Error, ProgressiveMesh, ProgressiveStream, QuadricOptions, Target, decimate_quadric,
};

fn progressive(mesh: &Mesh, faces: usize) -> ProgressiveMesh {
    let options = QuadricOptions::default();
    let target = Target::Faces(faces);
    ProgressiveMesh::new(mesh, target, &options, Progress::NONE).expect("triangles")
}

/// Faces as positions of corners, whatever their numbers: each starts with its least corner.
fn shape(mesh: &Mesh) -> Vec<[[u64; 3]; 3]> {
    let bits = |p: DVec3| p.to_array().map(f64::to_bits);
    let face = |f| {
        let corners = mesh.triangle(f).expect("triangles").map(|v| bits(mesh.position(v)));
        let least = (0..3).min_by_key(|&k| corners[k]).expect("three corners");
        [0, 1, 2].map(|k| corners[(least + k) % 3])
    };
    let mut faces: Vec<_> = mesh.faces().map(face).collect();
    faces.sort_unstable();
    faces
}

fn inputs() -> Vec<Mesh> {
    vec![
        shapes::icosphere(3).unwrap(),
        shapes::blob(3).unwrap(),
        shapes::with_holes(&shapes::icosphere(4).unwrap(), 3, 1, 5).unwrap(),
        shapes::grid(9, 7).unwrap(),
    ]
}

#[test]
fn levels_are_those_of_decimation_bit_for_bit() {
    for mesh in inputs() {
        let mut levels = progressive(&mesh, 40);
        assert_eq!(shape(&levels.mesh().unwrap()), shape(&mesh));
        for level in (0..=levels.level_count()).step_by(37) {
            levels.set_level(level).unwrap();
            let mut decimated = mesh.clone();
            let target = Target::Vertices(levels.vertex_count());
            let options = QuadricOptions { polish: 0, ..QuadricOptions::default() };
            let _ = decimate_quadric(
                &mut decimated,
                target,
                &VertexSet::new(),
                &options,
                Progress::NONE,
            )
            .unwrap();
            assert_eq!(shape(&levels.mesh().unwrap()), shape(&decimated), "level {level}");
        }
    }
}

#[test]
fn every_level_is_the_same_from_both_sides() {
    for mesh in inputs() {
        let mut levels = progressive(&mesh, 40);
        let finest = levels.level_count();
        let mut going_down = Vec::new();
        for level in (0..=finest).rev() {
            levels.set_level(level).unwrap();
            going_down.push((levels.positions().to_vec(), levels.faces().to_vec()));
        }
        for level in 0..=finest {
            levels.set_level(level).unwrap();
            let (positions, faces) = &going_down[finest - level];
            assert_eq!((levels.positions(), levels.faces()), (&positions[..], &faces[..]));
        }
    }
}

#[test]
fn files_come_back_and_stream() {
    for mesh in inputs() {
        let levels = progressive(&mesh, 40);
        let bytes = levels.to_bytes();
        let mut stream = ProgressiveStream::new();
        for (k, chunk) in bytes.chunks(97).enumerate() {
            stream.push(chunk).unwrap();
            if k % 20 == 0
                && let Some(arrived) = stream.mesh()
            {
                arrived.mesh().unwrap().validate().unwrap();
            }
        }
        let mut back = stream.finish().unwrap();
        assert_eq!((back.positions(), back.faces()), (levels.positions(), levels.faces()));
        back.set_level(0).unwrap();
        let mut base = levels.clone();
        base.set_level(0).unwrap();
        assert_eq!((back.positions(), back.faces()), (base.positions(), base.faces()));
    }
}

#[test]
fn every_damaged_byte_and_every_missing_end_is_noticed() {
    let bytes = progressive(&shapes::icosphere(2).unwrap(), 20).to_bytes();
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 4;
        let error = ProgressiveMesh::from_bytes(&damaged).unwrap_err();
        assert!(matches!(error, Error::Damaged { .. }), "{at}: {error}");
        let error = ProgressiveMesh::from_bytes(&bytes[..at]).unwrap_err();
        assert!(matches!(error, Error::Damaged { .. }), "{at}: {error}");
    }
    let longer = [&bytes[..], &[0]].concat();
    let error = ProgressiveMesh::from_bytes(&longer).unwrap_err();
    assert!(error.to_string().contains("bytes follow"), "{error}");
    let error = ProgressiveMesh::from_bytes(b"solid model").unwrap_err();
    assert!(error.to_string().contains("no progressive mesh"), "{error}");
}

#[test]
fn morphs_start_as_the_coarse_level_looks_and_end_as_the_fine_one() {
    let mesh = shapes::blob(3).unwrap();
    let mut levels = progressive(&mesh, 60);
    let (from, to) = (20, 200);
    levels.set_level(from).unwrap();
    let coarse = levels.positions().to_vec();
    let morph = levels.geomorph(from, to).unwrap();
    assert_eq!(&morph.positions(0.0)[..coarse.len()], &coarse[..]);
    assert_eq!(morph.positions(1.0), levels.positions());
    // Faces that are not there at the coarse level have no area at the start.
    let start = morph.positions(0.0);
    let area = |face: &[u32; 3]| {
        let [p, q, r] = face.map(|v| start[v as usize]);
        (q - p).cross(r - p).length()
    };
    let flat = levels.faces().iter().filter(|face| area(face) == 0.0).count();
    levels.set_level(from).unwrap();
    let coarse_faces = levels.face_count();
    levels.set_level(to).unwrap();
    assert_eq!(flat, levels.face_count() - coarse_faces);
    assert!(matches!(levels.set_level(10_000), Err(Error::NoLevel { .. })));
    assert!(matches!(levels.geomorph(9, 3), Err(Error::InvalidOption { .. })));
}

/// With data of every kind that levels have, and some that they have not.
fn dressed() -> Mesh {
    let mut mesh = shapes::blob(3).unwrap();
    let positions = mesh.positions().values().to_vec();
    let color = |p: &DVec3| Color([p.x as f32, 0.5, (p.z * p.y) as f32, 1.0]);
    let texture: Vec<DVec2> = mesh
        .halfedges()
        .map(|h| mesh.face(h).map_or(DVec2::ZERO, |_| mesh.position(mesh.from(h)).truncate()))
        .collect();
    let seams: Vec<f64> =
        mesh.halfedges().map(|h| mesh.face(h).map_or(0.0, |f| f.index() as f64)).collect();
    let data = mesh.attributes_mut();
    data.vertex.insert(COLOR, positions.iter().map(color).collect::<Vec<_>>());
    data.vertex.insert("height", positions.iter().map(|p| p.z).collect::<Vec<f64>>());
    data.vertex.insert("part", (0..positions.len()).map(|v| (v % 7) as u8).collect::<Vec<_>>());
    data.vertex.insert("wide", vec![1_u64; positions.len()]);
    data.corner.insert(UV, texture);
    data.corner.insert("seams", seams);
    mesh
}

type Values = ([u32; 4], u64, u8, [u64; 2]);

/// The data at each position.
fn values(mesh: &Mesh) -> BTreeMap<[u64; 3], Values> {
    let data = mesh.attributes();
    let color = data.vertex.get::<Color>(COLOR).unwrap();
    let height = data.vertex.get::<f64>("height").unwrap();
    let part = data.vertex.get::<u8>("part").unwrap();
    let uv = data.corner.get::<DVec2>(UV).unwrap();
    let of = |v| {
        let h = mesh.vertex_halfedges(v).find(|&h| mesh.face(h).is_some()).unwrap();
        let key = mesh.position(v).to_array().map(f64::to_bits);
        let uv = uv[h].to_array().map(f64::to_bits);
        (key, (color[v].0.map(f32::to_bits), height[v].to_bits(), part[v], uv))
    };
    mesh.vertices().map(of).collect()
}

#[test]
fn data_at_every_level_are_those_of_decimation_bit_for_bit() {
    let mesh = dressed();
    let mut levels = progressive(&mesh, 40);
    assert_eq!(levels.column_names().collect::<Vec<_>>(), [COLOR, "height", "part", UV]);
    assert_eq!(levels.left_out(), ["wide of vertices", "seams of corners"]);
    assert_eq!(values(&levels.mesh().unwrap()), values(&mesh));
    // Columns that levels have not make seams, which decimation would keep.
    let mut plain = mesh.clone();
    let _ = plain.attributes_mut().corner.remove("seams");
    let mut levels_of_plain = progressive(&plain, 40);
    for level in (0..=levels_of_plain.level_count()).step_by(61).chain([3, 0]) {
        levels_of_plain.set_level(level).unwrap();
        let mut decimated = plain.clone();
        let target = Target::Vertices(levels_of_plain.vertex_count());
        let options = QuadricOptions { polish: 0, ..QuadricOptions::default() };
        let none = VertexSet::new();
        let _ = decimate_quadric(&mut decimated, target, &none, &options, Progress::NONE).unwrap();
        let level_mesh = levels_of_plain.mesh().unwrap();
        assert_eq!(values(&level_mesh), values(&decimated), "level {level}");
    }
    levels.set_level(0).unwrap();
    let bytes = levels.to_bytes();
    let mut back = ProgressiveMesh::from_bytes(&bytes).unwrap();
    assert_eq!(values(&back.mesh().unwrap()), values(&mesh));
    back.set_level(0).unwrap();
    assert_eq!(values(&back.mesh().unwrap()), values(&levels.mesh().unwrap()));
}

#[test]
fn damage_in_files_with_data_is_noticed_and_the_first_version_is_read() {
    let bytes = progressive(&dressed(), 600).to_bytes();
    for at in (0..bytes.len()).step_by(13) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 16;
        let error = ProgressiveMesh::from_bytes(&damaged).unwrap_err();
        assert!(matches!(error, Error::Damaged { .. }), "{at}: {error}");
    }
    let mut later = bytes;
    later[8] = 3;
    let error = ProgressiveMesh::from_bytes(&later).unwrap_err();
    assert!(error.to_string().contains("only 1 and 2 are known"), "{error}");
    let first = include_bytes!("version-1.dgpp");
    let mut levels = ProgressiveMesh::from_bytes(first).unwrap();
    assert_eq!((levels.vertex_count(), levels.face_count()), (42, 80));
    assert_eq!(shape(&levels.mesh().unwrap()), shape(&shapes::icosphere(1).unwrap()));
    let again = levels.to_bytes();
    levels.set_level(0).unwrap();
    assert_eq!((levels.face_count(), levels.column_names().count()), (20, 0));
    assert_eq!(ProgressiveMesh::from_bytes(&again).unwrap().level_count(), 30);
}

/// On 327,680 faces where `DGP_LONG_TESTS` is set, which takes a minute and a half.
#[test]
fn every_level_of_a_large_mesh_is_the_same_from_both_sides() {
    let refined = if std::env::var_os("DGP_LONG_TESTS").is_some() { 7 } else { 4 };
    let mesh = shapes::with_noise(shapes::icosphere(refined).unwrap(), 0.05, 1).unwrap();
    let mut levels = progressive(&mesh, mesh.face_count() / 300);
    let finest = levels.level_count();
    // A sum over what a level changes tells levels apart at the cost of a change.
    let print = |levels: &ProgressiveMesh, vertex: usize| {
        let bits = levels.positions()[vertex].to_array().map(f64::to_bits);
        bits.iter().fold(levels.face_count() as u64, |sum, x| sum.rotate_left(7) ^ x)
    };
    let whole = |levels: &ProgressiveMesh| (levels.positions().to_vec(), levels.faces().to_vec());
    let mut going_down = Vec::with_capacity(finest + 1);
    let mut wholes = Vec::new();
    for level in (0..=finest).rev() {
        levels.set_level(level).unwrap();
        going_down.push(print(&levels, level % levels.vertex_count()));
        if level % (finest / 8) == 0 {
            wholes.push(whole(&levels));
        }
    }
    for level in 0..=finest {
        levels.set_level(level).unwrap();
        let now = print(&levels, level % levels.vertex_count());
        assert_eq!(now, going_down[finest - level], "level {level}");
        if level % (finest / 8) == 0 {
            assert_eq!(Some(whole(&levels)), wholes.pop(), "level {level}");
        }
    }
    assert_eq!(shape(&levels.mesh().unwrap()), shape(&mesh));
    for level in [0, finest / 3, finest - finest / 100] {
        levels.set_level(level).unwrap();
        let mut decimated = mesh.clone();
        let target = Target::Vertices(levels.vertex_count());
        let options = QuadricOptions { polish: 0, ..QuadricOptions::default() };
        let none = VertexSet::new();
        let _ = decimate_quadric(&mut decimated, target, &none, &options, Progress::NONE).unwrap();
        assert_eq!(shape(&levels.mesh().unwrap()), shape(&decimated), "level {level}");
    }
}
