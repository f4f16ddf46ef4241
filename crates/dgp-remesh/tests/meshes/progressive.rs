//! Progressive meshes: levels replay bit for bit, files come back, damage is told.

use dgp_mesh::{DVec3, Mesh, Progress, VertexSet, shapes};
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
            let options = QuadricOptions::default();
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
