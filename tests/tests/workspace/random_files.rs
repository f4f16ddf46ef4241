//! The fuzzers' bodies on random bytes and on files with random damage.

use std::fs;

use dgp_io::{Document, Encoding, Format, WriteOptions, write_bytes};
use dgp_mesh::{
    COLOR, Color, DVec2, DVec3, FaceList, GROUP, IndexedFaceSet, Label, NORMAL, Normal, Progress,
    UV,
};
use dgp_tests::{data, fuzz, random::Random};

type Body = fn(&[u8]);

const BODIES: [(Format, Body); 5] = [
    (Format::Obj, fuzz::obj),
    (Format::Ply, fuzz::ply),
    (Format::Stl, fuzz::stl),
    (Format::Off, fuzz::off),
    (Format::Xyz, fuzz::xyz),
];

/// Words that steer a reader into its corners.
const WORDS: [&str; 24] = [
    "v ",
    "vt ",
    "vn ",
    "f ",
    "OFF",
    "COFF",
    "BINARY",
    "ply\n",
    "end_header\n",
    "element vertex ",
    "property list uchar int ",
    "solid",
    "facet normal ",
    "vertex ",
    "endfacet",
    "4294967295",
    "-1",
    "1e999",
    "nan",
    "//",
    "\\\n",
    "\r",
    "#",
    "\0",
];

#[test]
fn random_bytes_do_no_harm() {
    let mut random = Random::new(1);
    for _ in 0..2_000 {
        let mut bytes = Vec::new();
        while random.below(12) > 0 {
            match random.below(3) {
                0 => bytes.extend(WORDS[random.below(WORDS.len())].bytes()),
                1 => bytes.extend(random.below(40).to_string().bytes().chain([b' '])),
                _ => bytes.push(random.bits() as u8),
            }
        }
        for (_, body) in BODIES {
            body(&bytes);
        }
        fuzz::build_from_faces(&bytes);
    }
}

#[test]
fn damaged_files_do_no_harm() {
    let mut random = Random::new(2);
    for (format, body) in BODIES {
        for encoding in [Encoding::Text, Encoding::LittleEndian, Encoding::BigEndian] {
            if !format.has_encoding(encoding) {
                continue;
            }
            let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
            let (bytes, _) = write_bytes(&colorful(), format, &options, Progress::NONE).unwrap();
            for _ in 0..600 {
                let mut bytes = bytes.clone();
                for _ in 0..=random.below(4) {
                    damage(&mut bytes, &mut random);
                }
                body(&bytes);
            }
        }
    }
}

#[test]
fn fixtures_do_no_harm() {
    for path in data::files(&data::fixtures()) {
        let bytes = fs::read(&path).unwrap();
        for (_, body) in BODIES {
            body(&bytes);
        }
        fuzz::build_from_faces(&bytes);
    }
}

/// Changes, drops, doubles or inserts some bytes.
fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(bytes.len());
    let end = (at + random.below(20)).min(bytes.len());
    match random.below(6) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => {
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
        3 => drop(bytes.splice(at..at, WORDS[random.below(WORDS.len())].bytes())),
        4 => bytes[at..end].fill_with(|| random.bits() as u8),
        _ => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
    }
}

/// Two faces with all common attributes.
fn colorful() -> Document {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y / 3.0, -DVec3::Z];
    let faces = FaceList::from_indices::<&[usize]>(&[&[0, 1, 2, 3], &[0, 3, 4]]);
    let mut set = IndexedFaceSet::new(positions, faces).unwrap();
    set.vertex_attributes.insert(NORMAL, vec![Normal(DVec3::Z); 5]);
    set.vertex_attributes.insert(COLOR, vec![Color::from_rgb8([255, 128, 0]); 5]);
    set.corner_attributes
        .insert(UV, (0..7).map(|i| DVec2::splat(f64::from(i))).collect::<Vec<_>>());
    set.face_attributes.insert(GROUP, vec![Label::new("a"), Label::new("b")]);
    set.face_attributes.insert(COLOR, vec![Color::from_rgb8([1, 2, 3]); 2]);
    Document { comments: vec!["two faces".to_owned()], ..set.into() }
}
