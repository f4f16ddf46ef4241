//! Any document comes back from each format bit for bit, but for what the report names.

use dgp_io::{Document, Encoding, Format, WriteOptions, read_bytes, write_bytes};
use dgp_mesh::{
    COLOR, Color, DVec2, DVec3, FaceList, GROUP, IndexedFaceSet, Label, NORMAL, Normal, Progress,
    UV, VertexId,
};
use proptest::{collection::vec, num::f64::NORMAL as FINITE, prelude::*};

/// Numbers of all sizes, and some that trip printers.
fn number() -> impl Strategy<Value = f64> {
    let odd = [0.0, -0.0, 1.0, 5e-324, f64::MAX, f64::INFINITY, 0.1, 1e23, 9_007_199_254_740_993.0];
    prop_oneof![3 => FINITE, 1 => prop::sample::select(odd.to_vec())]
}

prop_compose! {
    fn document()(count in 1_usize..12)(
        positions in vec([number(), number(), number()], count),
        normals in vec([number(), number(), number()], count),
        colors in vec(any::<[u8; 4]>(), count),
        faces in vec(vec(0..count, 3..6), 1..8),
        seeds in vec(number(), 40),
        with in any::<[bool; 5]>(),
    ) -> Document {
        let mut list = FaceList::new();
        for face in &faces {
            let face: Vec<VertexId> = face.iter().map(|&v| VertexId::new(v)).collect();
            list.push(&face);
        }
        let corners = list.corners().len();
        let positions: Vec<DVec3> = positions.into_iter().map(DVec3::from_array).collect();
        let mut set = IndexedFaceSet::new(positions, list).unwrap();
        if with[0] {
            let normals: Vec<Normal> =
                normals.into_iter().map(|n| Normal(DVec3::from_array(n))).collect();
            set.vertex_attributes.insert(NORMAL, normals);
        }
        if with[1] {
            let colors: Vec<Color> = colors.into_iter().map(Color::from_rgba8).collect();
            set.vertex_attributes.insert(COLOR, colors);
        }
        if with[2] {
            let uv = |c: usize| DVec2::new(seeds[c % 40], c as f64);
            set.corner_attributes.insert(UV, (0..corners).map(uv).collect::<Vec<DVec2>>());
        }
        if with[3] {
            let label = |f: usize| Label::new(["", "left arm", "#2"][f % 3]);
            set.face_attributes.insert(GROUP, (0..faces.len()).map(label).collect::<Vec<Label>>());
        }
        if with[4] {
            set.vertex_attributes.insert("heat", seeds[..set.vertex_count()].to_vec());
        }
        set.into()
    }
}

proptest! {
    #[test]
    fn documents_come_back(document in document()) {
        for (format, encoding) in [
            (Format::Ply, Encoding::Text),
            (Format::Ply, Encoding::LittleEndian),
            (Format::Ply, Encoding::BigEndian),
            (Format::Off, Encoding::Text),
            (Format::Obj, Encoding::Text),
            (Format::Xyz, Encoding::Text),
        ] {
            let options = WriteOptions { encoding: Some(encoding), ..WriteOptions::default() };
            let (bytes, report) = write_bytes(&document, format, &options, Progress::NONE).unwrap();
            let again = read_bytes(&bytes, format).unwrap();
            let bits = |document: &Document| -> Vec<[u64; 3]> {
                let positions = document.set.positions().values().iter();
                positions.map(|p| p.to_array().map(f64::to_bits)).collect()
            };
            prop_assert_eq!(bits(&again), bits(&document), "{} {}", format, encoding);
            if format != Format::Xyz {
                prop_assert_eq!(again.set.faces(), document.set.faces());
            }
            if report.losses.is_empty() && matches!(format, Format::Ply | Format::Off) {
                prop_assert_eq!(&again, &document, "{} {}", format, encoding);
            }
            // What was written is its own best copy; OBJ may find that corners agree.
            let (twice, _) = write_bytes(&again, format, &options, Progress::NONE).unwrap();
            if format == Format::Obj {
                let third = read_bytes(&twice, format).unwrap();
                prop_assert_eq!(&third, &again);
            } else {
                prop_assert_eq!(&twice, &bytes, "{} {}", format, encoding);
            }
        }
    }
}
