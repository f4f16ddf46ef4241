//! The bodies of the fuzzers: each takes any bytes and must end without a panic, soon, and in
//! memory of a few times the size of the bytes. What can be read must also survive writing.

use dgp_io::{Document, Encoding, Format, WriteOptions, read_bytes, write_bytes};
use dgp_mesh::{
    DVec3, FaceList, IndexedFaceSet, Mesh, Progress, RepairOptions, Tolerance, VertexId, defects,
    repair,
};

/// Reads an OBJ file.
pub fn obj(bytes: &[u8]) {
    read_and_write(bytes, Format::Obj);
}

/// Reads a PLY file.
pub fn ply(bytes: &[u8]) {
    read_and_write(bytes, Format::Ply);
}

/// Reads an STL file.
pub fn stl(bytes: &[u8]) {
    read_and_write(bytes, Format::Stl);
}

/// Reads an OFF file.
pub fn off(bytes: &[u8]) {
    read_and_write(bytes, Format::Off);
}

/// Reads an XYZ file and a PWN file.
pub fn xyz(bytes: &[u8]) {
    read_and_write(bytes, Format::Xyz);
    read_and_write(bytes, Format::Pwn);
}

/// Builds a half-edge mesh from arbitrary faces: the first byte is the number of vertices, then
/// come faces, each a number of corners and their vertices.
pub fn build_from_faces(bytes: &[u8]) {
    let Some((&count, mut rest)) = bytes.split_first() else { return };
    let count = usize::from(count);
    let mut faces = FaceList::new();
    while let Some((&degree, after)) = rest.split_first() {
        let degree = usize::from(degree % 8).min(after.len());
        let (face, after) = after.split_at(degree);
        let face: Vec<VertexId> = face.iter().map(|&v| VertexId::new(usize::from(v))).collect();
        faces.push(&face);
        rest = after;
    }
    let positions: Vec<DVec3> = (0..count).map(place).collect();
    let Ok(set) = IndexedFaceSet::new(positions, faces) else { return };
    let found = defects(&set, Progress::NONE).expect("nobody cancels");
    match Mesh::new(&set) {
        Ok(mesh) => {
            assert!(found.is_manifold(), "{found:?}");
            assert_eq!(mesh.to_indexed(), set);
        }
        Err(error) => assert!(!found.is_manifold(), "no defect explains: {error}"),
    }
    repairs(&set, &RepairOptions::default());
    let all = RepairOptions {
        weld: Some(Tolerance::OfDiagonal(0.01)),
        hole_edges: usize::MAX,
        ..RepairOptions::default()
    };
    repairs(&set, &all);
}

/// Points of which some are equal, some on a line and most in general position.
fn place(i: usize) -> DVec3 {
    DVec3::new((i % 7) as f64, (i * i % 11) as f64, (i / 2 % 5) as f64)
}

/// Whatever the faces, a repair gives a mesh.
fn repairs(set: &IndexedFaceSet, options: &RepairOptions) {
    let (mesh, _) =
        repair(set, options, Progress::NONE).unwrap_or_else(|error| panic!("{error}: {set:?}"));
    mesh.validate().unwrap_or_else(|invalid| panic!("{invalid}: {set:?}"));
}

/// The contents of a file, if it has any, must come back from every encoding of its format.
fn read_and_write(bytes: &[u8], format: Format) {
    let _ = Format::sniff(bytes);
    let Ok(document) = read_bytes(bytes, format) else { return };
    for encoding in [Encoding::Text, Encoding::LittleEndian, Encoding::BigEndian] {
        if !format.has_encoding(encoding) {
            continue;
        }
        let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
        let (written, report) = write_bytes(&document, format, &options, Progress::NONE)
            .unwrap_or_else(|error| panic!("{format} as {encoding}: {error}"));
        let again = read_bytes(&written, format)
            .unwrap_or_else(|error| panic!("{format} as {encoding}: {error}"));
        if report.losses.is_empty() {
            same(&document, &again, format, encoding);
        }
    }
}

fn same(before: &Document, after: &Document, format: Format, encoding: Encoding) {
    let what = format!("{format} as {encoding}");
    let (before, after) = (&before.set, &after.set);
    assert_eq!(before.faces(), after.faces(), "{what}");
    assert_eq!(before.vertex_count(), after.vertex_count(), "{what}");
    for (v, p) in before.positions().iter() {
        let q = after.position(v);
        let equal = |k: usize| p[k].to_bits() == q[k].to_bits() || (p[k].is_nan() && q[k].is_nan());
        assert!((0..3).all(equal), "{what}: {v} from {p} to {q}");
    }
}
