//! Reading and writing STL, XYZ and PWN.

use dgp_io::{
    ATTRIBUTE_BYTES, Cause, Document, Encoding, Error, Format, Place, WriteOptions, WriteReport,
    read_bytes, read_bytes_with, write_bytes,
};
use dgp_mesh::{
    COLOR, Color, DVec3, FaceId, FaceList, IndexedFaceSet, Label, NORMAL, Normal, OBJECT, Progress,
};

fn written(document: &Document, format: Format, encoding: Encoding) -> (Vec<u8>, WriteReport) {
    let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
    write_bytes(document, format, &options, Progress::NONE).unwrap()
}

fn cause(bytes: &[u8], format: Format) -> Cause {
    match read_bytes(bytes, format) {
        Err(Error::Malformed { cause, .. }) => cause,
        other => panic!("{other:?}"),
    }
}

/// A tetrahedron whose vertices are numbered by first appearance.
fn tetrahedron() -> Document {
    let positions = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::Z];
    let faces = FaceList::from_indices(&[[0, 1, 2], [0, 2, 3], [2, 1, 3], [1, 0, 3]]);
    IndexedFaceSet::new(positions, faces).unwrap().into()
}

#[test]
fn corners_are_welded_by_their_bits() {
    let document = tetrahedron();
    for encoding in [Encoding::Text, Encoding::LittleEndian] {
        let (bytes, report) = written(&document, Format::Stl, encoding);
        assert_eq!(report.losses, []);
        assert_eq!(read_bytes(&bytes, Format::Stl).unwrap(), document, "{encoding}");
    }
    let (text, _) = written(&document, Format::Stl, Encoding::Text);
    let negative = String::from_utf8(text).unwrap().replace("vertex 0 0 0", "vertex -0 0 -0.0");
    assert_eq!(read_bytes(negative.as_bytes(), Format::Stl).unwrap().set.vertex_count(), 4);
}

/// Found by fuzzing: text keeps no bits of what is no number, so that vertices became fewer.
#[test]
fn what_is_no_number_is_one_vertex_whatever_its_bits() {
    let (mut bytes, _) = written(&tetrahedron(), Format::Stl, Encoding::LittleEndian);
    for (at, bits) in [(96, 0x7fc0_0001_u32), (146, 0xffff_ffff)] {
        bytes[at..at + 4].copy_from_slice(&bits.to_le_bytes());
    }
    let document = read_bytes(&bytes, Format::Stl).unwrap();
    assert_eq!(document.set.vertex_count(), 5);
    let (text, _) = written(&document, Format::Stl, Encoding::Text);
    let again = read_bytes(&text, Format::Stl).unwrap();
    assert_eq!(again.set.faces(), document.set.faces());
    let signed = String::from_utf8(text).unwrap().replacen("nan", "-nan", 1);
    let again = read_bytes(signed.as_bytes(), Format::Stl).unwrap();
    assert_eq!(again.set.faces(), document.set.faces());
}

#[test]
fn solids_are_objects() {
    let text = "solid left\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                vertex 0 1 0\nendloop\nendfacet\nendsolid left\nsolid right hand\n\
                facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 1 0 vertex 1 0 0 endloop\n\
                endfacet\nendsolid\n";
    let document = read_bytes(text.as_bytes(), Format::Stl).unwrap();
    assert_eq!((document.set.vertex_count(), document.set.face_count()), (3, 2));
    let labels = document.set.face_attributes.get::<Label>(OBJECT).unwrap();
    assert_eq!(labels[FaceId::new(1)], Label::new("right hand"));
    let (bytes, _) = written(&document, Format::Stl, Encoding::Text);
    assert_eq!(read_bytes(&bytes, Format::Stl).unwrap(), document);
}

#[test]
fn binary_files_that_begin_with_solid_are_binary() {
    let mut document = tetrahedron();
    document.set.face_attributes.insert(ATTRIBUTE_BYTES, vec![1_u16, 2, 3, 0]);
    let (mut bytes, _) = written(&document, Format::Stl, Encoding::LittleEndian);
    bytes[..5].copy_from_slice(b"solid");
    let read = read_bytes(&bytes, Format::Stl).unwrap();
    assert_eq!(read.set, document.set);
    assert_eq!(read.comments, ["solid"]);
}

#[test]
fn polygons_are_cut_and_that_is_reported() {
    let square = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.1), DVec3::Y];
    let faces = FaceList::from_indices::<&[usize]>(&[&[0, 1, 2, 3], &[0, 1]]);
    let document = Document::from(IndexedFaceSet::new(square, faces).unwrap());
    let (bytes, report) = written(&document, Format::Stl, Encoding::LittleEndian);
    assert_eq!(read_bytes(&bytes, Format::Stl).unwrap().set.face_count(), 2);
    let losses: Vec<String> = report.losses.iter().map(ToString::to_string).collect();
    assert_eq!(
        losses,
        [
            "polygons cut into triangles (1)",
            "faces with fewer than 3 corners left out (1)",
            "coordinates rounded to single precision (1)"
        ]
    );
}

#[test]
fn normals_against_their_facet_are_reported() {
    let (bytes, _) = written(&tetrahedron(), Format::Stl, Encoding::Text);
    let text = String::from_utf8(bytes).unwrap().replace("normal 0 0 -1", "normal 0 0 1");
    let (_, report) = read_bytes_with(text.as_bytes(), Format::Stl, Progress::NONE).unwrap();
    assert_eq!(report.warnings.len(), 1);
    assert_eq!(report.warnings[0].first, Place::Line(2));
}

#[test]
fn wrong_counts_and_cut_files_are_refused() {
    let (bytes, _) = written(&tetrahedron(), Format::Stl, Encoding::LittleEndian);
    for len in [0, 40, 83, 100, bytes.len() - 1] {
        assert!(read_bytes(&bytes[..len], Format::Stl).is_err(), "{len} bytes");
    }
    let mut more = bytes.clone();
    more[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(matches!(cause(&more, Format::Stl), Cause::TooMany { possible: 4, .. }));
    let (text, _) = written(&tetrahedron(), Format::Stl, Encoding::Text);
    assert!(matches!(cause(&text[..text.len() - 40], Format::Stl), Cause::CutShort { .. }));
}

#[test]
fn points_have_normals_or_colors() {
    let read = |text: &str, format| read_bytes(text.as_bytes(), format).unwrap();
    let document = read("# scan\n0 0 0 0 0 1\n1 2 3.5 1 0 0\n", Format::Pwn);
    let normals = document.set.vertex_attributes.get::<Normal>(NORMAL).unwrap().values();
    assert_eq!(normals, [Normal(DVec3::Z), Normal(DVec3::X)]);
    for format in [Format::Pwn, Format::Xyz] {
        let (bytes, report) = written(&document, format, Encoding::Text);
        assert_eq!(report.losses, []);
        assert_eq!(read_bytes(&bytes, format).unwrap(), document);
    }
    let document = read("2\n0,0,0, 255 0 51\n1 2 3 4 5 6", Format::Xyz);
    let colors = document.set.vertex_attributes.get::<Color>(COLOR).unwrap().values();
    assert_eq!(colors[0], Color([1.0, 0.0, 0.2, 1.0]));
    let more = read("0 0 0 .5 7\n1 1 1 .5 8\n", Format::Xyz);
    let column = more.set.vertex_attributes.get::<f64>("column5").unwrap();
    assert_eq!(column.values(), [7.0, 8.0]);
}

#[test]
fn bad_points_are_refused() {
    let few = Cause::TooFewNumbers { found: 2, expected: 3 };
    assert_eq!(cause(b"0 0 0\n1 1\n", Format::Xyz), few);
    assert_eq!(cause(b"0 0\n", Format::Xyz), few);
    assert_eq!(cause(b"0 0 x\n", Format::Pwn), Cause::NotANumber { text: "x".to_owned() });
    assert!(matches!(cause(b"0 0 0\n1 1 1 1\n", Format::Xyz), Cause::Header { .. }));
    assert!(matches!(cause(b"999999\n0 0 0\n", Format::Xyz), Cause::TooMany { .. }));
}
