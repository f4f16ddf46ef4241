//! Damage to a shape: noise, holes, random numbering, flipped and unwelded patches.
//!
//! A patch is the faces whose centers lie within a ball around the center of a random face, so that
//! it needs no connectivity.

use glam::DVec3;

use super::Random;
use crate::{
    CornerId, Error, FaceId, FaceList, FaceSet, IndexedFaceSet, Mesh, VertexId, VertexMap,
};

/// `mesh` with random offsets: each coordinate moves by a normally distributed length whose standard
/// deviation is `amplitude` times the mean edge length.
///
/// An amplitude that is negative or not finite is an error, and so is one that moves a vertex to
/// infinity.
pub fn with_noise(mut mesh: Mesh, amplitude: f64, seed: u64) -> Result<Mesh, Error> {
    if !(amplitude >= 0.0 && amplitude.is_finite()) {
        return Err(Error::option("amplitude", amplitude, "finite and not negative"));
    }
    let deviation = amplitude * mean_edge_length(&mesh);
    let mut random = Random::new(seed);
    let mut moved = mesh.positions().clone();
    for (_, p) in moved.iter_mut() {
        *p += deviation * DVec3::new(random.normal(), random.normal(), random.normal());
    }
    if moved.values().iter().any(|p| !p.is_finite()) {
        return Err(Error::option("amplitude", amplitude, "so small that positions stay finite"));
    }
    mesh.set_positions(moved);
    Ok(mesh)
}

/// `mesh` without the faces in up to `count` disks of `rings` rings of faces around random vertices.
///
/// Where disks meet, faces whose vertex would lie between two holes go too, so that what remains is
/// a manifold. Vertices that lose all their faces go; the others keep their order.
pub fn with_holes(mesh: &Mesh, count: usize, rings: usize, seed: u64) -> Result<Mesh, Error> {
    let mut random = Random::new(seed);
    let mut gone = FaceSet::new();
    if mesh.vertex_count() > 0 {
        for _ in 0..count.min(mesh.vertex_count()) {
            let center = VertexId::new(random.below(mesh.vertex_count()));
            gone.extend(disk_faces(mesh, center, rings).iter());
        }
    }
    remove_between_holes(mesh, &mut gone);
    let set = mesh.to_indexed();
    let kept: Vec<FaceId> = mesh.faces().filter(|&f| !gone.contains(f)).collect();
    let mut vertex_of = VertexMap::filled(mesh.vertex_count(), None);
    let mut sources = Sources::default();
    for v in mesh.vertices() {
        let had_faces = !mesh.is_isolated_vertex(v);
        if !had_faces || mesh.vertex_faces(v).any(|f| !gone.contains(f)) {
            vertex_of[v] = Some(VertexId::new(sources.vertices.len()));
            sources.vertices.push(v);
        }
    }
    let mut faces = FaceList::new();
    for f in kept {
        let corners = set.faces().face(f).iter();
        let corners: Vec<VertexId> = corners.filter_map(|&v| vertex_of[v]).collect();
        faces.push(&corners);
        sources.faces.push(f);
        sources.corners.extend(set.faces().face_corners(f));
    }
    Mesh::new(&derived(&set, faces, &sources))
}

/// `set` with vertices and faces in random order: the worst numbering for the caches.
pub fn shuffled(set: &IndexedFaceSet, seed: u64) -> IndexedFaceSet {
    let mut random = Random::new(seed);
    let mut sources = Sources::all(set);
    random.shuffle(&mut sources.vertices);
    random.shuffle(&mut sources.faces);
    let mut vertex_of = VertexMap::filled(set.vertex_count(), VertexId::new(0));
    for (i, &v) in sources.vertices.iter().enumerate() {
        vertex_of[v] = VertexId::new(i);
    }
    sources.corners.clear();
    let mut faces = FaceList::new();
    faces.reserve(set.face_count(), set.faces().corners().len());
    let mut face = Vec::new();
    for &f in &sources.faces {
        face.clear();
        face.extend(set.faces().face(f).iter().map(|&v| vertex_of[v]));
        faces.push(&face);
        sources.corners.extend(set.faces().face_corners(f));
    }
    derived(set, faces, &sources)
}

/// `set` with the faces of a patch turned inside out. `radius` is relative to the diagonal of the
/// bounding box.
pub fn flip_patch(set: &IndexedFaceSet, radius: f64, seed: u64) -> IndexedFaceSet {
    let patch = patch(set, radius, seed);
    let mut sources = Sources::all(set);
    let mut faces = FaceList::new();
    let mut corner = 0;
    let mut face = Vec::new();
    for (f, vertices) in set.faces().iter() {
        face.clear();
        face.extend_from_slice(vertices);
        if patch.contains(f) {
            face.reverse();
            sources.corners[corner..corner + face.len()].reverse();
        }
        faces.push(&face);
        corner += face.len();
    }
    derived(set, faces, &sources)
}

/// `set` with the faces of a patch cut loose: where the patch meets other faces it gets vertices of
/// its own, at the same places. `radius` is relative to the diagonal of the bounding box.
pub fn unweld_patch(set: &IndexedFaceSet, radius: f64, seed: u64) -> IndexedFaceSet {
    let patch = patch(set, radius, seed);
    let mut is_outside = VertexMap::filled(set.vertex_count(), false);
    for (_, vertices) in set.faces().iter().filter(|&(f, _)| !patch.contains(f)) {
        for &v in vertices {
            is_outside[v] = true;
        }
    }
    let mut sources = Sources::all(set);
    let mut copies = VertexMap::filled(set.vertex_count(), None);
    let mut faces = FaceList::new();
    let mut face = Vec::new();
    for (f, vertices) in set.faces().iter() {
        face.clear();
        face.extend(vertices.iter().map(|&v| {
            if !patch.contains(f) || !is_outside[v] {
                return v;
            }
            *copies[v].get_or_insert_with(|| {
                sources.vertices.push(v);
                VertexId::new(sources.vertices.len() - 1)
            })
        }));
        faces.push(&face);
    }
    derived(set, faces, &sources)
}

/// Where the elements of a changed face set come from.
#[derive(Default)]
pub(super) struct Sources {
    pub(super) vertices: Vec<VertexId>,
    pub(super) corners: Vec<CornerId>,
    pub(super) faces: Vec<FaceId>,
}

impl Sources {
    /// Each element of `set`, in order.
    pub(super) fn all(set: &IndexedFaceSet) -> Self {
        Sources {
            vertices: set.positions().ids().collect(),
            corners: (0..set.faces().corners().len()).map(CornerId::new).collect(),
            faces: (0..set.face_count()).map(FaceId::new).collect(),
        }
    }
}

/// The face set of `faces` whose vertices, corners and faces have the data of `sources` in `set`.
pub(super) fn derived(set: &IndexedFaceSet, faces: FaceList, sources: &Sources) -> IndexedFaceSet {
    let positions: Vec<DVec3> = sources.vertices.iter().map(|&v| set.position(v)).collect();
    let mut new = IndexedFaceSet::from_valid(positions.into(), faces);
    let Sources { vertices, corners, faces } = sources;
    new.vertex_attributes = set
        .vertex_attributes
        .gather(vertices.len(), |v: VertexId| vertices.get(v.index()).copied());
    new.corner_attributes =
        set.corner_attributes.gather(corners.len(), |c: CornerId| corners.get(c.index()).copied());
    new.face_attributes =
        set.face_attributes.gather(faces.len(), |f: FaceId| faces.get(f.index()).copied());
    new
}

/// The mean length of the edges, 0 if there are none.
fn mean_edge_length(mesh: &Mesh) -> f64 {
    let lengths = mesh.edges().map(|e| {
        let [v, w] = mesh.edge_vertices(e);
        mesh.position(v).distance(mesh.position(w))
    });
    lengths.sum::<f64>() / mesh.edge_count().max(1) as f64
}

/// The faces with a vertex fewer than `rings` edges away from `center`.
fn disk_faces(mesh: &Mesh, center: VertexId, rings: usize) -> FaceSet {
    let mut faces = FaceSet::new();
    let mut met = crate::VertexSet::new();
    met.insert(center);
    let mut front = vec![center];
    for _ in 0..rings {
        let mut next = Vec::new();
        for v in front {
            faces.extend(mesh.vertex_faces(v));
            next.extend(mesh.vertex_neighbors(v).filter(|&w| met.insert(w)));
        }
        if next.is_empty() {
            break;
        }
        front = next;
    }
    faces
}

/// Adds the faces of vertices around which the other faces would form several fans.
fn remove_between_holes(mesh: &Mesh, gone: &mut FaceSet) {
    loop {
        let before = gone.len();
        for v in mesh.vertices() {
            let remains = |h| mesh.face(h).is_some_and(|f| !gone.contains(f));
            let fans = mesh.vertex_halfedges(v).filter(|&h| remains(h) && !remains(mesh.cw(h)));
            if fans.count() > 1 {
                gone.extend(mesh.vertex_faces(v));
            }
        }
        if gone.len() == before {
            return;
        }
    }
}

/// The faces whose centers lie within `radius` box diagonals of the center of a random face.
fn patch(set: &IndexedFaceSet, radius: f64, seed: u64) -> FaceSet {
    let count = set.face_count();
    if count == 0 {
        return FaceSet::new();
    }
    let positions = set.positions().values();
    let low = positions.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
    let high = positions.iter().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
    let center = |f: FaceId| {
        let face = set.faces().face(f);
        face.iter().map(|&v| set.position(v)).sum::<DVec3>() / face.len().max(1) as f64
    };
    let middle = center(FaceId::new(Random::new(seed).below(count)));
    let reach = radius * low.distance(high);
    (0..count).map(FaceId::new).filter(|&f| center(f).distance(middle) <= reach).collect()
}
