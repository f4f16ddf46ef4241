//! Reading and writing OBJ and OFF.

use dgp_io::{
    Cause, Document, Encoding, Error, Format, Place, WriteOptions, read_bytes, read_bytes_with,
    write_bytes,
};
use dgp_mesh::{
    COLOR, Color, DVec2, DVec3, FaceId, GROUP, Label, MATERIAL, NORMAL, Normal, Progress, UV,
    VertexId,
};

fn obj(text: &str) -> Document {
    read_bytes(text.as_bytes(), Format::Obj).unwrap()
}

fn off(text: &str) -> Document {
    read_bytes(text.as_bytes(), Format::Off).unwrap()
}

fn written(document: &Document, format: Format, encoding: Encoding) -> Vec<u8> {
    let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
    write_bytes(document, format, &options, Progress::NONE).unwrap().0
}

fn fault(bytes: &[u8], format: Format) -> (Place, Cause) {
    match read_bytes(bytes, format) {
        Err(Error::Malformed { place, cause, .. }) => (place, cause),
        other => panic!("{other:?}"),
    }
}

#[test]
fn faces_may_count_backwards_and_span_lines() {
    let document = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 \\\n -1\nv 0 0 1\nf -1 1 2 # last\n");
    let faces: Vec<Vec<usize>> =
        document.set.faces().iter().map(|(_, f)| f.iter().map(|v| v.index()).collect()).collect();
    assert_eq!(faces, [[0, 1, 2], [3, 0, 1]]);
}

#[test]
fn every_line_end_will_do() {
    let unix = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3";
    for end in ["\r\n", "\r", "\n"] {
        assert_eq!(obj(&unix.replace('\n', end)), obj(unix), "{end:?}");
    }
    assert_eq!(obj(&format!("\u{feff}{unix}")), obj(unix));
}

#[test]
fn seams_stay_on_corners_and_the_rest_goes_to_vertices() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt .5 .5\nvn 0 0 1\n\
                f 1/1/1 2/2/1 3/3/1\nf 1/5/1 3/3/1 4/4/1\n";
    let document = obj(text);
    let set = &document.set;
    assert_eq!(
        set.vertex_attributes.get::<Normal>(NORMAL).unwrap().values(),
        [Normal(DVec3::Z); 4]
    );
    let uv = set.corner_attributes.get::<DVec2>(UV).unwrap().values();
    assert_eq!((uv[0], uv[3]), (DVec2::ZERO, DVec2::splat(0.5)));
    let bytes = written(&document, Format::Obj, Encoding::Text);
    assert_eq!(read_bytes(&bytes, Format::Obj).unwrap(), document);
    let text = String::from_utf8(bytes).unwrap();
    assert_eq!((text.matches("vt ").count(), text.matches("vn ").count()), (5, 1));
}

#[test]
fn labels_lines_points_and_tags_come_back() {
    let text = "# two words\nmtllib a b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\
                o thing\ng left arm\nusemtl skin\ns 1\nf 1 2 3\ng\ns off\nf 3 2 1\n\
                l 1 2 3\np 1 3\nt crease 2/1/0 0 1 2.5\nt interpolateboundary 1/0/0 2\n";
    let document = obj(text);
    let groups = document.set.face_attributes.get::<Label>(GROUP).unwrap();
    assert_eq!(groups[FaceId::new(0)], Label::new("left arm"));
    assert_eq!(groups[FaceId::new(1)], Label::default());
    let materials = document.set.face_attributes.get::<Label>(MATERIAL).unwrap();
    assert_eq!(materials[FaceId::new(1)], Label::new("skin"));
    assert_eq!(document.comments, ["two words"]);
    assert_eq!(document.material_libraries, ["a b.mtl"]);
    assert_eq!(document.polylines, [[0, 1, 2].map(VertexId::new)]);
    assert_eq!(document.points, [0, 2].map(VertexId::new));
    assert_eq!((document.tags[0].name.as_str(), document.tags[0].floats[0]), ("crease", 2.5));
    let bytes = written(&document, Format::Obj, Encoding::Text);
    assert_eq!(read_bytes(&bytes, Format::Obj).unwrap(), document);
}

/// Found by fuzzing: words that were announced and not there were empty, and gone when written.
#[test]
fn tags_have_the_words_they_announce() {
    let short = fault(b"t name 0/0/3 a b\nt name 0/0/3 a b c\n", Format::Obj);
    let problem = "2 words where the tag announces 3".to_owned();
    assert_eq!(short, (Place::Line(1), Cause::Header { problem }));
    let mut document = obj("v 0 0 0\nt name 0/0/1 a\n");
    document.tags[0].strings = vec![String::new(), "two words".to_owned()];
    let bytes = written(&document, Format::Obj, Encoding::Text);
    let strings = &read_bytes(&bytes, Format::Obj).unwrap().tags[0].strings;
    assert_eq!(strings, &["_", "two_words"]);
}

#[test]
fn clouds_have_normals_and_colors_without_faces() {
    let document = obj("vn 0 0 1\nv 0 0 0 1 0 .5\nvn 1 0 0\nv 1 2 3 0 0 1\n");
    let normals = document.set.vertex_attributes.get::<Normal>(NORMAL).unwrap();
    assert_eq!(normals.values(), [Normal(DVec3::Z), Normal(DVec3::X)]);
    let colors = document.set.vertex_attributes.get::<Color>(COLOR).unwrap();
    assert_eq!(colors.values()[0], Color([1.0, 0.0, 0.5, 1.0]));
    let bytes = written(&document, Format::Obj, Encoding::Text);
    assert_eq!(read_bytes(&bytes, Format::Obj).unwrap(), document);
}

#[test]
fn normals_that_are_not_there_do_not_cost_the_faces() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n";
    let (document, report) = read_bytes_with(text, Format::Obj, Progress::NONE).unwrap();
    assert_eq!(document.set.face_count(), 1);
    assert!(document.set.vertex_attributes.is_empty());
    assert_eq!(
        report.warnings[0].to_string(),
        "line 4: corner names a normal that is not there (3 times)"
    );
}

#[test]
fn unknown_statements_are_counted() {
    let text = b"v 0 0 0\nvp 1 2\ncurv 0 1 \\\n 2 3\nvp 3 4\n";
    let (_, report) = read_bytes_with(text, Format::Obj, Progress::NONE).unwrap();
    let found: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        found,
        ["line 2: statement `vp` skipped (2 times)", "line 3: statement `curv` skipped"]
    );
}

#[test]
fn bad_obj_files_are_refused_with_their_line() {
    let index = |index, count| Cause::IndexOutOfRange { what: "vertex", index, count, first: 1 };
    let number = |text: &str| Cause::NotANumber { text: text.to_owned() };
    let cases: [(&[u8], usize, Cause); 8] = [
        (b"", 1, Cause::Empty),
        (b"v 0 0 0\n\nf 1 2 3\n", 3, index(2, 1)),
        (b"v 0 0 0\nf 0 1 1\n", 2, Cause::IndexZero { what: "vertex", format: Format::Obj }),
        (b"f -1 -2 -3\n", 1, Cause::BeforeFirst { what: "vertex", index: -1, before: 0 }),
        (b"v 0 0 0\nf 1 1 99999999999\n", 2, index(99_999_999_999, 1)),
        (b"v 0 0\n", 1, Cause::TooFewNumbers { found: 2, expected: 3 }),
        (b"v 0 0 0\nv 1 3.1+e2 0\n", 2, number("3.1+e2")),
        (b"v 0 0 0\nf 1/x 1 1\n", 2, Cause::NotAWholeNumber { text: "1/x".to_owned() }),
    ];
    for (bytes, line, cause) in cases {
        let text = String::from_utf8_lossy(bytes);
        assert_eq!(fault(bytes, Format::Obj), (Place::Line(line), cause), "{text}");
    }
}

#[test]
fn counts_comments_and_colors_stand_where_they_like_in_off() {
    let plain = off("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    let same = [
        "# before\nOFF 4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
        "OFF4 2\n0 0 0\n1 0 0 # here\n\n1 1 0\n0 1 0\n\n3 0 1 2\n# there\n3 0 2 3",
        "OFF\r\n4\r\n2\r\n0\r\n0 0 0 1 0 0 1 1 0\r\n0 1\r\n0\r\n3 0\r\n1 2\r\n3 0 2 3\r\n",
        "4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n# after\n",
        "OFF 4 2 0\n0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n3 0 1 2\n3 0 2 3\n",
    ];
    for text in same {
        assert_eq!(off(text).set, plain.set, "{text}");
    }
    let colored = off("OFF\n3 2 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255 0 51\n3 2 1 0\n");
    let colors = colored.set.face_attributes.get::<Color>(COLOR).unwrap();
    assert_eq!(colors.values(), [Color([1.0, 0.0, 0.2, 1.0]), Color::default()]);
}

#[test]
fn attributes_that_corners_name_but_are_not_there_leave_the_geometry() {
    // Programs write 0 or any number for "none"; whole collections of files are like this.
    for face in ["f 1/0/0 2/0/0 3/0/0", "f 1/1/1 2/2/1 3/3/1", "f 1//-4 2//-4 3//-4"] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n");
        let (document, report) =
            read_bytes_with(text.as_bytes(), Format::Obj, Progress::NONE).unwrap();
        assert_eq!((document.set.vertex_count(), document.set.face_count()), (3, 1), "{face}");
        assert_eq!(document.set.corner_attributes.names().count(), 0, "{face}");
        let warned = report.warnings.iter().any(|warning| warning.what.contains("not there"));
        assert!(warned, "{face}: {report:?}");
    }
    let vertex = fault(b"v 0 0 0\nf 0 1 1\n", Format::Obj);
    let cause = Cause::IndexZero { what: "vertex", format: Format::Obj };
    assert_eq!(vertex, (Place::Line(2), cause));
}

#[test]
fn off_keeps_all_its_attributes_in_each_encoding() {
    let text = "STCN4OFF\n# made by hand\n3 1 0\n\
                0 .5 0 1 0 0 1 255 0 51 255 0 1\n1 0 0 .25 0 1 0 0 0 255 51 .5 .5\n\
                1 1 0 1 1 0 0 1 2 3 4 1 1\n3 0 1 2 .5 .25 0 1\n";
    let document = off(text);
    assert_eq!(document.set.vertex_attributes.names().count(), 4);
    for encoding in [Encoding::Text, Encoding::BigEndian, Encoding::LittleEndian] {
        let again = read_bytes(&written(&document, Format::Off, encoding), Format::Off).unwrap();
        assert_eq!(again.set, document.set, "{encoding}");
    }
}

#[test]
fn bad_off_files_are_refused_with_their_line() {
    let index = |index| Cause::IndexOutOfRange { what: "vertex", index, count: 3, first: 0 };
    let vertices = || "vertices".to_owned();
    let claim = Cause::TooMany { what: vertices(), claimed: 353_535_235_358, possible: 1 };
    let short = Cause::CutShort { what: vertices(), found: 1, expected: 2 };
    let cases: [(&[u8], usize, Cause); 6] = [
        (b"OFF\n353535235358 6 0\n0 0 0\n", 2, claim),
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n", 6, index(3)),
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 -1\n", 6, index(-1)),
        (b"OFF\n2 0 0\n0.125 0.125 0.125\n1 0\n", 5, short),
        (b"OFF\n1 0 0\n0 zero 0\n", 3, Cause::NotANumber { text: "zero".to_owned() }),
        (b"OFF BINARY\n\0\0\0\x01\0\0\0", 2, Cause::Empty),
    ];
    for (bytes, line, cause) in &cases[..5] {
        let text = String::from_utf8_lossy(bytes);
        assert_eq!(fault(bytes, Format::Off), (Place::Line(*line), cause.clone()), "{text}");
    }
    assert!(matches!(fault(cases[5].0, Format::Off), (Place::Byte(_), Cause::CutShort { .. })));
}
