//! What a scanner makes of a shape, for trying out what reads, checks, mends and smooths.

use glam::DVec3;

use super::{
    Random,
    damage::{Sources, derived},
    flip_patch, unweld_patch, with_holes, with_noise,
};
use crate::{
    COLOR, Color, CornerId, Error, FaceId, FaceList, IndexedFaceSet, Mesh, VertexId, VertexMap,
};

/// The name of the `f64` per vertex in which [`like_a_scan`] says how sure the scanner is, 0 to 1.
pub const CONFIDENCE: &str = "confidence";

/// Noise of a scan, relative to the mean edge length.
const NOISE: f64 = 0.12;
/// How many single points float about, triangles collapse to an edge, and triangles come twice.
const STRAY: usize = 5;

/// `mesh` as a careless scan would give it: noisy, with three holes, a patch cut loose along
/// duplicate vertices, a patch inside out, a few points of no face, a few faces that name a vertex
/// twice or come twice; with a color and a [`CONFIDENCE`] per vertex.
///
/// Other attributes of `mesh` are kept. Errors: those of [`with_noise`] and [`with_holes`].
pub fn like_a_scan(mesh: &Mesh, seed: u64) -> Result<IndexedFaceSet, Error> {
    let mut random = Random::new(seed);
    let noisy = with_noise(mesh.clone(), NOISE, random.bits())?;
    // A hole has a few thousandths of the area: rings grow like the root of the face count.
    let rings = 1 + (noisy.face_count() as f64 * 2e-4).sqrt() as usize;
    let holed = with_holes(&noisy, 3, rings, random.bits())?;
    let mut set = holed.to_indexed();
    paint(&holed, &mut set, &mut random);
    let set = unweld_patch(&set, 0.12, random.bits());
    let set = flip_patch(&set, 0.06, random.bits());
    Ok(with_strays(&set, &mut random))
}

/// Gives each vertex the color of weathered clay and less confidence where the surface faces along z,
/// away from a scanner that goes around it.
fn paint(mesh: &Mesh, set: &mut IndexedFaceSet, random: &mut Random) {
    let normals = mesh.map_vertices(|v| {
        let around = mesh.vertex_halfedges(v).filter(|&h| mesh.face(h).is_some());
        let p = mesh.position(v);
        let corner = |h| {
            let [to, from] = [mesh.to(h), mesh.from(mesh.prev(h))].map(|w| mesh.position(w) - p);
            to.cross(from)
        };
        around.map(corner).sum::<DVec3>().normalize_or_zero()
    });
    let confidence = normals.map(|n| 0.25 + 0.75 * (1.0 - n.z * n.z).max(0.0).sqrt());
    let colors: VertexMap<Color> = VertexMap::from_fn(mesh.vertex_count(), |v| {
        let light = 0.5 + 0.5 * normals[v].z;
        let grain = 12.0 * random.normal();
        let channel = |dark: f64, bright: f64| {
            (dark + light * (bright - dark) + grain).clamp(0.0, 255.0) as u8
        };
        Color::from_rgb8([channel(150.0, 226.0), channel(96.0, 190.0), channel(70.0, 150.0)])
    });
    set.vertex_attributes.insert(CONFIDENCE, confidence);
    set.vertex_attributes.insert(COLOR, colors);
}

/// Adds points of no face, faces that name a vertex twice, and faces that come twice.
fn with_strays(set: &IndexedFaceSet, random: &mut Random) -> IndexedFaceSet {
    if set.face_count() == 0 {
        return set.clone();
    }
    let mut sources = Sources::all(set);
    let mut faces: FaceList = set.faces().clone();
    for _ in 0..STRAY {
        let f = FaceId::new(random.below(set.face_count()));
        let corners: Vec<CornerId> = set.faces().face_corners(f).collect();
        for twin in [vec![corners[0], corners[1], corners[1]], corners] {
            let vertices: Vec<VertexId> = twin.iter().map(|&c| set.faces().vertex(c)).collect();
            faces.push(&vertices);
            sources.corners.extend(twin);
            sources.faces.push(f);
        }
        sources.vertices.push(VertexId::new(random.below(set.vertex_count())));
    }
    let mut scan = derived(set, faces, &sources);
    let stray = set.vertex_count();
    let middle = set.positions().values().iter().sum::<DVec3>() / stray.max(1) as f64;
    for p in &mut scan.positions_mut()[stray..] {
        // Out of the surface by some fraction of its size.
        *p += (0.1 + 0.2 * random.uniform()) * (*p - middle);
    }
    scan
}
