//! tries
use std::{fs, time::Instant};
use dgp_mesh::{*, spatial::*};
use dgp_remesh::*;
fn read(path: &str) -> IndexedFaceSet {
    let b = fs::read(path).unwrap();
    let n = |at: usize| u64::from_le_bytes(b[at..at + 8].try_into().unwrap()) as usize;
    let (v, f, _c) = (n(0), n(8), n(16));
    let d = |at: usize| f64::from_le_bytes(b[at..at + 8].try_into().unwrap());
    let pos: Vec<DVec3> = (0..v).map(|i| DVec3::new(d(24 + 24 * i), d(32 + 24 * i), d(40 + 24 * i))).collect();
    let s = 24 + 24 * v + 4 * (f + 1);
    let u = |i: usize| u32::from_le_bytes(b[s + 4 * i..s + 4 * i + 4].try_into().unwrap()) as usize;
    let faces: Vec<[usize; 3]> = (0..f).map(|i| [u(3 * i), u(3 * i + 1), u(3 * i + 2)]).collect();
    IndexedFaceSet::new(pos, FaceList::from_indices(&faces)).unwrap()
}
fn quality(a: &TriangleTree, b: &IndexedFaceSet) -> [f64; 6] {
    let b = TriangleTree::new(b, Progress::NONE).unwrap();
    let diagonal = a.bounding_box().unwrap().diagonal() * 1e-4;
    let o = DeviationOptions { samples: 200_000 };
    let x = deviation(a, &b, &o, Progress::NONE).unwrap();
    let y = deviation(&b, a, &o, Progress::NONE).unwrap();
    let h = hausdorff(a, &b, &HausdorffOptions { tolerance: 2e-5, queries: 500_000 }, Progress::NONE).unwrap();
    [x.mean, y.mean, x.rms, y.rms, h.forward.lower, h.backward.lower].map(|x| x / diagonal)
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let set = read(&args[1]);
    let a = TriangleTree::new(&set, Progress::NONE).unwrap();
    let name = args[1].rsplit('/').next().unwrap().to_owned();
    for arg in &args[3..] {
        if arg.ends_with(".raw") {
            let s = read(arg);
            println!("{name:14} {:34} {:6} f            {:.3?}", arg.rsplit('/').next().unwrap(), s.face_count(), quality(&a, &s));
            continue;
        }
        let part: usize = args[2].parse().unwrap();
        let mut mesh = Mesh::new(&set).unwrap();
        let mut o = QuadricOptions::default();
        for word in arg.split(',') {
            let (k, v) = word.split_once('=').unwrap_or((word, "0"));
            let x: f64 = v.parse().unwrap();
            match k {
                "fast" => o = QuadricOptions::fast(),
                "passes" => o.order = Order::Passes,
                "polish" => o.polish = x as usize,
                "blend" => o.memory = Memory::Blend(x),
                "kept" => o.memory = Memory::Kept,
                "less" => o.memory = Memory::Memoryless,
                "free" => o.volume = Volume::Free,
                "opt" => o.placement = Placement::Optimal,
                "ends" => o.placement = Placement::Ends,
                "damp" => o.damping = x,
                "len" => o.length_weight = x,
                "turn" => o.largest_turn = x.to_radians(),
                "attr" => o.attribute_weight = x,
                _ => {}
            }
        }
        let t = Instant::now();
        let target = Target::Faces(set.face_count() / part);
        let _r = decimate_quadric(&mut mesh, target, &VertexSet::new(), &o, Progress::NONE).unwrap();
        let ms = t.elapsed().as_secs_f64() * 1e3;
        println!("{name:14} {arg:34} {:6} f {ms:8.1} ms {:.3?}", mesh.face_count(), quality(&a, &mesh.to_indexed()));
    }
}
