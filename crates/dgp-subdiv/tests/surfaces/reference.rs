//! Cages and their refinements as OpenSubdiv's authors keep them, where `../shared` or
//! `DGP_SHARED_DATA` has them: positions match to the precision of the files.

use std::{env, fs, path::PathBuf};

use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Mesh, Progress, VertexId};
use dgp_subdiv::{
    BoundaryRule, LoopWeights, RefinementOptions, RefinementPlan, SHARP, Scheme, Sharpness,
};

/// A shape, what its tags say, and how it is to be refined.
struct Cage {
    mesh: Mesh,
    sharpness: Sharpness,
    boundary: BoundaryRule,
}

fn folder() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = env::var_os("DGP_SHARED_DATA").map_or(beside, PathBuf::from);
    let folder = data.join("quads/subdiv_ref");
    folder.is_dir().then_some(folder)
}

fn positions(text: &str) -> Vec<DVec3> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
    let numbers = |line: &str| -> Vec<f64> {
        line.split_ascii_whitespace().map(|word| word.parse().unwrap()).collect()
    };
    lines.map(|line| DVec3::from_slice(&numbers(line))).collect()
}

fn cage(text: &str) -> Cage {
    let faces = text.lines().filter_map(|line| line.strip_prefix("f "));
    let index = |word: &str| word.split('/').next().unwrap().parse::<usize>().unwrap() - 1;
    let faces: Vec<Vec<usize>> =
        faces.map(|line| line.split_ascii_whitespace().map(index).collect()).collect();
    let set = IndexedFaceSet::new(positions(text), FaceList::from_indices(&faces)).unwrap();
    let mesh = Mesh::new(&set).unwrap();
    let (mut sharpness, mut boundary) = (Sharpness::new(), BoundaryRule::EdgeOnly);
    for line in text.lines().filter_map(|line| line.strip_prefix("t ")) {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let vertex = |k: usize| VertexId::new(words[k].parse().unwrap());
        match words[0] {
            "interpolateboundary" if words[2] == "1" => boundary = BoundaryRule::EdgeAndCorner,
            "interpolateboundary" => assert_eq!(words[2], "2"),
            "crease" => {
                let h = mesh.halfedge_between(vertex(2), vertex(3)).unwrap();
                sharpness.set_edge(h.edge(), words[4].parse::<f64>().unwrap().min(SHARP));
            }
            "corner" => sharpness.set_vertex(vertex(2), words[3].parse().unwrap()),
            other => panic!("tag {other}"),
        }
    }
    Cage { mesh, sharpness, boundary }
}

/// The largest distance from a point of one list to the nearest of the other, both ways.
fn distance(a: &[DVec3], b: &[DVec3]) -> f64 {
    let one_way = |a: &[DVec3], b: &[DVec3]| {
        // Sorted along x, so that few are compared.
        let mut sorted = b.to_vec();
        sorted.sort_by(|p, q| p.x.total_cmp(&q.x));
        let nearest = |p: DVec3| {
            let from = sorted.partition_point(|q| q.x < p.x - 1e-3);
            let near = sorted[from..].iter().take_while(|q| q.x <= p.x + 1e-3);
            near.map(|q| q.distance(p)).fold(f64::INFINITY, f64::min)
        };
        a.iter().map(|&p| nearest(p)).fold(0.0, f64::max)
    };
    one_way(a, b).max(one_way(b, a))
}

#[test]
fn all_reference_cages_are_matched() {
    let Some(folder) = folder() else {
        return;
    };
    let mut names: Vec<String> = fs::read_dir(&folder)
        .unwrap()
        .filter_map(|entry| entry.unwrap().file_name().into_string().ok())
        .filter_map(|name| name.strip_suffix("_base.obj").map(str::to_owned))
        .collect();
    names.sort();
    let mut levels = 0;
    for name in &names {
        let Cage { mesh, sharpness, boundary } =
            cage(&fs::read_to_string(folder.join(format!("{name}_base.obj"))).unwrap());
        let scheme = match name.split('_').next().unwrap() {
            "catmark" => Scheme::CatmullClark,
            "loop" => Scheme::Loop(LoopWeights::Original),
            "bilinear" => Scheme::Bilinear,
            other => panic!("{other}"),
        };
        for level in 0.. {
            let Ok(text) = fs::read_to_string(folder.join(format!("{name}_level{level}.obj")))
            else {
                break;
            };
            levels += 1;
            let options = RefinementOptions {
                scheme,
                levels: level + 1,
                boundary,
                ..RefinementOptions::default()
            };
            let plan = RefinementPlan::new(&mesh, &sharpness, &options, Progress::NONE).unwrap();
            let refined = plan.refine(mesh.positions().values()).unwrap();
            let expected = positions(&text);
            assert_eq!(refined.len(), expected.len(), "{name} level {level}");
            // Six or seven digits of coordinates up to 2, in 32 bits.
            let distance = distance(&refined, &expected);
            assert!(distance < 2e-6, "{name} level {level}: {distance}");
        }
    }
    assert_eq!((names.len(), levels), (12, 39), "cages and levels in {}", folder.display());
}
