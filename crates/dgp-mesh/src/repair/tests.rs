//! Repairs of every defect, of several at once, and of arbitrary faces.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::{FaceList, shapes};

/// Vertices in general position.
fn set<F: AsRef<[usize]>>(vertices: usize, faces: &[F]) -> IndexedFaceSet {
    let at = |i: usize| {
        let t = i as f64;
        DVec3::new((1.3 * t).sin(), (2.1 * t + 0.4).cos(), (0.7 * t * t).sin())
    };
    IndexedFaceSet::new((0..vertices).map(at).collect::<Vec<_>>(), FaceList::from_indices(faces))
        .unwrap()
}

fn mend(set: &IndexedFaceSet, options: RepairOptions) -> (Mesh, RepairReport) {
    repair(set, &options, Progress::NONE).unwrap()
}

fn tetrahedron([a, b, c, d]: [usize; 4]) -> [[usize; 3]; 4] {
    [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]
}

fn ids(elements: Option<&Elements>) -> Vec<usize> {
    match elements {
        None => Vec::new(),
        Some(Elements::Faces(list)) => list.iter().map(|f| f.index()).collect(),
        Some(Elements::Vertices(list)) => list.iter().map(|v| v.index()).collect(),
        Some(other) => panic!("{other:?}"),
    }
}

#[test]
fn a_good_mesh_is_left_alone() {
    let good = shapes::icosphere(2).unwrap().to_indexed();
    let (faces, report) = repair_faces(&good, &RepairOptions::default(), Progress::NONE).unwrap();
    assert!(report.changes.is_empty() && matches!(faces, Cow::Borrowed(_)));
    assert!(report.faces.iter().all(|(f, &new)| new == Some(f)));
}

#[test]
fn solids_that_touch_along_an_edge_come_apart() {
    let positions = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.1, 0.0],
        [1.0, -0.1, 0.5],
        [-1.0, 0.1, 0.0],
        [-1.0, -0.1, 0.5],
    ];
    let faces = [tetrahedron([0, 1, 2, 3]), tetrahedron([1, 0, 4, 5])].concat();
    let positions = positions.map(DVec3::from).to_vec();
    let two = IndexedFaceSet::new(positions, FaceList::from_indices(&faces)).unwrap();
    let (mesh, report) = mend(&two, RepairOptions::default());
    assert_eq!((mesh.vertex_count(), mesh.edge_count(), mesh.face_count()), (8, 12, 8));
    assert!(mesh.halfedges().all(|h| mesh.face(h).is_some()));
    assert_eq!(report.count(RepairAction::SeparateEdges), 1);
    assert_eq!(ids(report.get(RepairAction::SplitVertices)), [0, 1]);
}

#[test]
fn a_fin_is_cut_from_the_surface_it_stands_on() {
    let positions =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -1.0, 0.1], [0.5, 0.2, -1.0]];
    let faces = FaceList::from_indices(&[[0, 1, 2], [1, 0, 3], [1, 0, 4]]);
    let fin = IndexedFaceSet::new(positions.map(DVec3::from).to_vec(), faces).unwrap();
    let (mesh, report) = mend(&fin, RepairOptions::default());
    assert_eq!((mesh.vertex_count(), mesh.edge_count()), (7, 8));
    let last = mesh.face_vertices(FaceId::new(2)).map(|v| report.vertex_sources[v].index());
    assert_eq!(last.collect::<Vec<_>>(), [1, 0, 4]);
    let (cut, _) =
        mend(&fin, RepairOptions { crowded_edges: CrowdedEdges::Cut, ..Default::default() });
    assert_eq!((cut.vertex_count(), cut.edge_count()), (9, 9));
}

#[test]
fn the_two_sides_of_a_sheet_become_two_sheets() {
    let front = [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]];
    let back = front.map(|[a, b, c]| [c, b, a]);
    let positions: Vec<_> =
        (0..6).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
    let faces = FaceList::from_indices(&[front, back].concat());
    let sheet = IndexedFaceSet::new(positions, faces).unwrap();
    let (mesh, _) = mend(&sheet, RepairOptions::default());
    assert_eq!((mesh.vertex_count(), mesh.edge_count(), mesh.face_count()), (12, 18, 8));
}

#[test]
fn faces_that_disagree_are_turned_and_the_whole_outward() {
    let mut faces = shapes::icosphere(1).unwrap().to_faces();
    for f in (0..faces.len()).map(FaceId::new).filter(|f| f.index() % 5 != 0) {
        faces.face_mut(f).reverse();
    }
    let positions = shapes::icosphere(1).unwrap().positions().clone();
    let turned = IndexedFaceSet::new(positions, faces).unwrap();
    let (mesh, report) = mend(&turned, RepairOptions::default());
    assert_eq!(report.count(RepairAction::TurnFaces), 16);
    assert_eq!(report.count(RepairAction::TurnComponents), 1);
    let sphere = shapes::icosphere(1).unwrap();
    for f in mesh.faces() {
        let [a, b, c] = mesh.triangle(f).unwrap().map(|v| mesh.position(v));
        assert!(a.dot(b.cross(c)) > 0.0);
    }
    assert_eq!(mesh.edge_count(), sphere.edge_count());
}

#[test]
fn one_sided_surfaces_are_cut_or_refused() {
    let strip = set(6, &[[0, 1, 4, 3], [1, 2, 5, 4], [2, 3, 0, 5]]);
    let (mesh, report) = mend(&strip, RepairOptions::default());
    assert_eq!((mesh.vertex_count(), report.count(RepairAction::CutEdges)), (8, 1));
    let refused = RepairOptions { one_sided: OneSided::Refuse, ..Default::default() };
    let error = repair(&strip, &refused, Progress::NONE).unwrap_err();
    assert!(matches!(error, Error::OneSided { edges: 1, .. }), "{error}");
}

#[test]
fn holes_are_filled_but_no_edge_is_used_twice() {
    let sphere = shapes::icosphere(2).unwrap().to_indexed();
    let mut faces = FaceList::new();
    for (_, face) in sphere.faces().iter().filter(|(f, _)| !(40..52).contains(&f.index())) {
        faces.push(face);
    }
    let mut holed = IndexedFaceSet::new(sphere.positions().clone(), faces).unwrap();
    let count = holed.face_count();
    holed.face_attributes.insert("part", vec![7_u8; count]);
    let options = RepairOptions { hole_edges: 100, ..Default::default() };
    let (mesh, report) = mend(&holed, options);
    assert!(mesh.halfedges().all(|h| mesh.face(h).is_some()));
    assert!(report.count(RepairAction::FillHoles) > 0);
    assert!(mesh.attributes().face.get::<u8>("part").unwrap().values().iter().all(|&p| p == 7));
    assert!(report.face_sources.values()[count..].iter().all(Option::is_none));
    // A lone triangle has a rim too, but closing it would make a second side.
    let (lone, report) = mend(&set(3, &[[0, 1, 2]]), options);
    assert_eq!((lone.face_count(), report.changes.len()), (1, 0));
}

#[test]
fn components_are_dropped_by_size() {
    let faces: &[&[usize]] = &[&[0, 1, 2], &[3, 4, 5], &[5, 4, 6], &[7, 8, 9]];
    let three = set(10, faces);
    for (which, left) in [
        (KeepComponents::Largest(1), 2),
        (KeepComponents::Largest(2), 3),
        (KeepComponents::AtLeast(2), 2),
        (KeepComponents::AtLeast(3), 0),
        (KeepComponents::All, 4),
    ] {
        let (mesh, report) =
            mend(&three, RepairOptions { components: which, ..Default::default() });
        assert_eq!(mesh.face_count(), left, "{which:?}");
        assert_eq!(report.faces.values().iter().flatten().count(), left);
    }
}

#[test]
fn bridges_to_holes_stay_in_place() {
    let positions = [
        [0.0, 0.0, 0.0],
        [3.0, 0.0, 0.0],
        [3.0, 3.0, 0.0],
        [0.0, 3.0, 0.0],
        [1.0, 1.0, 0.0],
        [2.0, 1.0, 0.0],
        [2.0, 2.0, 0.0],
    ];
    let faces = FaceList::from_indices(&[[0, 1, 2, 3, 0, 4, 6, 5, 4]]);
    let bridged = IndexedFaceSet::new(positions.map(DVec3::from).to_vec(), faces).unwrap();
    let (mesh, report) = mend(&bridged, RepairOptions::default());
    assert_eq!((mesh.vertex_count(), mesh.degree(FaceId::new(0))), (9, 9));
    assert_eq!(ids(report.get(RepairAction::CopyCorners)), [0]);
}

#[test]
fn welding_a_soup_gives_the_mesh_back() {
    let sphere = shapes::icosphere(1).unwrap().to_indexed();
    let soup = crate::PolygonSoup::from_indexed(&sphere).to_separate();
    let options = RepairOptions { weld: Some(Tolerance::Exact), ..Default::default() };
    let (mesh, report) = mend(&soup, options);
    assert_eq!(
        (mesh.vertex_count(), mesh.face_count()),
        (sphere.vertex_count(), sphere.face_count())
    );
    assert!(report.vertices.values().iter().all(Option::is_some));
    assert_eq!(
        report.count(RepairAction::MergeVertices),
        soup.vertex_count() - mesh.vertex_count()
    );
}

#[test]
fn flat_faces_go_without_opening_anything() {
    // A square with center 4, and a flat face between it and a corner 5 on its lower side.
    let positions = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 2.0, 0.0],
        [0.0, 2.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.5, 0.0, 0.0],
        [1.0, -1.0, 0.0],
    ];
    let faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [0, 6, 5], [6, 1, 5]];
    let cap =
        IndexedFaceSet::new(positions.map(DVec3::from).to_vec(), FaceList::from_indices(&faces))
            .unwrap();
    let options = RepairOptions { flat_faces: FlatFaces::Remove, ..Default::default() };
    let (mesh, report) = mend(&cap, options);
    assert_eq!((mesh.vertex_count(), mesh.edge_count(), mesh.face_count()), (7, 13, 7));
    assert_eq!(ids(report.get(RepairAction::RemoveFlatFaces)), [4]);
    let flat = mesh.faces().filter(|&f| {
        crate::check::is_flat(mesh.positions(), &mesh.face_vertices(f).collect::<Vec<_>>())
    });
    assert_eq!(flat.count(), 0);

    // The same with the center beside itself: a flat face whose two corners are at one place.
    let positions =
        [positions[0], positions[1], positions[2], positions[3], positions[4], positions[4]];
    let faces = [[0, 1, 4], [1, 2, 4], [2, 5, 4], [2, 3, 5], [3, 0, 5], [0, 4, 5]];
    let needle =
        IndexedFaceSet::new(positions.map(DVec3::from).to_vec(), FaceList::from_indices(&faces))
            .unwrap();
    let (mesh, report) = mend(&needle, options);
    assert_eq!((mesh.vertex_count(), mesh.edge_count(), mesh.face_count()), (5, 8, 4));
    assert_eq!(ids(report.get(RepairAction::RemoveFlatFaces)), [2, 5]);
    assert_eq!(report.vertices[VertexId::new(5)], Some(VertexId::new(4)));
}

#[test]
fn it_stops_when_asked_to() {
    use std::{
        ops::ControlFlow,
        sync::atomic::{AtomicUsize, Ordering},
    };
    let count = AtomicUsize::new(0);
    let counting = |_| {
        count.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    let strip = set(6, &[[0, 1, 4, 3], [1, 2, 5, 4], [2, 3, 0, 5]]);
    let options =
        RepairOptions { hole_edges: 9, weld: Some(Tolerance::Exact), ..Default::default() };
    let _ = repair(&strip, &options, Progress::new(&counting)).unwrap();
    for stop_at in 1..=count.into_inner() {
        let left = AtomicUsize::new(stop_at);
        let stop = |_| match left.fetch_sub(1, Ordering::Relaxed) {
            1 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let result = repair(&strip, &options, Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))), "report {stop_at}");
    }
}

/// Faces of up to five corners on eight vertices, some at one place, one perhaps nowhere.
fn any_set() -> impl Strategy<Value = IndexedFaceSet> {
    let faces = prop::collection::vec(prop::collection::vec(0_usize..8, 0..6), 0..14);
    let triangles = prop::collection::vec(prop::collection::vec(0_usize..8, 3..=3), 0..24);
    let grid = prop::collection::vec([0_i32..3, 0..3, 0..3], 8);
    (prop_oneof![faces, triangles], grid, 0_usize..40).prop_map(|(faces, grid, bad)| {
        let at = |(i, &[x, y, z]): (usize, &[i32; 3])| {
            let x = if i == bad { f64::NAN } else { x.into() };
            DVec3::new(x, y.into(), z.into())
        };
        let positions: Vec<_> = grid.iter().enumerate().map(at).collect();
        let faces = FaceList::from_indices(&faces);
        let corners = faces.corners().iter().map(|v| v.index() as u32).collect::<Vec<_>>();
        let numbers = (0..faces.len() as u32).collect::<Vec<_>>();
        let mut set = IndexedFaceSet::new(positions, faces).unwrap();
        set.corner_attributes.insert("vertex", corners);
        set.vertex_attributes.insert("number", (0..8_u32).collect::<Vec<_>>());
        set.face_attributes.insert("number", numbers);
        set
    })
}

fn any_options() -> impl Strategy<Value = RepairOptions> {
    let facing = prop_oneof![Just(Facing::Keep), Just(Facing::Consistent), Just(Facing::Outward)];
    let crowded = prop_oneof![Just(CrowdedEdges::Pair), Just(CrowdedEdges::Cut)];
    let isolated = prop_oneof![Just(IsolatedVertices::Drop), Just(IsolatedVertices::Keep)];
    (facing, crowded, isolated).prop_map(|(orientation, crowded_edges, isolated_vertices)| {
        RepairOptions { orientation, crowded_edges, isolated_vertices, ..Default::default() }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn any_faces_become_a_mesh_that_needs_no_repair(set in any_set(), options in any_options()) {
        let (mesh, _) = repair(&set, &options, Progress::NONE).unwrap();
        let again = mesh.to_indexed();
        let (faces, report) = repair_faces(&again, &options, Progress::NONE).unwrap();
        prop_assert_eq!(&report.changes, &[]);
        prop_assert_eq!(faces.as_ref(), &again);
        let defects = crate::defects(&again, Progress::NONE).unwrap();
        prop_assert!(defects.is_manifold(), "{}", defects);
    }

    #[test]
    fn every_face_is_kept_or_listed_and_its_data_go_with_it(
        set in any_set(),
        options in any_options(),
    ) {
        let (mesh, report) = repair(&set, &options, Progress::NONE).unwrap();
        let mut dropped = ids(report.get(RepairAction::DropNonFiniteFaces));
        dropped.extend(ids(report.get(RepairAction::DropShortFaces)));
        if let Some(Elements::FacePairs(pairs)) = report.get(RepairAction::DropDuplicateFaces) {
            dropped.extend(pairs.iter().map(|pair| pair[0].index()));
        }
        dropped.sort_unstable();
        let gone = report.faces.iter().filter(|(_, new)| new.is_none()).map(|(f, _)| f.index());
        prop_assert_eq!(dropped, gone.collect::<Vec<_>>());

        let number = mesh.attributes().vertex.get::<u32>("number").unwrap();
        for v in mesh.vertices() {
            prop_assert_eq!(number[v] as usize, report.vertex_sources[v].index());
            prop_assert_eq!(mesh.position(v), set.position(report.vertex_sources[v]));
        }
        let corner = mesh.attributes().corner.get::<u32>("vertex").unwrap();
        let face_number = mesh.attributes().face.get::<u32>("number").unwrap();
        for f in mesh.faces() {
            prop_assert_eq!(Some(FaceId::new(face_number[f] as usize)), report.face_sources[f]);
            for h in mesh.face_halfedges(f) {
                prop_assert_eq!(corner[h], number[mesh.from(h)]);
            }
        }
    }

    #[test]
    fn all_options_together_still_give_a_mesh(
        set in any_set(),
        options in any_options(),
        steps in 0_u8..4,
        largest in 1_usize..3,
    ) {
        let options = RepairOptions {
            weld: Some(Tolerance::Distance(f64::from(steps) * 0.5)),
            flat_faces: FlatFaces::Remove,
            components: KeepComponents::Largest(largest),
            hole_edges: 12,
            ..options
        };
        let (mesh, report) = repair(&set, &options, Progress::NONE).unwrap();
        prop_assert_eq!(report.face_sources.len(), mesh.face_count());
        let scaled = 2.0_f64.powi(-700);
        let mut small = set.clone();
        for p in small.positions_mut() {
            *p *= scaled;
        }
        let options = RepairOptions {
            weld: Some(Tolerance::Distance(f64::from(steps) * 0.5 * scaled)),
            ..options
        };
        let (small_mesh, small_report) = repair(&small, &options, Progress::NONE).unwrap();
        prop_assert_eq!(small_report, report);
        prop_assert_eq!(small_mesh.connectivity(), mesh.connectivity());
    }
}

#[test]
fn walls_and_fins_go_and_sheets_keep_a_side() {
    let options =
        RepairOptions { opposite_faces: OppositeFaces::Remove, ..RepairOptions::default() };
    let dropped = |report: &RepairReport| ids(report.get(RepairAction::DropOppositeFaces));
    // Two tetrahedra with a wall between them, which both have: 3 of one and 2 of the other.
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 1.0], [0.3, 0.3, -1.0]];
    let positions = positions.map(DVec3::from).to_vec();
    let upper = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let lower = [[0, 1, 2], [1, 0, 4], [2, 1, 4], [0, 2, 4]];
    let faces = FaceList::from_indices(&[upper, lower].concat());
    let (mesh, report) = mend(&IndexedFaceSet::new(positions.clone(), faces).unwrap(), options);
    assert_eq!((mesh.face_count(), mesh.vertex_count(), dropped(&report)), (6, 5, vec![0, 4]));
    assert!(mesh.halfedges().all(|h| mesh.face(h).is_some()));
    // A fin with two sides on a tetrahedron.
    let fin = [upper.as_slice(), &[[0, 1, 4], [1, 0, 4]]].concat();
    let fin = IndexedFaceSet::new(positions, FaceList::from_indices(&fin)).unwrap();
    let (mesh, report) = mend(&fin, options);
    assert_eq!((mesh.face_count(), dropped(&report)), (4, vec![4, 5]));
    // A tetrahedron with a side too many.
    let more = [upper.as_slice(), &[[3, 1, 0]]].concat();
    let more = IndexedFaceSet::new(fin.positions().clone(), FaceList::from_indices(&more)).unwrap();
    let (mesh, report) = mend(&more, options);
    assert_eq!((mesh.face_count(), dropped(&report)), (4, vec![4]));
    assert!(mesh.halfedges().all(|h| mesh.face(h).is_some()));
    // A sheet of both sides of a grid, and each face a second time.
    let grid = shapes::grid(3, 3).unwrap().to_indexed();
    let mut faces = grid.faces().clone();
    for (_, face) in grid.faces().iter() {
        faces.push(&face.iter().rev().copied().collect::<Vec<_>>());
        faces.push(face);
    }
    let sheet = IndexedFaceSet::new(grid.positions().clone(), faces).unwrap();
    let (mesh, report) = mend(&sheet, options);
    assert_eq!((mesh.face_count(), dropped(&report).len()), (grid.face_count(), grid.face_count()));
    assert_eq!(report.count(RepairAction::DropDuplicateFaces), grid.face_count());
    let (_, again) = mend(&mesh.to_indexed(), options);
    assert_eq!(again.changes, []);
}
