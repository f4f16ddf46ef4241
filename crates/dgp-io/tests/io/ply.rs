//! Reading and writing PLY.

use dgp_io::{
    Cause, Document, Encoding, Error, ExtraElement, Format, NumberList, Place, WriteOptions,
    read_bytes, read_bytes_with, write_bytes,
};
use dgp_mesh::{
    AttributeTable, COLOR, Color, DVec2, DVec3, FaceList, IndexedFaceSet, NORMAL, Normal, Progress,
    UV,
};

const ENCODINGS: [Encoding; 3] = [Encoding::Text, Encoding::LittleEndian, Encoding::BigEndian];

fn ply(text: &str) -> Document {
    read_bytes(text.as_bytes(), Format::Ply).unwrap()
}

fn written(document: &Document, encoding: Encoding) -> Vec<u8> {
    let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
    let (bytes, report) = write_bytes(document, Format::Ply, &options, Progress::NONE).unwrap();
    assert_eq!(report.losses, []);
    bytes
}

fn fault(bytes: &[u8]) -> (Place, Cause) {
    match read_bytes(bytes, Format::Ply) {
        Err(Error::Malformed { place, cause, .. }) => (place, cause),
        other => panic!("{other:?}"),
    }
}

/// Polygons with everything a PLY file can hold.
fn everything() -> Document {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y / 3.0, -DVec3::Z];
    let faces = FaceList::from_indices::<&[usize]>(&[&[0, 1, 2, 3], &[0, 3, 4]]);
    let mut set = IndexedFaceSet::new(positions, faces).unwrap();
    let vertex = &mut set.vertex_attributes;
    vertex.insert(NORMAL, vec![Normal(DVec3::new(0.6, 0.0, 0.8)); 5]);
    vertex.insert(COLOR, (0..5).map(|i| Color::from_rgba8([i, 7, 255, 9])).collect::<Vec<_>>());
    vertex.insert(UV, vec![DVec2::new(0.1, 0.5); 5]);
    vertex.insert("height", vec![0.1_f64, f64::INFINITY, -0.0, 1e-300, 4.0]);
    vertex.insert("heat", vec![0.1_f32; 5]);
    vertex.insert("a", vec![-1_i8; 5]);
    vertex.insert("b", vec![200_u8; 5]);
    vertex.insert("c", vec![-3000_i16; 5]);
    vertex.insert("d", vec![60_000_u16; 5]);
    vertex.insert("e", vec![i32::MIN; 5]);
    vertex.insert("f", vec![u32::MAX; 5]);
    let lists = [vec![], vec![0.1], vec![1.0, 2.0], vec![-7.5], vec![3.0; 3]];
    vertex.insert("near", lists.into_iter().map(NumberList).collect::<Vec<_>>());
    set.corner_attributes
        .insert(UV, (0..7).map(|i| DVec2::splat(f64::from(i))).collect::<Vec<_>>());
    set.face_attributes.insert(COLOR, vec![Color([0.1, 0.2, 0.3, 0.5]); 2]);
    set.face_attributes.insert("part", vec![3_i32, 4]);
    let mut rows = AttributeTable::new(2);
    rows.insert("vertex1", vec![0_i32, 1]);
    rows.insert("vertex2", vec![1_i32, 2]);
    rows.insert("crease", vec![0.25_f32, 1.0]);
    let mut document = Document::from(set);
    document.elements.push(ExtraElement { name: "edge".to_owned(), rows });
    document.comments = vec!["made by hand".to_owned(), String::new()];
    document.notes = vec!["num_cols 3".to_owned()];
    document
}

#[test]
fn everything_comes_back_in_each_encoding() {
    let document = everything();
    for encoding in ENCODINGS {
        let again = read_bytes(&written(&document, encoding), Format::Ply).unwrap();
        assert_eq!(again, document, "{encoding}");
    }
}

#[test]
fn types_are_as_small_as_they_can_be_without_loss() {
    let header = |document: &Document| {
        let bytes = written(document, Encoding::LittleEndian);
        let end = bytes.windows(10).position(|window| window == b"end_header").unwrap();
        String::from_utf8(bytes[..end].to_vec()).unwrap()
    };
    let full = header(&everything());
    assert!(
        full.contains("double x") && full.contains("uchar alpha") && full.contains("float alpha")
    );
    let triangle = FaceList::from_indices(&[[0, 1, 2]]);
    let set = IndexedFaceSet::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangle).unwrap();
    assert!(header(&set.into()).contains("float x"));
}

#[test]
fn headers_may_be_sloppy() {
    let neat = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let sloppy = neat
        .replace("element", "  element")
        .replace("property float", "property \t float32")
        .replace("uchar int vertex_index", "uint8 uint16 vertex_indices ");
    let same = [
        sloppy,
        neat.replace('\n', "\r\n"),
        neat.replace('\n', "\r"),
        neat.replace("\n1 0 0", " 1 0\n0 "),
        neat.replace("end_header\n", "end_header\n\n"),
    ];
    for text in same {
        assert_eq!(ply(&text), ply(neat), "{text:?}");
    }
    // A body of bytes follows the line end of the header at once, whatever its first bytes are.
    let mut bytes = neat[..neat.find("0 0 0").unwrap()]
        .replace("ascii", "binary_little_endian")
        .replace('\n', "\r\n")
        .into_bytes();
    for x in [f32::from_le_bytes(*b"\n\r\n\r"), 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let document = read_bytes(&bytes, Format::Ply).unwrap();
    assert_eq!((document.set.vertex_count(), document.set.face_count()), (3, 1));
}

#[test]
fn strips_are_unrolled_with_their_orientation() {
    let document = ply("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n\
        property float y\nproperty float z\nelement tristrips 1\n\
        property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n\
        8 0 1 2 3 -1 3 2 0\n");
    let faces: Vec<Vec<usize>> =
        document.set.faces().iter().map(|(_, f)| f.iter().map(|v| v.index()).collect()).collect();
    assert_eq!(faces, [[0, 1, 2], [2, 1, 3], [3, 2, 0]]);
}

#[test]
fn colors_of_every_type_are_fractions() {
    for (kind, values) in [("uchar", "255 0 51"), ("float", "1 0 .2"), ("ushort", "65535 0 13107")]
    {
        for prefix in ["", "diffuse_"] {
            let document = ply(&format!(
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                 property float z\nproperty {kind} {prefix}red\nproperty {kind} {prefix}green\n\
                 property {kind} {prefix}blue\nend_header\n0 0 0 {values}\n"
            ));
            let colors = document.set.vertex_attributes.get::<Color>(COLOR).unwrap();
            assert_eq!(colors.values(), [Color([1.0, 0.0, 0.2, 1.0])], "{kind}");
        }
    }
}

#[test]
fn what_is_behind_the_last_row_is_reported() {
    let mut bytes = written(&everything(), Encoding::BigEndian);
    bytes.extend(b"??");
    let (document, report) = read_bytes_with(&bytes, Format::Ply, Progress::NONE).unwrap();
    assert_eq!(document, everything());
    assert_eq!(report.warnings[0].what, "2 bytes after the last row skipped");
}

#[test]
fn bad_files_are_refused_with_their_place() {
    let vertices = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
                    property float z\n";
    let faces =
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n";
    let line = |text: &str| fault(text.as_bytes());
    let claim =
        "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n1\n";
    assert!(matches!(line(claim), (Place::Line(3), Cause::TooMany { claimed: 4_000_000_000, .. })));
    let short = format!("{vertices}end_header\n0 0 0.25\n1 0\n");
    assert!(matches!(line(&short), (_, Cause::CutShort { found: 1, expected: 2, .. })));
    let index = format!("{vertices}{faces}3 0 1 7\n");
    assert!(matches!(line(&index), (Place::Line(12), Cause::IndexOutOfRange { index: 7, .. })));
    let word = format!("{vertices}end_header\n0 0 0\n1 x 0\n");
    assert_eq!(line(&word), (Place::Line(9), Cause::NotANumber { text: "x".to_owned() }));
    assert!(matches!(line("ply\nformat ascii 1.0\n"), (_, Cause::Header { .. })));
    assert!(matches!(line("play\n"), (_, Cause::WrongFormat { .. })));
    assert_eq!(line("").1, Cause::Empty);
    let bytes = written(&everything(), Encoding::LittleEndian);
    for len in (0..bytes.len()).step_by(7) {
        assert!(read_bytes(&bytes[..len], Format::Ply).is_err(), "{len} of {} bytes", bytes.len());
    }
}
